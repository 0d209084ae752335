//! Who is left out by the rules that the study file had before the first participant came.

use crate::study::file::Exclude;
use crate::study::tables::{Answer, CATCH, FINISHED, Tables};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// A participant that rules leave out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Excluded {
    /// The participant.
    pub participant: String,
    /// The rules that hold, with what was found.
    pub reasons: Vec<Reason>,
}

/// A rule that leaves a participant out, with what was found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "rule", rename_all = "snake_case")]
pub enum Reason {
    /// Instructed answers were given wrongly.
    FailedCatch {
        /// How many trials.
        found: u32,
    },
    /// Answers came too fast.
    MedianMsBelow {
        /// Median time of an answer, ms.
        found: u32,
    },
    /// Too many answers were the same.
    SameAnswerShare {
        /// Share of the most frequent answer.
        found: f64,
    },
}

/// The participants that finished and that a rule leaves out.
pub(super) fn excluded(tables: &Tables, rules: &Exclude) -> Vec<Excluded> {
    let finished: BTreeSet<&str> = tables
        .people
        .iter()
        .filter(|one| one.state == FINISHED)
        .map(|one| one.participant.as_str())
        .collect();
    let mut own: BTreeMap<&str, Vec<&Answer>> = BTreeMap::new();
    for answer in tables.answers.iter().filter(|answer| !answer.role.is_empty()) {
        own.entry(&answer.participant).or_default().push(answer);
    }
    let judged = own.into_iter().filter(|(participant, _)| finished.contains(participant));
    let found = judged.map(|(participant, answers)| Excluded {
        participant: participant.to_owned(),
        reasons: reasons(&answers, rules),
    });
    found.filter(|one| !one.reasons.is_empty()).collect()
}

fn reasons(answers: &[&Answer], rules: &Exclude) -> Vec<Reason> {
    let mut reasons = Vec::new();
    let wrong = |answer: &&&Answer| answer.role == CATCH && answer.value != answer.wanted;
    let failed: BTreeSet<&str> = answers.iter().filter(wrong).map(|answer| answer.page.as_str()).collect();
    let failed = u32::try_from(failed.len()).unwrap_or(u32::MAX);
    if rules.failed_catch.is_some_and(|least| failed >= least) {
        reasons.push(Reason::FailedCatch { found: failed });
    }
    let median = median_ms(answers);
    if rules.median_ms_below.is_some_and(|least| median < least) {
        reasons.push(Reason::MedianMsBelow { found: median });
    }
    let same = same_share(answers);
    if rules.same_answer_share.is_some_and(|most| same > most) {
        reasons.push(Reason::SameAnswerShare { found: same });
    }
    reasons
}

/// Median time of a page of answers, over its number of answers, ms. Times of answers count from when the page was seen.
fn median_ms(answers: &[&Answer]) -> u32 {
    let mut pages: BTreeMap<&str, (u32, u32)> = BTreeMap::new();
    for answer in answers {
        let (last, count) = pages.entry(&answer.page).or_default();
        *last = (*last).max(answer.ms);
        *count += 1;
    }
    let mut times: Vec<u32> = pages.into_values().map(|(last, count)| last / count.max(1)).collect();
    times.sort_unstable();
    times.get(times.len() / 2).copied().unwrap_or(u32::MAX)
}

/// Share of the most frequent number among all that are not instructed.
fn same_share(answers: &[&Answer]) -> f64 {
    let mut counts: BTreeMap<i64, u32> = BTreeMap::new();
    for value in answers.iter().filter(|answer| answer.role != CATCH).filter_map(|answer| answer.value) {
        *counts.entry(value).or_default() += 1;
    }
    let most = counts.values().max().copied().unwrap_or(0);
    f64::from(most) / f64::from(counts.values().sum::<u32>().max(1))
}
