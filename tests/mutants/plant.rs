//! Single errors in a WGSL text.

use crate::tokens::{Kind, Token, arguments, closing, tokens};
use std::collections::BTreeMap;
use std::ops::Range;

/// One error in one file.
#[derive(Debug, Clone)]
pub(crate) struct Mutant {
    /// `FILE: FUNCTION: LINE: OPERATOR`: stays the same when other lines change.
    pub(crate) id: String,
    /// The whole text with the error. A second one holds a coarser error at the same place, for when nothing can notice the
    /// first: a bound that no number falls on.
    pub(crate) texts: Vec<String>,
}

/// Whether the comparison at a byte of the text is of floats, as the compiler knows.
pub(crate) type IsFloat<'a> = &'a dyn Fn(usize) -> bool;

/// A change: what stands there becomes something else.
struct Change {
    name: String,
    at: Range<usize>,
    new: String,
    coarser: Option<String>,
}

/// All errors that are planted in a text.
pub(crate) fn plant(file: &str, text: &str, is_float: IsFloat<'_>) -> Vec<Mutant> {
    let tokens = tokens(text);
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    let mut mutants = Vec::new();
    for part in parts(&tokens) {
        for index in part.tokens.clone() {
            for change in changes(text, &tokens, index, is_float) {
                let line = line_of(text, change.at.start);
                let base = format!("{file}: {}: {line}: {}", part.name, change.name);
                let count = seen.entry(base.clone()).or_default();
                *count += 1;
                let id = if *count > 1 { format!("{base} #{count}") } else { base };
                let with = |new: &String| {
                    let mut text = text.to_owned();
                    text.replace_range(change.at.clone(), new);
                    text
                };
                let texts = [Some(&change.new), change.coarser.as_ref()].into_iter().flatten().map(with);
                mutants.push(Mutant { id, texts: texts.collect() });
            }
        }
    }
    mutants
}

/// The code of a line, without its comment.
fn line_of(text: &str, at: usize) -> &str {
    let begin = text[..at].rfind('\n').map_or(0, |end| end + 1);
    let line = text[begin..].lines().next().unwrap_or_default();
    line.split("//").next().unwrap_or_default().trim()
}

/// A function's body, or the value of a constant.
struct Part {
    name: String,
    tokens: Range<usize>,
}

fn parts(tokens: &[Token]) -> Vec<Part> {
    let mut found = Vec::new();
    let mut index = 0;
    while let Some(token) = tokens.get(index) {
        let rest = &tokens[index..];
        let name = rest.get(1).map_or(String::new(), |name| name.text.clone());
        let offset = |mark: &str| rest.iter().position(|token| token.is(mark)).unwrap_or(rest.len() - 1);
        let end = match token.text.as_str() {
            "fn" => {
                let open = index + offset("{");
                let close = closing(tokens, open).unwrap_or(tokens.len() - 1);
                found.push(Part { name, tokens: open..close });
                close
            }
            "const" => {
                let end = index + offset(";");
                found.push(Part { name: "const".to_owned(), tokens: index + offset("=")..end });
                end
            }
            "struct" => closing(tokens, index + offset("{")).unwrap_or(tokens.len() - 1),
            "@" => index + 1,
            "var" => index + offset(";"),
            _ => index,
        };
        index = end + 1;
    }
    found
}

fn changes(text: &str, tokens: &[Token], index: usize, is_float: IsFloat<'_>) -> Vec<Change> {
    let token = &tokens[index];
    match token.kind {
        Kind::Number => number(tokens, index).into_iter().collect(),
        Kind::Mark => {
            mark(text, tokens, index, is_float).into_iter().chain(dropped(text, tokens, index)).collect()
        }
        Kind::Word => word(text, tokens, index),
    }
}

fn change(name: &str, at: &Range<usize>, new: impl Into<String>) -> Change {
    Change { name: name.to_owned(), at: at.clone(), new: new.into(), coarser: None }
}

