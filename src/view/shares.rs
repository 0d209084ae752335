//! Shares of the emotions, as the panel sets them: they always make up the whole.

/// The same shares as parts of one; all alike when there is nothing to share.
pub(super) fn whole(shares: [f32; 4]) -> [f32; 4] {
    let shares = shares.map(|share| if share.is_finite() { share.max(0.0) } else { 0.0 });
    let sum: f32 = shares.iter().sum();
    if sum > 0.0 { shares.map(|share| share / sum) } else { [0.25; 4] }
}

/// One share becomes `value`, 0 to 1; the others keep their proportions and make up the rest.
pub(super) fn with(shares: [f32; 4], index: usize, value: f32) -> [f32; 4] {
    let value = value.clamp(0.0, 1.0);
    let shares = whole(shares);
    let others = 1.0 - shares[index];
    let mut changed = shares.map(|share| {
        // no other person is there: the new ones are of all kinds
        let part = if others > 1e-6 { share / others } else { 1.0 / 3.0 };
        part * (1.0 - value)
    });
    changed[index] = value;
    changed
}

#[cfg(test)]
mod tests {
    use super::*;

    fn are(found: [f32; 4], want: [f32; 4]) {
        let off = found.iter().zip(want).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 1e-6, "{found:?}, not {want:?}");
    }

    #[test]
    fn equal_weights_are_a_quarter_each() {
        are(whole([1.0; 4]), [0.25; 4]);
        are(whole([3.0, 1.0, 0.0, 0.0]), [0.75, 0.25, 0.0, 0.0]);
        are(whole([0.0; 4]), [0.25; 4]);
        are(whole([f32::NAN, -1.0, 2.0, 0.0]), [0.0, 0.0, 1.0, 0.0]);
    }

    #[test]
    fn a_share_that_changes_leaves_the_others_in_proportion() {
        are(with([0.25; 4], 0, 0.7), [0.7, 0.1, 0.1, 0.1]);
        are(with([0.4, 0.3, 0.2, 0.1], 0, 0.1), [0.1, 0.45, 0.3, 0.15]);
        are(with([0.5, 0.5, 0.0, 0.0], 1, 1.0), [0.0, 1.0, 0.0, 0.0]);
        are(with([1.0, 0.0, 0.0, 0.0], 0, 0.4), [0.4, 0.2, 0.2, 0.2]);
        are(with([0.25; 4], 2, 7.0), [0.0, 0.0, 1.0, 0.0]);
    }
}
