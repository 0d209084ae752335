//! `phase-perceiver`: a perceiver that agrees with people better than the 29 features do. Ours.
//!
//! Labelled gaits in; a [`Perceiver`] out. Each gait becomes the numbers of [`descriptor()`]: curves over phase in the
//! walker's own frame and in body lengths, of which means and amplitudes of harmonics are kept, both sides of the
//! body averaged. So frame rate, size, heading, place, capture noise and which foot goes first fall away, and
//! a few hundred gaits are enough to learn from. Two opinions of equal weight are asked:
//!
//! - many linear discriminants, each with a shrunken covariance, each on its own random 40 of the numbers;
//! - kernel ridge regression of the four classes on an RBF kernel over all of them.
//!
//! The constants were chosen on E-Gait with subject-grouped folds; when they and the descriptor's parts are chosen
//! again inside every training fold (nested, a menu of 152; 5 seeds), accuracy is 65.0 %, about 1.5 points lower. Figures:
//! `tests/perception_compare.rs`.

mod descriptor;

use super::evaluate::Random;
use super::linear::{Cholesky, Matrix, covariance, distance_squared, dot, mean, number};
use super::memo::{Key, Memo, key};
use super::{Error, Method, Perceiver};
use crate::emotion::Emotion;
use crate::gait::Gait;
pub use descriptor::{DESCRIPTOR_LENGTH, descriptor};
use std::sync::Arc;

/// Name in tables and on the command line.
pub const NAME: &str = "phase-perceiver";
/// Standardised numbers are cut off here: a number this far out tells of a capture, not of an emotion.
const FARTHEST: f64 = 4.0;
/// The RBF kernel is `exp(-WIDTH d^2 / median d^2)`.
const WIDTH: f64 = 0.7;

/// The method and its settings.
#[derive(Debug, Clone)]
pub struct PhasePerceiver {
    /// Number of linear discriminants, at least 1.
    pub discriminants: usize,
    /// Numbers that each of them sees, at least 1.
    pub numbers: usize,
    /// How far their covariance is shrunk towards a multiple of the identity, above 0, to 1.
    pub shrinkage: f64,
    /// What is added to the diagonal of the kernel matrix, above 0.
    pub ridge: f64,
    known: Memo<Key, Arc<Vec<f64>>>,
}

impl Default for PhasePerceiver {
    fn default() -> Self {
        Self { discriminants: 200, numbers: 40, shrinkage: 0.1, ridge: 0.1, known: Memo::default() }
    }
}

impl Method for PhasePerceiver {
    fn name(&self) -> &'static str {
        NAME
    }

    fn train(&self, gaits: &[&Gait], emotions: &[Emotion], seed: u64) -> Result<Box<dyn Perceiver>, Error> {
        let failed = |message: String| Error::Training { method: NAME, message };
        let settings_are_good = self.discriminants >= 1
            && self.numbers >= 1
            && self.shrinkage > 0.0
            && self.shrinkage <= 1.0
            && self.ridge > 0.0
            && self.ridge.is_finite();
        if !settings_are_good {
            return Err(failed(format!(
                "{} discriminants of {} numbers, shrinkage {}, ridge {}; needed: at least 1 of at least 1, \
                 above 0 to 1, above 0",
                self.discriminants, self.numbers, self.shrinkage, self.ridge
            )));
        }
        super::check_training(NAME, gaits, emotions)?;
        let raw: Vec<Arc<Vec<f64>>> =
            gaits.iter().map(|gait| self.known.of(key(gait), || Arc::new(descriptor(gait)))).collect();
        if let Some(i) = raw.iter().position(|point| !point.iter().all(|v| v.is_finite())) {
            return Err(failed(format!(
                "gait {:?} has numbers that are not finite; leave it out",
                gaits[i].name
            )));
        }
        let scale = Standard::fit(&raw);
        let points: Vec<Vec<f64>> = raw.iter().map(|point| scale.apply(point)).collect();
        let classes: Vec<usize> = emotions.iter().map(|emotion| emotion.index()).collect();
        Ok(Box::new(Trained {
            discriminants: self.discriminants(&points, &classes, seed).map_err(failed)?,
            ridge: KernelRidge::fit(points, &classes, self.ridge).map_err(failed)?,
            scale,
            known: self.known.clone(),
        }))
    }
}

