//! Primitives of the generated bodies: lofts of rings, flat patches, smooth normals.
//!
//! A *shell* is one connected surface. Its triangles are turned outward by its signed volume, so that no part
//! has to care about winding, and its normals are averaged over vertices that share a position, so that a
//! change of paint (which needs its own vertices) leaves no crease.

use super::super::{FaceVertex, Material, Mesh, Vertex};
use crate::avatar::wardrobe::Tailoring;
use crate::gait::JOINT_COUNT;
use glam::Vec3;
use std::collections::HashMap;
use std::f32::consts::TAU;

/// Shares of the 16 joints in a vertex, any positive sum.
pub(super) type Shares = [f32; JOINT_COUNT];

/// Colour and tint of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Paint {
    pub(super) material: Material,
    pub(super) color: Vec3,
}

impl Paint {
    /// A tinted surface; `shade` darkens the agent's colour.
    pub(super) const fn tinted(material: Material, shade: f32) -> Self {
        Self { material, color: Vec3::splat(shade) }
    }

    /// A surface of fixed linear colour.
    pub(super) const fn fixed(red: f32, green: f32, blue: f32) -> Self {
        Self { material: Material::Fixed, color: Vec3::new(red, green, blue) }
    }
}

/// What clothes do to a ring and the band that begins at it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Cover {
    /// Which part of an outfit covers the band from this ring to the next one; 0: it looks alike in all.
    pub(super) part: u32,
    /// Whether the body's own outfit covers it.
    pub(super) is_plain: bool,
    /// By how much the ring is larger where an outfit differs from the body's own in this, m.
    pub(super) growth: f32,
}

impl Cover {
    /// Of the vertices of its band.
    const fn tailoring(self) -> Tailoring {
        Tailoring { part: self.part, is_plain: self.is_plain, growth: 0.0 }
    }
}

/// A closed cross section: a superellipse with its own back radius.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ring {
    /// Centre, m.
    pub(super) center: Vec3,
    /// Half axis towards the body's left, m.
    pub(super) side: Vec3,
    /// Half axis towards the front, m.
    pub(super) front: Vec3,
    /// Back radius over front radius.
    pub(super) back: f32,
    /// Exponent: 2 is an ellipse, larger is boxier.
    pub(super) square: f32,
    /// Paint of the band from this ring to the next one.
    pub(super) paint: Paint,
    /// Paint of the back half of that band, where it differs.
    pub(super) back_paint: Option<Paint>,
    /// Coarsest level that keeps this ring.
    pub(super) keep: usize,
    pub(super) cover: Cover,
}

impl Ring {
    /// Point at `angle` (0 is front, a quarter turn is the body's left).
    pub(super) fn point(&self, angle: f32, swell: f32) -> Vec3 {
        let rounded = |value: f32| value.signum() * libm::powf(value.abs(), 2.0 / self.square);
        let (sine, cosine) = (rounded(libm::sinf(angle)), rounded(libm::cosf(angle)));
        let depth = if cosine < 0.0 { cosine * self.back } else { cosine };
        self.center + (self.side * sine + self.front * depth) * swell
    }
}

/// A ring about an upright axis.
pub(super) fn level_ring(
    center: Vec3,
    [broad, deep]: [f32; 2],
    square: f32,
    paint: Paint,
    keep: usize,
) -> Ring {
    Ring {
        center,
        side: Vec3::X * broad,
        front: Vec3::Z * deep,
        back: 1.0,
        square,
        paint,
        back_paint: None,
        keep,
        cover: Cover::default(),
    }
}

/// How the ends of a loft are closed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Cap {
    /// Not closed (the end lies inside another shell).
    Open,
    /// A fan about the ring's centre moved outward along the loft by this much, m.
    Fan(f32),
}

/// By how much a polygon is made larger than its circle. It would lie inside, and look thinner the fewer sides it has.
pub(super) fn swell(segments: usize) -> f32 {
    libm::cosf(TAU * 0.5 / segments as f32).recip().sqrt()
}

