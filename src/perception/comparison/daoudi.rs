//! Daoudi, Berretti, Pala, Delevoye, Del Bimbo 2017 (ICIAP workshops, arXiv 1707.07180): covariances of the joints as points
//! of a Riemannian manifold.
//!
//! Grades. *Abstract*: covariance descriptors of the sequence of 3-D joints, the manifold of symmetric positive definite
//! matrices, geodesic distances and geometric means. *Stated*: SPD manifold and nearest neighbours. *Reconstructed*:
//! the normalisation of the joints (heading, body length, 64 frames) and the amount of shrinkage. A gait of fewer
//! frames than coordinates has a singular covariance; what is added to its diagonal makes it a point of the manifold.

use super::{by_distance, nearest};
use crate::emotion::Emotion;
use crate::gait::Gait;
use crate::perception::body::Body;
use crate::perception::linear::{Cholesky, Eigen, Matrix, covariance, eigenvalues, mean, number};
use crate::perception::memo::{Key, Memo, key};
use crate::perception::{Error, Method, Perceiver, check_training};
use std::sync::Arc;

/// Name in tables and on the command line.
pub(super) const NAME: &str = "daoudi-2017";
/// Coordinates of a pose: all joints but the root, which is the origin.
const COORDINATES: usize = 45;
/// Added to the diagonal: this share of the mean variance.
const SHRINKAGE: f64 = 1e-3;
/// Most rounds of the geometric mean.
const ROUNDS: usize = 20;

/// How far apart two covariances are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Metric {
    /// `|log(A^-1/2 B A^-1/2)|`: the same for `X A X^T` and `X B X^T`.
    #[default]
    AffineInvariant,
    /// `|log A - log B|`: cheaper.
    LogEuclidean,
}

/// What answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[doc(hidden)]
pub enum Rule {
    /// The emotion of the nearest training gait.
    #[default]
    NearestNeighbour,
    /// The emotion with the nearest geometric mean (of [`Metric`]; affine-invariant: Karcher's).
    NearestMean,
}

/// Covariance descriptors, compared along geodesics.
#[derive(Debug, Clone, Default)]
pub struct Daoudi2017 {
    /// How far apart two covariances are.
    pub metric: Metric,
    /// What answers.
    pub rule: Rule,
    known: Memo<Key, Option<Arc<Point>>>,
    distances: Memo<(Key, Key), f64>,
}

impl Daoudi2017 {
    /// With this metric and rule.
    pub fn new(metric: Metric, rule: Rule) -> Self {
        Self { metric, rule, ..Self::default() }
    }
}

/// A point of the manifold.
#[derive(Debug, Clone, PartialEq)]
struct Point {
    matrix: Matrix,
    factor: Cholesky,
    logarithm: Matrix,
}

impl Point {
    /// None if the matrix is not symmetric positive definite.
    fn of(matrix: Matrix) -> Option<Self> {
        let logarithm = Eigen::of(&matrix)?.apply(f64::ln);
        let is_finite = logarithm.values.iter().all(|v| v.is_finite());
        Some(Self { factor: Cholesky::of(&matrix).filter(|_| is_finite)?, matrix, logarithm })
    }

    /// The covariance of a gait's joints.
    fn of_gait(gait: &Gait) -> Option<Self> {
        let frames: Vec<Vec<f64>> =
            Body::of(gait).poses.iter().map(|pose| pose[1..].iter().flatten().copied().collect()).collect();
        let spread = covariance(&frames, &mean(&frames));
        let share = (SHRINKAGE * spread.trace() / number(COORDINATES)).max(f64::MIN_POSITIVE.sqrt());
        Self::of(spread.plus(share, &Matrix::identity(COORDINATES)))
    }
}

/// Distance of two points; infinite where it is not a number.
fn distance(metric: Metric, a: &Point, b: &Point) -> f64 {
    let found = match metric {
        Metric::LogEuclidean => a.logarithm.plus(-1.0, &b.logarithm).norm(),
        Metric::AffineInvariant => eigenvalues(&a.factor.whiten(&b.matrix))
            .map_or(f64::NAN, |values| values.iter().map(|v| v.ln() * v.ln()).sum::<f64>().sqrt()),
    };
    if found.is_finite() { found } else { f64::INFINITY }
}

