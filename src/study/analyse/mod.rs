//! The planned analysis of a study: exclusions, tests of conditions, emotions that were identified.
//!
//! Every test is computed twice: of all participants that finished, and of those that no rule of `[exclude]` leaves out. Simulated
//! participants and people are never mixed.

mod conditions;
mod exclude;
mod identify;
mod markdown;

pub use conditions::{ConditionTest, Conditions, Pair};
pub use exclude::{Excluded, Reason};
pub use identify::Identified;

use super::error::Error;
use super::file::{Part, Question, StudyFile, Test};
use super::tables::{Answer, FINISHED, SIMULATED, Tables};
use crate::emotion::Emotion;
use conditions::Wish;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// What a study found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Analysis {
    /// The study's id.
    pub study: String,
    /// Its version.
    pub version: u32,
    /// Whether the participants are simulated.
    pub is_simulated: bool,
    /// Participants by the state in which they ended.
    pub states: BTreeMap<String, usize>,
    /// Participants that finished.
    pub finished: usize,
    /// Of them, who is left out by the rules of the study file.
    pub excluded: Vec<Excluded>,
    /// The tests without the excluded.
    pub results: Vec<Finding>,
    /// The tests of all that finished.
    pub with_excluded: Vec<Finding>,
}

/// What one planned test found.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Finding {
    /// Tests of conditions.
    Friedman(Conditions),
    /// Emotions that were shown and answered.
    Confusion(Box<Identified>),
}

/// Analyses the answers of a study as its file plans it.
///
/// # Errors
/// [`Error::Analysis`] if people and simulated participants are mixed, if none finished, or if a test lacks answers;
/// [`Error::Statistics`] for numbers that no statistic can be computed of.
pub fn analyse(file: &StudyFile, tables: &Tables) -> Result<Analysis, Error> {
    let study = &file.study;
    let wrong = |message: &str| Error::Analysis { test: study.id.clone(), message: message.to_owned() };
    let simulated = tables.people.iter().filter(|one| one.front == SIMULATED).count();
    if simulated > 0 && simulated < tables.people.len() {
        return Err(wrong("simulated participants are mixed with people; analyse them apart"));
    }
    let mut states = BTreeMap::new();
    for one in &tables.people {
        *states.entry(one.state.clone()).or_default() += 1;
    }
    let finished: BTreeSet<&str> = tables
        .people
        .iter()
        .filter(|one| one.state == FINISHED)
        .map(|one| one.participant.as_str())
        .collect();
    if finished.is_empty() {
        return Err(wrong("no participant finished"));
    }
    let excluded = exclude::excluded(tables, &file.exclude);
    let out: BTreeSet<&str> = excluded.iter().map(|one| one.participant.as_str()).collect();
    let of = |is_in: &dyn Fn(&str) -> bool| {
        let own: Vec<&Answer> = tables.answers.iter().filter(|one| is_in(&one.participant)).collect();
        if own.is_empty() && !file.analysis.tests.is_empty() {
            return Err(wrong("the rules of [exclude] leave everyone out"));
        }
        file.analysis.tests.iter().map(|test| finding(file, &own, test)).collect::<Result<Vec<_>, _>>()
    };
    let all = |participant: &str| finished.contains(participant);
    let kept = |participant: &str| all(participant) && !out.contains(participant);
    let (results, with_excluded) = (of(&kept)?, of(&all)?);
    Ok(Analysis {
        study: study.id.clone(),
        version: study.version,
        is_simulated: simulated > 0,
        states,
        finished: finished.len(),
        excluded,
        results,
        with_excluded,
    })
}

fn finding(file: &StudyFile, answers: &[&Answer], test: &Test) -> Result<Finding, Error> {
    match test {
        Test::Friedman { of, by, within, then } => {
            let part = of.split('.').next().and_then(|part| file.parts.get(part)).and_then(Part::trials);
            let show = part.map(|part| &part.show);
            let order = show.and_then(|show| {
                if by == "scene" { show.scenes.as_deref() } else { show.conditions.as_deref() }
            });
            let order = order.unwrap_or_default();
            let wish = Wish { of, by, within: within.as_deref(), then: then.as_ref(), order };
            Ok(Finding::Friedman(conditions::conditions(answers, wish)?))
        }
        Test::Confusion { of } => {
            let options = emotions(file, of)?;
            Ok(Finding::Confusion(Box::new(identify::identified(answers, of, &options)?)))
        }
    }
}

/// The emotions that a choice offers, in its order.
fn emotions(file: &StudyFile, of: &str) -> Result<Vec<Emotion>, Error> {
    let wrong = |message: String| Error::Analysis { test: of.to_owned(), message };
    let name = of.split_once('.').map_or("", |(_, question)| question);
    let Some(Question::Choice { options, .. }) = file.questions.get(name) else {
        return Err(wrong(format!("questions.{name} must be a choice among the emotions")));
    };
    let language = file.study.languages.first().map_or("en", String::as_str);
    let emotion = |option: &super::Words| {
        option.find(language, &[]).parse::<Emotion>().map_err(|error| wrong(error.to_string()))
    };
    options.iter().map(emotion).collect()
}
