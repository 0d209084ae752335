//! What a simulated study leaves: tables of plain values.

use super::store::Store;
use crate::emotion::Emotion;
use crate::study::plan::{Counts, Plan, Role, Stimulus, Trial};
use crate::study::protocol::{Session, State};
use serde::Serialize;
use std::collections::BTreeMap;

/// A participant of a simulated study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Participant {
    /// Number, in the order of arrival.
    pub number: u64,
    /// Where the participation ended.
    pub state: State,
    /// Whether there was a place.
    pub was_placed: bool,
    /// Whether the participant answers at random.
    pub is_careless: bool,
}

/// An answer of a simulated study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AnswerRow {
    /// Number of the participant.
    pub participant: u64,
    /// The page.
    pub page: String,
    /// The question.
    pub question: String,
    /// The number; none for free text.
    pub value: Option<i64>,
    /// From the moment the question was seen to the answer, ms.
    pub ms: u32,
    /// The trial that it is about, if it is about one.
    pub trial: Option<Trial>,
    /// What the trial showed.
    pub stimulus: Option<Stimulus>,
}

/// A simulated study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Run {
    /// Everyone who arrived.
    pub participants: Vec<Participant>,
    /// Participants that got a place, later lapsed or not.
    pub placed: usize,
    /// Participants that found no place.
    pub turned_away: usize,
    /// All last answers of participants that have not withdrawn.
    pub answers: Vec<AnswerRow>,
    /// Fewest and most answers of a stimulus in each fill part.
    pub answered: BTreeMap<String, (u32, u32)>,
    /// Counts of every counted part at the end, by stimulus or row.
    #[serde(skip)]
    pub counts: Vec<Counts>,
    /// From the first arrival to the last event, ms.
    pub duration_ms: i64,
}

/// The answers of a participation, in the order of pages.
pub(crate) fn answers(plan: &Plan, number: u64, session: &Session) -> Vec<AnswerRow> {
    let trial = |page: &str| {
        let (part, position) = page.rsplit_once('/')?;
        let position: u32 = position.parse().ok()?;
        let placed = session.placed().unwrap_or_default();
        let of = |position| placed.iter().find(|trial| trial.part == part && trial.position == position);
        let own = of(position)?;
        let shown = match own.role {
            Role::Repeat { of: first } => of(first)?,
            _ => own,
        };
        let stimuli = &plan.trials_of(part)?.stimuli;
        let stimulus = shown.item.and_then(|item| stimuli.get(item as usize)).cloned();
        Some((own.clone(), stimulus))
    };
    let row = |((page, question), given): (&(String, String), &crate::study::protocol::Given)| {
        let (trial, stimulus) = trial(page).map_or((None, None), |(trial, stimulus)| (Some(trial), stimulus));
        AnswerRow {
            participant: number,
            page: page.clone(),
            question: question.clone(),
            value: given.value,
            ms: given.ms,
            trial,
            stimulus,
        }
    };
    session.answers().iter().map(row).collect()
}

/// Fewest and most answers of a stimulus in each fill part.
pub(super) fn answered(plan: &Plan, store: &Store<'_>) -> BTreeMap<String, (u32, u32)> {
    let ends = |(_, part, _): (usize, &str, &_)| {
        let answered = store.ledger().answered(part)?;
        Some((part.to_owned(), (*answered.iter().min()?, *answered.iter().max()?)))
    };
    plan.counted().filter_map(ends).collect()
}

/// Mean ratings of each gait in the order of [`Emotion::ALL`], and the number of raters, from the ordinary trials of a part that asks
/// `question` (`emotions`) about each emotion. Trials that are not answered whole do not count.
pub fn mean_ratings(
    answers: &[AnswerRow],
    part: &str,
    question: &str,
) -> BTreeMap<String, ([f64; 4], usize)> {
    let mut of_trial: BTreeMap<(&str, u64, &str), [Option<i64>; 4]> = BTreeMap::new();
    for row in answers {
        let is_counted = row.trial.as_ref().is_some_and(|t| t.part == part && t.role == Role::Ordinary);
        let Some(Stimulus::Gait { gait }) = row.stimulus.as_ref().filter(|_| is_counted) else { continue };
        let item = row.question.strip_prefix(question).and_then(|rest| rest.strip_prefix('.'));
        let Some(emotion) = item.and_then(|item| item.parse::<Emotion>().ok()) else { continue };
        of_trial.entry((gait, row.participant, &row.page)).or_default()[emotion.index()] = row.value;
    }
    let mut sums: BTreeMap<String, ([i64; 4], i32)> = BTreeMap::new();
    for ((gait, ..), values) in of_trial {
        let [Some(happy), Some(angry), Some(sad), Some(neutral)] = values else { continue };
        let (sum, count) = sums.entry(gait.to_owned()).or_default();
        [happy, angry, sad, neutral].iter().zip(sum).for_each(|(value, sum)| *sum += value);
        *count += 1;
    }
    #[allow(clippy::cast_precision_loss, reason = "sums of ratings are small")]
    let mean = |(gait, (sum, count)): (String, ([i64; 4], i32))| {
        (gait, (sum.map(|sum| sum as f64 / f64::from(count)), usize::try_from(count).unwrap_or(0)))
    };
    sums.into_iter().map(mean).collect()
}
