//! Questions, and the wording of questionnaires.

use super::notes::Notes;
use crate::spelling::suggestion;
use crate::study::file::{LikertItem, Part, Points, Question};
use crate::study::instrument::{self, Instrument};
use crate::study::words::Words;
use std::collections::{BTreeMap, BTreeSet};

/// Greatest number of an answer or a point.
const MOST_NUMBER: i64 = 1_000_000_000;

pub(super) fn check(notes: &mut Notes<'_>) {
    let asked = asked(notes);
    for (name, question) in &notes.file().questions {
        let key = format!("questions.{name}");
        notes.id(&key, name);
        if instrument::names().contains(&name.as_str()) {
            let hint = "questions of that name are the questionnaire's; word it in [wording]";
            notes.error(&key, format!("{name:?}"), "another name than a questionnaire's", hint);
        }
        one(notes, &key, question);
        if !asked.contains(name.as_str()) {
            notes.warn(&key, "a question", "asked by some part", "participants do not see it otherwise");
        }
    }
    wording(notes);
    for name in instrument::names().into_iter().filter(|name| asked.contains(name)) {
        if let Ok(Some(instrument)) = Instrument::builtin(name) {
            unworded(notes, &instrument);
        }
    }
}

/// All names that parts ask.
fn asked<'s>(notes: &Notes<'s>) -> BTreeSet<&'s str> {
    let names = |part: &'s Part| match part {
        Part::Form(form) => vec![&form.ask],
        Part::Trials(trials) => {
            [Some(&trials.ask), trials.after_block.as_ref()].into_iter().flatten().collect()
        }
        Part::Text(_) | Part::Comprehension(_) => Vec::new(),
    };
    let all = notes.file().parts.values().flat_map(names).flat_map(|names| &names.0);
    all.map(String::as_str).collect()
}

fn one(notes: &mut Notes<'_>, key: &str, question: &Question) {
    let text_key = format!("{key}.text");
    match question {
        Question::Likert { points, items, .. } => likert(notes, key, points, items),
        Question::Choice { options, .. } => {
            if !(2..=100).contains(&options.len()) {
                let found = format!("{} options", options.len());
                notes.error(
                    &format!("{key}.options"),
                    found,
                    "2 to 100 options",
                    "or ask a question of kind text",
                );
            }
            for (index, option) in options.iter().enumerate() {
                notes.words(&format!("{key}.options[{index}]"), option);
            }
        }
        Question::Number { text, least, greatest, .. } => {
            notes.words(&text_key, text);
            notes.within(&format!("{key}.least"), *least, [-MOST_NUMBER, MOST_NUMBER], "choose another unit");
            notes.within(
                &format!("{key}.greatest"),
                *greatest,
                [-MOST_NUMBER, MOST_NUMBER],
                "choose another unit",
            );
            if least >= greatest {
                let allowed = format!("above {least}");
                notes.error(&format!("{key}.greatest"), greatest, allowed, "least comes first");
            }
        }
        Question::Text { text, most } => {
            notes.words(&text_key, text);
            notes.within(&format!("{key}.most"), *most, [1, 10_000], "2000 characters are a page");
        }
    }
}

fn likert(notes: &mut Notes<'_>, key: &str, points: &Points, items: &[LikertItem]) {
    let (least, greatest) = points.ends().unwrap_or((0, 0));
    if !(1..=100).contains(&greatest.saturating_sub(least)) {
        let found = format!("{least} to {greatest}");
        notes.error(&format!("{key}.points"), found, "2 to 101 points", "5 and 7 are usual");
    }
    notes.within(&format!("{key}.points"), greatest, [-MOST_NUMBER, MOST_NUMBER], "5 and 7 are usual");
    for (point, text) in points.labels() {
        notes.words(&format!("{key}.points.{point}"), text);
    }
    if items.is_empty() {
        let hint = "try items = [{ id = \"happy\", text = \"This person looks happy\" }]";
        notes.error(&format!("{key}.items"), "[]", "one statement or more", hint);
    }
    for (index, item) in items.iter().enumerate() {
        let key = format!("{key}.items[{index}]");
        notes.id(&format!("{key}.id"), &item.id);
        notes.words(&format!("{key}.text"), &item.text);
        if items[..index].iter().any(|other| other.id == item.id) {
            let hint = "answers are stored by it";
            notes.error(&format!("{key}.id"), format!("{:?}", item.id), "another id than the others'", hint);
        }
    }
}

/// The lab's own wording names questionnaires and items that there are.
fn wording(notes: &mut Notes<'_>) {
    let known = instrument::names();
    for (name, texts) in &notes.file().wording {
        let key = format!("wording.{name}");
        if notes.known(&key, name, &known, "a questionnaire")
            && let Ok(Some(instrument)) = Instrument::builtin(name)
        {
            items(notes, &key, texts, &instrument);
        }
    }
}

fn items(notes: &mut Notes<'_>, key: &str, texts: &BTreeMap<String, Words>, instrument: &Instrument) {
    let known: Vec<&str> = instrument.items.iter().map(|item| item.id.as_str()).collect();
    for (item, text) in texts {
        let key = format!("{key}.{item}");
        if known.contains(&item.as_str()) {
            notes.words(&key, text);
        } else {
            let allowed = format!("an item of {}", instrument.id);
            notes.error(&key, format!("{item:?}"), allowed, suggestion(item, &known, "there are"));
        }
    }
}

/// A questionnaire that is asked has all of its wording.
fn unworded(notes: &mut Notes<'_>, instrument: &Instrument) {
    let id = &instrument.id;
    let lacking = instrument.without_wording(notes.file().wording.get(id));
    let Some(first) = lacking.first() else { return };
    let found = format!("{} of {} items without wording", lacking.len(), instrument.items.len());
    let hint = format!("{}; write [wording.{id}] with {first} = \"..\" and so on", instrument.licence);
    notes.missing(&format!("wording.{id}"), found, "a text for every item", hint);
}
