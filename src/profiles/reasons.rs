//! The loader's reasons in Chinese. The loader tells them in English, as programs and files want them; every sentence of
//! its has its like here, the braces standing for what it fills in.

/// English and Chinese.
const SENTENCES: &[(&str, &str)] = &[
    ("the text ends too early", "文本不完整，提前结束"),
    ("something follows the end of the profile", "设备描述结束后还有多余内容"),
    ("not JSON: unexpected character", "不是有效的 JSON：此处出现意外字符"),
    ("not JSON: invalid value", "不是有效的 JSON：值无效"),
    ("must be an object in braces", "须为花括号中的对象"),
    ("this key is no text", "键名不是文本"),
    ("unknown key {}; known are {}", "未知的键 {}；可用的键：{}"),
    ("the key {} stands twice", "键 {} 重复出现"),
    ("the key {} is missing", "缺少键 {}"),
    ("must be a list in brackets", "须为方括号中的列表"),
    ("is listed twice", "重复列出"),
    ("must be a text in quotes", "须为引号中的文本"),
    ("use lower-case letters, digits, - and _", "只能使用小写字母、数字、- 和 _"),
    ("must be true or false", "须为 true 或 false"),
    ("must be a whole number from 0 to {}", "须为 0 到 {} 之间的整数"),
    ("must be a whole number from -9 to 18", "须为 -9 到 18 之间的整数"),
    ("must be a number without exponent, with at most 18 decimals", "须为不带指数、小数不超过 18 位的数"),
    ("{} is none of {}", "{} 不在允许的取值之中：{}"),
    ("is not known", "未知的取值"),
    ("must be bytes in hexadecimal digits", "须为十六进制字节"),
    ("this program reads format {}", "本程序读取的格式版本为 {}"),
    ("is none of the units", "不在允许的从机地址范围内"),
    ("must not be 0", "不能为 0"),
    (
        "a group is 1 to 2000 bits read by function 1 or 2, or 1 to 125 registers by 3 or 4",
        "一组须为用功能码 1 或 2 读取的 1 到 2000 位，或用功能码 3 或 4 读取的 1 到 125 个寄存器",
    ),
    ("must be registers, read by function 3 or 4", "须为用功能码 3 或 4 读取的寄存器"),
    ("must name something to try", "须给出至少一项处理办法"),
    ("only a command leaves a device in a state", "只有命令才会使设备处于某种状态"),
    (
        "{} must be a number that can be read, with the same unit and decimals",
        "{} 须为可读的数，且单位和小数位数与此相同",
    ),
    ("only a measurement that is a number has limits", "只有数值型的测量值才有量程"),
    ("a coil or discrete input is 0xFF00 or 0, not {}", "线圈和离散输入的代码为 0xFF00 或 0，不是 {}"),
    ("what is never written has no consequence", "不能写的数据项没有写入后果"),
    ("tell what this danger costs, as consequence", "请用 consequence 写明此危险的后果"),
    ("tell what the danger of code {} costs, as consequence", "请用 consequence 写明代码 {} 的危险后果"),
    ("only whole numbers and decimals have a scale and an offset", "只有整数和定点小数才有比例和偏移"),
    ("no point lies in this group", "该组中没有任何数据项"),
    ("there is no point {}", "没有数据项 {}"),
    ("no other point scales this one: leave out decimals", "该数据项的小数位数不来自其他数据项，请去掉 decimals"),
    ("another point scales this one: tell its decimals", "该数据项的小数位数来自其他数据项，请写明 decimals"),
    ("the point that scales this one has no such value", "给出小数位数的数据项没有这个取值"),
    ("is never read", "从不读取"),
    ("these registers are {}, not {}", "这些寄存器的值是 {}，不是 {}"),
    ("these registers hold no value: {}", "这些寄存器不构成有效值：{}"),
    ("this point has {} registers", "该数据项占 {} 个寄存器"),
    ("must run upwards and end at {} at most", "须从小到大，且不超过 {}"),
    ("must run upwards", "须从小到大"),
    ("another point has the id {}", "另一个数据项已使用标识 {}"),
    ("another point is primary", "已有另一个主测量值"),
    (
        "{} must be one register that can be read, has no scale and depends on no other",
        "{} 须为可读的单个寄存器，没有比例，且不依赖其他数据项",
    ),
    (
        "only whole numbers are scaled by another point, and without decimals of their own",
        "只有自身不带小数位数的整数才能由其他数据项给出小数位数",
    ),
    ("{} has the same register and function", "{} 使用了相同的寄存器和功能码"),
    ("runs over the last register", "超出最后一个寄存器"),
    ("nothing reads it and nothing writes it", "既不能读也不能写"),
    ("a coil or discrete input is a code", "线圈和离散输入的类型须为 code"),
    ("function 6 writes one register", "功能码 6 只能写一个寄存器"),
    ("the code {} stands twice", "代码 {} 重复出现"),
    ("only the types code and bits have codes", "只有 code 和 bits 类型才有代码表"),
    ("a measurement is read by a function", "测量值须有读功能码"),
    ("what is never written has no effects", "不能写的数据项没有写入影响"),
    (
        "what the codes (number, sets) or the written number do not tell cannot be an effect",
        "无法从代码（number、sets）或写入的数值得知的内容不能作为写入影响",
    ),
    ("the code {} sets what is none of the effects", "代码 {} 所设置的内容不在写入影响之中"),
    ("must be one of {}", "须为以下之一：{}"),
    ("this type has no {}", "该类型没有 {}"),
    ("must be 1 to 16", "须为 1 到 16"),
    ("one register is ABCD, or BADC with its low byte first", "单个寄存器的字节顺序为 ABCD，低字节在前时为 BADC"),
    ("must have at least one bit", "至少须有一位"),
    ("a code has a number or a name", "代码须有数值或名称"),
];

