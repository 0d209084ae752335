//! Coloured triangle meshes built from primitives: what the scenery is made of.

use super::material::SurfaceMaterial;
use crate::avatar::PlaceModel;
use glam::{Quat, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// How much scenery has to show.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Finish {
    /// Blocks: what low quality draws.
    Plain,
    /// Reveals, frames, letters, leaves.
    Fine,
}

impl Finish {
    /// Most triangles of an environment; what is farthest from the user is simplified, then left out.
    pub const fn most_triangles(self) -> usize {
        match self {
            Self::Plain => 60_000,
            Self::Fine => 200_000,
        }
    }
}

/// A coloured triangle mesh, world frame, metres, y up. Triangles wind counter-clockwise seen from outside.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EnvironmentMesh {
    /// Position of each vertex, m.
    pub positions: Vec<Vec3>,
    /// Unit normal of each vertex.
    pub normals: Vec<Vec3>,
    /// Linear colour of each vertex, 0 to 1; above 1 the surface glows.
    pub colors: Vec<Vec3>,
    /// Of what lies flat and casts no shadow, the layer of each vertex: 1 is what people stand on, the ones below are seen
    /// where nothing lies above them. 0 of everything else. Empty: 0 everywhere.
    pub layers: Vec<u8>,
    /// What the surface is made of at each vertex. Empty: [`SurfaceMaterial::Plain`] everywhere.
    pub materials: Vec<SurfaceMaterial>,
    /// Three indices per triangle.
    pub indices: Vec<u32>,
    /// Three indices per triangle of what stands for some of that where it is far from the eyes.
    #[doc(hidden)]
    pub far_indices: Vec<u32>,
    /// What has such a stand-in.
    #[doc(hidden)]
    pub distant: Vec<Distant>,
    /// A place of the user's own, which is drawn with the rest.
    #[doc(hidden)]
    pub place: Option<Arc<PlaceModel>>,
}

/// A thing that is drawn with fewer triangles from afar.
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Distant {
    /// Where its triangles are in `indices`.
    pub near: Range<usize>,
    /// Where those from afar are in `far_indices`.
    pub far: Range<usize>,
}

impl EnvironmentMesh {
    /// Number of triangles.
    pub const fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }
}

impl EnvironmentMesh {
    pub(crate) fn clear(&mut self) {
        self.positions.clear();
        self.normals.clear();
        self.colors.clear();
        self.layers.clear();
        self.materials.clear();
        self.indices.clear();
        self.far_indices.clear();
        self.distant.clear();
    }

    pub(crate) fn append(&mut self, part: &Self) {
        let base = u32::try_from(self.positions.len()).unwrap_or(u32::MAX);
        self.positions.extend(&part.positions);
        self.normals.extend(&part.normals);
        self.colors.extend(&part.colors);
        self.layers.extend(&part.layers);
        self.materials.extend(&part.materials);
        self.indices.extend(part.indices.iter().map(|index| base.saturating_add(*index)));
    }

    /// Has a part stand for the triangles from the index `since` on, where they are far from the eyes.
    pub(crate) fn stand_in(&mut self, since: usize, part: &Self) {
        let near = since..self.indices.len();
        self.append(part);
        let far = self.indices.split_off(near.end);
        let from = self.far_indices.len();
        self.far_indices.extend(far);
        self.distant.push(Distant { near, far: from..self.far_indices.len() });
    }
}

/// Linear colour of an sRGB `0xRRGGBB`.
#[allow(clippy::cast_precision_loss, reason = "a byte is exact in f32")]
pub(crate) fn srgb(hex: u32) -> Vec3 {
    let channel = |shift: u32| {
        let c = ((hex >> shift) & 0xff) as f32 / 255.0;
        if c <= 0.04045 { c / 12.92 } else { libm::powf((c + 0.055) / 1.055, 2.4) }
    };
    Vec3::new(channel(16), channel(8), channel(0))
}

/// Adds primitives to a mesh in the frame of one object: origin on the ground, turned about +y.
#[derive(Debug)]
pub(crate) struct Builder<'a> {
    mesh: &'a mut EnvironmentMesh,
    origin: Vec3,
    turn: Quat,
    layer: u8,
    material: SurfaceMaterial,
}

