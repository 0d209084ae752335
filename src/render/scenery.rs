//! What of an environment a view draws, and in which order: near things as they are, far ones by fewer triangles; then what lies flat.

use super::camera::View;
use super::parts::{self, Part};
use crate::scenario::Distant;
use glam::{Mat4, Vec3, Vec4};
use std::collections::BTreeMap;

/// Size of the smallest things that are left out from afar, m: windows are set back so far.
const SMALLEST: f32 = 0.14;
/// They are left out where they have fewer pixels than this.
const PIXELS: f32 = 6.0;

/// The parts of an environment.
#[derive(Debug, Default)]
pub(super) struct Scenery {
    things: Vec<Thing>,
    /// What is drawn at any distance, and stands.
    standing: Vec<Part>,
    /// What lies flat, the upper layers first: they hide the others. It casts no shadow.
    flat: Vec<Part>,
}

/// A thing that is drawn in one of two ways.
#[derive(Debug)]
struct Thing {
    near: Vec<Part>,
    far: Vec<Part>,
    low: Vec3,
    high: Vec3,
}

/// From where an environment is looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight<'a> {
    eyes: &'a [Vec3],
    /// Pixels of a metre at a distance of 1 m; of a map, at any distance.
    focal: f32,
    is_map: bool,
}

impl<'a> Sight<'a> {
    /// Of a view whose images have so many rows.
    pub(super) fn of(view: &'a View, rows: u32) -> Self {
        let eyes = &view.eyes[..view.eye_count.clamp(1, 2) as usize];
        Self { eyes, focal: view.focal(rows), is_map: view.parallel }
    }

    /// How far a box is from the nearer eye, m.
    fn distance(&self, low: Vec3, high: Vec3) -> f32 {
        let off = self.eyes.iter().map(|eye| eye.distance(eye.clamp(low, high)));
        off.fold(f32::INFINITY, f32::min)
    }

    /// Whether small parts of what is so far away, m, cannot be seen.
    fn is_far(&self, distance: f32) -> bool {
        SMALLEST * self.focal < PIXELS * if self.is_map { 1.0 } else { distance }
    }
}

impl Scenery {
    /// Sorts triangles into parts: all indices in a new order, and the parts. `corner` is where a vertex is, m, and its layer (see
    /// [`crate::scenario::EnvironmentMesh::layers`]).
    ///
    /// None when a range of `distant` lies beyond its list, or begins before the one ahead of it ends.
    pub(super) fn new(
        corner: impl Fn(u32) -> Vec4,
        indices: &[u32],
        far_indices: &[u32],
        distant: &[Distant],
    ) -> Option<(Vec<u32>, Self)> {
        let (mut sorted, mut scenery) = (Vec::new(), Self::default());
        let place = |index: u32| corner(index).truncate();
        let add = |sorted: &mut Vec<u32>, indices: &[u32]| {
            let first = u32::try_from(sorted.len()).unwrap_or(u32::MAX);
            let (part, parts) = parts::split(place, indices);
            sorted.extend(part);
            parts.into_iter().map(|part| part.behind(first)).collect::<Vec<_>>()
        };
        let (mut always, mut done) = (Vec::new(), 0);
        for thing in distant {
            let (near, far) = (indices.get(thing.near.clone())?, far_indices.get(thing.far.clone())?);
            always.extend(indices.get(done..thing.near.start)?);
            done = thing.near.end;
            let corners = || near.iter().chain(far).map(|index| place(*index));
            let (low, high) = (corners().fold(Vec3::MAX, Vec3::min), corners().fold(Vec3::MIN, Vec3::max));
            let (near, far) = (add(&mut sorted, near), add(&mut sorted, far));
            scenery.things.push(Thing { near, far, low, high });
        }
        always.extend(indices.get(done..)?);
        let mut layers: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for triangle in always.as_chunks::<3>().0 {
            let layer = triangle.map(|index| corner(index).w).into_iter().fold(f32::INFINITY, f32::min);
            layers.entry(layer.max(0.0).to_bits()).or_default().extend(triangle);
        }
        for (layer, triangles) in &layers {
            let parts = if *layer == 0 { &mut scenery.standing } else { &mut scenery.flat };
            parts.extend(add(&mut sorted, triangles));
        }
        Some((sorted, scenery))
    }

    /// The ranges of indices that are drawn, first and count: what lies in the clip space of one of these matrices. Things come from
    /// near to far, and then the ground, so that what they hide is not shaded.
    pub(super) fn seen(&self, clip_from_world: &[Mat4], sight: &Sight<'_>) -> Vec<(u32, u32)> {
        parts::seen(self.standing(sight).chain(&self.flat), clip_from_world)
    }

    /// The same of what casts shadows, by the clip space of the sun.
    pub(super) fn casting(&self, clip_from_sun: &Mat4, sight: &Sight<'_>) -> Vec<(u32, u32)> {
        parts::seen(self.standing(sight), std::slice::from_ref(clip_from_sun))
    }

