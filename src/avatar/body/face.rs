//! The finest head: a face in relief, and eyes that turn under lids.
//!
//! The surface of the skull is moved forwards and back by soft bumps. Eyeballs are caps of spheres set into its sockets, with
//! shells of skin just outside as lids. They hang on joints of their own, which kernel `eyes` turns.

use super::head::{SQUARE, Skin, Skull};
use super::shape::{Builder, Paint};
use super::weights::step;
use super::{Material, SKIN, Sex};
use crate::kernels::shared::body::{LEFT_EYE, LIDS, RIGHT_EYE};
use glam::Vec3;
use std::f32::consts::{PI, TAU};

const WHITE: Paint = Paint::fixed(0.62, 0.6, 0.57);
const IRIS: Paint = Paint::fixed(0.1, 0.053, 0.026);
const RIM: Paint = Paint::fixed(0.03, 0.018, 0.012);
const PUPIL: Paint = Paint::fixed(0.006, 0.005, 0.005);
const GLINT: Paint = Paint::fixed(1.0, 1.0, 1.0);
const LASHES: Paint = Paint::tinted(Material::Skin, 0.22);
const LIPS: Paint = Paint { material: Material::Skin, color: Vec3::new(0.72, 0.42, 0.42) };
const MOUTH: Paint = Paint { material: Material::Skin, color: Vec3::new(0.5, 0.26, 0.26) };
const BROW: Paint = Paint::tinted(Material::Hair, 0.75);

/// Of the finest head: rows under the crown (man's size), m. Above the last one there is hair.
const ROWS: [f32; 22] = [
    0.236, 0.230, 0.220, 0.208, 0.198, 0.193, 0.1885, 0.184, 0.176, 0.168, 0.160, 0.153, 0.144, 0.134, 0.125,
    0.118, 0.111, 0.104, 0.097, 0.089, 0.075, 0.045,
];
/// Of its half: columns as shares of the half width, from the middle of the face to the side; then angles from the front.
const COLUMNS: [f32; 10] = [0.0, 0.095, 0.2, 0.31, 0.42, 0.53, 0.64, 0.76, 0.88, 1.0];
const BACK: [f32; 2] = [2.1, 2.65];

/// Centre of the left eyeball at the side of the middle and under the crown (man's size), and its depth and radius, m.
const EYE_AT: [f32; 2] = [0.0315, 0.1115];
const EYE_DEPTH: f32 = 0.0715;
const EYE_RADIUS: f32 = 0.0160;

/// A soft bump, 1 in the middle.
fn bump(x: f32, y: f32) -> f32 {
    libm::expf(-(x * x + y * y))
}

impl Skull {
    /// What the face adds in front of the skull at `x` to the left and `drop` under the crown (man's size), m.
    fn relief(&self, x: f32, drop: f32) -> f32 {
        let x = x.abs();
        let is_man = self.sex == Sex::Male;
        let [eye, eye_drop] = EYE_AT;
        let socket = 0.008 * bump((x - eye) / 0.0165, (drop - eye_drop + 0.003) / 0.0120);
        let temple = 0.0055 * bump((x - 0.049) / 0.010, (drop - 0.110) / 0.015);
        let ridge = if is_man { 0.0035 } else { 0.001 };
        let ridge = ridge * bump((x - 0.026) / 0.022, (drop - 0.094) / 0.008);
        let along = ((drop - 0.100) / (0.155 - 0.100)).clamp(0.0, 1.0);
        let (tip, width) = if is_man { (0.0235, 0.0105) } else { (0.0185, 0.0095) };
        let nose = (0.005 + (tip - 0.005) * along) * bump(x / (0.0065 + (width - 0.0065) * along), 0.0);
        let nose = nose * step(0.088, 0.108, drop) * step(0.1665, 0.156, drop);
        let wings = 0.006 * bump((x - 0.0125) / 0.006, (drop - 0.1555) / 0.006);
        let cheek = 0.003 * bump((x - 0.040) / 0.018, (drop - 0.146) / 0.020);
        let under = 0.0018 * bump((x - eye) / 0.016, (drop - 0.127) / 0.007);
        let lips = 0.0045 * bump(x / 0.021, (drop - 0.1845) / 0.0045)
            + 0.005 * bump(x / 0.018, (drop - 0.1935) / 0.005);
        let mouth = 0.0025 * bump(x / 0.024, (drop - 0.1885) / 0.0025);
        let chin = 0.004 * bump(x / 0.018, (drop - 0.216) / 0.011);
        ridge + temple + nose + wings + cheek + under + lips + chin - socket - mouth
    }

