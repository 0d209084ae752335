//! AVX-512: sixteen words. A truth value is a bit.

use std::arch::x86_64::*;

/// How many invocations run side by side.
pub const LANES: usize = 16;

/// One word a lane.
#[derive(Debug, Clone, Copy)]
#[repr(transparent)]
pub struct V(__m512i);

/// One truth value a lane.
#[derive(Debug, Clone, Copy)]
#[repr(transparent)]
pub struct M(__mmask16);

/// 2^31 as a float.
const TWO_31: u32 = 0x4f00_0000;

#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
fn float(v: V) -> __m512 {
    _mm512_castsi512_ps(v.0)
}

#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
fn bits(v: __m512) -> V {
    V(_mm512_castps_si512(v))
}

/// Operations of one instruction, of this and another.
macro_rules! both {
    ($($(#[$doc:meta])* $name:ident |$a:ident, $b:ident| $body:expr;)*) => {
        $($(#[$doc])* #[inline] #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")] pub fn $name(self, other: Self) -> Self {
            let ($a, $b) = (self, other);
            $body
        })*
    };
}

/// Operations on this alone.
macro_rules! one {
    ($($(#[$doc:meta])* $name:ident |$a:ident| $body:expr;)*) => {
        $($(#[$doc])* #[inline] #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")] pub fn $name(self) -> Self {
            let $a = self;
            $body
        })*
    };
}

/// Comparisons with another.
macro_rules! compare {
    ($($(#[$doc:meta])* $name:ident |$a:ident, $b:ident| $body:expr;)*) => {
        $($(#[$doc])* #[inline] #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")] pub fn $name(self, other: Self) -> M {
            let ($a, $b) = (self, other);
            M($body)
        })*
    };
}

impl V {
    /// The word in all lanes.
    #[inline]
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
    pub fn c(word: u32) -> Self {
        Self(_mm512_set1_epi32(word as i32))
    }

    /// 0, 1, 2, and so on.
    #[inline]
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
    pub fn iota() -> Self {
        Self(_mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15))
    }

    /// The word of the first lane that is true.
    #[inline]
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
    pub fn first(self, mask: M) -> u32 {
        _mm512_cvtsi512_si32(_mm512_maskz_compress_epi32(mask.0, self.0)) as u32
    }

    both! {
        /// Sum of floats.
        fadd |a, b| bits(_mm512_add_ps(float(a), float(b)));
        /// Difference of floats.
        fsub |a, b| bits(_mm512_sub_ps(float(a), float(b)));
        /// Product of floats.
        fmul |a, b| bits(_mm512_mul_ps(float(a), float(b)));
        /// Quotient of floats.
        fdiv |a, b| bits(_mm512_div_ps(float(a), float(b)));
        /// The lesser float; the second where neither is less.
        fmin |a, b| bits(_mm512_min_ps(float(a), float(b)));
        /// The greater float; the second where neither is greater.
        fmax |a, b| bits(_mm512_max_ps(float(a), float(b)));
        /// Sum, modulo 2^32.
        iadd |a, b| Self(_mm512_add_epi32(a.0, b.0));
        /// Difference, modulo 2^32.
        isub |a, b| Self(_mm512_sub_epi32(a.0, b.0));
        /// Product, modulo 2^32.
        imul |a, b| Self(_mm512_mullo_epi32(a.0, b.0));
        /// Bits of both.
        and |a, b| Self(_mm512_and_si512(a.0, b.0));
        /// Bits of either.
        or |a, b| Self(_mm512_or_si512(a.0, b.0));
        /// Bits that differ.
        xor |a, b| Self(_mm512_xor_si512(a.0, b.0));
        /// Shifted to the higher bits, by the other modulo 32.
        ishl |a, b| Self(_mm512_sllv_epi32(a.0, b.and(Self::c(31)).0));
        /// Shifted to the lower bits, by the other modulo 32; zeros come in.
        ushr |a, b| Self(_mm512_srlv_epi32(a.0, b.and(Self::c(31)).0));
        /// Shifted to the lower bits, by the other modulo 32; the sign comes in.
        ishr |a, b| Self(_mm512_srav_epi32(a.0, b.and(Self::c(31)).0));
        /// The lesser unsigned.
        umin |a, b| Self(_mm512_min_epu32(a.0, b.0));
        /// The greater unsigned.
        umax |a, b| Self(_mm512_max_epu32(a.0, b.0));
        /// The lesser signed.
        imin |a, b| Self(_mm512_min_epi32(a.0, b.0));
        /// The greater signed.
        imax |a, b| Self(_mm512_max_epi32(a.0, b.0));
    }

    one! {
        /// Square root of a float.
        fsqrt |a| bits(_mm512_sqrt_ps(float(a)));
        /// Magnitude of a float.
        fabs |a| a.and(Self::c(0x7fff_ffff));
        /// A float negated.
        fneg |a| a.xor(Self::c(0x8000_0000));
        /// A float rounded down.
        ffloor |a| bits(_mm512_roundscale_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(float(a)));
        /// A float rounded up.
        fceil |a| bits(_mm512_roundscale_ps::<{ _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC }>(float(a)));
        /// A float rounded towards zero.
        ftrunc |a| bits(_mm512_roundscale_ps::<{ _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC }>(float(a)));
        /// A float rounded to the nearest, of two the even.
        fround |a| bits(_mm512_roundscale_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(float(a)));
        /// To an unsigned integer, towards zero; the nearest where it does not fit, NaN to 0.
        f_to_u |a| Self(_mm512_cvttps_epu32(float(a.fmax(Self::c(0))))); // of NaN the zero
        /// To a signed integer, towards zero; the nearest where it does not fit, NaN to 0.
        f_to_i |a| {
            let is_over = Self::c(TWO_31).fleq(a);
            let word = is_over.pick(Self::c(i32::MAX as u32), Self(_mm512_cvttps_epi32(float(a))));
            a.feq(a).pick(word, Self::c(0))
        };
        /// A float of an unsigned integer, rounded once.
        u_to_f |a| bits(_mm512_cvtepu32_ps(a.0));
        /// A float of a signed integer.
        i_to_f |a| bits(_mm512_cvtepi32_ps(a.0));
        /// Magnitude of a signed integer.
        iabs |a| Self(_mm512_abs_epi32(a.0));
    }

    compare! {
        /// Equal words.
        ieq |a, b| _mm512_cmpeq_epi32_mask(a.0, b.0);
        /// Less, as unsigned integers.
        ult |a, b| _mm512_cmplt_epu32_mask(a.0, b.0);
        /// Less, as signed integers.
        ilt |a, b| _mm512_cmplt_epi32_mask(a.0, b.0);
        /// Equal, as floats.
        feq |a, b| _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(float(a), float(b));
        /// Less, as floats.
        flt |a, b| _mm512_cmp_ps_mask::<_CMP_LT_OQ>(float(a), float(b));
        /// Less or equal, as floats.
        fleq |a, b| _mm512_cmp_ps_mask::<_CMP_LE_OQ>(float(a), float(b));
    }
}

impl M {
    /// The same in all lanes.
    #[inline]
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
    pub fn c(value: bool) -> Self {
        Self(0u16.wrapping_sub(u16::from(value)))
    }

    both! {
        /// Both.
        and |a, b| Self(a.0 & b.0);
        /// Either.
        or |a, b| Self(a.0 | b.0);
        /// One of them alone.
        xor |a, b| Self(a.0 ^ b.0);
        /// This without the other.
        andnot |a, b| Self(a.0 & !b.0);
    }

    /// Not.
    #[inline]
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
    pub fn negated(self) -> Self {
        Self(!self.0)
    }

    /// Some lane is true.
    #[inline]
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
    pub fn any(self) -> bool {
        self.bits() != 0
    }

    /// A bit a lane, the first lowest.
    #[inline]
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
    pub fn bits(self) -> u32 {
        u32::from(self.0)
    }

    /// The first where true, else the second.
    #[inline]
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
    pub fn pick(self, yes: V, no: V) -> V {
        V(_mm512_mask_blend_epi32(self.0, no.0, yes.0))
    }
}

/// The word at each lane's index.
///
/// # Safety
/// Every index is that of a word that may be read.
#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
unsafe fn gather(from: *const u32, index: V) -> V {
    let at = index.to_array();
    // SAFETY: the caller vouches for each index.
    let word = |lane: usize| unsafe { from.add(at[lane] as usize).cast::<i32>().read() };
    let block = |first: usize| _mm_setr_epi32(word(first), word(first + 1), word(first + 2), word(first + 3));
    let (low, high) = (_mm256_set_m128i(block(4), block(0)), _mm256_set_m128i(block(12), block(8)));
    V(_mm512_inserti64x4::<1>(_mm512_castsi256_si512(low), high))
}

/// Four words of memory, or two and two zeros.
///
/// # Safety
/// They may be read.
#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
unsafe fn load(from: *const u32, at: usize, words: usize) -> __m128i {
    // SAFETY: the caller vouches for the words.
    unsafe {
        let words_there: *const __m128i = from.add(at).cast();
        if words == 4 { _mm_loadu_si128(words_there) } else { _mm_loadl_epi64(words_there) }
    }
}

/// The `W` words from each lane's index on: four at a time as they lie in memory, then word by word.
///
/// # Safety
/// They may be read.
#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
unsafe fn gather_row<const W: usize>(from: *const u32, index: V) -> [V; W] {
    let at = index.to_array();
    let mut row = [V::c(0); W];
    let mut offset = 0;
    while offset + 2 <= W {
        let step = if offset + 4 <= W { 4 } else { 2 };
        let mut blocks = [V::c(0); 4];
        let mut first = 0;
        while first < 4 {
            // SAFETY: the caller vouches for the words of each lane.
            let [a, b, c, d] = unsafe {
                [
                    load(from, at[first] as usize + offset, step),
                    load(from, at[first + 4] as usize + offset, step),
                    load(from, at[first + 8] as usize + offset, step),
                    load(from, at[first + 12] as usize + offset, step),
                ]
            };
            let (low, high) = (_mm256_set_m128i(b, a), _mm256_set_m128i(d, c));
            blocks[first] = V(_mm512_inserti64x4::<1>(_mm512_castsi256_si512(low), high));
            first += 1;
        }
        let rows = transpose(blocks);
        row[offset..offset + step].copy_from_slice(&rows[..step]);
        offset += step;
    }
    if offset < W {
        // SAFETY: as above.
        row[offset] = unsafe { gather(from.add(offset), index) };
    }
    row
}

/// Swaps the two indices of each block of four by four words: word `j` of block `k` of value `i` becomes word `i` of block `k` of
/// value `j`.
#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
fn transpose([a, b, c, d]: [V; 4]) -> [V; 4] {
    let (low, high) = (_mm512_unpacklo_epi32(a.0, b.0), _mm512_unpackhi_epi32(a.0, b.0));
    let (low2, high2) = (_mm512_unpacklo_epi32(c.0, d.0), _mm512_unpackhi_epi32(c.0, d.0));
    [
        V(_mm512_unpacklo_epi64(low, low2)),
        V(_mm512_unpackhi_epi64(low, low2)),
        V(_mm512_unpacklo_epi64(high, high2)),
        V(_mm512_unpackhi_epi64(high, high2)),
    ]
}

common!(#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]);
