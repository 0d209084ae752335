//! Questions as native controls.

use super::frame::{FORM, Frame};
use crate::study::plan::Scale;
use crate::study::protocol::PageQuestion;
use maud::{Markup, html};
use std::collections::{BTreeMap, BTreeSet};

/// What the names of fields with answers begin with: it keeps them apart from what a page sends besides.
pub(in super::super) const PREFIX: &str = "q:";

/// What was sent before and could not be taken, and what of it is missing.
#[derive(Debug, Clone, Default)]
pub(in super::super) struct Filled {
    /// What was written or chosen, by question.
    pub(in super::super) given: BTreeMap<String, String>,
    /// Questions that have to be answered.
    pub(in super::super) lacking: BTreeSet<String>,
}

/// What a page sends besides its answers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hidden<'a> {
    /// The page's id.
    pub(super) page: &'a str,
    /// When it was shown, UTC ms: without scripts the server takes the time.
    pub(super) shown: i64,
}

/// The form of a page, with its questions and the button that ends it.
pub(super) fn form(
    frame: &Frame<'_>,
    hidden: Hidden<'_>,
    questions: &[PageQuestion],
    filled: &Filled,
) -> Markup {
    let words = frame.words;
    let has_rows = questions.iter().any(|question| matches!(question.scale, Scale::Points { .. }));
    html! {
        form id=(FORM) method="post" action=(frame.at("/answer")) autocomplete="off" {
            (frame.mark())
            input type="hidden" name="page" value=(hidden.page);
            input type="hidden" name="shown" value=(hidden.shown);
            @if !filled.lacking.is_empty() { p.lacking role="alert" { (words.lacking_all) } }
            @for (index, question) in questions.iter().enumerate() {
                @let before = index.checked_sub(1).and_then(|before| questions.get(before));
                @if !question.heading.is_empty() && before.is_none_or(|before| before.heading != question.heading) {
                    h2 { (question.heading) }
                }
                (control(frame, question, filled))
            }
            @if has_rows { p.note { (words.keys_note) } }
            button.next type="submit" { (words.next) }
        }
    }
}

fn control(frame: &Frame<'_>, question: &PageQuestion, filled: &Filled) -> Markup {
    let given = filled.given.get(&question.id).map_or("", String::as_str);
    let is_lacking = filled.lacking.contains(&question.id);
    let note = html! {
        @if is_lacking { p.lacking { (frame.words.lacking) } }
        @else if question.optional { p.note { (frame.words.optional) } }
    };
    match &question.scale {
        Scale::Points { least, greatest, labels } => {
            let is_worded = i64::try_from(labels.len()).is_ok_and(|count| count > greatest - least);
            let word =
                |point: i64| labels.iter().find(|(own, _)| *own == point).map(|(_, word)| word.as_str());
            let text = |point: i64| match word(point) {
                Some(word) if is_worded => word.to_owned(),
                Some(word) => format!("{point} {word}"),
                None => point.to_string(),
            };
            let options: Vec<(i64, String)> =
                (*least..=*greatest).map(|point| (point, text(point))).collect();
            radios(question, &options, (given, "points"), &note)
        }
        Scale::Options { options } => radios(question, options, (given, "options"), &note),
        Scale::Number { least, greatest } => html! {
            div.field data-question=(question.id) {
                label for=(name(question)) { (question.text) }
                (note)
                input type="number" inputmode="numeric" step="1" id=(name(question)) name=(name(question))
                    min=(least) max=(greatest) value=(given) required[!question.optional];
            }
        },
        Scale::Text { most } => html! {
            div.field data-question=(question.id) {
                label for=(name(question)) { (question.text) }
                (note)
                textarea id=(name(question)) name=(name(question)) rows="5" maxlength=(most)
                    required[!question.optional] { (given) }
            }
        },
    }
}

/// A group of native radio buttons, of a class that the style sheet lays out.
fn radios(
    question: &PageQuestion,
    options: &[(i64, String)],
    (given, class): (&str, &str),
    note: &Markup,
) -> Markup {
    html! {
        fieldset class=(class) data-question=(question.id) {
            legend { (question.text) }
            (note)
            div.choices {
                @for (value, text) in options {
                    label {
                        input type="radio" name=(name(question)) value=(value) required[!question.optional]
                            checked[given == value.to_string()];
                        span { (text) }
                    }
                }
            }
        }
    }
}

/// The name of a question's field. Its prefix keeps it apart from what the page sends besides.
fn name(question: &PageQuestion) -> String {
    format!("{}{}", PREFIX, question.id)
}
