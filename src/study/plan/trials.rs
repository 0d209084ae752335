//! Stimuli and trials.

use super::blocks::Blocks;
use super::compile::{Plan, Step, StepKind, TrialsStep};
use super::draw::{Purpose, random, word};
use super::square::Square;
use crate::study::file::{Design, Seeds};
use serde::{Deserialize, Serialize};

/// Seeds a stimulus is shown with where it is a clip, made before the study.
const CLIP_SEEDS: usize = 3;

/// What a trial shows. It never reaches a browser, which knows its [name](Plan::name) alone.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Stimulus {
    /// A gait of a library.
    Gait {
        /// Its name.
        gait: String,
    },
    /// A scene.
    Scene {
        /// Its name.
        scene: String,
        /// The condition.
        condition: String,
    },
    /// A single agent; its gait is drawn by the trial's seed.
    Agent {
        /// The emotion that it is to show.
        emotion: String,
        /// Its avatar.
        body: String,
        /// The condition.
        condition: String,
    },
}

impl Stimulus {
    /// The scene, if it is one.
    pub fn scene(&self) -> Option<&str> {
        match self {
            Self::Scene { scene, .. } => Some(scene),
            _ => None,
        }
    }

    /// The condition, if it has one.
    pub fn condition(&self) -> Option<&str> {
        match self {
            Self::Gait { .. } => None,
            Self::Scene { condition, .. } | Self::Agent { condition, .. } => Some(condition),
        }
    }

    /// A text that is equal for equal stimuli alone.
    pub(super) fn key(&self) -> String {
        match self {
            Self::Gait { gait } => format!("gait\0{gait}"),
            Self::Scene { scene, condition } => format!("scene\0{scene}\0{condition}"),
            Self::Agent { emotion, body, condition } => format!("agent\0{emotion}\0{body}\0{condition}"),
        }
    }
}

/// What a trial is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "role", rename_all = "kebab-case")]
pub enum Role {
    /// Its answers count.
    Ordinary,
    /// It shows again what the trial at position `of` showed; how far a rater agrees with themselves.
    Repeat {
        /// Position of the first showing.
        of: u32,
    },
    /// It shows nothing and asks for a certain answer.
    Catch {
        /// The answer.
        answer: i64,
    },
}

/// One trial of a participant.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Trial {
    /// Name of the part.
    pub part: String,
    /// Position within the part, from 1.
    pub position: u32,
    /// Index of the stimulus in [`TrialsStep::stimuli`]; none for a trial that repeats another or shows nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub item: Option<u32>,
    /// The block, from 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub block: Option<u32>,
    /// Row of the design.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub row: Option<u32>,
    /// Seed of what is shown, 0 to 2^63 - 1.
    pub seed: u64,
    /// What it is for.
    #[serde(flatten)]
    pub role: Role,
}

/// A trial's stimulus is another one from now on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Swap {
    /// Name of the part.
    pub part: String,
    /// Position within the part, from 1.
    pub position: u32,
    /// Index of the new stimulus; none if the trial is left out.
    pub item: Option<u32>,
}

/// Trials as `u32`, which all their numbers are.
#[allow(clippy::cast_possible_truncation, reason = "a study has at most a million of anything")]
pub(super) const fn small(number: usize) -> u32 {
    number as u32
}

impl Plan {
    /// The trials of a part in these stimuli's order, without a design: every participant gets the same.
    pub fn fixed_trials(&self, part: &str, step: &TrialsStep) -> Vec<Trial> {
        (0..step.stimuli.len())
            .map(|item| self.trial(part, step, 0, item))
            .enumerate()
            .map(numbered)
            .collect()
    }

    fn trial(&self, part: &str, step: &TrialsStep, person: u64, item: usize) -> Trial {
        let key = word(&step.stimuli[item].key());
        Trial {
            part: part.to_owned(),
            position: 0,
            item: Some(small(item)),
            block: None,
            row: None,
            seed: self.trial_seed(part, person, key),
            role: Role::Ordinary,
        }
    }

    /// Everything that a participant may be shown in a browser: part, stimulus and seed (0 of gaits, which have none). Studies for
    /// headsets alone have gaits only.
    pub fn shown_on_the_web(&self) -> Vec<(String, Stimulus, u64)> {
        let mut shown = Vec::new();
        for Step { name, kind } in &self.steps {
            let StepKind::Trials(step) = kind else { continue };
            for stimulus in &step.stimuli {
                if matches!(stimulus, Stimulus::Gait { .. }) {
                    shown.push((name.clone(), stimulus.clone(), 0));
                } else if self.shows_clips {
                    let what = match stimulus.scene() {
                        Some(scene) if step.seeds == Seeds::PerBlock && step.is_in_blocks() => word(scene),
                        _ => word(&stimulus.key()),
                    };
                    let seeds = (0..CLIP_SEEDS).map(|clip| self.clip_seed(name, what, clip));
                    shown.extend(seeds.map(|seed| (name.clone(), stimulus.clone(), seed)));
                }
            }
        }
        shown
    }

