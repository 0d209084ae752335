//! The flow and its parts.

use super::notes::Notes;
use super::trials;
use crate::study::file::{Check, Names, Part};
use crate::study::instrument;
use crate::study::materials::Materials;
use crate::study::plan::BUILT_IN_QUESTIONS;

/// The name of the step that is no part.
const CONSENT: &str = "consent";

pub(super) fn check(notes: &mut Notes<'_>, materials: &Materials) {
    flow(notes);
    for (name, part) in &notes.file().parts {
        let key = format!("part.{name}");
        notes.id(&key, name);
        if name == CONSENT {
            notes.error(&key, "a part", "another name", "consent is a section of its own: [consent]");
        }
        match part {
            Part::Text(text) => notes.words(&format!("{key}.text"), &text.text),
            Part::Form(form) => asked(notes, &format!("{key}.ask"), &form.ask),
            Part::Comprehension(check) => comprehension(notes, &key, check),
            Part::Trials(trials) => trials::check(notes, &key, trials, materials),
        }
        if !notes.file().study.flow.contains(name) {
            notes.warn(&key, "a part", "named in study.flow", "participants do not see it otherwise");
        }
    }
}

fn flow(notes: &mut Notes<'_>) {
    let file = notes.file();
    let flow = &file.study.flow;
    if flow.first().is_none_or(|first| first != CONSENT) {
        let found = flow.first().map_or("[]".to_owned(), |first| format!("{first:?} first"));
        notes.error("study.flow", found, "\"consent\" first", "nothing is asked before participants agree");
    }
    let known: Vec<&str> = file.parts.keys().map(String::as_str).chain([CONSENT]).collect();
    for (index, name) in flow.iter().enumerate() {
        let key = format!("study.flow[{index}]");
        if notes.known(&key, name, &known, "\"consent\" or the name of a part")
            && flow[..index].contains(name)
        {
            notes.error(&key, format!("{name:?}"), "named once", "answers are stored by the part's name");
        }
    }
    let at = |is: fn(&Part) -> bool| flow.iter().position(|name| file.parts.get(name).is_some_and(is));
    let first_counted = at(|part| part.trials().is_some_and(|trials| trials.counted));
    let last_check =
        flow.iter().rposition(|name| matches!(file.parts.get(name), Some(Part::Comprehension(_))));
    if let (Some(check), Some(first)) = (last_check, first_counted)
        && check > first
    {
        let hint =
            "a place is given before the first counted trials; a participant who fails must not hold one";
        notes.error(
            &format!("study.flow[{check}]"),
            "a check after trials",
            "before all counted trials",
            hint,
        );
    }
}

/// Names of questions.
pub(super) fn asked(notes: &mut Notes<'_>, key: &str, names: &Names) {
    if names.0.is_empty() {
        notes.error(
            key,
            "[]",
            "one question or more",
            "name a table of [questions], a questionnaire, gender or age",
        );
    }
    let own = notes.file().questions.keys().map(String::as_str);
    let known: Vec<&str> = own.chain(BUILT_IN_QUESTIONS).chain(instrument::names()).collect();
    for (index, name) in names.0.iter().enumerate() {
        let key = if names.0.len() == 1 { key.to_owned() } else { format!("{key}[{index}]") };
        let allowed = "the name of a question, a questionnaire or a built-in question";
        if notes.known(&key, name, &known, allowed) && names.0[..index].contains(name) {
            notes.error(&key, format!("{name:?}"), "asked once a page", "remove it");
        }
    }
}

fn comprehension(notes: &mut Notes<'_>, key: &str, check: &Check) {
    notes.within(&format!("{key}.attempts"), check.attempts, [1, 10], "2 forgives one slip");
    if check.questions.is_empty() {
        notes.error(&format!("{key}.questions"), "[]", "one question or more", "or remove the part");
    }
    for (index, question) in check.questions.iter().enumerate() {
        let key = format!("{key}.questions[{index}]");
        notes.words(&format!("{key}.text"), &question.text);
        let options = question.options.len();
        if options < 2 {
            let hint = "a check needs something to choose from";
            notes.error(&format!("{key}.options"), format!("{options} options"), "2 options or more", hint);
        }
        if question.right >= options {
            let allowed = format!("0 to {}", options.saturating_sub(1));
            notes.error(&format!("{key}.right"), question.right, allowed, "options count from 0");
        }
        for (option, words) in question.options.iter().enumerate() {
            notes.words(&format!("{key}.options[{option}]"), words);
        }
    }
}
