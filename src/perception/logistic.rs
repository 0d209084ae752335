//! Multinomial logistic regression with a ridge.
//!
//! Points of classes in; for each class a plane, so that `P(class | x) = exp(plane . [x, 1]) / sum` (softmax). The planes
//! minimise `-sum log P(class of x | x) + ridge/2 |slopes|^2`; offsets cost nothing. The minimum is unique and found by
//! Böhning's lower bound (1992, Ann. Inst. Statist. Math. 44): the curvature of the likelihood never exceeds
//! `1/2 X^T X` for each class, so that one factored matrix gives all steps, which always go down; with Nesterov's
//! momentum, restarted where it leads up.

use super::linear::{Cholesky, Matrix, dot, number};
use serde::{Deserialize, Serialize};

/// Most steps; a few dozen are needed.
const STEPS: usize = 2_000;
/// The minimum is found when no part of the gradient exceeds this for each point.
const FLAT: f64 = 1e-6;
/// Keeps the matrix positive definite where a number does not vary; of the points' number.
const FIRM: f64 = 1e-9;

/// Points to learn from are not finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the points are not finite")]
pub struct NotFinite;

/// A trained regression.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Logistic {
    /// Of each class: its slopes and last its offset.
    planes: Vec<Vec<f64>>,
}

impl Logistic {
    /// Learns from points of one length with their classes, 0 to `classes` - 1, each of which occurs; `start` is a
    /// regression with a like ridge, to be there sooner.
    ///
    /// # Errors
    /// [`NotFinite`].
    pub fn train<P: AsRef<[f64]>>(
        points: &[P],
        of: &[usize],
        classes: usize,
        ridge: f64,
        start: Option<&Self>,
    ) -> Result<Self, NotFinite> {
        let rows: Vec<Vec<f64>> =
            points.iter().map(|point| point.as_ref().iter().copied().chain([1.0]).collect()).collect();
        let size = rows.first().map_or(0, Vec::len);
        let bound = Cholesky::of(&bound(&rows, size, ridge)).ok_or(NotFinite)?;
        let mut planes = start.map_or_else(|| vec![vec![0.0; size]; classes], |s| s.planes.clone());
        let mut ahead = planes.clone();
        let mut momentum = 1.0_f64;
        for _ in 0..STEPS {
            let slope = gradient(&rows, of, &ahead, ridge);
            if slope.iter().flatten().all(|part| part.abs() <= FLAT * number(rows.len())) {
                break;
            }
            let next: Vec<Vec<f64>> =
                ahead.iter().zip(&slope).map(|(plane, slope)| less(plane, &bound.solve(slope))).collect();
            // the step leads up against the way taken: restart the momentum
            let turns: f64 =
                (0..classes).map(|c| dot(&less(&ahead[c], &next[c]), &less(&next[c], &planes[c]))).sum();
            let after =
                if turns > 0.0 { 1.0 } else { f64::midpoint(1.0, (4.0 * momentum * momentum + 1.0).sqrt()) };
            let carry = if turns > 0.0 { 0.0 } else { (momentum - 1.0) / after };
            for ((ahead, next), plane) in ahead.iter_mut().zip(&next).zip(&planes) {
                *ahead = next.iter().zip(plane).map(|(n, p)| n + carry * (n - p)).collect();
            }
            planes = next;
            momentum = after;
        }
        Ok(Self { planes: ahead })
    }

    /// Says what is wrong with a regression that was read from a file, for points of `length` numbers.
    ///
    /// # Errors
    /// A message with what was found and expected.
    pub(crate) fn validate(&self, classes: usize, length: usize) -> Result<(), String> {
        if self.planes.len() != classes {
            return Err(format!("{} planes for {classes} emotions", self.planes.len()));
        }
        match self
            .planes
            .iter()
            .find(|plane| plane.len() != length + 1 || !plane.iter().all(|v| v.is_finite()))
        {
            Some(plane) => {
                let (found, wanted) = (plane.len(), length + 1);
                Err(format!("a plane of {found} numbers; each must have {wanted} finite ones"))
            }
            None => Ok(()),
        }
    }

    /// Probability of each class; they add up to 1.
    pub fn probabilities(&self, point: &[f64]) -> Vec<f64> {
        let scores = self.planes.iter().map(|plane| dot(plane, point) + plane.last().copied().unwrap_or(0.0));
        softmax(scores.collect())
    }
}

/// `a - b`.
fn less(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// `exp(score) / sum`.
fn softmax(mut scores: Vec<f64>) -> Vec<f64> {
    let most = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    scores.iter_mut().for_each(|score| *score = (*score - most).exp());
    let sum: f64 = scores.iter().sum();
    scores.iter_mut().for_each(|score| *score /= sum);
    scores
}

/// `1/2 X^T X + ridge` (the offset without it), its lower triangle.
fn bound(rows: &[Vec<f64>], size: usize, ridge: f64) -> Matrix {
    let mut matrix = Matrix::zeros(size, size);
    for row in rows {
        for i in 0..size {
            let factor = 0.5 * row[i];
            matrix.row_mut(i)[..=i].iter_mut().zip(row).for_each(|(to, from)| *to += factor * from);
        }
    }
    for i in 0..size {
        matrix[(i, i)] += FIRM * number(rows.len()) + if i + 1 < size { ridge } else { 0.0 };
    }
    matrix
}

/// Of what is minimised, for each class.
fn gradient(rows: &[Vec<f64>], of: &[usize], planes: &[Vec<f64>], ridge: f64) -> Vec<Vec<f64>> {
    let mut slope: Vec<Vec<f64>> = planes
        .iter()
        .map(|plane| {
            let last = plane.len() - 1;
            plane.iter().enumerate().map(|(i, p)| if i < last { ridge * p } else { 0.0 }).collect()
        })
        .collect();
    for (row, &class) in rows.iter().zip(of) {
        let told = softmax(planes.iter().map(|plane| dot(plane, row)).collect());
        for (c, (slope, p)) in slope.iter_mut().zip(told).enumerate() {
            let error = p - f64::from(u8::from(c == class));
            slope.iter_mut().zip(row).for_each(|(s, x)| *s += error * x);
        }
    }
    slope
}

#[cfg(test)]
mod tests;
