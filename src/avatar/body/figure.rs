//! The measures that a generated body has itself, from the numbers that make it, and what a physique makes of them.

use super::limbs::{LIMB_SIDES, Station, arm_stations, leg_stations, radius_at};
use super::trunk::{LOWER_SQUARE, TRUNK_SIDES, UPPER_SQUARE, rings, rows_of};
use super::{Measures, Sex, TOP};
use crate::avatar::body::shape::swell;
use crate::gait::Joint;
use crate::kernels::palette::BACK;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};
use std::sync::OnceLock;

/// Heights at which girths are taken, over stature: chest, waist at the navel, hips at the buttocks (ANSUR II, means of men and
/// women).
const HEIGHTS: [f32; 3] = [0.727, 0.602, 0.509];
/// Where those of limbs are taken: number of the bone, and share of it.
type OnBone = (usize, f32);
/// Below the crotch.
const THIGH: OnBone = (0, 0.2);
const CALF: OnBone = (1, 0.33);
const UPPER_ARM: OnBone = (0, 0.47);
const FOREARM: OnBone = (1, 0.25);

/// What a body is multiplied by across its trunk, (breadth, depth), and its thighs, girth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Across {
    pub(crate) chest: Vec2,
    pub(crate) waist: Vec2,
    pub(crate) hips: Vec2,
    pub(crate) thigh: f32,
}

impl Default for Across {
    fn default() -> Self {
        Self { chest: Vec2::ONE, waist: Vec2::ONE, hips: Vec2::ONE, thigh: 1.0 }
    }
}

/// A place of the skin of the trunk, to the left and to the front, m: the sum of these, each but the first times its ratio.
#[derive(Debug, Clone, Copy, Default)]
struct Place {
    still: Vec2,
    chest: Vec2,
    waist: Vec2,
    hips: Vec2,
    thigh: Vec2,
}

impl Place {
    /// Between this one and another.
    fn lerp(&self, other: &Self, way: f32) -> Self {
        Self {
            still: self.still.lerp(other.still, way),
            chest: self.chest.lerp(other.chest, way),
            waist: self.waist.lerp(other.waist, way),
            hips: self.hips.lerp(other.hips, way),
            thigh: self.thigh.lerp(other.thigh, way),
        }
    }

    fn on(&self, across: &Across) -> Vec2 {
        self.still
            + self.chest * across.chest
            + self.waist * across.waist
            + self.hips * across.hips
            + self.thigh * across.thigh
    }
}

/// A horizontal cut through the trunk.
#[derive(Debug, Clone, Default)]
pub(crate) struct Section {
    /// Around it.
    places: [Place; TRUNK_SIDES],
    /// Its breadth and depth on the body itself, m.
    pub(crate) size: Vec2,
}

impl Section {
    /// Its girth on a body of that shape, m.
    pub(crate) fn girth(&self, across: &Across) -> f32 {
        let points = self.places.map(|place| place.on(across));
        let next = points.iter().cycle().skip(1);
        points.iter().zip(next).map(|(a, b)| a.distance(*b)).sum()
    }
}

/// What a generated body measures, m.
#[derive(Debug, Clone)]
pub(crate) struct Figure {
    /// Standing height.
    pub(crate) stature: f32,
    /// Heights of the joint of the hips and of that of the head.
    pub(crate) root: f32,
    pub(crate) head: f32,
    pub(crate) chest: Section,
    pub(crate) waist: Section,
    pub(crate) hips: Section,
    /// Girths.
    pub(crate) thigh: f32,
    pub(crate) calf: f32,
    pub(crate) upper_arm: f32,
    pub(crate) forearm: f32,
}

impl Figure {
    /// That of one of the bodies.
    pub(crate) fn of(sex: Sex) -> &'static Self {
        static FIGURES: OnceLock<[Figure; 2]> = OnceLock::new();
        &FIGURES.get_or_init(|| Sex::ALL.map(Self::measured))[sex as usize]
    }

    fn measured(sex: Sex) -> Self {
        let measures = Measures::of(sex);
        let stature = measures.top();
        let [chest, waist, hips] = HEIGHTS.map(|share| section(&measures, share * stature));
        let [leg, arm] = [leg_stations(sex), arm_stations(sex)];
        let limb = |stations: &[Station], (bone, share): OnBone| {
            let corner = radius_at(stations, bone, share) * swell(LIMB_SIDES);
            2.0 * LIMB_SIDES as f32 * corner * libm::sinf(PI / LIMB_SIDES as f32)
        };
        Self {
            stature,
            root: measures.bones.of(Joint::Root).y,
            head: measures.bones.of(Joint::Head).y,
            chest,
            waist,
            hips,
            thigh: limb(leg, THIGH),
            calf: limb(leg, CALF),
            upper_arm: limb(arm, UPPER_ARM),
            forearm: limb(arm, FOREARM),
        }
    }
}

/// The cut at a height through top, or through what is below it.
fn section(measures: &Measures, height: f32) -> Section {
    let (lower, upper) = rows_of(measures.sex);
    let is_upper = upper.first().is_none_or(|row| height >= row.0);
    let (rows, square) = if is_upper { (upper, UPPER_SQUARE) } else { (lower, LOWER_SQUARE) };
    let is_skirt = !is_upper && measures.sex == Sex::Female;
    let after = rows.iter().position(|row| row.0 >= height).unwrap_or(rows.len() - 1).max(1);
    let pair = [rows[after - 1], rows[after]];
    let [below, above] = pair.map(|row| row.0);
    let rings = rings(&pair, square, TOP);
    let way = ((height - below) / (above - below)).clamp(0.0, 1.0);
    let places = std::array::from_fn(|side| {
        let angle = TAU * side as f32 / TRUNK_SIDES as f32;
        let at = |ring: usize| place(measures, rings[ring].point(angle, swell(TRUNK_SIDES)), is_skirt);
        at(0).lerp(&at(1), way)
    });
    let own = places.map(|place: Place| place.on(&Across::default()));
    let (least, most) =
        own.iter().fold((Vec2::MAX, Vec2::MIN), |(least, most), p| (least.min(*p), most.max(*p)));
    Section { places, size: most - least }
}

fn flat(point: Vec3) -> Vec2 {
    Vec2::new(point.x, point.z)
}

/// A place of the skin by what it hangs on. Each part goes out from its joint, the waist from the back.
fn place(measures: &Measures, point: Vec3, is_skirt: bool) -> Place {
    let shares = if is_skirt { measures.bones.skirt(point) } else { measures.bones.trunk(point) };
    let share = |joint: Joint| shares[joint as usize];
    let thighs = [Joint::LeftHip, Joint::RightHip];
    // the waist is half way between root and spine, see avatar::waist; what hangs on shoulders is as broad as the chest
    let root = share(Joint::Root);
    let spine = 1.0 - root - thighs.map(share).iter().sum::<f32>();
    let waist = 2.0 * root.min(spine);
    let middle = |joint: Joint| flat(measures.bones.of(joint));
    let back = middle(Joint::Spine) - Vec2::new(0.0, BACK);
    let mut out = Place::default();
    let parts = [
        (&mut out.hips, middle(Joint::Root), root - 0.5 * waist),
        (&mut out.waist, back, waist),
        (&mut out.chest, middle(Joint::Spine), spine - 0.5 * waist),
    ];
    for (part, middle, share) in parts {
        *part = (flat(point) - middle) * share;
        out.still += middle * share;
    }
    for thigh in thighs {
        out.thigh += (flat(point) - middle(thigh)) * share(thigh);
        out.still += middle(thigh) * share(thigh);
    }
    out
}
