//! The Frame builder page.

use super::texts;

texts! {
    builder => "Builder" | "组帧";
    builder_title => "Build a frame" | "组建报文";
    way => "Kind of message" | "报文类型";
    way_request => "Request" | "请求";
    way_response => "Reply" | "应答";
    way_exception => "Exception" | "异常应答";
    builder_point => "Reading, setting or command" | "读数、参数或命令";
    builder_no_point => "None: fields as below" | "不选：直接填写下方字段";
    builder_reads => "Read" | "读";
    builder_writes => "Write" | "写";
    builder_commands => "Commands" | "命令";
    function_typed => "other…" | "其他…";
    builder_point_value(name: &str) => "Value: {name}" | "数值：{name}";

    start_address => "Start address" | "起始地址";
    register_value => "Register value" | "寄存器值";
    register_values => "Register values" | "寄存器值（多个）";
    bit_values => "Coils or inputs" | "线圈或输入";
    status_byte => "Status bits" | "状态位";
    sub_function_code => "Sub-function" | "子功能码";
    file_ranges => "File ranges" | "文件区段";
    file_records => "File records" | "文件记录";
    file_contents => "Records read" | "读出的记录";
    id_code => "Read device ID code" | "设备标识读取码";
    id_objects => "Objects" | "对象";
    busy_word => "Status word" | "状态字";

    fault_number(first: &str, last: &str) => "A whole number from {first} to {last}, decimal or hexadecimal with 0x." | "须为 {first} 到 {last} 之间的整数，十进制或以 0x 开头的十六进制。";
    fault_item(at: usize, first: &str, last: &str) => "Entry {at}: a whole number from {first} to {last}, decimal or hexadecimal with 0x." | "第 {at} 项须为 {first} 到 {last} 之间的整数，十进制或以 0x 开头的十六进制。";
    form_count(first: u16, last: u16) => "{first} to {last} entries are allowed." | "允许 {first} 到 {last} 项。";
    fault_count_exact(count: u16) => "Exactly {count} entries are needed." | "须恰好为 {count} 项。";
    fault_bit => "Only 0 and 1, one for each coil or input." | "只能填 0 和 1，每个线圈或输入一位。";
    fault_line(line: usize) => "Line {line} does not have what it needs." | "第 {line} 行的内容不符合要求。";
    fault_record => "Files count from 1, records go from 0 to 9999, and each has at least one register." | "文件号从 1 开始，记录号为 0 到 9999，每条记录至少一个寄存器。";
    form_too_long => "Too long for one frame, here or in the reply." | "过长，一帧（本帧或其应答）放不下。";
    fault_bytes => "This cannot be read as bytes." | "无法识别为字节。";

    past_the_end => "This goes past address 65535: devices answer exception 02." | "超出了最大地址 65535，设备会返回异常码 02。";
    same_as(text: &str) => "= {text}" | "= {text}";
    hint_values => "Decimal, negative or 0x; spaces or commas between" | "十进制、负数或 0x 十六进制，以空格或逗号分隔";
    hint_bits => "0 or 1 for each, the first one first" | "每位填 0 或 1，从第一个开始";
    hint_data => "Hexadecimal bytes" | "十六进制字节";
    hint_sub_functions => "0 echo, 1 restart, 2 diagnostic register, 3 ASCII delimiter, 4 listen only, 10 clear counters, 11–18 counters, 20 clear overrun" | "0 回送，1 重启通信，2 诊断寄存器，3 ASCII 结束符，4 只听模式，10 清零计数器，11–18 各计数器，20 清除溢出计数";
    hint_ranges => "In each line: file, record, number of registers" | "每行依次为：文件号、记录号、寄存器个数";
    hint_records => "In each line: file, record, values" | "每行依次为：文件号、记录号、各寄存器值";
    hint_contents => "In each line: the values of one record" | "每行为一条记录的各寄存器值";
    hint_id_code => "1 basic, 2 regular, 3 extended, 4 one object" | "1 基本，2 常规，3 扩展，4 单个对象";
    hint_objects => "In each line: number, text" | "每行依次为：编号、文本";
    value_misfit => "This value does not fit its registers." | "该数值无法用其寄存器表示。";
    value_range(first: &str, last: &str) => "from {first} to {last}" | "{first} 到 {last}";
    value_outside(first: &str, last: &str) => "The device takes {first} to {last} only." | "设备只接受 {first} 到 {last}。";

    frame => "Frame" | "报文";
    wrong_check => "Send a wrong check" | "故意使用错误的校验";
    wrong_check_tag => "check wrong on purpose" | "校验已故意改错";
    frame_incomplete => "The frame is complete once the marked fields are right." | "修正标出的字段后即可得到完整报文。";
    take_apart => "Take apart" | "解析";
    characters_many(count: usize) => "{count} characters" | "{count} 个字符";
    bytes_count(count: usize) => "{count} bytes" | "{count} 字节";
    reply_is(length: &str) => "reply {length}" | "应答 {length}";
    reply_unknown => "only the reply tells its length" | "应答长度由应答本身决定";
    reply_none => "no reply" | "无应答";

    copy_as => "Copy as" | "复制为";
    copy => "Copy" | "复制";
    copy_spelling(name: &str) => "Copy: {name}" | "复制：{name}";
    spelling_spaced => "Hex with spaces" | "十六进制（空格分隔）";
    spelling_plain => "Hex" | "十六进制（无空格）";
    spelling_c => "C array" | "C 数组";
    spelling_python => "Python bytes" | "Python 字节串";
    spelling_rust => "Rust array" | "Rust 数组";
    spelling_escaped => "\\x string" | "\\x 字符串";
    spelling_decimal => "Decimal" | "十进制";
    spelling_text => "ASCII text" | "ASCII 文本";

    calculator => "CRC and LRC" | "CRC 与 LRC 计算";
    calculator_input => "Bytes to compute the checks of" | "待计算校验的字节";
    calculator_placeholder => "Bytes in any spelling, for example 01 03 00 31 00 01" | "任意写法的字节，例如 01 03 00 31 00 01";
    calculator_empty => "Type or paste bytes: their checks appear here." | "输入或粘贴字节，此处显示其校验。";
    on_the_wire => "on the line" | "线上顺序";
    ends_with_crc => "the last two bytes are the right CRC" | "末两个字节就是正确的 CRC";
    ends_without_crc => "the last two bytes are no CRC" | "末两个字节不是 CRC";
    ends_with_lrc => "the last byte is the right LRC" | "末字节就是正确的 LRC";
    ends_without_lrc => "the last byte is no LRC" | "末字节不是 LRC";
}
