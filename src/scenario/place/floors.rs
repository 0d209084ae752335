//! Floors above the ground: bridges, ramps, storeys, their railings, and obstacles that do not reach from the ground up.

use super::material::SurfaceMaterial;
use super::mesh::{Builder, EnvironmentMesh, srgb};
use crate::kernels::shared::climb::STEP;
use crate::kernels::shared::floors::EDGE;
use crate::kernels::shared::floors::index::FLOOR_STRIDE;
use crate::kernels::shared::orca::TALL;
use crate::scenario::file::{Floor, Obstacle};
use crate::scenario::polygon;
use glam::{Vec2, Vec3};

/// Most corners of a floor: its elements in the buffer `floors` are a plane and eight edges.
pub(crate) const MAX_FLOOR_CORNERS: usize = FLOOR_STRIDE - 1;
/// Height of a railing above the floor, m.
pub const RAILING: f32 = 1.1;
/// Thickness of what is drawn, m.
const SLAB: f32 = 0.25;

impl Floor {
    pub(crate) fn corners(&self) -> Vec<Vec2> {
        self.polygon.iter().copied().map(Vec2::from).collect()
    }

    /// (a, b, c) of height = a x + b z + c.
    pub(crate) fn plane(&self) -> Vec3 {
        let (corners, h) = (self.corners(), &self.heights);
        let &[first, ..] = h.as_slice() else { return Vec3::ZERO };
        let (&[p, q, r, ..], &[hp, hq, hr, ..]) = (corners.as_slice(), h.as_slice()) else {
            return Vec3::new(0.0, 0.0, first);
        };
        let (u, v) = (q - p, r - p);
        let area = u.perp_dot(v);
        let slope = Vec2::new((hq - hp) * v.y - (hr - hp) * u.y, (hr - hp) * u.x - (hq - hp) * v.x) / area;
        Vec3::new(slope.x, slope.y, hp - slope.dot(p))
    }

    fn height_at(&self, at: Vec2) -> f32 {
        self.plane().dot(at.extend(1.0))
    }

    /// The floor as `elevate` reads it.
    fn elements(&self) -> [[f32; 4]; FLOOR_STRIDE] {
        let corners = polygon::oriented(self.corners(), true);
        let mut elements = [[0.0, 0.0, 1.0, 0.0]; FLOOR_STRIDE];
        elements[0] = self.plane().extend(0.0).to_array();
        for (element, (a, b)) in elements[1..].iter_mut().zip(polygon::edges(&corners)) {
            let inward = (b - a).normalize_or_zero().perp();
            *element = [inward.x, inward.y, -inward.dot(a), 0.0];
        }
        elements
    }
}

/// Something solid between two heights: a railing on a bridge does not stop those under it.
#[derive(Debug, Clone, PartialEq)]
pub struct Raised {
    /// Corners; two are a wall, solid from both sides; more are counter-clockwise and solid within.
    pub outline: Vec<Vec2>,
    /// Its lowest point, m.
    pub low: f32,
    /// Its highest point, m.
    pub high: f32,
}

/// Whether a point is on a floor, seen from above.
fn is_on(floor: &[[f32; 4]], at: Vec2) -> bool {
    is_within(floor, at, EDGE)
}

/// Whether a point lies inside the edges of a floor moved out by `margin` m.
fn is_within(floor: &[[f32; 4]], at: Vec2, margin: f32) -> bool {
    floor[1..].iter().all(|&[n, m, d, _]| n * at.x + m * at.y + d >= -margin)
}

/// The height of a floor's plane at a point, m.
fn height_on(floor: &[[f32; 4]], at: Vec2) -> f32 {
    let [a, b, c, _] = floor[0];
    a * at.x + b * at.y + c
}

/// All floors of a scene, and what stands on them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Floors {
    floors: Vec<Floor>,
    /// `[floor][9]`: the plane, then the edges, as `elevate` reads them.
    pub elements: Vec<[f32; 4]>,
    /// Railings, and obstacles with a height range.
    pub raised: Vec<Raised>,
}

impl Floors {
    /// Floors with their railings, and those obstacles that stand at some heights only.
    pub fn new(floors: &[Floor], obstacles: &[Obstacle]) -> Self {
        let railing = |floor: &Floor, edge: u32| {
            let (corners, count) = (floor.corners(), floor.polygon.len());
            let outline = vec![corners[edge as usize % count], corners[(edge as usize + 1) % count]];
            let [a, b] = [outline[0], outline[1]].map(|end| floor.height_at(end));
            Raised { outline, low: a.min(b), high: a.max(b) + RAILING }
        };
        let railings = floors.iter().flat_map(|f| f.railings.iter().map(move |edge| railing(f, *edge)));
        let solids = obstacles.iter().filter(|obstacle| obstacle.is_raised()).map(|obstacle| Raised {
            outline: polygon::oriented(obstacle.polygon.iter().copied().map(Vec2::from).collect(), true),
            low: obstacle.low.unwrap_or(-1000.0),
            high: obstacle.high.unwrap_or(1000.0),
        });
        Self {
            floors: floors.to_vec(),
            elements: floors.iter().flat_map(Floor::elements).collect(),
            raised: railings.chain(solids).collect(),
        }
    }

