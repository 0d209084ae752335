//! The Vulkan device that tests run on. Without Vulkan on the machine a test says so and passes; with
//! `GAITWAY_REQUIRE_GPU=1` it fails. Any other error is a failure in either case.
#![allow(dead_code, reason = "shared by many test programs, of which few need all of it")]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "for tests: a failure is a panic"
)]

/// Whether a test fails where what it needs is absent: `GAITWAY_REQUIRE_...=1` demands it.
pub(crate) fn is_demanded(variable: &str) -> bool {
    std::env::var(variable).as_deref() == Ok("1")
}

/// Whether a machine without Vulkan fails the tests.
pub(crate) fn is_required() -> bool {
    is_demanded("GAITWAY_REQUIRE_GPU")
}

/// What was made on a device; none where there is no Vulkan and none is required.
pub(crate) fn on_device<T>(made: Result<T, gaitway::Error>) -> Option<T> {
    match made {
        Ok(made) => Some(made),
        Err(error) if is_absence(&error) && !is_required() => {
            println!("skipped: no Vulkan ({error})");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// Whether an error says that this machine, or this build, has no Vulkan.
fn is_absence(error: &gaitway::Error) -> bool {
    #[cfg(feature = "vulkan")]
    if let gaitway::Error::Gpu(error) | gaitway::Error::Render(gaitway::render::Error::Gpu(error)) = error {
        use gaitway::gpu::Error::{NoDevice, NoDriver, NoLoader};
        return matches!(error, NoLoader(_) | NoDriver { .. } | NoDevice { .. });
    }
    matches!(error, gaitway::Error::Sim(gaitway::sim::Error::NoVulkan))
}

/// A device with the validation layer that `GAITWAY_VALIDATION` asks for.
#[cfg(feature = "vulkan")]
pub(crate) fn device() -> Option<std::sync::Arc<gaitway::gpu::Device>> {
    let validation = gaitway::gpu::Validation::from_environment().unwrap();
    on_device(gaitway::gpu::Device::open(None, validation).map_err(gaitway::Error::from))
}

/// Fails if the validation layer has said anything since the program began. Says so where the layer is off and nothing is
/// asserted.
#[cfg(feature = "vulkan")]
pub(crate) fn assert_silent() {
    use gaitway::gpu::{Validation, validation_messages};
    if Validation::from_environment().unwrap() == Validation::Off {
        return println!("not asserted: the validation layer is off (GAITWAY_VALIDATION)");
    }
    let messages = validation_messages();
    assert!(messages.is_empty(), "{messages:#?}");
}

#[cfg(feature = "vulkan")]
#[test]
fn only_a_machine_without_vulkan_is_a_reason_to_skip() {
    use gaitway::gpu::Error;
    let absence = Error::NoLoader("libvulkan.so.1".to_owned());
    assert!(is_absence(&absence.into()) && is_absence(&gaitway::sim::Error::NoVulkan.into()));
    let lost = Error::DeviceLost { dispatches: "integrate".to_owned() };
    let faults: [gaitway::Error; 3] =
        [lost.into(), Error::NoValidationLayer.into(), gaitway::sim::Error::NoGaits.into()];
    for fault in faults {
        assert!(!is_absence(&fault), "{fault}");
    }
}
