// Correctly rounded division and square root on any device that adds, subtracts and multiplies as Vulkan demands.
//
// The device's own reciprocal is a first guess, which may be wrong by 24 units in the last place. Integers decide: a residual
// modulo 2^32 is exact, since it is below 2^31. What the first correction leaves is less than 1.001, so one step goes to the
// nearest integer. A tie cannot occur: no quotient of two 24-bit numbers and no root of one lies halfway between two 24-bit
// numbers.
//
// Twins: reference::careful.

// a / b
fn op_div(a: f32, b: f32) -> f32 {
    let ua = bitcast<u32>(a);
    let ub = bitcast<u32>(b);
    let sign = (ua ^ ub) & 0x80000000u;
    var ea = i32((ua >> 23u) & 0xffu);
    var eb = i32((ub >> 23u) & 0xffu);
    var ma = (ua & 0x7fffffu) | 0x800000u;
    var mb = (ub & 0x7fffffu) | 0x800000u;
    if u32(ea - 1) >= 254u || u32(eb - 1) >= 254u { // zero, subnormal, infinite or NaN
        let xa = ua & 0x7fffffffu;
        let xb = ub & 0x7fffffffu;
        if xa > 0x7f800000u || xb > 0x7f800000u || (xa == xb && (xa == 0u || xa == 0x7f800000u)) {
            return from_bits(0x7fc00000u);
        }
        if xa == 0x7f800000u || xb == 0u {
            return from_bits(sign | 0x7f800000u);
        }
        if xb == 0x7f800000u || xa == 0u {
            return from_bits(sign);
        }
        if ea == 0 {
            let shift = countLeadingZeros(xa) - 8u;
            ma = xa << shift;
            ea = 1 - i32(shift);
        }
        if eb == 0 {
            let shift = countLeadingZeros(xb) - 8u;
            mb = xb << shift;
            eb = 1 - i32(shift);
        }
    }
    let less = select(0u, 1u, ma < mb);
    let inverse = 1.0 / from_bits(0x3f000000u + mb); // of the mantissa in [1, 2)
    let guess = from_bits(0x3f000000u + ma) * inverse;
    var q = u32(guess * select(8388608.0, 16777216.0, less == 1u));
    let d = i32(mb);
    var r = bitcast<i32>((ma << (23u + less)) - q * mb);
    let off = i32(f32(r) * (inverse * 1.1920929e-7)); // how far off, to within little more than one; 2^-23
    q = bitcast<u32>(bitcast<i32>(q) + off);
    r = r - off * d;
    let step = select(0, 1, 2 * r > d) - select(0, 1, 2 * r < -d);
    q = bitcast<u32>(bitcast<i32>(q) + step);
    r = r - step * d;
    let e = ea - eb + 127 - i32(less);
    if u32(e - 1) < 254u {
        return from_bits(sign | ((u32(e) << 23u) + (q - 0x800000u)));
    }
    if e >= 255 {
        return from_bits(sign | 0x7f800000u);
    }
    // a subnormal result is rounded once, to even, from the floor of the quotient with a guard and a sticky bit
    if r < 0 {
        q = q - 1u;
        r = r + d;
    }
    let wide = (q << 2u) | select(0u, 2u, 2 * r >= d) | select(0u, 1u, r != 0 && 2 * r != d);
    let shift = min(u32(1 - e), 26u) + 2u;
    let rest = wide & ((1u << shift) - 1u);
    let half = 1u << (shift - 1u);
    let m = wide >> shift;
    let up = rest > half || (rest == half && (m & 1u) == 1u);
    return from_bits(sign | (m + select(0u, 1u, up)));
}

// The square root of x
fn op_sqrt(x: f32) -> f32 {
    let u = bitcast<u32>(x);
    var e = i32(u >> 23u);
    var m = (u & 0x7fffffu) | 0x800000u;
    if u - 0x00800000u >= 0x7f000000u { // negative, zero, subnormal, infinite or NaN
        if (u & 0x7fffffffu) == 0u || u == 0x7f800000u {
            return x;
        }
        if u > 0x7f800000u {
            return from_bits(0x7fc00000u);
        }
        let shift = countLeadingZeros(u) - 8u;
        m = u << shift;
        e = 1 - i32(shift);
    }
    let odd = u32(e - 127) & 1u;
    let scaled = from_bits(0x3f000000u + m + (odd << 23u)); // in [1, 4)
    let inverse = inverseSqrt(scaled);
    var s = u32(scaled * inverse * 8388608.0);
    var r = bitcast<i32>((m << (23u + odd)) - s * s);
    let off = i32(f32(r) * (inverse * 5.9604645e-8)); // 2^-24
    r = r - off * (2 * i32(s) + off);
    s = bitcast<u32>(bitcast<i32>(s) + off);
    let step = select(0, 1, r > i32(s)) - select(0, 1, r <= -i32(s));
    s = bitcast<u32>(bitcast<i32>(s) + step);
    let exponent = ((e - 127 - i32(odd)) >> 1u) + 127;
    return from_bits((u32(exponent) << 23u) + (s - 0x800000u));
}

// Minimum, maximum and clamp as those of plain.wgsl, compared as integers: no compiler makes the device's own of them.
fn op_min(a: f32, b: f32) -> f32 {
    return from_bits(select(bitcast<u32>(b), bitcast<u32>(a), is_less(a, b)));
}

fn op_max(a: f32, b: f32) -> f32 {
    return from_bits(select(bitcast<u32>(b), bitcast<u32>(a), is_less(b, a)));
}

fn op_clamp(x: f32, low: f32, high: f32) -> f32 {
    let raised = select(bitcast<u32>(x), bitcast<u32>(low), is_less(x, low));
    return from_bits(select(raised, bitcast<u32>(high), is_less(high, from_bits(raised))));
}

fn is_less(a: f32, b: f32) -> bool {
    let xa = bitcast<i32>(a) & 0x7fffffff;
    let xb = bitcast<i32>(b) & 0x7fffffff;
    let ka = select(xa, -xa, bitcast<i32>(a) < 0);
    let kb = select(xb, -xb, bitcast<i32>(b) < 0);
    return ka < kb && max(xa, xb) <= 0x7f800000;
}

// The float of these bits: a function, since naga refuses constants that are infinite or NaN
fn from_bits(bits: u32) -> f32 {
    return bitcast<f32>(bits);
}
