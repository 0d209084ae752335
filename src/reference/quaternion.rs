//! Twin of `shaders/shared/quaternion.wgsl`: vectors and quaternions (x, y, z, w), every sum written out from left
//! to right. A quaternion `b_from_a` turns vectors of frame a into frame b; products read right to left.

use super::exact::sin_cos;

/// x kept in [low, high].
pub fn limit(x: f32, low: f32, high: f32) -> f32 {
    if x > high {
        high
    } else if x < low {
        low
    } else {
        x
    }
}

/// a + b.
pub fn add3(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// a - b.
pub fn sub3(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// a times s.
pub fn scale3(a: [f32; 3], s: f32) -> [f32; 3] {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// a + b.
pub fn add4([ax, ay, az, aw]: [f32; 4], [bx, by, bz, bw]: [f32; 4]) -> [f32; 4] {
    [ax + bx, ay + by, az + bz, aw + bw]
}

/// a times s.
pub fn scale4([x, y, z, w]: [f32; 4], s: f32) -> [f32; 4] {
    [x * s, y * s, z * s, w * s]
}

/// -a.
pub fn negate4([x, y, z, w]: [f32; 4]) -> [f32; 4] {
    [-x, -y, -z, -w]
}

/// The first three components.
pub fn xyz([x, y, z, _]: [f32; 4]) -> [f32; 3] {
    [x, y, z]
}

/// Dot product.
pub fn dot3(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Cross product.
pub fn cross3(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Dot product.
pub fn dot4([ax, ay, az, aw]: [f32; 4], [bx, by, bz, bw]: [f32; 4]) -> f32 {
    ax * bx + ay * by + az * bz + aw * bw
}

/// The inverse of a unit quaternion.
pub fn quat_conjugate([x, y, z, w]: [f32; 4]) -> [f32; 4] {
    [-x, -y, -z, w]
}

/// First b, then a.
pub fn quat_mul([ax, ay, az, aw]: [f32; 4], [bx, by, bz, bw]: [f32; 4]) -> [f32; 4] {
    [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
}

/// q / |q|; no rotation when q is (nearly) zero.
pub fn quat_normalize(q: [f32; 4]) -> [f32; 4] {
    let square = dot4(q, q);
    if square > 1e-12 {
        return scale4(q, 1.0 / square.sqrt());
    }
    [0.0, 0.0, 0.0, 1.0]
}

/// v turned by the unit quaternion q.
pub fn quat_rotate(q: [f32; 4], v: [f32; 3]) -> [f32; 3] {
    let [x, y, z, w] = q;
    let axis = [x, y, z];
    let t = cross3(axis, v);
    let twice = add3(t, t);
    add3(add3(v, scale3(twice, w)), cross3(axis, twice))
}

/// From a to b along the shorter way, not normalised.
pub fn quat_lerp(a: [f32; 4], b: [f32; 4], t: f32) -> [f32; 4] {
    let near = if dot4(a, b) < 0.0 { negate4(b) } else { b };
    lerp4(a, near, t)
}

/// From a to b.
pub fn lerp4(a: [f32; 4], b: [f32; 4], t: f32) -> [f32; 4] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t)
}

/// First turned by `pitch` about x (chin down), then by `yaw` about y (to the left), radians.
pub fn quat_yaw_pitch(yaw: f32, pitch: f32) -> [f32; 4] {
    let [ys, yc] = sin_cos(yaw * 0.5);
    let [xs, xc] = sin_cos(pitch * 0.5);
    [yc * xs, ys * xc, -(ys * xs), yc * xc]
}

/// A vector turned to the left about y by the angle of (sine, cosine).
pub fn turn_left([s, c]: [f32; 2], v: [f32; 3]) -> [f32; 3] {
    [c * v[0] + s * v[2], v[1], c * v[2] - s * v[0]]
}

/// q, then turned to the left about y by `yaw` radians.
pub fn quat_before_yaw(yaw: f32, [x, y, z, w]: [f32; 4]) -> [f32; 4] {
    let [s, c] = sin_cos(yaw * 0.5);
    [c * x + s * z, c * y + s * w, c * z - s * x, c * w - s * y]
}

/// Turned to the left about y by `yaw` radians, then q.
pub fn quat_after_yaw([x, y, z, w]: [f32; 4], yaw: f32) -> [f32; 4] {
    let [s, c] = sin_cos(yaw * 0.5);
    [x * c - z * s, y * c + w * s, z * c + x * s, w * c - y * s]
}

/// The rotation of a matrix given by rows, which may carry one scale for all axes.
pub fn quat_from_rows(row_x: [f32; 3], row_y: [f32; 3], row_z: [f32; 3]) -> [f32; 4] {
    let square = dot3(row_x, row_x);
    if !(square > 1e-12) {
        return [0.0, 0.0, 0.0, 1.0];
    }
    let scale = square.sqrt();
    let [x, y, z] = [row_x, row_y, row_z].map(|row| row.map(|m| m / scale));
    // the largest of the four components decides the way, so that nothing small is divided by
    if x[0] + y[1] + z[2] > 0.0 {
        return quat_normalize([z[1] - y[2], x[2] - z[0], y[0] - x[1], 1.0 + x[0] + y[1] + z[2]]);
    }
    if x[0] > y[1] && x[0] > z[2] {
        return quat_normalize([1.0 + x[0] - y[1] - z[2], x[1] + y[0], x[2] + z[0], z[1] - y[2]]);
    }
    if y[1] > z[2] {
        return quat_normalize([x[1] + y[0], 1.0 - x[0] + y[1] - z[2], y[2] + z[1], x[2] - z[0]]);
    }
    quat_normalize([x[2] + z[0], y[2] + z[1], 1.0 - x[0] - y[1] + z[2], y[0] - x[1]])
}

/// First to the right by `roll` about z (positive: the left side rises), then forwards by `pitch` about x, rad.
pub fn quat_pitch_roll(pitch: f32, roll: f32) -> [f32; 4] {
    let [xs, xc] = sin_cos(pitch * 0.5);
    let [zs, zc] = sin_cos(roll * 0.5);
    [xs * zc, -(xs * zs), xc * zs, xc * zc]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::exact::{hash_u32, unit_f32};
    use glam::{Mat3, Quat, Vec3};

    fn random_quat(seed: u32) -> Quat {
        let part = |i: u32| unit_f32(hash_u32(seed * 4 + i)) - 0.5;
        Quat::from_xyzw(part(0), part(1), part(2), part(3)).normalize()
    }

    #[test]
    fn products_rotations_and_matrices_agree_with_glam() {
        for seed in 0..1000 {
            let (a, b) = (random_quat(seed), random_quat(seed + 7777));
            let v = Vec3::new(1.0, -2.0, 0.5);
            assert!(Quat::from_array(quat_mul(a.to_array(), b.to_array())).dot(a * b).abs() > 0.999_999);
            assert!((Vec3::from(quat_rotate(a.to_array(), v.to_array())) - a * v).length() < 2e-6);
            let yaw = Quat::from_rotation_y(0.7);
            assert!(Quat::from_array(quat_before_yaw(0.7, a.to_array())).dot(yaw * a).abs() > 0.999_999);
            assert!(Quat::from_array(quat_after_yaw(a.to_array(), 0.7)).dot(a * yaw).abs() > 0.999_999);
            assert!((Vec3::from(turn_left(sin_cos(0.7), v.to_array())) - yaw * v).length() < 2e-6);
            let m = Mat3::from_quat(a) * 3.0;
            let rows = [m.row(0), m.row(1), m.row(2)].map(|row| row.to_array());
            assert!(Quat::from_array(quat_from_rows(rows[0], rows[1], rows[2])).dot(a).abs() > 0.999_999);
        }
    }

    #[test]
    fn yaw_turns_left_and_pitch_lowers_the_chin() {
        let face = quat_rotate(quat_yaw_pitch(0.5, 0.25), [0.0, 0.0, 1.0]);
        let want =
            Vec3::new(0.5_f32.sin() * 0.25_f32.cos(), -(0.25_f32.sin()), 0.5_f32.cos() * 0.25_f32.cos());
        assert!((Vec3::from(face) - want).length() < 1e-6);
    }

    #[test]
    fn a_zero_quaternion_and_a_zero_matrix_are_no_rotation() {
        assert_eq!(quat_normalize([0.0; 4]), [0.0, 0.0, 0.0, 1.0]);
        assert_eq!(quat_from_rows([0.0; 3], [0.0; 3], [0.0; 3]), [0.0, 0.0, 0.0, 1.0]);
    }
}
