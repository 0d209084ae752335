//! Head, hair and, of the coarser levels, face.

use super::shape::{Builder, Cap, Cover, Paint, Ring, Shares};
use super::weights::step;
use super::{HAIR, Material, Measures, SKIN, Sex};
use crate::kernels::shared::outfit::HAIR_DOWN;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

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
pub(super) const SQUARE: f32 = 2.3;
const UNDER_HAIR: Paint = Paint::tinted(Material::Hair, 0.55);
/// Shades of hair from column to column of the finest level: the same on both sides.
const STRANDS: [f32; 12] = [0.96, 1.0, 0.86, 0.95, 0.80, 0.92, 0.85, 0.92, 0.80, 0.95, 0.86, 1.0];
const IN_EAR: Paint = Paint { material: Material::Skin, color: Vec3::new(0.50, 0.38, 0.36) };
const EYE: Paint = Paint::fixed(0.015, 0.012, 0.01);

/// How hair is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cut {
    /// Down to the jaw, over the ears.
    Long,
    /// Off the ears, a short nape.
    Short,
    /// The same of long hair that is tied up.
    Up,
}

impl Cut {
    const fn of(sex: Sex) -> Self {
        match sex {
            Sex::Female => Self::Long,
            Sex::Male => Self::Short,
        }
    }

    /// How fast the hair closes in on the nape and, beside it, on the neck, metres per metre of height.
    const fn closing(self) -> [f32; 2] {
        match self {
            Self::Long => [0.30, 0.16],
            Self::Short | Self::Up => [0.45, 0.05],
        }
    }
}

/// The skull as a function of height.
pub(super) struct Skull {
    pub(super) crown: f32,
    pub(super) size: f32,
    pub(super) sex: Sex,
    /// See [`Cut::closing`].
    nape: f32,
    side: f32,
}

impl Skull {
    pub(super) fn of(measures: &Measures) -> Self {
        let size = if measures.sex == Sex::Male { 1.0 } else { 0.955 };
        let [nape, side] = Cut::of(measures.sex).closing();
        // Hair adds to the stature, so the crown of the skull lies under it.
        Self { crown: measures.height - 0.014 * size, size, sex: measures.sex, nape, side }
    }

