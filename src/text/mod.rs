//! Every text of the page, in both languages side by side.
//!
//! [`texts!`] makes one method of [`Language`] from each line, so a missing translation or a wrong argument does not
//! compile. A text without arguments is a `&'static str`, one with arguments a `String`.

mod anatomy;
mod builder;
mod configure;
mod console;
mod decoder;
mod desk;
mod diagnosis;
mod faults;
mod fleet;
mod handling;
mod help;
mod live;
mod profiles;
mod sequence;
mod shell;

use serde::{Deserialize, Serialize};

/// A text of the page that takes no arguments.
pub(crate) type Label = fn(Language) -> &'static str;

/// The languages of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Language {
    /// English.
    En,
    /// Simplified Chinese.
    Zh,
}

impl Language {
    /// The language that a BCP 47 tag such as `zh-CN` asks for, if it is one of ours.
    pub(crate) fn from_tag(tag: &str) -> Option<Self> {
        match tag.split('-').next()? {
            "zh" | "ZH" => Some(Self::Zh),
            "en" | "EN" => Some(Self::En),
            _ => None,
        }
    }

    /// The tag for `<html lang>` and for storage.
    pub(crate) fn tag(self) -> &'static str {
        match self {
            Self::En => "en",
            Self::Zh => "zh-CN",
        }
    }

    /// The other one: what the switch leads to.
    pub(crate) fn other(self) -> Self {
        match self {
            Self::En => Self::Zh,
            Self::Zh => Self::En,
        }
    }
}

/// Makes methods of [`Language`]: `key => "English" | "Chinese";`, or with arguments
/// `key(unit: u8) => "unit {unit}" | "地址 {unit}";`.
macro_rules! texts {
    (@one $key:ident () $en:literal $zh:literal) => {
        pub(crate) fn $key(self) -> &'static str {
            match self {
                $crate::text::Language::En => $en,
                $crate::text::Language::Zh => $zh,
            }
        }
    };
    (@one $key:ident ($($argument:ident: $type:ty),+) $en:literal $zh:literal) => {
        pub(crate) fn $key(self, $($argument: $type),+) -> String {
            match self {
                $crate::text::Language::En => format!($en),
                $crate::text::Language::Zh => format!($zh),
            }
        }
    };
    ($($key:ident $(($($argument:ident: $type:ty),+))? => $en:literal | $zh:literal;)+) => {
        /// One method a text; its words say what it is for.
        impl $crate::text::Language {
            $($crate::text::texts!(@one $key ($($($argument: $type),+)?) $en $zh);)+
        }

        #[cfg(test)]
        pub(super) const ALL: &[(&str, &str, &str)] = &[$((stringify!($key), $en, $zh)),+];
    };
}
use texts;

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> impl Iterator<Item = &'static (&'static str, &'static str, &'static str)> {
        [
            shell::ALL,
            live::ALL,
            faults::ALL,
            help::ALL,
            fleet::ALL,
            decoder::ALL,
            anatomy::ALL,
            diagnosis::ALL,
            desk::ALL,
            builder::ALL,
            handling::ALL,
            configure::ALL,
            console::ALL,
            sequence::ALL,
            profiles::ALL,
        ]
        .into_iter()
        .flatten()
    }

    /// The text without its `{arguments}`.
    fn words(text: &str) -> String {
        let mut depth = 0_u32;
        text.chars()
            .filter(|&c| {
                match c {
                    '{' => depth += 1,
                    '}' => depth -= 1,
                    _ => return depth == 0,
                }
                false
            })
            .collect()
    }

    fn is_cjk(c: char) -> bool {
        matches!(c, '\u{3000}'..='\u{303F}' | '\u{4E00}'..='\u{9FFF}' | '\u{FF00}'..='\u{FFEF}')
    }

    #[test]
    fn english_has_no_chinese_characters() {
        for (key, en, _) in all().filter(|(key, ..)| *key != "switch_language") {
            assert!(!en.chars().any(is_cjk), "{key}: {en}");
        }
    }

    #[test]
    fn every_chinese_text_is_translated() {
        for (key, en, zh) in all() {
            let translated = words(zh);
            if translated.chars().any(char::is_alphabetic) {
                assert_ne!(en, zh, "{key}");
                assert!(*key == "switch_language" || translated.chars().any(is_cjk), "{key}: {zh}");
            }
        }
    }

    #[test]
    fn both_languages_use_the_same_arguments() {
        let arguments = |text: &str| {
            let mut found: Vec<String> =
                text.split('{').skip(1).filter_map(|rest| rest.split('}').next().map(str::to_owned)).collect();
            found.sort();
            found
        };
        for (key, en, zh) in all() {
            assert_eq!(arguments(en), arguments(zh), "{key}");
        }
    }

    #[test]
    fn chinese_is_set_with_full_width_marks_and_spaces_around_latin() {
        for (key, _, zh) in all() {
            // These arguments are Chinese themselves; the others are numbers, codes and names.
            let zh = ["name", "names", "place", "supply", "plus", "minus", "a", "b"]
                .iter()
                .fold((*zh).to_owned(), |text, argument| text.replace(&format!("{{{argument}}}"), "字"));
            let text: Vec<char> = words(&zh.replace('{', "\u{1}{").replace('}', "}\u{1}")).chars().collect();
            for pair in text.windows(2) {
                let latin = |c: char| c.is_ascii_alphanumeric() || c == '\u{1}';
                let han = |c: char| matches!(c, '\u{4E00}'..='\u{9FFF}');
                assert!(!(han(pair[0]) && latin(pair[1]) || latin(pair[0]) && han(pair[1])), "{key}: {zh}");
                assert!(!(han(pair[0]) && ",;:?!()".contains(pair[1])), "{key}: {zh}");
            }
        }
    }

    #[test]
    fn tags_name_languages() {
        assert_eq!(Language::from_tag("zh-TW"), Some(Language::Zh));
        assert_eq!(Language::from_tag("en-GB"), Some(Language::En));
        assert_eq!(Language::from_tag("de"), None);
        for language in [Language::En, Language::Zh] {
            assert_eq!(Language::from_tag(language.tag()), Some(language));
        }
    }
}
