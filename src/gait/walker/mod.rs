//! The procedural walker: labelled walk cycles from a few dozen numbers, so that everything runs with no data set.
//!
//! A [`WalkerStyle`] says how a person walks (speed, cycle time, arm swing, slump, head, bounce, …) and with what
//! body. [`walk`] turns it into a [`Gait`]: the planted foot rolls over heel, ball and toes on ground that passes
//! at exactly [`WalkerStyle::speed`], the leading leg carries the pelvis as high as the knees of healthy adults do,
//! and the swinging leg follows their angles; trunk, arms and head are a mean pose and one or two harmonics
//! (the form of Troje 2002). [`WalkerStyle::expressed`] has one style per emotion, sex and strength of expression,
//! [`WalkerStyle::mix`] blends them (S-32) and [`WalkerStyle::vary`] makes individuals.
//!
//! All arithmetic is plain f64 with our own sine, so a style gives the same bits on every machine.

mod legs;
mod presets;
mod style;
mod trig;
mod upper;

pub use presets::{EXPRESSION, MOST_EXPRESSION};
pub use style::{Body, OutOfRange, STYLE_FIELDS, Sex, StyleField, WalkerStyle};

use super::{Error, Gait, JOINT_COUNT, Joint, JointSet, LabelOrigin, Pose, Provenance};
use crate::emotion::Emotion;
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;
use trig::{Turn, cos, sin};

/// Frames of a generated cycle: that of the clips on the device, so that retargeting samples frames as they are.
#[doc(hidden)]
pub const FRAMES: usize = 64;

/// [`FRAMES`] as a number to divide by.
const FRAMES_F64: f64 = 64.0;

/// Version of the generator, written into [`Gait::provenance`]; raised whenever the same style gives another gait.
#[doc(hidden)]
pub const VERSION: u32 = 7;

/// Travel of a stride in leg lengths for which [`WalkerStyle::bounce`] and the angles of the legs hold.
const USUAL_STRIDE: f64 = 1.6;

/// Pelvis of one frame: where it is and how it is turned.
struct Pelvis {
    root: DVec3,
    /// About +y, positive to the left.
    yaw: Turn,
    /// About +z, positive lifts the left side.
    roll: Turn,
    roll_angle: f64,
}

impl Pelvis {
    /// At a phase, carried as high as `lift` says.
    fn at(style: &WalkerStyle, phase: f64, lift: &legs::Lift) -> Self {
        // The left foot strikes at 0: the left hip is then forward (yaw to the right) and, a moment later,
        // high, because the side of the swinging leg drops; the body is over the standing leg at 0.28.
        let yaw = -style.pelvis_turn * cos(TAU * phase);
        let roll_angle = style.pelvis_drop * sin(TAU * (phase - 0.02));
        let root = DVec3::new(
            style.sway * sin(TAU * (phase - 0.04)),
            lift.at(phase),
            0.012 * sin(2.0 * TAU * (phase + 0.045)),
        );
        Self { root, yaw: Turn::new(yaw), roll: Turn::new(roll_angle), roll_angle }
    }

    /// Centre of the hip joint on `side` (+1 left, -1 right).
    fn hip(&self, body: &Body, side: f64) -> DVec3 {
        let offset = DVec3::new(side * 0.5 * body.hip_width(), -body.root_above_hips(), 0.0);
        self.root + turned_y(turned_z(offset, self.roll), self.yaw)
    }
}

/// Rotates about +x, positive tips +y towards +z (forwards).
fn turned_x(v: DVec3, turn: Turn) -> DVec3 {
    DVec3::new(v.x, turn.cos * v.y - turn.sin * v.z, turn.sin * v.y + turn.cos * v.z)
}

/// Rotates about +y, positive turns +z towards +x (to the left).
fn turned_y(v: DVec3, turn: Turn) -> DVec3 {
    DVec3::new(turn.cos * v.x + turn.sin * v.z, v.y, turn.cos * v.z - turn.sin * v.x)
}

/// Rotates about +z, positive turns +x towards +y.
fn turned_z(v: DVec3, turn: Turn) -> DVec3 {
    DVec3::new(turn.cos * v.x - turn.sin * v.y, turn.sin * v.x + turn.cos * v.y, v.z)
}

