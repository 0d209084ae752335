//! The character of every agent, where feelings change.

use crate::scenario::file::EmotionDynamics;
use crate::scenario::random::{Purpose, range};

impl EmotionDynamics {
    /// Expressiveness, openness, amplification and bias of an agent.
    pub fn character(&self, seed: u64, agent: u32) -> [f32; 4] {
        let traits = [self.expressiveness, self.openness, self.amplification, self.bias];
        let mut drawn_traits = [0.0; 4];
        for ((draw, [low, high]), own) in (0..).zip(traits).zip(&mut drawn_traits) {
            *own = range(seed, agent, Purpose::Temperament, draw, low, high);
        }
        drawn_traits
    }
}
