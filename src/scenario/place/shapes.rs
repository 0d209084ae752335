//! Shapes that only fine scenery has: reveals, limbs, leaves, bodies lofted over sections.

use super::mesh::Builder;
use glam::{Quat, Vec3};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Sides of a limb.
const LIMB_SIDES: u32 = 6;

#[allow(clippy::cast_precision_loss, reason = "a handful of sides")]
fn around(i: u32, sides: u32) -> (f32, f32) {
    let angle = TAU * i as f32 / sides as f32;
    (libm::cosf(angle), libm::sinf(angle))
}

impl Builder<'_> {
    /// The same object in a frame turned by so many quarters about +y: its +z looks where side `quarters` does.
    pub(super) fn side(&mut self, quarters: u8) -> Builder<'_> {
        self.aside(f32::from(quarters) * FRAC_PI_2)
    }

    /// The same object in a frame turned by an angle about +y.
    pub(super) fn aside(&mut self, angle: f32) -> Builder<'_> {
        self.turned_by(Quat::from_rotation_y(angle))
    }

    /// An upright rectangle at `z` that faces +z.
    pub(super) fn rect(&mut self, x: [f32; 2], y: [f32; 2], z: f32, color: Vec3) {
        self.rect_shaded(x, y, z, [color; 2]);
    }

    /// The same in one colour below and another above.
    pub(super) fn rect_shaded(&mut self, x: [f32; 2], y: [f32; 2], z: f32, [below, above]: [Vec3; 2]) {
        if x[1] - x[0] < 1.0e-4 || y[1] - y[0] < 1.0e-4 {
            return;
        }
        let at = |i: usize, j: usize| Vec3::new(x[i], y[j], z);
        self.quad_shaded([at(0, 0), at(1, 0), at(1, 1), at(0, 1)], [below, below, above, above]);
    }

    /// The four inner sides of an opening that leads from the wall at `z[0]` back to `z[1]`; darker at the back and under the head.
    pub(super) fn recess(&mut self, x: [f32; 2], y: [f32; 2], z: [f32; 2], color: Vec3) {
        let at = |i: usize, j: usize, k: usize| Vec3::new(x[i], y[j], z[k]);
        let (front, back) = (color, color * 0.6);
        self.quad_shaded([at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0)], [front, back, back, front]);
        self.quad_shaded([at(1, 0, 1), at(1, 0, 0), at(1, 1, 0), at(1, 1, 1)], [back, front, front, back]);
        self.quad_shaded([at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1)], [front, front, back, back]);
        self.quad_shaded(
            [at(0, 1, 1), at(1, 1, 1), at(1, 1, 0), at(0, 1, 0)],
            [back * 0.7, back * 0.7, back, back],
        );
    }

    /// A round limb from one point to another, of these radii, open at both ends.
    pub(super) fn limb(&mut self, from: Vec3, to: Vec3, radii: [f32; 2], color: Vec3) {
        self.tube(from, to, radii, LIMB_SIDES, color);
    }

    /// The same with a lid at its far end.
    pub(super) fn limb_capped(&mut self, from: Vec3, to: Vec3, radii: [f32; 2], sides: u32, color: Vec3) {
        let [u, v] = self.tube(from, to, radii, sides, color);
        let out = (to - from).normalize_or(Vec3::Y);
        let rim = |i: u32| {
            let (x, y) = around(i, sides);
            to + (u * x + v * y) * radii[1]
        };
        let middle = self.vertex(to, out, color);
        let corners: Vec<u32> = (0..=sides).map(|i| self.vertex(rim(i), out, color)).collect();
        for pair in corners.windows(2) {
            self.indices([middle, pair[0], pair[1]]);
        }
    }

    fn tube(&mut self, from: Vec3, to: Vec3, [r0, r1]: [f32; 2], sides: u32, color: Vec3) -> [Vec3; 2] {
        let axis = (to - from).normalize_or(Vec3::Y);
        let u = axis.any_orthonormal_vector();
        let v = axis.cross(u);
        let slope = axis * ((r0 - r1) / from.distance(to).max(1.0e-4));
        let ring: Vec<[u32; 2]> = (0..=sides)
            .map(|i| {
                let (x, y) = around(i, sides);
                let out = u * x + v * y;
                let normal = (out + slope).normalize_or(out);
                [self.vertex(from + out * r0, normal, color), self.vertex(to + out * r1, normal, color)]
            })
            .collect();
        for pair in ring.windows(2) {
            let ([a, d], [b, c]) = (pair[0], pair[1]);
            self.indices([a, b, c]);
            self.indices([a, c, d]);
        }
        [u, v]
    }

    /// A leaf or a bunch of them: a rhombus of this length that faces `facing`, lit as if it faced `normal`.
    pub(super) fn leaf(
        &mut self,
        at: Vec3,
        [facing, normal]: [Vec3; 2],
        length: f32,
        turn: f32,
        color: Vec3,
    ) {
        let u = facing.any_orthonormal_vector();
        let v = facing.cross(u);
        let (sine, cosine) = (libm::sinf(turn), libm::cosf(turn));
        let (along, aside) =
            ((u * cosine + v * sine) * (0.5 * length), (v * cosine - u * sine) * (0.3 * length));
        let normal = if normal.dot(facing) > 0.1 { normal } else { facing };
        let corners = [at - along, at + aside, at + along, at - aside].map(|p| {
            // no leaf goes into the ground
            let above = Vec3::new(p.x, p.y.max(0.01), p.z);
            self.vertex(above, normal, color)
        });
        let [a, b, c, d] = corners;
        self.indices([a, d, c]);
        self.indices([a, c, b]);
    }

    /// A blade of grass: its two feet and its tip, lit from above.
    pub(super) fn blade(&mut self, [left, right, tip]: [Vec3; 3], color: Vec3) {
        let face = (left - right).cross(tip - right).normalize_or(Vec3::Y);
        let normal = (face + Vec3::Y).normalize_or(face);
        let [a, b] = [right, left].map(|p| self.vertex(p, normal, color * 0.7));
        let c = self.vertex(tip, normal, color * 1.2);
        self.indices([a, b, c]);
    }

    /// A disc that faces +z.
    pub(super) fn dial(&mut self, center: Vec3, radius: f32, sides: u32, color: Vec3) {
        let middle = self.vertex(center, Vec3::Z, color);
        let rim: Vec<u32> = (0..=sides)
            .map(|i| {
                let (x, y) = around(i, sides);
                self.vertex(center + Vec3::new(x, y, 0.0) * radius, Vec3::Z, color)
            })
            .collect();
        for pair in rim.windows(2) {
            self.indices([middle, pair[0], pair[1]]);
        }
    }

    /// An upright round wall without top and bottom.
    pub(super) fn turned_wall(&mut self, base: Vec3, radius: f32, height: f32, sides: u32, color: Vec3) {
        self.tube(base, base + Vec3::Y * height, [radius; 2], sides, color);
    }

    /// A smooth skin over sections that follow one another along +z, each from its foot at +x over the top to its foot at -x; both ends
    /// are closed.
    pub(super) fn loft(&mut self, sections: &[Vec<Vec3>], color: Vec3) {
        let count = sections.iter().map(Vec::len).min().unwrap_or(0);
        let mut normals = vec![vec![Vec3::ZERO; count]; sections.len()];
        let mut faces = Vec::new();
        for k in 1..sections.len() {
            for i in 1..count {
                let cell = [(k - 1, i - 1), (k - 1, i), (k, i), (k, i - 1)];
                let [a, b, c, d] = cell.map(|(k, i)| sections[k][i]);
                let face = (c - a).cross(d - b);
                for (k, i) in cell {
                    normals[k][i] += face;
                }
                faces.push(cell);
            }
        }
        let grid: Vec<Vec<u32>> = sections
            .iter()
            .zip(&normals)
            .map(|(section, normals)| {
                section
                    .iter()
                    .zip(normals)
                    .map(|(p, normal)| self.vertex(*p, normal.normalize_or(Vec3::Y), color))
                    .collect()
            })
            .collect();
        for cell in faces {
            let [a, b, c, d] = cell.map(|(k, i)| grid[k][i]);
            self.indices([a, b, c]);
            self.indices([a, c, d]);
        }
        for (section, flip) in [(sections.first(), false), (sections.last(), true)] {
            let Some([first, rest @ ..]) = section.map(Vec::as_slice) else { continue };
            for pair in rest.windows(2) {
                let [b, c] = if flip { [pair[0], pair[1]] } else { [pair[1], pair[0]] };
                self.triangle([*first, b, c], color * 0.9);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::EnvironmentMesh;
    use super::*;

    fn build(draw: impl Fn(&mut Builder<'_>)) -> EnvironmentMesh {
        let mut mesh = EnvironmentMesh::default();
        draw(&mut Builder::new(&mut mesh, Vec3::ZERO, 0.0));
        mesh
    }

    /// Middle and normal of every triangle; its corners' normals agree with it.
    fn faces(mesh: &EnvironmentMesh) -> Vec<(Vec3, Vec3)> {
        let face = |t: &[u32]| {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
            let normal = (b - a).cross(c - a).normalize();
            assert!(normal.is_finite());
            for i in t {
                assert!(mesh.normals[*i as usize].dot(normal) > 0.0, "{a} {b} {c}");
            }
            ((a + b + c) / 3.0, normal)
        };
        mesh.indices.chunks(3).map(face).collect()
    }

    #[test]
    fn closed_shapes_face_outwards_and_openings_inwards() {
        let section = |z: f32| {
            [(1.0, 0.0), (1.0, 1.0), (0.5, 1.5), (-0.5, 1.5), (-1.0, 1.0), (-1.0, 0.0)]
                .map(|(x, y)| Vec3::new(x, y, z))
                .to_vec()
        };
        let sections = [section(-2.0), section(0.0), section(2.0)];
        for (name, middle, mesh) in [
            ("loft", Vec3::Y * 0.7, build(|b| b.loft(&sections, Vec3::ONE))),
            ("limb", Vec3::Y, build(|b| b.limb_capped(Vec3::ZERO, Vec3::Y * 2.0, [0.5, 0.3], 9, Vec3::ONE))),
            ("wall", Vec3::Y, build(|b| b.turned_wall(Vec3::ZERO, 1.0, 2.0, 24, Vec3::ONE))),
        ] {
            for (at, normal) in faces(&mesh) {
                assert!((at - middle).dot(normal) > 0.0, "{name}: {at} {normal}");
            }
        }
        let niche = build(|b| b.recess([-1.0, 1.0], [0.0, 2.0], [0.0, -0.5], Vec3::ONE));
        for (at, normal) in faces(&niche) {
            assert!((at - Vec3::new(0.0, 1.0, -0.25)).dot(normal) < 0.0, "{at} {normal}");
        }
        assert_eq!(niche.indices.len(), 4 * 6);
    }

    #[test]
    fn sides_look_where_their_quarter_does() {
        for (quarters, out) in (0..4_u8).zip([Vec3::Z, Vec3::X, Vec3::NEG_Z, Vec3::NEG_X]) {
            let mesh = build(|b| b.side(quarters).rect([-1.0, 1.0], [0.0, 1.0], 3.0, Vec3::ONE));
            for (at, normal) in faces(&mesh) {
                assert!(normal.dot(out) > 0.999 && (at.dot(out) - 3.0).abs() < 1.0e-5, "{quarters}");
            }
            assert!(build(|b| b.rect([1.0, 1.0], [0.0, 1.0], 0.0, Vec3::ONE)).indices.is_empty());
        }
        let dial = build(|b| b.dial(Vec3::Y, 1.0, 12, Vec3::ONE));
        assert!(faces(&dial).iter().all(|(_, normal)| normal.z > 0.999));
    }

    #[test]
    fn leaves_face_where_they_should_and_grass_upwards() {
        for facing in [Vec3::X, Vec3::Y, Vec3::new(0.6, 0.0, -0.8)] {
            let mesh = build(|b| b.leaf(Vec3::Y, [facing, Vec3::NEG_X], 0.3, 1.0, Vec3::ONE));
            assert!(faces(&mesh).iter().all(|(_, normal)| normal.dot(facing) > 0.999), "{facing}");
        }
        let [left, right] = [Vec3::new(0.0, 0.0, 0.01), Vec3::new(0.0, 0.0, -0.01)];
        let tip = Vec3::new(0.05, 0.1, 0.0);
        let blade = build(|b| b.blade([left, right, tip], Vec3::ONE));
        assert!(faces(&blade).iter().all(|(_, normal)| normal.y > 0.0));
    }
}