/// Geometric mean: the point whose sum of squared distances is smallest.
fn geometric_mean(metric: Metric, points: &[&Point]) -> Option<Point> {
    let first = points.first()?;
    let size = first.matrix.rows;
    let share = 1.0 / number(points.len());
    let logarithm =
        points.iter().fold(Matrix::zeros(size, size), |sum, point| sum.plus(share, &point.logarithm));
    let mut matrix = Eigen::of(&logarithm)?.apply(f64::exp);
    if metric == Metric::LogEuclidean {
        return Point::of(matrix);
    }
    // Karcher's: from the log-Euclidean mean, a step along the mean of the directions to all points
    for _ in 0..ROUNDS {
        let eigen = Eigen::of(&matrix)?;
        let (root, inverse) = (eigen.apply(f64::sqrt), eigen.apply(|v| 1.0 / v.sqrt()));
        let mut step = Matrix::zeros(size, size);
        for point in points {
            let seen = symmetric(&inverse.times(&point.matrix).times(&inverse));
            step = step.plus(share, &Eigen::of(&seen)?.apply(f64::ln));
        }
        matrix = symmetric(&root.times(&Eigen::of(&step)?.apply(f64::exp)).times(&root));
        if step.norm() < 1e-8 {
            break;
        }
    }
    Point::of(matrix)
}

/// `(A + A^T) / 2`: rounding makes products a little unsymmetric.
fn symmetric(matrix: &Matrix) -> Matrix {
    let mut half = matrix.plus(1.0, &matrix.transposed());
    half.values.iter_mut().for_each(|v| *v /= 2.0);
    half
}

impl Method for Daoudi2017 {
    fn name(&self) -> &'static str {
        NAME
    }

    fn train(&self, gaits: &[&Gait], emotions: &[Emotion], _: u64) -> Result<Box<dyn Perceiver>, Error> {
        check_training(NAME, gaits, emotions)?;
        let failed = |message: String| Error::Training { method: NAME, message };
        let mut references = Vec::with_capacity(gaits.len());
        for (gait, &emotion) in gaits.iter().zip(emotions) {
            let key = key(gait);
            let point = self.known.of(key, || Point::of_gait(gait).map(Arc::new)).ok_or_else(|| {
                failed(format!("gait {:?} has numbers that are not finite; leave it out", gait.name))
            })?;
            references.push((Some(key), point, emotion));
        }
        if self.rule == Rule::NearestMean {
            let all = std::mem::take(&mut references);
            for emotion in Emotion::ALL {
                let members: Vec<&Point> = all
                    .iter()
                    .filter(|(_, _, e)| *e == emotion)
                    .map(|(_, point, _)| point.as_ref())
                    .collect();
                if !members.is_empty() {
                    let mean = geometric_mean(self.metric, &members)
                        .ok_or_else(|| failed(format!("the {emotion} gaits have no geometric mean")))?;
                    references.push((None, Arc::new(mean), emotion));
                }
            }
        }
        Ok(Box::new(Trained { references, method: self.clone() }))
    }
}

#[derive(Debug)]
struct Trained {
    /// The key of a gait, none of a mean.
    references: Vec<(Option<Key>, Arc<Point>, Emotion)>,
    method: Daoudi2017,
}

