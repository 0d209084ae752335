//! p values of several tests together.
//!
//! Based on: Bonferroni (Dunn 1961); Holm 1979, "A simple sequentially rejective multiple test procedure", Scandinavian
//! Journal of Statistics 6; Benjamini and Hochberg 1995, "Controlling the false discovery rate", JRSS B 57.

use super::describe::number;
use super::error::Error;
use serde::{Deserialize, Serialize};

/// How p values of several tests are adjusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Adjustment {
    /// Times the number of tests.
    Bonferroni,
    /// Bonferroni step down; the chance of any false positive stays below the level.
    Holm,
    /// Step up; the expected share of false positives among positives stays below the level.
    BenjaminiHochberg,
}

/// Adjusted p values, at most 1, in the order given. A test is significant where its adjusted p is at most the level.
///
/// # Errors
/// A p outside [0, 1].
pub fn adjust(p: &[f64], adjustment: Adjustment) -> Result<Vec<f64>, Error> {
    if let Some(&value) = p.iter().find(|value| !(0.0..=1.0).contains(*value)) {
        return Err(Error::Range { what: "p", value, range: "[0, 1]" });
    }
    let count = number(p.len());
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|&a, &b| p[a].total_cmp(&p[b]));
    let mut adjusted = vec![1.0; p.len()];
    match adjustment {
        Adjustment::Bonferroni => {
            for (out, value) in adjusted.iter_mut().zip(p) {
                *out = (value * count).min(1.0);
            }
        }
        Adjustment::Holm => {
            let mut greatest: f64 = 0.0;
            for (smaller, &i) in order.iter().enumerate() {
                greatest = greatest.max(p[i] * (count - number(smaller)));
                adjusted[i] = greatest.min(1.0);
            }
        }
        Adjustment::BenjaminiHochberg => {
            let mut least: f64 = 1.0;
            for (smaller, &i) in order.iter().enumerate().rev() {
                least = least.min(p[i] * count / number(smaller + 1));
                adjusted[i] = least;
            }
        }
    }
    Ok(adjusted)
}
