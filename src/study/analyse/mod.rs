//! The planned analysis: exclusions by the rules of the study file, then its tests, each with and without the excluded.
//!
//! [`analyse()`] gives facts as fields; [`markdown()`] makes a page of them. Simulated participants and people never enter one
//! analysis.
//!
//! ```
//! use gaitway::study::analyse::{analyse, markdown};
//! use gaitway::study::plan::Plan;
//! use gaitway::study::simulate::{Habits, Minds, Setup, run};
//! use gaitway::study::tables::Tables;
//! use gaitway::study::{Materials, Study};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let study = Study::builtin("eva-agents")?;
//! let plan = Plan::of(&study.file, &Materials::default())?;
//! let setup = Setup { participants: 24, at_once: 6, habits: Habits::default(), seed: 1 };
//! let (_, run) = run(&plan, &Minds::default(), setup)?;
//! let analysis = analyse(&study.file, &Tables::simulated(&run))?;
//! assert!(!analysis.is_short && analysis.tests.len() == 2);
//! println!("{}", markdown(&analysis));
//! # Ok(())
//! # }
//! ```

mod answers;
mod common;
mod confusion;
mod exclude;
mod friedman;
mod parts;
mod questionnaires;
mod ratings;
mod report;

pub use answers::{Group, ItemAnswers};
pub use common::{CONFIDENCE, DRAWS, Error};
pub use confusion::ConfusionBlock;
pub use exclude::{Excluded, Exclusions, LEAST_ANSWERS, Reason, Rule};
pub use friedman::{FriedmanBlock, FriedmanTest, LEVEL, Level, Outcome, Pair};
pub use parts::{Gaits, PartCount};
pub use questionnaires::{Change, ChangeTest, PageScores, Questionnaire, Score, ScoreRow, scores};
pub use ratings::{LabelStability, RatingBlock};
pub use report::{html, markdown};

use super::file::{self, Front, OnWithdrawal, StudyFile};
use super::plan::Ending;
use super::protocol::State;
use super::tables::{Chosen, Tables, Value};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// The planned analysis of a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Analysis {
    /// Name of the study.
    pub study: String,
    /// Version of its file.
    pub version: u32,
    /// Title, in the first language.
    pub title: String,
    /// Who took part.
    pub participants: Participants,
    /// Who was excluded.
    pub exclusions: Exclusions,
    /// Answers of each counted part, without the excluded.
    pub parts: Vec<PartCount>,
    /// The tests, in the order of the file.
    pub tests: Vec<Test>,
    /// Scores of questionnaires, in the order of the flow.
    pub questionnaires: Sides<Vec<Questionnaire>>,
    /// Ratings of gaits, if the file asks for labels.
    pub ratings: Option<Box<Sides<RatingBlock>>>,
    /// Answers to each item of each scale after trials, without the excluded.
    pub answers: Vec<ItemAnswers>,
    /// Free texts of participants. The page does not print them, since they may tell who wrote them.
    pub free_texts: usize,
    /// Whether a part or a test has fewer participants or answers than the plan's least, without the excluded.
    pub is_short: bool,
}

/// Who took part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Participants {
    /// All that arrived.
    pub arrived: usize,
    /// Those with a place.
    pub placed: usize,
    /// Those with an answer to an ordinary trial that are not excluded.
    pub analysed: usize,
    /// Whether all are simulated. None of them is otherwise.
    pub is_simulated: bool,
    /// Participants by front.
    pub fronts: BTreeMap<Front, usize>,
    /// Participants of the data that the analysis is not of, by front.
    pub left_out: BTreeMap<Front, usize>,
    /// Participants by state.
    pub states: BTreeMap<String, usize>,
}

/// A test with its result.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Test {
    /// Friedman tests, one an item and a level of `within`.
    Friedman(Box<Sides<FriedmanBlock>>),
    /// A confusion matrix.
    Confusion(Box<Sides<ConfusionBlock>>),
}

/// A result without and with the excluded participants.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sides<T> {
    /// Without the excluded.
    pub kept: T,
    /// With them; none if no participant is excluded, where it would be the same.
    pub everyone: Option<T>,
}

