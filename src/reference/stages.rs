//! The stages of journeys; twin of `shaders/shared/stages.wgsl`, which states the layout.

use super::exact::{dot2, hash_u32, unit_f32};
use crate::kernels::layout::Stage;
use crate::kernels::shared::stages::INNER;

/// Whether a point is in the rectangle of a region.
pub fn in_region(at: [f32; 2], region: &Stage) -> bool {
    let to = [at[0] - region.place[0], at[1] - region.place[1]];
    let (u, v) = (region.along, region.across);
    dot2(to, u).abs() <= dot2(u, u) && dot2(to, v).abs() <= dot2(v, v)
}

/// The place of its own that an agent has in a region.
pub fn own_place(agent: u32, region: &Stage) -> [f32; 2] {
    let begin = hash_u32((region.number as u32).wrapping_add(1));
    let u = (2.0 * unit_f32(agent.wrapping_mul(3_242_174_889).wrapping_add(begin)) - 1.0) * INNER;
    let v = (2.0 * unit_f32(agent.wrapping_mul(2_447_445_414).wrapping_add(hash_u32(begin))) - 1.0) * INNER;
    place_at(region, u, v)
}

/// The nearest point of a region, as far inside as the places in it are.
pub fn nearest_place(at: [f32; 2], region: &Stage) -> [f32; 2] {
    let to = [at[0] - region.place[0], at[1] - region.place[1]];
    let (along, across) = (region.along, region.across);
    let u = (dot2(to, along) / dot2(along, along)).clamp(-INNER, INNER);
    let v = (dot2(to, across) / dot2(across, across)).clamp(-INNER, INNER);
    place_at(region, u, v)
}

/// The point of a region at shares of its half axes.
fn place_at(region: &Stage, u: f32, v: f32) -> [f32; 2] {
    let ([x, z], [ax, az], [bx, bz]) = (region.place, region.along, region.across);
    [x + (u * ax + v * bx), z + (u * az + v * bz)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn region(place: [f32; 2], along: [f32; 2], across: [f32; 2], number: f32) -> Stage {
        Stage { place, along, across, number, ..Stage::default() }
    }

    #[test]
    fn two_hundred_people_have_places_of_their_own_apart_and_inside() {
        let own = region([7.0, -2.0], [5.0, 1.0], [-1.0, 5.0], 3.0);
        let places: Vec<[f32; 2]> = (0..200).map(|agent| own_place(agent, &own)).collect();
        for (i, a) in places.iter().enumerate() {
            assert!(in_region(*a, &own));
            for b in &places[..i] {
                // a lattice of 200 points on this area has its points 0.72 m apart
                assert!((a[0] - b[0]).hypot(a[1] - b[1]) > 0.4, "{a:?} {b:?}");
            }
        }
        assert_ne!(places[0], own_place(0, &Stage { number: 4.0, ..own }), "another stage, another place");
    }

    #[test]
    fn the_nearest_place_of_a_region_is_inside_it_and_straight_ahead() {
        let own = region([0.0, 0.0], [0.0, 2.0], [-1.0, 0.0], 0.0);
        let found = nearest_place([5.0, 1.0], &own);
        assert!((found[0] - 0.9).abs() < 1e-6 && (found[1] - 1.0).abs() < 1e-6, "{found:?}");
        assert!(in_region([1.0, 2.0], &own) && !in_region([1.01, 0.0], &own));
    }
}