    /// How many floors there are.
    pub fn count(&self) -> usize {
        self.floors.len()
    }

    /// Height at which an agent stands at a point that stood at `present` m just before, m: the rule of `elevate`.
    pub fn height(&self, at: Vec2, present: f32) -> f32 {
        self.on(at, present).map_or(0.0, |floor| self.level(floor, at))
    }

    /// The floor on which an agent stands at a point that stood at `present` m just before; none: the ground.
    pub fn on(&self, at: Vec2, present: f32) -> Option<usize> {
        let (mut nearest, mut found) = (STEP, None);
        for floor in (0..self.count()).filter(|floor| self.covers(*floor, at)) {
            let off = (self.level(floor, at) - present).abs();
            if off < nearest {
                (nearest, found) = (off, Some(floor));
            }
        }
        found
    }

    /// Corners of a floor, counter-clockwise.
    pub fn outline(&self, floor: usize) -> Vec<Vec2> {
        polygon::oriented(self.floors[floor].corners(), true)
    }

    /// Height of the plane of a floor at a point, m.
    pub fn level(&self, floor: usize, at: Vec2) -> f32 {
        height_on(&self.elements[floor * FLOOR_STRIDE..], at)
    }

    /// Whether a floor reaches over or under a point, as `elevate` sees it.
    pub fn covers(&self, floor: usize, at: Vec2) -> bool {
        self.is_within(floor, at, EDGE)
    }

    /// Whether a point lies inside the edges of a floor moved out by `margin` m.
    pub fn is_within(&self, floor: usize, at: Vec2, margin: f32) -> bool {
        is_within(&self.elements[floor * FLOOR_STRIDE..][..FLOOR_STRIDE], at, margin)
    }

    /// Height at which an agent stands that came to a point from the height `present` m: on the floor, or the ground, that is no
    /// farther than a step up or down. None: there is nothing to stand on.
    pub fn footing(&self, at: Vec2, present: f32) -> Option<f32> {
        let height = self.height(at, present);
        ((height - present).abs() < STEP).then_some(height)
    }

    /// Heights of the ground and of all floors at a point, m.
    pub(crate) fn heights(&self, at: Vec2) -> Vec<f32> {
        let floors = self.elements.chunks_exact(FLOOR_STRIDE);
        let on = floors.filter(|floor| is_on(floor, at)).map(|floor| height_on(floor, at));
        std::iter::once(0.0).chain(on).collect()
    }

    /// Where a ray meets a floor, or the ground, from above: the place and its height, m. None where it meets a floor from
    /// below first, or nothing at all.
    pub fn hit(&self, from: Vec3, direction: Vec3) -> Option<(Vec2, f32)> {
        const FLAT: f32 = 0.05;
        let ahead = |t: f32| {
            let point = from + direction * t;
            Vec2::new(point.x, point.z)
        };
        let ground = (direction.y < -FLAT && from.y > 0.0).then(|| (from.y / -direction.y, true));
        let floors = self.elements.chunks_exact(FLOOR_STRIDE).filter_map(|floor| {
            let above = from.y - height_on(floor, ahead(0.0));
            let [a, b, ..] = floor[0];
            let sinks = a * direction.x + b * direction.z - direction.y;
            let t = above / sinks;
            (sinks.abs() > FLAT && t > 0.0 && is_on(floor, ahead(t))).then_some((t, above > 0.0))
        });
        let (t, is_from_above) = floors.chain(ground).min_by(|a, b| a.0.total_cmp(&b.0))?;
        is_from_above.then(|| (ahead(t), from.y + t * direction.y))
    }

    /// Whether a disc of `radius` m on a floor `height` m high keeps clear of railings and of what is solid there.
    pub fn admits(&self, at: Vec2, radius: f32, height: f32) -> bool {
        let is_in_the_way = |solid: &Raised| {
            let mut edges = polygon::edges(&solid.outline);
            height + TALL > solid.low
                && height < solid.high
                && (edges.any(|(a, b)| polygon::point_segment_distance(at, a, b) < radius)
                    || (solid.outline.len() > 2 && polygon::contains(&solid.outline, at)))
        };
        !self.raised.iter().any(is_in_the_way)
    }

