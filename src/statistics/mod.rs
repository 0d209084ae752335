//! Statistics of studies with people: tests, effect sizes, agreement of raters and power.
//!
//! Every function is pure: plain slices in, numbers out. What draws at random takes a seed. Each statistic agrees with a
//! published implementation; `docs/statistics.md` names it and gives the largest difference measured.
//!
//! ```
//! use gaitway::statistics::{Adjustment, adjust, friedman, wilcoxon};
//!
//! # fn main() -> Result<(), gaitway::statistics::Error> {
//! // five people answer one question under three conditions, 1 to 7
//! let answers = [[2.0, 4.0, 6.0], [3.0, 3.0, 5.0], [1.0, 4.0, 4.0], [2.0, 5.0, 7.0], [4.0, 4.0, 5.0]];
//! let test = friedman::friedman(&answers)?;
//! println!("Q = {:.2}, W = {:.2}, exact p = {:.4}", test.chi_square, test.w, friedman::exact_p(&answers)?);
//!
//! let pairs = [[0, 1], [1, 2], [0, 2]].map(|[a, b]| answers.map(|row| row[b] - row[a]));
//! let mut p = Vec::new();
//! for differences in &pairs {
//!     p.push(wilcoxon::wilcoxon(differences, wilcoxon::Options::default())?.p);
//! }
//! println!("Holm: {:?}", adjust(&p, Adjustment::Holm)?);
//! # Ok(())
//! # }
//! ```
//!
//! | question | function |
//! | --- | --- |
//! | do conditions differ | [`friedman::friedman`], [`friedman::exact_p`] |
//! | which two | [`wilcoxon::wilcoxon`], [`wilcoxon::shift`], [`adjust()`] |
//! | are emotions identified | [`confusion::confusion`], [`confusion::accuracy_over_people`] |
//! | do raters agree | [`agreement::agreement`], [`icc::icc`], [`icc::cronbach`], [`kappa::kappa`] |
//! | does a label depend on its raters | [`stability::label_stability`] |
//! | how many people | [`power::friedman_power`], [`power::simulate`] |
//! | does the paper follow from its own numbers | [`paper::recompute`] |

mod adjust;
pub mod agreement;
pub mod confusion;
mod describe;
pub mod distribution;
mod error;
pub mod friedman;
pub mod icc;
mod interval;
pub mod kappa;
pub mod paper;
pub mod power;
mod ranks;
pub mod stability;
pub mod wilcoxon;

pub use adjust::{Adjustment, adjust};
pub use describe::{Description, describe, quantile};
pub use error::Error;
pub use interval::{binomial_test, share_interval, wilson_interval};
pub use ranks::{Ranks, ranks};

use serde::{Deserialize, Serialize};

/// The alternative to a null hypothesis about a centre or a share.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Alternative {
    /// It differs from the null value.
    #[default]
    TwoSided,
    /// It lies below the null value.
    Less,
    /// It lies above the null value.
    Greater,
}
