//! Correctly rounded division and square root from an approximate reciprocal: twins of `shaders/operations/careful.wgsl`.
//!
//! The twins of kernels divide as the computer does, which is exact. These here show that the careful code gives the same, for
//! any guess that a device may make.

/// `a / b` rounded to the nearest; `inverse` is a device's `1 / x`.
pub fn divide(a: f32, b: f32, inverse: impl Fn(f32) -> f32) -> f32 {
    let (ua, ub) = (a.to_bits(), b.to_bits());
    let sign = (ua ^ ub) & 0x8000_0000;
    let (mut ea, mut eb) = ((ua >> 23 & 0xff) as i32, (ub >> 23 & 0xff) as i32);
    let (mut ma, mut mb) = (ua & 0x7f_ffff | 0x80_0000, ub & 0x7f_ffff | 0x80_0000);
    if (ea - 1) as u32 >= 254 || (eb - 1) as u32 >= 254 {
        let (xa, xb) = (ua & 0x7fff_ffff, ub & 0x7fff_ffff);
        if xa > 0x7f80_0000 || xb > 0x7f80_0000 || (xa == xb && (xa == 0 || xa == 0x7f80_0000)) {
            return f32::from_bits(0x7fc0_0000);
        }
        if xa == 0x7f80_0000 || xb == 0 {
            return f32::from_bits(sign | 0x7f80_0000);
        }
        if xb == 0x7f80_0000 || xa == 0 {
            return f32::from_bits(sign);
        }
        if ea == 0 {
            let shift = xa.leading_zeros() - 8;
            (ma, ea) = (xa << shift, 1 - shift as i32);
        }
        if eb == 0 {
            let shift = xb.leading_zeros() - 8;
            (mb, eb) = (xb << shift, 1 - shift as i32);
        }
    }
    let less = u32::from(ma < mb);
    let inverse = inverse(f32::from_bits(0x3f00_0000 + mb));
    let guess = f32::from_bits(0x3f00_0000 + ma) * inverse;
    let mut q = (guess * if less == 1 { 16_777_216.0 } else { 8_388_608.0 }) as u32;
    let d = mb as i32;
    let mut r = (ma << (23 + less)).wrapping_sub(q.wrapping_mul(mb)) as i32;
    let off = (r as f32 * (inverse * 1.192_092_9e-7)) as i32;
    q = q.wrapping_add_signed(off);
    r = r.wrapping_sub(off.wrapping_mul(d));
    let step = i32::from(2 * r > d) - i32::from(2 * r < -d);
    q = q.wrapping_add_signed(step);
    r -= step * d;
    let e = ea - eb + 127 - less as i32;
    if (e - 1) as u32 >= 254 {
        let bits = if e >= 255 { 0x7f80_0000 } else { subnormal(q, r, d, e) };
        return f32::from_bits(sign | bits);
    }
    f32::from_bits(sign | (((e as u32) << 23) + (q - 0x80_0000)))
}

/// The bits of a subnormal quotient: rounded once, to even, from the floor `q` with a guard and a sticky bit.
fn subnormal(mut q: u32, mut r: i32, d: i32, e: i32) -> u32 {
    if r < 0 {
        (q, r) = (q - 1, r + d);
    }
    let wide = q << 2 | u32::from(2 * r >= d) << 1 | u32::from(r != 0 && 2 * r != d);
    let shift = ((1 - e) as u32).min(26) + 2;
    let (rest, half, m) = (wide & ((1 << shift) - 1), 1 << (shift - 1), wide >> shift);
    m + u32::from(rest > half || (rest == half && m & 1 == 1))
}

/// The root of `x` rounded to the nearest; `inverse_root` is a device's `1 / sqrt(x)`.
pub fn square_root(x: f32, inverse_root: impl Fn(f32) -> f32) -> f32 {
    let u = x.to_bits();
    let (mut e, mut m) = ((u >> 23) as i32, u & 0x7f_ffff | 0x80_0000);
    if u.wrapping_sub(0x80_0000) >= 0x7f00_0000 {
        if u & 0x7fff_ffff == 0 || u == 0x7f80_0000 {
            return x;
        }
        if u > 0x7f80_0000 {
            return f32::from_bits(0x7fc0_0000);
        }
        let shift = u.leading_zeros() - 8;
        (m, e) = (u << shift, 1 - shift as i32);
    }
    let odd = (e - 127) as u32 & 1;
    let scaled = f32::from_bits(0x3f00_0000 + m + (odd << 23));
    let inverse = inverse_root(scaled);
    let mut s = (scaled * inverse * 8_388_608.0) as u32;
    let mut r = (m << (23 + odd)).wrapping_sub(s.wrapping_mul(s)) as i32;
    let off = (r as f32 * (inverse * 5.960_464_5e-8)) as i32;
    r = r.wrapping_sub(off.wrapping_mul(2 * s as i32 + off));
    s = s.wrapping_add_signed(off);
    let step = i32::from(r > s as i32) - i32::from(r <= -(s as i32));
    s = s.wrapping_add_signed(step);
    let exponent = ((e - 127 - odd as i32) >> 1) + 127;
    f32::from_bits(((exponent as u32) << 23) + (s - 0x80_0000))
}
