//! How a device computes the kernels: with its own operations where they are exact, with careful code where they are not.
//!
//! Vulkan lets a device divide wrongly by 2.5 units in the last place, take roots wrongly, return either of two zeros from `min`
//! and `max`, and flush subnormal numbers. A crowd that differs by one rounding is a different crowd after some hundred steps.

use super::Error;
use crate::kernels::link::{self, FloatMode, Operation, declare, link};
use crate::kernels::operations;
use crate::kernels::probe::Primitive;
use ash::vk;
use std::fmt;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU8, Ordering};

/// Which arithmetic is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum Wanted {
    /// The device's own where it is exact, careful code where it is not.
    #[default]
    Auto,
    /// The device's own.
    Native,
    /// Careful code, also where the device is exact.
    Careful,
}

/// What the program's option says: one more than the number of the variant, 0 for nothing.
static OPTION: AtomicU8 = AtomicU8::new(0);

impl Wanted {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Auto, Self::Native, Self::Careful];
    /// The environment variable that says it where no option does.
    pub const VARIABLE: &str = "GAITWAY_ARITHMETIC";

    /// What it is called.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Native => "native",
            Self::Careful => "careful",
        }
    }

    /// Makes it the choice for all devices that this process opens from now on.
    pub fn choose(self) {
        OPTION.store(self as u8 + 1, Ordering::Relaxed);
    }

    /// What [`Self::choose`] said last, or else the environment variable [`Self::VARIABLE`]; `Auto` without either.
    ///
    /// # Errors
    /// [`Error::UnknownArithmetic`].
    pub fn of_process() -> Result<Self, Error> {
        let chosen = OPTION.load(Ordering::Relaxed);
        if let Some(wanted) = Self::ALL.into_iter().find(|wanted| *wanted as u8 + 1 == chosen) {
            return Ok(wanted);
        }
        let name = std::env::var_os(Self::VARIABLE).unwrap_or_default();
        let name = name.to_string_lossy();
        let found = Self::ALL.into_iter().find(|wanted| wanted.name() == name);
        if name.is_empty() {
            Ok(Self::Auto)
        } else {
            found.ok_or(Error::UnknownArithmetic(name.into_owned()))
        }
    }
}

/// For tests: what a device does wrong, planted into the code of its kernels.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Fault {
    /// Division and root are wrong by up to one unit in the last place.
    By1,
    /// The same by up to three units.
    By3,
    /// Division and root are wrong by one unit for few operands, whether the device's own or careful.
    Slip,
    /// Minimum, maximum and clamp return the other one of two zeros.
    Zeros,
    /// Subnormal numbers are taken for zero.
    Flush,
}

impl Fault {
    const NAMED: [(&str, Self); 5] = [
        ("by-1", Self::By1),
        ("by-3", Self::By3),
        ("slip", Self::Slip),
        ("zeros", Self::Zeros),
        ("flush", Self::Flush),
    ];
    /// The environment variable that names them, separated by commas.
    pub const VARIABLE: &str = "GAITWAY_WRONG_ARITHMETIC";

    /// Those that [`Self::VARIABLE`] names.
    ///
    /// # Errors
    /// [`Error::UnknownFault`].
    pub fn from_environment() -> Result<Vec<Self>, Error> {
        let names = std::env::var_os(Self::VARIABLE).unwrap_or_default();
        let names = names.to_string_lossy().into_owned();
        let find = |name: &str| Self::NAMED.into_iter().find(|(known, _)| *known == name.trim());
        let named =
            |name: &str| find(name).map(|(_, fault)| fault).ok_or(Error::UnknownFault(name.to_owned()));
        names.split(',').filter(|name| !name.is_empty()).map(named).collect()
    }
}

/// How the kernels of a device are to be computed.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Setting {
    /// Which arithmetic.
    pub wanted: Wanted,
    /// For tests: what the device does wrong.
    #[doc(hidden)]
    pub faults: Vec<Fault>,
}

impl Setting {
    /// What option and environment say.
    ///
    /// # Errors
    /// When a variable has a value that is none.
    pub fn of_process() -> Result<Self, Error> {
        Ok(Self { wanted: Wanted::of_process()?, faults: Fault::from_environment()? })
    }

    /// Whether the code of its kernels is that of the program: not wrong on purpose, nor compiled when the program starts.
    pub(super) fn is_lasting(&self) -> bool {
        self.faults.is_empty() && shader_folder().is_none()
    }
}

