//! The Decoder page.

use super::texts;

texts! {
    decoder_title => "Take frames apart" | "报文解析";
    decoder_input => "Frames, one or many, as hex or as ASCII text" | "报文（一条或多条），十六进制或 ASCII 文本";
    decoder_placeholder => "Paste or drop anything that came off a line: hex in any spelling, ASCII frames, logs of other tools, hex dumps. For example 01 04 00 04 00 02 30 0A" | "可粘贴或拖入线路上的任何数据：各种写法的十六进制、ASCII 报文、其他工具的日志、十六进制转储。例如 01 04 00 04 00 02 30 0A";
    examples => "Examples:" | "示例：";
    example_request => "Request" | "请求";
    example_reply => "Reply −0.328 mm" | "应答 −0.328 mm";
    example_exception => "Exception" | "异常应答";
    example_ascii => "ASCII" | "ASCII 报文";
    restore_text => "Back to the previous text" | "恢复之前的内容";
    decoder_empty => "Nothing to take apart yet. Paste bytes from any log, or take an example." | "还没有可解析的内容。粘贴任意日志中的字节，或选用一个示例。";
    parse_error_at(line: usize, column: usize, what: &str) => "Line {line}, column {column}: {what}" | "第 {line} 行第 {column} 列：{what}";
    frames => "Frames" | "报文";
    direction => "Dir" | "方向";
    bytes => "Bytes" | "字节";
    meaning => "Meaning" | "含义";
    check => "Check" | "校验";
    field => "Field" | "字段";
    value => "Value" | "值";
    check_ok => "ok" | "正确";
    check_bad => "wrong" | "错误";
    check_expected(expected: &str) => "expected {expected}" | "应为 {expected}";
    noise => "noise" | "杂散字节";
    selected_frame => "Selected frame" | "所选报文";
    noise_meaning => "belongs to no frame" | "不属于任何报文";
    no_frame => "bytes without a frame" | "无法组成报文的字节";

    unit_short => "Unit" | "地址";

    unexpected_character(character: char) => "“{character}” does not belong here" | "此处不应出现“{character}”";
    odd_digits => "an odd number of digits: one is missing" | "数字个数为奇数，缺少一位";
    reply_needs_request => "Put the request before the reply: only it tells which registers these are." | "请把请求放在应答之前，只有请求才说明这些是哪些寄存器。";
}