    fn clip_seed(&self, part: &str, what: u64, clip: usize) -> u64 {
        random(self.seed, Purpose::Trial, &[word(part), what, clip as u64]).bits() >> 1
    }

    /// The seed of what is shown. Where participants may see clips it is one of few for each `what`.
    fn trial_seed(&self, part: &str, person: u64, what: u64) -> u64 {
        let mut own = random(self.seed, Purpose::Trial, &[word(part), person, what]);
        if self.shows_clips { self.clip_seed(part, what, own.below(CLIP_SEEDS)) } else { own.bits() >> 1 }
    }

    /// A participant's trials of a fill design, with repeated and instructed ones among them.
    pub(super) fn fill_trials(
        &self,
        part: &str,
        step: &TrialsStep,
        person: u64,
        items: &[usize],
    ) -> Vec<Trial> {
        let mut trials: Vec<Trial> = items
            .iter()
            .map(|&item| self.trial(part, step, person, item))
            .enumerate()
            .map(numbered)
            .collect();
        let mut random = random(self.seed, Purpose::Extra, &[word(part), person]);
        // Walks are repeated at the end, so that others lie between: the first ones, one of each half.
        let half = (trials.len() / 2).max(1);
        let mut again: Vec<usize> = (0..half.min(trials.len())).collect();
        random.shuffle(&mut again);
        for first in again.into_iter().take(step.repeat as usize) {
            let mut repeat = Trial { item: None, ..trials[first].clone() };
            repeat.role = Role::Repeat { of: trials[first].position };
            trials.push(repeat);
        }
        for _ in 0..step.catches {
            if let Some(answer) = step.instructed_answer(&mut random) {
                let at = 1 + random.below(trials.len().max(1));
                trials.insert(at.min(trials.len()), self.catch(part, answer));
            }
        }
        renumbered(trials)
    }

    fn catch(&self, part: &str, answer: i64) -> Trial {
        let role = Role::Catch { answer };
        Trial { part: part.to_owned(), position: 0, item: None, block: None, row: None, seed: 0, role }
    }

    /// A participant's trials of a row of blocks.
    pub(super) fn block_trials(
        &self,
        part: &str,
        step: &TrialsStep,
        person: u64,
        (blocks, row): (&Blocks, usize),
    ) -> Vec<Trial> {
        let conditions = step.conditions.max(1);
        let trial = |cell: super::blocks::Cell| {
            let mut trial = self.trial(part, step, person, cell.scene * conditions + cell.condition);
            if step.seeds == Seeds::PerBlock {
                let scene = step.stimuli[cell.scene * conditions].scene().unwrap_or_default();
                trial.seed = self.trial_seed(part, person, word(scene));
            }
            Trial { block: Some(small(cell.block)), row: Some(small(row)), ..trial }
        };
        blocks.cells(row).into_iter().map(trial).enumerate().map(numbered).collect()
    }

    /// A participant's trials of a row of a square.
    pub(super) fn square_trials(
        &self,
        part: &str,
        step: &TrialsStep,
        person: u64,
        (square, row): (&Square, usize),
    ) -> Vec<Trial> {
        let trial = |&item: &usize| Trial { row: Some(small(row)), ..self.trial(part, step, person, item) };
        square.items(row).iter().map(trial).enumerate().map(numbered).collect()
    }

    /// Trials of one participant in a part, repeated and instructed ones included.
    pub fn trial_count(&self, step: &TrialsStep) -> usize {
        let extra = (step.repeat + step.catches) as usize;
        match step.design {
            Some(Design::Fill { each, .. }) => (each as usize).min(step.stimuli.len()) + extra,
            _ => step.stimuli.len(),
        }
    }
}

fn numbered((index, trial): (usize, Trial)) -> Trial {
    Trial { position: small(index + 1), ..trial }
}

/// Positions as they stand, and what refers to them.
fn renumbered(trials: Vec<Trial>) -> Vec<Trial> {
    let moved: Vec<(u32, u32)> = trials
        .iter()
        .enumerate()
        .filter(|(_, trial)| trial.role == Role::Ordinary)
        .map(|(index, trial)| (trial.position, small(index + 1)))
        .collect();
    let new = |old: u32| moved.iter().find(|(before, _)| *before == old).map_or(old, |&(_, after)| after);
    let role = |role| match role {
        Role::Repeat { of } => Role::Repeat { of: new(of) },
        other => other,
    };
    let trials = trials.into_iter().map(|trial| Trial { role: role(trial.role), ..trial });
    trials.enumerate().map(numbered).collect()
}