    fn standing(&self, sight: &Sight<'_>) -> impl Iterator<Item = &Part> {
        let mut things: Vec<(f32, &Thing)> =
            self.things.iter().map(|thing| (sight.distance(thing.low, thing.high), thing)).collect();
        things.sort_by(|a, b| a.0.total_cmp(&b.0));
        let is_far = things.into_iter().map(|(distance, thing)| (sight.is_far(distance), thing));
        is_far.flat_map(|(is_far, thing)| if is_far { &thing.far } else { &thing.near }).chain(&self.standing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Camera;
    use glam::Vec2;

    /// Three triangles side by side, and one that stands for the second.
    fn three() -> (Vec<Vec3>, Vec<u32>, Vec<u32>, Vec<Distant>) {
        let triangle =
            |x: f32| [Vec3::new(x, 0.0, 0.0), Vec3::new(x + 1.0, 0.0, 0.0), Vec3::new(x, 1.0, 0.0)];
        let corners = [triangle(0.0), triangle(1.0), triangle(2.0), triangle(1.0)].concat();
        (corners, (0..9).collect(), vec![9, 10, 11], vec![Distant { near: 3..6, far: 0..3 }])
    }

    fn drawn(sorted: &[u32], ranges: &[(u32, u32)]) -> Vec<u32> {
        let mut drawn: Vec<u32> = ranges
            .iter()
            .flat_map(|(first, count)| sorted[*first as usize..(*first + *count) as usize].to_vec())
            .collect();
        drawn.sort_unstable();
        drawn
    }

    #[test]
    fn what_is_far_is_drawn_by_what_stands_for_it_and_nothing_twice() {
        let (corners, indices, far, distant) = three();
        let corner = |index: u32| corners[index as usize].extend(0.0);
        let (sorted, scenery) = Scenery::new(corner, &indices, &far, &distant).unwrap();
        let seen = |view: &View, rows| {
            drawn(&sorted, &scenery.seen(&view.clip_from_world[..1], &Sight::of(view, rows)))
        };
        let from = |distance: f32, rows: u32| {
            let camera = Camera::user_eyes(Vec3::new(1.0, 0.5, -distance), 0.0, 0.0);
            seen(&View::mono(&camera, rows, rows), rows)
        };
        let (near, far) = ((0..9).collect::<Vec<u32>>(), vec![0, 1, 2, 6, 7, 8, 9, 10, 11]);
        // 772 pixels a metre at a metre: 14 cm are 6 pixels at 18 m
        assert_eq!((from(17.9, 720), from(18.1, 720)), (near.clone(), far.clone()));
        assert_eq!((from(8.9, 360), from(9.1, 360)), (near.clone(), far.clone()), "a smaller picture");
        // a map of 16 m has 45 pixels a metre, one of 60 m 12
        let map = |height| seen(&View::mono(&Camera::top(Vec2::new(1.0, 0.0), height), 720, 720), 720);
        assert_eq!((map(16.0), map(60.0)), (near, far));
    }

    #[test]
    fn the_nearer_of_two_eyes_says_how_far_a_thing_is() {
        let eyes = [Vec3::ZERO, Vec3::X * 10.0];
        let sight = |eyes| Sight { eyes, focal: 772.0, is_map: false };
        let far = |sight: Sight<'_>| {
            sight.is_far(sight.distance(Vec3::new(25.0, -1.0, -1.0), Vec3::new(35.0, 1.0, 1.0)))
        };
        assert!(far(sight(&eyes[..1])) && !far(sight(&eyes)));
    }

    #[test]
    fn near_things_are_drawn_before_far_ones() {
        let (corners, indices, _, _) = three();
        let corner = |index: u32| corners[index as usize].extend(0.0);
        // two things, each drawn the same way near and far, and the first triangle always
        let distant = vec![Distant { near: 3..6, far: 0..3 }, Distant { near: 6..9, far: 3..6 }];
        let (sorted, scenery) = Scenery::new(corner, &indices, &indices[3..9], &distant).unwrap();
        let order = |x: f32| {
            let camera = Camera::user_eyes(Vec3::new(x, 0.5, -6.0), 0.0, 0.0);
            let view = View::mono(&camera, 720, 720);
            let ranges = scenery.seen(&view.clip_from_world[..1], &Sight::of(&view, 720));
            ranges
                .iter()
                .flat_map(|(first, count)| sorted[*first as usize..(*first + *count) as usize].to_vec())
                .collect::<Vec<u32>>()
        };
        assert_eq!(order(0.5), [3, 4, 5, 6, 7, 8, 0, 1, 2]);
        assert_eq!(order(3.0), [6, 7, 8, 3, 4, 5, 0, 1, 2]);
    }

    #[test]
    fn upper_layers_are_drawn_before_lower_ones_and_cast_no_shadow() {
        let (corners, indices, _, _) = three();
        let layers = [2.0, 1.0, 0.0];
        let corner = |index: u32| corners[index as usize].extend(layers[index as usize / 3]);
        let (sorted, scenery) = Scenery::new(corner, &indices, &[], &[]).unwrap();
        let camera = Camera::user_eyes(Vec3::new(1.0, 0.5, -6.0), 0.0, 0.0);
        let view = View::mono(&camera, 720, 720);
        let (clip, sight) = (&view.clip_from_world[..1], Sight::of(&view, 720));
        assert_eq!(sorted, [6, 7, 8, 3, 4, 5, 0, 1, 2]);
        assert_eq!(scenery.seen(clip, &sight), [(0, 9)]);
        assert_eq!(scenery.casting(&clip[0], &sight), [(0, 3)]);
    }

    #[test]
    fn ranges_beyond_their_lists_are_refused() {
        let (corners, indices, far, _) = three();
        let corner = |index: u32| corners[index as usize].extend(0.0);
        for distant in [
            vec![Distant { near: 3..12, far: 0..3 }],
            vec![Distant { near: 3..6, far: 0..6 }],
            vec![Distant { near: 3..6, far: 0..3 }, Distant { near: 0..3, far: 0..3 }],
        ] {
            assert!(Scenery::new(corner, &indices, &far, &distant).is_none(), "{distant:?}");
        }
    }
}
