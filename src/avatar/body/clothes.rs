//! What the two bodies may wear beside their own outfits: trousers, jackets, coats, hats, glasses, backpacks, and the hair of
//! `hair`. One mesh, of which an agent shows the parts that its outfit has.

use super::face::{EYE_AT, EYE_DEPTH};
use super::head::{Skin, Skull};
use super::shape::{Builder, Cap, Paint, Shares, level_ring};
use super::trunk::{LOWER_SQUARE, Row, TRUNK_SIDES, UPPER_SQUARE, rings, rows_of, tilt_collar};
use super::{BOTTOM, Made, Material, Measures, Sex, TOP};
use crate::gait::{JOINT_COUNT, Joint};
use crate::kernels::shared::outfit::{BACKPACK, BRIM, CAP, COAT, GLASSES, JACKET, PEAK, TROUSERS};
use glam::Vec3;
use std::f32::consts::TAU;

/// The seat of a woman's trousers.
const SEAT: &[Row] = &[
    (0.785, 0.098, 0.080, 0.090, 2),
    (0.818, 0.160, 0.101, 0.122, 0),
    (0.880, 0.168, 0.107, 0.130, 1),
    (0.980, 0.142, 0.097, 0.098, 2),
];
/// Coats from their hem up.
// The upper row is where a skirt's is, and goes with the thighs as that does: else a skirt comes through where a thigh is lifted.
const FEMALE_COAT: &[Row] = &[(0.518, 0.216, 0.186, 0.194, 2), (0.640, 0.214, 0.173, 0.187, 0)];
const MALE_COAT: &[Row] = &[(0.540, 0.232, 0.188, 0.196, 2), (0.660, 0.228, 0.177, 0.190, 0)];
/// How far the hem of a jacket hangs below that of a top, and stands off it, m.
const HEM_DROP: f32 = 0.040;
const HEM_OFF: f32 = 0.010;
/// How far a collar stands up, and off the neck, m.
const COLLAR_RISE: f32 = 0.030;
const COLLAR_OFF: f32 = 0.005;
/// The inside of what hangs or stands open.
const SHADED: f32 = 0.55;
const FRAME: Paint = Paint::fixed(0.02, 0.018, 0.018);

impl Measures {
    /// Height of the collar of the top, m.
    pub(super) fn collar(&self) -> f32 {
        let (_, top) = rows_of(self.sex);
        top.last().map_or(self.height, |row| row.0)
    }

    /// All that a level has beside the body's own outfit.
    pub(super) fn clothes(&self, level: usize) -> Made {
        let bones = self.bones;
        let trunk = |p: Vec3| bones.trunk(p);
        let head = |_: Vec3| bones.head();
        let long = |p: Vec3| self.of_long_hair(p);
        let skirt = |p: Vec3| bones.skirt(p);
        let leg = |p: Vec3| self.of_leg(p);
        let back = |_: Vec3| -> Shares {
            let mut shares = [0.0; JOINT_COUNT];
            shares[Joint::Spine as usize] = 1.0;
            shares
        };
        let skull = Skull::of(self);
        let mut builder = Builder::new(level);
        let out = &mut builder;
        if self.sex == Sex::Female {
            out.wear(TROUSERS, false);
            self.seat(out, &trunk);
            [true, false].into_iter().for_each(|left| self.trouser_leg(out, left, &leg));
        }
        out.wear(COAT, false);
        self.coat(out, &skirt);
        out.wear(BACKPACK, false);
        self.backpack(out, &back);
        if level < 2 {
            out.wear(JACKET, false);
            self.hem_and_collar(out, &trunk);
            self.other_hair(out, &head, &long);
            out.wear(CAP, false);
            skull.cap(out, &head);
            out.wear(PEAK, false);
            skull.peak(out, &head);
            out.wear(BRIM, false);
            skull.brim(out, &head);
            out.wear(GLASSES, false);
            skull.glasses(out, &head);
        }
        builder.finish()
    }

