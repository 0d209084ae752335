//! The pages of a part with trials, in order.

use crate::study::plan::{Role, Trial, TrialsStep};

/// A page of a part with trials.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stop {
    /// The trial of this index: its stimulus, then its questions.
    Trial(usize),
    /// The questions after a block, which counts from 1.
    AfterBlock(u32),
    /// A rest after a block, which counts from 1.
    Rest(u32),
}

/// The pages of a part with these trials.
pub(super) fn stops(step: &TrialsStep, trials: &[Trial]) -> Vec<Stop> {
    let mut stops = Vec::new();
    for (index, trial) in trials.iter().enumerate() {
        stops.push(Stop::Trial(index));
        let next = trials.get(index + 1);
        let Some(block) = trial.block.filter(|_| next.is_none_or(|next| next.block != trial.block)) else {
            continue;
        };
        let block = block + 1;
        if !step.after_block.is_empty() {
            stops.push(Stop::AfterBlock(block));
        }
        let rests = step.rest_after_blocks.is_some_and(|every| every > 0 && block.is_multiple_of(every));
        if rests && next.is_some() {
            stops.push(Stop::Rest(block));
        }
    }
    stops
}

/// Whether a trial shows something.
pub(super) const fn shows(trial: &Trial) -> bool {
    !matches!(trial.role, Role::Catch { .. })
}
