//! Every kernel against its CPU twin, on the user's own device.

pub mod cases;
#[cfg(feature = "vulkan")]
mod equivalence;
#[cfg(feature = "vulkan")]
mod numerics;
#[cfg(feature = "vulkan")]
pub mod report;

#[cfg(feature = "vulkan")]
pub use equivalence::{Comparison, Expected, compare_dispatches, compare_tampered};
#[cfg(feature = "vulkan")]
pub use numerics::{CASES, Numerics, numerics};
#[cfg(feature = "vulkan")]
pub use report::{Options, Report, verify};
