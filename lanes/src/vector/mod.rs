//! Words of several invocations side by side: a [`V`](portable::V) holds one 32-bit word of each, a
//! [`M`](portable::M) one truth value of each. A word has no type: an operation says whether it takes floats (`f…`),
//! unsigned (`u…`) or signed integers (`i…`).
//!
//! Every module here has the same names. A generated kernel is compiled once with each; [`Isa::best`] says which to run.
//! Arithmetic is that of IEEE 754, and nothing is contracted: all give the same bits.

#[macro_use]
mod common;
#[cfg(target_arch = "x86_64")]
pub mod avx2;
#[cfg(target_arch = "x86_64")]
pub mod avx512;
#[cfg(target_arch = "aarch64")]
pub mod neon;
pub mod portable;

/// A set of instructions that kernels are compiled for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Isa {
    /// What every machine has: arrays of eight words, which the compiler makes vectors of where it can.
    Portable,
    /// NEON: four words.
    Neon,
    /// AVX2: eight words.
    Avx2,
    /// AVX-512 (F, BW, DQ, VL): sixteen words.
    Avx512,
}

impl Isa {
    /// All, the narrowest first.
    pub const ALL: [Self; 4] = [Self::Portable, Self::Neon, Self::Avx2, Self::Avx512];

    /// Those that machines of an architecture may have, by the name that Cargo gives it (`CARGO_CFG_TARGET_ARCH`).
    pub fn of(architecture: &str) -> &'static [Self] {
        match architecture {
            "x86_64" => &[Self::Portable, Self::Avx2, Self::Avx512],
            "aarch64" => &[Self::Portable, Self::Neon],
            _ => &[Self::Portable],
        }
    }

    /// Its name, as in modules of generated code.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Neon => "neon",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// How many invocations run side by side.
    pub const fn lanes(self) -> u32 {
        match self {
            Self::Neon => 4,
            Self::Portable | Self::Avx2 => 8,
            Self::Avx512 => 16,
        }
    }

    /// Whether this machine has it.
    pub fn is_here(self) -> bool {
        match self {
            Self::Portable => true,
            Self::Neon => cfg!(target_arch = "aarch64"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }

    /// The widest that this machine has.
    pub fn best() -> Self {
        Self::ALL.into_iter().rev().find(|isa| isa.is_here()).unwrap_or(Self::Portable)
    }
}
