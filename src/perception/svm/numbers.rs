//! Pairs and counts of classes, and the similarity of points.

/// The distinct classes, ascending.
pub(super) fn distinct(classes: &[usize]) -> Vec<usize> {
    let mut names = classes.to_vec();
    names.sort_unstable();
    names.dedup();
    names
}

/// The pairs of `count` classes: (0, 1), (0, 2), ... (1, 2), ...
pub(super) fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |a| (a + 1..count).map(move |b| (a, b)))
}

pub(super) fn similarity(gamma: Option<f64>, a: &[f64], b: &[f64]) -> f64 {
    match gamma {
        None => a.iter().zip(b).map(|(a, b)| a * b).sum(),
        Some(gamma) => (-gamma * a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>()).exp(),
    }
}

#[allow(clippy::cast_precision_loss, reason = "counts of points and features are far below 2^53")]
pub(super) fn count_f64(count: usize) -> f64 {
    count as f64
}
