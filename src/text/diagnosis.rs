//! What is wrong with a frame, and what causes it on a line.

use super::texts;

texts! {
    bit_turned => "One bit was turned over on the way" | "传输中有一位翻转";
    bit_turned_in_byte(number: usize, found: &str, right: &str, bit: u8) => "Byte {number} came as {found} instead of {right}: with bit {bit} turned back, the check is right." | "第 {number} 个字节收到的是 {found}，应为 {right}：把位 {bit} 翻转回来，校验就正确。";
    bit_turned_in_character(number: usize, found: &str, right: &str, bit: u8) => "Character {number} came as {found} instead of {right}: with bit {bit} turned back, the check is right." | "第 {number} 个字符收到的是 {found}，应为 {right}：把位 {bit} 翻转回来，校验就正确。";
    bit_turned_cause => "Usual causes: interference on the cable, a missing terminating resistor, missing bias or ground." | "常见原因：线缆受到干扰、缺少终端电阻、缺少偏置电阻或未接公共地。";

    crc_swapped => "The two bytes of the CRC are swapped" | "CRC 的两个字节颠倒";
    crc_swapped_cause => "The program that built this frame sends the CRC's high byte first. On the line the low byte comes first; no device answers the frame as it is." | "生成该报文的程序先发送了 CRC 的高字节。线路上应先发送低字节；按现在的顺序，设备不会应答。";

    byte_missing => "A byte is missing" | "缺少一个字节";
    byte_missing_at(number: usize, right: &str) => "{right} got lost at place {number}: with it, the check is right." | "位置 {number} 处丢失了 {right}：补上后校验正确。";
    byte_missing_somewhere => "With one byte more the check would be right, but several places would do." | "补上一个字节后校验正确，但有多个位置都可能。";
    byte_missing_cause => "Usual causes: the receiver was overrun, a wrong parity setting drops bytes, or the line was turned around too late or too early." | "常见原因：接收缓冲溢出、奇偶校验设置错误导致字节被丢弃、收发切换过早或过晚。";
    byte_extra => "There is a byte too many" | "多出一个字节";
    byte_extra_at(number: usize, found: &str) => "{found} at place {number} does not belong there: without it, the check is right." | "位置 {number} 处多出 {found}：去掉后校验正确。";
    byte_extra_somewhere => "With one byte less the check would be right, but several places would do." | "去掉一个字节后校验正确，但有多个位置都可能。";
    byte_extra_cause => "Usual causes: a stray byte while the line is turned around, a missing bias that lets the idle line float, or interference." | "常见原因：收发切换时产生的杂散字节、缺少偏置电阻使空闲总线电平浮动、线缆受到干扰。";

    crc_wrong => "The CRC is wrong" | "CRC 错误";
    lrc_wrong => "The LRC is wrong" | "LRC 错误";
    check_for_these_bytes(expected: &str) => "For these bytes as they stand it should be {expected}. No device answers such a frame, and a master must drop it." | "按现有字节计算应为 {expected}。设备不会应答这样的报文，主站也必须丢弃它。";
    lrc_in_rtu => "An RTU frame with the check of ASCII mode" | "RTU 报文使用了 ASCII 模式的校验";
    lrc_in_rtu_cause => "It ends with an LRC where a CRC belongs: its sender mixes up the two modes. Set the program to RTU, or send the frame as ASCII characters." | "报文末尾是 LRC，而不是 CRC：发送方混淆了两种模式。请把程序设为 RTU，或把报文改为 ASCII 字符发送。";
    crc_in_ascii => "An ASCII frame with the check of RTU mode" | "ASCII 报文使用了 RTU 模式的校验";
    crc_in_ascii_cause => "It ends with a CRC where an LRC belongs: its sender mixes up the two modes. Set the program to ASCII, or send the bytes as RTU." | "报文末尾是 CRC，而不是 LRC：发送方混淆了两种模式。请把程序设为 ASCII，或按 RTU 方式发送。";
    not_hex => "A character that is no hexadecimal digit" | "含有非十六进制字符";
    not_hex_at(number: usize, found: &str) => "Character {number} is {found}; between colon and line end only 0 to 9 and A to F may stand." | "第 {number} 个字符是 {found}；冒号与行尾之间只允许 0–9 和 A–F。";
    not_hex_cause => "Usual causes: interference, or 8 data bits on one side and 7 on the other." | "常见原因：线缆受到干扰，或一端为 8 个数据位而另一端为 7 个。";
    digits_odd => "A digit without its twin" | "有一个数字不成对";
    digits_odd_what => "Two characters make a byte, but their number is odd: one got lost or one was added." | "两个字符表示一个字节，但字符个数为奇数：丢失或多出了一个字符。";
    cut_off => "The frame ends too early" | "报文不完整";
    cut_off_of(found: usize, expected: usize) => "{found} bytes came of {expected}." | "应有 {expected} 字节，只收到 {found} 字节。";
    cut_off_characters_of(found: usize, expected: usize) => "{found} characters came of {expected}." | "应有 {expected} 个字符，只收到 {found} 个。";
    cut_off_cause => "Usual causes: a time-out that is too short, a pause within the frame, or a USB adapter that hands its bytes over in portions, so that the frame was cut where a portion ended." | "常见原因：超时时间太短、报文中间出现停顿，或 USB 适配器分批交付数据，使报文在批次边界处被切断。";

    echo => "The adapter hears itself" | "适配器收到自己发送的数据";
    echo_what => "This is the request again, before the reply. Adapters with two wires do so where the receiver stays on while sending. It does no harm as long as the master leaves it out; many adapters have a switch for it." | "这是请求的回波，出现在应答之前。两线制适配器在发送时不关闭接收就会这样。只要主站忽略它就没有影响；许多适配器可以用开关或跳线关闭回波。";
    byte_count_wrong => "The byte count does not fit" | "字节数与报文不符";
    byte_count_wrong_what(found: u8, expected: usize) => "It says {found}, but should be {expected} by the length of the frame or by what was asked." | "报文中写的是 {found}，按报文长度或请求的数量应为 {expected}。";
    byte_count_wrong_cause => "Usual causes: a fault in the program that built the frame, or a late reply to another request." | "常见原因：生成该报文的程序有误，或这是对另一个请求的迟到应答。";
    unit_is_reserved_title(unit: u8) => "Unit id {unit} is reserved" | "从机地址 {unit} 是保留地址";
    unit_is_reserved_what => "The standard keeps 248 to 255 for later use; most devices do not answer there." | "标准保留了地址 248 到 255，多数设备不会应答。";
    unit_taken_here => "The chosen device takes this unit id; others on the same line may not." | "所选设备支持该地址，但同一总线上的其他设备可能不支持。";
    unit_not_taken(first: u16, last: u16) => "The chosen device takes {first} to {last}." | "所选设备的地址范围是 {first} 到 {last}。";
    value_not_allowed => "A value that the device does not allow" | "数值不在设备允许的范围内";
    value_is(name: &str, value: &str) => "{name} is {value}." | "{name}的值为 {value}。";
    value_may_be(allowed: &str) => "Allowed: {allowed}." | "允许值：{allowed}。";
    value_has_no_format(name: &str, found: &str) => "{name} is written as {found}, which is none of its values." | "{name}的原始数据为 {found}，不是合法的数值。";
    value_cause => "Is this the chosen device? Another one keeps other data in these registers." | "请确认所选设备是否正确；其他设备的这些寄存器内容不同。";
    manual_is_wrong => "The manual prints this frame, and prints it wrong" | "说明书中的该报文印刷有误";
    manual_right_frame(right: &str) => "Right is {right}: the device takes this one." | "正确的报文是 {right}，设备以此为准。";

    refused(code: u8, name: &str) => "Refused with exception {code:02}: {name}" | "请求被拒绝，异常码 {code:02}：{name}";
    refused_function(function: &str, name: &str) => "The device refuses function {function} ({name})." | "设备拒绝了功能码 {function}（{name}）。";
    refused_1 => "It does not know this function, or not in its present state. Its manual lists those that it knows." | "设备不支持该功能码，或当前状态下不支持。支持的功能码见设备说明书。";
    refused_2 => "There is no such register or coil, or there are not so many from there on. Check address and quantity; some manuals count from 1, the frame counts from 0." | "没有这样的寄存器或线圈，或从该地址起没有这么多。请检查地址和数量；有的说明书从 1 开始编号，而报文从 0 开始。";
    refused_3 => "The quantity or the value is none that it takes." | "数量或数值不被设备接受。";
    refused_4 => "It failed while it did so. Switch it off and on; if that does not help, it is defective." | "设备在执行时出错。请断电后重新上电；如果仍然如此，设备可能已损坏。";
    refused_5 => "It has taken the command and needs more time: ask later whether it is done." | "设备已接受命令，但需要更长时间处理；请稍后再查询是否完成。";
    refused_6 => "It is busy with a long command: repeat the request later." | "设备正忙于执行耗时的命令；请稍后重发请求。";
    refused_8 => "The check of its file memory failed: the record is damaged." | "设备的文件存储区校验失败，记录已损坏。";
    refused_10 => "The gateway has no way to the target: it is set up wrongly or overloaded." | "网关没有通往目标设备的路径：配置错误或负载过高。";
    refused_11 => "The gateway got no answer from the target: it is off, or has another unit id." | "网关没有收到目标设备的应答：设备未上电或地址不对。";
    refused_other => "The standard does not name this code; the device's manual may." | "标准没有定义该异常码，请查阅设备说明书。";
    only_functions(functions: &str) => "By its profile the chosen device knows only the functions {functions}." | "根据设备描述文件，所选设备只支持功能码 {functions}。";
    written_with(name: &str, functions: &str, function: &str) => "{name} is written with function {functions}, not with {function}." | "{name}的写功能码是 {functions}，不是 {function}。";
    read_with(name: &str, functions: &str, function: &str) => "{name} is read with function {functions}, not with {function}." | "{name}的读功能码是 {functions}，不是 {function}。";
    only_read(name: &str) => "{name} can be read, but not written." | "{name}只能读取，不能写入。";
    only_written(name: &str) => "{name} can be written, but not read." | "{name}只能写入，不能读取。";
    belongs_together(name: &str, count: usize, address: &str) => "{name} takes {count} registers from {address} on: they go together in one request." | "{name}占用从 {address} 起的 {count} 个寄存器，必须在一次请求中一起读写。";
    goes_over_gap(place: &str) => "The request goes over {place}, which the chosen device does not have: ask for what stands before it and behind it in two requests." | "请求范围包含了所选设备没有的{place}；请把它前后的部分分成两次请求。";
    nothing_there(place: &str) => "The chosen device has nothing at {place} for this function." | "所选设备在该功能码下没有{place}。";
    not_in_one_read(names: &str) => "The profile does not promise that these can be read at once: {names}. Read them one by one." | "设备描述文件没有说明以下各项可以一次读出：{names}。请逐个读取。";
    value_refused(name: &str, value: &str) => "{name} does not take {value}." | "{name}不接受 {value}。";
}
