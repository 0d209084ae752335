//! Who stands under the pointer: a ray against upright cylinders, and against the scenery that hides them.

use crate::ground::is_absent;
use crate::scenario::EnvironmentMesh;
use glam::{Vec2, Vec3};

/// Least radius that is clicked at, m: limbs reach beyond the disc that others avoid.
const LEAST_RADIUS: f32 = 0.3;

/// A ray in the world: where it begins, and its unit direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it begins, m.
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
}

/// An upright cylinder around a person.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pillar {
    /// Ground position (x, z), m.
    pub position: [f32; 2],
    /// Height of the floor stood on, m.
    pub foot: f32,
    /// Radius, m.
    pub radius: f32,
    /// Height, m.
    pub height: f32,
}

/// Distance along a ray at which it enters a pillar, m; 0 from inside; `None` when it misses or the pillar is behind.
pub fn enters(ray: &Ray, pillar: &Pillar) -> Option<f32> {
    let radius = pillar.radius.max(LEAST_RADIUS);
    let from = Vec2::new(ray.origin.x, ray.origin.z) - Vec2::from_array(pillar.position);
    let along = Vec2::new(ray.direction.x, ray.direction.z);
    // within the disc: |from + t along| <= radius
    let (a, b, c) = (along.length_squared(), from.dot(along), from.length_squared() - radius * radius);
    let disc = if a > 1e-12 {
        let root = b * b - a * c;
        (root >= 0.0).then(|| [(-b - root.sqrt()) / a, (-b + root.sqrt()) / a])?
    } else if c <= 0.0 {
        [f32::NEG_INFINITY, f32::INFINITY] // straight down
    } else {
        return None;
    };
    // within the slab between foot and head
    let (low, high) = (pillar.foot - ray.origin.y, pillar.foot + pillar.height - ray.origin.y);
    let slab = if ray.direction.y.abs() > 1e-12 {
        let (a, b) = (low / ray.direction.y, high / ray.direction.y);
        [a.min(b), a.max(b)]
    } else if low <= 0.0 && high >= 0.0 {
        [f32::NEG_INFINITY, f32::INFINITY]
    } else {
        return None;
    };
    let (enter, leave) = (disc[0].max(slab[0]).max(0.0), disc[1].min(slab[1]));
    (enter <= leave).then_some(enter)
}

/// The first pillar that a ray enters, nearer than `farthest`: its number and distance, m. An absent person is
/// not there.
pub fn first(ray: &Ray, pillars: impl Iterator<Item = Pillar>, farthest: f32) -> Option<(usize, f32)> {
    pillars
        .enumerate()
        .filter(|(_, pillar)| !is_absent(pillar.position))
        .filter_map(|(number, pillar)| enters(ray, &pillar).map(|distance| (number, distance)))
        .filter(|(_, distance)| *distance < farthest)
        .min_by(|(_, a), (_, b)| a.total_cmp(b))
}

/// Distance along a ray to the first triangle of the scenery, m; infinite when there is none.
pub fn wall(ray: &Ray, mesh: &EnvironmentMesh) -> f32 {
    let nearest = |indices: &[u32], corner: &dyn Fn(usize) -> Option<Vec3>| {
        let hits = indices.chunks_exact(3).filter_map(|three| {
            let [a, b, c] = [0, 1, 2].map(|k| corner(three[k] as usize));
            meets(ray, [a?, b?, c?])
        });
        hits.fold(f32::INFINITY, f32::min)
    };
    let scenery = nearest(&mesh.indices, &|index| mesh.positions.get(index).copied());
    let Some(place) = &mesh.place else { return scenery };
    let corner = |index: usize| place.vertices.get(index).map(|vertex| vertex.position);
    scenery.min(nearest(&place.solid, &corner)).min(nearest(&place.open, &corner))
}