    /// The skin at an angle from the front, to the left; the face's relief is in it.
    fn skin(&self, angle: f32, drop: f32, out: f32) -> Vec3 {
        let (half_width, front, back) = Self::section(drop);
        let middle = 0.5 * (front + back);
        let rounded = |v: f32| v.signum() * libm::powf(v.abs(), 2.0 / SQUARE);
        let x = rounded(libm::sinf(angle)) * half_width;
        let ahead = rounded(libm::cosf(angle));
        let relief = if ahead > 0.0 { self.relief(x, drop) + out } else { 0.0 };
        Vec3::new(
            x * self.size,
            self.crown - drop * self.size,
            (middle + (front - middle) * ahead + relief) * self.size,
        )
    }

    /// The angle at which the skin is at a share of the half width.
    fn angle(share: f32) -> f32 {
        share.signum() * libm::asinf(libm::powf(share.abs().min(1.0), 0.5 * SQUARE))
    }

    /// Centre of the left eyeball, m.
    pub(super) fn eyeball(&self) -> Vec3 {
        let [x, drop] = EYE_AT;
        Vec3::new(x * self.size, self.crown - drop * self.size, EYE_DEPTH * self.size)
    }

    /// The finest head without its hair.
    pub(super) fn face_and_eyes<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        self.head_and_face(builder, skin);
        for side in [-1.0, 1.0] {
            self.brow(builder, skin, side);
            let center = self.eyeball() * Vec3::new(side, 1.0, 1.0);
            let eye = Eye { center, radius: EYE_RADIUS * self.size, side };
            eye.ball(builder);
            eye.lower_lid(builder, skin);
            eye.upper_lid(builder);
        }
    }

    fn head_and_face<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        let half: Vec<f32> = COLUMNS[1..].iter().map(|share| Self::angle(*share)).chain(BACK).collect();
        let left = half.iter().copied();
        let right = half.iter().rev().map(|angle| -angle);
        let angles: Vec<f32> = std::iter::once(0.0).chain(left).chain([PI]).chain(right).collect();
        let rows: Vec<Vec<Vec3>> = ROWS
            .iter()
            .map(|drop| angles.iter().map(|angle| self.skin(*angle, *drop, 0.0)).collect())
            .collect();
        let paint = |row: usize, column: usize| {
            let p = rows[row][column];
            // from the upper to the lower lip: half its width, and its paint
            let (half, lip) = match row {
                7 => (0.013, LIPS),
                6 => (0.024, MOUTH),
                5 => (0.015, LIPS),
                _ => return SKIN,
            };
            if p.z > 0.0 && p.x.abs() < half * self.size { lip } else { SKIN }
        };
        builder.begin(skin);
        builder.painted_grid(&rows, true, &paint);
        // The bottom; the top is open, under the hair.
        let rim: Vec<u32> = rows[0].iter().map(|p| builder.vertex(*p, SKIN)).collect();
        let middle = rows[0].iter().sum::<Vec3>() / angles.len() as f32;
        let tip = builder.vertex(middle - Vec3::Y * 0.004, SKIN);
        for k in 0..rim.len() {
            builder.triangle(rim[(k + 1) % rim.len()], rim[k], tip);
        }
        builder.end(None);
    }

    /// A strip of hair over an eye, following the skin.
    fn brow<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>, side: f32) {
        let thick = if self.sex == Sex::Male { 0.0042 } else { 0.0028 };
        let strip = |edge: f32| -> Vec<Vec3> {
            let at = |t: f32| {
                let x = side * (0.0125 + 0.037 * t);
                let (half_width, ..) = Self::section(0.092);
                // Highest at two thirds, and pointed at the temple.
                let drop = 0.0925 - 0.0035 * libm::sinf(t * 2.5) + edge * thick * (0.65 + t - 1.4 * t * t);
                self.skin(Self::angle(x / half_width), drop, 0.0017)
            };
            (0..6_u8).map(|k| at(f32::from(k) / 5.0)).collect()
        };
        builder.begin(skin);
        builder.grid(&[strip(0.7), strip(-0.7)], false, BROW);
        builder.end(Some(Vec3::Z));
    }
}

/// An eye: a sphere that looks along +z.
struct Eye {
    center: Vec3,
    radius: f32,
    side: f32,
}

