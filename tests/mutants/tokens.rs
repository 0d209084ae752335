//! The tokens of a WGSL text.

use std::ops::Range;

/// What a token is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Word,
    Number,
    Mark,
}

/// A token and where it stands, bytes.
#[derive(Debug, Clone)]
pub(crate) struct Token {
    pub(crate) kind: Kind,
    pub(crate) at: Range<usize>,
    pub(crate) text: String,
}

impl Token {
    pub(crate) fn is(&self, text: &str) -> bool {
        self.text == text
    }
}

/// Marks of several characters, longest first. Angle brackets of types stand alone.
const MARKS: [&str; 19] = [
    "<<=", ">>=", "<<", ">>", "<=", ">=", "==", "!=", "&&", "||", "+=", "-=", "*=", "/=", "|=", "&=", "++",
    "--", "->",
];

/// Splits a text, comments left out.
pub(crate) fn tokens(text: &str) -> Vec<Token> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        }
        if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
            continue;
        }
        let (kind, length) = if first.is_ascii_digit() {
            (Kind::Number, number(rest))
        } else if first.is_alphabetic() || first == '_' {
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_');
            (Kind::Word, end.unwrap_or(rest.len()))
        } else {
            let mark = MARKS.iter().find(|mark| rest.starts_with(**mark));
            (Kind::Mark, mark.map_or(first.len_utf8(), |mark| mark.len()))
        };
        found.push(Token { kind, at: at..at + length, text: rest[..length].to_owned() });
        at += length;
    }
    found
}

/// Length of the number that a text begins with.
fn number(text: &str) -> usize {
    let is_hex = text.starts_with("0x");
    let mut last = ' ';
    let end = text.find(|c: char| {
        let goes_on = c.is_alphanumeric() || c == '.' || (!is_hex && last == 'e' && (c == '-' || c == '+'));
        last = c;
        !goes_on
    });
    end.unwrap_or(text.len())
}

/// The token that closes the bracket at `open`.
pub(crate) fn closing(tokens: &[Token], open: usize) -> Option<usize> {
    let mut depth = 0_i32;
    for (index, token) in tokens.iter().enumerate().skip(open) {
        match token.text.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some(index);
        }
    }
    None
}

/// Ranges of the arguments of the call whose bracket is at `open`, bytes.
pub(crate) fn arguments(tokens: &[Token], open: usize) -> Vec<Range<usize>> {
    let Some(close) = closing(tokens, open) else { return Vec::new() };
    let (mut found, mut begin, mut index) = (Vec::new(), tokens[open].at.end, open + 1);
    while index < close {
        match tokens[index].text.as_str() {
            "(" | "[" => index = closing(tokens, index).unwrap_or(close),
            "," => {
                found.push(begin..tokens[index].at.start);
                begin = tokens[index].at.end;
            }
            _ => {}
        }
        index += 1;
    }
    found.push(begin..tokens[close].at.start);
    found
}