/// The folder whose shaders are compiled when the program starts, if `GAITWAY_SHADERS` names one.
pub(crate) fn shader_folder() -> Option<PathBuf> {
    if cfg!(feature = "hot-reload") { std::env::var_os("GAITWAY_SHADERS").map(PathBuf::from) } else { None }
}

/// Operations that are replaced together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Part {
    /// Division.
    Division,
    /// Square root.
    SquareRoot,
    /// Minimum, maximum, clamp.
    Order,
}

impl Part {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Division, Self::SquareRoot, Self::Order];

    const fn name(self) -> &'static str {
        match self {
            Self::Division => "division",
            Self::SquareRoot => "square root",
            Self::Order => "minimum and maximum",
        }
    }

    const fn operations(self) -> &'static [Operation] {
        match self {
            Self::Division => &[Operation::Divide],
            Self::SquareRoot => &[Operation::Root],
            Self::Order => &[Operation::Least, Operation::Most, Operation::Clamp],
        }
    }

    /// The part that a primitive belongs to; none for what no code of ours can mend.
    pub const fn of(primitive: Primitive) -> Option<Self> {
        match primitive {
            Primitive::Division => Some(Self::Division),
            Primitive::SquareRoot => Some(Self::SquareRoot),
            Primitive::Minimum | Primitive::Maximum | Primitive::Clamp => Some(Self::Order),
            _ => None,
        }
    }
}

/// The arithmetic that a device's kernels are computed with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Arithmetic {
    /// What is computed by careful code; nothing on an exact device.
    careful: Vec<Part>,
    modes: Vec<FloatMode>,
    faults: Vec<Fault>,
}

impl fmt::Display for Arithmetic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.careful.is_empty() {
            return f.write_str(Wanted::Native.name());
        }
        let names: Vec<&str> = self.careful.iter().map(|part| part.name()).collect();
        write!(f, "{} ({})", Wanted::Careful.name(), names.join(", "))
    }
}

impl Arithmetic {
    /// Careful code for these parts, on a device that lets these modes be declared and has these faults.
    pub(super) const fn new(careful: Vec<Part>, modes: Vec<FloatMode>, faults: Vec<Fault>) -> Self {
        Self { careful, modes, faults }
    }

    /// What is computed by careful code.
    pub fn careful(&self) -> &[Part] {
        &self.careful
    }

    /// The code of a kernel with this arithmetic.
    pub(super) fn applied(&self, code: &[u32]) -> Result<Vec<u32>, Error> {
        Ok(declare(&self.linked(code)?, &self.modes))
    }

    fn linked(&self, code: &[u32]) -> Result<Vec<u32>, link::Error> {
        use Operation::{Add, Divide, InverseRoot, Multiply, Root, Subtract};
        let has = |fault| self.faults.contains(&fault);
        let mut code = code.to_vec();
        if has(Fault::Slip) {
            code = link(&code, operations::SLIP, &[Divide, Root])?;
        }
        let careful: Vec<Operation> =
            self.careful.iter().flat_map(|part| part.operations()).copied().collect();
        code = link(&code, operations::CAREFUL, &careful)?;
        let plain = if has(Fault::Zeros) { operations::ZEROS } else { operations::PLAIN };
        code = link(&code, plain, Part::Order.operations())?;
        for (fault, library) in [(Fault::By1, operations::WRONG_BY_1), (Fault::By3, operations::WRONG_BY_3)] {
            if has(fault) {
                code = link(&code, library, &[Divide, Root, InverseRoot])?;
            }
        }
        if has(Fault::Flush) {
            code = link(&code, operations::FLUSH, &[Add, Subtract, Multiply, Divide, Root])?;
        }
        Ok(code)
    }
}

/// What may be declared of floats of 32 bits on a device.
pub(super) fn float_modes(instance: &ash::Instance, physical: vk::PhysicalDevice) -> Vec<FloatMode> {
    let mut floats = vk::PhysicalDeviceFloatControlsProperties::default();
    // SAFETY: the device came from this instance and has Vulkan 1.3, so the structure is known to it.
    unsafe {
        let mut all = vk::PhysicalDeviceProperties2::default().push_next(&mut floats);
        instance.get_physical_device_properties2(physical, &mut all);
    }
    let offered = [
        (FloatMode::DenormPreserve, floats.shader_denorm_preserve_float32),
        (FloatMode::SignedZeroInfNanPreserve, floats.shader_signed_zero_inf_nan_preserve_float32),
        (FloatMode::RoundingModeRte, floats.shader_rounding_mode_rte_float32),
    ];
    offered.into_iter().filter(|(_, offered)| *offered == vk::TRUE).map(|(mode, _)| mode).collect()
}
