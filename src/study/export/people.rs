//! The table of participants, and whether gender and age may be in it.

use super::columns::number;
use super::sheet::Sheet;
use crate::study::analyse::{Analysis, Error, Reason};
use crate::study::file::StudyFile;
use crate::study::plan::{BUILT_IN_QUESTIONS, Scale, prompts};
use crate::study::tables::{Tables, name};
use std::collections::BTreeMap;

/// What a participant said of gender and age.
type About = [Option<i64>; 2];

fn about(tables: &Tables) -> BTreeMap<&str, About> {
    let mut found: BTreeMap<&str, About> = BTreeMap::new();
    for row in &tables.answers {
        let index = BUILT_IN_QUESTIONS.iter().position(|question| *question == row.question);
        if let (Some(index), Some(value)) = (index, row.number()) {
            found.entry(&row.participant).or_default()[index] = Some(value);
        }
    }
    found
}

/// The questions about the person that were answered.
pub(super) fn asked(tables: &Tables) -> Vec<String> {
    let all = about(tables);
    let is_asked = |index: &usize| all.values().any(|about| about[*index].is_some());
    (0..BUILT_IN_QUESTIONS.len()).filter(is_asked).map(|index| BUILT_IN_QUESTIONS[index].to_owned()).collect()
}

/// Fewest people that share gender and age, of the combinations that are there; none if no participant said either.
pub(super) fn smallest_cell(tables: &Tables) -> Option<usize> {
    let mut cells: BTreeMap<About, usize> = BTreeMap::new();
    for about in about(tables).into_values() {
        *cells.entry(about).or_default() += 1;
    }
    cells.into_values().min()
}

/// The table of participants.
pub(super) fn participants(
    study: &StudyFile,
    tables: &Tables,
    analysis: &Analysis,
    file: String,
    is_withheld: bool,
) -> Result<Sheet, Error> {
    let columns = [
        "participant",
        "front",
        "state",
        "placed",
        "excluded",
        "reasons",
        "frames",
        "late_frames",
        "gender",
        "age",
    ];
    let about = about(tables);
    let genders = genders(study)?;
    let rows = tables.participants.iter().map(|one| {
        let excluded = analysis.exclusions.excluded.iter().find(|found| found.participant == one.participant);
        let reasons = excluded.map_or(&[][..], |found| &found.reasons).iter().map(rule);
        let [gender, age] =
            about.get(one.participant.as_str()).copied().filter(|_| !is_withheld).unwrap_or_default();
        vec![
            one.participant.clone(),
            name(&one.front),
            name(&one.state),
            one.placed.to_string(),
            excluded.is_some().to_string(),
            reasons.collect::<Vec<_>>().join(" "),
            number(one.frames.map(|frames| frames.all)),
            number(one.frames.map(|frames| frames.late)),
            gender.map_or_else(String::new, |index| genders.get(&index).cloned().unwrap_or_default()),
            number(age),
        ]
    });
    Ok(Sheet::new((file, "a participant"), &columns, &columns[..5], rows.collect()))
}

/// Words of the answers to the question about gender.
fn genders(study: &StudyFile) -> Result<BTreeMap<i64, String>, Error> {
    let languages = &study.study.languages;
    let preferred = languages.first().map_or("", String::as_str);
    let mut found = BTreeMap::new();
    for prompt in prompts(study, BUILT_IN_QUESTIONS[0])?.into_iter().flatten() {
        if let Scale::Options { options } = prompt.scale {
            found.extend(
                options.iter().map(|(index, words)| (*index, words.find(preferred, languages).to_owned())),
            );
        }
    }
    Ok(found)
}

const fn rule(reason: &Reason) -> &'static str {
    match reason {
        Reason::Operator => "operator",
        Reason::FailedCatch { .. } => "failed_catch",
        Reason::MedianMsBelow { .. } => "median_ms_below",
        Reason::SameAnswerShare { .. } => "same_answer_share",
        Reason::LateFramesShare { .. } => "late_frames_share",
    }
}
