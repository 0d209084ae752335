//! What is known of a device by its driver alone: Vulkan has no query for it.

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

/// Whether the GPU of this driver and maker draws an image tile by tile.
pub(super) fn is_tiler(driver: vk::DriverId, vendor: u32) -> bool {
    TILERS.contains(&driver) || (driver == vk::DriverId::MOLTENVK && vendor == APPLE)
}

#[cfg(test)]
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
}