impl Perceiver for Trained {
    fn probabilities(&self, gait: &Gait) -> [f64; 4] {
        let own = key(gait);
        let Some(point) = self.method.known.of(own, || Point::of_gait(gait).map(Arc::new)) else {
            return [0.25; 4];
        };
        by_distance(nearest(self.references.iter().map(|(other, reference, emotion)| {
            // a pair has one order, so that both ways round give the same bits
            let found = match *other {
                Some(other) if own <= other => {
                    self.method.distances.of((own, other), || distance(self.method.metric, &point, reference))
                }
                Some(other) => {
                    self.method.distances.of((other, own), || distance(self.method.metric, reference, &point))
                }
                None => distance(self.method.metric, reference, &point),
            };
            (found, *emotion)
        })))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::perception::evaluate::Random;

    /// A symmetric positive definite matrix.
    fn spd(size: usize, seed: u64) -> Matrix {
        let mut random = Random::new(seed);
        let mut half = Matrix::zeros(size, size);
        half.values.iter_mut().for_each(|v| *v = random.unit() - 0.5);
        half.times(&half.transposed()).plus(0.05, &Matrix::identity(size))
    }

    fn point(matrix: &Matrix) -> Point {
        Point::of(matrix.clone()).unwrap()
    }

    #[test]
    fn the_geodesic_distance_is_the_same_after_any_linear_map() {
        let (a, b, x) = (spd(6, 1), spd(6, 2), spd(6, 3).plus(0.3, &spd(6, 4)));
        let mapped = |m: &Matrix| point(&symmetric(&x.times(m).times(&x.transposed())));
        let before = distance(Metric::AffineInvariant, &point(&a), &point(&b));
        let after = distance(Metric::AffineInvariant, &mapped(&a), &mapped(&b));
        assert!((before - after).abs() < 1e-7 && before > 0.5, "{before} {after}");
        let back = distance(Metric::AffineInvariant, &point(&b), &point(&a));
        assert!((before - back).abs() < 1e-9);
        assert!(distance(Metric::AffineInvariant, &point(&a), &point(&a)) < 1e-9);
    }

    #[test]
    fn the_distance_of_diagonal_matrices_is_that_of_their_logarithms() {
        let (a, b) = (Matrix::diagonal(&[1.0, 2.0, 8.0]), Matrix::diagonal(&[4.0, 2.0, 1.0]));
        let wanted = (4_f64.ln().powi(2) + 8_f64.ln().powi(2)).sqrt();
        for metric in [Metric::AffineInvariant, Metric::LogEuclidean] {
            assert!((distance(metric, &point(&a), &point(&b)) - wanted).abs() < 1e-12);
        }
    }

    #[test]
    fn the_mean_of_commuting_matrices_is_that_of_their_logarithms() {
        let basis = Eigen::of(&spd(5, 9)).unwrap();
        let with = |values: [f64; 5]| Eigen { values: values.to_vec(), ..basis.clone() }.apply(|v| v);
        let (a, b) = (with([1.0, 2.0, 4.0, 0.5, 3.0]), with([4.0, 2.0, 1.0, 2.0, 27.0]));
        let wanted = with([2.0, 2.0, 2.0, 1.0, 9.0]);
        for metric in [Metric::AffineInvariant, Metric::LogEuclidean] {
            let mean = geometric_mean(metric, &[&point(&a), &point(&b)]).unwrap();
            assert!(mean.matrix.plus(-1.0, &wanted).norm() < 1e-8, "{metric:?}");
        }
    }

    #[test]
    fn the_karcher_mean_of_two_matrices_is_halfway_between_them() {
        let (a, b) = (point(&spd(6, 1)), point(&spd(6, 2)));
        let mean = geometric_mean(Metric::AffineInvariant, &[&a, &b]).unwrap();
        let whole = distance(Metric::AffineInvariant, &a, &b);
        for end in [&a, &b] {
            assert!((distance(Metric::AffineInvariant, end, &mean) - whole / 2.0).abs() < 1e-6);
        }
        let cheap = geometric_mean(Metric::LogEuclidean, &[&a, &b]).unwrap();
        assert!(cheap.matrix.plus(-1.0, &mean.matrix).norm() > 1e-6, "they do not commute");
    }

    #[test]
    fn all_metrics_and_rules_recognise_walkers() {
        use crate::gait::walker::{Sex, WalkerStyle, walk};
        let make = |seed, index, emotion| {
            walk(&WalkerStyle::preset(emotion, Sex::Male).vary(seed, index), "w").unwrap()
        };
        let (mut gaits, mut emotions) = (Vec::new(), Vec::new());
        for index in 0..4 {
            for emotion in [Emotion::Sad, Emotion::Happy] {
                gaits.push(make(1, index, emotion));
                emotions.push(emotion);
            }
        }
        let gaits: Vec<&Gait> = gaits.iter().collect();
        for metric in [Metric::AffineInvariant, Metric::LogEuclidean] {
            for rule in [Rule::NearestNeighbour, Rule::NearestMean] {
                let perceiver = Daoudi2017::new(metric, rule).train(&gaits, &emotions, 0).unwrap();
                for index in 0..3 {
                    assert_eq!(
                        perceiver.emotion(&make(2, index, Emotion::Sad)),
                        Emotion::Sad,
                        "{metric:?} {rule:?}"
                    );
                }
            }
        }
    }
}