    /// Height at the end of a straight walk that begins at height `present`, m.
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "steps of a quarter of a metre along a route"
    )]
    pub(crate) fn walk(&self, start: Vec2, end: Vec2, mut present: f32) -> f32 {
        if self.floors.is_empty() {
            return 0.0;
        }
        let steps = (start.distance(end) * 4.0).ceil().max(1.0) as u32;
        for step in 0..=steps {
            present = self.height(start.lerp(end, step as f32 / steps as f32), present);
        }
        present
    }

    /// Adds slabs and railings to a mesh.
    pub fn draw(&self, mesh: &mut EnvironmentMesh) {
        let mut builder = Builder::new(mesh, Vec3::ZERO, 0.0);
        let (concrete, steel) = (srgb(0x00b4_afa6), srgb(0x0056_606b));
        for floor in &self.floors {
            builder.of(SurfaceMaterial::Concrete);
            let corners = polygon::oriented(floor.corners(), true);
            let at = |p: Vec2, drop: f32| Vec3::new(p.x, floor.height_at(p) - drop, p.y);
            for i in 1..corners.len() - 1 {
                // seen from above, (x, z) is left-handed: counter-clockwise there is clockwise from above
                let [a, b, c] = [corners[0], corners[i], corners[i + 1]];
                builder.on(1).triangle([c, b, a].map(|p| at(p, 0.0)), concrete);
                builder.on(0).triangle([a, b, c].map(|p| at(p, SLAB)), concrete * 0.6);
            }
            for (a, b) in polygon::edges(&corners) {
                builder.quad([at(a, 0.0), at(b, 0.0), at(b, SLAB), at(a, SLAB)], concrete * 0.8);
            }
            builder.of(SurfaceMaterial::Plain);
            let plain = floor.corners();
            for &edge in &floor.railings {
                let (a, b) = (plain[edge as usize], plain[(edge as usize + 1) % plain.len()]);
                rail(&mut builder, floor, [a, b], steel);
            }
        }
    }
}

/// Posts every metre and a half, and two rails.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a few hundred posts"
)]
fn rail(builder: &mut Builder<'_>, floor: &Floor, [a, b]: [Vec2; 2], color: Vec3) {
    const HALF: f32 = 0.03;
    let posts = ((a.distance(b) / 1.5).ceil() as u32).clamp(1, 400);
    let foot = |t: f32| {
        let p = a.lerp(b, t);
        Vec3::new(p.x, floor.height_at(p), p.y)
    };
    for post in 0..=posts {
        let base = foot(post as f32 / posts as f32);
        builder.block(base, Vec3::new(2.0 * HALF, RAILING, 2.0 * HALF), color);
    }
    let side = (b - a).normalize_or_zero().perp() * HALF;
    let side = Vec3::new(side.x, 0.0, side.y);
    for height in [0.5 * RAILING, RAILING] {
        let [low, high] = [Vec3::Y * (height - HALF), Vec3::Y * (height + HALF)];
        let (p, q) = (foot(0.0), foot(1.0));
        for (near, far) in [(p, q), (q, p)] {
            let out = if near == p { -side } else { side };
            builder.quad([near + out + low, near + out + high, far + out + high, far + out + low], color);
        }
        builder.quad([p - side + high, p + side + high, q + side + high, q - side + high], color);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::scenario::file::Point;

    fn bridge() -> Floors {
        let floor = |polygon: [Point; 4], heights: &[f32]| Floor {
            polygon: polygon.to_vec(),
            heights: heights.to_vec(),
            railings: vec![0, 2],
        };
        Floors::new(
            &[
                floor([[-14.0, -2.0], [-4.0, -2.0], [-4.0, 2.0], [-14.0, 2.0]], &[0.0, 3.0, 3.0]),
                floor([[-4.0, -2.0], [4.0, -2.0], [4.0, 2.0], [-4.0, 2.0]], &[3.0]),
                floor([[4.0, -2.0], [14.0, -2.0], [14.0, 2.0], [4.0, 2.0]], &[3.0, 0.0, 0.0]),
            ],
            &[],
        )
    }

    #[test]
    fn who_walks_up_the_ramp_is_on_the_bridge_and_who_walks_under_it_is_not() {
        let floors = bridge();
        let [left, right] = [Vec2::new(-16.0, 0.0), Vec2::new(16.0, 0.0)];
        assert!((floors.walk(left, Vec2::ZERO, 0.0) - 3.0).abs() < 1e-5);
        assert!(floors.walk(left, Vec2::new(-9.0, 1.0), 0.0) > 1.4);
        assert!(floors.walk(left, right, 0.0).abs() < 1e-6);
        assert!(floors.walk(Vec2::new(0.0, -8.0), Vec2::ZERO, 0.0).abs() < 1e-6);
        assert_eq!(floors.raised.len(), 6);
        assert!(floors.raised[2].low > 2.9 && floors.raised[2].high < 4.2);
    }

    #[test]
    fn the_mesh_of_a_floor_faces_up_on_top() {
        let mut mesh = EnvironmentMesh::default();
        bridge().draw(&mut mesh);
        let top =
            mesh.positions.iter().zip(&mesh.normals).filter(|(p, n)| (p.y - 3.0).abs() < 1e-4 && n.y > 0.9);
        assert!(top.count() >= 6);
        for t in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
            let normal = mesh.normals[t[0] as usize];
            assert!((b - a).cross(c - a).dot(normal) > -1e-6, "a triangle winds against its normal");
        }
    }
}
