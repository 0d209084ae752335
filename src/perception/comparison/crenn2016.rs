//! Crenn, Khan, Meyer, Bouakaz 2016 (IC3D): statistics and spectra of geometry and movement of the upper body.
//!
//! Grades. *Abstract*: low-cost features of animated 3-D skeletons, motivated by psychology, on several databases;
//! geometric, motion and Fourier features and a support vector machine (from later citations). *Stated*: posture and
//! movement, SVM, the upper body only. *Reconstructed*: the list of signals, their statistics, the grid of C and gamma.

use super::finite;
use super::machine::{Machine, failed};
use crate::emotion::Emotion;
use crate::gait::{Gait, Joint};
use crate::perception::body::{Body, BodyPose, UP, amplitude, angle, length, mean, minus};
use crate::perception::linear::number;
use crate::perception::memo::{Key, Memo, key};
use crate::perception::svm::{Gamma, Grid, Settings};
use crate::perception::{Error, Method, Perceiver, check_training};
use Joint::{
    Head, LeftElbow, LeftHand, LeftShoulder, Neck, RightElbow, RightHand, RightShoulder, Root, Spine,
};
use std::sync::Arc;

/// Name in tables and on the command line.
pub(super) const NAME: &str = "crenn-2016";
/// Joints of the upper body.
const UPPER: [Joint; 10] =
    [Root, Spine, Neck, Head, LeftShoulder, LeftElbow, LeftHand, RightShoulder, RightElbow, RightHand];
/// Joints of which speed, acceleration and jerk are taken.
const MOVING: [Joint; 7] = [LeftHand, RightHand, LeftElbow, RightElbow, LeftShoulder, RightShoulder, Head];
/// Amplitudes kept of each signal.
const BINS: usize = 5;
/// Signals: 14 of posture, 3 of each moving joint.
const SIGNALS: usize = 14 + 3 * MOVING.len();
/// Numbers of a gait: mean, standard deviation, least, most and amplitudes of each signal.
const NUMBERS: usize = SIGNALS * (4 + BINS);

/// Upper-body signals, scaled to [-1, 1], into an RBF machine with C and gamma searched on inner folds.
#[derive(Debug, Clone)]
pub struct Crenn2016 {
    /// What is searched.
    pub grid: Grid,
    known: Memo<Key, Arc<Vec<f64>>>,
}

impl Default for Crenn2016 {
    /// C 1 to 100 in steps of about 3; gamma `auto`, a third of it, and `scale`.
    fn default() -> Self {
        let gamma = vec![Gamma::Value(1.0 / (3.0 * number(NUMBERS))), Gamma::Auto, Gamma::Scale];
        Self { grid: Grid { c: vec![1.0, 3.0, 10.0, 30.0, 100.0], gamma }, known: Memo::default() }
    }
}

/// The signals over time, in metres, radians and seconds: at 30 Hz, walking direction along z.
fn signals(gait: &Gait) -> Vec<Vec<f64>> {
    let body = Body::at_rate(gait);
    let unit = body.length;
    let at = |pose: &BodyPose, joint: Joint| pose[joint as usize];
    let over = |f: &dyn Fn(&BodyPose) -> f64| -> Vec<f64> { body.poses.iter().map(f).collect() };
    let apart = |a: Joint, b: Joint| over(&|pose| unit * length(minus(at(pose, a), at(pose, b))));
    let corner = |middle: Joint, a: Joint, b: Joint| {
        over(&|pose| angle(minus(at(pose, a), at(pose, middle)), minus(at(pose, b), at(pose, middle))))
    };
    let mut found = vec![
        over(&|pose| unit.powi(3) * upper_box(pose)),
        corner(Neck, RightShoulder, LeftShoulder),
        corner(RightShoulder, Neck, LeftShoulder),
        corner(LeftShoulder, Neck, RightShoulder),
        over(&|pose| angle(minus(at(pose, Head), at(pose, Root)), UP)),
        corner(Neck, Head, Spine),
        over(&|pose| {
            let (a, b) =
                (minus(at(pose, LeftHand), at(pose, Neck)), minus(at(pose, RightHand), at(pose, Neck)));
            unit.powi(2) * length(a) * length(b) * angle(a, b).sin() / 2.0
        }),
        apart(LeftHand, Root),
        apart(RightHand, Root),
        corner(LeftElbow, LeftShoulder, LeftHand),
        corner(RightElbow, RightShoulder, RightHand),
        apart(LeftHand, RightHand),
        apart(LeftHand, Head),
        apart(RightHand, Head),
    ];
    for joint in MOVING {
        found.extend(derivatives(&body, joint));
    }
    found
}

/// Volume of the box around the upper body, body lengths cubed.
fn upper_box(pose: &BodyPose) -> f64 {
    let side = |axis: usize| {
        let along = UPPER.map(|joint| pose[joint as usize][axis]);
        along.iter().copied().fold(f64::NEG_INFINITY, f64::max)
            - along.iter().copied().fold(f64::INFINITY, f64::min)
    };
    side(0) * side(1) * side(2)
}

