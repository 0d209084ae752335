//! What is known of a device by its driver alone: Vulkan has no query for it.

use super::Error;
use ash::vk;

/// Drivers of GPUs that draw an image tile by tile, each in memory of their own. Whatever reads an image before all of it is
/// drawn has every tile written out and read in again, which on a phone takes longer than what it saves.
const TILERS: [vk::DriverId; 10] = [
    vk::DriverId::QUALCOMM_PROPRIETARY,
    vk::DriverId::MESA_TURNIP,
    vk::DriverId::ARM_PROPRIETARY,
    vk::DriverId::MESA_PANVK,
    vk::DriverId::IMAGINATION_PROPRIETARY,
    vk::DriverId::IMAGINATION_OPEN_SOURCE_MESA,
    vk::DriverId::BROADCOM_PROPRIETARY,
    vk::DriverId::MESA_V3DV,
    HONEYKRISP,
    KOSMICKRISP,
];
/// `VK_DRIVER_ID_MESA_HONEYKRISP`, Apple's GPUs on Linux; `ash` knows it by its first name.
const HONEYKRISP: vk::DriverId = vk::DriverId::MESA_AGXV;
/// `VK_DRIVER_ID_MESA_KOSMICKRISP`, Apple's GPUs on macOS, which is younger than `ash`.
const KOSMICKRISP: vk::DriverId = vk::DriverId::from_raw(28);
/// Apple's number as a maker of GPUs. `MoltenVK` also serves GPUs of Intel and AMD, which are no tilers.
const APPLE: u32 = 0x106b;

/// Drivers whose indexed indirect draws draw nothing and report nothing: on Quest 2 and 3 direct draws of the same arguments
/// are seen (gfx-rs/wgpu, issue 8801).
const DRAW_NOTHING_INDIRECTLY: [vk::DriverId; 1] = [vk::DriverId::QUALCOMM_PROPRIETARY];

/// Whether the GPU of this driver and maker draws an image tile by tile.
pub(super) fn is_tiler(driver: vk::DriverId, vendor: u32) -> bool {
    TILERS.contains(&driver) || (driver == vk::DriverId::MOLTENVK && vendor == APPLE)
}

/// Whether indexed indirect draws of this driver draw something, as far as is known.
pub(super) fn draws_indirectly(driver: vk::DriverId) -> bool {
    !DRAW_NOTHING_INDIRECTLY.contains(&driver)
}

/// Where the arguments of a crowd's draws come from. The images are the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Draws {
    /// Indirect, but direct where the driver is known to draw nothing indirectly.
    #[default]
    Auto,
    /// From the device: the host waits for nothing.
    Indirect,
    /// From the host, which reads what the kernels wrote for this frame: it waits for them in each frame.
    Direct,
}

impl Draws {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Auto, Self::Indirect, Self::Direct];
    /// The environment variable that says it where no setting does.
    pub const VARIABLE: &str = "GAITWAY_DRAWS";

    /// What it is called.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Indirect => "indirect",
            Self::Direct => "direct",
        }
    }

    /// What the environment variable [`Self::VARIABLE`] says; `Auto` without it.
    ///
    /// # Errors
    /// [`Error::UnknownDraws`].
    pub fn of_process() -> Result<Self, Error> {
        let name = std::env::var_os(Self::VARIABLE).unwrap_or_default();
        Self::parse(&name.to_string_lossy())
    }

    fn parse(name: &str) -> Result<Self, Error> {
        let found = Self::ALL.into_iter().find(|draws| draws.name() == name);
        if name.is_empty() { Ok(Self::Auto) } else { found.ok_or(Error::UnknownDraws(name.to_owned())) }
    }

    /// This, or what `otherwise` says where this is left open.
    pub(crate) fn or(self, otherwise: Self) -> Self {
        if self == Self::Auto { otherwise } else { self }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;

    #[test]
    fn phones_and_apples_gpus_are_tilers_and_cards_are_not() {
        // numbers of the registry, whatever `ash` calls them
        for driver in [7, 8, 9, 12, 18, 19, 20, 25, 26, 28] {
            assert!(is_tiler(vk::DriverId::from_raw(driver), 0), "{driver}");
        }
        for driver in [0, 1, 2, 3, 4, 5, 6, 10, 13, 14, 21, 22, 23, 24, 27] {
            assert!(!is_tiler(vk::DriverId::from_raw(driver), 0x8086), "{driver}");
        }
        assert!(is_tiler(vk::DriverId::MOLTENVK, APPLE));
        assert!(!is_tiler(vk::DriverId::NVIDIA_PROPRIETARY, APPLE));
    }

    #[test]
    fn only_qualcomms_own_driver_is_drawn_with_directly() {
        let directly = (0..40).map(vk::DriverId::from_raw).filter(|driver| !draws_indirectly(*driver));
        assert_eq!(directly.collect::<Vec<_>>(), [vk::DriverId::QUALCOMM_PROPRIETARY]);
    }

    #[test]
    fn a_setting_goes_before_the_environment_and_that_before_the_driver() {
        use Draws::{Auto, Direct, Indirect};
        assert_eq!(["", "auto", "direct"].map(|name| Draws::parse(name).unwrap()), [Auto, Auto, Direct]);
        assert_eq!(Indirect.or(Direct.or(Indirect)), Indirect);
        assert_eq!(Auto.or(Direct.or(Indirect)), Direct);
        assert_eq!(Auto.or(Auto.or(Direct)), Direct);
        let error = Draws::parse("Direct").unwrap_err().to_string();
        assert_eq!(error, "GAITWAY_DRAWS=Direct: must be auto, indirect or direct");
    }
}
