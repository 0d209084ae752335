//! `phase-perceiver`: a perceiver that agrees with people better than the 29 features do. Ours.
//!
//! Labelled gaits in; a [`Perceiver`] out. Each gait becomes the numbers of [`descriptor()`]: curves over phase in the
//! walker's own frame and in body lengths, of which means and amplitudes of harmonics are kept, both sides of the
//! body averaged. So frame rate, size, heading, place, capture noise and which foot goes first fall away, and
//! a few hundred gaits are enough to learn from: by logistic regression ([`logistic`](super::logistic)).
//!
//! Its one setting, the ridge, is chosen at every training on folds of the training gaits, grouped by person: the one under
//! which the left-out gaits are likeliest. So held-out gaits do not influence it. The descriptor was designed with E-Gait in
//! view, where it gives 66.4 % (people held out) and the 29 features with the SVM 57.5; with a data set held out
//! 48.6 %. With 27 more numbers that tell of the rig (see [`descriptor()`]) it gave 67.4 and 47.0 %, and choosing among
//! its parts inside the folds 65.7 to 66.1 %. Figures: `tests/perception/compare.rs`.

mod descriptor;

use super::evaluate::inner_folds;
use super::linear::{mean, number};
use super::logistic::Logistic;
use super::memo::{Key, Memo, key};
use super::model::{Machine, Model, TrainedOn};
use super::{Error, Method, Perceiver};
use crate::emotion::Emotion;
use crate::gait::Gait;
pub use descriptor::{DESCRIPTOR_LENGTH, descriptor};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Name in tables and on the command line.
pub const NAME: &str = "phase-perceiver";
/// Standardised numbers are cut off here: a number this far out comes from the capture, not from an emotion.
const FARTHEST: f64 = 4.0;
/// Numbers that vary less than this do not vary.
const STILL: f64 = 1e-6;
/// Folds on which the ridge is chosen; fewer where there are fewer people.
const FOLDS: usize = 5;
/// Least probability that counts: one gait that is seen quite differently must not decide alone.
const LEAST: f64 = 1e-6;

/// The method and its settings.
#[derive(Debug, Clone)]
pub struct PhasePerceiver {
    /// What the ridge is chosen from, above 0, from the largest to the smallest. One: no choice.
    pub ridges: Vec<f64>,
    known: Memo<Key, Arc<Vec<f64>>>,
}

impl Default for PhasePerceiver {
    fn default() -> Self {
        Self { ridges: vec![300.0, 100.0, 30.0, 10.0, 3.0], known: Memo::default() }
    }
}

impl Method for PhasePerceiver {
    fn name(&self) -> &'static str {
        NAME
    }

    fn train(&self, gaits: &[&Gait], emotions: &[Emotion], seed: u64) -> Result<Box<dyn Perceiver>, Error> {
        let (learned, _) = self.learn(gaits, emotions, seed)?;
        Ok(Box::new(Trained { learned, known: self.known.clone() }))
    }
}

impl PhasePerceiver {
    /// Words for a report.
    pub fn describe(&self) -> String {
        match self.ridges.as_slice() {
            [ridge] => format!("{DESCRIPTOR_LENGTH} numbers over phase, ridge {ridge}"),
            ridges => format!("{DESCRIPTOR_LENGTH} numbers over phase, ridge chosen from {ridges:?}"),
        }
    }

    /// Trains a model that can be saved and recognises gaits unlike its training gaits. Its answers equal those of
    /// [`Method::train`] bit for bit.
    ///
    /// # Errors
    /// As [`Method::train`].
    pub fn model(&self, gaits: &[&Gait], emotions: &[Emotion], seed: u64) -> Result<Model, Error> {
        let (learned, ridge) = self.learn(gaits, emotions, seed)?;
        let settings = match self.ridges.as_slice() {
            [_] => format!("ridge {ridge}"),
            _ => format!("ridge {ridge}, chosen on {FOLDS} inner folds"),
        };
        let trained_on = TrainedOn::of(gaits, emotions, settings, seed);
        Ok(Model::new(Machine::PhasePerceiver(learned), trained_on).with_novelty(gaits, emotions))
    }

