//! A line as words.

use crate::fault::{Fault, FaultKind};

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Token {
    /// In characters, from 1.
    pub(crate) column: u32,
    pub(crate) kind: TokenKind,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum TokenKind {
    Word(String),
    /// What stands between quotes, escapes and all.
    Quoted(String),
    /// `,` `=` `!=` `<` `<=` `>` `>=`
    Mark(&'static str),
}

impl Token {
    /// As it stands in the text.
    pub(crate) fn text(&self) -> String {
        match &self.kind {
            TokenKind::Word(word) => word.clone(),
            TokenKind::Quoted(inner) => format!("\"{inner}\""),
            TokenKind::Mark(mark) => (*mark).to_owned(),
        }
    }

    pub(crate) fn is_word(&self, word: &str) -> bool {
        matches!(&self.kind, TokenKind::Word(own) if own == word)
    }
}

/// The words of a line, and its comment without the mark.
pub(crate) fn line(line: u32, text: &str) -> Result<(Vec<Token>, Option<String>), Fault> {
    let characters: Vec<char> = text.chars().collect();
    let at = |index: usize| characters.get(index).copied();
    let part = |from: usize, to: usize| characters.get(from..to).unwrap_or_default().iter().collect::<String>();
    let column = |index: usize| u32::try_from(index + 1).unwrap_or(u32::MAX);
    let mut tokens = Vec::new();
    let mut index = 0;
    while let Some(character) = at(index) {
        let start = index;
        let kind = match character {
            _ if character.is_whitespace() || character.is_control() => {
                index += 1;
                continue;
            }
            '#' => return Ok((tokens, Some(part(index + 1, characters.len()).trim().to_owned()))),
            '"' => {
                index += 1;
                while at(index).is_some_and(|next| next != '"') {
                    index += if at(index) == Some('\\') { 2 } else { 1 };
                }
                if at(index).is_none() {
                    return Err(Fault { line, column: column(start), kind: FaultKind::QuoteNotClosed });
                }
                index += 1;
                TokenKind::Quoted(part(start + 1, index - 1))
            }
            _ => {
                if let Some(mark) = mark(character, at(index + 1)) {
                    index += mark.len();
                    TokenKind::Mark(mark)
                } else {
                    while at(index).is_some_and(|next| !ends_word(next, at(index + 1))) {
                        index += 1;
                    }
                    TokenKind::Word(part(start, index))
                }
            }
        };
        tokens.push(Token { column: column(start), kind });
    }
    Ok((tokens, None))
}

fn mark(character: char, next: Option<char>) -> Option<&'static str> {
    Some(match (character, next) {
        (',', _) => ",",
        ('=', _) => "=",
        ('!', Some('=')) => "!=",
        ('<', Some('=')) => "<=",
        ('<', _) => "<",
        ('>', Some('=')) => ">=",
        ('>', _) => ">",
        _ => return None,
    })
}

fn ends_word(character: char, next: Option<char>) -> bool {
    character.is_whitespace()
        || character.is_control()
        || matches!(character, '"' | '#')
        || mark(character, next).is_some()
}

/// One character of a quoted text, with its place in it; `Err` holds the escape that does not exist.
pub(crate) enum Character {
    /// As it stands there.
    Plain(char),
    /// What an escape means.
    Escaped(u8),
}

/// The characters of a quoted text, escapes resolved, each with its place.
pub(crate) fn unescape(inner: &str) -> Result<Vec<(usize, Character)>, (usize, String)> {
    let mut all = Vec::new();
    let mut characters = inner.chars().enumerate();
    while let Some((at, character)) = characters.next() {
        if character != '\\' {
            all.push((at, Character::Plain(character)));
            continue;
        }
        let letter = characters.next().map_or(' ', |(_, letter)| letter);
        let byte = match letter {
            'n' => b'\n',
            'r' => b'\r',
            't' => b'\t',
            '0' => 0,
            'a' => 0x07,
            'b' => 0x08,
            'v' => 0x0B,
            'f' => 0x0C,
            'e' => 0x1B,
            '\\' => b'\\',
            '"' => b'"',
            'x' | 'X' => {
                let digits: String = characters.by_ref().take(2).map(|(_, digit)| digit).collect();
                match u8::from_str_radix(&digits, 16) {
                    Ok(byte) if digits.len() == 2 && !digits.starts_with('+') => byte,
                    _ => return Err((at, format!("\\{letter}{digits}"))),
                }
            }
            other => return Err((at, format!("\\{other}"))),
        };
        all.push((at, Character::Escaped(byte)));
    }
    Ok(all)
}
