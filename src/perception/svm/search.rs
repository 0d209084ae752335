//! C and gamma by search: the pair with the best accuracy on inner folds of the training points.

use super::{Gamma, Kernel, Settings, Svm, Untrainable, count_f64};
use rayon::prelude::*;

/// What is tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Values of C.
    pub c: Vec<f64>,
    /// Values of gamma.
    pub gamma: Vec<Gamma>,
}

impl Default for Grid {
    /// C 0.1 to 100 and gamma 0.003 to 0.3, in steps of about 3 (ours), and the two presets of gamma.
    fn default() -> Self {
        let gamma = [0.003, 0.01, 0.03, 0.1, 0.3].map(Gamma::Value);
        Self {
            c: vec![0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0],
            gamma: [Gamma::Auto, Gamma::Scale].into_iter().chain(gamma).collect(),
        }
    }
}

/// What a search found.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The settings given, with the best C and gamma.
    pub settings: Settings,
    /// Share of right answers on the held-out points of the inner folds.
    pub accuracy: f64,
}

/// Tries every pair of the grid. `folds[i]` is the inner fold of point i (0 to k - 1); of equally good pairs the
/// first of the grid is taken, smaller C before larger.
///
/// # Errors
/// As [`Svm::train`], or if the folds do not match the points or the grid is empty.
pub fn search(
    points: &[Vec<f64>],
    classes: &[usize],
    folds: &[usize],
    settings: &Settings,
    grid: &Grid,
) -> Result<Found, Untrainable> {
    if folds.len() != points.len() || points.len() != classes.len() {
        return Err(Untrainable(format!(
            "{} points, {} classes, {} folds; they must be as many",
            points.len(),
            classes.len(),
            folds.len()
        )));
    }
    let count = folds.iter().max().map_or(0, |last| last + 1);
    let candidates: Vec<Settings> = grid
        .c
        .iter()
        .flat_map(|&c| grid.gamma.iter().map(move |&gamma| (c, gamma)))
        .map(|(c, gamma)| {
            let kernel = Kernel::Rbf(gamma);
            Settings { c, kernel, has_probabilities: false, ..settings.clone() }
        })
        .collect();
    let rights: Result<Vec<usize>, Untrainable> = candidates
        .par_iter()
        .map(|candidate| (0..count).map(|fold| right(points, classes, folds, fold, candidate)).sum())
        .collect();
    let rights = rights?;
    let best = (0..rights.len()).reduce(|best, i| if rights[i] > rights[best] { i } else { best });
    let empty = || Untrainable("the grid is empty: give at least one C and one gamma".to_owned());
    let best = best.ok_or_else(empty)?;
    let found = &candidates[best];
    Ok(Found {
        settings: Settings { c: found.c, kernel: found.kernel, ..settings.clone() },
        accuracy: count_f64(rights[best]) / count_f64(points.len()),
    })
}

/// Right answers on one fold of a machine trained on the others; none where the others have one class only.
fn right(
    points: &[Vec<f64>],
    classes: &[usize],
    folds: &[usize],
    fold: usize,
    settings: &Settings,
) -> Result<usize, Untrainable> {
    let (held, kept): (Vec<usize>, Vec<usize>) = (0..points.len()).partition(|&i| folds[i] == fold);
    let of = |chosen: &[usize]| -> (Vec<Vec<f64>>, Vec<usize>) {
        chosen.iter().map(|&i| (points[i].clone(), classes[i])).unzip()
    };
    let (kept_points, kept_classes) = of(&kept);
    if super::distinct(&kept_classes).len() < 2 {
        return Ok(0);
    }
    let machine = Svm::train(&kept_points, &kept_classes, settings)?;
    Ok(held.iter().filter(|&&i| machine.predict(&points[i]) == classes[i]).count())
}
