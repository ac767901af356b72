//! The frame around the pages: navigation, top bar, switches, and the page after a crash.

use super::texts;

texts! {
    live => "Live" | "实时";
    decoder => "Decoder" | "解码";
    console => "Console" | "控制台";
    profiles => "Profiles" | "设备库";
    device_help => "Help with the device" | "设备帮助";
    pages => "Pages" | "页面";
    switch_language => "中文" | "English";
    switch_language_label => "Switch to Chinese" | "切换到英文";
    theme_auto => "Theme: as the system" | "主题：跟随系统";
    theme_light => "Theme: light" | "主题：浅色";
    theme_dark => "Theme: dark" | "主题：深色";
    skip_to_content => "Skip to content" | "跳到正文";

    loading => "Loading…" | "正在加载…";
    loading_failed => "This part of the page could not be loaded. Check the network connection." | "这一部分未能加载，请检查网络连接。";
    load_again => "Try again" | "重试";

    no_port => "No port" | "未选串口";
    simulator => "Simulated sensor" | "模拟传感器";
    replay_source => "Recording" | "回放记录";
    read_only => "Read only" | "只读";
    read_only_hint => "Lets only reads out of the port: nothing that could change a device is sent, by anybody." | "只允许读请求发出：任何来源都不会发送可能改动设备的内容。";
    serial_port => "Serial port" | "串口";
    unit_id(unit: u8) => "unit {unit}" | "地址 {unit}";
    round_trip => "round trip" | "往返";
    state_closed => "Not connected" | "未连接";
    state_opening => "Opening port" | "正在打开串口";
    state_waiting => "Waiting for an answer" | "等待应答";
    state_listening => "Listening" | "监听中";
    state_reading => "Reading" | "正在读取";
    state_failing => "Reading fails" | "读取异常";
    state_lost => "Adapter unplugged" | "适配器已拔出";
    state_closing => "Closing port" | "正在关闭串口";
    state_failed => "Port did not open" | "串口打不开";
    disconnect => "Disconnect" | "断开";

    crash_title => "Buslens has stopped" | "Buslens 已停止运行";
    crash_what => "An internal fault stopped the page. The port has been closed and the bus is quiet. Your settings and texts are kept; load the page again to go on." | "程序内部出错，页面已停止。串口已关闭，总线上不再有通信。您的设置和输入的内容都已保留，重新加载页面即可继续。";
    crash_report => "If it happens again, please send us these details." | "如果再次出现，请把下面的详细信息发给我们。";
    copy_details => "Copy details" | "复制详细信息";
    copied => "Copied" | "已复制";
    reload => "Load the page again" | "重新加载页面";
    crash_details => "Details" | "详细信息";
}
