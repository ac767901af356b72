//! The user's own sequences, and how they are kept on this computer: a line `=name` before each, a space before each of
//! its lines.

/// The most that are kept.
const MOST: usize = 200;
/// The longest name, in characters.
pub(crate) const LONGEST_NAME: usize = 80;

/// A sequence with its name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Own {
    /// One line; unique.
    pub(crate) name: String,
    /// The sequence's text.
    pub(crate) text: String,
}

/// All of them as one text.
pub(crate) fn write(all: &[Own]) -> String {
    let mut kept = String::new();
    for Own { name, text } in all {
        for part in ["=", name, "\n"] {
            kept.push_str(part);
        }
        for line in text.split('\n') {
            for part in [" ", line, "\n"] {
                kept.push_str(part);
            }
        }
    }
    kept
}

/// What [`write`] wrote. What it cannot have written is left out.
pub(crate) fn read(kept: &str) -> Vec<Own> {
    let mut all: Vec<Own> = Vec::new();
    let mut begun = false;
    for line in kept.split('\n') {
        if let Some(name) = line.strip_prefix('=') {
            if all.len() >= MOST {
                break;
            }
            let name = free_name(&all, &clean_name(name));
            all.push(Own { name, text: String::new() });
            begun = true;
        } else if let (Some(line), Some(own)) = (line.strip_prefix(' '), all.last_mut()) {
            if !std::mem::take(&mut begun) {
                own.text.push('\n');
            }
            own.text.push_str(line);
        }
    }
    all
}

/// Adds a sequence under its name, or where that is taken or empty under another, which is returned; `None` where there are
/// too many.
pub(crate) fn add(all: &mut Vec<Own>, name: &str, text: String) -> Option<String> {
    let name = free_name(all, &clean_name(name));
    (all.len() < MOST).then(|| all.push(Own { name: name.clone(), text }))?;
    Some(name)
}

/// A name that no other has: this one, or with a number behind it.
fn free_name(all: &[Own], name: &str) -> String {
    let numbered = (2..).map(|number| [name, " (", &u32::to_string(&number), ")"].concat());
    let free = |name: &String| !name.is_empty() && all.iter().all(|own| own.name != *name);
    std::iter::once(name.to_owned()).chain(numbered).find(free).unwrap_or_default()
}

/// A name as it is kept: one line, without spaces around it, not too long.
pub(crate) fn clean_name(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).take(LONGEST_NAME).collect();
    plain.trim().to_owned()
}

/// A name for a file: what could be a path or a command is left out.
pub(crate) fn file_name(name: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || matches!(c, '-' | '_') { c } else { ' ' };
    let words: String = name.chars().map(plain).collect();
    let name = words.split_whitespace().collect::<Vec<_>>().join("-");
    if name.is_empty() { "sequence".to_owned() } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn own(name: &str, text: &str) -> Own {
        Own { name: name.to_owned(), text: text.to_owned() }
    }

    #[test]
    fn what_is_kept_comes_back() {
        let all = vec![
            own("empty", ""),
            own("零点", "# 注释\n\nread all\n=not a name\n"),
            own("<img onerror=x>", " indented\r\n\ttab"),
            own("a=b", "\n\n"),
        ];
        assert_eq!(read(&write(&all)), all);
        assert!(read("").is_empty() && read("nonsense\n x").is_empty());
    }

    #[test]
    fn names_are_unique_and_of_one_line() {
        let mut all = Vec::new();
        let names: Vec<_> = ["a", "a", " a\n", "", ""].iter().map(|name| add(&mut all, name, String::new())).collect();
        let names: Vec<_> = names.iter().flatten().map(String::as_str).collect();
        assert_eq!(names, ["a", "a (2)", "a (3)", " (2)", " (3)"]);
        assert_eq!(read("=a\n=a\n").iter().map(|own| own.name.as_str()).collect::<Vec<_>>(), ["a", "a (2)"]);
    }

    #[test]
    fn there_is_an_end_to_how_many() {
        let mut all = Vec::new();
        for number in 0..MOST {
            assert!(add(&mut all, &number.to_string(), String::new()).is_some());
        }
        assert_eq!(add(&mut all, "more", String::new()), None);
        assert_eq!(read(&[write(&all), "=more\n".to_owned()].concat()).len(), MOST);
    }

    #[test]
    fn a_files_name_leads_nowhere() {
        assert_eq!(file_name("Acceptance test: LVDT"), "Acceptance-test-LVDT");
        assert_eq!(file_name("../../etc/passwd"), "etc-passwd");
        assert_eq!((file_name("零点 1"), file_name("//")), ("零点-1".into(), "sequence".into()));
    }
}
