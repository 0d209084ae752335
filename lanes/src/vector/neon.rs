//! NEON, which every 64-bit Arm machine has: four words. A truth value is a word of ones or zeros.
//! Eight words in two registers take as many instructions in all: lanes wait for each other longer, and registers run out.

use std::arch::aarch64::*;

/// How many invocations run side by side.
pub const LANES: usize = 4;

/// One word a lane.
#[derive(Debug, Clone, Copy)]
#[repr(transparent)]
pub struct V(uint32x4_t);

/// One truth value a lane.
#[derive(Debug, Clone, Copy)]
#[repr(transparent)]
pub struct M(uint32x4_t);

/// The bit of each lane, for [`M::bits`].
const BIT: [u32; LANES] = [1, 2, 4, 8];

#[inline(always)]
fn float(words: uint32x4_t) -> float32x4_t {
    // SAFETY: every 64-bit Arm machine has NEON.
    unsafe { vreinterpretq_f32_u32(words) }
}

#[inline(always)]
fn bits(floats: float32x4_t) -> uint32x4_t {
    // SAFETY: as above.
    unsafe { vreinterpretq_u32_f32(floats) }
}

#[inline(always)]
fn to_signed(words: uint32x4_t) -> int32x4_t {
    // SAFETY: as above.
    unsafe { vreinterpretq_s32_u32(words) }
}

#[inline(always)]
fn to_unsigned(words: int32x4_t) -> uint32x4_t {
    // SAFETY: as above.
    unsafe { vreinterpretq_u32_s32(words) }
}

/// The word in all lanes.
#[inline(always)]
fn all(word: u32) -> uint32x4_t {
    // SAFETY: as above.
    unsafe { vdupq_n_u32(word) }
}

