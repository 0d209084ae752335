//! Head, hair and, of the coarser levels, face.

use super::shape::{Builder, Cap, Cover, Paint, Ring, Shares};
use super::{HAIR, Material, Measures, SKIN, Sex};
use crate::kernels::shared::outfit::BEARD;
use glam::Vec3;
use std::f32::consts::TAU;

pub(super) type Skin<'a> = &'a dyn Fn(Vec3) -> Shares;

/// (height under the crown, half width, front, back, coarsest level) of the skull, man's size, metres.
pub(super) const SKULL: [(f32, f32, f32, f32, usize); 9] = [
    (0.236, 0.026, 0.084, -0.020, 1),
    (0.222, 0.044, 0.097, 0.012, 0),
    (0.190, 0.061, 0.099, -0.040, 2),
    (0.150, 0.071, 0.097, -0.080, 0),
    (0.110, 0.075, 0.093, -0.092, 1),
    (0.080, 0.077, 0.098, -0.097, 0),
    (0.048, 0.072, 0.088, -0.092, 2),
    (0.018, 0.052, 0.058, -0.066, 1),
    (0.000, 0.016, 0.015, -0.024, 2),
];
/// A bearded head keeps this row in the second level as well: there the beard ends.
const BEARD_EDGE: usize = 3;
pub(super) const SQUARE: f32 = 2.3;
/// How fast hair closes in on the nape and, beside it, on the neck, metres per metre of height: down to the jaw, and short.
pub(super) const TO_JAW: [f32; 2] = [0.30, 0.16];
pub(super) const SHORT: [f32; 2] = [0.45, 0.05];
/// Where an edge turns in to, outside the skin, m.
pub(super) const UNDER_SHELL: f32 = -0.004;
const IN_EAR: Paint = Paint { material: Material::Skin, color: Vec3::new(0.50, 0.38, 0.36) };
const EYE: Paint = Paint::fixed(0.015, 0.012, 0.01);
/// Eyes, brows and mouth of the second level are so far in front of the skin, m: its facets cut corners off the curved face.
pub(super) const BEFORE_FACETS: f32 = 0.006;

/// The skull as a function of height.
pub(super) struct Skull {
    pub(super) crown: f32,
    pub(super) size: f32,
    pub(super) sex: Sex,
    /// How fast its hair closes in: see [`TO_JAW`].
    nape: f32,
    side: f32,
}

impl Skull {
    pub(super) fn of(measures: &Measures) -> Self {
        let size = if measures.sex == Sex::Male { 1.0 } else { 0.955 };
        let [nape, side] = if measures.sex == Sex::Male { SHORT } else { TO_JAW };
        // Hair adds to the stature, so the crown of the skull lies under it.
        Self { crown: measures.height - 0.014 * size, size, sex: measures.sex, nape, side }
    }

    /// The same under hair that closes in otherwise.
    pub(super) const fn with(&self, [nape, side]: [f32; 2]) -> Self {
        Self { nape, side, ..*self }
    }

    /// (half width, front, back) at `drop` under the crown (man's size), unscaled.
    pub(super) fn section(drop: f32) -> (f32, f32, f32) {
        let drop = drop.clamp(0.0, SKULL[0].0);
        let above = SKULL.iter().position(|row| row.0 <= drop).unwrap_or(SKULL.len() - 1).max(1);
        let (low, high) = (SKULL[above - 1], SKULL[above]);
        let t = (low.0 - drop) / (low.0 - high.0).max(1e-6);
        let mix = |a: f32, b: f32| a + (b - a) * t;
        (mix(low.1, high.1), mix(low.2, high.2), mix(low.3, high.3))
    }

    /// Point on the face `x` to the left and `drop` under the crown (man's size), `out` in front of the skin.
    pub(super) fn face(&self, x: f32, drop: f32, out: f32) -> Vec3 {
        let (half_width, front, back) = Self::section(drop);
        let middle = 0.5 * (front + back);
        let depth = libm::powf(1.0 - libm::powf((x.abs() / half_width).min(1.0), SQUARE), 1.0 / SQUARE);
        Vec3::new(
            x * self.size,
            self.crown - drop * self.size,
            (middle + (front - middle) * depth + out) * self.size,
        )
    }

    /// Point around the skull at `angle` from the front, `thick` outside the skin.
    pub(super) fn around(&self, angle: f32, drop: f32, thick: f32) -> Vec3 {
        // Hair falls from the widest part: below it the outline does not follow the jaw inward.
        let (mut half_width, front, mut back) = Self::section(drop.max(0.004));
        if drop > 0.11 {
            let (ear, _, nape) = Self::section(0.11);
            half_width = ear - (drop - 0.11) * self.side;
            back = nape + (drop - 0.11) * self.nape;
        }
        let middle = 0.5 * (front + back);
        let rounded = |v: f32| v.signum() * libm::powf(v.abs(), 2.0 / SQUARE);
        let x = rounded(libm::sinf(angle)) * (half_width + thick);
        let z = middle + rounded(libm::cosf(angle)) * (front - middle + thick);
        Vec3::new(x * self.size, self.crown + (thick * 0.9 - drop) * self.size, z * self.size)
    }

    /// A place by its distance from the middle to the left, under the crown and to the front (man's size), m.
    pub(super) fn beside(&self, [aside, drop, ahead]: [f32; 3]) -> Vec3 {
        Vec3::new(aside * self.size, self.crown - drop * self.size, ahead * self.size)
    }
}

