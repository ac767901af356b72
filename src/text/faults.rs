//! What went wrong and what to try.

use super::texts;

texts! {
    what_to_try => "What to try" | "可以这样处理";
    change_settings => "Disconnect and change settings" | "断开并修改设置";
    dismiss => "Close" | "关闭";

    no_web_serial => "This browser cannot use serial ports" | "此浏览器不支持串口";
    no_web_serial_what => "It has no Web Serial. Everything else works, and the simulated sensor can be tried." | "它没有 Web Serial 功能。其他功能可以照常使用，也可以先用模拟传感器试用。";
    no_web_serial_browser => "Open this page in Chrome, Edge or Opera 89 or newer on a computer, or in Firefox 151 or newer." | "请在电脑上用 Chrome、Edge 或 Opera 89 及以上版本打开本页，也可以用 Firefox 151 及以上版本。";
    no_web_serial_phone => "On a phone: Chrome for Android 148 or newer." | "在手机上请用 Android 版 Chrome 148 及以上版本。";
    no_web_serial_policy => "If the browser is new enough, its administrator may have switched serial ports off." | "如果浏览器版本足够新，可能是管理员用策略禁用了串口。";

    insecure => "This address is not secure, so the browser offers no serial ports" | "当前网址不安全，浏览器不提供串口";
    insecure_what => "Browsers allow serial ports only on pages that come over https or from this computer." | "浏览器只允许通过 https 打开的页面或本机页面使用串口。";
    insecure_https => "Open this page with https:// instead of http://." | "请用 https:// 而不是 http:// 打开本页。";
    insecure_localhost => "Or run it on this computer and open http://localhost." | "或者在本机运行，然后打开 http://localhost。";

    policy => "This page may not use serial ports here" | "本页在此处无权使用串口";
    policy_what => "It stands inside another page that has not passed on the permission, or an administrator's rule forbids it." | "本页嵌在另一个没有授予串口权限的页面里，或者被管理员策略禁止。";
    policy_own_tab => "Open this page in a tab of its own." | "请在单独的标签页中打开本页。";
    policy_embed => "Whoever embeds it must allow \"serial\" on the frame." | "嵌入方须在框架上允许 \"serial\" 权限。";
    policy_admin => "Ask the administrator about the rule DefaultSerialGuardSetting." | "请向管理员确认 DefaultSerialGuardSetting 策略。";

    picker_closed => "No port was chosen" | "没有选择串口";
    picker_closed_what => "The browser's list was closed without a choice. If your adapter was not on it:" | "浏览器的串口列表已关闭，但没有选择。如果列表中没有您的适配器：";
    picker_cable => "Plug the adapter in again, straight into the computer. Some USB cables only charge." | "重新插拔适配器，直接插到电脑上。有些 USB 线只能充电，不能传数据。";
    picker_driver => "Install its driver: CH340/CH341 (WCH), CP210x (Silicon Labs), FTDI or PL2303 (Prolific). Windows shows an adapter without a driver in the device manager." | "安装驱动：CH340/CH341（沁恒）、CP210x（Silicon Labs）、FTDI 或 PL2303（Prolific）。在 Windows 设备管理器中可以看到没有驱动的适配器。";
    picker_linux => "On Linux add yourself to the group dialout (on Arch: uucp) and log in again." | "在 Linux 上把当前用户加入 dialout 组（Arch 为 uucp 组），然后重新登录。";

    busy => "The port is in use" | "串口被占用";
    busy_what(port: &str) => "{port} could not be opened: another program or page holds it, or its driver refuses." | "无法打开 {port}：它正被其他程序或页面占用，或者驱动拒绝访问。";
    busy_close => "Close other programs that use it: the maker's tool, a serial terminal, a PLC tool, another tab with this page." | "关闭占用它的其他程序：厂家软件、串口助手、PLC 编程软件，或打开了本页的其他标签页。";
    busy_replug => "Unplug the adapter, wait two seconds, plug it in again." | "拔下适配器，等待两秒后重新插上。";
    busy_linux => "On Linux your user must be in the group dialout (on Arch: uucp)." | "在 Linux 上，当前用户必须属于 dialout 组（Arch 为 uucp 组）。";

    missing => "The adapter is not plugged in" | "适配器未插入";
    missing_what(port: &str) => "{port} was there before, but is not any more." | "{port} 之前存在，但现在找不到了。";
    missing_plug => "Plug the adapter in and connect again." | "插入适配器后重新连接。";
    missing_choose => "If it is plugged in, choose it again." | "如果已经插好，请重新选择串口。";

    forbidden => "The browser forbids this port" | "浏览器禁止使用该串口";
    forbidden_what(port: &str) => "The permission for {port} is missing or was taken back." | "没有使用 {port} 的权限，或权限已被收回。";
    forbidden_choose => "Choose the port again to give the permission." | "重新选择串口以授予权限。";
    forbidden_admin => "On a managed computer ask the administrator to allow serial ports for this page." | "如果是受管理的电脑，请联系管理员允许本页使用串口。";

    unsupported => "The adapter does not know these settings" | "适配器不支持这些设置";
    unsupported_what(port: &str, line: &str) => "The driver of {port} refuses {line}." | "{port} 的驱动不接受 {line}。";
    unsupported_standard => "Use a standard baud rate, such as 9600 or 115200." | "请使用标准波特率，例如 9600 或 115200。";
    unsupported_bits => "Use 8 data bits and 1 stop bit." | "请使用 8 个数据位和 1 个停止位。";

    not_loaded => "The simulated sensor could not be loaded" | "无法加载模拟传感器";
    not_loaded_what => "It is a part of this page that is fetched when it is first used, and it did not arrive." | "它是本页的一部分，首次使用时才会加载，但这次没有加载成功。";
    not_loaded_network => "Check the network connection, then try again." | "检查网络连接，然后重试。";
    not_loaded_reload => "If that does not help, reload the page: a newer version may have replaced this one." | "如果仍然不行，请重新加载页面：网站可能已更新为新版本。";

    open_other => "The port could not be opened" | "无法打开串口";
    open_other_what(words: &str) => "The browser says: {words}" | "浏览器报告：{words}";
    pick_other => "The list of ports could not be shown" | "无法显示串口列表";

    silence(unit: u8) => "No answer from unit {unit}" | "地址 {unit} 没有应答";
    silence_broadcast => "No answer to the broadcast address" | "广播地址没有应答";
    silence_what(settings: &str) => "The port is open, but nothing comes back at {settings}." | "串口已打开，但在 {settings} 下收不到任何数据。";
    try_power => "Is the sensor powered?" | "传感器是否已供电？";
    try_power_of(supply: &str) => "Is the sensor powered? It needs {supply}." | "传感器是否已供电？需要{supply}。";
    supply_between(supply: &str, plus: &str, minus: &str) => "{supply} between {plus} (V+) and {minus} (V−)" | "在{plus}线（V+）与{minus}线（V−）之间提供 {supply}";
    try_swap => "Swap A and B: swapped wires are the most frequent cause, and do no harm." | "对调 A、B 两线：这是最常见的原因，接反不会损坏设备。";
    try_swap_of(a: &str, b: &str) => "Swap A ({a}) and B ({b}): swapped wires are the most frequent cause, and do no harm." | "对调 A（{a}线）和 B（{b}线）：这是最常见的原因，接反不会损坏设备。";
    try_unit(unit: u8) => "Is the unit id {unit}? It is printed on the housing." | "从机地址是 {unit} 吗？地址印在外壳上。";
    try_settings(settings: &str, factory: &str) => "Do baud rate, parity and mode match the sensor? Now: {settings}. Factory default: {factory}." | "波特率、奇偶校验和传输模式是否与传感器一致？当前：{settings}，出厂默认：{factory}。";
    try_termination => "On a long cable: fit 120 Ω between A and B at both ends, and connect the grounds." | "线缆较长时：在两端 A、B 之间各接 120 Ω 终端电阻，并连接两端的地线。";

    garbage => "Bytes come back, but they make no frame" | "收到数据，但无法组成报文";
    garbage_what(settings: &str) => "Most often baud rate or parity are wrong. Now: {settings}." | "最常见的原因是波特率或奇偶校验不对。当前：{settings}。";
    try_other_baud(factory: &str) => "Try the factory default first ({factory}), then other baud rates and parities." | "先试出厂默认值（{factory}），再试其他波特率和奇偶校验。";
    try_any_baud => "Try other baud rates and parities." | "试试其他波特率和奇偶校验。";
    try_noise => "Noise on A and B: keep the cable away from motors and inverters, and connect the shield at one end." | "A、B 线上有干扰：线缆应远离电机和变频器，屏蔽层单端接地。";
    try_one_sensor => "Do two devices share this address? Then both answer at once." | "总线上是否有两台设备地址相同？它们会同时应答。";

    bad_check => "Replies come with a wrong check" | "应答的校验码错误";
    bad_check_what => "The frame has the right shape, but bytes were changed on the way. Such replies are not shown as readings." | "报文格式正确，但传输中有字节出错。这类应答不会作为读数显示。";

    exception(code: u8) => "The sensor answers with exception {code:02}" | "传感器返回异常码 {code:02}";
    exception_what(unit: u8, function: u8, name: &str) => "Unit {unit} is there and understands the frame, but refuses function {function:02}: {name}." | "地址 {unit} 的设备在线，也能识别报文，但拒绝了功能码 {function:02}：{name}。";
    exception_1 => "function not supported" | "不支持该功能码";
    exception_2 => "wrong data address" | "数据地址错误";
    exception_3 => "value out of range" | "数值超出范围";
    exception_4 => "device failure" | "设备故障";
    exception_5 => "accepted, still working" | "已接受，正在处理";
    exception_6 => "device busy" | "设备忙";
    exception_7 => "negative acknowledge" | "否定应答";
    exception_8 => "memory parity error" | "存储器奇偶校验错误";
    exception_10 => "gateway path unavailable" | "网关路径不可用";
    exception_11 => "target behind the gateway does not answer" | "网关后的目标设备没有应答";
    exception_other => "unknown reason" | "未知原因";
    try_profile => "Is this the device chosen in the settings? Another device has other registers." | "设备型号是否选对？不同设备的寄存器不同。";
    try_restart => "Switch the sensor off and on, and wait two seconds." | "将传感器断电后重新上电，等待两秒。";
    try_wait => "Wait a moment: reading goes on by itself." | "请稍候，读取会自动继续。";

    late => "Replies come too late" | "应答太迟";
    late_what => "It is no longer sure which request they answer, so they are not shown as readings." | "无法确定应答对应哪个请求，因此不作为读数显示。";
    try_slower => "Read less often: set a longer period." | "降低读取频率：设置更长的读取周期。";
    try_latency => "FTDI adapters: set the latency timer to 1 ms in the driver." | "FTDI 适配器：在驱动中把延迟定时器（Latency Timer）设为 1 ms。";
    try_gateway => "Radio or network converters on the way add delay." | "途中的无线模块或网络转换器会增加延迟。";

    bad_value => "The reply holds a value that this device cannot have" | "应答中的数值不符合该设备的格式";
    bad_value_what => "The check is right, but the value breaks the format of the chosen device. It is not shown." | "校验正确，但数值不符合所选设备的数据格式，因此不予显示。";

    lost => "The adapter was unplugged" | "适配器已拔出";
    lost_what(port: &str) => "{port} is gone. Plug it in again: reading resumes by itself." | "{port} 已断开。重新插上后会自动继续读取。";
    lost_socket => "If this happens without a hand on it: check plug and cable, and avoid unpowered hubs." | "如果没有碰它也会断开：请检查插头和线缆，不要使用无源集线器。";
}

impl super::Language {
    /// What an exception code means, in a few words.
    pub(crate) fn exception_name(self, code: u8) -> &'static str {
        match code {
            1 => self.exception_1(),
            2 => self.exception_2(),
            3 => self.exception_3(),
            4 => self.exception_4(),
            5 => self.exception_5(),
            6 => self.exception_6(),
            7 => self.exception_7(),
            8 => self.exception_8(),
            10 => self.exception_10(),
            11 => self.exception_11(),
            _ => self.exception_other(),
        }
    }
}
