//! Arms, legs with shoes.

use super::shape::{Builder, Cap, Cover, Paint, Ring, Shares};
use super::weights::step;
use super::{BOTTOM, Material, Measures, SHOE, SKIN, SOLE, Sex, TOP};
use crate::gait::Joint;
use crate::kernels::shared::outfit::{BARE_LEGS, LOWER_LEG, LOWER_SLEEVE, SNEAKERS, UPPER_SLEEVE};
use glam::{Mat3, Vec3};

pub(super) type Skin<'a> = &'a dyn Fn(Vec3) -> Shares;

/// Position along a bone chain: (bone, share of it), then the radius, the coarsest level and the paint.
pub(super) type Station = (usize, f32, f32, usize, Paint);

/// Round rings across the chain `points`, at the bisecting plane near its joints.
fn tube(points: &[Vec3; 3], stations: &[Station]) -> Vec<Ring> {
    let ring = |&(bone, t, radius, keep, paint): &Station| {
        let (a, b) = (points[bone], points[bone + 1]);
        let along = (b - a).normalize_or_zero();
        let front = (Vec3::Z - along * along.z).normalize_or_zero();
        Ring {
            center: a + (b - a) * t,
            side: front.cross(along) * -radius,
            front: front * radius,
            back: 1.0,
            square: 2.0,
            paint,
            back_paint: None,
            keep,
            cover: Cover::default(),
        }
    };
    stations.iter().map(ring).collect()
}

/// The end of a sleeve.
const CUFF: Paint = Paint::tinted(Material::Top, 0.6);
/// The end of a trouser leg.
const HEM: Paint = Paint::tinted(Material::Bottom, 0.6);

/// Sleeve and arm.
pub(super) fn arm_stations(sex: Sex) -> &'static [Station] {
    match sex {
        // Short sleeve, then skin.
        Sex::Female => &[
            (0, 0.12, 0.050, 1, TOP),
            (0, 0.46, 0.050, 0, CUFF),
            (0, 0.47, 0.046, 1, SKIN),
            (0, 0.88, 0.038, 0, SKIN),
            (1, 0.06, 0.040, 1, SKIN),
            (1, 0.25, 0.039, 0, SKIN),
            (1, 1.00, 0.024, 1, SKIN),
        ],
        // Long sleeve to the wrist.
        Sex::Male => &[
            (0, 0.12, 0.058, 1, TOP),
            (0, 0.40, 0.055, 0, TOP),
            (0, 0.41, 0.055, 0, TOP),
            (0, 0.90, 0.047, 0, TOP),
            (1, 0.06, 0.048, 1, TOP),
            (1, 0.92, 0.035, 1, CUFF),
            (1, 0.93, 0.027, 0, SKIN),
            (1, 0.99, 0.026, 0, SKIN),
        ],
    }
}

/// Trouser leg or bare leg.
pub(super) fn leg_stations(sex: Sex) -> &'static [Station] {
    match sex {
        // Under the skirt, and 8 mm below its hem, it has the skirt's colour.
        Sex::Female => &[
            (0, 0.20, 0.094, 0, BOTTOM),
            (0, 0.60, 0.075, 0, BOTTOM),
            (0, 0.86, 0.060, 2, SKIN),
            (1, 0.00, 0.056, 2, SKIN),
            (1, 0.32, 0.057, 0, SKIN),
            (1, 0.60, 0.047, 0, SKIN),
            (1, 1.04, 0.033, 2, SKIN),
        ],
        Sex::Male => &[
            (0, 0.04, 0.080, 2, BOTTOM),
            (0, 0.15, 0.092, 0, BOTTOM),
            (0, 0.86, 0.066, 0, BOTTOM),
            (1, 0.00, 0.062, 2, BOTTOM),
            (1, 0.35, 0.060, 0, BOTTOM),
            (1, 1.00, 0.056, 0, HEM),
            (1, 1.01, 0.036, 0, SHOE),
            (1, 1.07, 0.038, 2, SHOE),
        ],
    }
}

