//! Karg, Kuehnlenz, Buss 2010 (IEEE TSMC-B 40(4), 1050 to 1061): principal components of a stride's parameters.
//!
//! Grades. *Abstract*: compares PCA, kernel PCA, LDA and GDA for reducing what a single stride holds. *Stated*: "uses
//! PCA to classify gait features related to shoulder, neck and thorax angles, stride length, and velocity". *Reconstructed*:
//! which angles, which statistics, 95 % of the variance, and the classifiers, of which the nearest neighbour is the
//! default.

use super::{by_distance, finite, nearest, of_classes};
use crate::emotion::Emotion;
use crate::gait::{Gait, Joint};
use crate::perception::body::{AHEAD, Body, UP, angle, in_plane, mean};
use crate::perception::linear::{Pca, distance_squared, number};
use crate::perception::memo::{Key, Memo, key};
use crate::perception::svm::{Kernel, Settings, Svm};
use crate::perception::{Error, Method, Perceiver, check_training};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Name in tables and on the command line.
pub(super) const NAME: &str = "karg-2010";
/// Share of the variance that the principal components hold.
const SHARE: f64 = 0.95;
/// Least variance of a component within a class, for [`Classifier::NaiveBayes`]: of z-scores.
const LEAST_VARIANCE: f64 = 1e-3;

/// What answers in the space of the principal components.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Classifier {
    /// The emotion of the nearest training gait.
    #[default]
    NearestNeighbour,
    /// A normal distribution of each component for each emotion.
    NaiveBayes,
    /// Support vector machine with the plain dot product, C = 1, one-versus-one.
    LinearSvm,
}

/// Speed, stride, cadence and ranges of four angles; z-scores; principal components; a [`Classifier`].
#[derive(Debug, Clone, Default)]
pub struct Karg2010 {
    /// What answers.
    pub classifier: Classifier,
    known: Memo<Key, Arc<Vec<f64>>>,
}

impl Karg2010 {
    /// With this classifier.
    pub fn new(classifier: Classifier) -> Self {
        Self { classifier, ..Self::default() }
    }
}

/// Speed (m/s), stride length (m), steps per second; least, mean and largest of neck, thorax and both shoulders'
/// flexion (radians).
fn numbers(gait: &Gait) -> Vec<f64> {
    use Joint::{Head, LeftElbow, LeftShoulder, Neck, RightElbow, RightShoulder, Root, Spine};
    let body = Body::of(gait);
    let between = |a: [Joint; 2], b: [Joint; 2]| -> Vec<f64> {
        body.bone(a[0], a[1]).zip(body.bone(b[0], b[1])).map(|(a, b)| angle(a, b)).collect()
    };
    let curves = [
        between([Neck, Head], [Spine, Neck]),
        in_plane(body.bone(Root, Neck), AHEAD, UP),
        between([LeftShoulder, LeftElbow], [Neck, Root]),
        between([RightShoulder, RightElbow], [Neck, Root]),
    ];
    let mut found = vec![f64::from(gait.speed), f64::from(gait.stride_length()), 2.0 / body.cycle_time];
    for curve in curves {
        let least = curve.iter().copied().fold(f64::INFINITY, f64::min);
        let most = curve.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        found.extend([least, mean(&curve), most]);
    }
    found
}

impl Method for Karg2010 {
    fn name(&self) -> &'static str {
        NAME
    }

    fn train(&self, gaits: &[&Gait], emotions: &[Emotion], _: u64) -> Result<Box<dyn Perceiver>, Error> {
        check_training(NAME, gaits, emotions)?;
        let failed = |message: String| Error::Training { method: NAME, message };
        let raw: Vec<Arc<Vec<f64>>> =
            gaits.iter().map(|gait| self.known.of(key(gait), || Arc::new(numbers(gait)))).collect();
        let raw: Vec<&[f64]> = raw.iter().map(|numbers| numbers.as_slice()).collect();
        finite(NAME, gaits, &raw)?;
        // z-scores: numbers that do not vary have no say
        let centre = crate::perception::linear::mean(&raw);
        let scale: Vec<f64> = (0..centre.len())
            .map(|i| {
                let variance =
                    raw.iter().map(|n| (n[i] - centre[i]).powi(2)).sum::<f64>() / number(raw.len());
                if variance > 1e-18 { 1.0 / variance.sqrt() } else { 0.0 }
            })
            .collect();
        let scores = Scores { centre, scale };
        let points: Vec<Vec<f64>> = raw.iter().map(|numbers| scores.of(numbers)).collect();
        let pca = Pca::of(&points, usize::MAX, SHARE)
            .ok_or_else(|| failed("the numbers have no principal components".to_owned()))?;
        let points: Vec<Vec<f64>> = points.iter().map(|point| pca.project(point)).collect();
        let rule = match self.classifier {
            Classifier::NearestNeighbour => {
                Trained::Neighbours(points.into_iter().zip(emotions.iter().copied()).collect())
            }
            Classifier::NaiveBayes => Trained::Bayes(bayes(&points, emotions)),
            Classifier::LinearSvm => {
                let classes: Vec<usize> = emotions.iter().map(|emotion| emotion.index()).collect();
                let settings = Settings { kernel: Kernel::Linear, ..Settings::default() };
                Trained::Svm(Box::new(
                    Svm::train(&points, &classes, &settings).map_err(|why| failed(why.into()))?,
                ))
            }
        };
        Ok(Box::new(Machine { scores, pca, rule, known: self.known.clone() }))
    }
}

