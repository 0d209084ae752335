//! Whether a gait is unlike those that a model has learned from.
//!
//! The training gaits are taken as a cloud with a width of its own along its `MOST` widest directions and one width along
//! all others (probabilistic principal components, Tipping and Bishop 1999). A point's distance to it is Mahalanobis'
//!
//! `d^2 = 1/D (sum_i c_i^2 / variance_i + |rest|^2 / rest_variance)`
//!
//! with `D` numbers of the point, `c_i` along the directions and `rest` what these leave. The limit is taken from the
//! training gaits themselves: each is measured against the cloud of the other people, and `WITHIN` of them lie within it.
//! So a gait beyond the limit is farther from the training gaits than they lie from one another.

use super::linear::{Pca, distance_squared, dot, number};
use serde::{Deserialize, Serialize};

/// Most directions with a width of their own.
const MOST: usize = 20;
/// Gaits for each of them.
const PER_DIRECTION: usize = 10;
/// Share of the training gaits, held out, that lie within the limit.
const WITHIN: f64 = 0.99;
/// Least variance, of the largest: gaits that do not vary at all in some number have no infinite weight there.
const LEAST: f64 = 1e-6;

/// The cloud of the training gaits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Novelty {
    mean: Vec<f64>,
    /// Unit vectors, each of the mean's length.
    directions: Vec<Vec<f64>>,
    /// Variance along each.
    variances: Vec<f64>,
    /// Variance along each of all other directions.
    rest: f64,
    /// Distance beyond which a point is unlike the training gaits.
    limit: f64,
}

impl Novelty {
    /// The cloud of `points`, all of one length; `folds` says which of them are held out together to find the limit. None
    /// if they do not vary, are not finite or are all of one fold.
    pub fn fit(points: &[Vec<f64>], folds: &[usize]) -> Option<Self> {
        let mut held_out = Vec::with_capacity(points.len());
        for fold in 0..=folds.iter().copied().max()? {
            let of = |out: bool| {
                let chosen = points.iter().zip(folds).filter(move |(_, f)| (**f == fold) == out);
                chosen.map(|(point, _)| point.clone()).collect::<Vec<_>>()
            };
            let (out, others) = (of(true), of(false));
            if !out.is_empty() {
                let cloud = Self::cloud(&others)?;
                held_out.extend(out.iter().map(|point| cloud.distance(point)));
            }
        }
        held_out.sort_by(f64::total_cmp);
        let limit = *held_out.get(rank(held_out.len()))?;
        let cloud = Self::cloud(points)?;
        (limit > 0.0 && limit.is_finite()).then_some(Self { limit, ..cloud })
    }

    /// The cloud without its limit.
    fn cloud(points: &[Vec<f64>]) -> Option<Self> {
        let most = (points.len() / PER_DIRECTION).clamp(1, MOST);
        let Pca { mean, directions, variances } = Pca::of(points, most, 1.0)?;
        let total = points.iter().map(|p| distance_squared(p, &mean)).sum::<f64>() / number(points.len());
        let widest = *variances.first()?;
        let others = number(mean.len().checked_sub(variances.len()).filter(|count| *count > 0)?);
        let rest = ((total - variances.iter().sum::<f64>()) / others).max(LEAST * widest);
        let variances: Vec<f64> = variances.into_iter().map(|v| v.max(LEAST * widest)).collect();
        let directions = (0..variances.len()).map(|i| directions.row(i).to_vec()).collect();
        (widest > 0.0 && rest.is_finite()).then_some(Self { mean, directions, variances, rest, limit: 1.0 })
    }

    /// Distance of a point to the training gaits.
    fn distance(&self, point: &[f64]) -> f64 {
        let away: Vec<f64> = point.iter().zip(&self.mean).map(|(p, m)| p - m).collect();
        let mut left = dot(&away, &away);
        let mut squares = 0.0;
        for (direction, variance) in self.directions.iter().zip(&self.variances) {
            let along = dot(direction, &away);
            squares += along * along / variance;
            left -= along * along;
        }
        ((squares + left.max(0.0) / self.rest) / number(self.mean.len())).sqrt()
    }