impl Eye {
    /// The point at `aside` towards the temple and turned up by `up` about the axis through both eyes, degrees.
    fn at(&self, aside: f32, up: f32, out: f32) -> Vec3 {
        let (sine, cosine) = libm::sincosf(aside.to_radians());
        let (high, ahead) = libm::sincosf(up.to_radians());
        let direction = Vec3::new(self.side * sine, cosine * high, cosine * ahead);
        self.center + direction * (self.radius + out)
    }

    fn ball(&self, builder: &mut Builder<'_>) {
        const SLICES: u8 = 12;
        builder.begin_on(if self.side > 0.0 { LEFT_EYE } else { RIGHT_EYE });
        let ring = |angle: f32, paint: Paint, builder: &mut Builder<'_>| -> Vec<u32> {
            let (sine, cosine) = libm::sincosf(angle.to_radians());
            (0..SLICES)
                .map(|k| {
                    let (up, aside) = libm::sincosf(TAU * f32::from(k) / f32::from(SLICES));
                    let direction = Vec3::new(sine * aside, sine * up, cosine);
                    builder.vertex(self.center + direction * self.radius, paint)
                })
                .collect()
        };
        let pupil = ring(9.5, PUPIL, builder);
        for pair in pupil.windows(2).skip(1) {
            builder.triangle(pupil[0], pair[0], pair[1]);
        }
        let bands: [&[(f32, Paint)]; 2] =
            [&[(9.5, IRIS), (23.0, RIM)], &[(23.0, WHITE), (48.0, WHITE), (84.0, WHITE)]];
        for band in bands {
            let rings: Vec<Vec<u32>> =
                band.iter().map(|(angle, paint)| ring(*angle, *paint, builder)).collect();
            for pair in rings.windows(2) {
                let [inner, outer] = [&pair[0], &pair[1]];
                for k in 0..inner.len() {
                    let next = (k + 1) % inner.len();
                    builder.triangle(inner[k], outer[k], outer[next]);
                    builder.triangle(inner[k], outer[next], inner[next]);
                }
            }
        }
        builder.end(Some(Vec3::Z));
        builder.begin_on(if self.side > 0.0 { LEFT_EYE } else { RIGHT_EYE });
        // To the same side in both eyes, as light falls in.
        let spot = [(2.5, 6.0), (6.0, 6.5), (5.5, 10.5), (3.0, 9.5)]
            .map(|(x, up)| self.at(self.side * x, up, 0.0003));
        let ids = spot.map(|p| builder.vertex(p, GLINT));
        builder.triangle(ids[0], ids[1], ids[2]);
        builder.triangle(ids[0], ids[2], ids[3]);
        builder.end(Some(Vec3::Z));
    }

    /// A lid as a shell outside the eyeball, from its margin, which is dark with lashes, to `end`, degrees. It is fine enough
    /// for its facets to stay outside the eyeball, however it is turned.
    fn lid(&self, builder: &mut Builder<'_>, margin: &dyn Fn(f32) -> f32, lashes: f32, end: f32, out: f32) {
        const ASIDE: [f32; 11] = [-84.0, -62.0, -47.0, -32.0, -16.0, 0.0, 16.0, 32.0, 47.0, 62.0, 84.0];
        let row = |share: f32, first: f32| -> Vec<Vec3> {
            let up = |aside: f32| {
                let from = margin(aside) + first;
                from + (end - from) * share
            };
            ASIDE.iter().map(|aside| self.at(*aside, up(*aside), out)).collect()
        };
        builder.grid(&[row(0.0, 0.0), row(0.0, lashes)], false, LASHES);
        builder.grid(&[0.0, 0.22, 0.45, 0.7, 1.0].map(|share| row(share, lashes)), false, SKIN);
        builder.end(Some(Vec3::Z));
    }

    fn upper_lid(&self, builder: &mut Builder<'_>) {
        builder.begin_on(LIDS);
        let margin = |aside: f32| 18.0 - 22.0 * (aside / 50.0) * (aside / 50.0);
        self.lid(builder, &margin, 5.0, 105.0, 0.0012 * self.radius / EYE_RADIUS);
    }

    fn lower_lid<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        builder.begin(skin);
        let margin = |aside: f32| -16.0 + 12.0 * (aside / 50.0) * (aside / 50.0);
        self.lid(builder, &margin, -2.0, -80.0, 0.0007 * self.radius / EYE_RADIUS);
    }
}