/// Distance at which a ray meets a triangle (Möller and Trumbore 1997), from either side.
fn meets(ray: &Ray, [a, b, c]: [Vec3; 3]) -> Option<f32> {
    let (ab, ac) = (b - a, c - a);
    let p = ray.direction.cross(ac);
    let determinant = ab.dot(p);
    if determinant.abs() < 1e-12 {
        return None;
    }
    let to = ray.origin - a;
    let u = to.dot(p) / determinant;
    let q = to.cross(ab);
    let v = ray.direction.dot(q) / determinant;
    let distance = ac.dot(q) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn pillar(x: f32, z: f32) -> Pillar {
        Pillar { position: [x, z], foot: 0.0, radius: 0.3, height: 1.8 }
    }

    fn ray(origin: Vec3, at: Vec3) -> Ray {
        Ray { origin, direction: (at - origin).normalize() }
    }

    #[test]
    fn the_nearest_of_those_in_line_is_picked_whatever_their_order() {
        let eye = ray(Vec3::new(0.0, 1.5, 10.0), Vec3::new(0.0, 1.0, 0.0));
        let people = [pillar(0.0, -5.0), pillar(0.1, 2.0), pillar(0.0, 12.0), pillar(1.0, 4.0)];
        let (number, distance) = first(&eye, people.into_iter(), f32::INFINITY).unwrap();
        assert_eq!(number, 1);
        assert!((distance - 7.72).abs() < 0.03, "{distance}: a hair before the disc's near side");
        let back = people.into_iter().rev();
        assert_eq!(first(&eye, back, f32::INFINITY).unwrap().0, 2);
    }

    #[test]
    fn rays_that_pass_over_beside_or_away_pick_no_one() {
        let one = || std::iter::once(pillar(0.0, 0.0));
        let eye = Vec3::new(0.0, 1.5, 10.0);
        for (at, want) in [
            (Vec3::new(0.0, 1.75, 0.3), true),
            (Vec3::new(0.0, 1.95, 0.3), false),
            (Vec3::new(0.28, 1.0, 0.0), true),
            (Vec3::new(0.4, 1.0, 0.0), false),
            (Vec3::new(0.0, 1.5, 20.0), false),
        ] {
            assert_eq!(first(&ray(eye, at), one(), f32::INFINITY).is_some(), want, "{at}");
        }
        assert!(first(&ray(eye, Vec3::Y), one(), 9.0).is_none(), "something stands in between");
    }

    #[test]
    fn from_above_and_from_inside_and_on_a_bridge() {
        let above = ray(Vec3::new(0.1, 30.0, 0.0), Vec3::new(0.1, 0.0, 0.0));
        assert!((enters(&above, &pillar(0.0, 0.0)).unwrap() - 28.2).abs() < 1e-4);
        assert!(enters(&above, &pillar(0.5, 0.0)).is_none());
        let level = Ray { origin: Vec3::new(0.0, 1.0, 0.1), direction: Vec3::X };
        assert!(enters(&level, &pillar(0.0, 0.0)).is_some_and(|distance| distance.abs() < 1e-6));
        let raised = Pillar { foot: 3.0, ..pillar(5.0, 0.0) };
        assert!(enters(&level, &raised).is_none());
        assert!(enters(&Ray { origin: Vec3::new(0.0, 4.0, 0.0), ..level }, &raised).is_some());
    }

    #[test]
    fn absent_people_cannot_be_picked() {
        let gone = Pillar { position: [crate::ground::ABSENT; 2], ..pillar(0.0, 0.0) };
        let down = Ray {
            origin: Vec3::new(crate::ground::ABSENT, 10.0, crate::ground::ABSENT),
            direction: Vec3::NEG_Y,
        };
        assert!(first(&down, std::iter::once(gone), f32::INFINITY).is_none());
    }

    #[test]
    fn walls_are_met_from_both_sides_and_only_in_front() {
        let mesh = EnvironmentMesh {
            positions: vec![Vec3::new(-1.0, 0.0, 2.0), Vec3::new(1.0, 0.0, 2.0), Vec3::new(0.0, 2.0, 2.0)],
            indices: vec![0, 1, 2, 0, 9, 1], // the second triangle has no such corner
            ..EnvironmentMesh::default()
        };
        let eye = |z: f32, way: Vec3| Ray { origin: Vec3::new(0.0, 0.5, z), direction: way };
        assert!((wall(&eye(10.0, Vec3::NEG_Z), &mesh) - 8.0).abs() < 1e-5);
        assert!((wall(&eye(-1.0, Vec3::Z), &mesh) - 3.0).abs() < 1e-5);
        assert!(wall(&eye(10.0, Vec3::Z), &mesh).is_infinite());
        assert!(wall(&eye(10.0, Vec3::new(0.3, 0.0, -1.0).normalize()), &mesh).is_infinite());
    }
}
