//! Mid-ranks.
//!
//! Ranks are kept doubled: a mid-rank is a whole or half number, its double a whole one. Sums and comparisons of doubled
//! ranks are exact.

use super::error::{Error, finite};

/// Most values ranked together: the cube of their number must fit 64 bits.
const MOST_VALUES: usize = 1_000_000;

/// Ranks of a sample, from the least value up.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ranks {
    /// Twice the mid-rank of each value, in the order given; the least possible is 2.
    pub doubled: Vec<u64>,
    /// Sum of `t^3 - t` over groups of t equal values.
    pub ties: u64,
}

impl Ranks {
    /// The mid-ranks, in the order given.
    #[allow(clippy::cast_precision_loss, reason = "ranks are far below 2^53")]
    pub fn mid(&self) -> Vec<f64> {
        self.doubled.iter().map(|&rank| rank as f64 / 2.0).collect()
    }
}

/// Ranks `values`; equal values share the mean of their ranks.
///
/// # Errors
/// A value that is not finite, or more than 1,000,000 values.
pub fn ranks(values: &[f64]) -> Result<Ranks, Error> {
    finite("value", values)?;
    if values.len() > MOST_VALUES {
        return Err(Error::TooMany { what: "values to rank", found: values.len(), most: MOST_VALUES });
    }
    let mut order: Vec<usize> = (0..values.len()).collect();
    // 0 added makes -0 equal to 0
    let key = |i: usize| values[i] + 0.0;
    order.sort_by(|&a, &b| key(a).total_cmp(&key(b)));
    let mut doubled = vec![0; values.len()];
    let (mut ties, mut start) = (0, 0);
    for group in order.chunk_by(|&a, &b| key(a).total_cmp(&key(b)).is_eq()) {
        let end = start + group.len();
        // the mean of the ranks start + 1 to end, doubled
        let rank = (start + 1 + end) as u64;
        for &i in group {
            doubled[i] = rank;
        }
        let t = group.len() as u64;
        ties += t * t * t - t;
        start = end;
    }
    Ok(Ranks { doubled, ties })
}