    fn seat<'a>(&self, builder: &mut Builder<'a>, trunk: Skin<'a>) {
        let segments = [TRUNK_SIDES, 7, 5][builder.level.min(2)];
        builder.begin(trunk);
        builder.loft(&rings(SEAT, LOWER_SQUARE, BOTTOM), segments, [Cap::Fan(0.02), Cap::Open]);
        builder.end(None);
    }

    /// The hem of a jacket over the top's, and a collar that stands up.
    fn hem_and_collar<'a>(&self, builder: &mut Builder<'a>, trunk: Skin<'a>) {
        let segments = [TRUNK_SIDES, 7, 5][builder.level.min(2)];
        let (_, top) = rows_of(self.sex);
        let (Some(hem), Some(next), Some(neck)) = (top.first(), top.get(1), top.last()) else { return };
        let wider = |row: &Row, y: f32, off: f32, keep: usize| -> Row {
            (y, row.1 + off, row.2 + off, row.3 + off, keep)
        };
        let way = (0.05 / (next.0 - hem.0)).min(1.0);
        let mix = |a: f32, b: f32| a + (b - a) * way;
        let up = (mix(hem.0, next.0), mix(hem.1, next.1), mix(hem.2, next.2), mix(hem.3, next.3), 2);
        let under = wider(hem, hem.0 - HEM_DROP, HEM_OFF - 0.012, 0);
        let rows = [
            wider(hem, hem.0 - HEM_DROP, HEM_OFF, 2),
            wider(hem, hem.0, HEM_OFF, 0),
            wider(&up, up.0, 0.0, 2),
        ];
        let mut hanging = rings(&rows, UPPER_SQUARE, TOP);
        let inside = Paint::tinted(Material::Top, SHADED);
        hanging.splice(0..0, rings(&[under], UPPER_SQUARE, inside));
        builder.begin(trunk);
        builder.loft(&hanging, segments, [Cap::Open; 2]);
        builder.end(None);
        // it comes out of the top, and its edge turns in
        let rows = [
            wider(neck, neck.0 - 0.018, COLLAR_OFF, 2),
            wider(neck, neck.0 + COLLAR_RISE, COLLAR_OFF, 2),
            wider(neck, neck.0 + COLLAR_RISE, COLLAR_OFF - 0.006, 0),
            wider(neck, neck.0, COLLAR_OFF - 0.006, 0),
        ];
        let mut standing = rings(&rows, UPPER_SQUARE, TOP);
        for ring in &mut standing {
            tilt_collar(ring);
        }
        standing[2].paint = inside;
        builder.begin(trunk);
        builder.loft(&standing, segments, [Cap::Open; 2]);
        builder.end(None);
    }

    /// What of a coat is below a jacket's hem: it hangs on the thighs, as a skirt does.
    fn coat<'a>(&self, builder: &mut Builder<'a>, skirt: Skin<'a>) {
        let segments = [TRUNK_SIDES, 7, 5][builder.level.min(2)];
        let (_, top) = rows_of(self.sex);
        let (Some(hem), Some(next)) = (top.first(), top.get(1)) else { return };
        let rows = match self.sex {
            Sex::Female => FEMALE_COAT,
            Sex::Male => MALE_COAT,
        };
        let wider = |row: &Row, y: f32, off: f32, keep: usize| -> Row {
            (y, row.1 + off, row.2 + off, row.3 + off, keep)
        };
        let inside = Paint::tinted(Material::Top, SHADED);
        let mut hanging = rings(&rows[..1], LOWER_SQUARE, inside);
        hanging.extend(rings(rows, LOWER_SQUARE, TOP));
        // over the jacket's hem, and out of the jacket
        let over =
            [wider(hem, hem.0, HEM_OFF + 0.005, 1), wider(next, (hem.0 + 0.05).min(next.0), -0.002, 2)];
        hanging.extend(rings(&over, UPPER_SQUARE, TOP));
        builder.begin(skirt);
        builder.loft(&hanging, segments, [Cap::Fan(-0.05), Cap::Open]);
        builder.end(None);
    }

    fn backpack<'a>(&self, builder: &mut Builder<'a>, back: Skin<'a>) {
        let size = if self.sex == Sex::Male { 1.0 } else { 0.9 };
        let top = self.bones.of(Joint::LeftShoulder).y + 0.01;
        let segments = [8, 6, 4][builder.level.min(2)];
        // (below the top, half broad, half deep, how far its middle is behind the spine, coarsest level)
        const ROWS: [(f32, f32, f32, f32, usize); 5] = [
            (0.430, 0.105, 0.050, 0.150, 2),
            (0.400, 0.135, 0.078, 0.172, 0),
            (0.220, 0.142, 0.088, 0.186, 1),
            (0.060, 0.130, 0.072, 0.180, 0),
            (0.000, 0.090, 0.036, 0.160, 2),
        ];
        let ring = |&(below, broad, deep, behind, keep): &(f32, f32, f32, f32, usize)| {
            let center = Vec3::new(0.0, top - below * size, -behind * size);
            level_ring(center, [broad * size, deep * size], 3.2, TOP, keep)
        };
        builder.begin(back);
        builder.loft(&ROWS.iter().map(ring).collect::<Vec<_>>(), segments, [Cap::Fan(0.006); 2]);
        builder.end(None);
    }
}

