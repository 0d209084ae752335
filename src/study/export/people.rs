//! The table of participants, and how much of gender and age may be in it.

use super::columns::number;
use super::notes::SMALLEST_CELL;
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

/// First years of the bands that ages are given in, with what the bands are called.
const BANDS: [(i64, &str); 7] =
    [(0, "0-17"), (18, "18-24"), (25, "25-34"), (35, "35-44"), (45, "45-54"), (55, "55-64"), (65, "65+")];

/// The band of an age, by its index.
fn band(age: i64) -> usize {
    BANDS.iter().rposition(|(first, _)| age >= *first).unwrap_or(0)
}

/// How much of gender and age a dataset gives away.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Detail {
    /// Both as they were answered.
    Exact,
    /// The gender, and the age in a band.
    Bands,
    /// The gender alone.
    Gender,
    /// Neither.
    Nothing,
}

impl Detail {
    /// The most detail of which [`SMALLEST_CELL`] people or more share each combination that is there.
    pub(super) fn of(tables: &Tables) -> Self {
        let all = about(tables);
        let is_safe = |detail: &Self| {
            let mut cells: BTreeMap<About, usize> = BTreeMap::new();
            for about in all.values() {
                *cells.entry(detail.cell(*about)).or_default() += 1;
            }
            cells.into_values().all(|count| count >= SMALLEST_CELL)
        };
        [Self::Exact, Self::Bands, Self::Gender].into_iter().find(is_safe).unwrap_or(Self::Nothing)
    }

    /// What is left of an answer to both.
    fn cell(self, [gender, age]: About) -> About {
        match self {
            Self::Exact => [gender, age],
            Self::Bands => [gender, age.map(|age| BANDS[band(age)].0)],
            Self::Gender => [gender, None],
            Self::Nothing => [None, None],
        }
    }

    /// Whether the answers to a question are in the tables.
    pub(super) fn has(self, question: &str) -> bool {
        let [gender, age] = BUILT_IN_QUESTIONS;
        !(question == age && self != Self::Exact || question == gender && self == Self::Nothing)
    }
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
    detail: Detail,
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
        "age_band",
    ];
    let about = about(tables);
    let genders = genders(study)?;
    let rows = tables.participants.iter().map(|one| {
        let excluded = analysis.exclusions.excluded.iter().find(|found| found.participant == one.participant);
        let reasons = excluded.map_or(&[][..], |found| &found.reasons).iter().map(rule);
        let said = about.get(one.participant.as_str()).copied().unwrap_or_default();
        let [gender, age] = detail.cell(said);
        let band = age.filter(|_| detail == Detail::Bands).map(|age| BANDS[band(age)].1.to_owned());
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
            number(age.filter(|_| detail == Detail::Exact)),
            band.unwrap_or_default(),
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