    /// What is learned, and the ridge that was chosen or given.
    fn learn(&self, gaits: &[&Gait], emotions: &[Emotion], seed: u64) -> Result<(Learned, f64), Error> {
        let failed = |message: String| Error::Training { method: NAME, message };
        let is_good = |ridge: &f64| *ridge > 0.0 && ridge.is_finite();
        if self.ridges.is_empty() || !self.ridges.iter().all(is_good) {
            return Err(failed(format!("ridges {:?}; needed: at least one, each above 0", self.ridges)));
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
        let learning = Learning { raw: &raw, emotions };
        let all: Vec<usize> = (0..raw.len()).collect();
        let ridge = match self.ridges.as_slice() {
            [ridge] => *ridge,
            ridges => {
                likeliest(&learning, ridges, &inner_folds(gaits, emotions, FOLDS, seed)).map_err(failed)?
            }
        };
        let learned = learning.learn(&all, ridge, None).map_err(failed)?;
        Ok((learned, ridge))
    }
}

/// The ridge under which gaits of folds left out are likeliest.
fn likeliest(learning: &Learning<'_>, ridges: &[f64], folds: &[usize]) -> Result<f64, String> {
    let count = folds.iter().max().map_or(0, |last| last + 1);
    let mut likelihoods = vec![0.0; ridges.len()];
    for fold in 0..count {
        let (out, rest): (Vec<usize>, Vec<usize>) = (0..folds.len()).partition(|&i| folds[i] == fold);
        let first = rest.first().map(|&i| learning.emotions[i]);
        if out.is_empty() || rest.iter().all(|&i| Some(learning.emotions[i]) == first) {
            continue; // nothing to learn
        }
        let mut before: Option<Learned> = None;
        for (likelihood, &ridge) in likelihoods.iter_mut().zip(ridges) {
            let learned = learning.learn(&rest, ridge, before.as_ref())?;
            for &i in &out {
                let told = learned.of_raw(&learning.raw[i])[learning.emotions[i].index()];
                *likelihood += told.max(LEAST).ln();
            }
            before = Some(learned);
        }
    }
    let best = (0..ridges.len()).fold(0, |best, i| if likelihoods[i] > likelihoods[best] { i } else { best });
    Ok(ridges[best])
}

/// What is learned from.
struct Learning<'a> {
    raw: &'a [Arc<Vec<f64>>],
    emotions: &'a [Emotion],
}

impl Learning<'_> {
    /// Learns from the gaits `of`.
    fn learn(&self, of: &[usize], ridge: f64, start: Option<&Learned>) -> Result<Learned, String> {
        let raw: Vec<Arc<Vec<f64>>> = of.iter().map(|&i| self.raw[i].clone()).collect();
        let scale = Standard::fit(&raw);
        if scale.deviation.iter().all(|deviation| *deviation <= STILL) {
            return Err("the gaits do not differ in any number; give gaits of different motion".to_owned());
        }
        let points: Vec<Vec<f64>> = raw.iter().map(|point| within(&scale.apply(point))).collect();
        let emotions: Vec<Emotion> =
            Emotion::ALL.into_iter().filter(|e| of.iter().any(|&i| self.emotions[i] == *e)).collect();
        let class = |i: &usize| emotions.iter().position(|e| *e == self.emotions[*i]).unwrap_or_default();
        let classes: Vec<usize> = of.iter().map(class).collect();
        let start = start.map(|learned| &learned.planes);
        let planes = Logistic::train(&points, &classes, emotions.len(), ridge, start)
            .map_err(|error| error.to_string())?;
        Ok(Learned { scale, emotions, planes })
    }
}

/// What was learned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Learned {
    #[serde(flatten)]
    scale: Standard,
    /// Those that were there, in the order of the classes.
    emotions: Vec<Emotion>,
    planes: Logistic,
}

impl Learned {
    /// The standardised numbers of a gait, however far out.
    pub(super) fn point(&self, gait: &Gait) -> Vec<f64> {
        self.scale.apply(&descriptor(gait))
    }

    /// Probability of each emotion at a standardised point.
    pub(super) fn probabilities(&self, point: &[f64]) -> [f64; 4] {
        let mut all = [0.0; 4];
        for (emotion, p) in self.emotions.iter().zip(self.planes.probabilities(&within(point))) {
            all[emotion.index()] = p;
        }
        all
    }

    /// The same of numbers that are not standardised.
    fn of_raw(&self, raw: &[f64]) -> [f64; 4] {
        self.probabilities(&self.scale.apply(raw))
    }

    pub(super) fn validate(&self) -> Result<(), String> {
        let Standard { mean, deviation } = &self.scale;
        if [mean.len(), deviation.len()] != [DESCRIPTOR_LENGTH; 2] {
            let (found, other) = (mean.len(), deviation.len());
            return Err(format!(
                "{found} means and {other} deviations; expected {DESCRIPTOR_LENGTH} of each"
            ));
        }
        if !mean.iter().chain(deviation).all(|v| v.is_finite()) || deviation.iter().any(|v| *v < 0.0) {
            return Err("a mean or deviation is not finite, or a deviation below 0".to_owned());
        }
        if self.emotions.len() < 2 || !self.emotions.is_sorted_by(|a, b| a < b) {
            return Err(format!(
                "its emotions are {:?}; expected two or more, in their order",
                self.emotions
            ));
        }
        self.planes.validate(self.emotions.len(), DESCRIPTOR_LENGTH)
    }
}

/// The point with numbers no farther out than [`FARTHEST`]; those that are none are 0.
fn within(point: &[f64]) -> Vec<f64> {
    let cut = |v: &f64| if v.is_finite() { v.clamp(-FARTHEST, FARTHEST) } else { 0.0 };
    point.iter().map(cut).collect()
}

/// Mean and standard deviation of each number over the training gaits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
            if *deviation > STILL { (value - mean) / deviation } else { 0.0 }
        };
        point.iter().zip(&self.mean).zip(&self.deviation).map(scaled).collect()
    }
}

/// A trained [`PhasePerceiver`].
#[derive(Debug)]
struct Trained {
    learned: Learned,
    known: Memo<Key, Arc<Vec<f64>>>,
}

impl Perceiver for Trained {
    fn probabilities(&self, gait: &Gait) -> [f64; 4] {
        self.learned.of_raw(&self.known.of(key(gait), || Arc::new(descriptor(gait))))
    }
}

#[cfg(test)]
mod tests;
