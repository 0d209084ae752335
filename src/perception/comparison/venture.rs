//! Venture et al. 2014 (Int. J. Social Robotics 6, 621 to 632): auto-correlation of joint angles, and similarity.
//!
//! Grades. *Abstract*: joint angles of a body of 34 degrees of freedom, feature vectors, each motion compared with a
//! database of reference motions, 6 and then 12 angles; good within a person, poor between people. *Stated*:
//! "auto-correlation matrix of the joint angles at each frame ... similarity indices". *Reconstructed*: which 12
//! angles, lags of 0 to 5 frames at 30 Hz, the normalised scalar product as similarity index, the most similar
//! reference as the default answer.

use super::{by_distance, finite};
use crate::emotion::Emotion;
use crate::gait::{Gait, Joint};
use crate::perception::body::{AHEAD, BACK, Body, DOWN, LEFTWARD, UP, angle, in_plane, mean};
use crate::perception::linear::{dot, number};
use crate::perception::memo::{Key, Memo, key};
use crate::perception::{Error, Method, Perceiver, check_training};
use std::sync::Arc;

/// Name in tables and on the command line.
pub(super) const NAME: &str = "venture-2014";
/// Largest lag, frames of 1/30 s.
const LAGS: usize = 5;

/// How the similarities to the references become an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[doc(hidden)]
pub enum Answer {
    /// The emotion of the most similar reference.
    #[default]
    MostSimilar,
    /// The emotion whose references are most similar on average.
    MeanSimilarity,
}

/// Auto-correlation matrices of 12 joint angles, compared with those of the training gaits.
#[derive(Debug, Clone, Default)]
pub struct Venture2014 {
    /// How similarities become an answer.
    pub answer: Answer,
    known: Memo<Key, Arc<Vec<f64>>>,
}

impl Venture2014 {
    /// With this answer.
    pub fn new(answer: Answer) -> Self {
        Self { answer, ..Self::default() }
    }
}

/// The 12 angles over time, radians: torso pitch, roll and yaw against the hips; neck flexion, rotation and side bend;
/// shoulders, elbows, hips, left then right. The head's own rotation is not in 16 joints: a walker looks ahead, so the
/// neck turns against the shoulders.
fn angles(gait: &Gait) -> Vec<Vec<f64>> {
    use Joint::{
        Head, LeftElbow, LeftHand, LeftHip, LeftKnee, LeftShoulder, Neck, RightElbow, RightHand, RightHip,
        RightKnee, RightShoulder, Root, Spine,
    };
    let body = Body::at_rate(gait);
    let less = |a: Vec<f64>, b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>();
    let swing = |from, to| in_plane(body.bone(from, to), AHEAD, DOWN);
    let bend = |a, b, c| body.bone(a, b).zip(body.bone(b, c)).map(|(u, f)| angle(u, f)).collect::<Vec<_>>();
    let shoulders = in_plane(body.bone(RightShoulder, LeftShoulder), BACK, LEFTWARD);
    let hips = in_plane(body.bone(RightHip, LeftHip), BACK, LEFTWARD);
    vec![
        in_plane(body.bone(Root, Neck), AHEAD, UP),
        in_plane(body.bone(Root, Neck), LEFTWARD, UP),
        less(shoulders.clone(), &hips),
        less(in_plane(body.bone(Neck, Head), AHEAD, UP), &in_plane(body.bone(Spine, Neck), AHEAD, UP)),
        shoulders.iter().map(|yaw| -yaw).collect(),
        less(in_plane(body.bone(Neck, Head), LEFTWARD, UP), &in_plane(body.bone(Spine, Neck), LEFTWARD, UP)),
        swing(LeftShoulder, LeftElbow),
        swing(RightShoulder, RightElbow),
        bend(LeftShoulder, LeftElbow, LeftHand),
        bend(RightShoulder, RightElbow, RightHand),
        swing(LeftHip, LeftKnee),
        swing(RightHip, RightKnee),
    ]
}