/// One more, or one unit in the last place; a hundredth where that is too little.
fn number(tokens: &[Token], index: usize) -> Option<Change> {
    let token = &tokens[index];
    let is_float = !token.text.starts_with("0x") && token.text.contains(['.', 'e', 'f']);
    if !is_float {
        let digits = token.text.trim_end_matches(['u', 'i']);
        let suffix = &token.text[digits.len()..];
        let value = match digits.strip_prefix("0x") {
            Some(hex) => u64::from_str_radix(hex, 16).ok()?,
            None => digits.parse().ok()?,
        };
        let most = u64::from(u32::MAX);
        let new = if value == most { value - 1 } else { value + 1 };
        return Some(change(&format!("{} + 1", token.text), &token.at, format!("{new}{suffix}")));
    }
    let value: f32 = token.text.trim_end_matches('f').parse().ok()?;
    let (fine, coarse) = if value == 0.0 { (1e-6, 1e-2) } else { (value.next_up(), value * 1.01) };
    let mut change = change(&format!("{} one ulp up", token.text), &token.at, format!("{fine:?}"));
    change.coarser = Some(format!("{coarse:?}"));
    Some(change)
}

/// Other operators.
fn mark(text: &str, tokens: &[Token], index: usize, is_float: IsFloat<'_>) -> Option<Change> {
    let token = &tokens[index];
    let spaced = text[..token.at.start].ends_with(' ') && text[token.at.end..].starts_with([' ', '\n']);
    let named = |new: &str| Some(change(&format!("{} to {new}", token.text), &token.at, new));
    match token.text.as_str() {
        "[" => return index_plus_one(text, tokens, index),
        "!" => return named(""),
        "-" if !spaced => return Some(change("sign dropped", &token.at, "")),
        _ if !spaced => return None,
        _ => {}
    }
    let (new, coarser) = match token.text.as_str() {
        "<" => ("<=", ">="),
        "<=" => ("<", ">"),
        ">" => (">=", "<="),
        ">=" => (">", "<"),
        "==" => ("!=", ""),
        "!=" => ("==", ""),
        "+" => ("-", ""),
        "-" => ("+", ""),
        "*" => ("/", ""),
        "/" | "%" => ("*", ""),
        "&&" => ("||", ""),
        "||" => ("&&", ""),
        "&" => ("|", ""),
        "|" | "^" => ("&", ""),
        "<<" => (">>", ""),
        ">>" => ("<<", ""),
        "+=" => ("-=", ""),
        "-=" => ("+=", ""),
        "*=" => ("/=", ""),
        "/=" => ("*=", ""),
        "|=" => ("&=", ""),
        _ => return None,
    };
    let mut change = named(new)?;
    let is_coarser = !coarser.is_empty() && is_float(token.at.start);
    change.coarser = is_coarser.then(|| coarser.to_owned());
    Some(change)
}

fn index_plus_one(text: &str, tokens: &[Token], open: usize) -> Option<Change> {
    let before = tokens.get(open.checked_sub(1)?)?;
    let is_index = before.kind == Kind::Word || before.is("]") || before.is(")");
    let inside = tokens[open].at.end..tokens[closing(tokens, open)?].at.start;
    let new = format!("({}) + 1", &text[inside.clone()]);
    is_index.then(|| change("index + 1", &inside, new))
}

/// A statement that is left out: the one that the mark ends.
fn dropped(text: &str, tokens: &[Token], index: usize) -> Option<Change> {
    if !tokens[index].is(";") {
        return None;
    }
    let begin = tokens[..index].iter().rposition(|token| [";", "{", "}"].contains(&token.text.as_str()))? + 1;
    let statement = tokens.get(begin)?;
    let says = &tokens[begin..index];
    let is_call = statement.kind == Kind::Word && says.get(1).is_some_and(|next| next.is("("));
    let is_kept = ["let", "var", "const", "if", "for", "while", "loop", "switch", "return"];
    let assigns =
        says.iter().any(|t| t.is("=") || (t.text.len() > 1 && t.text.ends_with('=') && !is_test(&t.text)));
    let leaves = says.len() == 1 && ["return", "continue", "break"].contains(&statement.text.as_str());
    let is_statement = (is_call || assigns) && !is_kept.contains(&statement.text.as_str());
    // what stands in the head of a loop is none
    let line = line_of(text, statement.at.start);
    let is_loop =
        line.starts_with("for") && says.iter().all(|t| text[t.at.clone()].len() < 80) && line.contains(") {");
    let at = statement.at.start..tokens[index].at.end;
    ((is_statement && !is_loop) || leaves).then(|| change("dropped", &at, ""))
}

