//! Crenn, Meyer, Khan, Konik, Bouakaz 2017 (ICMI; extended in IEEE Access 2020): what is left when the neutral motion is
//! taken out.
//!
//! Grades. *Abstract*: the neutral motion is made from the expressive one by minimising a cost of neutrality in a space
//! of two nested PCAs; the residue between the two is classified. *Stated*: "residual between input and neutral
//! motion". *Reconstructed*: everything else, and the closed form: every term of the cost is made quadratic, so the
//! neutral motion is the solution of 15 linear equations instead of an iteration.
//!
//! With `z` a motion's coordinates and `x(z)` its curves, the neutral motion minimises
//! `|x''(z)|^2 / a + |ends of x(z) - ends of the mean neutral motion|^2 / e + |z - z_in|^2 / r + z S^-1 z / p`,
//! where the ends are head, hands and feet (they span the box whose volume the original speaks of), `S` is the
//! variance of `z`, and `a`, `e`, `r`, `p` are the means of the terms over the training gaits (of `z_in`, the mean
//! `|z|^2`), so that all four weigh the same.

use super::finite;
use super::machine::{Machine, failed};
use crate::emotion::Emotion;
use crate::gait::{Gait, Joint};
use crate::perception::body::{Body, FRAMES, amplitude, mean};
use crate::perception::linear::{Cholesky, Matrix, Pca, dot, number};
use crate::perception::memo::{Key, Memo, key};
use crate::perception::svm::{Gamma, Kernel, Settings};
use crate::perception::{Error, Method, Perceiver, check_training};
use std::sync::Arc;

/// Name in tables and on the command line.
pub(super) const NAME: &str = "crenn-2017";
/// Coordinates of a pose: all joints but the root.
const COORDINATES: usize = 45;
/// Principal components of a pose.
const POSE_COMPONENTS: usize = 12;
/// Principal components of a motion.
const MOTION_COMPONENTS: usize = 15;
/// Fourier amplitudes kept of each coordinate.
const BINS: usize = 5;
/// Joints that end a limb or the spine.
const ENDS: [Joint; 5] = [Joint::Head, Joint::LeftHand, Joint::RightHand, Joint::LeftFoot, Joint::RightFoot];

/// Statistics of the residue into an RBF machine: C = 1, gamma `scale`, one-versus-one.
#[derive(Debug, Clone, Default)]
pub struct Crenn2017 {
    known: Memo<Key, Arc<Vec<f64>>>,
}

/// A normalised cycle as [`FRAMES`] poses of [`COORDINATES`] numbers, one after another.
fn curves(gait: &Gait) -> Vec<f64> {
    Body::of(gait).poses.iter().flat_map(|pose| pose[1..].iter().flatten().copied()).collect()
}

impl Method for Crenn2017 {
    fn name(&self) -> &'static str {
        NAME
    }

    fn train(&self, gaits: &[&Gait], emotions: &[Emotion], _: u64) -> Result<Box<dyn Perceiver>, Error> {
        check_training(NAME, gaits, emotions)?;
        let all: Vec<Arc<Vec<f64>>> =
            gaits.iter().map(|gait| self.known.of(key(gait), || Arc::new(curves(gait)))).collect();
        let all: Vec<&[f64]> = all.iter().map(|curves| curves.as_slice()).collect();
        finite(NAME, gaits, &all)?;
        let space = Space::of(&all, emotions).ok_or_else(|| {
            failed(NAME)("the gaits do not differ; give gaits of different motion".to_owned())
        })?;
        let raw: Vec<Vec<f64>> = all.iter().map(|curves| space.numbers(curves)).collect();
        let kernel = Kernel::Rbf(Gamma::Scale);
        let settings = Settings { kernel, has_probabilities: true, ..Settings::default() };
        let machine = Machine::train(&raw, gaits, emotions, &settings, None).map_err(failed(NAME))?;
        Ok(Box::new(Trained { space, machine, known: self.known.clone() }))
    }
}

/// The two nested PCAs and the equations of the neutral motion.
#[derive(Debug)]
struct Space {
    pose: Pca,
    motion: Pca,
    /// Left side of the equations.
    equations: Cholesky,
    /// Right side, but for the motion's own part.
    right: Vec<f64>,
    /// The motion's own part of the right side: times its coordinates.
    own: f64,
}