impl<'a> Builder<'a> {
    pub(crate) fn new(mesh: &'a mut EnvironmentMesh, origin: Vec3, heading: f32) -> Self {
        Self {
            mesh,
            origin,
            turn: Quat::from_rotation_y(heading),
            layer: 0,
            material: SurfaceMaterial::Plain,
        }
    }

    /// What follows lies flat in this layer; 0: it does not.
    pub(crate) fn on(&mut self, layer: u8) -> &mut Self {
        self.layer = layer;
        self
    }

    /// What follows is made of this.
    pub(crate) fn of(&mut self, material: SurfaceMaterial) -> &mut Self {
        self.material = material;
        self
    }

    pub(super) fn vertex(&mut self, position: Vec3, normal: Vec3, color: Vec3) -> u32 {
        let index = u32::try_from(self.mesh.positions.len()).unwrap_or(u32::MAX);
        self.mesh.positions.push(self.origin + self.turn * position);
        self.mesh.normals.push(self.turn * normal);
        self.mesh.colors.push(color);
        self.mesh.layers.push(self.layer);
        self.mesh.materials.push(self.material);
        index
    }

    /// A triangle of vertices that are there, counter-clockwise seen from outside.
    pub(super) fn indices(&mut self, corners: [u32; 3]) {
        self.mesh.indices.extend(corners);
    }