impl PhasePerceiver {
    /// Linear discriminants on random numbers: `z B - mu B / 2 + ln prior` with `B = S^-1 mu`.
    fn discriminants(
        &self,
        points: &[Vec<f64>],
        classes: &[usize],
        seed: u64,
    ) -> Result<Vec<Discriminant>, String> {
        let length = points.first().map_or(0, Vec::len);
        let of_class = |class: usize| -> Vec<&Vec<f64>> {
            points.iter().zip(classes).filter(|&(_, &c)| c == class).map(|(point, _)| point).collect()
        };
        let means: [Option<Vec<f64>>; 4] = std::array::from_fn(|class| {
            let members = of_class(class);
            (!members.is_empty()).then(|| mean(&members))
        });
        let priors: [f64; 4] =
            std::array::from_fn(|class| number(of_class(class).len()) / number(points.len()));
        let within: Vec<Vec<f64>> = points
            .iter()
            .zip(classes)
            .filter_map(|(point, &class)| {
                Some(point.iter().zip(means[class].as_ref()?).map(|(p, m)| p - m).collect())
            })
            .collect();
        // once for all numbers; each discriminant takes its rows and columns of it
        let whole = covariance(&within, &vec![0.0; length]);
        let mut random = Random::new(seed);
        let mut order: Vec<usize> = (0..length).collect();
        (0..self.discriminants)
            .map(|_| {
                random.shuffle(&mut order);
                let chosen = order[..self.numbers.min(length)].to_vec();
                let spread = shrunk(&whole, &chosen, self.shrinkage);
                let factor = Cholesky::of(&spread)
                    .ok_or("the gaits do not differ in any number; give gaits of different motion")?;
                let planes = std::array::from_fn(|class| {
                    let centre = means[class].as_ref()?;
                    let centre: Vec<f64> = chosen.iter().map(|&i| centre[i]).collect();
                    let slope = factor.solve(&centre);
                    let offset = priors[class].ln() - dot(&centre, &slope) / 2.0;
                    Some((slope, offset))
                });
                Ok(Discriminant { chosen, planes })
            })
            .collect()
    }
}

/// Rows and columns `chosen` of a covariance, shrunk towards the mean of their variances.
fn shrunk(whole: &Matrix, chosen: &[usize], shrinkage: f64) -> Matrix {
    let size = chosen.len();
    let mut part = Matrix::zeros(size, size);
    for (i, &row) in chosen.iter().enumerate() {
        for (j, &column) in chosen.iter().enumerate() {
            part[(i, j)] = (1.0 - shrinkage) * whole[(row, column)];
        }
    }
    let variance = chosen.iter().map(|&i| whole[(i, i)]).sum::<f64>() / number(size);
    for i in 0..size {
        part[(i, i)] += shrinkage * variance;
    }
    part
}

/// Mean and standard deviation of each number over the training gaits.
#[derive(Debug)]
struct Standard {
    mean: Vec<f64>,
    deviation: Vec<f64>,
}

impl Standard {
    fn fit(points: &[Arc<Vec<f64>>]) -> Self {
        let points: Vec<&[f64]> = points.iter().map(|point| point.as_slice()).collect();
        let mean = mean(&points);
        let variance = |i: usize| {
            points.iter().map(|p| (p[i] - mean[i]) * (p[i] - mean[i])).sum::<f64>() / number(points.len())
        };
        Self { deviation: (0..mean.len()).map(|i| variance(i).sqrt()).collect(), mean }
    }

    /// Numbers that did not vary become 0.
    fn apply(&self, point: &[f64]) -> Vec<f64> {
        let scaled = |((value, mean), deviation): ((&f64, &f64), &f64)| {
            if *deviation > 1e-9 { ((value - mean) / deviation).clamp(-FARTHEST, FARTHEST) } else { 0.0 }
        };
        point.iter().zip(&self.mean).zip(&self.deviation).map(scaled).collect()
    }
}

/// A linear discriminant of some of the numbers.
#[derive(Debug)]
struct Discriminant {
    chosen: Vec<usize>,
    /// Slope and offset of each emotion that was there.
    planes: [Option<(Vec<f64>, f64)>; 4],
}

