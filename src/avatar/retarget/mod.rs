//! Offline retargeting of gaits (positions only) onto avatars (rotations). Spec 1.9, S-22, A-27.
//!
//! 1. The gait is resampled to the clip's phases and scaled by leg length.
//! 2. Pelvis frame from (left hip - right hip) and (spine - root), chest frame from the shoulders and
//!    (neck - spine), head from (head - neck).
//! 3. Arms take the directions of the gait's bones; their twist comes from the plane of the elbow, or from
//!    anatomy where the arm is straight (a previous frame's plane would not close the loop). Hands hang a little.
//! 4. The feet follow a plan that keeps the planted foot still and the gait's bend of the knee ([`plan`]); legs reach
//!    it by two-bone inverse kinematics. The hips move by a centimetre at most, or sink where no leg could reach.
//! 5. Turns relative to the rest pose become local rotations, whatever the rig's joint axes are.

mod cycle;
mod feet;
mod plan;
pub(super) mod rig;

use super::{Avatar, CLIP_FRAMES, Clip, ClipFrame, Error};
use crate::gait::{Gait, JOINT_COUNT, Joint, Pose};
use glam::{Mat3, Quat, Vec3};
use plan::{FootPlan, FootTarget, Leg, MOST_SHIFT, pitched};
use rig::{Limb, Rig, anatomical_hinge, hinge};

/// Greatest use of a leg's length: a knee never locks.
const REACH: f32 = 0.9995;

/// Share of a neck's lean backwards by which the face turns up: people look ahead, however they carry their heads.
const HEAD_TIPS_BACK: f32 = 0.25;

/// How far a hand at rest hangs beside its forearm: the share of the way to straight down, and at most, rad (the wrist's own
/// limit to that side is about 0.5).
const HAND_HANGS: f32 = 0.18;
const MOST_HANGING: f32 = 0.2;

/// Share of the chest's turn about the vertical that the head takes part in; walkers look ahead.
const HEAD_FOLLOWS_CHEST: f32 = 0.25;

/// The body above the legs, as turns from the rest pose in model space, and the hips' midpoint.
pub(super) struct Posture {
    pub(super) pelvis: Quat,
    pub(super) chest: Quat,
    pub(super) neck: Quat,
    pub(super) head: Quat,
    /// Directions of (upper arm, forearm): left, right.
    pub(super) arms: [[Vec3; 2]; 2],
    /// Hinge suggested by the gait's knees: left, right.
    pub(super) knees: [Vec3; 2],
    /// Midpoint of the hips, m.
    pub(super) hips: Vec3,
}

/// Where a foot is: its ankle, m, and its turn from the rest pose, in model space.
#[derive(Clone, Copy)]
pub(super) struct Foot {
    pub(super) ankle: Vec3,
    pub(super) turn: Quat,
}

impl Posture {
    /// Where a hip joint is, m.
    pub(super) fn hip(&self, rig: &Rig, joint: Joint) -> Vec3 {
        self.hips + self.pelvis * (rig.at(joint) - rig.hips())
    }
}

/// A gait at the phases of a clip, `[CLIP_FRAMES]`.
///
/// # Errors
/// As of [`retarget`], for the gait.
pub(crate) fn at_phases(gait: &Gait) -> Result<Vec<Pose>, Error> {
    cycle::resample(gait)
}

