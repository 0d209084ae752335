//! What this machine has for a headset, and what is missing: for `gaitway devices`.

use super::Error;
use super::runtime::{Runtime, RuntimeInfo};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

/// Where loaders look for the active runtime's manifest, below `$XDG_CONFIG_HOME` or one of these.
const ACTIVE: &str = "openxr/1/active_runtime.json";
const SYSTEM: [&str; 3] = ["/etc/xdg", "/etc", "/usr/local/etc"];

/// The parts that were found, from the loader up. Nothing is known of the parts after the first missing one.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct Survey {
    /// Whether there is an OpenXR loader.
    pub loader: bool,
    /// Manifest of the active runtime, where it is found without loading the runtime.
    pub manifest: Option<PathBuf>,
    /// Whether the runtime could be loaded.
    pub installed: bool,
    /// Whether the runtime, or its service, answers.
    pub answers: bool,
    /// The runtime and its headset; none unless both are there.
    pub runtime: Option<RuntimeInfo>,
    /// What is missing for a headset; none if nothing is.
    pub missing: Option<String>,
    /// What the user can do about it.
    pub hint: Option<String>,
}

/// Looks for loader, runtime, service and headset. Does not wait longer than `patience` for a runtime that hangs.
pub fn survey(patience: Duration) -> Survey {
    let (sender, receiver) = mpsc::channel();
    // a call into a runtime whose service hangs never returns: then the thread is left behind
    let looks = thread::Builder::new().name("openxr".to_owned()).spawn(move || {
        let _ = sender.send(Runtime::open().map(|runtime| runtime.info().clone()));
    });
    let found = match looks {
        Ok(_) => receiver.recv_timeout(patience).unwrap_or(Err(Error::Silent)),
        Err(error) => Err(Error::NoLoader(error.to_string())),
    };
    Survey { manifest: manifest(), ..Survey::of(found) }
}

impl Survey {
    fn of(found: Result<RuntimeInfo, Error>) -> Self {
        // how far it got before the first thing that is missing
        let reached = match &found {
            Err(Error::NoLoader(_)) => 0,
            Err(Error::NoRuntime(_)) => 1,
            Err(Error::NoService(_) | Error::Silent) => 2,
            _ => 3,
        };
        Self {
            loader: reached > 0,
            installed: reached > 1,
            answers: reached > 2,
            missing: found.as_ref().err().map(ToString::to_string),
            hint: found.as_ref().err().and_then(Error::hint).map(str::to_owned),
            runtime: found.ok(),
            manifest: None,
        }
    }
}

/// The manifest that the loader takes: `XR_RUNTIME_JSON`, or the active one of the user or the system.
fn manifest() -> Option<PathBuf> {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    if let Some(path) = set("XR_RUNTIME_JSON") {
        return Some(path);
    }
    let user = set("XDG_CONFIG_HOME").or_else(|| set("HOME").map(|home| home.join(".config")));
    let folders = user.into_iter().chain(SYSTEM.map(|folder| Path::new(folder).to_owned()));
    folders.map(|folder| folder.join(ACTIVE)).find(|path| path.exists())
}

#[cfg(test)]
mod tests {
    use super::*;
    use openxr::sys::Result as R;

    #[test]
    fn a_survey_shows_how_far_it_got() {
        let reached = |error| {
            let survey = Survey::of(Err(error));
            assert!(survey.missing.is_some() && survey.runtime.is_none());
            [survey.loader, survey.installed, survey.answers]
        };
        assert_eq!(reached(Error::NoLoader(String::new())), [false; 3]);
        assert_eq!(reached(Error::NoRuntime(R::ERROR_RUNTIME_UNAVAILABLE)), [true, false, false]);
        assert_eq!(reached(Error::NoService(R::ERROR_RUNTIME_FAILURE)), [true, true, false]);
        assert_eq!(reached(Error::Silent), [true, true, false]);
        assert_eq!(reached(Error::NoHeadset("Monado".to_owned())), [true; 3]);
    }
}