fn is_test(mark: &str) -> bool {
    ["==", "!=", "<=", ">="].contains(&mark)
}

fn word(text: &str, tokens: &[Token], index: usize) -> Vec<Change> {
    let token = &tokens[index];
    let next_is_open = tokens.get(index + 1).is_some_and(|next| next.is("("));
    let is_part = index > 0 && tokens[index - 1].is(".");
    if is_part {
        return component(token).into_iter().collect();
    }
    match token.text.as_str() {
        "if" => condition(text, tokens, index),
        "true" => vec![change("true to false", &token.at, "false")],
        "false" => vec![change("false to true", &token.at, "true")],
        "min" if next_is_open => vec![change("min to max", &token.at, "max")],
        "max" if next_is_open => vec![change("max to min", &token.at, "min")],
        "floor" if next_is_open => vec![change("floor to ceil", &token.at, "ceil")],
        "abs" | "sqrt" if next_is_open => vec![change(&format!("{} dropped", token.text), &token.at, "")],
        "atomicMin" => vec![change("atomicMin to atomicMax", &token.at, "atomicMax")],
        "atomicMax" => vec![change("atomicMax to atomicMin", &token.at, "atomicMin")],
        "select" if next_is_open => swapped(text, tokens, index).into_iter().collect(),
        "clamp" if next_is_open => unclamped(text, tokens, index),
        _ => Vec::new(),
    }
}

/// Another component of a vector.
fn component(token: &Token) -> Option<Change> {
    let is_vector = token.text.len() <= 4 && token.text.chars().all(|c| "xyzw".contains(c));
    let other = |c| match c {
        'x' => 'y',
        'y' => 'x',
        'z' => 'w',
        _ => 'z',
    };
    let new: String = token.text.chars().map(other).collect();
    is_vector.then(|| change(&format!(".{} to .{new}", token.text), &token.at, new))
}

/// A condition that is always met, and one that never is.
fn condition(text: &str, tokens: &[Token], index: usize) -> Vec<Change> {
    let Some(open) = tokens[index..].iter().position(|token| token.is("{")) else { return Vec::new() };
    let at = tokens[index].at.end..tokens[index + open].at.start;
    let is_known = ["true", "false"].contains(&text[at.clone()].trim());
    let new = |value: &str| change(&format!("if {value}"), &at, format!(" {value} "));
    if is_known { Vec::new() } else { vec![new("true"), new("false")] }
}

fn swapped(text: &str, tokens: &[Token], index: usize) -> Option<Change> {
    let found = arguments(tokens, index + 1);
    let [first, second, _] = found.as_slice() else { return None };
    let new = format!("{},{}", &text[second.clone()], &text[first.clone()]);
    Some(change("select swapped", &(first.start..second.end), new))
}

/// A bound that is left out.
fn unclamped(text: &str, tokens: &[Token], index: usize) -> Vec<Change> {
    let found = arguments(tokens, index + 1);
    let [value, low, high] = found.as_slice() else { return Vec::new() };
    let at = tokens[index].at.start..high.end;
    let of = |name: &str, bound: &Range<usize>| {
        format!("{name}({},{}", &text[value.clone()], &text[bound.clone()])
    };
    vec![
        change("clamp without its upper bound", &at, of("max", low)),
        change("clamp without its lower bound", &at, of("min", high)),
    ]
}
