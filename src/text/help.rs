//! The device's own help: wiring, settings, limits, what to try.

use super::texts;

texts! {
    device_help_of(name: &str) => "Help: {name}" | "帮助：{name}";
    device_help_print => "Print" | "打印";
    device_help_wiring => "Wiring" | "接线";
    device_help_no_wires => "The manual does not tell the colours of the wires: see the label on the cable. A goes to the adapter's A (also D+ or 485+), B to its B (D− or 485−)." | "说明书没有给出线色，请以电缆标签为准。A 接转换器的 A（也标作 D+、485+），B 接转换器的 B（D−、485−）。";
    device_help_rs485 => "A goes to the adapter's A (also D+ or 485+), B to its B (D− or 485−)." | "A 接转换器的 A（也标作 D+、485+），B 接转换器的 B（D−、485−）。";
    device_help_rs232 => "RS232 levels: use an RS232 port or adapter, not an RS485 one." | "RS232 电平：请使用 RS232 串口或转换器，不能用 RS485 转换器。";
    device_help_device => "Device" | "设备";
    device_help_supply => "Supply" | "电源";
    device_help_adapter => "Adapter" | "转换器";
    device_help_wire => "Wire" | "线";
    device_help_terminal => "Terminal" | "端子";
    device_help_pin => "Pin" | "针脚";
    device_help_use => "Use" | "用途";
    device_help_plug => "The plug, seen from its face" | "插头正面";

    device_help_defaults => "Factory settings" | "出厂设置";
    device_help_line => "Line" | "通信参数";
    device_help_mode => "Mode" | "传输模式";
    device_help_unit => "Address" | "地址";
    device_help_usually(unit: u8) => "usually {unit}" | "一般为 {unit}";
    device_help_limits => "Limits" | "使用限制";
    device_help_units => "Addresses" | "地址范围";
    device_help_bauds => "Baud rates" | "波特率";
    device_help_from_to(first: &str, last: &str) => "{first} to {last}" | "{first} 到 {last}";
    device_help_limits_of(first: &str, last: &str) => "from “{first}” to “{last}”, as the device says" | "由设备给出：“{first}”到“{last}”";
    device_help_startup => "After power-on" | "上电后";
    device_help_silent(time: &str) => "it does not answer for {time}" | "{time} 内不应答";
    device_help_answer => "Answer" | "应答";
    device_help_within(time: &str) => "within {time}" | "{time} 以内";
    device_help_readings => "Readings" | "读取周期";
    device_help_every(usual: &str, least: &str) => "usually every {usual}, never faster than every {least}" | "通常每 {usual} 一次，最快每 {least} 一次";
    device_help_writes => "Writes" | "写入";
    device_help_one_in(time: &str) => "at most one in {time}" | "每 {time} 最多一次";
    device_help_endures(count: &str) => "its memory endures about {count}" | "存储器寿命约 {count} 次";
    device_help_pause => "Before another device is asked" | "访问下一设备前";
    device_help_wait(time: &str) => "wait {time}" | "等待 {time}";

    device_help_try => "When something is wrong" | "常见问题与解决方法";
    device_help_notes => "Good to know" | "注意事项";
    device_help_errata => "Mistakes in the manual" | "说明书勘误";
    device_help_printed => "printed" | "印作";
    device_help_right => "right" | "应为";
    device_help_source(source: &str) => "From: {source}" | "来源：{source}";
}