impl Skull {
    /// How far a cap is outside the skin, m (man's size): over all hair.
    const CAP_OFF: f32 = 0.024;
    /// Its rim, under the crown at the front and at the back, m.
    const RIM: [f32; 2] = [0.060, 0.100];

    /// Where its rim is at an angle from the front, under the crown, m.
    fn rim(angle: f32) -> f32 {
        let [front, back] = Self::RIM;
        front + (back - front) * (0.5 - 0.5 * libm::cosf(angle))
    }

    fn cap<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        let (columns, rows) = if builder.level == 0 { (11_u8, 3_u8) } else { (7, 2) };
        let row = |t: f32, off: f32| -> Vec<Vec3> {
            let at = |k: u8| {
                let angle = TAU * f32::from(k) / f32::from(columns);
                self.around(angle, Self::rim(angle) * libm::powf(1.0 - t, 1.5), off)
            };
            (0..columns).map(at).collect()
        };
        // the first row turns in under the rim
        let mut grid = vec![row(0.0, 0.004)];
        grid.extend((0..=rows).map(|k| row(f32::from(k) / f32::from(rows), Self::CAP_OFF)));
        let inside = Paint::tinted(Material::Top, SHADED);
        builder.begin(skin);
        builder.painted_grid(&grid, true, &|row, _| if row == 0 { inside } else { TOP });
        builder.close(grid.last(), 0.002, TOP);
        builder.end(None);
    }

    fn peak<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        const REACH: f32 = 0.062; // in front of the cap
        const HALF: f32 = 0.95; // of the angle that it takes
        let columns = if builder.level == 0 { 8_u8 } else { 4 };
        let row = |out: f32, down: f32| -> Vec<Vec3> {
            let at = |k: u8| {
                let turn = HALF * (2.0 * f32::from(k) / f32::from(columns) - 1.0);
                let way = turn / HALF;
                let rim = self.around(turn, Self::rim(turn), Self::CAP_OFF - 0.002);
                // straight ahead, and less at its ends
                let reach = REACH * (1.0 - way * way) * out * self.size;
                let sag = (0.012 * out + 0.010 * way * way * out + down) * self.size;
                rim + Vec3::new(0.0, -sag, reach)
            };
            (0..=columns).map(at).collect()
        };
        let inside = Paint::tinted(Material::Top, SHADED);
        let upper = [row(0.0, -0.003), row(0.55, -0.003), row(1.0, 0.0)];
        let lower = [row(1.0, 0.0), row(0.0, 0.001)];
        builder.begin(skin);
        builder.grid(&upper, false, TOP);
        builder.end(Some(Vec3::new(0.0, 1.0, 0.3)));
        builder.begin(skin);
        builder.grid(&lower, false, inside);
        builder.end(Some(Vec3::NEG_Y));
    }

    /// All round, a little lower in front and at the back.
    fn brim<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        const REACH: f32 = 0.058;
        const SAG: f32 = 0.016;
        let columns = if builder.level == 0 { 12_u8 } else { 7 };
        let row = |out: f32, down: f32| -> Vec<Vec3> {
            let at = |k: u8| {
                let angle = TAU * f32::from(k) / f32::from(columns);
                let drop = Self::rim(angle) - 0.004;
                let rolled = libm::cosf(2.0 * angle) * 0.008 * out;
                let place = self.around(angle, drop, Self::CAP_OFF - 0.002 + REACH * out);
                // `around` rises with the distance from the skin
                place
                    - Vec3::Y * (REACH * 0.9 + SAG) * out * self.size
                    - Vec3::Y * (rolled + down) * self.size
            };
            (0..columns).map(at).collect()
        };
        let inside = Paint::tinted(Material::Top, SHADED);
        let upper = [row(0.0, -0.002), row(1.0, 0.0)];
        let lower = [row(1.0, 0.0), row(0.0, 0.002)];
        builder.begin(skin);
        builder.grid(&upper, true, TOP);
        builder.end(Some(Vec3::Y));
        builder.begin(skin);
        builder.grid(&lower, true, inside);
        builder.end(Some(Vec3::NEG_Y));
    }

    fn glasses<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        /// Of a rim, in the first two levels.
        const CORNERS: [u8; 2] = [10, 6];
        const HALF: [f32; 2] = [0.0245, 0.0190]; // of a rim, broad and high
        const THICK: f32 = 0.0028;
        const AHEAD: f32 = 0.0300; // of the middle of the eyes
        const TO_EAR: [f32; 3] = [0.077, 0.112, -0.004];
        let [eye, drop] = EYE_AT;
        let corners = CORNERS[builder.level.min(1)];
        // rims bend back towards the temples
        let flat = |x: f32, up: f32, out: f32| {
            self.beside([x, drop - 0.001 - up, EYE_DEPTH + AHEAD + out - 2.2 * x * x])
        };
        for side in [-1.0, 1.0_f32] {
            let rim = |grow: f32, out: f32| -> Vec<Vec3> {
                let at = |k: u8| {
                    let (sine, cosine) = libm::sincosf(TAU * f32::from(k) / f32::from(corners));
                    let rounded = |v: f32| v.signum() * libm::powf(v.abs(), 0.75);
                    let x = eye * 1.03 + rounded(cosine) * (HALF[0] + grow);
                    flat(side * x, rounded(sine) * (HALF[1] + grow), out)
                };
                (0..corners).map(at).collect()
            };
            builder.begin(skin);
            builder.grid(&[rim(0.0, 0.0), rim(THICK, 0.0)], true, FRAME);
            builder.end(Some(Vec3::Z));
            let hinge = eye * 1.03 + HALF[0] + THICK;
            let strip = |up: f32, out: f32| {
                let ear = self.beside([side * (TO_EAR[0] + out), TO_EAR[1] - up, TO_EAR[2]]);
                vec![flat(side * (hinge + out), 0.006 + up, 0.0), ear]
            };
            builder.begin(skin);
            builder.grid(&[strip(-0.0022, 0.001), strip(0.0022, 0.001)], false, FRAME);
            builder.end(Some(Vec3::X * side));
        }
        let bridge = |up: f32| -> Vec<Vec3> {
            let half = eye * 1.03 - HALF[0];
            [-half, 0.0, half].map(|x| flat(x, 0.006 + up, 0.001)).to_vec()
        };
        builder.begin(skin);
        builder.grid(&[bridge(-0.0016), bridge(0.0016)], false, FRAME);
        builder.end(Some(Vec3::Z));
    }
}