/// Operations of this and another.
macro_rules! both {
    ($($(#[$doc:meta])* $name:ident |$a:ident, $b:ident| $body:expr;)*) => {
        $($(#[$doc])* #[inline(always)] pub fn $name(self, other: Self) -> Self {
            let ($a, $b) = (self.0, other.0);
            // SAFETY: every 64-bit Arm machine has NEON.
            Self(unsafe { $body })
        })*
    };
}

/// Operations on this alone.
macro_rules! one {
    ($($(#[$doc:meta])* $name:ident |$a:ident| $body:expr;)*) => {
        $($(#[$doc])* #[inline(always)] pub fn $name(self) -> Self {
            let $a = self.0;
            // SAFETY: every 64-bit Arm machine has NEON.
            Self(unsafe { $body })
        })*
    };
}

/// Comparisons with another.
macro_rules! compare {
    ($($(#[$doc:meta])* $name:ident |$a:ident, $b:ident| $body:expr;)*) => {
        $($(#[$doc])* #[inline(always)] pub fn $name(self, other: Self) -> M {
            let ($a, $b) = (self.0, other.0);
            // SAFETY: every 64-bit Arm machine has NEON.
            M(unsafe { $body })
        })*
    };
}

impl V {
    /// The word in all lanes.
    #[inline(always)]
    pub fn c(word: u32) -> Self {
        Self(all(word))
    }

    /// 0, 1, 2, and so on.
    #[inline(always)]
    pub fn iota() -> Self {
        Self::from_array([0, 1, 2, 3])
    }

    /// The word of the first lane that is true.
    #[inline(always)]
    pub fn first(self, mask: M) -> u32 {
        self.to_array()[mask.bits().trailing_zeros() as usize % LANES]
    }

    both! {
        /// Sum of floats.
        fadd |a, b| bits(vaddq_f32(float(a), float(b)));
        /// Difference of floats.
        fsub |a, b| bits(vsubq_f32(float(a), float(b)));
        /// Product of floats.
        fmul |a, b| bits(vmulq_f32(float(a), float(b)));
        /// Quotient of floats.
        fdiv |a, b| bits(vdivq_f32(float(a), float(b)));
        // `vminq_f32` takes -0 for less than 0 and gives NaN where either is: not what a shader says.
        /// The lesser float; the second where neither is less.
        fmin |a, b| vbslq_u32(vcltq_f32(float(a), float(b)), a, b);
        /// The greater float; the second where neither is greater.
        fmax |a, b| vbslq_u32(vcltq_f32(float(b), float(a)), a, b);
        /// Sum, modulo 2^32.
        iadd |a, b| vaddq_u32(a, b);
        /// Difference, modulo 2^32.
        isub |a, b| vsubq_u32(a, b);
        /// Product, modulo 2^32.
        imul |a, b| vmulq_u32(a, b);
        /// Bits of both.
        and |a, b| vandq_u32(a, b);
        /// Bits of either.
        or |a, b| vorrq_u32(a, b);
        /// Bits that differ.
        xor |a, b| veorq_u32(a, b);
        /// Shifted to the higher bits, by the other modulo 32.
        ishl |a, b| vshlq_u32(a, to_signed(vandq_u32(b, all(31))));
        // There is no shift to the lower bits by a register: one to the higher bits by less than zero does it.
        /// Shifted to the lower bits, by the other modulo 32; zeros come in.
        ushr |a, b| vshlq_u32(a, vnegq_s32(to_signed(vandq_u32(b, all(31)))));
        /// Shifted to the lower bits, by the other modulo 32; the sign comes in.
        ishr |a, b| to_unsigned(vshlq_s32(to_signed(a), vnegq_s32(to_signed(vandq_u32(b, all(31))))));
        /// The lesser unsigned.
        umin |a, b| vminq_u32(a, b);
        /// The greater unsigned.
        umax |a, b| vmaxq_u32(a, b);
        /// The lesser signed.
        imin |a, b| to_unsigned(vminq_s32(to_signed(a), to_signed(b)));
        /// The greater signed.
        imax |a, b| to_unsigned(vmaxq_s32(to_signed(a), to_signed(b)));
    }

    one! {
        /// Square root of a float.
        fsqrt |a| bits(vsqrtq_f32(float(a)));
        /// Magnitude of a float.
        fabs |a| vandq_u32(a, all(0x7fff_ffff));
        /// A float negated.
        fneg |a| veorq_u32(a, all(0x8000_0000));
        /// A float rounded down.
        ffloor |a| bits(vrndmq_f32(float(a)));
        /// A float rounded up.
        fceil |a| bits(vrndpq_f32(float(a)));
        /// A float rounded towards zero.
        ftrunc |a| bits(vrndq_f32(float(a)));
        /// A float rounded to the nearest, of two the even.
        fround |a| bits(vrndnq_f32(float(a)));
        /// To an unsigned integer, towards zero; the nearest where it does not fit, NaN to 0.
        f_to_u |a| vcvtq_u32_f32(float(a));
        /// To a signed integer, towards zero; the nearest where it does not fit, NaN to 0.
        f_to_i |a| to_unsigned(vcvtq_s32_f32(float(a)));
        /// A float of an unsigned integer, rounded once.
        u_to_f |a| bits(vcvtq_f32_u32(a));
        /// A float of a signed integer.
        i_to_f |a| bits(vcvtq_f32_s32(to_signed(a)));
        /// Magnitude of a signed integer.
        iabs |a| to_unsigned(vabsq_s32(to_signed(a)));
    }

    compare! {
        /// Equal words.
        ieq |a, b| vceqq_u32(a, b);
        /// Less, as unsigned integers.
        ult |a, b| vcltq_u32(a, b);
        /// Less, as signed integers.
        ilt |a, b| vcltq_s32(to_signed(a), to_signed(b));
        /// Equal, as floats.
        feq |a, b| vceqq_f32(float(a), float(b));
        /// Less, as floats.
        flt |a, b| vcltq_f32(float(a), float(b));
        /// Less or equal, as floats.
        fleq |a, b| vcleq_f32(float(a), float(b));
    }
}

impl M {
    /// The same in all lanes.
    #[inline(always)]
    pub fn c(value: bool) -> Self {
        Self(all(0u32.wrapping_sub(u32::from(value))))
    }

    both! {
        /// Both.
        and |a, b| vandq_u32(a, b);
        /// Either.
        or |a, b| vorrq_u32(a, b);
        /// One of them alone.
        xor |a, b| veorq_u32(a, b);
        /// This without the other.
        andnot |a, b| vbicq_u32(a, b);
    }

    /// Not.
    #[inline(always)]
    pub fn negated(self) -> Self {
        // SAFETY: every 64-bit Arm machine has NEON.
        Self(unsafe { vmvnq_u32(self.0) })
    }

    /// Some lane is true.
    #[inline(always)]
    pub fn any(self) -> bool {
        // SAFETY: every 64-bit Arm machine has NEON.
        unsafe { vmaxvq_u32(self.0) != 0 }
    }

    /// A bit a lane, the first lowest.
    #[inline(always)]
    pub fn bits(self) -> u32 {
        // SAFETY: every 64-bit Arm machine has NEON, and there are four words to load.
        unsafe { vaddvq_u32(vandq_u32(self.0, vld1q_u32(BIT.as_ptr()))) }
    }

    /// The first where true, else the second.
    #[inline(always)]
    pub fn pick(self, yes: V, no: V) -> V {
        // SAFETY: every 64-bit Arm machine has NEON.
        V(unsafe { vbslq_u32(self.0, yes.0, no.0) })
    }
}

/// The word at each lane's index.
///
/// # Safety
/// Every index is that of a word that may be read.
#[inline(always)]
unsafe fn gather(from: *const u32, index: V) -> V {
    let mut words = index.to_array();
    for word in &mut words {
        // SAFETY: the caller vouches for each index.
        *word = unsafe { from.add(*word as usize).read() };
    }
    V::from_array(words)
}

/// The `W` words from each lane's index on: four or two at a time as they lie in memory, then word by word.
///
/// # Safety
/// They may be read.
#[inline(always)]
unsafe fn gather_row<const W: usize>(from: *const u32, index: V) -> [V; W] {
    let at = index.to_array();
    let mut row = [V::c(0); W];
    let mut offset = 0;
    while offset + 4 <= W {
        let mut lanes = [V::c(0); 4];
        for (lane, at) in lanes.iter_mut().zip(at) {
            // SAFETY: the caller vouches for the words of each lane.
            *lane = V(unsafe { vld1q_u32(from.add(at as usize + offset)) });
        }
        row[offset..offset + 4].copy_from_slice(&transpose(lanes));
        offset += 4;
    }
    while offset + 2 <= W {
        // SAFETY: as above.
        unsafe {
            let two = |lane: usize| vld1_u32(from.add(at[lane] as usize + offset));
            let (low, high) = (vcombine_u32(two(0), two(1)), vcombine_u32(two(2), two(3)));
            row[offset] = V(vuzp1q_u32(low, high));
            row[offset + 1] = V(vuzp2q_u32(low, high));
        }
        offset += 2;
    }
    if offset < W {
        // SAFETY: as above.
        row[offset] = unsafe { gather(from.add(offset), index) };
    }
    row
}

/// Swaps the two indices of four by four words: word `j` of value `i` becomes word `i` of value `j`.
#[inline(always)]
fn transpose([a, b, c, d]: [V; 4]) -> [V; 4] {
    // SAFETY: every 64-bit Arm machine has NEON.
    unsafe {
        let pairs = |words| vreinterpretq_u64_u32(words);
        let (even, odd) = (pairs(vtrn1q_u32(a.0, b.0)), pairs(vtrn2q_u32(a.0, b.0)));
        let (even2, odd2) = (pairs(vtrn1q_u32(c.0, d.0)), pairs(vtrn2q_u32(c.0, d.0)));
        [
            V(vreinterpretq_u32_u64(vtrn1q_u64(even, even2))),
            V(vreinterpretq_u32_u64(vtrn1q_u64(odd, odd2))),
            V(vreinterpretq_u32_u64(vtrn2q_u64(even, even2))),
            V(vreinterpretq_u32_u64(vtrn2q_u64(odd, odd2))),
        ]
    }
}

common!();
