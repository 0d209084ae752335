//! Times until bodies touch, as rates (1 / time, 1/s); twin of `shaders/shared/contact.wgsl`.

use super::exact::{det2, dot2, greater, lesser};
use crate::kernels::shared::contact::{CORNER, NEARLY_TOUCHING};

/// Returns the inverse of the time until a point of velocity `velocity` enters the disc of `radius` m around `to`; 0: never.
/// The result is at most `most`, and `most` for a point inside that goes farther in.
pub fn disc_rate(to: [f32; 2], velocity: [f32; 2], radius: f32, most: f32) -> f32 {
    let b = dot2(to, velocity);
    let c = dot2(to, to) - radius * radius;
    let discriminant = b * b - dot2(velocity, velocity) * c;
    if !(b > 0.0) || discriminant < 0.0 {
        return 0.0;
    }
    lesser((b + discriminant.sqrt()) / greater(c, NEARLY_TOUCHING), most)
}

/// The same for four velocities, without a branch for one of them.
pub fn disc_rates(to: [f32; 2], x: &[f32; 4], y: &[f32; 4], radius: f32, most: f32) -> [f32; 4] {
    let c = dot2(to, to) - radius * radius;
    let b: [f32; 4] = std::array::from_fn(|i| to[0] * x[i] + to[1] * y[i]);
    let discriminant: [f32; 4] = std::array::from_fn(|i| b[i] * b[i] - (x[i] * x[i] + y[i] * y[i]) * c);
    let meets: [bool; 4] = std::array::from_fn(|i| (b[i] > 0.0) & !(discriminant[i] < 0.0));
    if !(meets[0] | meets[1] | meets[2] | meets[3]) {
        return [0.0; 4];
    }
    let gap = greater(c, NEARLY_TOUCHING);
    std::array::from_fn(|i| {
        let root = (if meets[i] { discriminant[i] } else { 0.0 }).sqrt();
        let rate = lesser((b[i] + root) / gap, most);
        if meets[i] { rate } else { 0.0 }
    })
}

/// Until a disc of `radius` m on the open side of a wall touches it; `to_a` and `to_b` lead to the wall's ends, `along` is
/// its unit direction.
pub fn segment_rate(
    to_a: [f32; 2],
    to_b: [f32; 2],
    along: [f32; 2],
    velocity: [f32; 2],
    radius: f32,
    most: f32,
) -> f32 {
    let gap = greater(det2(along, to_a) - radius, NEARLY_TOUCHING);
    let inward = det2(along, velocity);
    let mut rate = 0.0;
    if inward > 0.0 {
        let s = dot2(along, velocity) * (gap / inward) - dot2(along, to_a);
        if s >= 0.0 && s <= dot2(along, [to_b[0] - to_a[0], to_b[1] - to_a[1]]) {
            rate = lesser(inward / gap, most);
        }
    }
    rate = greater(rate, disc_rate(to_a, velocity, radius * CORNER, most));
    greater(rate, disc_rate(to_b, velocity, radius * CORNER, most))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_is_reached_after_the_gap_over_the_speed_and_never_when_passing_or_leaving() {
        assert!((disc_rate([5.0, 0.0], [2.0, 0.0], 1.0, 30.0) - 0.5).abs() < 1e-6);
        assert_eq!(disc_rate([5.0, 0.0], [-2.0, 0.0], 1.0, 30.0), 0.0);
        assert_eq!(disc_rate([5.0, 2.0], [2.0, 0.0], 1.0, 30.0), 0.0);
        assert_eq!(disc_rate([0.5, 0.0], [2.0, 0.0], 1.0, 30.0), 30.0, "inside and farther in");
        assert_eq!(disc_rate([0.5, 0.0], [-2.0, 0.0], 1.0, 30.0), 0.0, "inside and out");
        let (x, y) = ([2.0, -2.0, 0.3, 1.0], [0.0, 0.1, 0.9, 0.2]);
        for to in [[5.0, 0.0], [0.5, 0.1], [1.0, 0.0]] {
            let one = |i: usize| disc_rate(to, [x[i], y[i]], 1.0, 30.0);
            assert_eq!(disc_rates(to, &x, &y, 1.0, 30.0), [one(0), one(1), one(2), one(3)], "four at a time");
        }
    }

    #[test]
    fn a_wall_is_reached_in_its_middle_at_its_ends_and_not_beside_it() {
        // solid above: the wall runs along +x, its open side is z < 0
        let rate = |at: [f32; 2], v| {
            let (to_a, to_b) = ([-at[0], -at[1]], [4.0 - at[0], -at[1]]);
            segment_rate(to_a, to_b, [1.0, 0.0], v, 0.5, 30.0)
        };
        assert!((rate([2.0, -2.5], [0.0, 1.0]) - 0.5).abs() < 1e-6);
        assert_eq!(rate([2.0, -2.5], [1.0, 0.0]), 0.0, "along");
        assert_eq!(rate([2.0, -2.5], [0.0, -1.0]), 0.0, "away");
        assert_eq!(rate([5.0, -2.5], [0.0, 1.0]), 0.0, "beside");
        assert!(rate([4.3, -2.5], [0.0, 1.0]) > 0.0, "the corner");
        assert_eq!(rate([2.0, -0.5], [0.0, 1.0]), 30.0, "touching");
    }
}
