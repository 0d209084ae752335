//! Every kernel against its CPU twin, on the user's own device.
//!
//! ```no_run
//! # #[cfg(not(feature = "vulkan"))]
//! # fn main() {}
//! # #[cfg(feature = "vulkan")]
//! use gaitway::gpu::{Device, Validation};
//! # #[cfg(feature = "vulkan")]
//! use gaitway::verify::{Options, verify};
//!
//! # #[cfg(feature = "vulkan")]
//! # fn main() -> gaitway::Result<()> {
//! let device = Device::open(None, Validation::Off)?;
//! let report = verify(&device, &Options::quick(), &mut |_, _| ())?;
//! println!("{}: {}", report.device, report.arithmetic.taken);
//! for kernel in report.kernels.iter().filter(|kernel| !kernel.pass) {
//!     println!("{} differs by {:e}", kernel.name, kernel.max_error);
//! }
//! # Ok(())
//! # }
//! ```

#[doc(hidden)]
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "bits of floats"
)]
pub mod careful;
#[doc(hidden)]
pub mod cases;
#[cfg(feature = "vulkan")]
mod equivalence;
#[cfg(feature = "vulkan")]
mod numerics;
#[cfg(feature = "vulkan")]
pub mod report;

#[cfg(feature = "vulkan")]
#[doc(hidden)]
pub use equivalence::{Comparison, Expected, compare_dispatches, compare_tampered};
#[cfg(feature = "vulkan")]
pub use report::{Options, Report, verify};
