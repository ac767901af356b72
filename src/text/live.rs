//! The Live page: connecting, readings, the trend, counters.

use super::texts;

texts! {
    connect_title => "Connect a sensor" | "连接传感器";
    port => "Port" | "串口";
    port_none => "No port chosen yet" | "尚未选择串口";
    choose_port => "Choose port…" | "选择串口…";
    port_hint => "The browser asks once which adapter this page may use." | "浏览器会询问一次，允许本页使用哪个适配器。";
    device => "Device" | "设备";
    baud => "Baud rate" | "波特率";
    baud_other => "Other…" | "其他…";
    baud_free => "Other baud rate" | "其他波特率";
    parity => "Parity" | "奇偶校验";
    parity_none => "None" | "无";
    parity_odd => "Odd" | "奇";
    parity_even => "Even" | "偶";
    stop_bits => "Stop bits" | "停止位";
    data_bits => "Data bits" | "数据位";
    mode => "Mode" | "传输模式";
    unit => "Unit id" | "从机地址";
    period => "Period" | "读取周期";
    period_is(rate: &str) => "{rate} readings per second; 0 only listens" | "每秒读取 {rate} 次；填 0 则只监听";
    listen_only => "Only listens: nothing is sent by itself." | "只监听，不会主动发送数据。";
    polling_paused => "polling is paused" | "轮询已暂停";
    a_replay => "a recording is played" | "正在回放记录";
    factory_default => "factory default" | "出厂默认";
    factory_default_is(value: &str) => "factory default: {value}" | "出厂默认：{value}";
    reset_to_defaults => "Factory settings" | "恢复出厂默认值";
    connect => "Connect" | "连接";
    connecting => "Connecting…" | "正在连接…";
    try_without_hardware => "Try without hardware" | "无硬件试用";
    try_hint => "A simulated sensor on a simulated line, through the same program as a real one." | "模拟线路上的模拟传感器，走的是与真实设备相同的程序。";

    invalid_baud => "A baud rate is a whole number from 50 to 4 000 000." | "波特率须为 50 到 4 000 000 之间的整数。";
    invalid_unit => "A unit id is a whole number from 0 to 255." | "从机地址须为 0 到 255 之间的整数。";
    invalid_period => "A period is a whole number from 0 to 3 600 000 ms." | "读取周期须为 0 到 3 600 000 ms 之间的整数。";
    unit_printed => "printed on the housing" | "印在外壳上";
    unit_broadcast => "0 is the broadcast address. Only one sensor may be connected: if there are several, all of them answer at once and the answers collide." | "0 是广播地址。总线上只能接一个传感器：如果接了多个，它们会同时应答，数据相互冲突。";
    unit_reserved => "Addresses above 247 are reserved by the Modbus standard. Most devices do not answer them." | "大于 247 的地址为 Modbus 标准的保留地址，多数设备不会应答。";
    period_short(least: u32) => "This device should not be read more often than every {least} ms; values may repeat or get lost." | "该设备的读取周期不宜小于 {least} ms，否则数据可能重复或丢失。";

    wiring_title => "Wiring" | "接线";
    wire_sensor => "Sensor" | "传感器";
    step_wire => "Wire the sensor and switch its supply on." | "接好传感器的线，并接通电源。";
    step_port => "Plug the adapter in and choose its port." | "插入适配器，选择对应的串口。";
    step_connect => "Check the address on the housing, then connect." | "核对外壳上的地址，然后点击连接。";

    shown_unit => "Unit shown" | "显示单位";
    converted_from(value: &str, unit: &str) => "converted from {value} {unit}" | "由 {value} {unit} 换算";
    above_range(limit: &str) => "above the range, which ends at {limit}" | "超出量程上限 {limit}";
    below_range(limit: &str) => "below the range, which begins at {limit}" | "低于量程下限 {limit}";
    minimum => "min" | "最小";
    maximum => "max" | "最大";
    mean => "mean" | "平均";
    reset_statistics => "Reset statistics" | "统计清零";
    statistics_since => "Since connecting or the last reset" | "自连接或上次清零起统计";
    no_reading_yet => "No reading yet" | "尚无读数";
    old_reading(seconds: u32) => "old: {seconds} s ago" | "旧数据：{seconds} 秒前";
    old_reading_minutes(minutes: u32) => "old: {minutes} min ago" | "旧数据：{minutes} 分钟前";

    last_minute => "Last 60 s" | "最近 60 秒";
    trend_label(name: &str) => "{name} over the last 60 seconds" | "最近 60 秒的{name}曲线";
    trend_now => "now" | "现在";
    trend_seconds(seconds: u32) => "−{seconds} s" | "−{seconds} 秒";
    trend_waiting => "The curve starts with the first reading." | "收到第一个读数后开始绘制曲线。";

    connection => "Connection" | "连接状态";
    replies => "Replies" | "应答";
    no_answers => "No answers" | "无应答";
    bad_checks => "Check errors" | "校验错误";
    exceptions => "Exceptions" | "异常应答";
    late_replies => "Late replies" | "迟到应答";
    noise_bytes => "Noise bytes" | "干扰字节";
    line_errors => "Line errors" | "线路错误";
    rate => "Rate wanted / got" | "速率（设定 / 实际）";
    round_trip_time => "Round trip" | "往返时间";

    last_exchange => "Last exchange" | "最近一次通信";
    open_in_decoder => "Open in decoder" | "在解码页打开";
    nothing_sent => "Nothing sent yet" | "尚未发送";
    nothing_received => "Nothing came back" | "没有收到数据";
}
