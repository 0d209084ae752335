//! How sure a share is.

/// z of a two-sided interval of 95 %.
const Z: f64 = 1.959_963_984_540_054;

/// The 95 % interval of a share of `count` by Wilson (1927); of nothing, anything is possible.
///
/// The share may be a mean over repetitions, and need not be a whole number out of `count`.
pub fn share_interval(share: f64, count: u64) -> [f64; 2] {
    if count == 0 {
        return [0.0, 1.0];
    }
    #[allow(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
    let n = count as f64;
    let whole = 1.0 + Z * Z / n;
    let middle = (share + Z * Z / (2.0 * n)) / whole;
    let half = Z * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt() / whole;
    // rounding must not leave the share itself outside
    [(middle - half).clamp(0.0, share), (middle + half).clamp(share, 1.0)]
}