impl Space {
    /// Of the training gaits; none if they do not differ.
    fn of(all: &[&[f64]], emotions: &[Emotion]) -> Option<Self> {
        let poses: Vec<&[f64]> = all.iter().flat_map(|curves| curves.chunks_exact(COORDINATES)).collect();
        let pose = Pca::of(&poses, POSE_COMPONENTS, 1.0)?;
        let coefficients: Vec<Vec<f64>> = all.iter().map(|curves| coefficients(&pose, curves)).collect();
        let motion = Pca::of(&coefficients, MOTION_COMPONENTS, 1.0)?;
        let inputs: Vec<Vec<f64>> = coefficients.iter().map(|c| motion.project(c)).collect();
        // the mean neutral motion, or of all where none is neutral
        let neutral: Vec<&Vec<f64>> = coefficients
            .iter()
            .zip(emotions)
            .filter(|&(_, &emotion)| emotion == Emotion::Neutral)
            .map(|(c, _)| c)
            .collect();
        let neutral =
            if neutral.is_empty() { motion.mean.clone() } else { crate::perception::linear::mean(&neutral) };
        let centre: Vec<f64> = motion.mean.iter().zip(&neutral).map(|(m, n)| m - n).collect();
        let jolt =
            Quadratic::of(&motion, &motion.mean, |c| second_difference(c, pose.variances.len()), &inputs);
        let ends = Quadratic::of(&motion, &centre, |c| ends_of(c, &pose), &inputs);
        let size = motion.variances.len();
        let spread: f64 = motion.variances.iter().sum();
        if spread.is_nan() || spread <= 0.0 {
            return None;
        }
        // z S^-1 z is the number of components, on average
        let prior: Vec<f64> = motion.variances.iter().map(|v| 1.0 / (v * number(size))).collect();
        let own = 1.0 / spread;
        let left = Matrix::diagonal(&prior)
            .plus(own, &Matrix::identity(size))
            .plus(jolt.weight, &jolt.square)
            .plus(ends.weight, &ends.square);
        let right = (0..size).map(|i| -jolt.weight * jolt.linear[i] - ends.weight * ends.linear[i]).collect();
        Some(Self { equations: Cholesky::of(&left)?, right, own, pose, motion })
    }

    /// Coordinates of the neutral motion of a motion with coordinates `input`.
    fn neutral(&self, input: &[f64]) -> Vec<f64> {
        let right: Vec<f64> = self.right.iter().zip(input).map(|(r, z)| r + self.own * z).collect();
        self.equations.solve(&right)
    }

    /// Mean, standard deviation and amplitudes of each coordinate of the residue.
    fn numbers(&self, curves: &[f64]) -> Vec<f64> {
        let input = self.motion.project(&coefficients(&self.pose, curves));
        let neutral = self.motion.restore(&self.neutral(&input));
        let width = self.pose.variances.len();
        let poses: Vec<Vec<f64>> = neutral.chunks_exact(width).map(|c| self.pose.restore(c)).collect();
        let mut found = Vec::with_capacity(COORDINATES * (2 + BINS));
        for i in 0..COORDINATES {
            let residue: Vec<f64> =
                curves.iter().skip(i).step_by(COORDINATES).zip(&poses).map(|(x, pose)| x - pose[i]).collect();
            let mean = mean(&residue);
            let variance = residue.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / number(FRAMES);
            found.extend([mean, variance.sqrt()]);
            found.extend((1..=BINS).map(|k| amplitude(&residue, k)));
        }
        found
    }
}

/// Each pose's coordinates in the space of poses, one pose after another.
fn coefficients(pose: &Pca, curves: &[f64]) -> Vec<f64> {
    curves.chunks_exact(COORDINATES).flat_map(|frame| pose.project(frame)).collect()
}

/// Second difference around the cycle of curves of `width` numbers a frame.
fn second_difference(curve: &[f64], width: usize) -> Vec<f64> {
    let (count, length) = (curve.len(), width.max(1));
    (0..count)
        .map(|i| curve[(i + length) % count] - 2.0 * curve[i] + curve[(i + count - length) % count])
        .collect()
}

/// Where head, hands and feet are moved by coefficients of poses.
fn ends_of(curve: &[f64], pose: &Pca) -> Vec<f64> {
    let width = pose.variances.len().max(1);
    let mut found = Vec::with_capacity(curve.len() / width * ENDS.len() * 3);
    for frame in curve.chunks_exact(width) {
        for joint in ENDS {
            for axis in 0..3 {
                let column = (joint as usize - 1) * 3 + axis;
                found.push(frame.iter().enumerate().map(|(k, c)| c * pose.directions[(k, column)]).sum());
            }
        }
    }
    found
}

/// `|L (centre + W z)|^2` for a linear `L`, over the directions `W` of the motions.
struct Quadratic {
    /// `W^T L^T L W`.
    square: Matrix,
    /// `W^T L^T L centre`.
    linear: Vec<f64>,
    /// 1 over its mean over the training gaits; 0 if that is 0.
    weight: f64,
}

