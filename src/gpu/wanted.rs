//! Which of the machine's devices is meant.

use super::instance::{DeviceInfo, DeviceKind};
use std::fmt;

/// The environment variable that names a device where no option does.
pub const DEVICE_VARIABLE: &str = "GAITWAY_DEVICE";

/// The device that is wanted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Wanted {
    /// The best one: discrete, integrated, virtual, software.
    Best,
    /// The best one that is no software.
    Hardware,
    /// The one of this number in the loader's list ([`super::list`]), which `gaitway devices` prints.
    Number(usize),
    /// The best one whose name contains this, whatever the case.
    Named(String),
}

impl Wanted {
    /// What an option says, or else the environment variable [`DEVICE_VARIABLE`]; without either the best. Digits alone
    /// are a number.
    pub fn of(option: Option<&str>) -> Self {
        let environment =
            || std::env::var_os(DEVICE_VARIABLE).map(|text| text.to_string_lossy().into_owned());
        Self::parse(&option.map(str::to_owned).or_else(environment).unwrap_or_default())
    }

    fn parse(text: &str) -> Self {
        let text = text.trim();
        match text {
            "" => Self::Best,
            _ if text.bytes().all(|byte| byte.is_ascii_digit()) => {
                Self::Number(text.parse().unwrap_or(usize::MAX))
            }
            _ => Self::Named(text.to_lowercase()),
        }
    }

    /// The device among these, usable ones only.
    pub fn choose<'a>(&self, devices: impl IntoIterator<Item = &'a DeviceInfo>) -> Option<&'a DeviceInfo> {
        let fits = |info: &&DeviceInfo| match self {
            Self::Best => true,
            Self::Hardware => info.kind != DeviceKind::Cpu,
            Self::Number(number) => info.index == *number,
            Self::Named(name) => info.name.to_lowercase().contains(name),
        };
        let usable = devices.into_iter().filter(|info| info.unusable.is_none());
        usable.filter(fits).min_by_key(|info| (info.kind, info.index))
    }
}

impl fmt::Display for Wanted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Best => write!(f, "no Vulkan device can be used"),
            Self::Hardware => write!(f, "no Vulkan device but software can be used"),
            Self::Number(number) => write!(f, "no usable Vulkan device has the number {number}"),
            Self::Named(name) => write!(f, "no usable Vulkan device has {name:?} in its name"),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;

    fn device(index: usize, name: &str, kind: DeviceKind, unusable: Option<&str>) -> DeviceInfo {
        DeviceInfo {
            index,
            name: name.to_owned(),
            kind,
            api: "1.3.0".to_owned(),
            driver: String::new(),
            is_tiler: false,
            draws_indirectly: true,
            unusable: unusable.map(str::to_owned),
        }
    }

    #[test]
    fn digits_are_a_number_in_the_list_and_never_part_of_a_name() {
        let devices = [
            device(0, "llvmpipe (LLVM 19.1.7, 256 bits)", DeviceKind::Cpu, None),
            device(1, "NVIDIA RTX 4070", DeviceKind::Discrete, None),
            device(2, "NVIDIA RTX 3060", DeviceKind::Discrete, Some("needs Vulkan 1.3")),
        ];
        let index = |text: &str| Wanted::parse(text).choose(&devices).map(|info| info.index);
        assert_eq!((index(""), index("0"), index("1")), (Some(1), Some(0), Some(1)));
        assert_eq!((index("rtx"), index("LLVM"), index(" llvmpipe ")), (Some(1), Some(0), Some(0)));
        assert_eq!(Wanted::Hardware.choose(&devices).map(|info| info.index), Some(1));
        assert_eq!(Wanted::Hardware.choose(&devices[..1]), None);
        for absent in ["7", "19", "4070", "2", "3060 ", "99999999999999999999999", "radeon", "-1"] {
            assert_eq!(index(absent), None, "{absent}");
        }
    }
}
