//! Answers of the methods: probabilities of the four emotions from distances and from classes.

use super::super::Error;
use crate::emotion::Emotion;
use crate::gait::Gait;

/// Numbers of all gaits, or which gait has some that are not finite.
pub(super) fn finite<T: AsRef<[f64]>>(
    method: &'static str,
    gaits: &[&Gait],
    found: &[T],
) -> Result<(), Error> {
    match found.iter().position(|numbers| !numbers.as_ref().iter().all(|v| v.is_finite())) {
        None => Ok(()),
        Some(i) => Err(Error::Training {
            method,
            message: format!("gait {:?} has numbers that are not finite; leave it out", gaits[i].name),
        }),
    }
}

/// Probabilities from the smallest distance to each emotion: as `1 / distance`, and certain at distance 0. An emotion
/// at infinity, or not a number, has none.
pub(super) fn by_distance(distances: [f64; 4]) -> [f64; 4] {
    let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
    let weights = distances.map(|d| match d {
        d if d.is_nan() => 0.0,
        d if d <= nearest => 1.0,
        d => nearest / d,
    });
    let sum: f64 = weights.iter().sum();
    if sum > 0.0 { weights.map(|weight| weight / sum) } else { [0.25; 4] }
}

/// Smallest distance to a reference of each emotion, infinite where there is none.
pub(super) fn nearest(distances: impl Iterator<Item = (f64, Emotion)>) -> [f64; 4] {
    let mut best = [f64::INFINITY; 4];
    for (distance, emotion) in distances {
        let best = &mut best[emotion.index()];
        *best = best.min(distance);
    }
    best
}

/// Probabilities of the emotions from those of a machine that knows only some of them.
pub(super) fn of_classes(classes: &[usize], probabilities: Option<Vec<f64>>, answer: usize) -> [f64; 4] {
    let mut all = [0.0; 4];
    match probabilities {
        Some(found) => classes.iter().zip(found).for_each(|(&class, p)| all[class] = p),
        None => all[answer] = 1.0,
    }
    all
}