/// Lengths of the first three derivatives of a joint's way over the ground, m/s, m/s2, m/s3: central differences, one
/// after another, around the cycle.
fn derivatives(body: &Body, joint: Joint) -> [Vec<f64>; 3] {
    let count = body.poses.len();
    let step = body.cycle_time / number(count);
    let mut curve: Vec<[f64; 3]> = body.path(joint).map(|p| p.map(|v| v * body.length)).collect();
    std::array::from_fn(|order| {
        curve = (0..count)
            .map(|i| {
                let (before, after) = (curve[(i + count - 1) % count], curve[(i + 1) % count]);
                minus(after, before).map(|v| v / (2.0 * step))
            })
            .collect();
        if order == 0 {
            curve.iter_mut().for_each(|v| v[2] += body.speed * body.length);
        }
        curve.iter().map(|v| length(*v)).collect()
    })
}

/// Statistics of the signals.
fn numbers(gait: &Gait) -> Vec<f64> {
    let mut found = Vec::with_capacity(NUMBERS);
    for signal in signals(gait) {
        let mean = mean(&signal);
        let variance = signal.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / number(signal.len());
        let least = signal.iter().copied().fold(f64::INFINITY, f64::min);
        let most = signal.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        found.extend([mean, variance.sqrt(), least, most]);
        found.extend((1..=BINS).map(|k| amplitude(&signal, k)));
    }
    found
}

impl Method for Crenn2016 {
    fn name(&self) -> &'static str {
        NAME
    }

    fn train(&self, gaits: &[&Gait], emotions: &[Emotion], seed: u64) -> Result<Box<dyn Perceiver>, Error> {
        check_training(NAME, gaits, emotions)?;
        let raw: Vec<Vec<f64>> =
            gaits.iter().map(|gait| self.known.of(key(gait), || Arc::new(numbers(gait))).to_vec()).collect();
        finite(NAME, gaits, &raw)?;
        let settings = Settings { has_probabilities: true, ..Settings::default() };
        let machine = Machine::train(&raw, gaits, emotions, &settings, Some((&self.grid, seed)))
            .map_err(failed(NAME))?;
        Ok(Box::new(Trained { machine, known: self.known.clone() }))
    }
}

#[derive(Debug)]
struct Trained {
    machine: Machine,
    known: Memo<Key, Arc<Vec<f64>>>,
}

impl Perceiver for Trained {
    fn probabilities(&self, gait: &Gait) -> [f64; 4] {
        self.machine.probabilities(&self.known.of(key(gait), || Arc::new(numbers(gait))))
    }

    fn emotion(&self, gait: &Gait) -> Emotion {
        self.machine.emotion(&self.known.of(key(gait), || Arc::new(numbers(gait))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::walker::{Sex, WalkerStyle, walk};

    fn walker() -> Gait {
        walk(&WalkerStyle::preset(Emotion::Happy, Sex::Male), "happy").unwrap()
    }

    #[test]
    fn the_legs_have_no_say() {
        let gait = walker();
        let mut other = gait.clone();
        for pose in &mut other.poses {
            // the body's length counts knees and feet, so they turn about their joints rather than stretch
            let (knee, foot) = (Joint::LeftKnee as usize, Joint::LeftFoot as usize);
            let way = pose[foot] - pose[knee];
            pose[foot] = pose[knee] + glam::Quat::from_rotation_x(0.4) * way;
        }
        let apart =
            numbers(&gait).iter().zip(numbers(&other)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-3, "{apart}");
        assert_eq!(numbers(&gait).len(), NUMBERS);
    }

    #[test]
    fn derivatives_of_a_circle_are_those_of_the_circle() {
        // a hand on a circle of 0.3 m, once a cycle: speed r w, acceleration r w^2, jerk r w^3
        let mut gait = walker();
        gait.speed = 0.0;
        let count = gait.poses.len();
        let body_length = Body::at_rate(&gait).length;
        for (i, pose) in gait.poses.iter_mut().enumerate() {
            let turn = std::f64::consts::TAU * number(i) / number(count);
            #[allow(clippy::cast_possible_truncation, reason = "positions are f32")]
            let (y, z) = ((0.3 * turn.cos()) as f32, (0.3 * turn.sin()) as f32);
            pose[LeftHand as usize] = pose[Root as usize] + glam::Vec3::new(0.0, y, z);
        }
        let body = Body::at_rate(&gait);
        assert!((body.length - body_length).abs() < 1e-9);
        let rate = std::f64::consts::TAU / body.cycle_time;
        for (order, curve) in derivatives(&body, LeftHand).iter().enumerate() {
            let wanted = 0.3 * rate.powi(i32::try_from(order).unwrap() + 1);
            let found = mean(curve);
            assert!((found / wanted - 1.0).abs() < 0.08, "order {order}: {found} for {wanted}");
        }
    }
}