/// What an outfit changes in a ring of an arm: where it has short sleeves a man's arm is thinner, where it has long ones a
/// woman's thicker.
fn sleeve(sex: Sex, bone: usize, share: f32, paint: Paint) -> Cover {
    let (hem, growth) = match sex {
        Sex::Female => (0.465, 0.004),
        Sex::Male => (0.40, if bone > 0 && share > 0.5 { -0.008 } else { -0.006 }),
    };
    let is_hand = sex == Sex::Male && paint == SKIN;
    match bone as f32 + share {
        _ if is_hand => Cover::default(),
        place if place < hem => Cover { part: UPPER_SLEEVE, is_plain: true, growth: 0.0 },
        place => {
            // where a sleeve ends both have the same ring
            let is_hem = place < hem + 0.006;
            let growth = if is_hem { 0.0 } else { growth };
            Cover { part: LOWER_SLEEVE, is_plain: sex == Sex::Male, growth }
        }
    }
}

/// Where a man's shorts end, along the thigh.
const SHORTS: f32 = 0.86;

/// The same of a trouser leg: below shorts a calf is thinner.
fn trouser_leg(bone: usize, share: f32, paint: Paint) -> Cover {
    if paint == SHOE || (bone == 0 && share < SHORTS) {
        return Cover::default();
    }
    let growth = match (bone, share) {
        (0, _) => 0.0,
        (_, share) => -0.006 - 0.014 * share * share,
    };
    Cover { part: LOWER_LEG, is_plain: true, growth }
}

/// A woman's trouser leg.
const TROUSER_LEG: &[Station] = &[
    (0, 0.04, 0.080, 2, BOTTOM),
    (0, 0.15, 0.094, 0, BOTTOM),
    (0, 0.50, 0.080, 1, BOTTOM),
    (0, 0.86, 0.064, 0, BOTTOM),
    (1, 0.00, 0.060, 2, BOTTOM),
    (1, 0.35, 0.060, 0, BOTTOM),
    (1, 1.00, 0.050, 0, HEM),
    (1, 1.04, 0.034, 2, HEM),
];

/// Radius of a limb at a share of one of its bones, m.
pub(super) fn radius_at(stations: &[Station], bone: usize, share: f32) -> f32 {
    let place = |station: &Station| station.0 as f32 + station.1;
    let wanted = bone as f32 + share;
    let after =
        stations.iter().position(|station| place(station) >= wanted).unwrap_or(stations.len() - 1).max(1);
    let (a, b) = (&stations[after - 1], &stations[after]);
    let way = (wanted - place(a)) / (place(b) - place(a)).max(1e-6);
    a.2 + (b.2 - a.2) * way.clamp(0.0, 1.0)
}

/// How much deeper the back of a thigh is at the hip's joint, of its radius.
const BUTTOCK: f32 = 0.36;
/// How much flatter the front of a thigh is at its top, under a skirt.
const UNDER_SKIRT: f32 = 0.2;

/// Sides of the finest limbs.
pub(super) const LIMB_SIDES: usize = 8;

impl Measures {
    fn chain(&self, left: bool, joints: [Joint; 3]) -> [Vec3; 3] {
        joints.map(|joint| self.bones.of(if left { joint } else { joint.mirrored() }))
    }