/// `A_l = sum over t of x_t x_(t+l)^T / (count - l)` for lags 0 to `lags`, of curves with their means taken out, as one
/// vector of length 1 (of zeros for curves that do not move).
fn autocorrelation(curves: &[Vec<f64>], lags: usize) -> Vec<f64> {
    let curves: Vec<Vec<f64>> = curves
        .iter()
        .map(|curve| {
            let mean = mean(curve);
            curve.iter().map(|x| x - mean).collect()
        })
        .collect();
    let count = curves.first().map_or(0, Vec::len);
    let mut all = Vec::with_capacity((lags + 1) * curves.len() * curves.len());
    for lag in 0..=lags.min(count.saturating_sub(1)) {
        for a in &curves {
            for b in &curves {
                all.push(dot(a, b.get(lag..).unwrap_or_default()) / number(count - lag));
            }
        }
    }
    let length = dot(&all, &all).sqrt();
    if length > 0.0 {
        all.iter_mut().for_each(|v| *v /= length);
    }
    all
}

fn vector(gait: &Gait) -> Vec<f64> {
    autocorrelation(&angles(gait), LAGS)
}

impl Method for Venture2014 {
    fn name(&self) -> &'static str {
        NAME
    }

    fn train(&self, gaits: &[&Gait], emotions: &[Emotion], _: u64) -> Result<Box<dyn Perceiver>, Error> {
        check_training(NAME, gaits, emotions)?;
        let vectors: Vec<Arc<Vec<f64>>> =
            gaits.iter().map(|gait| self.known.of(key(gait), || Arc::new(vector(gait)))).collect();
        let plain: Vec<&[f64]> = vectors.iter().map(|vector| vector.as_slice()).collect();
        finite(NAME, gaits, &plain)?;
        let references = vectors.into_iter().zip(emotions.iter().copied()).collect();
        Ok(Box::new(Trained { references, answer: self.answer, known: self.known.clone() }))
    }
}

#[derive(Debug)]
struct Trained {
    references: Vec<(Arc<Vec<f64>>, Emotion)>,
    answer: Answer,
    known: Memo<Key, Arc<Vec<f64>>>,
}

impl Perceiver for Trained {
    fn probabilities(&self, gait: &Gait) -> [f64; 4] {
        let vector = self.known.of(key(gait), || Arc::new(vector(gait)));
        // an angle between vectors: 0 is the same motion, a right angle nothing in common
        let mut similarity = [(f64::NEG_INFINITY, 0.0, 0_usize); 4];
        for (reference, emotion) in &self.references {
            let (most, sum, count) = &mut similarity[emotion.index()];
            let index = dot(reference, &vector);
            *most = most.max(index);
            *sum += index;
            *count += 1;
        }
        by_distance(similarity.map(|(most, sum, count)| match (count, self.answer) {
            (0, _) => f64::INFINITY,
            (_, Answer::MostSimilar) => 1.0 - most.min(1.0),
            (_, Answer::MeanSimilarity) => 1.0 - (sum / number(count)).min(1.0),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn sinusoid(amplitude: f64, phase: f64, offset: f64) -> Vec<f64> {
        // 10 whole turns, so that every lag sees nearly whole turns
        (0..400).map(|i| offset + amplitude * (TAU * number(i) / 40.0 + phase).cos()).collect()
    }

    #[test]
    fn autocorrelation_of_a_sinusoid_is_the_cosine_of_the_lag() {
        let found = autocorrelation(&[sinusoid(2.0, 0.3, 5.0)], 5);
        for (lag, value) in found.iter().enumerate() {
            let wanted = (TAU * number(lag) / 40.0).cos();
            assert!((value / found[0] - wanted).abs() < 0.02, "lag {lag}: {value}");
        }
        assert!((dot(&found, &found) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn amplitude_and_offset_of_all_curves_have_no_say_but_their_phase_has() {
        let one = autocorrelation(&[sinusoid(1.0, 0.0, 0.0), sinusoid(1.0, 1.0, 0.0)], 3);
        let larger = autocorrelation(&[sinusoid(3.0, 0.0, 1.0), sinusoid(3.0, 1.0, -2.0)], 3);
        let shifted = autocorrelation(&[sinusoid(1.0, 0.0, 0.0), sinusoid(1.0, 2.5, 0.0)], 3);
        assert!((dot(&one, &larger) - 1.0).abs() < 1e-9);
        assert!(dot(&one, &shifted) < 0.9);
    }

    #[test]
    fn curves_that_do_not_move_have_no_direction() {
        assert!(autocorrelation(&[vec![2.0; 9]], 5).iter().all(|v| *v == 0.0));
        assert!(autocorrelation(&[], 5).is_empty());
    }
}