/// Puts a gait onto an avatar.
///
/// Left and right, phase 0 and cycle time stay; metres are scaled by leg length, so [`Clip::speed`] differs from
/// [`Gait::speed`]. A planted foot moves backwards by exactly [`Clip::stride_travel`] per cycle.
///
/// # Errors
/// [`Error::Unusable`] when the gait has fewer than 4 frames, a length, rate or speed that is not finite or a leg
/// of no length, or the avatar's rest pose is degenerate.
pub fn retarget(gait: &Gait, avatar: &Avatar) -> Result<Clip, Error> {
    let rig = Rig::new(avatar)?;
    let poses = cycle::resample(gait)?;
    let gait_leg = leg_length(&poses);
    if gait_leg < 0.05 {
        let message = format!("its legs are {gait_leg} m long; are the positions in metres?");
        return Err(Error::Unusable { name: gait.name.clone(), message });
    }
    let scale = rig.leg_length() / gait_leg;
    let travel = gait.stride_travel() * scale;
    let feet = [Joint::LeftFoot, Joint::RightFoot];
    let stances = feet.map(|foot| feet::stance(&poses, foot, gait.stride_travel()));
    let gait_ankle = feet::ankle_height(&poses, [(feet[0], stances[0]), (feet[1], stances[1])]);
    let ankle = 0.5 * (rig.at(feet[0]).y + rig.at(feet[1]).y);
    let spread = arm_spread(&rig, &poses);
    let mut postures: Vec<Posture> = poses
        .iter()
        .map(|pose| {
            posture(&rig, pose, scale, spread, |hips| {
                Vec3::new(hips.x * scale, (hips.y - gait_ankle) * scale + ankle, hips.z * scale)
            })
        })
        .collect();
    let plan = |postures: &[Posture], side: usize| {
        let limb = &rig.legs[side];
        let leg = |(pose, body): (&Pose, &Posture)| Leg {
            hip: body.hip(&rig, limb.chain[0]),
            to_ankle: leg_of(pose, limb),
        };
        let legs = poses.iter().zip(postures).map(leg).collect();
        FootPlan::new(legs, stances[side], travel, limb.length, &rig.soles[side])
    };
    let mut plans = [0, 1].map(|side| plan(&postures, side));
    let (level, mut shift) = hip_shift(&plans);
    let hips: Vec<Vec3> = postures.iter().map(|body| body.hips).collect();
    for pass in 0..2 {
        for ((body, hips), shift) in postures.iter_mut().zip(&hips).zip(&shift) {
            body.hips.y = hips.y + level + shift;
        }
        let before = plans.map(|plan| plan.at_strike);
        plans = [0, 1].map(|side| plan(&postures, side));
        for (plan, before) in plans.iter_mut().zip(before) {
            if pass == 0 {
                plan.settle();
            } else {
                plan.at_strike = before;
            }
            plan.roll();
        }
        if pass == 0 {
            shift = hip_rise(&shift, &plans);
        }
    }
    let targets: Vec<[FootTarget; 2]> = (0..CLIP_FRAMES)
        .map(|frame| frame as f32 / CLIP_FRAMES as f32)
        .map(|phase| [plans[0].at(phase), plans[1].at(phase)])
        .collect();
    let frames = solve(&rig, &postures, &targets);
    Ok(Clip { frames, stride_travel: travel, speed: travel / gait.cycle_time() })
}

/// The leg of a gait's pose at the avatar's size, from hip to ankle: its direction, and the bend of its knee, m.
fn leg_of(pose: &Pose, limb: &Limb) -> Vec3 {
    let [hip, knee, foot] = limb.chain.map(|joint| pose[joint as usize]);
    let [thigh, shin] = limb.length;
    let bend = (knee - hip).normalize_or(Vec3::NEG_Y).dot((foot - knee).normalize_or(Vec3::NEG_Y));
    let length = (thigh * thigh + shin * shin + 2.0 * thigh * shin * bend).max(0.0).sqrt();
    // with a rounded corner: a knee that straightens does not jerk
    let (longest, round) = (REACH * limb.reach(), 0.0015 * limb.reach());
    let over = length - longest;
    let length = 0.5 * (length + longest - libm::hypotf(over, round));
    (foot - hip).normalize_or(Vec3::NEG_Y) * length
}

