//! Features to [-1, 1] by the smallest and largest value of each (S-13).

use serde::{Deserialize, Serialize};

/// Smallest and largest value of each feature of a set of points.
///
/// Fitted on the training gaits alone by default: fitted on all, the held-out gaits would have a say in what is
/// learned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scaling {
    low: Vec<f64>,
    high: Vec<f64>,
}

impl Scaling {
    /// The ranges of these points, all of one length; of none, no feature.
    pub fn fit<'a>(points: impl IntoIterator<Item = &'a [f64]>) -> Self {
        let mut scaling = Self { low: Vec::new(), high: Vec::new() };
        for (number, point) in points.into_iter().enumerate() {
            if number == 0 {
                scaling = Self { low: point.to_vec(), high: point.to_vec() };
            }
            for ((low, high), value) in scaling.low.iter_mut().zip(&mut scaling.high).zip(point) {
                *low = low.min(*value);
                *high = high.max(*value);
            }
        }
        scaling
    }

    /// Number of features.
    pub fn len(&self) -> usize {
        self.low.len()
    }

    /// Whether it knows no feature.
    pub fn is_empty(&self) -> bool {
        self.low.is_empty()
    }

    /// `(x - (M + m) / 2) / ((M - m) / 2)`, 0 where M = m. Points outside the fitted ranges leave [-1, 1].
    pub fn apply(&self, point: &[f64]) -> Vec<f64> {
        let scaled = |((value, low), high): ((&f64, &f64), &f64)| {
            let half = (high - low) / 2.0;
            if half > 0.0 { (value - f64::midpoint(*high, *low)) / half } else { 0.0 }
        };
        point.iter().zip(&self.low).zip(&self.high).map(scaled).collect()
    }

    /// Says what is wrong with ranges that were read from a file.
    ///
    /// # Errors
    /// A message with what was found and expected.
    pub(crate) fn validate(&self, features: usize) -> Result<(), String> {
        let (low, high) = (self.low.len(), self.high.len());
        if low != features || high != features {
            return Err(format!("the scaling has {low} and {high} numbers; expected {features} of each"));
        }
        match self
            .low
            .iter()
            .zip(&self.high)
            .position(|(low, high)| !(low <= high && (high - low).is_finite()))
        {
            Some(i) => Err(format!(
                "feature {} is scaled from {} to {}; the range must be finite and ascending",
                i + 1,
                self.low[i],
                self.high[i]
            )),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_becomes_minus_one_the_largest_one_and_a_constant_zero() {
        let points = [[1.0, 5.0, 7.0], [3.0, 5.0, -1.0], [2.0, 5.0, 0.0]];
        let scaling = Scaling::fit(points.iter().map(<[f64; 3]>::as_slice));
        let scaled: Vec<Vec<f64>> = points.iter().map(|point| scaling.apply(point)).collect();
        let expected = [[-1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [0.0, 0.0, -0.75]];
        for (scaled, expected) in scaled.iter().flatten().zip(expected.iter().flatten()) {
            assert!((scaled - expected).abs() < 1e-15, "{scaled} {expected}");
        }
        assert!((scaling.apply(&[5.0, 9.0, 7.0])[0] - 3.0).abs() < 1e-15, "outside the range");
    }

    #[test]
    fn ranges_of_a_damaged_file_are_refused() {
        let scaling = Scaling { low: vec![0.0, 2.0], high: vec![1.0, 1.0] };
        assert!(scaling.validate(2).unwrap_err().contains("feature 2"));
        assert!(scaling.validate(3).unwrap_err().contains("expected 3"));
    }
}
