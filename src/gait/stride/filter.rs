//! Signals of one take: zero-phase low-pass, peaks with prominence.

use crate::gait::Pose;
use std::f32::consts::{PI, SQRT_2};

/// Fourth-order Butterworth low-pass without phase shift: a second-order filter run forwards and backwards.
///
/// `rate` and `cutoff` in Hz. The ends are extended by reflection through the end points. A cutoff at or above
/// 0.45 of the rate leaves the signal as it is.
pub(in crate::gait) fn low_pass(signal: &[f32], rate: f32, cutoff: f32) -> Vec<f32> {
    let (Some(&first), Some(&last)) = (signal.first(), signal.last()) else { return Vec::new() };
    if cutoff >= 0.45 * rate {
        return signal.to_vec();
    }
    // One second order pass loses 3 dB at the cutoff, two lose 6: widened so that both together lose 3 dB.
    let k = libm::tanf((PI * cutoff / 0.802 / rate).min(1.4));
    let norm = 1.0 / (1.0 + SQRT_2 * k + k * k);
    let b = [k * k * norm, 2.0 * k * k * norm, k * k * norm];
    let a = [2.0 * (k * k - 1.0) * norm, (1.0 - SQRT_2 * k + k * k) * norm];

    let pad = frames(1.5 * rate / cutoff).min(signal.len() - 1);
    let front = (1..=pad).rev().map(|i| 2.0 * first - signal[i]);
    let back = (1..=pad).map(|i| 2.0 * last - signal[signal.len() - 1 - i]);
    let mut padded: Vec<f32> = front.chain(signal.iter().copied()).chain(back).collect();
    for _ in 0..2 {
        // Started in the steady state of the first value, so that the start does not ring.
        let start = padded.first().copied().unwrap_or(0.0);
        let (mut x1, mut x2, mut y1, mut y2) = (start, start, start, start);
        for value in &mut padded {
            let x = *value;
            let y = b[0] * x + b[1] * x1 + b[2] * x2 - a[0] * y1 - a[1] * y2;
            (x2, x1, y2, y1) = (x1, x, y1, y);
            *value = y;
        }
        padded.reverse();
    }
    padded[pad..pad + signal.len()].to_vec()
}

/// Central differences per second.
pub(super) fn derivative(signal: &[f32], rate: f32) -> Vec<f32> {
    let last = signal.len().saturating_sub(1);
    (0..signal.len())
        .map(|i| {
            let (before, after) = (i.saturating_sub(1), (i + 1).min(last));
            (signal[after] - signal[before]) * rate / (after - before).max(1) as f32
        })
        .collect()
}

/// Local maxima at least `separation` frames apart that stand at least `prominence` above the higher of the two
/// lowest points that part them from higher ground. A plateau counts once, at its middle.
pub(super) fn peaks(signal: &[f32], separation: f32, prominence: f32) -> Vec<usize> {
    let mut found: Vec<usize> = Vec::new();
    let mut i = 1;
    while i + 1 < signal.len() {
        let mut end = i;
        while end + 1 < signal.len() && signal[end + 1] <= signal[i] && signal[end + 1] >= signal[i] {
            end += 1;
        }
        let rises = signal[i - 1] < signal[i];
        let falls = end + 1 < signal.len() && signal[end + 1] < signal[i];
        if rises && falls && prominence_at(signal, i) >= prominence {
            found.push(usize::midpoint(i, end));
        }
        i = end + 1;
    }
    // The higher of two that stand too close stays; ties go to the earlier.
    let mut by_height = found.clone();
    by_height.sort_by(|&a, &b| signal[b].total_cmp(&signal[a]).then(a.cmp(&b)));
    let mut kept = std::collections::BTreeSet::new();
    for peak in by_height {
        let below = kept.range(..peak).next_back().is_none_or(|&other| (peak - other) as f32 >= separation);
        let above =
            kept.range(peak..).next().is_none_or(|&other: &usize| (other - peak) as f32 >= separation);
        if below && above {
            kept.insert(peak);
        }
    }
    kept.into_iter().collect()
}

/// How far a signal falls on both sides of a peak before it rises above it (the lesser of the two falls).
fn prominence_at(signal: &[f32], peak: usize) -> f32 {
    /// Looking no further keeps long takes linear; no stride spans this many frames.
    const REACH: usize = 4096;
    let height = signal[peak];
    let fall = |values: &mut dyn Iterator<Item = &f32>| {
        values
            .take(REACH)
            .take_while(|&&value| value <= height)
            .fold(0.0_f32, |fall, value| fall.max(height - value))
    };
    fall(&mut signal[..peak].iter().rev()).min(fall(&mut signal[peak + 1..].iter()))
}

/// The pose at a fractional frame, by Catmull-Rom splines through the frames; `poses` must not be empty.
pub(in crate::gait) fn pose_at(poses: &[Pose], frame: f32) -> Pose {
    let last = poses.len().saturating_sub(1);
    let i = frames(frame).min(last);
    let t = (frame - i as f32).clamp(0.0, 1.0);
    let [a, b, c, d] = [i.saturating_sub(1), i, (i + 1).min(last), (i + 2).min(last)].map(|i| &poses[i]);
    std::array::from_fn(|j| {
        let (a, b, c, d) = (a[j], b[j], c[j], d[j]);
        b + (c - a + (a * 2.0 - b * 5.0 + c * 4.0 - d + (b * 3.0 - c * 3.0 + d - a) * t) * t) * (t * 0.5)
    })
}

/// A positive number of frames, rounded down; 0 for what is not finite.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "`as` saturates, and NaN becomes 0: both are what is wanted here"
)]
pub(in crate::gait) fn frames(value: f32) -> usize {
    value.max(0.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(hz: f32, rate: f32, n: usize) -> Vec<f32> {
        (0..n).map(|i| (2.0 * PI * hz * i as f32 / rate).sin()).collect()
    }

    #[test]
    fn low_pass_keeps_slow_parts_in_place_and_halves_power_at_the_cutoff() {
        let amplitude = |hz: f32| {
            let filtered = low_pass(&sine(hz, 120.0, 1200), 120.0, 6.0);
            filtered[300..900].iter().copied().fold(0.0, f32::max)
        };
        assert!((amplitude(1.0) - 1.0).abs() < 0.01);
        assert!((amplitude(6.0) - 0.5_f32.sqrt()).abs() < 0.02, "{}", amplitude(6.0));
        assert!(amplitude(20.0) < 0.02);
        let slow = sine(1.0, 120.0, 1200);
        for (a, b) in slow.iter().zip(low_pass(&slow, 120.0, 6.0)) {
            assert!((a - b).abs() < 0.02);
        }
    }

    #[test]
    fn peaks_respect_prominence_separation_and_plateaus() {
        let signal = [0.0, 1.0, 0.9, 1.1, 0.0, 2.0, 2.0, 2.0, 0.0, 0.5, 0.0];
        assert_eq!(peaks(&signal, 1.0, 0.3), [3, 6, 9]);
        assert_eq!(peaks(&signal, 1.0, 0.05), [1, 3, 6, 9]);
        assert_eq!(peaks(&signal, 4.0, 0.3), [6]);
        assert!(peaks(&[], 1.0, 0.0).is_empty() && peaks(&[1.0], 1.0, 0.0).is_empty());
    }
}