/// Collects shells into a mesh.
pub(super) struct Builder<'a> {
    pub(super) level: usize,
    mesh: Mesh,
    shell_vertices: usize,
    shell_indices: usize,
    shares: &'a dyn Fn(Vec3) -> Shares,
    /// The one joint that the shell hangs on, whatever `shares` say.
    only: Option<u8>,
    face: Vec<FaceVertex>,
    /// Of every vertex.
    tailoring: Vec<Tailoring>,
    /// Of those to come.
    worn: Tailoring,
}

impl<'a> Builder<'a> {
    pub(super) fn new(level: usize) -> Self {
        Self {
            level,
            mesh: Mesh::default(),
            shell_vertices: 0,
            shell_indices: 0,
            shares: &|_| [0.0; JOINT_COUNT],
            only: None,
            face: Vec::new(),
            tailoring: Vec::new(),
            worn: Tailoring::default(),
        }
    }

    /// The mesh, and what of it an expression moves and an outfit changes.
    pub(super) fn finish(self) -> (Mesh, Vec<FaceVertex>, Vec<Tailoring>) {
        (self.mesh, self.face, self.tailoring)
    }

    /// Says which part of an outfit the shells to come are. Parts of the body's own outfit are `plain`.
    pub(super) const fn wear(&mut self, part: u32, is_plain: bool) {
        self.worn = Tailoring { part, is_plain, growth: 0.0 };
    }

    /// Says that the vertices from number `first` on that are wanted belong to a part that the body's own outfit has not.
    pub(super) fn cover(&mut self, first: usize, part: u32, is_wanted: &dyn Fn(&Vertex) -> bool) {
        for (vertex, own) in self.mesh.vertices.iter().zip(&mut self.tailoring).skip(first) {
            if is_wanted(vertex) {
                *own = Tailoring { part, is_plain: false, growth: 0.0 };
            }
        }
    }

    /// How many vertices there are.
    pub(super) fn len(&self) -> usize {
        self.mesh.vertices.len()
    }

    /// Says how an expression moves the vertices from number `first` on: by their order from there.
    pub(super) fn express(&mut self, first: usize, moves: &dyn Fn(usize, &Vertex) -> FaceVertex) {
        for (vertex, number) in self.mesh.vertices[first..].iter().zip(0..) {
            let own = moves(number, vertex);
            if own != FaceVertex::default() {
                let vertex = u32::try_from(first + number).unwrap_or(u32::MAX);
                self.face.push(FaceVertex { vertex, ..own });
            }
        }
    }

    /// Starts a shell whose skin follows `shares`.
    pub(super) fn begin(&mut self, shares: &'a dyn Fn(Vec3) -> Shares) {
        self.shares = shares;
        self.only = None;
        self.shell_vertices = self.mesh.vertices.len();
        self.shell_indices = self.mesh.indices.len();
    }

    /// Starts a shell that hangs on one joint of the skin.
    pub(super) fn begin_on(&mut self, joint: u32) {
        self.begin(&|_| [0.0; JOINT_COUNT]);
        self.only = u8::try_from(joint).ok();
    }

    /// Adds a vertex; its normal comes with [`Self::end`].
    pub(super) fn vertex(&mut self, position: Vec3, paint: Paint) -> u32 {
        let (joints, weights) = match self.only {
            Some(joint) => ([joint, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]),
            None => pack(&(self.shares)(position)),
        };
        let index = u32::try_from(self.mesh.vertices.len()).unwrap_or(u32::MAX);
        self.mesh.vertices.push(Vertex {
            position,
            normal: Vec3::Y,
            color: paint.color,
            alpha: 1.0,
            material: paint.material,
            joints,
            weights,
        });
        self.tailoring.push(self.worn);
        index
    }

    /// Adds a triangle unless it has no area.
    pub(super) fn triangle(&mut self, a: u32, b: u32, c: u32) {
        let at = |index: u32| self.mesh.vertices[index as usize].position;
        if (at(b) - at(a)).cross(at(c) - at(a)).length_squared() > 1e-16 {
            self.mesh.indices.extend([a, b, c]);
        }
    }

