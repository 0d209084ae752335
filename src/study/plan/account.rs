//! The books of one part, and what one participant holds of it.

use super::blocks::Blocks;
use super::compile::{Plan, TrialsStep};
use super::draw::word;
use super::fill::Fill;
use super::rows::Rows;
use super::square::Square;
use super::trials::{Swap, Trial, small};
use crate::study::file::Design;
use std::collections::BTreeSet;
use std::ops::Range;

#[derive(Debug, Clone)]
pub(super) enum Account {
    Fill(Fill),
    Blocks(Blocks, Rows),
    Square(Square, Rows),
    Same,
}

#[derive(Debug, Clone)]
pub(super) struct Holder {
    pub(super) place: u64,
    pub(super) trials: Vec<Trial>,
    /// Trials that are answered or left out, by index.
    pub(super) done: BTreeSet<usize>,
    pub(super) has_lapsed: bool,
}

impl Holder {
    pub(super) fn is_done(&self) -> bool {
        self.done.len() == self.trials.len()
    }

    pub(super) fn index(&self, part: &str, position: u32) -> Option<usize> {
        self.trials.iter().position(|trial| trial.part == part && trial.position == position)
    }

    /// Stimuli of a part that the participant has or had.
    pub(super) fn items(&self, part: &str) -> Vec<usize> {
        let own = self.trials.iter().filter(|trial| trial.part == part);
        own.filter_map(|trial| trial.item).map(|item| item as usize).collect()
    }

    pub(super) fn swap(&mut self, swap: &Swap) {
        if let Some(index) = self.index(&swap.part, swap.position) {
            self.trials[index].item = swap.item;
        }
    }

    /// Whether all of a part's trials are done.
    pub(super) fn has_done(&self, part: &str) -> bool {
        self.trials.iter().enumerate().all(|(at, trial)| trial.part != part || self.done.contains(&at))
    }
}

impl Account {
    pub(super) fn of(plan: &Plan, name: &str, step: &TrialsStep) -> Self {
        let items = step.stimuli.len();
        match step.design {
            Some(Design::Fill { each, at_least }) => {
                Self::Fill(Fill::new(plan.seed ^ word(name), items, each as usize, at_least))
            }
            Some(Design::Blocks { .. }) => {
                let conditions = step.conditions.max(1);
                let blocks = Blocks::new(items / conditions, conditions);
                let rows = Rows::new(blocks.rows());
                Self::Blocks(blocks, rows)
            }
            Some(Design::Square) => {
                let square = Square::new(items);
                let rows = Rows::new(square.rows());
                Self::Square(square, rows)
            }
            None => Self::Same,
        }
    }

    /// Rows of its design; 0 without one.
    pub(super) fn rows(&self) -> usize {
        match self {
            Self::Blocks(_, rows) | Self::Square(_, rows) => rows.count(),
            Self::Fill(_) | Self::Same => 0,
        }
    }

    /// The trials of a new participant, with a row of `among` if that is given.
    pub(super) fn admit(
        &mut self,
        plan: &Plan,
        (name, step): (&str, &TrialsStep),
        person: u64,
        among: Option<&Range<u32>>,
    ) -> Vec<Trial> {
        match self {
            // another fill part may be the one that still lacks answers: this one is then not asked
            Self::Fill(fill) => {
                fill.admit(person).map_or_else(Vec::new, |items| plan.fill_trials(name, step, person, &items))
            }
            Self::Blocks(blocks, rows) => {
                let row = rows.admit(among, |cycle| blocks.cycle(plan.seed, cycle)).unwrap_or_default();
                plan.block_trials(name, step, person, (blocks, row))
            }
            Self::Square(square, rows) => {
                let row = rows.admit(among, |_| square.cycle()).unwrap_or_default();
                plan.square_trials(name, step, person, (square, row))
            }
            Self::Same => plan.fixed_trials(name, step),
        }
    }