impl Discriminant {
    /// Posterior of each emotion.
    fn probabilities(&self, point: &[f64]) -> [f64; 4] {
        let seen: Vec<f64> = self.chosen.iter().map(|&i| point[i]).collect();
        let scores = self.planes.each_ref().map(|plane| match plane {
            Some((slope, offset)) => dot(slope, &seen) + offset,
            None => f64::NEG_INFINITY,
        });
        let most = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let weights = scores.map(|score| (score - most).exp());
        let sum: f64 = weights.iter().sum();
        weights.map(|weight| weight / sum)
    }
}

/// Regression of the classes (1 for one's own, 0 for the others, less the mean) on an RBF kernel.
#[derive(Debug)]
struct KernelRidge {
    points: Vec<Vec<f64>>,
    /// Of each training gait, for each emotion.
    weights: Vec<[f64; 4]>,
    priors: [f64; 4],
    /// Of the exponent.
    gamma: f64,
}

impl KernelRidge {
    fn fit(points: Vec<Vec<f64>>, classes: &[usize], ridge: f64) -> Result<Self, String> {
        let count = points.len();
        let mut squares = Matrix::zeros(count, count);
        let mut sorted = Vec::with_capacity(count * count.saturating_sub(1) / 2);
        for i in 0..count {
            for j in 0..i {
                squares[(i, j)] = distance_squared(&points[i], &points[j]);
                sorted.push(squares[(i, j)]);
            }
        }
        sorted.sort_by(f64::total_cmp);
        let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
        if median <= 0.0 {
            return Err("most gaits are the same; give gaits of different motion".to_owned());
        }
        let gamma = WIDTH / median;
        let mut kernel = squares;
        for i in 0..count {
            for j in 0..i {
                kernel[(i, j)] = (-gamma * kernel[(i, j)]).exp();
            }
            kernel[(i, i)] = 1.0 + ridge;
        }
        let factor = Cholesky::of(&kernel).ok_or("the kernel matrix is singular; raise the ridge")?;
        let mut weights = vec![[0.0; 4]; count];
        let mut priors = [0.0; 4];
        for class in 0..4 {
            let members = classes.iter().filter(|&&c| c == class).count();
            priors[class] = number(members) / number(count);
            let wanted: Vec<f64> =
                classes.iter().map(|&c| f64::from(u8::from(c == class)) - priors[class]).collect();
            for (weights, weight) in weights.iter_mut().zip(factor.solve(&wanted)) {
                weights[class] = weight;
            }
        }
        Ok(Self { points, weights, priors, gamma })
    }

    /// Score of each emotion; they add up to 1, but may leave [0, 1].
    fn scores(&self, point: &[f64]) -> [f64; 4] {
        let mut scores = self.priors;
        for (known, weights) in self.points.iter().zip(&self.weights) {
            let likeness = (-self.gamma * distance_squared(known, point)).exp();
            scores.iter_mut().zip(weights).for_each(|(s, w)| *s += likeness * w);
        }
        scores
    }
}

/// A trained [`PhasePerceiver`].
#[derive(Debug)]
struct Trained {
    scale: Standard,
    discriminants: Vec<Discriminant>,
    ridge: KernelRidge,
    known: Memo<Key, Arc<Vec<f64>>>,
}

impl Perceiver for Trained {
    fn probabilities(&self, gait: &Gait) -> [f64; 4] {
        let raw = self.known.of(key(gait), || Arc::new(descriptor(gait)));
        let point: Vec<f64> =
            self.scale.apply(&raw).iter().map(|v| if v.is_finite() { *v } else { 0.0 }).collect();
        let mut votes = [0.0; 4];
        for discriminant in &self.discriminants {
            let says = discriminant.probabilities(&point);
            votes.iter_mut().zip(says).for_each(|(vote, p)| *vote += p);
        }
        let scores = self.ridge.scores(&point);
        let both: [f64; 4] =
            std::array::from_fn(|i| (votes[i] / number(self.discriminants.len()) + scores[i]).max(0.0));
        let sum: f64 = both.iter().sum();
        both.map(|p| p / sum)
    }
}

#[cfg(test)]
mod tests;