    /// Sleeve, forearm, hand.
    pub(super) fn arm<'a>(&self, builder: &mut Builder<'a>, left: bool, skin: Skin<'a>) {
        let points = self.chain(left, [Joint::LeftShoulder, Joint::LeftElbow, Joint::LeftHand]);
        let segments = [LIMB_SIDES, 5, 3][builder.level.min(2)];
        let stations = arm_stations(self.sex);
        builder.begin(skin);
        if builder.level >= 2 {
            // The coarsest arm is one prism per bone, the hand its tapered end.
            let sleeve = if self.sex == Sex::Male { TOP } else { SKIN };
            let radius = if self.sex == Sex::Male { 0.056 } else { 0.046 };
            let coarse = [
                (0, -0.06, radius * 0.8, 2, TOP),
                (1, 0.0, radius * 0.8, 2, sleeve),
                (1, 1.5, radius * 0.5, 2, sleeve),
            ];
            let mut coarse = tube(&points, &coarse);
            coarse[0].cover = Cover { part: UPPER_SLEEVE, is_plain: true, growth: 0.0 };
            coarse[1].cover = Cover { part: LOWER_SLEEVE, is_plain: self.sex == Sex::Male, growth: 0.0 };
            builder.loft(&coarse, segments, [Cap::Open; 2]);
        } else {
            let mut rings = self.shoulder(points[0]);
            let mut arm = tube(&points, stations);
            for (ring, (bone, share, _, _, paint)) in arm.iter_mut().zip(stations) {
                ring.cover = sleeve(self.sex, *bone, *share, *paint);
            }
            rings.extend(arm);
            builder.loft(&rings, segments, [Cap::Open; 2]);
        }
        builder.end(None);
        if builder.level < 2 {
            self.hand(builder, points, left, skin);
        }
    }

    /// The head of a sleeve: from inside the top, beside the neck, over the shoulder into the arm.
    fn shoulder(&self, joint: Vec3) -> Vec<Ring> {
        /// Of a man's left one: its centre from the joint and where the loft goes from there, both to the side and up; radii
        /// across and towards the front, and the coarsest level.
        type Section = ([f32; 2], [f32; 2], [f32; 2], usize);
        const OF_MAN: [Section; 4] = [
            ([-0.094, 0.024], [1.00, -0.15], [0.030, 0.036], 0),
            ([-0.044, 0.006], [0.93, -0.37], [0.037, 0.050], 1),
            ([-0.004, -0.010], [0.62, -0.78], [0.046, 0.060], 0),
            ([0.001, -0.024], [0.35, -0.94], [0.053, 0.062], 0),
        ];
        let size = if self.sex == Sex::Male { 1.0 } else { 0.80 };
        let ring = |&([aside, up], [along_x, along_y], [across, front], keep): &Section| {
            let mirrored = |x: f32, y: f32| Vec3::new(x * joint.x.signum(), y, 0.0);
            let along = mirrored(along_x, along_y).normalize_or_zero();
            Ring {
                center: joint + mirrored(aside, up) * size,
                side: Vec3::Z.cross(along) * (-across * size),
                front: Vec3::Z * (front * size),
                back: 1.0,
                square: 2.0,
                paint: TOP,
                back_paint: None,
                keep,
                cover: Cover { part: UPPER_SLEEVE, is_plain: true, growth: 0.0 },
            }
        };
        OF_MAN.iter().map(ring).collect()
    }

    /// Trouser leg or bare leg, and a shoe.
    pub(super) fn leg<'a>(&self, builder: &mut Builder<'a>, left: bool, skin: Skin<'a>, foot: Skin<'a>) {
        let points = self.chain(left, [Joint::LeftHip, Joint::LeftKnee, Joint::LeftFoot]);
        let segments = [LIMB_SIDES, 5, 3][builder.level.min(2)];
        let stations = leg_stations(self.sex);
        let mut rings = tube(&points, stations);
        for (ring, (bone, share, _, _, paint)) in rings.iter_mut().zip(stations) {
            if self.sex == Sex::Male {
                ring.cover = trouser_leg(*bone, *share, *paint);
            }
            match self.sex {
                _ if *bone > 0 => {}
                // under a seat thighs are deeper: no buttock hangs over its leg
                Sex::Male => ring.back += BUTTOCK * step(0.3, 0.0, *share),
                // flatter in front, where a leg that is lifted would come through the skirt
                Sex::Female => {
                    let flat = 1.0 - UNDER_SKIRT * step(0.5, 0.2, *share);
                    ring.front *= flat;
                    ring.back /= flat;
                }
            }
        }
        if self.sex == Sex::Female {
            builder.wear(BARE_LEGS, true);
        }
        builder.begin(skin);
        builder.loft(&rings, segments, [Cap::Open; 2]);
        builder.end(None);
        builder.wear(0, true);
        self.shoe(builder, points[2], left, foot);
    }

    /// A woman's trouser leg, from inside the seat.
    pub(super) fn trouser_leg<'a>(&self, builder: &mut Builder<'a>, left: bool, skin: Skin<'a>) {
        let points = self.chain(left, [Joint::LeftHip, Joint::LeftKnee, Joint::LeftFoot]);
        let segments = [LIMB_SIDES, 5, 3][builder.level.min(2)];
        let mut rings = tube(&points, TROUSER_LEG);
        for (ring, (bone, share, ..)) in rings.iter_mut().zip(TROUSER_LEG) {
            if *bone == 0 {
                ring.back += BUTTOCK * step(0.3, 0.0, *share);
            }
        }
        builder.begin(skin);
        builder.loft(&rings, segments, [Cap::Open; 2]);
        builder.end(None);
    }

    fn shoe<'a>(&self, builder: &mut Builder<'a>, ankle: Vec3, left: bool, foot: Skin<'a>) {
        // (z from the ankle, half width, height of the upper, coarsest level) of a man's shoe.
        const LAST: [(f32, f32, f32, usize); 5] = [
            (-0.066, 0.032, 0.088, 2),
            (0.025, 0.039, 0.096, 1),
            (0.085, 0.047, 0.060, 0),
            (0.145, 0.046, 0.044, 2),
            (0.185, 0.028, 0.030, 0),
        ];
        const SOLE_HEIGHT: f32 = 0.018;
        let size = if self.sex == Sex::Male { 1.0 } else { 0.87 };
        let toe_out = Mat3::from_rotation_y(if left { 0.11 } else { -0.11 });
        let ground = Vec3::new(ankle.x, 0.0, ankle.z);
        let place = |x: f32, y: f32, z: f32| ground + toe_out * (Vec3::new(x, y, z) * size);
        let section = |&(z, half_width, height, _): &(f32, f32, f32, usize)| -> Vec<Vec3> {
            let rise = if z > 0.16 { 0.006 } else { 0.0 };
            let broad = half_width * 1.06;
            if builder.level > 0 {
                return [
                    (-broad, rise),
                    (-half_width * 0.6, height),
                    (half_width * 0.6, height),
                    (broad, rise),
                ]
                .map(|(x, y)| place(x, y, z))
                .to_vec();
            }
            vec![
                place(-broad, rise, z),
                place(-broad, SOLE_HEIGHT, z),
                place(-half_width * 0.55, height, z),
                place(half_width * 0.55, height, z),
                place(broad, SOLE_HEIGHT, z),
                place(broad, rise, z),
            ]
        };
        let sections: Vec<Vec<Vec3>> =
            LAST.iter().filter(|row| row.3 >= builder.level).map(section).collect();
        let first = builder.len();
        builder.begin(foot);
        let strips: &[(std::ops::Range<usize>, Paint)] =
            if builder.level == 0 { &[(0..2, SOLE), (1..5, SHOE), (4..6, SOLE)] } else { &[(0..4, SHOE)] };
        for (columns, paint) in strips {
            let rows: Vec<Vec<Vec3>> = sections.iter().map(|row| row[columns.clone()].to_vec()).collect();
            builder.grid(&rows, false, *paint);
        }
        let bottom: Vec<Vec<Vec3>> = sections.iter().map(|row| vec![row[row.len() - 1], row[0]]).collect();
        builder.grid(&bottom, false, SOLE);
        let ends = [(sections.first(), false), (sections.last(), true)];
        for (row, front) in ends {
            let Some(row) = row else { continue };
            let rim: Vec<u32> = row.iter().map(|&p| builder.vertex(p, SHOE)).collect();
            for pair in rim.windows(2).skip(1) {
                if front {
                    builder.triangle(rim[0], pair[0], pair[1]);
                } else {
                    builder.triangle(rim[0], pair[1], pair[0]);
                }
            }
        }
        builder.end(None);
        builder.cover(first, SNEAKERS, &|_| true);
    }
}