impl Skull {
    pub(super) fn ears<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        [-1.0, 1.0].into_iter().for_each(|side| self.ear(builder, skin, side));
    }

    /// A shell beside the head, hollow in front, that stands off at the back.
    fn ear<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>, side: f32) {
        const COLUMNS: u8 = 8;
        /// Of the middle: aside, under the crown, ahead, m (man's size).
        const AT: [f32; 3] = [0.074, 0.126, -0.006];
        const HALF: [f32; 2] = [0.0165, 0.0310]; // broad, high, m
        const LEAN: f32 = 0.2; // to the back, of its height
        const OFF: f32 = 0.32; // of its breadth
        // of the outline, and aside, m
        let place = |angle: f32, share: f32, out: f32| {
            let (sine, cosine) = libm::sincosf(angle);
            // the lobe is narrower than the helix
            let back = -cosine * HALF[0] * (1.0 + 0.3 * sine) * share;
            let up = sine * HALF[1] * share;
            let back = back + LEAN * up;
            Vec3::new(
                side * (AT[0] + (back + HALF[0]) * OFF * share.min(1.0) + out) * self.size,
                self.crown + (up - AT[1]) * self.size,
                (AT[2] - back) * self.size,
            )
        };
        let row = |share: f32, out: f32| -> Vec<Vec3> {
            (0..COLUMNS).map(|k| place(TAU * f32::from(k) / f32::from(COLUMNS), share, out)).collect()
        };
        builder.begin(skin);
        let rows =
            [row(0.8, -0.012), row(0.98, -0.002), row(1.0, 0.002), row(0.72, 0.0015), row(0.35, -0.005)];
        let shade = |row: usize, _| if row == 4 { IN_EAR } else { SKIN };
        builder.painted_grid(&rows, true, &shade);
        builder.end(Some(Vec3::X * side));
    }
}

impl Measures {
    pub(super) fn head<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        let skull = Skull::of(self);
        if builder.level == 0 {
            skull.face_and_eyes(builder, skin);
            self.own_hair(builder, &skull, skin);
            return;
        }
        let size = skull.size;
        let segments = [7, 5][(builder.level - 1).min(1)];
        let mut rings: Vec<Ring> = SKULL
            .iter()
            .enumerate()
            .map(|(row, &(drop, half_width, front, back, keep))| Ring {
                center: Vec3::new(0.0, skull.crown - drop * size, 0.5 * (front + back) * size),
                side: Vec3::X * half_width * size,
                front: Vec3::Z * 0.5 * (front - back) * size,
                back: 1.0,
                square: SQUARE,
                // Without a hair shell, the coarsest head wears its hair as paint.
                paint: if builder.level >= 2 && drop < 0.06 { HAIR } else { SKIN },
                back_paint: (builder.level >= 2).then_some(HAIR),
                keep: if row == BEARD_EDGE && self.sex == Sex::Male { 1 } else { keep },
                cover: Cover::default(),
            })
            .collect();
        let first = builder.len();
        builder.begin(skin);
        if builder.level >= 2 {
            // The neck belongs to the coarsest head.
            let base = if self.sex == Sex::Male { 1.50 } else { 1.38 };
            let under =
                Ring { center: Vec3::new(0.0, base, -0.005), paint: SKIN, back_paint: None, ..rings[1] };
            rings.insert(0, Ring { side: Vec3::X * 0.05, front: Vec3::Z * 0.05, keep: 2, ..under });
        }
        builder.loft(
            &rings,
            segments,
            [if builder.level >= 2 { Cap::Open } else { Cap::Fan(0.004) }, Cap::Fan(0.002)],
        );
        builder.end(None);
        if builder.level < 2 {
            if self.sex == Sex::Male {
                builder.cover(first, BEARD, &|own| skull.is_low_and_in_front(own.position));
            }
            self.own_hair(builder, &skull, skin);
            self.nose(builder, &skull, skin);
            Self::eyes(builder, &skull, skin);
            skull.brows_and_mouth(builder, skin);
        }
    }

    fn nose<'a>(&self, builder: &mut Builder<'a>, skull: &Skull, skin: Skin<'a>) {
        let reach = if self.sex == Sex::Male { 0.024 } else { 0.019 };
        let shade = Paint::tinted(Material::Skin, 0.8);
        let bridge = skull.face(0.0, 0.106, 0.001);
        let tip = skull.face(0.0, 0.152, reach);
        let left = skull.face(0.016, 0.160, 0.001);
        let right = skull.face(-0.016, 0.160, 0.001);
        builder.begin(skin);
        let ids = [bridge, tip, left, right].map(|p| builder.vertex(p, SKIN));
        builder.triangle(ids[0], ids[2], ids[1]);
        builder.triangle(ids[0], ids[1], ids[3]);
        let under = [tip, left, right].map(|p| builder.vertex(p, shade));
        builder.triangle(under[0], under[1], under[2]);
        builder.end(Some(Vec3::Z));
    }

    fn eyes<'a>(builder: &mut Builder<'a>, skull: &Skull, skin: Skin<'a>) {
        let [w, h] = [0.0140, 0.0070];
        for side in [-1.0, 1.0] {
            let corners = [(-w, 0.0), (-0.5 * w, h), (0.5 * w, h), (w, 0.0), (0.5 * w, -h), (-0.5 * w, -h)];
            let mut corners =
                corners.map(|(dx, dy)| skull.face(side * 0.032 + dx, 0.108 + dy, BEFORE_FACETS));
            let depth = corners.iter().map(|p| p.z).sum::<f32>() / 6.0;
            corners.iter_mut().for_each(|p| p.z = 0.4 * p.z + 0.6 * depth);
            builder.patch(&corners, Vec3::Z, EYE, skin);
        }
    }
}
