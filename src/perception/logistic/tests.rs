#![allow(clippy::unwrap_used, reason = "a test fails loudly")]
use super::*;
use crate::perception::evaluate::Random;

/// Points of `classes` clouds in `size` dimensions that overlap.
fn clouds(count: usize, size: usize, classes: usize, seed: u64) -> (Vec<Vec<f64>>, Vec<usize>) {
    let mut random = Random::new(seed);
    let of: Vec<usize> = (0..count).map(|i| i % classes).collect();
    let points = of
        .iter()
        .map(|&class| {
            (0..size)
                .map(|i| 4.0 * random.unit() - 2.0 + if i % classes == class { 1.0 } else { 0.0 })
                .collect()
        })
        .collect();
    (points, of)
}

/// What the planes minimise.
fn cost(points: &[Vec<f64>], of: &[usize], model: &Logistic, ridge: f64) -> f64 {
    let surprise: f64 =
        points.iter().zip(of).map(|(point, &class)| -model.probabilities(point)[class].ln()).sum();
    let slopes = model.planes.iter().flat_map(|plane| &plane[..plane.len() - 1]);
    surprise + ridge / 2.0 * slopes.map(|s| s * s).sum::<f64>()
}

#[test]
fn no_step_in_any_direction_makes_it_better() {
    for (count, size, ridge) in [(40, 3, 0.5), (30, 50, 3.0), (60, 8, 300.0)] {
        let (points, of) = clouds(count, size, 3, 5);
        let model = Logistic::train(&points, &of, 3, ridge, None).unwrap();
        let least = cost(&points, &of, &model, ridge);
        for class in 0..3 {
            for i in 0..=size {
                for step in [-0.01, 0.01] {
                    let mut other = model.clone();
                    other.planes[class][i] += step;
                    assert!(cost(&points, &of, &other, ridge) > least - 1e-9, "{size} {class} {i}");
                }
            }
        }
    }
}

#[test]
fn the_start_is_no_matter() {
    let (points, of) = clouds(50, 20, 4, 9);
    let far = Logistic::train(&points, &of, 4, 1000.0, None).unwrap();
    let a = Logistic::train(&points, &of, 4, 2.0, None).unwrap();
    let b = Logistic::train(&points, &of, 4, 2.0, Some(&far)).unwrap();
    for point in &points {
        let (a, b) = (a.probabilities(point), b.probabilities(point));
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-4), "{a:?} {b:?}");
        assert!((a.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_large_ridge_leaves_the_shares_of_the_classes() {
    let points: Vec<Vec<f64>> = (0..10).map(|i| vec![f64::from(i)]).collect();
    let of = [0, 0, 0, 0, 0, 0, 0, 1, 1, 1];
    let model = Logistic::train(&points, &of, 2, 1e9, None).unwrap();
    assert!((model.probabilities(&[3.0])[0] - 0.7).abs() < 1e-5);
}

#[test]
fn probabilities_are_those_of_an_independent_program() {
    // scikit-learn 1.9, LogisticRegression(C = 1/0.8), which minimises the same
    let points =
        [[0.5, 1.2], [1.5, -0.3], [-0.7, 0.4], [2.1, 1.9], [-1.3, -0.8], [0.2, 0.1], [1.1, 2.2], [-0.4, 1.7]];
    let model = Logistic::train(&points, &[0, 1, 2, 0, 2, 1, 0, 2], 3, 0.8, None).unwrap();
    for (point, theirs) in [
        ([0.3, 0.9], [0.366_342_7, 0.265_596_9, 0.368_060_4]),
        ([-1.0, 2.0], [0.163_127_2, 0.024_427_3, 0.812_445_5]),
    ] {
        let ours = model.probabilities(&point);
        assert!(ours.iter().zip(theirs).all(|(a, b)| (a - b).abs() < 2e-6), "{ours:?}");
    }
}

#[test]
fn points_without_numbers_are_refused() {
    assert!(Logistic::train(&[[1.0], [f64::NAN]], &[0, 1], 2, 1.0, None).is_err());
}