/// `(x - mean) / standard deviation`.
#[derive(Debug)]
struct Scores {
    centre: Vec<f64>,
    scale: Vec<f64>,
}

impl Scores {
    fn of(&self, numbers: &[f64]) -> Vec<f64> {
        numbers.iter().zip(&self.centre).zip(&self.scale).map(|((n, c), s)| (n - c) * s).collect()
    }
}

/// A class: its share, means and variances.
#[derive(Debug)]
struct Normal {
    prior: f64,
    mean: Vec<f64>,
    variance: Vec<f64>,
}

fn bayes(points: &[Vec<f64>], emotions: &[Emotion]) -> [Option<Normal>; 4] {
    Emotion::ALL.map(|emotion| {
        let members: Vec<&Vec<f64>> =
            points.iter().zip(emotions).filter(|&(_, &e)| e == emotion).map(|(point, _)| point).collect();
        if members.is_empty() {
            return None;
        }
        let centre = crate::perception::linear::mean(&members);
        let variance = |i: usize| {
            let sum: f64 = members.iter().map(|m| (m[i] - centre[i]).powi(2)).sum();
            (sum / number(members.len())).max(LEAST_VARIANCE)
        };
        Some(Normal {
            prior: number(members.len()) / number(points.len()),
            variance: (0..centre.len()).map(variance).collect(),
            mean: centre,
        })
    })
}

impl Normal {
    /// Logarithm of prior times density.
    fn score(&self, point: &[f64]) -> f64 {
        let terms = point.iter().zip(&self.mean).zip(&self.variance);
        self.prior.ln() - 0.5 * terms.map(|((p, m), v)| (p - m).powi(2) / v + (TAU * v).ln()).sum::<f64>()
    }
}

#[derive(Debug)]
enum Trained {
    Neighbours(Vec<(Vec<f64>, Emotion)>),
    Bayes([Option<Normal>; 4]),
    Svm(Box<Svm>),
}

#[derive(Debug)]
struct Machine {
    scores: Scores,
    pca: Pca,
    rule: Trained,
    known: Memo<Key, Arc<Vec<f64>>>,
}

impl Perceiver for Machine {
    fn probabilities(&self, gait: &Gait) -> [f64; 4] {
        let raw = self.known.of(key(gait), || Arc::new(numbers(gait)));
        let point = self.pca.project(&self.scores.of(&raw));
        match &self.rule {
            Trained::Neighbours(known) => by_distance(nearest(
                known.iter().map(|(other, emotion)| (distance_squared(other, &point).sqrt(), *emotion)),
            )),
            Trained::Bayes(normals) => {
                let scores =
                    normals.each_ref().map(|n| n.as_ref().map_or(f64::NEG_INFINITY, |n| n.score(&point)));
                let most = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let weights = scores.map(|score| (score - most).exp());
                let sum: f64 = weights.iter().sum();
                if sum.is_finite() && sum > 0.0 { weights.map(|w| w / sum) } else { [0.25; 4] }
            }
            Trained::Svm(svm) => of_classes(svm.classes(), None, svm.predict(&point)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::walker::{MOST_EXPRESSION, Sex, WalkerStyle, walk};

    #[test]
    fn the_numbers_are_those_of_the_card() {
        let mut gait = walk(&WalkerStyle::preset(Emotion::Neutral, Sex::Female), "n").unwrap();
        let found = numbers(&gait);
        assert_eq!(found.len(), 15);
        assert!((found[2] - 2.0 / f64::from(gait.cycle_time())).abs() < 1e-9);
        // a head straight ahead of the neck bends it by as much as the back stands upright
        for pose in &mut gait.poses {
            pose[Joint::Spine as usize] = pose[Joint::Root as usize] + glam::Vec3::Y * 0.2;
            pose[Joint::Neck as usize] = pose[Joint::Root as usize] + glam::Vec3::Y * 0.5;
            pose[Joint::Head as usize] = pose[Joint::Neck as usize] + glam::Vec3::Z * 0.2;
        }
        let bent = numbers(&gait);
        // the walker's mean heading is +z to within a degree
        assert!((bent[4] - std::f64::consts::FRAC_PI_2).abs() < 1e-3, "{}", bent[4]);
        assert!(bent[7].abs() < 1e-6, "thorax {}", bent[7]);
    }

    #[test]
    fn all_three_classifiers_tell_sad_from_happy_walkers() {
        let (mut gaits, mut emotions) = (Vec::new(), Vec::new());
        for index in 0..10 {
            for emotion in [Emotion::Sad, Emotion::Happy] {
                let preset = WalkerStyle::expressed(emotion, Sex::Male, MOST_EXPRESSION);
                let own = WalkerStyle::mix(&[(preset, 0.7), (preset.vary(3, index), 0.3)]).unwrap();
                gaits.push(walk(&own, "w").unwrap());
                emotions.push(emotion);
            }
        }
        let seen: Vec<&Gait> = gaits[..12].iter().collect();
        for classifier in [Classifier::NearestNeighbour, Classifier::NaiveBayes, Classifier::LinearSvm] {
            let perceiver = Karg2010::new(classifier).train(&seen, &emotions[..12], 0).unwrap();
            let told: Vec<Emotion> = gaits[12..].iter().map(|gait| perceiver.emotion(gait)).collect();
            assert_eq!(told, emotions[12..], "{classifier:?}");
        }
    }
}