/// Analyses a study as its file plans it. Answers of withdrawn participants count only where the file keeps them.
///
/// # Errors
/// [`Error::Mixed`] for people together with simulated participants. [`Error::Study`] for a test of questions or parts that the file
/// lacks, and for answers that do not fit the file. [`Error::Statistics`] where a statistic is undefined.
pub fn analyse(study: &StudyFile, tables: &Tables) -> Result<Analysis, Error> {
    let mut participants = participants(tables)?;
    let Split { everyone, exclusions, kept } = split(study, tables);
    participants.analysed = analysed(&kept);
    let everyone = (!exclusions.excluded.is_empty()).then_some(&everyone);
    let sides = |tables: &Tables| questionnaires::questionnaires(study, tables);
    let questionnaires = Sides { kept: sides(&kept)?, everyone: everyone.map(sides).transpose()? };
    let ratings = match ratings::Planned::new(study)? {
        None => None,
        Some(plan) => Some(Box::new(Sides {
            kept: plan.block(&kept)?,
            everyone: everyone.map(|tables| plan.block(tables)).transpose()?,
        })),
    };
    let mut tests = Vec::new();
    for (index, test) in study.analysis.tests.iter().enumerate() {
        let key = format!("analysis.test[{index}]");
        let seed = study.study.seed.wrapping_add(index as u64);
        tests.push(match test {
            file::Test::Friedman { of, by, within, then } => {
                let plan = friedman::Planned::new(study, &key, of, [by, within.as_deref().unwrap_or("")])?;
                let block = |tables: &Tables| plan.block(tables, then.as_ref(), seed);
                Test::Friedman(Box::new(Sides {
                    kept: block(&kept)?,
                    everyone: everyone.map(block).transpose()?,
                }))
            }
            file::Test::Confusion { of } => {
                let plan = confusion::Planned::new(study, &key, of)?;
                let block = |tables: &Tables| plan.block(tables, seed);
                Test::Confusion(Box::new(Sides {
                    kept: block(&kept)?,
                    everyone: everyone.map(block).transpose()?,
                }))
            }
        });
    }
    let parts = parts::counts(study, &kept);
    let is_short = parts.iter().any(|part| part.short_of.is_some()) || tests.iter().any(Test::is_short);
    let preferred = study.study.languages.first().map_or("", String::as_str);
    Ok(Analysis {
        study: study.study.id.clone(),
        version: study.study.version,
        title: study.study.title.find(preferred, &study.study.languages).to_owned(),
        participants,
        exclusions,
        parts,
        tests,
        questionnaires,
        ratings,
        answers: answers::answers(study, &kept)?,
        free_texts: kept.answers.iter().filter(|row| matches!(row.value, Some(Value::Text(_)))).count(),
        is_short,
    })
}

/// Analyses the participants that were chosen. The analysis says who was left out.
///
/// # Errors
/// As [`analyse()`].
pub fn analyse_chosen(study: &StudyFile, chosen: &Chosen) -> Result<Analysis, Error> {
    let mut found = analyse(study, &chosen.tables)?;
    found.participants.left_out.clone_from(&chosen.left_out);
    Ok(found)
}

/// The tables that an analysis keeps: without the answers of withdrawn participants, unless the file keeps them, and without the
/// excluded.
pub fn kept(study: &StudyFile, tables: &Tables) -> Tables {
    split(study, tables).kept
}

/// The tables without the participants that withdrew, unless the file keeps their answers.
pub fn not_withdrawn(study: &StudyFile, tables: &Tables) -> Tables {
    let deletes = study.consent.on_withdrawal == OnWithdrawal::Delete;
    tables.only(|one| !(deletes && one.state == State::Ended(Ending::Withdrawn)))
}

/// The sheet of ratings that `gait ratings` reads, of the participants that an analysis keeps; none unless the file asks for labels.
///
/// # Errors
/// [`Error::Study`] if the part of `[analysis] ratings` does not ask about the four emotions, 1 to 5.
pub fn rating_sheet(study: &StudyFile, tables: &Tables) -> Result<Option<String>, Error> {
    Ok(ratings::Planned::new(study)?.map(|plan| plan.sheet(&kept(study, tables))))
}

/// Tables with and without the excluded.
struct Split {
    everyone: Tables,
    exclusions: Exclusions,
    kept: Tables,
}

fn split(study: &StudyFile, tables: &Tables) -> Split {
    let everyone = not_withdrawn(study, tables);
    let exclusions = exclude::exclusions(&study.exclude, &everyone);
    let kept = everyone.only(|one| !exclusions.has(&one.participant));
    Split { everyone, exclusions, kept }
}

/// Participants with an answer to an ordinary trial.
fn analysed(tables: &Tables) -> usize {
    let ordinary = tables.answers.iter().filter(|row| row.is_ordinary());
    ordinary.map(|row| row.participant.as_str()).collect::<BTreeSet<_>>().len()
}

impl Test {
    fn is_short(&self) -> bool {
        match self {
            Self::Friedman(sides) => sides.kept.tests.iter().any(|test| test.short_of.is_some()),
            Self::Confusion(sides) => sides.kept.short_of.is_some(),
        }
    }
}

fn participants(tables: &Tables) -> Result<Participants, Error> {
    let fronts = tables.fronts();
    let mut states = BTreeMap::new();
    for one in &tables.participants {
        *states.entry(super::tables::name(&one.state)).or_insert(0) += 1;
    }
    let arrived = tables.participants.len();
    let simulated = fronts.get(&Front::Simulated).copied().unwrap_or(0);
    if simulated > 0 && simulated < arrived {
        return Err(Error::Mixed { people: arrived - simulated, simulated });
    }
    let placed = tables.participants.iter().filter(|one| one.placed).count();
    let left_out = BTreeMap::new();
    Ok(Participants { arrived, placed, analysed: 0, is_simulated: simulated > 0, fronts, left_out, states })
}
