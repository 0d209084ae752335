//! Arrays of eight words, with the operations of every machine.

/// How many invocations run side by side.
pub const LANES: usize = 8;

/// One word a lane.
#[derive(Debug, Clone, Copy)]
#[repr(transparent)]
pub struct V([u32; LANES]);

/// One truth value a lane: all bits or none.
#[derive(Debug, Clone, Copy)]
#[repr(transparent)]
pub struct M([u32; LANES]);

/// Operations on floats.
macro_rules! floats {
    ($($(#[$doc:meta])* $name:ident |$a:ident, $b:ident| $body:expr;)*) => {
        $($(#[$doc])* #[inline(always)] pub fn $name(self, other: Self) -> Self {
            self.each_f(other, |$a, $b| $body)
        })*
    };
}

/// Operations on one float.
macro_rules! float {
    ($($(#[$doc:meta])* $name:ident |$a:ident| $body:expr;)*) => {
        $($(#[$doc])* #[inline(always)] pub fn $name(self) -> Self { self.each_f(self, |$a, _| $body) })*
    };
}

/// Operations on words.
macro_rules! words {
    ($($(#[$doc:meta])* $name:ident |$a:pat_param, $b:pat_param| $body:expr;)*) => {
        $($(#[$doc])* #[inline(always)] pub fn $name(self, other: Self) -> Self {
            self.each(other, |$a, $b| $body)
        })*
    };
}

/// Comparisons of words.
macro_rules! compare {
    ($($(#[$doc:meta])* $name:ident |$a:ident, $b:ident| $body:expr;)*) => {
        $($(#[$doc])* #[inline(always)] pub fn $name(self, other: Self) -> M {
            M(self.each(other, |$a, $b| 0u32.wrapping_sub(u32::from($body))).0)
        })*
    };
}

impl V {
    /// The word in all lanes.
    #[inline(always)]
    pub const fn c(word: u32) -> Self {
        Self([word; LANES])
    }

    /// 0, 1, 2, and so on.
    #[inline(always)]
    pub const fn iota() -> Self {
        Self([0, 1, 2, 3, 4, 5, 6, 7])
    }

    /// The word of the first lane that is true.
    #[inline(always)]
    pub fn first(self, mask: M) -> u32 {
        self.0[mask.bits().trailing_zeros() as usize % LANES]
    }

    floats! {
        /// Sum.
        fadd |a, b| a + b;
        /// Difference.
        fsub |a, b| a - b;
        /// Product.
        fmul |a, b| a * b;
        /// Quotient.
        fdiv |a, b| a / b;
        /// The lesser; the second where neither is less.
        fmin |a, b| if a < b { a } else { b };
        /// The greater; the second where neither is greater.
        fmax |a, b| if b < a { a } else { b };
    }

    float! {
        /// Square root.
        fsqrt |a| a.sqrt();
        /// Magnitude.
        fabs |a| f32::from_bits(a.to_bits() & 0x7fff_ffff);
        /// Negated.
        fneg |a| f32::from_bits(a.to_bits() ^ 0x8000_0000);
        /// Rounded down.
        ffloor |a| a.floor();
        /// Rounded up.
        fceil |a| a.ceil();
        /// Rounded towards zero.
        ftrunc |a| a.trunc();
        /// Rounded to the nearest, of two the even.
        fround |a| a.round_ties_even();
        /// To an unsigned integer, towards zero; the nearest where it does not fit, NaN to 0.
        f_to_u |a| f32::from_bits(a as u32);
        /// To a signed integer, towards zero; the nearest where it does not fit, NaN to 0.
        f_to_i |a| f32::from_bits((a as i32) as u32);
        /// Of an unsigned integer.
        u_to_f |a| a.to_bits() as f32;
        /// Of a signed integer.
        i_to_f |a| (a.to_bits() as i32) as f32;
    }

    words! {
        /// Sum, modulo 2^32.
        iadd |a, b| a.wrapping_add(b);
        /// Difference, modulo 2^32.
        isub |a, b| a.wrapping_sub(b);
        /// Product, modulo 2^32.
        imul |a, b| a.wrapping_mul(b);
        /// Magnitude of a signed integer; the other counts for nothing.
        iabs_of |a, _| (a as i32).unsigned_abs();
        /// Bits of both.
        and |a, b| a & b;
        /// Bits of either.
        or |a, b| a | b;
        /// Bits that differ.
        xor |a, b| a ^ b;
        /// Shifted to the higher bits, by the other modulo 32.
        ishl |a, b| a.wrapping_shl(b);
        /// Shifted to the lower bits, by the other modulo 32; zeros come in.
        ushr |a, b| a.wrapping_shr(b);
        /// Shifted to the lower bits, by the other modulo 32; the sign comes in.
        ishr |a, b| (a as i32).wrapping_shr(b) as u32;
        /// The lesser unsigned.
        umin |a, b| a.min(b);
        /// The greater unsigned.
        umax |a, b| a.max(b);
        /// The lesser signed.
        imin |a, b| (a as i32).min(b as i32) as u32;
        /// The greater signed.
        imax |a, b| (a as i32).max(b as i32) as u32;
    }

    compare! {
        /// Equal words.
        ieq |a, b| a == b;
        /// Less, as unsigned integers.
        ult |a, b| a < b;
        /// Less, as signed integers.
        ilt |a, b| (a as i32) < (b as i32);
        /// Equal, as floats.
        feq |a, b| f32::from_bits(a) == f32::from_bits(b);
        /// Less, as floats.
        flt |a, b| f32::from_bits(a) < f32::from_bits(b);
        /// Less or equal, as floats.
        fleq |a, b| f32::from_bits(a) <= f32::from_bits(b);
    }

    /// Magnitude of a signed integer.
    #[inline(always)]
    pub fn iabs(self) -> Self {
        self.iabs_of(self)
    }
}

impl M {
    /// The same in all lanes.
    #[inline(always)]
    pub const fn c(value: bool) -> Self {
        Self([0u32.wrapping_sub(value as u32); LANES])
    }

    /// Both.
    #[inline(always)]
    pub fn and(self, other: Self) -> Self {
        Self(V(self.0).and(V(other.0)).0)
    }

    /// Either.
    #[inline(always)]
    pub fn or(self, other: Self) -> Self {
        Self(V(self.0).or(V(other.0)).0)
    }

    /// One of them alone.
    #[inline(always)]
    pub fn xor(self, other: Self) -> Self {
        Self(V(self.0).xor(V(other.0)).0)
    }

    /// This without the other.
    #[inline(always)]
    pub fn andnot(self, other: Self) -> Self {
        self.and(other.negated())
    }

    /// Not.
    #[inline(always)]
    pub fn negated(self) -> Self {
        Self(V(self.0).xor(V::c(u32::MAX)).0)
    }

    /// Some lane is true.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.bits() != 0
    }

    /// A bit a lane, the first lowest.
    #[inline(always)]
    pub fn bits(self) -> u32 {
        (0..LANES).fold(0, |bits, lane| bits | (self.0[lane] & 1) << lane)
    }

    /// The first where true, else the second.
    #[inline(always)]
    pub fn pick(self, yes: V, no: V) -> V {
        let mask = V(self.0);
        V(mask.and(yes).or(mask.xor(V::c(u32::MAX)).and(no)).0)
    }
}

/// The word at each lane's index.
///
/// # Safety
/// Every index is that of a word that may be read.
#[inline(always)]
unsafe fn gather(from: *const u32, index: V) -> V {
    // SAFETY: the caller vouches for each index.
    V(index.0.map(|at| unsafe { from.add(at as usize).read() }))
}

/// The `W` words from each lane's index on.
///
/// # Safety
/// They may be read.
#[inline(always)]
unsafe fn gather_row<const W: usize>(from: *const u32, index: V) -> [V; W] {
    let mut row = [V::c(0); W];
    for (offset, value) in row.iter_mut().enumerate() {
        // SAFETY: the caller vouches for each index.
        *value = unsafe { gather(from.add(offset), index) };
    }
    row
}

/// Swaps the two indices of each block of four by four words: word `j` of block `k` of value `i` becomes word `i` of block `k` of
/// value `j`.
#[inline(always)]
fn transpose(from: [V; 4]) -> [V; 4] {
    let mut to = from;
    for (i, to) in to.iter_mut().enumerate() {
        for (lane, word) in to.0.iter_mut().enumerate() {
            *word = from[lane % 4].0[lane / 4 * 4 + i];
        }
    }
    to
}

common!();
