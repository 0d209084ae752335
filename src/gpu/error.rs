//! What can go wrong with Vulkan.

use super::arithmetic;
use super::drivers::Draws;
use super::validation::Validation;
use super::wanted::Wanted;

/// Vulkan failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no Vulkan loader on this machine.
    #[error("no Vulkan loader found ({0})")]
    NoLoader(String),
    /// There is a loader but no driver.
    #[error("no Vulkan driver found ({call}: {result})")]
    NoDriver {
        /// The call that failed.
        call: &'static str,
        /// Its result.
        result: ash::vk::Result,
    },
    /// This process may not have as much memory as drivers need.
    #[error("no Vulkan driver is tried with {mib} MiB of address space; it takes {least}")]
    AddressSpace {
        /// What it may have.
        mib: u64,
        /// What it takes.
        least: u64,
    },
    /// `GAITWAY_VALIDATION` has a value that is none.
    #[error("GAITWAY_VALIDATION={0}: must be {names}", names = Validation::NAMES.join(", "))]
    UnknownValidation(String),
    /// `GAITWAY_ARITHMETIC` has a value that is none.
    #[error("{name}={0}: must be auto, native or careful", name = arithmetic::Wanted::VARIABLE)]
    UnknownArithmetic(String),
    /// `GAITWAY_DRAWS` has a value that is none.
    #[error("{name}={0}: must be auto, indirect or direct", name = Draws::VARIABLE)]
    UnknownDraws(String),
    /// `GAITWAY_WRONG_ARITHMETIC`, which is for tests, has a value that is none.
    #[error("{name}={0}: must be by-1, by-3, slip, zeros or flush", name = arithmetic::Fault::VARIABLE)]
    UnknownFault(String),
    /// The validation layer was asked for but is not installed.
    #[error("the Vulkan validation layer (VK_LAYER_KHRONOS_validation) is not installed")]
    NoValidationLayer,
    /// No device fits.
    #[error("{wanted}; found: {found}")]
    NoDevice {
        /// The device that was asked for.
        wanted: Wanted,
        /// The devices of the machine, with the reason why each is not usable.
        found: String,
    },
    /// A GPU was asked for, and the best device of the machine is software.
    #[error("{name} is software, no faster than the CPU")]
    OnlySoftware {
        /// The device.
        name: String,
    },
    /// A call failed.
    #[error("{call} failed: {result}")]
    Call {
        /// The call.
        call: &'static str,
        /// Its result.
        result: ash::vk::Result,
    },
    /// The device was lost while dispatches ran.
    #[error("the device was lost; the last dispatches submitted were {dispatches}")]
    DeviceLost {
        /// The dispatches, first to last.
        dispatches: String,
    },
    /// An allocation failed.
    #[error("cannot allocate {bytes} bytes for {name:?}: {reason}")]
    Memory {
        /// Buffer or image.
        name: String,
        /// Size.
        bytes: u64,
        /// Why.
        reason: String,
    },
    /// The library through which instance and device are made has refused.
    #[error("{call} failed: {result}")]
    Maker {
        /// The call.
        call: &'static str,
        /// Its result.
        result: String,
    },
    /// A buffer is larger than the device can bind.
    #[error("buffer {name:?} needs {bytes} bytes, but this device binds at most {limit}: use fewer agents")]
    TooLarge {
        /// Buffer.
        name: &'static str,
        /// Size.
        bytes: u64,
        /// The device's `maxStorageBufferRange` or `maxUniformBufferRange`.
        limit: u64,
    },
    /// Contents do not fit a buffer: they are longer than it. Contents of a uniform may also exceed 65,536 bytes or be no
    /// multiple of four.
    #[error("{bytes} bytes cannot be copied: buffer {name:?} has {size}")]
    Contents {
        /// Buffer.
        name: &'static str,
        /// Bytes to copy.
        bytes: u64,
        /// Bytes of the buffer.
        size: u64,
    },
    /// Group counts of a dispatch are to come from where none are: a buffer that no kernel of the engine binds, or beyond its end.
    #[error("{kernel}: no group counts at element {element} of buffer {buffer:?}")]
    Arguments {
        /// Kernel of the dispatch.
        kernel: &'static str,
        /// Buffer.
        buffer: &'static str,
        /// First of the three counts.
        element: u32,
    },
    /// A shader that was to be reloaded does not compile or has other bindings than the program was built with.
    #[cfg(feature = "hot-reload")]
    #[error(transparent)]
    Shader(#[from] crate::kernels::compile::fault::Error),
    /// An operation of a kernel cannot be replaced.
    #[error("the arithmetic of a kernel cannot be replaced: {0}")]
    Operations(#[from] crate::kernels::link::Error),
    /// A dispatch needs a kernel that the engine was not built with.
    #[error("kernel {0} is not part of this engine")]
    NoKernel(&'static str),
}

impl Error {
    /// Whether the device is lost: a new one may work.
    pub fn is_device_lost(&self) -> bool {
        let lost = ash::vk::Result::ERROR_DEVICE_LOST;
        matches!(self, Self::DeviceLost { .. })
            || matches!(self, Self::Call { result, .. } if *result == lost)
    }

    /// What the user can do about it.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::NoLoader(_) | Self::NoDriver { .. } => Some(
                "Debian/Ubuntu: apt install libvulkan1 mesa-vulkan-drivers; Fedora: dnf install vulkan-loader \
                 mesa-vulkan-drivers; Arch: pacman -S vulkan-icd-loader vulkan-swrast; or run scripts/setup and \
                 prefix the command with scripts/gpu-env",
            ),
            Self::NoValidationLayer => {
                Some("Debian/Ubuntu: apt install vulkan-validationlayers; or run through scripts/gpu-env")
            }
            Self::NoDevice { wanted: Wanted::Best, .. } => Some("`gaitway devices` says what is missing"),
            Self::NoDevice { .. } => {
                Some("name another with --device or GAITWAY_DEVICE, or none for the best")
            }
            Self::OnlySoftware { .. } => Some("--backend vulkan or --device takes it all the same"),
            Self::DeviceLost { .. } | Self::Call { result: ash::vk::Result::ERROR_DEVICE_LOST, .. } => {
                Some("the driver stopped or was reset; the system's log says more")
            }
            Self::AddressSpace { .. } => Some("raise the limit (ulimit -v)"),
            Self::Memory { .. } | Self::TooLarge { .. } => Some("ask for fewer agents or smaller images"),
            _ => None,
        }
    }
}

pub(crate) fn call(call: &'static str) -> impl FnOnce(ash::vk::Result) -> Error {
    move |result| Error::Call { call, result }
}
