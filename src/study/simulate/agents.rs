//! How simulated participants answer about scenes and single agents.

use super::draws::{cut, normal};
use crate::random::Random;
use std::collections::BTreeMap;

/// Answers about scenes: `q = μ_scene + δ_condition + u_person + trend · position + ε`, cut to the scale.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearModel {
    /// μ by scene; 4 for a scene that is not there.
    pub scenes: BTreeMap<String, f64>,
    /// δ by condition, for every question; 0 for a condition that is not there.
    pub conditions: BTreeMap<String, f64>,
    /// Standard deviation of u over people.
    pub person_deviation: f64,
    /// What a trial adds to the one before it.
    pub trend: f64,
    /// Standard deviation of ε.
    pub noise: f64,
}

/// No effect: every difference is noise of deviation 1, among people of deviation 0.7.
impl Default for LinearModel {
    fn default() -> Self {
        let (scenes, conditions) = (BTreeMap::new(), BTreeMap::new());
        Self { scenes, conditions, person_deviation: 0.7, trend: 0.0, noise: 1.0 }
    }
}

/// A trial as the model sees it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen<'a> {
    pub(super) scene: &'a str,
    pub(super) condition: &'a str,
    /// Position within the part, from 1.
    pub(super) position: u32,
}

impl LinearModel {
    /// The point that a person of deviate `person` chooses on a scale.
    pub(super) fn answer(
        &self,
        seen: Seen<'_>,
        person: f64,
        (least, greatest): (i64, i64),
        random: &mut Random,
    ) -> i64 {
        let scene = self.scenes.get(seen.scene).copied().unwrap_or(4.0);
        let condition = self.conditions.get(seen.condition).copied().unwrap_or(0.0);
        let trend = self.trend * f64::from(seen.position.saturating_sub(1));
        let q = scene + condition + self.person_deviation * person + trend + self.noise * normal(random);
        cut(q, least, greatest)
    }
}

/// What is answered for each emotion that is shown: rows are shown, columns are answered, both in the order of
/// [`Emotion::ALL`](crate::emotion::Emotion::ALL). Weights within a row are relative.
pub type Confusion = [[f64; 4]; 4];

/// The paper's confusion matrix (its table of the identification task), as counts of 48 a row.
pub const PAPER_CONFUSION: Confusion =
    [[29.0, 2.0, 2.0, 15.0], [9.0, 25.0, 0.0, 14.0], [0.0, 0.0, 48.0, 0.0], [4.0, 2.0, 8.0, 34.0]];

/// The column that is answered, drawn from a row.
pub(super) fn identify(row: [f64; 4], random: &mut Random) -> usize {
    let mut left = random.unit() * row.iter().sum::<f64>();
    for (column, weight) in row.iter().enumerate() {
        left -= weight;
        if left < 0.0 {
            return column;
        }
    }
    // rounding: the last column that can be answered
    row.iter().rposition(|&weight| weight > 0.0).unwrap_or(0)
}
