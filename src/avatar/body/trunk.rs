//! Torso with clothes, neck and skirt.

use super::shape::{Builder, Cap, Cover, Paint, Ring, Shares};
use super::weights::step;
use super::{BOTTOM, Material, Measures, SKIN, Sex, TOP};
use crate::gait::Joint;
use crate::kernels::shared::outfit::{SKIRT, TORSO};
use glam::Vec3;

/// How steeply a collar falls from the nape to the throat.
const COLLAR_SLOPE: f32 = 0.42;

/// (height, half width, front depth, back depth, coarsest level) of a horizontal ring, metres.
pub(super) type Row = (f32, f32, f32, f32, usize);

/// Horizontal rings from rows, bottom to top.
pub(super) fn rings(rows: &[Row], square: f32, paint: Paint) -> Vec<Ring> {
    let ring = |&(y, half_width, front, back, keep): &Row| Ring {
        center: Vec3::new(0.0, y, 0.0),
        side: Vec3::X * half_width,
        front: Vec3::Z * front,
        back: back / front,
        square,
        paint,
        back_paint: None,
        keep,
        cover: Cover::default(),
    };
    rows.iter().map(ring).collect()
}

const MALE_SEAT: &[Row] =
    &[(0.850, 0.106, 0.086, 0.091, 2), (0.880, 0.170, 0.108, 0.122, 0), (0.918, 0.174, 0.113, 0.126, 2)];
const MALE_TOP: &[Row] = &[
    (0.902, 0.181, 0.121, 0.135, 2),
    (1.060, 0.159, 0.112, 0.102, 0),
    (1.200, 0.167, 0.124, 0.112, 0),
    (1.300, 0.179, 0.131, 0.126, 1),
    (1.380, 0.180, 0.116, 0.125, 0),
    (1.430, 0.172, 0.094, 0.110, 2),
    (1.464, 0.138, 0.076, 0.096, 0),
    (1.484, 0.094, 0.066, 0.084, 0),
    (1.500, 0.066, 0.062, 0.072, 2),
];
const FEMALE_SKIRT: &[Row] = &[
    (0.520, 0.200, 0.172, 0.178, 2),
    (0.640, 0.196, 0.155, 0.168, 1),
    (0.780, 0.188, 0.126, 0.150, 0),
    (0.880, 0.178, 0.110, 0.132, 0),
    (0.975, 0.144, 0.097, 0.100, 2),
];
const FEMALE_TOP: &[Row] = &[
    (0.962, 0.157, 0.107, 0.113, 2),
    (0.988, 0.146, 0.100, 0.100, 0),
    (1.060, 0.132, 0.098, 0.087, 1),
    (1.165, 0.152, 0.130, 0.106, 0),
    (1.215, 0.158, 0.138, 0.110, 1),
    (1.275, 0.152, 0.112, 0.110, 0),
    (1.322, 0.142, 0.082, 0.096, 2),
    (1.349, 0.116, 0.064, 0.083, 0),
    (1.366, 0.080, 0.056, 0.072, 0),
    (1.380, 0.056, 0.052, 0.062, 2),
];
/// How boxy seat or skirt and top are.
pub(super) const LOWER_SQUARE: f32 = 2.4;
pub(super) const UPPER_SQUARE: f32 = 2.35;
/// Sides of the finest trunk.
pub(super) const TRUNK_SIDES: usize = 12;

/// Seat or skirt, and top.
pub(super) const fn rows_of(sex: Sex) -> (&'static [Row], &'static [Row]) {
    match sex {
        Sex::Female => (FEMALE_SKIRT, FEMALE_TOP),
        Sex::Male => (MALE_SEAT, MALE_TOP),
    }
}

/// Lets a ring of a collar lie lower at the throat than at the nape.
pub(super) fn tilt_collar(ring: &mut Ring) {
    ring.front.y = -COLLAR_SLOPE * ring.front.z;
}

impl Measures {
    /// Trousers' seat or skirt, top, collar, neck.
    pub(super) fn trunk<'a>(
        &self,
        builder: &mut Builder<'a>,
        trunk: &'a dyn Fn(Vec3) -> Shares,
        skirt: &'a dyn Fn(Vec3) -> Shares,
    ) {
        let segments = [TRUNK_SIDES, 7, 5][builder.level.min(2)];
        let (lower, upper) = rows_of(self.sex);
        if self.sex == Sex::Female {
            builder.wear(SKIRT, true);
        }
        builder.begin(if self.sex == Sex::Female { skirt } else { trunk });
        // The inside of a skirt is seen from below: its cap is pushed up and dark.
        let cap = if self.sex == Sex::Female { Cap::Fan(-0.05) } else { Cap::Fan(0.02) };
        builder.loft(&rings(lower, LOWER_SQUARE, BOTTOM), segments, [cap, Cap::Open]);
        builder.end(None);
        builder.wear(TORSO, true);
        builder.begin(trunk);
        let mut top = rings(upper, UPPER_SQUARE, TOP);
        let shoulder = self.bones.of(Joint::LeftShoulder).y;
        let collar = top.last().map_or(shoulder, |ring| ring.center.y);
        for ring in &mut top {
            // a collar lies lower at the throat than at the nape
            ring.front.y = -COLLAR_SLOPE * ring.front.z * step(shoulder, collar, ring.center.y);
        }
        // A belt line: the hem's underside closes against the trousers in the shade.
        if let Some(hem) = top.first().copied() {
            let under = Ring { side: hem.side * 0.93, front: hem.front * 0.9, center: hem.center, ..hem };
            top.insert(0, Ring { paint: Paint::tinted(Material::Top, 0.45), keep: 0, ..under });
        }
        builder.loft(&top, segments, [Cap::Open, Cap::Fan(0.004)]);
        builder.end(None);
        builder.wear(0, true);
        self.neck(builder, trunk);
    }

    fn neck<'a>(&self, builder: &mut Builder<'a>, trunk: &'a dyn Fn(Vec3) -> Shares) {
        let (base, top, radius) = match self.sex {
            Sex::Female => (1.352, 1.470, 0.045),
            Sex::Male => (1.462, 1.585, 0.056),
        };
        if builder.level >= 2 {
            return;
        }
        let segments = [8, 5][builder.level.min(1)];
        let ring = |t: f32, scale: f32, keep: usize| Ring {
            center: Vec3::new(0.0, base + (top - base) * t, -0.012 + 0.014 * t),
            side: Vec3::X * radius * scale,
            front: Vec3::new(0.0, -COLLAR_SLOPE * (1.0 - t), 1.0) * radius * scale,
            back: 1.1,
            square: 2.0,
            paint: SKIN,
            back_paint: None,
            keep,
            cover: Cover::default(),
        };
        builder.begin(trunk);
        builder.loft(&[ring(0.0, 1.1, 2), ring(0.4, 1.0, 0), ring(1.0, 1.0, 2)], segments, [Cap::Open; 2]);
        builder.end(None);
    }
}