impl Quadratic {
    fn of(motion: &Pca, centre: &[f64], map: impl Fn(&[f64]) -> Vec<f64>, inputs: &[Vec<f64>]) -> Self {
        let size = motion.variances.len();
        let images: Vec<Vec<f64>> = (0..size).map(|k| map(motion.directions.row(k))).collect();
        let origin = map(centre);
        let mut square = Matrix::zeros(size, size);
        for i in 0..size {
            for j in 0..size {
                square[(i, j)] = dot(&images[i], &images[j]);
            }
        }
        let linear: Vec<f64> = images.iter().map(|image| dot(image, &origin)).collect();
        let constant = dot(&origin, &origin);
        let value = |z: &Vec<f64>| {
            let curved: f64 = (0..size).map(|i| z[i] * dot(square.row(i), z)).sum();
            curved + 2.0 * dot(&linear, z) + constant
        };
        let mean = inputs.iter().map(value).sum::<f64>() / number(inputs.len());
        Self { square, linear, weight: if mean > 0.0 { 1.0 / mean } else { 0.0 } }
    }
}

#[derive(Debug)]
struct Trained {
    space: Space,
    machine: Machine,
    known: Memo<Key, Arc<Vec<f64>>>,
}

impl Trained {
    fn numbers(&self, gait: &Gait) -> Vec<f64> {
        self.space.numbers(&self.known.of(key(gait), || Arc::new(curves(gait))))
    }
}

impl Perceiver for Trained {
    fn probabilities(&self, gait: &Gait) -> [f64; 4] {
        self.machine.probabilities(&self.numbers(gait))
    }

    fn emotion(&self, gait: &Gait) -> Emotion {
        self.machine.emotion(&self.numbers(gait))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::walker::{Sex, WalkerStyle, walk};

    fn space() -> (Space, Vec<Vec<f64>>, Vec<Emotion>) {
        let (mut all, mut emotions) = (Vec::new(), Vec::new());
        for emotion in Emotion::ALL {
            for index in 0..5 {
                let style = WalkerStyle::preset(emotion, Sex::Female).vary(6, index);
                all.push(curves(&walk(&style, "w").unwrap()));
                emotions.push(emotion);
            }
        }
        let borrowed: Vec<&[f64]> = all.iter().map(Vec::as_slice).collect();
        (Space::of(&borrowed, &emotions).unwrap(), all, emotions)
    }

    /// The cost as it is written, without the algebra.
    fn cost(space: &Space, all: &[Vec<f64>], emotions: &[Emotion], input: &[f64], z: &[f64]) -> f64 {
        let coefficients_of: Vec<Vec<f64>> = all.iter().map(|c| coefficients(&space.pose, c)).collect();
        let neutral: Vec<&Vec<f64>> = coefficients_of
            .iter()
            .zip(emotions)
            .filter(|(_, e)| **e == Emotion::Neutral)
            .map(|(c, _)| c)
            .collect();
        let neutral = crate::perception::linear::mean(&neutral);
        let width = space.pose.variances.len();
        let terms = |z: &[f64]| {
            let c = space.motion.restore(z);
            let away: Vec<f64> = c.iter().zip(&neutral).map(|(c, n)| c - n).collect();
            let (jolt, ends) = (second_difference(&c, width), ends_of(&away, &space.pose));
            let prior: f64 = z.iter().zip(&space.motion.variances).map(|(z, v)| z * z / v).sum();
            [dot(&jolt, &jolt), dot(&ends, &ends), prior, dot(z, z)]
        };
        let inputs: Vec<Vec<f64>> = coefficients_of.iter().map(|c| space.motion.project(c)).collect();
        let mut means = [0.0; 4];
        for z in &inputs {
            means.iter_mut().zip(terms(z)).for_each(|(m, t)| *m += t / number(inputs.len()));
        }
        let [jolt, ends, prior, _] = terms(z);
        let own: f64 = z.iter().zip(input).map(|(a, b)| (a - b).powi(2)).sum();
        jolt / means[0] + ends / means[1] + prior / means[2] + own / means[3]
    }

    #[test]
    fn the_neutral_motion_minimises_the_cost() {
        let (space, all, emotions) = space();
        let input = space.motion.project(&coefficients(&space.pose, &all[7]));
        let best = space.neutral(&input);
        let least = cost(&space, &all, &emotions, &input, &best);
        assert!(least < cost(&space, &all, &emotions, &input, &input));
        for i in 0..best.len() {
            for step in [-0.01, 0.01] {
                let mut other = best.clone();
                other[i] += step;
                assert!(cost(&space, &all, &emotions, &input, &other) > least, "component {i}");
            }
        }
    }

    #[test]
    fn a_neutral_walker_leaves_less_than_a_happy_one() {
        let (space, all, _) = space();
        let size = |numbers: &[f64]| numbers.iter().map(|v| v * v).sum::<f64>();
        let of = |range: std::ops::Range<usize>| range.map(|i| size(&space.numbers(&all[i]))).sum::<f64>();
        assert!(of(15..20) < of(0..5), "{} {}", of(15..20), of(0..5));
        assert_eq!(space.numbers(&all[0]).len(), COORDINATES * 7);
    }
}