    /// The same object in a frame that is turned within this one.
    pub(super) fn turned_by(&mut self, turn: Quat) -> Builder<'_> {
        Builder { mesh: &mut *self.mesh, turn: self.turn * turn, ..*self }
    }

    /// Three corners, counter-clockwise seen from outside.
    pub(crate) fn triangle(&mut self, corners: [Vec3; 3], color: Vec3) {
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or(Vec3::Y);
        let indices = corners.map(|corner| self.vertex(corner, normal, color));
        self.mesh.indices.extend(indices);
    }

    /// Four corners, counter-clockwise seen from outside; flat.
    pub(crate) fn quad(&mut self, corners: [Vec3; 4], color: Vec3) {
        self.quad_shaded(corners, [color; 4]);
    }

    /// The same with a colour for each corner.
    pub(super) fn quad_shaded(&mut self, corners: [Vec3; 4], colors: [Vec3; 4]) {
        let normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]).normalize_or(Vec3::Y);
        let [a, b, c, d] = [0, 1, 2, 3].map(|i: usize| self.vertex(corners[i], normal, colors[i]));
        self.mesh.indices.extend([a, b, c, a, c, d]);
    }

    /// An upward rectangle `width` (x) by `depth` (z) about (x, z) at height y.
    pub(crate) fn sheet(&mut self, center: Vec3, width: f32, depth: f32, color: Vec3) {
        let (w, d) = (width * 0.5, depth * 0.5);
        let at = |x: f32, z: f32| center + Vec3::new(x, 0.0, z);
        self.quad([at(-w, -d), at(-w, d), at(w, d), at(w, -d)], color);
    }

    /// A cuboid between two corners, without its bottom when it stands on the ground (y <= 0).
    pub(crate) fn cuboid(&mut self, low: Vec3, high: Vec3, color: Vec3) {
        self.frustum_box(low, high, 1.0, color);
    }

    /// A cuboid whose top is smaller by `taper` (1 is upright).
    pub(crate) fn frustum_box(&mut self, low: Vec3, high: Vec3, taper: f32, color: Vec3) {
        let middle = (low + high) * 0.5;
        let corner = |x: f32, z: f32, top: bool| {
            let (k, y) = if top { (taper, high.y) } else { (1.0, low.y) };
            Vec3::new(middle.x + (x - middle.x) * k, y, middle.z + (z - middle.z) * k)
        };
        let (x0, x1, z0, z1) = (low.x, high.x, low.z, high.z);
        let ring = [(x0, z0), (x0, z1), (x1, z1), (x1, z0)];
        self.quad(ring.map(|(x, z)| corner(x, z, true)), color);
        if low.y > 0.0 {
            let [a, b, c, d] = ring.map(|(x, z)| corner(x, z, false));
            self.quad([d, c, b, a], color);
        }
        for i in 0..4 {
            let ((xa, za), (xb, zb)) = (ring[i], ring[(i + 1) % 4]);
            let side =
                [corner(xa, za, false), corner(xb, zb, false), corner(xb, zb, true), corner(xa, za, true)];
            self.quad(side, color);
        }
    }

    /// A cuboid about a point with full `size`, bottom at `base`.
    pub(crate) fn block(&mut self, base: Vec3, size: Vec3, color: Vec3) {
        let half = Vec3::new(size.x * 0.5, 0.0, size.z * 0.5);
        self.cuboid(base - half, base + half + Vec3::Y * size.y, color);
    }

    /// An upright round body turned from a profile of (radius, height) rings from bottom to top, smooth.
    /// A radius of 0 closes it; an open top end is capped.
    #[allow(clippy::cast_precision_loss, reason = "a handful of sides")]
    pub(crate) fn turned(&mut self, base: Vec3, profile: &[(f32, f32)], sides: u32, color: Vec3) {
        let direction = |i: u32| {
            let angle = std::f32::consts::TAU * i as f32 / sides as f32;
            Vec3::new(libm::sinf(angle), 0.0, libm::cosf(angle))
        };
        for pair in profile.windows(2) {
            let ((r0, y0), (r1, y1)) = (pair[0], pair[1]);
            let slope = Vec3::new(0.0, r0 - r1, 0.0);
            let mut ring = Vec::new();
            for i in 0..=sides {
                let out = direction(i);
                let normal = (out * (y1 - y0) + slope).normalize_or(Vec3::Y);
                let low = self.vertex(base + out * r0 + Vec3::Y * y0, normal, color);
                let high = self.vertex(base + out * r1 + Vec3::Y * y1, normal, color);
                ring.push((low, high));
            }
            for step in ring.windows(2) {
                let ((a, d), (b, c)) = (step[0], step[1]);
                if r0 > 0.0 {
                    self.mesh.indices.extend([a, b, c]);
                }
                if r1 > 0.0 {
                    self.mesh.indices.extend([a, c, d]);
                } else if r0 <= 0.0 {
                    continue;
                }
            }
        }
        if let Some(&(radius, y)) = profile.last()
            && radius > 0.0
        {
            self.disc(base + Vec3::Y * y, radius, sides, color);
        }
    }

    /// An upward disc.
    #[allow(clippy::cast_precision_loss, reason = "a handful of sides")]
    pub(crate) fn disc(&mut self, center: Vec3, radius: f32, sides: u32, color: Vec3) {
        let middle = self.vertex(center, Vec3::Y, color);
        let rim: Vec<u32> = (0..=sides)
            .map(|i| {
                let angle = std::f32::consts::TAU * i as f32 / sides as f32;
                self.vertex(
                    center + radius * Vec3::new(libm::sinf(angle), 0.0, libm::cosf(angle)),
                    Vec3::Y,
                    color,
                )
            })
            .collect();
        for step in rim.windows(2) {
            self.mesh.indices.extend([middle, step[0], step[1]]);
        }
    }

    /// An upward ring between two radii.
    #[allow(clippy::cast_precision_loss, reason = "a handful of sides")]
    pub(crate) fn ring(&mut self, center: Vec3, inner: f32, outer: f32, sides: u32, color: Vec3) {
        let out = |i: u32| {
            let angle = std::f32::consts::TAU * i as f32 / sides as f32;
            Vec3::new(libm::sinf(angle), 0.0, libm::cosf(angle))
        };
        for i in 0..sides {
            let (a, b) = (out(i), out(i + 1));
            self.quad(
                [center + a * inner, center + a * outer, center + b * outer, center + b * inner],
                color,
            );
        }
    }

    /// A closed ball stretched to `radii`, smooth.
    #[allow(clippy::cast_precision_loss, reason = "a handful of rings")]
    pub(crate) fn ball(&mut self, center: Vec3, radii: Vec3, sides: u32, color: Vec3) {
        let rings = (sides / 2).max(2);
        let point = |i: u32, j: u32| {
            let (up, around) = (
                std::f32::consts::PI * j as f32 / rings as f32,
                std::f32::consts::TAU * i as f32 / sides as f32,
            );
            Vec3::new(
                libm::sinf(up) * libm::sinf(around),
                -libm::cosf(up),
                libm::sinf(up) * libm::cosf(around),
            )
        };
        let mut grid = Vec::new();
        for j in 0..=rings {
            for i in 0..=sides {
                let unit = point(i, j);
                grid.push(self.vertex(center + unit * radii, (unit / radii).normalize_or(Vec3::Y), color));
            }
        }
        let at = |i: u32, j: u32| grid[(j * (sides + 1) + i) as usize];
        for j in 0..rings {
            for i in 0..sides {
                let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                if j > 0 {
                    self.mesh.indices.extend([a, b, c]);
                }
                if j + 1 < rings {
                    self.mesh.indices.extend([a, c, d]);
                }
            }
        }
    }

    /// A wheel: a cylinder whose axis is x.
    #[allow(clippy::cast_precision_loss, reason = "a handful of sides")]
    pub(crate) fn wheel(&mut self, center: Vec3, radius: f32, width: f32, sides: u32, color: Vec3) {
        let rim = |i: u32, x: f32| {
            let angle = std::f32::consts::TAU * i as f32 / sides as f32;
            center + Vec3::new(x, radius * libm::sinf(angle), radius * libm::cosf(angle))
        };
        let (left, right) = (width * 0.5, -width * 0.5);
        for i in 0..sides {
            let j = i + 1;
            self.quad([rim(i, right), rim(i, left), rim(j, left), rim(j, right)].map(|p| p), color);
        }
        for (x, flip) in [(left, false), (right, true)] {
            for i in 1..sides - 1 {
                let (b, c) = if flip { (i, i + 1) } else { (i + 1, i) };
                let normal = Vec3::X * x.signum();
                let corners = [rim(0, x), rim(b, x), rim(c, x)].map(|p| self.vertex(p, normal, color));
                self.mesh.indices.extend(corners);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Volume by the divergence theorem: positive when every face looks outwards.
    fn volume(mesh: &EnvironmentMesh) -> f32 {
        let p = |i: u32| mesh.positions[i as usize];
        mesh.indices.chunks(3).map(|t| p(t[0]).dot(p(t[1]).cross(p(t[2]))) / 6.0).sum()
    }

    fn normals_agree(mesh: &EnvironmentMesh) {
        for t in mesh.indices.chunks(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
            let face = (b - a).cross(c - a);
            assert!(face.length() > 1e-9, "degenerate triangle {a} {b} {c}");
            for &i in t {
                assert!(face.normalize().dot(mesh.normals[i as usize]) > 0.1, "{a} {b} {c}");
            }
        }
    }

    fn build(draw: impl Fn(&mut Builder<'_>)) -> EnvironmentMesh {
        let mut mesh = EnvironmentMesh::default();
        draw(&mut Builder::new(&mut mesh, Vec3::new(3.0, 0.0, -2.0), 0.6));
        mesh
    }

    #[test]
    fn every_primitive_faces_outwards() {
        let up = Vec3::Y;
        let closed: [(&str, f32, EnvironmentMesh); 4] = [
            ("block", 6.0, build(|b| b.block(up, Vec3::new(1.0, 2.0, 3.0), up))),
            ("ball", 4.18, build(|b| b.ball(up * 2.0, Vec3::ONE, 32, up))),
            ("wheel", std::f32::consts::PI, build(|b| b.wheel(up, 1.0, 1.0, 64, up))),
            ("cone", 1.04, build(|b| b.turned(up, &[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], 64, up))),
        ];
        for (name, expected, mesh) in closed {
            assert!((volume(&mesh) / expected - 1.0).abs() < 0.05, "{name}: {}", volume(&mesh));
            normals_agree(&mesh);
        }
        for open in [
            build(|b| b.sheet(Vec3::ZERO, 1.0, 2.0, up)),
            build(|b| b.disc(Vec3::ZERO, 1.0, 8, up)),
            build(|b| b.ring(Vec3::ZERO, 0.5, 1.0, 8, up)),
        ] {
            normals_agree(&open);
            assert!(open.normals.iter().all(|n| n.y > 0.99));
        }
    }
}
