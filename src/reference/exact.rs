//! Twin of `shaders/shared/exact.wgsl`: the same operations in the same order.
#![allow(clippy::excessive_precision, clippy::approx_constant, reason = "the shader's own literals")]

use crate::kernels::shared::exact::FAINT;

/// The lesser of two, as in `operations/plain.wgsl`: the second, unless the first is less. `f32::min` may return either of two
/// zeros.
pub fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater of two: the second, unless the first is greater.
pub fn greater(a: f32, b: f32) -> f32 {
    if b < a { a } else { b }
}

/// `(sin x, cos x)`.
pub fn sin_cos(x: f32) -> [f32; 2] {
    let k = (x * 0.636_619_75 + 0.5).floor();
    let r = ((x - k * 1.570_312_5) - k * 4.837_513e-4) - k * 7.549_79e-8;
    let quadrant = k as i32 & 3;
    let z = r * r;
    let s = r + r * z * (-0.166_666_55 + z * (0.008_332_161 + z * -0.000_195_152_96));
    let c = (1.0 - 0.5 * z) + z * z * (0.041_666_646 + z * (-0.001_388_731_6 + z * 2.443_315_7e-5));
    let even = quadrant & 1 == 0;
    let (sine, cosine) = if even { (s, c) } else { (c, s) };
    [if quadrant & 2 == 0 { sine } else { -sine }, if (quadrant + 1) & 2 == 0 { cosine } else { -cosine }]
}

/// Angle of (x, y) in (-pi, pi]; 0 at the origin.
pub fn atan2(y: f32, x: f32) -> f32 {
    let (ax, ay) = (x.abs(), y.abs());
    let (high, low) = (greater(ax, ay), lesser(ax, ay));
    if high == 0.0 {
        return 0.0;
    }
    let a = low / high;
    let z = a * a;
    let p = 1.0
        + z * (-0.333_330_36
            + z * (0.199_918_72
                + z * (-0.141_977_98
                    + z * (0.106_183_71
                        + z * (-0.074_568_55
                            + z * (0.042_137_623 + z * (-0.015_731_249 + z * 0.002_766_283_5)))))));
    let mut angle = a * p;
    if ay > ax {
        angle = 1.570_796_4 - angle;
    }
    if x < 0.0 {
        angle = 3.141_592_7 - angle;
    }
    if y < 0.0 { -angle } else { angle }
}

/// Arc cosine of x clamped to [-1, 1].
pub fn acos(x: f32) -> f32 {
    let c = x.clamp(-1.0, 1.0);
    atan2(((1.0 - c) * (1.0 + c)).sqrt(), c)
}

/// Arc sine of x clamped to [-1, 1].
pub fn asin(x: f32) -> f32 {
    let s = x.clamp(-1.0, 1.0);
    atan2(s, ((1.0 - s) * (1.0 + s)).sqrt())
}

/// 2 to the x, x clamped to [-126, 127].
pub fn exp2(x: f32) -> f32 {
    let c = x.clamp(-126.0, 127.0);
    let k = (c + 0.5).floor();
    let f = c - k;
    let p = 1.0
        + f * (0.693_147_2
            + f * (0.240_226_5
                + f * (0.055_503_27 + f * (0.009_618_057 + f * (0.001_340_042_8 + f * 0.000_154_614_45)))));
    p * f32::from_bits(((k as i32 + 127) as u32) << 23)
}

/// Angle brought to (-pi, pi].
pub fn wrap(angle: f32) -> f32 {
    angle - 6.283_185_5 * (angle * 0.159_154_94 + 0.5).floor()
}

/// Dot product.
pub fn dot2(a: [f32; 2], b: [f32; 2]) -> f32 {
    a[0] * b[0] + a[1] * b[1]
}

/// Twice the signed area of the triangle (0, a, b).
pub fn det2(a: [f32; 2], b: [f32; 2]) -> f32 {
    a[0] * b[1] - a[1] * b[0]
}

/// A well-mixed u32 from a u32.
pub fn hash_u32(value: u32) -> u32 {
    let mut x = value;
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Uniform in [0, 1) with 24 bits.
pub fn unit_f32(bits: u32) -> f32 {
    (bits >> 8) as f32 * 5.960_464_5e-8
}

/// Neither NaN nor huge.
pub fn is_finite2(v: [f32; 2]) -> bool {
    v[0].abs() < 1e30 && v[1].abs() < 1e30
}

/// What fades to nothing ends there: devices differ in whether they keep subnormal numbers.
pub fn unless_faint(x: f32) -> f32 {
    if x.abs() < FAINT { 0.0 } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_stay_within_what_the_header_states() {
        for i in -200_000..200_000_i32 {
            let x = i as f32 * 5e-4;
            let [s, c] = sin_cos(x);
            assert!((f64::from(s) - f64::from(x).sin()).abs() < 1.2e-7, "sin {x}");
            assert!((f64::from(c) - f64::from(x).cos()).abs() < 1.2e-7, "cos {x}");
            let y = (i as f32 * 0.37).rem_euclid(7.0) - 3.5;
            assert!(
                (f64::from(atan2(x, y)) - f64::from(x).atan2(f64::from(y))).abs() < 4e-7,
                "atan2 {x} {y}"
            );
            let u = i as f32 / 200_000.0;
            assert!((f64::from(acos(u)) - f64::from(u).acos()).abs() < 4e-7, "acos {u}");
            assert!((f64::from(asin(u)) - f64::from(u).asin()).abs() < 4e-7, "asin {u}");
            assert!((f64::from(exp2(x)) / f64::from(x).exp2() - 1.0).abs() < 3e-7, "exp2 {x}");
            assert!(wrap(x).abs() <= 3.141_594);
        }
        assert_eq!(atan2(0.0, 0.0), 0.0);
    }
}