    /// The same under other hair.
    pub(super) const fn with(self, cut: Cut) -> Self {
        let [nape, side] = cut.closing();
        Self { nape, side, ..self }
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
}

impl Skull {
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
            .map(|&(drop, half_width, front, back, keep)| Ring {
                center: Vec3::new(0.0, skull.crown - drop * size, 0.5 * (front + back) * size),
                side: Vec3::X * half_width * size,
                front: Vec3::Z * 0.5 * (front - back) * size,
                back: 1.0,
                square: SQUARE,
                // Without a hair shell, the coarsest head wears its hair as paint.
                paint: if builder.level >= 2 && drop < 0.06 { HAIR } else { SKIN },
                back_paint: (builder.level >= 2).then_some(HAIR),
                keep,
                cover: Cover::default(),
            })
            .collect();
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
            self.own_hair(builder, &skull, skin);
            self.nose(builder, &skull, skin);
            Self::eyes(builder, &skull, skin);
        }
    }

    /// The hair of a body's own outfit: women wear it down.
    fn own_hair<'a>(&self, builder: &mut Builder<'a>, skull: &Skull, skin: Skin<'a>) {
        if self.sex == Sex::Female {
            builder.wear(HAIR_DOWN, true);
        }
        Self::hair(builder, skull, Cut::of(self.sex), skin);
        builder.wear(0, true);
    }

    /// A shell of hair.
    pub(super) fn hair<'a>(builder: &mut Builder<'a>, skull: &Skull, cut: Cut, skin: Skin<'a>) {
        let is_finest = builder.level == 0;
        let (columns, rows) = match (cut, is_finest) {
            (_, false) => (7, 2),
            (Cut::Up, true) => (18, 5),
            _ => (24, 6),
        };
        let hairline = |angle: f32| -> f32 {
            let turn = if angle > PI { TAU - angle } else { angle };
            // parted on the left: a fringe falls to the right; the skull is open above its last row
            let fringe = match (cut, is_finest) {
                (_, false) => 0.052,
                (Cut::Long, true) => 0.049 + 0.015 * step(-0.45, 0.75, -libm::sinf(angle)),
                (Cut::Short | Cut::Up, true) => 0.048 + 0.008 * step(-0.45, 0.75, -libm::sinf(angle)),
            };
            match cut {
                // shorter in front
                Cut::Long => {
                    fringe + (0.212 + 0.026 * step(1.2, 2.3, turn) - fringe) * step(0.85, 1.35, turn)
                }
                // Sideburns in front of the ear, a short nape.
                Cut::Short | Cut::Up => {
                    fringe + (0.118 - fringe) * step(0.85, 1.5, turn) + 0.055 * step(1.7, 2.4, turn)
                }
            }
        };
        let thick = [0.013, 0.020][builder.level.min(1)] + if cut == Cut::Long { 0.005 } else { -0.002 };
        // Long hair grows thin towards its ends; short hair is fullest half way up.
        let fullness = |t: f32| match cut {
            _ if !is_finest => 1.0,
            Cut::Long => 0.8 + 0.2 * step(0.0, 0.4, t) + 0.12 * libm::sinf(PI * t),
            Cut::Short | Cut::Up => 1.0 + 0.3 * libm::sinf(PI * t),
        };
        let mut grid: Vec<Vec<Vec3>> = Vec::new();
        for row in 0..=rows + 1 {
            // The first row turns in under the hair's edge, so that it has thickness.
            let t = (row as f32 - 1.0).max(0.0) / rows as f32;
            let thickness = if row == 0 { -0.004 } else { thick * fullness(t) };
            let ring = (0..columns).map(|k| {
                let angle = TAU * k as f32 / columns as f32;
                // Flatter over the forehead, where it would look like a peak.
                let thickness =
                    thickness * (1.0 - 0.4 * (1.0 - step(0.2, 1.3, angle.min(TAU - angle))) * (1.0 - t));
                skull.around(angle, hairline(angle) * libm::powf(1.0 - t, 1.35), thickness)
            });
            grid.push(ring.collect());
        }
        let strands = |row: usize, column: usize| match row {
            _ if !is_finest => HAIR,
            0 => UNDER_HAIR,
            _ => Paint::tinted(Material::Hair, STRANDS[column % STRANDS.len()]),
        };
        builder.begin(skin);
        builder.painted_grid(&grid, true, &strands);
        // The crown.
        if let Some(top) = grid.last() {
            let rim: Vec<u32> = top.iter().map(|&p| builder.vertex(p, HAIR)).collect();
            let tip = top.iter().sum::<Vec3>() / columns as f32 + Vec3::Y * 0.001;
            let tip = builder.vertex(tip, HAIR);
            for k in 0..rim.len() {
                builder.triangle(rim[k], rim[(k + 1) % rim.len()], tip);
            }
        }
        builder.end(None);
        if cut != Cut::Long && builder.level == 0 {
            [-1.0, 1.0].into_iter().for_each(|side| skull.ear(builder, skin, side));
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
        let [w, h] = [0.018, 0.011];
        for side in [-1.0, 1.0] {
            let corners = [(-w, 0.0), (-0.5 * w, h), (0.5 * w, h), (w, 0.0), (0.5 * w, -h), (-0.5 * w, -h)];
            // Flat and just in front of the facets, which cut corners off the curved face.
            let mut corners = corners.map(|(dx, dy)| skull.face(side * 0.032 + dx, 0.108 + dy, 0.006));
            let depth = corners.iter().map(|p| p.z).sum::<f32>() / 6.0;
            corners.iter_mut().for_each(|p| p.z = 0.4 * p.z + 0.6 * depth);
            builder.patch(&corners, Vec3::Z, EYE, skin);
        }
    }
}
