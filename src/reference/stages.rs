//! The stages of journeys; twin of `shaders/shared/stages.wgsl`, which states the layout.

use super::exact::{dot2, hash_u32, unit_f32};
use crate::kernels::shared::stages::index::STAGE_STRIDE;
use crate::kernels::shared::stages::{INNER, WAYPOINT};

/// A waypoint as it lies in `stages`; x, z and radius in m.
pub const fn waypoint(x: f32, z: f32, radius: f32) -> [[f32; 4]; STAGE_STRIDE] {
    [[x, z, radius, WAYPOINT], [0.0; 4], [-1.0, 0.0, 0.0, 0.0], [0.0; 4]]
}

/// Whether a point is in the rectangle of a region.
pub fn in_region(at: [f32; 2], middle: [f32; 2], axes: [f32; 4]) -> bool {
    let to = [at[0] - middle[0], at[1] - middle[1]];
    let (u, v) = ([axes[0], axes[1]], [axes[2], axes[3]]);
    dot2(to, u).abs() <= dot2(u, u) && dot2(to, v).abs() <= dot2(v, v)
}

/// The place of its own that an agent has in a region.
pub fn own_place(agent: u32, number: u32, middle: [f32; 2], axes: [f32; 4]) -> [f32; 2] {
    let begin = hash_u32(number.wrapping_add(1));
    let u = (2.0 * unit_f32(agent.wrapping_mul(3_242_174_889).wrapping_add(begin)) - 1.0) * INNER;
    let v = (2.0 * unit_f32(agent.wrapping_mul(2_447_445_414).wrapping_add(hash_u32(begin))) - 1.0) * INNER;
    [middle[0] + (u * axes[0] + v * axes[2]), middle[1] + (u * axes[1] + v * axes[3])]
}

/// The nearest point of a region, as far inside as the places in it are.
pub fn nearest_place(at: [f32; 2], middle: [f32; 2], axes: [f32; 4]) -> [f32; 2] {
    let to = [at[0] - middle[0], at[1] - middle[1]];
    let ([ux, uz], [vx, vz]) = ([axes[0], axes[1]], [axes[2], axes[3]]);
    let u = (dot2(to, [ux, uz]) / dot2([ux, uz], [ux, uz])).clamp(-INNER, INNER);
    let v = (dot2(to, [vx, vz]) / dot2([vx, vz], [vx, vz])).clamp(-INNER, INNER);
    [middle[0] + (u * ux + v * vx), middle[1] + (u * uz + v * vz)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_hundred_people_have_places_of_their_own_apart_and_inside() {
        let axes = [5.0, 1.0, -1.0, 5.0];
        let places: Vec<[f32; 2]> = (0..200).map(|agent| own_place(agent, 3, [7.0, -2.0], axes)).collect();
        for (i, a) in places.iter().enumerate() {
            assert!(in_region(*a, [7.0, -2.0], axes));
            for b in &places[..i] {
                // a lattice of 200 points on this area has its points 0.72 m apart
                assert!((a[0] - b[0]).hypot(a[1] - b[1]) > 0.4, "{a:?} {b:?}");
            }
        }
        assert_ne!(places[0], own_place(0, 4, [7.0, -2.0], axes), "another stage, another place");
    }

    #[test]
    fn the_nearest_place_of_a_region_is_inside_it_and_straight_ahead() {
        let axes = [0.0, 2.0, -1.0, 0.0];
        let found = nearest_place([5.0, 1.0], [0.0, 0.0], axes);
        assert!((found[0] - 0.9).abs() < 1e-6 && (found[1] - 1.0).abs() < 1e-6, "{found:?}");
        assert!(in_region([1.0, 2.0], [0.0, 0.0], axes) && !in_region([1.01, 0.0], [0.0, 0.0], axes));
    }
}
