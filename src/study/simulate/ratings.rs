//! How simulated raters judge gaits.

use super::draws::normal;
use crate::emotion::Emotion;
use crate::random::Random;
use std::collections::BTreeMap;

/// How raters judge gaits: `z = a_i^e + b_j + ε`, cut by thresholds.
#[derive(Debug, Clone, PartialEq)]
pub struct RatingModel {
    /// `a_i^e` by gait, in the order of [`Emotion::ALL`]. A gait that is not there shows nothing: 0.
    pub shown: BTreeMap<String, [f64; 4]>,
    /// Standard deviation of `b_j` over raters.
    pub rater_deviation: f64,
    /// Standard deviation of ε.
    pub noise: f64,
    /// Where z passes from one point of the scale to the next, ascending; one fewer than points.
    pub thresholds: Vec<f64>,
}

impl RatingModel {
    /// Raters of a scale of five points: thresholds -1.5, -0.5, 0.5 and 1.5, deviations 0.3 of raters and 0.7 of answers.
    pub fn new(shown: BTreeMap<String, [f64; 4]>) -> Self {
        Self { shown, rater_deviation: 0.3, noise: 0.7, thresholds: vec![-1.5, -0.5, 0.5, 1.5] }
    }

    /// Gaits that each show one emotion clearly, weakly or not at all: strengths drawn by `seed` from 0.6 to 2.4 on
    /// one emotion, -2.2 to -0.4 on the others; one gait in ten shows nothing.
    pub fn drawn(gaits: &[String], seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut shown = BTreeMap::new();
        for gait in gaits {
            let own = random.below(4);
            let is_plain = random.below(10) == 0;
            let strength = 0.6 + 1.8 * random.unit();
            let other = [(); 4].map(|()| -2.2 + 1.8 * random.unit());
            let of = |emotion: usize| if emotion == own && !is_plain { strength } else { other[emotion] };
            shown.insert(gait.clone(), std::array::from_fn(of));
        }
        Self::new(shown)
    }

    /// What a gait shows.
    pub(super) fn of(&self, gait: &str) -> [f64; 4] {
        self.shown.get(gait).copied().unwrap_or_default()
    }

    /// The point that a rater chooses, from 1.
    pub(super) fn rate(&self, gait: &str, emotion: Emotion, rater: f64, random: &mut Random) -> i64 {
        let z = self.of(gait)[emotion.index()] + self.rater_deviation * rater + self.noise * normal(random);
        self.point(z)
    }

    fn point(&self, z: f64) -> i64 {
        1 + i64::try_from(self.thresholds.iter().filter(|&&threshold| z > threshold).count()).unwrap_or(0)
    }

    /// Expected ratings of a gait over all raters, by drawing `draws` of them: the truth that a study estimates.
    pub fn expected(&self, gait: &str, draws: u32, seed: u64) -> [f64; 4] {
        let mut random = Random::new(seed);
        Emotion::ALL.map(|emotion| {
            let one = |_| {
                let rater = normal(&mut random);
                self.rate(gait, emotion, rater, &mut random)
            };
            #[allow(clippy::cast_precision_loss, reason = "points of a scale")]
            let sum = (0..draws).map(one).sum::<i64>() as f64;
            sum / f64::from(draws)
        })
    }
}