    fn quad(&mut self, a: u32, b: u32, c: u32, d: u32) {
        self.triangle(a, b, c);
        self.triangle(a, c, d);
    }

    /// Turns the shell outward and gives it normals. `facing`: for open patches, the outward direction.
    pub(super) fn end(&mut self, facing: Option<Vec3>) {
        let indices = &mut self.mesh.indices[self.shell_indices..];
        let vertices = &mut self.mesh.vertices[self.shell_vertices..];
        let first = self.shell_vertices;
        let count = vertices.len().max(1);
        let middle = vertices.iter().map(|v| v.position).sum::<Vec3>() / count as f32;
        let at = |vertices: &[Vertex], index: u32| vertices[index as usize - first].position;
        let mut outward = 0.0;
        for t in indices.chunks_exact(3) {
            let (a, b, c) = (at(vertices, t[0]), at(vertices, t[1]), at(vertices, t[2]));
            let normal = (b - a).cross(c - a);
            outward += facing.map_or_else(|| normal.dot(a - middle), |facing| normal.dot(facing));
        }
        if outward < 0.0 {
            indices.chunks_exact_mut(3).for_each(|t| t.swap(1, 2));
        }
        let key = |p: Vec3| (p * 1e5).round().as_ivec3();
        let mut sums: HashMap<glam::IVec3, Vec3> = HashMap::new();
        for t in indices.chunks_exact(3) {
            let corners = [at(vertices, t[0]), at(vertices, t[1]), at(vertices, t[2])];
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
            for i in 0..3 {
                let (to, from) = (corners[(i + 1) % 3] - corners[i], corners[(i + 2) % 3] - corners[i]);
                // Weighing by the corner's angle makes the normal independent of how quads are split.
                *sums.entry(key(corners[i])).or_default() += normal * to.angle_between(from);
            }
        }
        for vertex in vertices {
            let sum = sums.get(&key(vertex.position)).copied().unwrap_or(Vec3::Y);
            vertex.normal = sum.try_normalize().unwrap_or(Vec3::Y);
        }
    }

    /// A loft through `rings` with `segments` sides; rings finer than the level are left out.
    pub(super) fn loft(&mut self, rings: &[Ring], segments: usize, caps: [Cap; 2]) {
        let rings: Vec<&Ring> = rings.iter().filter(|ring| ring.keep >= self.level).collect();
        let (Some(first), Some(last)) = (rings.first(), rings.last()) else { return };
        let swell = swell(segments);
        let shell = self.worn;
        let circle = |builder: &mut Self, ring: &Ring, paint: Paint, band: Cover| -> Vec<u32> {
            if band.part > 0 {
                builder.worn = Tailoring { growth: ring.cover.growth, ..band.tailoring() };
            }
            let corners = (0..segments)
                .map(|k| ring.point(TAU * k as f32 / segments as f32, swell))
                .collect::<Vec<_>>();
            let circle = corners.into_iter().map(|corner| builder.vertex(corner, paint)).collect();
            builder.worn = shell;
            circle
        };
        let mut previous: Option<(Vec<u32>, (Paint, u32))> = None;
        for pair in rings.windows(2) {
            let (paint, band) = (pair[0].paint, pair[0].cover);
            let behind = |k: usize| libm::cosf(TAU * (k as f32 + 0.5) / segments as f32) < 0.1;
            if let Some(back_paint) = pair[0].back_paint {
                let [low, high] = [pair[0], pair[1]].map(|ring| circle(self, ring, paint, band));
                let [low_back, high_back] =
                    [pair[0], pair[1]].map(|ring| circle(self, ring, back_paint, band));
                for k in 0..segments {
                    let next = (k + 1) % segments;
                    let (low, high) = if behind(k) { (&low_back, &high_back) } else { (&low, &high) };
                    self.quad(low[k], low[next], high[next], high[k]);
                }
                previous = None;
                continue;
            }
            let low = match previous.take() {
                Some((circle, painted)) if painted == (paint, band.part) => circle,
                _ => circle(self, pair[0], paint, band),
            };
            let high = circle(self, pair[1], paint, band);
            for k in 0..segments {
                let next = (k + 1) % segments;
                self.quad(low[k], low[next], high[next], high[k]);
            }
            previous = Some((high, (paint, band.part)));
        }
        let along = (last.center - first.center).normalize_or_zero();
        for (ring, paint, cap, out, reversed) in [
            (first, first.paint, caps[0], -along, true),
            (last, rings[rings.len().saturating_sub(2)].paint, caps[1], along, false),
        ] {
            let Cap::Fan(height) = cap else { continue };
            let rim = circle(self, ring, paint, Cover::default());
            let tip = self.vertex(ring.center + out * height, paint);
            for k in 0..segments {
                let next = (k + 1) % segments;
                if reversed {
                    self.triangle(rim[next], rim[k], tip);
                } else {
                    self.triangle(rim[k], rim[next], tip);
                }
            }
        }
    }

