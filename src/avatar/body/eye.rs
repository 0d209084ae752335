//! An eye of the finest level: a ball that turns, and lids over it.

use super::head::Skin;
use super::shape::{Builder, Paint};
use super::{Material, SKIN};
use crate::kernels::shared::body::{LEFT_EYE, LIDS, RIGHT_EYE};
use glam::Vec3;
use std::f32::consts::TAU;

const WHITE: Paint = Paint::fixed(0.62, 0.6, 0.57);
const IRIS: Paint = Paint::fixed(0.1, 0.053, 0.026);
const RIM: Paint = Paint::fixed(0.03, 0.018, 0.012);
const PUPIL: Paint = Paint::fixed(0.006, 0.005, 0.005);
const GLINT: Paint = Paint::fixed(1.0, 1.0, 1.0);
const LASHES: Paint = Paint::tinted(Material::Skin, 0.22);

/// Radius of an eyeball, man's size, m.
pub(super) const EYE_RADIUS: f32 = 0.0160;

/// An eye: a sphere that looks along +z.
pub(super) struct Eye {
    /// Of the ball, m.
    pub(super) center: Vec3,
    /// Of the ball, m.
    pub(super) radius: f32,
    /// 1 is the left one, -1 the right one.
    pub(super) side: f32,
}

impl Eye {
    /// The point at `aside` towards the temple and turned up by `up` about the axis through both eyes, degrees.
    fn at(&self, aside: f32, up: f32, out: f32) -> Vec3 {
        let (sine, cosine) = libm::sincosf(aside.to_radians());
        let (high, ahead) = libm::sincosf(up.to_radians());
        let direction = Vec3::new(self.side * sine, cosine * high, cosine * ahead);
        self.center + direction * (self.radius + out)
    }

    pub(super) fn ball(&self, builder: &mut Builder<'_>) {
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

    pub(super) fn upper_lid(&self, builder: &mut Builder<'_>) {
        builder.begin_on(LIDS);
        let margin = |aside: f32| 20.0 - 23.0 * (aside / 50.0) * (aside / 50.0);
        self.lid(builder, &margin, 5.0, 105.0, 0.0012 * self.radius / EYE_RADIUS);
    }

    pub(super) fn lower_lid<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        builder.begin(skin);
        let margin = |aside: f32| -19.0 + 13.0 * (aside / 50.0) * (aside / 50.0);
        self.lid(builder, &margin, -2.0, -80.0, 0.0007 * self.radius / EYE_RADIUS);
    }
}
