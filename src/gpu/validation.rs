//! The validation layer: how much it checks, and its voice.

use super::Error;
use ash::vk;
use std::ffi::{CStr, c_void};
use std::sync::{Mutex, PoisonError};

/// The layer's name.
pub(crate) const LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// How much the validation layer checks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Validation {
    /// No layer.
    #[default]
    Off,
    /// Core checks.
    Core,
    /// Core and synchronization, with the heuristic that sees missing barriers between dispatches.
    Sync,
    /// The same and checks inside shaders.
    GpuAssisted,
}

impl Validation {
    /// What they are called in `GAITWAY_VALIDATION`.
    pub const NAMES: [&str; 4] = ["off", "core", "sync", "gpu-av"];

    /// From the environment variable `GAITWAY_VALIDATION`: one of [`Self::NAMES`]; off where it is not set or empty.
    ///
    /// # Errors
    /// [`Error::UnknownValidation`].
    pub fn from_environment() -> Result<Self, Error> {
        match std::env::var_os("GAITWAY_VALIDATION") {
            None => Ok(Self::Off),
            Some(name) => Self::named(&name.to_string_lossy()),
        }
    }

    fn named(name: &str) -> Result<Self, Error> {
        match name {
            "" | "off" => Ok(Self::Off),
            "core" => Ok(Self::Core),
            "sync" => Ok(Self::Sync),
            "gpu-av" => Ok(Self::GpuAssisted),
            _ => Err(Error::UnknownValidation(name.to_owned())),
        }
    }
}

/// Messages of the validation layer since the program began. They outlive every device, since leaks are reported while a
/// device is destroyed.
static MESSAGES: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Messages of the validation layer since the program began.
pub fn validation_messages() -> Vec<String> {
    MESSAGES.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

extern "system" fn on_message(
    severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    _user: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the layer passes a pointer to callback data that is valid during this call, with C strings or null.
    let (id, text) = unsafe {
        let data = &*data;
        (data.message_id_name_as_c_str().unwrap_or(c""), data.message_as_c_str().unwrap_or(c""))
    };
    let (id, text) = (id.to_string_lossy(), text.to_string_lossy());
    // GPU-assisted validation warns about its own settings
    let own = ["VALIDATION-SETTINGS", "WARNING-GPU-Assisted-Validation", "WARNING-Setting-Limit-Adjusted"];
    if !own.iter().any(|name| id.contains(name)) {
        MESSAGES.lock().unwrap_or_else(PoisonError::into_inner).push(format!("{severity:?} {id}: {text}"));
    }
    vk::FALSE
}

pub(crate) fn messenger_info() -> vk::DebugUtilsMessengerCreateInfoEXT<'static> {
    // not INFO: with it the loader itself writes some sixty lines
    vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(
            vk::DebugUtilsMessageSeverityFlagsEXT::ERROR | vk::DebugUtilsMessageSeverityFlagsEXT::WARNING,
        )
        .message_type(
            vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION | vk::DebugUtilsMessageTypeFlagsEXT::PERFORMANCE,
        )
        .pfn_user_callback(Some(on_message))
}

pub(crate) fn bool_setting<'a>(name: &'a CStr, value: &'a [u8; 4]) -> vk::LayerSettingEXT<'a> {
    vk::LayerSettingEXT::default()
        .layer_name(LAYER)
        .setting_name(name)
        .ty(vk::LayerSettingTypeEXT::BOOL32)
        .values(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_layer_says_of_its_own_settings_is_not_kept() {
        let before = validation_messages();
        // as layers say it: with strings, and with none
        for text in [Some(c"a limit was adjusted"), None] {
            let mut data = vk::DebugUtilsMessengerCallbackDataEXT::default()
                .message_id_name(c"WARNING-Setting-Limit-Adjusted");
            if let Some(text) = text {
                data = data.message(text);
            }
            let severity = vk::DebugUtilsMessageSeverityFlagsEXT::WARNING;
            let kind = vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION;
            assert_eq!(on_message(severity, kind, &raw const data, std::ptr::null_mut()), vk::FALSE);
        }
        assert_eq!(validation_messages(), before);
    }
}