/// A reason in Chinese; one that is not known stays as it is.
pub(crate) fn in_chinese(reason: &str) -> String {
    let fitting =
        SENTENCES.iter().filter_map(|(english, chinese)| Some((english, chinese, filled_in(english, reason)?)));
    // What is filled in may hold words of another sentence: the one that says the most itself is meant.
    let found = fitting.max_by_key(|(english, ..)| english.len());
    let Some((_, chinese, words)) = found else { return reason.to_owned() };
    let mut words = words.into_iter();
    let mut all = String::new();
    for (at, part) in chinese.split("{}").enumerate() {
        if at > 0 {
            all.push_str(words.next().unwrap_or_default());
        }
        all.push_str(part);
    }
    all
}

/// What stands in a sentence for its braces, if it is one of these.
fn filled_in<'a>(pattern: &str, sentence: &'a str) -> Option<Vec<&'a str>> {
    let mut parts = pattern.split("{}");
    let mut rest = sentence.strip_prefix(parts.next()?)?;
    let mut words = Vec::new();
    let mut parts = parts.peekable();
    while let Some(part) = parts.next() {
        // The last part is the end of the sentence.
        let at = if parts.peek().is_none() { rest.len().checked_sub(part.len())? } else { rest.find(part)? };
        let (word, behind) = (rest.get(..at)?, rest.get(at..)?);
        words.push(word);
        rest = behind.strip_prefix(part)?;
    }
    rest.is_empty().then_some(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOADER: [&str; 3] = [
        include_str!("../../codec/src/profile/load.rs"),
        include_str!("../../codec/src/profile/load/json.rs"),
        include_str!("../../codec/src/profile/load/point.rs"),
    ];

    /// The sentences in the loader's source: texts of several words, outside its tests and comments.
    fn sentences() -> Vec<String> {
        let code = LOADER.iter().map(|source| source.split("#[cfg(test)]").next().unwrap());
        let lines = code.flat_map(str::lines).map(str::trim).filter(|line| !line.starts_with("//"));
        let texts = lines.flat_map(|line| line.split('"').skip(1).step_by(2));
        texts.filter(|text| text.contains(' ') && text.contains(char::is_alphabetic)).map(plain).collect()
    }

    /// The text with nothing in its braces.
    fn plain(text: &str) -> String {
        let mut depth = 0_u32;
        let kept = text.chars().filter(|c| match c {
            '{' => {
                depth += 1;
                true
            }
            '}' => {
                depth = depth.saturating_sub(1);
                true
            }
            _ => depth == 0,
        });
        kept.collect()
    }

    #[test]
    fn every_sentence_of_the_loader_is_told_in_chinese_too() {
        let all = sentences();
        assert!(all.len() > 40, "{all:?}");
        for sentence in all {
            assert!(SENTENCES.iter().any(|(english, _)| *english == sentence), "{sentence}");
        }
        for (english, chinese) in SENTENCES {
            assert_eq!(english.matches("{}").count(), chinese.matches("{}").count(), "{english}");
            let told = in_chinese(&english.replace("{}", "x"));
            assert_eq!(told, chinese.replace("{}", "x"), "{english}");
        }
    }

    #[test]
    fn what_is_filled_in_stays() {
        assert_eq!(in_chinese("nome is none of none, odd, even"), "nome 不在允许的取值之中：none, odd, even");
        assert_eq!(in_chinese("these registers are 23.45, not 23.4"), "这些寄存器的值是 23.45，不是 23.4");
        assert_eq!(in_chinese("of tomorrow"), "of tomorrow");
    }
}