/// One walk cycle of [`FRAMES`] frames in the given style, unlabelled.
///
/// The foot joint is the ankle; where the foot stands flat it is at y = 0 (a gait has no soles).
///
/// # Errors
/// [`Error::Unusable`] if a parameter is outside its range in [`STYLE_FIELDS`] or the legs are too short for the
/// stride (speed times cycle time).
pub fn walk(style: &WalkerStyle, name: &str) -> Result<Gait, Error> {
    let unusable = |error: OutOfRange| Error::Unusable { name: name.to_owned(), message: error.to_string() };
    style.check().map_err(unusable)?;
    let feet = legs::FootPath::new(style).ok_or_else(|| Error::Unusable {
        name: name.to_owned(),
        message: format!(
            "a stride of {:.2} m (speed {:.2} m/s x cycle_time {:.2} s) is too long for legs of {:.2} m; \
             lower one of the two or raise body.height",
            style.speed * style.cycle_time,
            style.speed,
            style.cycle_time,
            style.body.leg()
        ),
    })?;
    let poses =
        (0_u32..).take(FRAMES).map(|frame| pose(style, &feet, f64::from(frame) / FRAMES_F64)).collect();
    Ok(Gait {
        name: name.to_owned(),
        poses,
        frame_rate: single(FRAMES_F64 / style.cycle_time),
        speed: single(style.speed),
        provenance: Provenance {
            dataset: "walker".to_owned(),
            format: format!("gaitway walker {VERSION}"),
            take: name.to_owned(),
            ..Provenance::default()
        },
        acted: None,
        ratings: None,
        label: None,
        missing: JointSet::default(),
    })
}

/// One generated person of crowds: [`person_expressing`] the emotion as strongly as [`EXPRESSION`].
///
/// # Errors
/// As [`walk`]; not for any seed or index (a varied preset stays within its ranges).
pub fn person(emotion: Emotion, sex: Sex, seed: u64, index: u32) -> Result<Gait, Error> {
    person_expressing(emotion, sex, EXPRESSION, seed, index)
}

/// One generated person: [`WalkerStyle::expressed`], varied by `seed` and `index`, labelled. The same seed and index are the
/// same person in every emotion and expression.
///
/// The label is what the style was made to look like. The gait is unrated, so `ratings` is empty.
///
/// # Errors
/// As [`walk`]; not for any seed or index (a varied preset stays within its ranges).
pub fn person_expressing(
    emotion: Emotion,
    sex: Sex,
    expression: f64,
    seed: u64,
    index: u32,
) -> Result<Gait, Error> {
    let style = WalkerStyle::expressed(emotion, sex, expression).vary(seed, index);
    let mut gait = walk(&style, &format!("{emotion}-{sex}-{index}"))?;
    gait.provenance = Provenance {
        subject: Some(format!("{sex} {index}")),
        sex: Some(sex),
        label_origin: Some(LabelOrigin::Generated),
        notes: vec![format!("{emotion} {sex}, expression {expression}, seed {seed}, individual {index}")],
        ..gait.provenance
    };
    gait.acted = Some(emotion.name().to_owned());
    gait.label = Some(emotion);
    Ok(gait)
}

/// The 16 joints at `phase` in [0, 1).
fn pose(style: &WalkerStyle, feet: &legs::FootPath, phase: f64) -> Pose {
    let pelvis = Pelvis::at(style, phase, &feet.lift);
    let mut joints = [DVec3::ZERO; JOINT_COUNT];
    joints[Joint::Root as usize] = pelvis.root;
    upper::place(style, phase, &pelvis, &mut joints);
    for (side, hip) in [(1.0, Joint::LeftHip as usize), (-1.0, Joint::RightHip as usize)] {
        let ankle = feet.ankle(style, side, phase);
        joints[hip] = pelvis.hip(&style.body, side);
        joints[hip + 1] = legs::knee(style, side, joints[hip], ankle);
        joints[hip + 2] = ankle;
    }
    joints.map(|joint| Vec3::new(single(joint.x), single(joint.y), single(joint.z)))
}

#[allow(clippy::cast_possible_truncation, reason = "rounding to f32 is the purpose; values are a few metres")]
fn single(value: f64) -> f32 {
    value as f32
}
