//! Drawing by shares.

/// Index of the share that `u` in [0, 1) falls into; shares need not be normalised.
pub(crate) fn weighted(cumulative: &[f32], u: f32) -> usize {
    let total = cumulative.last().copied().unwrap_or(0.0);
    cumulative.partition_point(|&end| end <= u * total).min(cumulative.len().saturating_sub(1))
}

pub(crate) fn cumulate(shares: impl IntoIterator<Item = f32>) -> Vec<f32> {
    let add = |sum: &mut f32, share: f32| {
        *sum += share;
        Some(*sum)
    };
    shares.into_iter().scan(0.0, add).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_drawn_in_proportion_and_empty_ones_never() {
        let ends = cumulate([1.0, 0.0, 3.0, 0.0]);
        assert_eq!(weighted(&ends, 0.0), 0);
        assert_eq!(weighted(&ends, 0.2499), 0);
        assert_eq!(weighted(&ends, 0.25), 2);
        assert_eq!(weighted(&ends, 0.999_999), 2);
        assert_eq!(weighted(&[], 0.5), 0);
    }
}
