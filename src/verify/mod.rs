//! Every kernel three times: on the user's own device, by the lanes of the CPU, and by the plain twin. Without a device it is two.
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
//! let report = verify(Some(&device), &Options::quick(), &mut |_, _| ())?;
//! for kernel in report.kernels.iter().filter(|kernel| !kernel.pass) {
//!     println!("{}: {:?} wrong", kernel.name, kernel.differs);
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
mod crowd;
#[cfg(feature = "vulkan")]
mod device;
mod equivalence;
mod numerics;
pub mod report;
mod sides;

#[cfg(feature = "vulkan")]
#[doc(hidden)]
pub use device::{compare_dispatches, compare_tampered};
#[doc(hidden)]
pub use equivalence::{Comparison, Expected};
pub use report::{Options, Report, verify};
