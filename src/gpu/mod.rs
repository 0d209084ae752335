//! Vulkan: devices, buffers, kernels. Knows nothing of gaits or emotions.
//!
//! [`Device`] is a Vulkan device with its queue and allocator. [`Engine`] has one Vulkan buffer per
//! [`BufferId`](crate::kernels::BufferId) and one pipeline per phase of a kernel, and runs lists of dispatches. [`plan`]
//! places the barriers from what the kernels read and write.
//!
//! ```no_run
//! use gaitway::gpu::{self, Device, Validation};
//!
//! # fn main() -> gaitway::Result<()> {
//! for device in gpu::list()? {
//!     println!("{}: {} ({})", device.index, device.name, device.unusable.as_deref().unwrap_or("usable"));
//! }
//! let device = Device::open(None, Validation::from_environment()?)?; // the best one, or GAITWAY_DEVICE
//! println!("{}", device.describe());
//! # Ok(())
//! # }
//! ```

pub mod arithmetic;
mod buffer;
mod cache;
mod device;
mod drivers;
mod engine;
mod error;
#[cfg(test)]
#[path = "../../tests/common/gpu.rs"]
pub(crate) mod for_tests;
pub(crate) mod instance;
mod open;
mod pipeline;
pub mod plan;
mod probe;
mod validation;
mod wanted;

/// Frames that may be under way at a time: the device draws one while the host records the next.
pub(crate) const FRAMES_IN_FLIGHT: usize = 2;

pub use buffer::{Buffer, Memory};
pub use cache::CACHE_VARIABLE;
pub use device::Device;
pub use drivers::Draws;
pub(crate) use engine::ticks;
pub use engine::{DispatchTime, Engine};
pub(crate) use engine::{Part, Together};
pub use error::Error;
pub(crate) use error::call;
pub use instance::{DeviceInfo, DeviceKind, list};
pub use open::Priority;
pub use probe::Probe;
pub use validation::{Validation, validation_messages};
pub use wanted::{DEVICE_VARIABLE, Wanted};
