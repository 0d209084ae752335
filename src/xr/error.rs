//! What can go wrong with the headset.

use std::env::consts::OS;

/// The headset cannot be used, or not any more.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No OpenXR loader.
    #[error("no OpenXR loader found ({0})")]
    NoLoader(String),
    /// No runtime is installed or chosen.
    #[error("no OpenXR runtime is active ({0})")]
    NoRuntime(openxr::sys::Result),
    /// A runtime is installed but does not answer.
    #[error("the OpenXR runtime cannot be reached ({0}); its service is not running, or it does not answer")]
    NoService(openxr::sys::Result),
    /// A runtime is installed but did not return from a call.
    #[error("the OpenXR runtime does not answer; its service hangs")]
    Silent,
    /// The runtime lacks something that is needed.
    #[error("the OpenXR runtime {runtime} lacks {what}")]
    Lacks {
        /// Name of the runtime.
        runtime: String,
        /// What is missing.
        what: String,
    },
    /// No headset is connected.
    #[error("the OpenXR runtime {0} knows no headset")]
    NoHeadset(String),
    /// The session or the runtime went away.
    #[error("lost the headset: {0}")]
    Lost(Loss),
    /// A panel cannot be shown.
    #[error(transparent)]
    Panel(#[from] super::panel::PanelError),
    /// A call failed.
    #[error("{call} failed: {result}")]
    Call {
        /// The call.
        call: &'static str,
        /// Its result.
        result: openxr::sys::Result,
    },
    /// Vulkan failed.
    #[error(transparent)]
    Gpu(#[from] crate::gpu::Error),
    /// Drawing failed.
    #[error(transparent)]
    Render(#[from] crate::render::Error),
}

/// How a session was lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loss {
    /// The session is lost or will be; the runtime stays.
    Session,
    /// The runtime itself went away.
    Instance,
    /// An image of the swapchain did not come in time.
    Image,
}

impl std::fmt::Display for Loss {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Session => "the runtime ended the session",
            Self::Instance => "the runtime stopped",
            Self::Image => "the runtime kept an image for too long",
        })
    }
}

impl Error {
    /// What the user can do about it.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::NoLoader(_) => Some(loader_hint(OS)),
            Self::NoRuntime(_) => Some(runtime_hint(OS)),
            Self::NoService(_) => Some(service_hint(OS)),
            Self::Silent => Some("end the runtime's service and start it again"),
            Self::NoHeadset(_) => Some("connect the headset and wake it up, then try again"),
            _ => None,
        }
    }

    /// Whether trying again later may help.
    pub fn is_passing(&self) -> bool {
        matches!(self, Self::Lost(_) | Self::NoService(_) | Self::Silent | Self::NoHeadset(_))
    }
}

/// What to do without a loader on this system.
fn loader_hint(os: &str) -> &'static str {
    match os {
        "linux" => {
            "the loader is a package of its own, whatever the headset: Debian/Ubuntu: apt install libopenxr-loader1; \
             Fedora: dnf install openxr-libs; Arch: pacman -S openxr"
        }
        "windows" => "the loader is a part of this program: build it again, with CMake installed",
        _ => {
            "build the OpenXR loader (the OpenXR-SDK of Khronos) and put it where the system looks for libraries; \
             headsets are known to have runtimes on Linux and Windows"
        }
    }
}

/// What to do without a runtime on this system.
fn runtime_hint(os: &str) -> &'static str {
    match os {
        "windows" => {
            "install the headset's software (SteamVR, Meta Quest Link, Virtual Desktop, Varjo Base, PICO Connect) and \
             make it the active OpenXR runtime in its settings, or XR_RUNTIME_JSON names its manifest"
        }
        _ => {
            "start a runtime (SteamVR, WiVRn, Monado) and make it the active one, or XR_RUNTIME_JSON names its \
             manifest; Debian/Ubuntu: apt install libopenxr1-monado monado-service; without a headset: \
             scripts/setup --xr, and prefix commands with scripts/gpu-env"
        }
    }
}

/// What to do on this system with a runtime that does not answer.
fn service_hint(os: &str) -> &'static str {
    match os {
        "windows" => "start the headset's software first, then try again",
        _ => {
            "start the runtime first (Monado: monado-service, of the Debian package of that name), then try again"
        }
    }
}

/// An error of a call. A loss is one whatever the call.
pub(super) fn call(call: &'static str) -> impl FnOnce(openxr::sys::Result) -> Error {
    use openxr::sys::Result as R;
    move |result| match result {
        R::ERROR_INSTANCE_LOST => Error::Lost(Loss::Instance),
        R::ERROR_SESSION_LOST | R::SESSION_LOSS_PENDING => Error::Lost(Loss::Session),
        result => Error::Call { call, result },
    }
}

/// The outcome of a raw call. Success codes that mean a loss are errors.
pub(super) fn check(name: &'static str, result: openxr::sys::Result) -> Result<(), Error> {
    match result {
        openxr::sys::Result::TIMEOUT_EXPIRED => Err(Error::Lost(Loss::Image)),
        openxr::sys::Result::SESSION_LOSS_PENDING => Err(Error::Lost(Loss::Session)),
        result if result.into_raw() >= 0 => Ok(()),
        result => Err(call(name)(result)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hints_name_what_the_system_has() {
        for hint in [loader_hint, runtime_hint, service_hint] {
            assert!(!["apt ", "Debian", "monado"].iter().any(|word| hint("windows").contains(word)));
            assert_ne!(hint("linux"), hint("windows"));
        }
        assert!(loader_hint("linux").contains("libopenxr-loader1"));
        assert!(loader_hint("windows").contains("part of this program"));
        assert!(loader_hint("macos").contains("OpenXR-SDK"));
        assert!(runtime_hint("windows").contains("SteamVR"));
    }
}
