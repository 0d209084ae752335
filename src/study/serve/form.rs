//! Forms that were sent without scripts: a page's answers, all at once.

use super::cookie::mark;
use super::pages::{Filled, PREFIX};
use crate::study::plan::Scale;
use crate::study::protocol::{Answer, PageQuestion};
use axum::http::Uri;
use std::collections::BTreeMap;

/// The fields of a form, by name; the last of equal names counts.
pub(super) type Fields = BTreeMap<String, String>;

/// Reads a form's body, or what stands behind the question mark of an address (`application/x-www-form-urlencoded`); none if it
/// is no UTF-8.
pub(super) fn fields(body: &[u8]) -> Option<Fields> {
    let text = std::str::from_utf8(body).ok()?;
    let decoded = |text: &str| {
        let spaced = text.replace('+', " ");
        urlencoding::decode(&spaced).map(std::borrow::Cow::into_owned).ok()
    };
    let pair = |pair: &str| {
        let (name, value) = pair.split_once('=').unwrap_or((pair, ""));
        Some((decoded(name)?, decoded(value)?))
    };
    text.split('&').filter(|piece| !piece.is_empty()).map(pair).collect()
}

/// The fields of an address.
pub(super) fn query(address: &Uri) -> Fields {
    address.query().and_then(|query| fields(query.as_bytes())).unwrap_or_default()
}

/// A page's answers as a form has them.
#[derive(Debug)]
pub(super) struct Sheet {
    /// Those that can be sent to the store.
    pub(super) answers: Vec<Answer>,
    /// What was written, for showing the page again, and which of it cannot be read.
    pub(super) filled: Filled,
}

/// Reads a page's answers. `now` is UTC ms; the form says when the page was shown.
pub(super) fn sheet(fields: &Fields, page: &str, questions: &[PageQuestion], now: i64) -> Sheet {
    let shown = fields.get("shown").and_then(|shown| shown.parse::<i64>().ok()).unwrap_or(now);
    let ms = u32::try_from(now.saturating_sub(shown).max(0)).unwrap_or(u32::MAX);
    let mut sheet = Sheet { answers: Vec::new(), filled: Filled::default() };
    for question in questions {
        let Some(written) = fields.get(&format!("{PREFIX}{}", question.id)) else { continue };
        let written = written.replace("\r\n", "\n");
        sheet.filled.given.insert(question.id.clone(), written.clone());
        if written.trim().is_empty() {
            continue;
        }
        let (value, text) = match &question.scale {
            Scale::Text { most } => {
                let fits = written.chars().count() <= *most as usize;
                (None, Some(written.clone()).filter(|_| fits))
            }
            scale => (written.trim().parse().ok().filter(|&value| scale.allows(value)), None),
        };
        if value.is_none() && text.is_none() {
            sheet.filled.lacking.insert(question.id.clone());
            continue;
        }
        // the same form sent twice counts once; one that was changed has other keys
        let key = mark(&format!("{page}\0{}\0{shown}\0{written}", question.id));
        let (page, question) = (page.to_owned(), question.id.clone());
        sheet.answers.push(Answer { page, question, value, text, first_ms: ms, ms, key });
    }
    sheet
}

#[cfg(test)]
mod tests {
    use super::*;

    fn question(id: &str, scale: Scale<String>) -> PageQuestion {
        let (heading, text) = (String::new(), id.to_owned());
        PageQuestion { id: id.to_owned(), heading, text, scale, optional: false }
    }

    #[test]
    fn a_form_becomes_answers_with_keys_of_their_own() {
        let questions = [
            question("a.x", Scale::Points { least: 1, greatest: 5, labels: Vec::new() }),
            question("age", Scale::Number { least: 0, greatest: 120 }),
            question("remarks", Scale::Text { most: 6 }),
            question("left-out", Scale::Text { most: 6 }),
        ];
        let read = |body: &str| sheet(&fields(body.as_bytes()).unwrap(), "p/1", &questions, 5_000);
        let first =
            read("page=p%2F1&shown=2000&q%3Aa.x=4&q%3Aage=33&q%3Aremarks=a+b%0D%0A%C3%A9&q%3Aleft-out=");
        let values: Vec<_> =
            first.answers.iter().map(|answer| (answer.value, answer.text.as_deref())).collect();
        assert_eq!(values, [(Some(4), None), (Some(33), None), (None, Some("a b\né"))]);
        assert_eq!((first.answers[0].ms, first.filled.lacking.len()), (3000, 0));
        assert_eq!(read("shown=2000&q%3Aa.x=4").answers[0].key, first.answers[0].key);
        for other in ["shown=2001&q%3Aa.x=4", "shown=2000&q%3Aa.x=5"] {
            assert_ne!(read(other).answers[0].key, first.answers[0].key);
        }
        let wrong = read("q%3Aa.x=6&q%3Aage=old&q%3Aremarks=seven+letters");
        assert_eq!((wrong.answers.len(), wrong.filled.lacking.len()), (0, 3));
        assert_eq!(wrong.filled.given["age"], "old");
    }
}