/// How far the hips move up so that flat feet carry them, m: in all frames, and more or less than that by frame.
fn hip_shift(plans: &[FootPlan<'_>; 2]) -> (f32, Vec<f32>) {
    let carried: Vec<(usize, f32)> = plans.iter().flat_map(FootPlan::carried).collect();
    let level = carried.iter().map(|(_, up)| up).sum::<f32>() / carried.len().max(1) as f32;
    let mut shift = vec![0.0; CLIP_FRAMES];
    for (frame, up) in carried {
        shift[frame] = (up - level).clamp(-MOST_SHIFT, MOST_SHIFT);
    }
    (level, cycle::smooth(&shift))
}

/// The same, by frame, with the hips higher where a planted leg has no room to be as long as in the gait.
fn hip_rise(shift: &[f32], plans: &[FootPlan<'_>; 2]) -> Vec<f32> {
    let short = (0..CLIP_FRAMES).map(|frame| plans.iter().map(|plan| plan.short(frame)).fold(0.0, f32::max));
    let rise = cycle::smooth_above(&short.map(|short| short.min(2.0 * MOST_SHIFT)).collect::<Vec<_>>());
    shift.iter().zip(rise).map(|(shift, rise)| (shift + rise).min(MOST_SHIFT)).collect()
}

/// Mean length of the gait's legs, m.
fn leg_length(poses: &[Pose]) -> f32 {
    let leg = |pose: &Pose, hip: Joint| {
        let [hip, knee, foot] = [0, 1, 2].map(|k| pose[hip as usize + k]);
        hip.distance(knee) + knee.distance(foot)
    };
    let both = |pose: &Pose| 0.5 * (leg(pose, Joint::LeftHip) + leg(pose, Joint::RightHip));
    poses.iter().map(both).sum::<f32>() / poses.len() as f32
}

/// Turn that takes upright axes to the body part whose left and up directions are given.
fn upright(left: Vec3, up: Vec3) -> Quat {
    let x = left.normalize_or(Vec3::X);
    let y = (up - x * up.dot(x)).normalize_or(Vec3::Y);
    Quat::from_mat3(&Mat3::from_cols(x, y, x.cross(y)))
}

/// Heading of a turn about the vertical, radians, positive to the left.
fn heading(turn: Quat) -> f32 {
    let forward = turn * Vec3::Z;
    libm::atan2f(forward.x, forward.z)
}

/// How far (radians, outward) the arms must be spread so that hands stay clear of a broader body.
fn arm_spread(rig: &Rig, poses: &[Pose]) -> f32 {
    let arm = rig.arms[0].reach() + rig.arms[1].reach();
    let shoulders = rig.at(Joint::LeftShoulder).x - rig.at(Joint::RightShoulder).x;
    let out = |pose: &Pose| {
        let at = |joint: Joint| pose[joint as usize];
        let width = at(Joint::LeftHand).x
            - at(Joint::RightHand).x
            - (at(Joint::LeftShoulder).x - at(Joint::RightShoulder).x);
        let length = at(Joint::LeftShoulder).distance(at(Joint::LeftElbow))
            + at(Joint::LeftElbow).distance(at(Joint::LeftHand))
            + at(Joint::RightShoulder).distance(at(Joint::RightElbow))
            + at(Joint::RightElbow).distance(at(Joint::RightHand));
        width / length.max(1e-3)
    };
    let mean = poses.iter().map(out).sum::<f32>() / poses.len() as f32;
    let wanted = (2.0 * rig.hand_clearance - shoulders) / arm.max(1e-3);
    (wanted - mean).clamp(0.0, 0.6)
}

/// Reads a frame of the gait.
fn posture(rig: &Rig, pose: &Pose, scale: f32, spread: f32, place: impl Fn(Vec3) -> Vec3) -> Posture {
    debug_assert!(scale > 0.0, "leg lengths were checked");
    let at = |joint: Joint| pose[joint as usize];
    let pelvis = upright(at(Joint::LeftHip) - at(Joint::RightHip), at(Joint::Spine) - at(Joint::Root));
    let chest =
        upright(at(Joint::LeftShoulder) - at(Joint::RightShoulder), at(Joint::Neck) - at(Joint::Spine));
    // The avatar's own head sits where it does at rest when the gait's neck points the same way.
    let rest = (rig.at(Joint::Head) - rig.at(Joint::Neck)).normalize_or(Vec3::Y);
    let rest = if rest.y > 0.8 { rest } else { Vec3::Y };
    let mut neck = (at(Joint::Head) - at(Joint::Neck)).normalize_or(rest);
    neck.z += (1.0 - HEAD_TIPS_BACK) * (rest.z - neck.z).max(0.0);
    let nod = Quat::from_rotation_arc(rest, neck.normalize_or(rest));
    let head = nod * Quat::from_rotation_y(HEAD_FOLLOWS_CHEST * heading(chest));
    let arms = [0, 1].map(|side| {
        let [shoulder, elbow, hand] = rig.arms[side].chain.map(at);
        let out = Quat::from_rotation_z(if side == 0 { spread } else { -spread });
        let upper = (elbow - shoulder).normalize_or(Vec3::NEG_Y);
        [out * upper, out * (hand - elbow).normalize_or(upper)]
    });
    let knees = [0, 1].map(|side| {
        let [hip, knee, foot] = rig.legs[side].chain.map(at);
        let fallback = Quat::from_rotation_y(0.5 * heading(pelvis)) * Vec3::X;
        let (thigh, shin) = ((knee - hip).normalize_or(Vec3::NEG_Y), (foot - knee).normalize_or(Vec3::NEG_Y));
        // Half of what the gait says: knees point ahead, and captured knees are noisy.
        fallback.lerp(hinge(thigh, shin, fallback, 0.1, 0.5), 0.5).normalize_or(fallback)
    });
    Posture {
        pelvis,
        chest,
        neck: chest.slerp(head, 0.5),
        head,
        arms,
        knees,
        hips: place(at(Joint::LeftHip).midpoint(at(Joint::RightHip))),
    }
}

/// Places the hips, reaches the feet and writes local rotations.
fn solve(rig: &Rig, postures: &[Posture], targets: &[[FootTarget; 2]]) -> Vec<ClipFrame> {
    let excess: Vec<f32> =
        postures.iter().zip(targets).map(|(body, feet)| overreach(rig, body, feet)).collect();
    let lowering = cycle::smooth_above(&excess);
    let mut frames: Vec<ClipFrame> = Vec::with_capacity(postures.len());
    for ((body, feet), lower) in postures.iter().zip(targets).zip(lowering) {
        let feet = feet.map(|foot| Foot { ankle: foot.ankle, turn: pitched(foot.pitch) });
        frames.push(frame(rig, body, body.hips - Vec3::Y * lower, feet, frames.last()));
    }
    frames
}

/// A body with its hips there, whose legs reach the feet (left, right). Rotations are in the hemisphere of the frame before.
pub(super) fn frame(
    rig: &Rig,
    body: &Posture,
    hips: Vec3,
    feet: [Foot; 2],
    before: Option<&ClipFrame>,
) -> ClipFrame {
    let root = hips - body.pelvis * (rig.hips() - rig.at(Joint::Root));
    let mut turns = [Quat::IDENTITY; JOINT_COUNT];
    turns[Joint::Root as usize] = body.pelvis;
    turns[Joint::Spine as usize] = body.chest;
    turns[Joint::Neck as usize] = body.neck;
    turns[Joint::Head as usize] = body.head;
    for (side, foot) in feet.iter().enumerate() {
        let arm = &rig.arms[side];
        let own = body.chest.inverse() * body.arms[side][0];
        let fallback = body.chest * anatomical_hinge(own, -1.0);
        let axis = hinge(body.arms[side][0], body.arms[side][1], fallback, 0.1, 0.4);
        let [upper, fore] = arm.turns(body.arms[side], axis);
        let hand = hanging(body.arms[side][1]) * fore;
        for (joint, turn) in arm.chain.into_iter().zip([upper, fore, hand]) {
            turns[joint as usize] = turn;
        }
        let leg = &rig.legs[side];
        let hip = root + body.pelvis * (rig.at(leg.chain[0]) - rig.at(Joint::Root));
        let directions = reach(leg, hip, foot.ankle, body.knees[side]);
        let [thigh, shin] = leg.turns(directions, body.knees[side]);
        for (joint, turn) in leg.chain.into_iter().zip([thigh, shin, foot.turn]) {
            turns[joint as usize] = turn;
        }
    }
    ClipFrame { rotations: local(rig, &turns, before), root }
}

/// The turn by which a hand at rest hangs beside a forearm of this direction.
fn hanging(forearm: Vec3) -> Quat {
    let axis = forearm.cross(Vec3::NEG_Y);
    let away = libm::atan2f(axis.length(), -forearm.y);
    axis.try_normalize()
        .map_or(Quat::IDENTITY, |axis| Quat::from_axis_angle(axis, (HAND_HANGS * away).min(MOST_HANGING)))
}

/// How far the hips stand too high for a leg to reach its foot, m.
fn overreach(rig: &Rig, body: &Posture, feet: &[FootTarget; 2]) -> f32 {
    let excess = |side: usize| {
        if !feet[side].planted {
            return 0.0;
        }
        let leg = &rig.legs[side];
        let away = body.hip(rig, leg.chain[0]) - feet[side].ankle;
        let longest = REACH * leg.reach();
        let flat = away.x * away.x + away.z * away.z;
        away.y - (longest * longest - flat).max(0.25 * longest * longest).sqrt()
    };
    excess(0).max(excess(1)).max(0.0)
}

/// Two-bone inverse kinematics: directions of thigh and shin from `hip` to `ankle`, bent about `hinge`.
fn reach(leg: &Limb, hip: Vec3, ankle: Vec3, hinge: Vec3) -> [Vec3; 2] {
    let [thigh, shin] = leg.length;
    let straight = (ankle - hip).normalize_or(Vec3::NEG_Y);
    let shortest = (thigh - shin).abs() + 0.02 * (thigh + shin);
    let distance = hip.distance(ankle).clamp(shortest, REACH * (thigh + shin));
    let along = ((thigh * thigh - shin * shin + distance * distance) / (2.0 * distance)).clamp(-thigh, thigh);
    let axis = (hinge - straight * hinge.dot(straight)).normalize_or(Vec3::X);
    let knee = straight * along + straight.cross(axis) * (thigh * thigh - along * along).max(0.0).sqrt();
    [knee.normalize_or(straight), (straight * distance - knee).normalize_or(straight)]
}

/// Local rotations from turns of the rest pose, in the hemisphere of the frame before.
fn local(rig: &Rig, turns: &[Quat; JOINT_COUNT], before: Option<&ClipFrame>) -> [Quat; JOINT_COUNT] {
    let model: [Quat; JOINT_COUNT] = std::array::from_fn(|joint| turns[joint] * rig.rotation[joint]);
    std::array::from_fn(|joint| {
        let parent = if joint == 0 { Quat::IDENTITY } else { model[Joint::PARENT[joint]] };
        let rotation = (parent.inverse() * model[joint]).normalize();
        let reference = before.map_or(Quat::IDENTITY, |frame| frame.rotations[joint]);
        if rotation.dot(reference) < 0.0 { -rotation } else { rotation }
    })
}
