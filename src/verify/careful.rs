//! Careful division and root against those of this computer, whatever the guess of a device: the proof of
//! `shaders/operations/careful.wgsl`, by its twins.

use crate::reference::careful::{divide, square_root};
use rayon::prelude::*;
use std::ops::Range;

/// A float that is off by some units in the last place.
fn off(x: f32, units: i32) -> f32 {
    f32::from_bits(x.to_bits().wrapping_add_signed(units))
}

/// Whether two results are equal to the bit, or both no number.
fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// Most units by which a guess may be off, where Vulkan allows 3: the residual of a root stays below 2^31.
pub const MOST_OFF: i32 = 24;

/// How far the guess for a case is off.
fn error(number: u64) -> i32 {
    (number % (2 * MOST_OFF as u64 + 1)) as i32 - MOST_OFF
}

/// Whether the root of a float comes out wrong.
pub fn is_root_wrong(x: f32) -> bool {
    let guess = error(u64::from(x.to_bits()));
    !same(square_root(x, |x| off(1.0 / x.sqrt(), guess)), x.sqrt())
}

/// Whether a quotient comes out wrong, with the guess error that the number chooses.
pub fn is_quotient_wrong([a, b]: [f32; 2], number: u64) -> bool {
    let guess = error(number);
    !same(divide(a, b, |x| off(1.0 / x, guess)), a / b)
}

/// Wrong roots among the floats of these bits.
pub fn wrong_roots(bits: Range<u64>) -> usize {
    bits.into_par_iter().filter(|bits| is_root_wrong(f32::from_bits(*bits as u32))).count()
}

/// Wrong quotients among the random ones of these numbers.
pub fn wrong_quotients(numbers: Range<u64>) -> usize {
    numbers.into_par_iter().filter(|number| is_quotient_wrong(quotient(*number), number / 8)).count()
}

/// Quotients of every kind: of any bits, next to the middle between two floats, of subnormal numbers.
fn quotient(number: u64) -> [f32; 2] {
    let mut x = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^= x >> 31;
    let (a, b, more) = (x as u32, (x >> 32) as u32, (number >> 3) as u32);
    let mantissa = |bits: u32| bits & 0x7f_ffff | 0x80_0000;
    let [a, b] = match number % 8 {
        0..4 => [a, b],
        4..6 => {
            let product = (u64::from(2 * mantissa(a) + 1) * u64::from(mantissa(b))) >> 1;
            let shift = 64 - product.leading_zeros() - 24;
            let beside = (product >> shift) as u32 + more % 3 - 1;
            [beside.clamp(0x80_0000, 0xff_ffff) + 0x3f00_0000, mantissa(b) + 0x3f00_0000]
        }
        6 => [a & 0x80ff_ffff, b & 0x80ff_ffff],
        _ => [a & 0x80ff_ffff, b & 0x807f_ffff | (110 + more % 40) << 23],
    };
    [a, b].map(f32::from_bits)
}
