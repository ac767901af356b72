//! The Console page.

use super::texts;

texts! {
    origin => "Origin" | "来源";
    origin_poll => "poll" | "轮询";
    origin_console => "console" | "控制台";
    origin_sequence => "sequence" | "序列";
    origin_configuration => "settings" | "配置";
    gap => "Gap" | "间隔";
    round_trip_short => "Trip" | "往返";
    event_opened(line: &str, mode: &str) => "opened {line} {mode}" | "已打开 {line} {mode}";
    event_closed => "closed" | "已关闭";
    event_lost => "adapter gone" | "适配器已断开";
    event_line_error => "line error" | "线路错误";
    event_break(milliseconds: u32) => "break {milliseconds} ms" | "中断信号 {milliseconds} ms";
    event_forgotten(bytes: &str) => "{bytes} bytes forgotten" | "已丢弃 {bytes} 字节";
    both_directions => "TX and RX" | "TX 与 RX";
    profile_connected => "As connected" | "与所连设备一致";
    profile_connected_is(name: &str) => "Connected: {name}" | "所连设备：{name}";
}