    /// A surface over a grid of points `[row][column]`, closed around when `around` is set.
    pub(super) fn grid(&mut self, rows: &[Vec<Vec3>], around: bool, paint: Paint) {
        self.painted_grid(rows, around, &|_, _| paint);
    }

    /// The same with a paint for each (row, column), between which colours blend.
    pub(super) fn painted_grid(
        &mut self,
        rows: &[Vec<Vec3>],
        around: bool,
        paint: &dyn Fn(usize, usize) -> Paint,
    ) {
        let mut low: Vec<u32> = Vec::new();
        for (number, row) in rows.iter().enumerate() {
            let high: Vec<u32> =
                row.iter().enumerate().map(|(column, p)| self.vertex(*p, paint(number, column))).collect();
            let columns = if around { low.len() } else { low.len().saturating_sub(1) };
            for k in 0..columns {
                let next = (k + 1) % low.len();
                self.quad(low[k], low[next], high[next], high[k]);
            }
            low = high;
        }
    }

    /// Closes a surface over its last row of points: a fan about their middle, so much higher, m.
    pub(super) fn close(&mut self, last: Option<&Vec<Vec3>>, rise: f32, paint: Paint) {
        let Some(last) = last else { return };
        let rim: Vec<u32> = last.iter().map(|&p| self.vertex(p, paint)).collect();
        let tip = last.iter().sum::<Vec3>() / last.len() as f32 + Vec3::Y * rise;
        let tip = self.vertex(tip, paint);
        for k in 0..rim.len() {
            self.triangle(rim[k], rim[(k + 1) % rim.len()], tip);
        }
    }

    /// A flat convex patch as its own shell, seen from `facing`.
    pub(super) fn patch(
        &mut self,
        corners: &[Vec3],
        facing: Vec3,
        paint: Paint,
        shares: &'a dyn Fn(Vec3) -> Shares,
    ) {
        self.begin(shares);
        let fan: Vec<u32> = corners.iter().map(|&p| self.vertex(p, paint)).collect();
        for pair in fan.windows(2).skip(1) {
            self.triangle(fan[0], pair[0], pair[1]);
        }
        self.end(Some(facing));
    }
}

/// The four largest shares, normalised to sum 1; ties go to the lower joint.
pub(in crate::avatar) fn pack(shares: &Shares) -> ([u8; 4], [f32; 4]) {
    let mut order: [usize; JOINT_COUNT] = std::array::from_fn(|joint| joint);
    order.sort_by(|&a, &b| shares[b].total_cmp(&shares[a]).then(a.cmp(&b)));
    let total: f32 = order[..4].iter().map(|&joint| shares[joint].max(0.0)).sum();
    let mut joints = [0; 4];
    let mut weights = [0.0; 4];
    for slot in 0..4 {
        let share = shares[order[slot]].max(0.0);
        if total > 0.0 && share > 0.0 {
            joints[slot] = u8::try_from(order[slot]).unwrap_or(0);
            weights[slot] = share / total;
        }
    }
    if total <= 0.0 {
        weights[0] = 1.0;
    }
    (joints, weights)
}
