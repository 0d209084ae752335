//! The planned analysis.

use super::notes::Notes;
use crate::study::file::{Part, Question, StudyFile, Test, Trials};
use crate::study::instrument::{self, Instrument};

/// By what answers about scenes can be compared.
const FACTORS: [&str; 2] = ["condition", "scene"];

/// Whether a question asks for the ratings that become labels.
fn is_rating(file: &StudyFile, name: &str) -> bool {
    file.questions.get(name).is_some_and(Question::rates_emotions)
}

pub(super) fn check(notes: &mut Notes<'_>) {
    let analysis = &notes.file().analysis;
    if let Some(ratings) = &analysis.ratings {
        notes.within(
            "analysis.ratings.theta",
            ratings.theta,
            [0.0, 100.0],
            "the paper has 3.5 on a scale of 1 to 5",
        );
        let rated = part(notes, "analysis.ratings.part", &ratings.part);
        if rated.is_some_and(|trials| trials.show.gaits.is_none()) {
            let hint = "ratings become labels of gaits";
            notes.error(
                "analysis.ratings.part",
                format!("{:?}", ratings.part),
                "a part that shows gaits",
                hint,
            );
        } else if rated.is_some_and(|trials| !trials.ask.0.iter().any(|name| is_rating(notes.file(), name))) {
            let allowed = "a part that asks how happy, angry, sad and neutral a gait looks, 1 to 5";
            let hint = "a likert question of these four items is missing";
            notes.error("analysis.ratings.part", format!("{:?}", ratings.part), allowed, hint);
        }
    }
    for (index, test) in analysis.tests.iter().enumerate() {
        self::test(notes, &format!("analysis.test[{index}]"), test);
    }
    for (name, scoring) in &analysis.scoring {
        let key = format!("analysis.scoring.{name}");
        if !notes.known(&key, name, &instrument::names(), "a questionnaire") {
            continue;
        }
        let Ok(Some(instrument)) = Instrument::builtin(name) else { continue };
        for (at, variant) in scoring.variants.iter().enumerate() {
            let key = format!("{key}.variants[{at}]");
            notes.known(&key, variant, &instrument.variants(), "a way of scoring it");
        }
    }
}

/// The counted trials of a name.
fn part<'s>(notes: &mut Notes<'s>, key: &str, name: &str) -> Option<&'s Trials> {
    let counted = |part: &'s Part| part.trials().filter(|trials| trials.counted);
    let parts = &notes.file().parts;
    let known: Vec<&str> =
        parts.iter().filter(|(_, part)| counted(part).is_some()).map(|(name, _)| name.as_str()).collect();
    notes.known(key, name, &known, "a part with counted trials");
    parts.get(name).and_then(counted)
}

fn test(notes: &mut Notes<'_>, key: &str, test: &Test) {
    match test {
        Test::Friedman { of, by, within, .. } => {
            let shown = answers(notes, &format!("{key}.of"), of, true);
            notes.known(&format!("{key}.by"), by, &FACTORS, "what is compared");
            if let Some(within) = within {
                notes.known(&format!("{key}.within"), within, &FACTORS, "what each test holds fixed");
                if within == by {
                    let hint = "one of them is \"condition\", the other \"scene\"";
                    notes.error(&format!("{key}.within"), format!("{within:?}"), "another than `by`", hint);
                }
            }
            if shown.is_some_and(|trials| trials.show.scenes.is_none()) {
                let hint = "only scenes have conditions that a participant sees all of";
                notes.error(&format!("{key}.of"), format!("{of:?}"), "of a part that shows scenes", hint);
            }
        }
        Test::Confusion { of } => {
            let shown = answers(notes, &format!("{key}.of"), of, false);
            if shown.is_some_and(|trials| trials.show.agents.is_none()) {
                let hint = "only single agents show one emotion each";
                notes.error(&format!("{key}.of"), format!("{of:?}"), "of a part that shows agents", hint);
            }
        }
    }
}

/// The answers `PART.QUESTION` or `PART.QUESTION.ITEM`; returns what the part shows.
fn answers<'s>(notes: &mut Notes<'s>, key: &str, of: &str, has_item: bool) -> Option<&'s Trials> {
    let pieces: Vec<&str> = of.split('.').collect();
    let ([name, question] | [name, question, _]) = pieces[..] else {
        let allowed = if has_item { "PART.QUESTION.ITEM" } else { "PART.QUESTION" };
        notes.error(key, format!("{of:?}"), allowed, "* is every item");
        return None;
    };
    let trials = part(notes, key, name)?;
    let asked: Vec<&str> = trials.ask.0.iter().map(String::as_str).collect();
    if !notes.known(key, question, &asked, &format!("a question that {name} asks")) {
        return None;
    }
    match (pieces.get(2), notes.file().questions.get(question)) {
        (Some(&item), Some(Question::Likert { items, .. })) if item != "*" => {
            let known: Vec<&str> = items.iter().map(|item| item.id.as_str()).collect();
            notes.known(key, item, &known, "an item of the question, or *");
        }
        (None, _) if has_item => {
            notes.error(key, format!("{of:?}"), "PART.QUESTION.ITEM", "* is every item");
        }
        _ => {}
    }
    Some(trials)
}
