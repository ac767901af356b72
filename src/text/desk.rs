//! The Decoder page around the frames: the text, the list's tools, the counts, the closer look.

use super::texts;

texts! {
    open_file => "Open file…" | "打开文件…";
    pasted_text => "Pasted text" | "粘贴的文本";
    size_bytes(size: &str) => "{size} bytes" | "{size} 字节";
    size_characters(size: &str) => "{size} characters" | "{size} 个字符";
    close_document => "Close" | "关闭";
    begins_with => "It begins with:" | "开头内容：";
    reading_text(percent: u32) => "Reading, {percent} %" | "正在读取，{percent} %";
    stop => "Stop" | "停止";
    stopped_at(percent: u32) => "Stopped at {percent} %. What was read stays." | "已在 {percent} % 处停止，已读取的内容保留。";
    unreadable_file(words: &str) => "The file could not be read to its end. The browser says: {words}" | "文件未能读完。浏览器报告：{words}";

    read_as_hex => "Read as hexadecimal bytes" | "按十六进制字节读取";
    read_as_decimal => "Read as decimal bytes" | "按十进制字节读取";
    read_as_ascii => "Read as ASCII frames" | "按 ASCII 报文读取";
    read_as_log => "Read as a log with directions and times" | "按带方向和时间的日志读取";
    read_as_dump => "Read as a hex dump" | "按十六进制转储读取";
    read_as_words => "Read as a dump of 16-bit words" | "按 16 位字转储读取";
    read_as_session => "Read as a saved session" | "按已保存的会话读取";
    instead_hex => "Hexadecimal instead" | "改为十六进制";
    instead_decimal => "Decimal instead" | "改为十进制";
    instead_ascii => "ASCII frames instead" | "改为 ASCII 报文";
    instead_log => "Log instead" | "改为日志";
    instead_dump => "Hex dump instead" | "改为十六进制转储";
    instead_words => "16-bit words instead" | "改为 16 位字";
    instead_session => "A saved session instead" | "改为已保存的会话";
    faults_more(count: &str) => "and {count} more places" | "另有 {count} 处";
    too_large => "this number fits no byte" | "该数超出一个字节的范围";
    not_text => "this is not text: raw bytes or a binary file. What looks like text was read." | "这不是文本，而是原始字节或二进制文件。其中像文本的部分已读取。";
    repeat_too_long => "this repetition stands for more than can be taken in" | "此处省略的重复内容过多，未能展开";
    no_bytes => "no bytes in this text" | "文本中没有字节";

    profile => "Device" | "设备";
    profile_auto => "Find out" | "自动识别";
    profile_auto_is(name: &str) => "Found: {name}" | "识别为：{name}";
    profile_none => "None: registers only" | "不指定，仅显示寄存器";
    filter_unit => "Unit" | "地址";
    filter_function => "Function" | "功能码";
    filter_text => "Bytes, point or fault" | "字节、参数名或错误";
    filter_errors => "Errors only" | "仅看错误";
    filter_empty => "Nothing fits the filter." | "没有符合筛选条件的报文。";
    clear_filter => "Clear filter" | "清除筛选";
    shown_of(shown: &str, all: &str) => "{shown} of {all}" | "{shown} / {all}";
    export => "Export" | "导出";
    export_jsonl => "JSON Lines" | "JSON Lines 文件";
    export_csv => "CSV table" | "CSV 表格";
    export_hex => "Hex text" | "十六进制文本";
    copy_link => "Copy link" | "复制链接";
    copied_link => "Link copied" | "链接已复制";
    link_too_long => "Too long for a link" | "内容过长，无法生成链接";

    time => "Time" | "时间";
    line_number(line: u32) => "line {line}" | "第 {line} 行";
    offset_is(offset: &str) => "byte {offset}" | "字节 {offset}";
    unanswered => "no answer" | "无应答";
    orphan => "no request" | "无请求";
    more_bytes(count: &str) => "… {count} bytes" | "… 共 {count} 字节";
    to_pair => "Other half" | "对应报文";
    copy_hex => "Hex" | "十六进制";
    copy_c => "C array" | "C 数组";
    copy_json => "JSON" | "JSON 格式";
    copy_markdown => "Markdown" | "Markdown 表格";

    diagnosis => "What is wrong" | "问题分析";
    repaired_frame => "Probably meant:" | "可能的原报文：";
    take_repaired => "Take this apart" | "解析此报文";

    registers_views => "What the registers could mean" | "寄存器的各种解读";
    shown_label => "Shown on the device" | "设备显示值";
    shown_hint => "Type what the device's own display shows: the encodings that give this number are listed." | "输入设备自身显示的数值，列出能得到该数值的编码。";
    shown_not_number => "Type a number such as 123.456." | "请输入数字，例如 123.456。";
    fits_none => "No encoding of these registers gives this number." | "这些寄存器的任何编码都得不到该数值。";
    encoding => "Encoding" | "编码";
    decimals => "Decimals" | "小数位";
    first_register => "From register" | "起始寄存器";
    nth_register(number: u32) => "register {number} of the frame" | "报文第 {number} 个寄存器";

    statistics => "Counts" | "统计";
    count_frames => "Frames" | "报文";
    count_requests => "Requests" | "请求";
    count_responses => "Responses" | "应答";
    count_exceptions => "Exceptions" | "异常应答";
    count_damaged => "Damaged" | "校验错误";
    count_unanswered => "Unanswered" | "无应答";
    count_orphans => "Without request" | "无对应请求";
    count_noise => "Noise bytes" | "杂散字节";
    all_units => "All" | "全部";
    by_function => "By function" | "按功能码";
    by_diagnosis => "By fault" | "按错误类型";
}
