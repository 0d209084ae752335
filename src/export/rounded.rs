//! Numbers rounded to 1/1024: headings, velocities and feelings on their way into a Parquet file.

use rayon::prelude::*;

/// Steps to 1.
pub(super) const STEPS: f32 = 1024.0;
/// Most steps from zero that are kept as such.
const FARTHEST: f32 = 32_767.0;
/// Added to whole numbers this leaves them in the lower bits of the sum.
const WHOLE: f32 = 12_582_912.0; // 1.5 * 2^23
/// Numbers that a thread rounds at once.
const TOGETHER: usize = 1 << 15;

/// Numbers, rounded to the nearest multiple of 1 / [`STEPS`]; halves go to the even one.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Rounded {
    /// All are near zero: their numbers of steps.
    Near(Vec<i16>),
    /// Not all are.
    Far(Vec<f32>),
}

impl Default for Rounded {
    fn default() -> Self {
        Self::Near(Vec::new())
    }
}

impl Rounded {
    /// Takes numbers in place of its own, in memory that is there already.
    pub(super) fn take(&mut self, values: &[f32]) {
        let mut steps = match self {
            Self::Near(steps) => std::mem::take(steps),
            Self::Far(_) => Vec::new(),
        };
        steps.resize(values.len(), 0);
        let parts = values.par_chunks(TOGETHER).zip(steps.par_chunks_mut(TOGETHER));
        let is_near =
            parts.map(|(values, steps)| round_near(values, steps)).reduce(|| true, |all, one| all && one);
        *self = match is_near {
            true => Self::Near(steps),
            false => Self::Far(values.iter().map(|value| round(*value)).collect()),
        };
    }

    pub(super) fn is_near(&self) -> bool {
        matches!(self, Self::Near(_))
    }

    /// Keeps numbers as such, near or not.
    pub(super) fn make_far(&mut self) {
        if let Self::Near(steps) = self {
            *self = Self::Far(steps.iter().map(|step| of_steps(*step)).collect());
        }
    }

    /// Is empty, for numbers that are all near or not.
    pub(super) fn begin(&mut self, is_near: bool) {
        match self {
            Self::Near(steps) if is_near => steps.clear(),
            Self::Far(values) if !is_near => values.clear(),
            _ if is_near => *self = Self::Near(Vec::new()),
            _ => *self = Self::Far(Vec::new()),
        }
    }

    /// Steps by entries of so many numbers; none where not all are near.
    pub(super) fn near<const WIDTH: usize>(&self) -> &[[i16; WIDTH]] {
        match self {
            Self::Near(steps) => steps.as_chunks().0,
            Self::Far(_) => &[],
        }
    }

    /// Numbers by entries of so many; none where all are near.
    pub(super) fn far<const WIDTH: usize>(&self) -> &[[f32; WIDTH]] {
        match self {
            Self::Near(_) => &[],
            Self::Far(values) => values.as_chunks().0,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        match self {
            Self::Near(steps) => steps.is_empty(),
            Self::Far(values) => values.is_empty(),
        }
    }

    pub(super) fn clear(&mut self) {
        match self {
            Self::Near(steps) => steps.clear(),
            Self::Far(values) => values.clear(),
        }
    }
}

/// The number of so many steps.
pub(super) fn of_steps(steps: i16) -> f32 {
    f32::from(steps) / STEPS
}

/// Numbers of steps, and whether all are near zero: else the others are wrong. Without an early end, so that the compiler makes
/// vectors of it.
fn round_near(values: &[f32], steps: &mut [i16]) -> bool {
    let mut is_near = true;
    for (value, step) in values.iter().zip(steps) {
        is_near &= value.abs() <= FARTHEST / STEPS;
        // A sum of this size has no fraction, so adding rounds, in an instruction. The function of the library is a call.
        let [low, high, ..] = (value * STEPS + WHOLE).to_bits().to_le_bytes();
        *step = i16::from_le_bytes([low, high]);
    }
    is_near
}

/// Any number, rounded; without negative zeros.
fn round(value: f32) -> f32 {
    (value * STEPS).round_ties_even() / STEPS + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_to_the_nearest_of_a_thousand_and_twenty_four_parts() {
        for part in 0..40_000 {
            let value = (part as f32 - 20_000.0) * 0.000_123_4 * (1.0 + part as f32);
            let mut rounded = Rounded::default();
            rounded.take(&[value]);
            let is_near = value.abs() <= 31.999;
            assert_eq!(rounded.is_near(), is_near, "{value}");
            rounded.make_far();
            let found = rounded.far::<1>()[0][0];
            assert_eq!(
                found.to_bits(),
                ((value * STEPS).round_ties_even() / STEPS + 0.0).to_bits(),
                "{value}"
            );
        }
        let mut halves = Rounded::default();
        halves.take(&[0.5, 1.5, -0.5, 2.5].map(|half: f32| half / STEPS));
        assert_eq!(halves, Rounded::Near(vec![0, 2, 0, 2]));
    }

    #[test]
    fn one_number_that_is_far_or_none_keeps_all_as_they_are() {
        for odd in [32.0, -40.5, f32::INFINITY, f32::NAN] {
            let mut rounded = Rounded::default();
            let mut values = vec![0.25; 3 * TOGETHER];
            values[2 * TOGETHER] = odd;
            rounded.take(&values);
            assert!(!rounded.is_near());
            let far = rounded.far::<1>();
            assert_eq!(far.len(), values.len());
            assert_eq!(far[2 * TOGETHER][0].to_bits(), odd.to_bits());
            assert_eq!(far[0][0].to_bits(), 0.25_f32.to_bits());
            rounded.take(&values[..TOGETHER]);
            assert_eq!(rounded, Rounded::Near(vec![256; TOGETHER]));
        }
    }
}
