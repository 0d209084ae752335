//! Participants that the rules of `[exclude]` leave out.

use super::common::real;
use crate::statistics::quantile;
use crate::study::file::Exclude;
use crate::study::plan::Ending;
use crate::study::protocol::State;
use crate::study::tables::{Answer, Participant, Role, Tables};
use serde::Serialize;
use std::collections::BTreeMap;

/// Fewest answers to one question, all items and trials together, from which the share of the most frequent one is judged.
pub const LEAST_ANSWERS: usize = 8;

/// Who was excluded, and by which rules.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Exclusions {
    /// The rules of the file.
    pub rules: Exclude,
    /// Rules that no participant could be judged by, since the tables lack what they need.
    pub not_judged: Vec<Rule>,
    /// The excluded, in the order of the table.
    pub excluded: Vec<Excluded>,
}

impl Exclusions {
    /// Whether a participant is excluded.
    pub fn has(&self, participant: &str) -> bool {
        self.excluded.iter().any(|one| one.participant == participant)
    }
}

/// A rule of `[exclude]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// Instructed answers given wrongly.
    FailedCatch,
    /// Median time of an answer.
    MedianMsBelow,
    /// Share of the most frequent answer.
    SameAnswerShare,
    /// Share of late frames.
    LateFramesShare,
}

/// An excluded participant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Excluded {
    /// Code or number.
    pub participant: String,
    /// Every reason that applies.
    pub reasons: Vec<Reason>,
}

/// Why a participant is excluded.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "rule", rename_all = "snake_case")]
pub enum Reason {
    /// The operator excluded the participant while the study ran.
    Operator,
    /// Instructed trials with a wrong answer reach the rule's number.
    FailedCatch {
        /// Instructed trials with a wrong answer.
        failed: u32,
        /// The rule's number.
        least: u32,
    },
    /// The median time of an answer to an ordinary or repeated trial is below the rule's.
    MedianMsBelow {
        /// The median, ms.
        median: f64,
        /// The rule's time, ms.
        below: u32,
    },
    /// The most frequent answer to a question has a share above the rule's.
    SameAnswerShare {
        /// The question, all of its items together.
        question: String,
        /// The share.
        share: f64,
        /// The rule's share.
        above: f64,
    },
    /// Late frames have a share above the rule's.
    LateFramesShare {
        /// The share.
        share: f64,
        /// The rule's share.
        above: f64,
    },
}

/// What a participant did, as far as rules need it.
#[derive(Default)]
struct Record<'t> {
    /// Instructed trials by page: whether an answer is wrong.
    catches: BTreeMap<&'t str, bool>,
    /// Times of answers to trials that show something, ms.
    times: Vec<f64>,
    /// Numbers of each answer, by question.
    counts: BTreeMap<&'t str, BTreeMap<i64, usize>>,
}

pub(super) fn exclusions(rules: &Exclude, tables: &Tables) -> Exclusions {
    let mut records: BTreeMap<&str, Record<'_>> = BTreeMap::new();
    for row in &tables.answers {
        records.entry(&row.participant).or_default().add(row);
    }
    let none = Record::default();
    let of = |one: &Participant| records.get(one.participant.as_str()).unwrap_or(&none);
    let mut excluded = Vec::new();
    for one in &tables.participants {
        let reasons = reasons(rules, one, of(one));
        if !reasons.is_empty() {
            excluded.push(Excluded { participant: one.participant.clone(), reasons });
        }
    }
    let lacks = |rule: &Rule| match rule {
        Rule::FailedCatch => rules.failed_catch.is_some() && records.values().all(|r| r.catches.is_empty()),
        Rule::MedianMsBelow => {
            rules.median_ms_below.is_some() && records.values().all(|record| record.times.is_empty())
        }
        Rule::SameAnswerShare => {
            rules.same_answer_share.is_some() && records.values().all(|record| record.same().is_none())
        }
        Rule::LateFramesShare => {
            rules.late_frames_share.is_some() && tables.participants.iter().all(|one| late(one).is_none())
        }
    };
    let all = [Rule::FailedCatch, Rule::MedianMsBelow, Rule::SameAnswerShare, Rule::LateFramesShare];
    let not_judged = all.into_iter().filter(lacks).collect();
    Exclusions { rules: rules.clone(), not_judged, excluded }
}

impl<'t> Record<'t> {
    fn add(&mut self, row: &'t Answer) {
        let (Some(trial), Some(value)) = (row.trial, row.number()) else { return };
        if let Role::Catch(answer) = trial.role {
            *self.catches.entry(&row.page).or_default() |= value != answer;
            return;
        }
        self.times.extend(row.ms.map(f64::from));
        let question = row.question.split('.').next().unwrap_or_default();
        *self.counts.entry(question).or_default().entry(value).or_default() += 1;
    }

    /// The question whose most frequent answer has the greatest share.
    fn same(&self) -> Option<(&'t str, f64)> {
        let share = |(question, counts): (&&'t str, &BTreeMap<i64, usize>)| {
            let all: usize = counts.values().sum();
            let most = counts.values().max().copied().unwrap_or(0);
            (all >= LEAST_ANSWERS).then(|| (*question, real(most) / real(all)))
        };
        self.counts.iter().filter_map(share).max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

fn late(one: &Participant) -> Option<f64> {
    #[allow(clippy::cast_precision_loss, reason = "frames are far below 2^53")]
    one.frames.filter(|frames| frames.all > 0).map(|frames| frames.late as f64 / frames.all as f64)
}

fn reasons(rules: &Exclude, one: &Participant, record: &Record<'_>) -> Vec<Reason> {
    let mut reasons = Vec::new();
    if one.state == State::Ended(Ending::Excluded) {
        reasons.push(Reason::Operator);
    }
    if let Some(least) = rules.failed_catch {
        let failed = record.catches.values().filter(|&&is_wrong| is_wrong).count();
        let failed = u32::try_from(failed).unwrap_or(u32::MAX);
        if failed > 0 && failed >= least {
            reasons.push(Reason::FailedCatch { failed, least });
        }
    }
    if let Some(below) = rules.median_ms_below
        && let Ok(median) = quantile(&record.times, 0.5)
        && median < f64::from(below)
    {
        reasons.push(Reason::MedianMsBelow { median, below });
    }
    if let Some(above) = rules.same_answer_share
        && let Some((question, share)) = record.same()
        && share > above
    {
        reasons.push(Reason::SameAnswerShare { question: question.to_owned(), share, above });
    }
    if let Some(above) = rules.late_frames_share
        && let Some(share) = late(one)
        && share > above
    {
        reasons.push(Reason::LateFramesShare { share, above });
    }
    reasons
}