    /// Leases of trials that a store has.
    pub(super) fn take<'a>(&mut self, trials: impl Iterator<Item = &'a Trial>) {
        let mut trials = trials.peekable();
        match self {
            Self::Fill(fill) => {
                trials.filter_map(|trial| trial.item).for_each(|item| fill.lease(item as usize));
            }
            Self::Blocks(_, rows) | Self::Square(_, rows) => {
                if let Some(row) = trials.peek().and_then(|trial| trial.row) {
                    rows.lease_again(row as usize);
                }
            }
            Self::Same => {}
        }
    }

    pub(super) fn answer(&mut self, trial: &Trial, is_late: bool, ends_part: bool) {
        match self {
            Self::Fill(fill) => match (trial.item, is_late) {
                (Some(item), false) => fill.answer(item as usize),
                (Some(item), true) => fill.answer_late(item as usize),
                (None, _) => {}
            },
            Self::Blocks(_, rows) | Self::Square(_, rows) => match trial.row {
                Some(row) if ends_part && is_late => rows.finish_late(row as usize),
                Some(row) if ends_part => rows.finish(row as usize),
                _ => {}
            },
            Self::Same => {}
        }
    }

    pub(super) fn lapse(&mut self, holder: &Holder, name: &str) {
        match self {
            Self::Fill(fill) => {
                open(holder, name)
                    .filter_map(|(_, trial)| trial.item)
                    .for_each(|item| fill.lapse(item as usize));
            }
            Self::Blocks(_, rows) | Self::Square(_, rows) => {
                if let Some(row) = open(holder, name).find_map(|(_, trial)| trial.row) {
                    rows.lapse(row as usize);
                }
            }
            Self::Same => {}
        }
    }

    pub(super) fn resume(
        &mut self,
        holder: &mut Holder,
        name: &str,
        person: u64,
        shown: Option<(&str, u32)>,
    ) -> Vec<Swap> {
        match self {
            Self::Fill(fill) => {
                let lost: Vec<(usize, u32)> =
                    open(holder, name).filter_map(|(at, trial)| Some((at, trial.item?))).collect();
                lost.into_iter()
                    .filter_map(|(at, item)| resume_item(fill, holder, (at, item), person, shown))
                    .collect()
            }
            Self::Blocks(_, rows) | Self::Square(_, rows) => {
                if let Some(row) = open(holder, name).find_map(|(_, trial)| trial.row) {
                    rows.lease_again(row as usize);
                }
                Vec::new()
            }
            Self::Same => Vec::new(),
        }
    }

    pub(super) fn delete(&mut self, holder: &Holder, name: &str) {
        match self {
            Self::Fill(fill) => {
                let done = holder.done.iter().map(|&at| &holder.trials[at]);
                done.filter(|trial| trial.part == name)
                    .filter_map(|trial| trial.item)
                    .for_each(|item| fill.delete(item as usize));
            }
            Self::Blocks(_, rows) | Self::Square(_, rows) => {
                let row = holder.trials.iter().find(|trial| trial.part == name).and_then(|trial| trial.row);
                if let Some(row) = row.filter(|_| holder.has_done(name)) {
                    rows.delete(row as usize);
                }
            }
            Self::Same => {}
        }
    }
}

/// A participant's trials of a part that are not done, by index.
pub(super) fn open<'a>(holder: &'a Holder, name: &'a str) -> impl Iterator<Item = (usize, &'a Trial)> {
    let trials = holder.trials.iter().enumerate();
    trials.filter(move |(at, trial)| trial.part == name && !holder.done.contains(at))
}

/// Leases a stimulus again, or another one in its place.
fn resume_item(
    fill: &mut Fill,
    holder: &mut Holder,
    (at, item): (usize, u32),
    person: u64,
    shown: Option<(&str, u32)>,
) -> Option<Swap> {
    let (part, position) = (holder.trials[at].part.clone(), holder.trials[at].position);
    if shown == Some((&part, position)) {
        fill.lease(item as usize);
        return None;
    }
    let taken = small(fill.lease_again(person, item as usize, &holder.items(&part)));
    if taken == item {
        return None;
    }
    holder.trials[at].item = Some(taken);
    Some(Swap { part, position, item: Some(taken) })
}
