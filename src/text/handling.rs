//! What can be done with the device that is being read: commands, limits, notes.

use super::texts;

texts! {
    handling => "Operation" | "操作";
    commands_locked_read_only => "“Read only” is on: nothing that writes is sent. Switch it off at the top of the page." | "“只读”已打开：不会发送任何写操作。可在页面顶部关闭。";
    commands_locked_replay => "A recording is played: there is no device to be told anything." | "正在回放记录：没有可以接收命令的设备。";
    commands_locked_closed => "The port is not open." | "串口未打开。";
    commands_risky => "Commands that can lose settings" | "可能丢失设置的命令";
    command_of(name: &str, what: &str) => "{name}: {what}" | "{name}：{what}";
    command_ask(name: &str) => "{name}?" | "{name}？";
    command_cancel => "Cancel" | "取消";
    command_accept => "This will happen, and I want it:" | "我已知晓并同意以下后果：";
    command_sending(name: &str) => "{name}: being sent…" | "{name}：正在发送…";
    command_done(name: &str, time: &str) => "{name}: done at {time}. The device has confirmed it." | "{name}：已于 {time} 完成，设备已确认。";
    command_refused(name: &str, code: u8, meaning: &str) => "{name}: the device refused it by exception {code:02} ({meaning}). Nothing has changed." | "{name}：设备以异常码 {code:02} 拒绝（{meaning}），未作任何改动。";
    command_unproven(name: &str) => "{name}: no answer that could be read. The device may or may not have done it; it was not sent again." | "{name}：没有收到可识别的应答。设备可能已执行，也可能没有；未重复发送。";
    command_unproven_tip => "Look at the reading: has it changed? Then check supply and wiring, and send it again if it has not." | "请看读数是否已变化；若未变化，检查电源和接线后重新发送。";
    command_not_sent(name: &str) => "{name}: not sent." | "{name}：未发送。";
    command_busy => "Something else is being done on the line. Wait until it has ended, or stop it." | "线路上正在进行其他操作，请等待其结束或先停止。";
    command_not_kept => "The browser could not keep a record of it, and without one nothing is written. A private window or a full disk may be why." | "浏览器无法保存操作记录；没有记录就不会写入。可能是隐私窗口或磁盘已满。";
    command_cancelled => "It was stopped before it was sent." | "在发送之前已停止。";
    command_no_answer(name: &str) => "{name}: not sent, because the device does not answer. Check supply, wiring and settings." | "{name}：设备没有应答，因此未发送。请检查电源、接线和通信参数。";
    command_interrupted(name: &str) => "{name}: the port was closed or unplugged meanwhile. Connect again and look at the reading." | "{name}：期间串口被关闭或拔出。请重新连接并查看读数。";
    command_lost(name: &str) => "{name}: sent, and the device does not answer any more where it was looked for." | "{name}：已发送，但在已查找的设置下设备不再应答。";
    command_frames => "Frames" | "报文";

    hazard_defaults => "All settings become those of the factory, unit id and baud rate among them." | "所有设置恢复为出厂值，包括地址和波特率。";
    hazard_search => "Unit id, line settings and calibration may all be different afterwards; the device must be searched." | "之后地址、串口参数和校准数据都可能改变，必须重新搜索设备。";
    hazard_grave => "This loses settings or a calibration that cannot be brought back." | "将丢失无法恢复的设置或校准数据。";
    hazard_reserved_unit(unit: u8) => "Address {unit} is reserved by the Modbus standard: other masters may not reach the device." | "地址 {unit} 为 Modbus 标准的保留地址，其他主站可能无法访问该设备。";
    hazard_slow_baud(baud: u32) => "At {baud} Bd every exchange takes long." | "{baud} 波特率下每次通信都很慢。";
    hazard_broadcast => "Address 0: every device on the line takes this." | "地址 0：总线上的所有设备都会执行。";

    mark_since(what: &str, time: &str) => "{what} {time}" | "{time} {what}";

    range_of(name: &str) => "{name} within its range" | "{name}在量程中的位置";
    range_percent(percent: &str) => "{percent} % of the range" | "量程的 {percent}%";
    range_unknown => "The range has not been read yet." | "尚未读到量程。";
    notes_of_device => "Notes on this device" | "设备说明";
    note_of(name: &str, note: &str) => "{name}: {note}" | "{name}：{note}";
}