    /// Distance of a point to the training gaits in units of the limit: above 1 it is unlike them. Infinite if the
    /// point is not finite.
    pub fn of(&self, point: &[f64]) -> f64 {
        let found = self.distance(point) / self.limit;
        if found.is_nan() { f64::INFINITY } else { found }
    }

    /// Says what is wrong with a cloud that was read from a file; its points have `length` numbers.
    ///
    /// # Errors
    /// A message with what was found and expected.
    pub(crate) fn validate(&self, length: usize) -> Result<(), String> {
        let lengths = std::iter::once(&self.mean).chain(&self.directions).map(Vec::len);
        if let Some(found) = lengths.into_iter().find(|found| *found != length) {
            return Err(format!("novelty has a row of {found} numbers; expected {length}"));
        }
        if self.variances.len() != self.directions.len() {
            let (found, expected) = (self.variances.len(), self.directions.len());
            return Err(format!("novelty has {found} variances for {expected} directions"));
        }
        let widths = self.variances.iter().chain([&self.rest, &self.limit]);
        if let Some(width) = widths.into_iter().find(|width| !(**width > 0.0 && width.is_finite())) {
            return Err(format!("novelty has a variance or limit of {width}; it must be above 0"));
        }
        if !self.mean.iter().chain(self.directions.iter().flatten()).all(|v| v.is_finite()) {
            return Err("novelty has a number that is not finite".to_owned());
        }
        Ok(())
    }
}

/// Place of the limit among `count` sorted distances.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share of a count of gaits is a count of gaits"
)]
fn rank(count: usize) -> usize {
    ((WITHIN * number(count)).ceil() as usize).saturating_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::perception::evaluate::Random;

    /// Points that vary by 3 along the first number, by 1 along the second and hardly along 28 others.
    fn points(count: usize, seed: u64) -> Vec<Vec<f64>> {
        let mut random = Random::new(seed);
        let mut normal = || (0..12).map(|_| random.unit()).sum::<f64>() - 6.0;
        let wide = |i: usize| match i {
            0 => 3.0,
            1 => 1.0,
            _ => 0.05,
        };
        (0..count).map(|_| (0..30).map(|i| wide(i) * normal()).collect()).collect()
    }

    fn folds(count: usize) -> Vec<usize> {
        (0..count).map(|i| i % 10).collect()
    }

    #[test]
    fn one_in_a_hundred_of_the_same_kind_is_unlike_and_all_of_another_kind_are() {
        let novelty = Novelty::fit(&points(400, 1), &folds(400)).unwrap();
        let beyond = points(1000, 2).iter().filter(|point| novelty.of(point) > 1.0).count();
        assert!((2..=30).contains(&beyond), "{beyond} of 1000");
        for mut other in points(100, 3) {
            other[17] += 1.0;
            assert!(novelty.of(&other) > 1.0);
        }
    }

    #[test]
    fn far_along_a_wide_direction_is_nearer_than_the_same_way_along_a_narrow_one() {
        let novelty = Novelty::fit(&points(400, 1), &folds(400)).unwrap();
        let at = |i: usize| {
            let mut point = vec![0.0; 30];
            point[i] = 3.0;
            novelty.of(&point)
        };
        assert!(at(0) < at(1) && at(1) < at(5), "{} {} {}", at(0), at(1), at(5));
        assert!(novelty.of(&[f64::NAN; 30]).is_infinite());
    }

    #[test]
    fn what_does_not_vary_or_is_of_one_fold_has_no_novelty() {
        assert!(Novelty::fit(&vec![vec![1.0; 30]; 20], &folds(20)).is_none());
        assert!(Novelty::fit(&points(20, 1), &[0; 20]).is_none());
        assert!(Novelty::fit(&[], &[]).is_none());
    }

    #[test]
    fn a_damaged_cloud_is_refused() {
        let good = Novelty::fit(&points(60, 1), &folds(60)).unwrap();
        assert!(good.validate(30).is_ok());
        assert!(good.validate(29).unwrap_err().contains("expected 29"));
        assert!(Novelty { rest: 0.0, ..good.clone() }.validate(30).unwrap_err().contains("above 0"));
        assert!(Novelty { variances: vec![], ..good }.validate(30).unwrap_err().contains("0 variances"));
    }
}
