//! Makes CSS and scripts smaller without understanding them: comments and needless white space go, everything else stays.

/// Removes lines that are nothing but a comment, empty lines, and the space at both ends of the others. Texts in backticks
/// that run over several lines stay as they are.
pub(crate) fn js(source: &str) -> String {
    let mut out = String::with_capacity(source.len());
    let (mut in_comment, mut in_text) = (false, false);
    for line in source.lines() {
        let bare = line.trim();
        if in_comment || (!in_text && bare.starts_with("/*")) {
            in_comment = !bare.ends_with("*/");
            continue;
        }
        if !in_text && (bare.is_empty() || bare.starts_with("//")) {
            continue;
        }
        let begins_in_text = in_text;
        in_text ^= line.matches('`').count() % 2 == 1;
        out += match (begins_in_text, in_text) {
            (false, false) => bare,
            (false, true) => line.trim_start(),
            (true, false) => line.trim_end(),
            (true, true) => line,
        };
        out.push('\n');
    }
    out
}

/// Removes comments and white space that have no meaning. Strings and `url(...)` stay as they are.
pub(crate) fn css(source: &str) -> String {
    let mut out = String::with_capacity(source.len());
    let mut rest = source;
    // White space was read and not yet written; a comment without white space still parts two words.
    let (mut space, mut comment) = (false, false);
    while let Some(next) = rest.chars().next() {
        if next.is_ascii_whitespace() {
            space = true;
            rest = &rest[1..];
            continue;
        }
        if let Some(body) = rest.strip_prefix("/*") {
            comment = true;
            rest = body.split_once("*/").map_or("", |(_, after)| after);
            continue;
        }
        let last = out.chars().next_back();
        let needless = last.is_none_or(|last| "{};,:(".contains(last)) || "{};,)".contains(next);
        if space && !needless {
            out.push(' ');
        } else if comment && !space && !needless {
            out += "/**/";
        }
        (space, comment) = (false, false);
        if next == '}' && out.ends_with(';') {
            out.pop();
        }
        let length = token_length(rest, next);
        out += &rest[..length];
        rest = &rest[length..];
    }
    out
}

/// Bytes of `text` that must stay together: a string, an unquoted `url(...)`, an escape or one character.
fn token_length(text: &str, first: char) -> usize {
    match first {
        '"' | '\'' => {
            let mut escaped = false;
            let end = text.char_indices().skip(1).find(|&(_, c)| {
                let ends = c == first && !escaped;
                escaped = c == '\\' && !escaped;
                ends
            });
            end.map_or(text.len(), |(at, c)| at + c.len_utf8())
        }
        '\\' => text.chars().take(2).map(char::len_utf8).sum(),
        'u' | 'U' if text.get(..4).is_some_and(|word| word.eq_ignore_ascii_case("url(")) => {
            if text[4..].trim_start().starts_with(['"', '\'']) {
                4
            } else {
                text.find(')').map_or(text.len(), |at| at + 1)
            }
        }
        _ => first.len_utf8(),
    }
}

#[cfg(test)]
mod tests {
    use super::{css, js};

    #[test]
    fn comments_and_indentation_of_a_script_go() {
        let source =
            "/**\n * @param {any} x\n */\nfunction f(x) {\n    // why\n    return x; // kept\n\n}\n/* one */\n";
        assert_eq!(js(source), "function f(x) {\nreturn x; // kept\n}\n");
    }

    #[test]
    fn a_text_over_several_lines_stays() {
        let source = "  const a = `one\n    // two\n\n  three`;\n  b();\n";
        assert_eq!(js(source), "const a = `one\n    // two\n\n  three`;\nb();\n");
    }

    #[test]
    fn layout_goes() {
        assert_eq!(
            css("a {\n  color: red;\n  margin: 0 1px;\n}\n\nb , i { top: 0 }\n"),
            "a{color:red;margin:0 1px}b,i{top:0}"
        );
    }

    #[test]
    fn white_space_with_a_meaning_stays() {
        assert_eq!(css("a :hover > b { width: calc(1px + 2px) }"), "a :hover > b{width:calc(1px + 2px)}");
        assert_eq!(
            css("@media (width > 1px) and (height > 2px) { a { b: c } }"),
            "@media (width > 1px) and (height > 2px){a{b:c}}"
        );
    }

    #[test]
    fn comments_go_but_keep_words_apart() {
        assert_eq!(css("/* one */a/* two */{b:c/* three */}"), "a{b:c}");
        assert_eq!(css("a/*.*/.b{c:d}"), "a/**/.b{c:d}");
        assert_eq!(css("a /*.*/ .b{c:d}/* open"), "a .b{c:d}");
    }

    #[test]
    fn strings_and_addresses_stay() {
        let same = r#"a{content:"/*  \"x  */ ;";background:url(data:image/png;base64,/*==);quotes:'  {' '}  '}"#;
        assert_eq!(css(same), same);
        assert_eq!(css(r#"a{background:url( "b  c" )}"#), r#"a{background:url("b  c")}"#);
    }

    #[test]
    fn result_is_stable() {
        let once =
            css("@layer base { :root { --a : 1px ; } .x\\:y > :is( a , b ) { margin : -1px calc( 2 * var( --a ) ) } }");
        assert_eq!(css(&once), once);
    }
}
