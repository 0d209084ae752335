//! How people stand: the weight on one leg, then on the other, and what an emotion makes of it.
//!
//! A standing clip is one loop of shifted weight: at phase 0 it is on the left leg, at a half on the right. The device goes
//! through it in shifts and rests ([`crate::kernels::KernelId::Pose`]), and adds breath, sway, looks and what is an
//! individual's own ([`crate::kernels::KernelId::Idle`]). Both feet stay where they are, at the same places in all emotions.

use super::retarget::rig::Rig;
use super::retarget::{Foot, Posture, frame};
use super::{Avatar, CLIP_FRAMES, Clip, ClipFrame};
use crate::emotion::Emotion;
use crate::kernels::shared::standing::index::STANCES;
use crate::kernels::shared::standing::{STANCE_AHEAD, STANCE_WIDTH};
use glam::{Quat, Vec3};
use std::f32::consts::TAU;

/// How an emotion carries the body. Degrees against the rest pose, which is upright; forwards is positive.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Carriage {
    /// Pitch of the trunk above the pelvis.
    chest: f32,
    /// Pitch of the neck. More than the head's brings the chin forward.
    neck: f32,
    /// Pitch of the face.
    head: f32,
    /// The upper arms forwards.
    shoulder: f32,
    /// The upper arms outwards, beyond where they hang beside the body.
    abduction: f32,
    /// Bend of the elbows.
    elbow: f32,
    /// Bend of the knee that carries the weight.
    knee: f32,
    /// How far the pelvis drops on the free side.
    list: f32,
    /// How far the hips go over the foot that carries: 1 is right above it.
    shift: f32,
}

/// By emotion. With what is an individual's own, heads of the sad bend by 16 degrees at most and trunks of the angry by 8, which
/// is no more than what actors show.
const CARRIAGES: [Carriage; 4] = [
    // happy: open chest, head up, light on the feet
    Carriage {
        chest: -5.5,
        neck: -4.0,
        head: -5.0,
        shoulder: -8.0,
        abduction: 3.5,
        elbow: 17.0,
        knee: 4.0,
        list: 4.5,
        shift: 0.5,
    },
    // angry: tense arms held out and bent, chin forward, the weight ready on both feet
    Carriage {
        chest: 6.0,
        neck: 7.0,
        head: 1.0,
        shoulder: -4.0,
        abduction: 8.0,
        elbow: 38.0,
        knee: 8.0,
        list: 2.5,
        shift: 0.35,
    },
    // sad: the head hangs, the shoulders are forward, knees give in
    Carriage {
        chest: 6.0,
        neck: 11.0,
        head: 10.5,
        shoulder: 5.0,
        abduction: -1.5,
        elbow: 10.0,
        knee: 11.0,
        list: 4.0,
        shift: 0.45,
    },
    // neutral
    Carriage {
        chest: 0.0,
        neck: 2.0,
        head: 0.0,
        shoulder: -2.5,
        abduction: 0.0,
        elbow: 12.0,
        knee: 6.0,
        list: 4.0,
        shift: 0.45,
    },
];

/// Where the feet are: how far ahead of the middle, and how far the toes point out, left and right.
struct Stance {
    /// In lengths of the leg.
    ahead: [f32; 2],
    /// Degrees.
    toes_out: [f32; 2],
}

/// Side by side; the left foot ahead; the right foot ahead.
const FEET: [Stance; STANCES] = [
    Stance { ahead: [0.0, 0.0], toes_out: [9.0, 9.0] },
    Stance { ahead: [STANCE_AHEAD, -STANCE_AHEAD], toes_out: [6.0, 17.0] },
    Stance { ahead: [-STANCE_AHEAD, STANCE_AHEAD], toes_out: [17.0, 6.0] },
];

/// How far the hips stand before the ankles, in lengths of the leg.
const HIPS_AHEAD: f32 = 0.025;
/// How far the hips go back for a trunk that bends forward by a radian, in lengths of the leg.
const BALANCE: f32 = 0.3;
/// How far the hips go forward while weight goes over to the right, and back on the way to the left, in lengths of the leg.
const ROUND: f32 = 0.008;
/// Of the pelvis' list the trunk bends back.
const COUNTER: f32 = 0.4;
/// Of the hips' way to one side, in lengths of the leg, the turn of the pelvis, radians: the free side comes forward.
const TURN: f32 = 0.9;
/// Rounds the change from one carrying leg to the other, in lengths of the leg.
const SOFT: f32 = 0.01;

/// One loop of a relaxed stand: weight on the left leg, over to the right, and back. `stance` is one of several places for
/// the feet (counted round). `stride_travel` and `speed` are 0. An avatar that cannot be driven stands in its rest pose.
pub fn standing(avatar: &Avatar, emotion: Emotion, stance: usize) -> Clip {
    let frames = match Rig::new(avatar) {
        Ok(rig) => stand(&rig, &CARRIAGES[emotion.index()], &FEET[stance % STANCES]),
        Err(_) => {
            let rotations = avatar.joints.map(|joint| joint.rotation);
            vec![ClipFrame { rotations, root: avatar.joints[0].translation }; CLIP_FRAMES]
        }
    };
    Clip { frames, stride_travel: 0.0, speed: 0.0 }
}

fn stand(rig: &Rig, carriage: &Carriage, stance: &Stance) -> Vec<ClipFrame> {
    let feet = feet(rig, stance);
    let mut frames: Vec<ClipFrame> = Vec::with_capacity(CLIP_FRAMES);
    for number in 0..CLIP_FRAMES {
        let (round, left) = libm::sincosf(TAU * number as f32 / CLIP_FRAMES as f32);
        let body = posture(rig, carriage, stance, &feet, left, round);
        frames.push(frame(rig, &body, body.hips, feet, frames.last()));
    }
    frames
}

/// Both feet flat on the ground.
fn feet(rig: &Rig, stance: &Stance) -> [Foot; 2] {
    let hips = rig.hips();
    [0, 1].map(|side| {
        let hip = rig.at(rig.legs[side].chain[0]);
        let ahead = stance.ahead[side] * rig.leg_length();
        let turn = Quat::from_rotation_y(outward(side) * stance.toes_out[side].to_radians());
        Foot {
            ankle: Vec3::new(STANCE_WIDTH * (hip.x - hips.x), -rig.soles[side].lowest(0.0), hips.z + ahead),
            turn,
        }
    })
}

/// 1 where +x is outwards, of the left side.
const fn outward(side: usize) -> f32 {
    if side == 0 { 1.0 } else { -1.0 }
}

/// The body at one phase of the loop: `left` is 1 with the weight on the left and -1 with it on the right leg.
fn posture(
    rig: &Rig,
    carriage: &Carriage,
    stance: &Stance,
    feet: &[Foot; 2],
    left: f32,
    round: f32,
) -> Posture {
    let size = rig.leg_length();
    let bent = |degrees: f32| Quat::from_rotation_x(degrees.to_radians());
    let list = left * carriage.list.to_radians();
    let apart = 0.5 * (feet[0].ankle - feet[1].ankle);
    let over = carriage.shift * left * apart;
    let pelvis = Quat::from_rotation_y(TURN * over.x / size) * Quat::from_rotation_z(list);
    let chest = Quat::from_rotation_z(-COUNTER * list) * bent(carriage.chest);
    let middle = feet[0].ankle.midpoint(feet[1].ankle);
    let balance = HIPS_AHEAD - BALANCE * carriage.chest.to_radians() + ROUND * round;
    let mut body = Posture {
        pelvis,
        chest,
        neck: bent(carriage.neck),
        head: bent(carriage.head),
        arms: [0, 1].map(|side| arm(rig, carriage, side)),
        knees: [0, 1].map(|side| {
            Quat::from_rotation_y(outward(side) * 0.7 * stance.toes_out[side].to_radians()) * Vec3::X
        }),
        hips: (middle + over + Vec3::Z * (balance * size)).with_y(0.0),
    };
    body.hips.y = height(rig, carriage, feet, &body);
    body
}

/// How high the hips stand so that the leg that carries has its bend, and the other one at least that, m.
fn height(rig: &Rig, carriage: &Carriage, feet: &[Foot; 2], body: &Posture) -> f32 {
    let of_leg = |side: usize| {
        let leg = &rig.legs[side];
        let [thigh, shin] = leg.length;
        let bend = libm::cosf(carriage.knee.to_radians());
        let length2 = thigh * thigh + shin * shin + 2.0 * thigh * shin * bend;
        let away = body.hip(rig, leg.chain[0]) - feet[side].ankle;
        let flat2 = away.x * away.x + away.z * away.z;
        (length2 - flat2).max(0.25 * length2).sqrt() - away.y
    };
    let [left, right] = [of_leg(0), of_leg(1)];
    0.5 * (left + right - libm::hypotf(left - right, SOFT * rig.leg_length()))
}

/// Directions of an upper arm and a forearm that hang beside the body.
fn arm(rig: &Rig, carriage: &Carriage, side: usize) -> [Vec3; 2] {
    let shoulder = rig.at(rig.arms[side].chain[0]).x.abs();
    let out = (rig.hand_clearance - shoulder) / rig.arms[side].reach().max(1e-3);
    let out = out.clamp(0.06, 0.6);
    let hanging = |out: f32, ahead: f32| {
        Quat::from_rotation_z(outward(side) * out) * Quat::from_rotation_x(-ahead) * Vec3::NEG_Y
    };
    let [shoulder, elbow, abduction] =
        [carriage.shoulder, carriage.elbow, carriage.abduction].map(f32::to_radians);
    [hanging(1.1 * out + abduction, shoulder), hanging(0.8 * out, shoulder + elbow)]
}

#[cfg(test)]
mod tests {
    use super::super::kinematics::{Angle, Side, Walk};
    use super::super::{Sex, generated};
    use super::*;
    use crate::gait::{Joint, Pose};

    const MEASURED: [Angle; 6] =
        [Angle::Trunk, Angle::Head, Angle::Shoulder, Angle::Elbow, Angle::ArmAbduction, Angle::Knee];

    fn poses(avatar: &Avatar, clip: &Clip) -> Vec<Pose> {
        let joints = |frame: &ClipFrame| avatar.model_from_joint(&frame.rotations, frame.root);
        clip.frames.iter().map(|frame| joints(frame).map(|joint| joint.w_axis.truncate())).collect()
    }

    /// The means of the measured angles, and of the pitch of the face, degrees.
    fn means(avatar: &Avatar, emotion: Emotion) -> [f32; 7] {
        let mut sums = [0.0; 7];
        let mut count = 0.0;
        for stance in 0..STANCES {
            let clip = standing(avatar, emotion, stance);
            let walk =
                Walk { poses: poses(avatar, &clip), foot_pitch: Vec::new(), cycle_time: 1.0, travel: 1.0 };
            for side in Side::BOTH {
                for (sum, angle) in sums.iter_mut().zip(MEASURED) {
                    *sum += walk.curve(angle, side).unwrap().iter().sum::<f32>();
                }
                count += CLIP_FRAMES as f32;
            }
            for frame in &clip.frames {
                let model = avatar.model_from_joint(&frame.rotations, frame.root);
                let head = Joint::Head as usize;
                let ahead = (model[head] * avatar.joints[head].joint_from_mesh).transform_vector3(Vec3::Z);
                let [.., face] = &mut sums;
                *face += 2.0 * libm::atan2f(-ahead.y, ahead.z).to_degrees();
            }
        }
        sums.map(|sum| sum / count)
    }

    #[test]
    fn each_emotion_stands_otherwise_than_the_neutral_in_four_angles_and_with_its_own_signs() {
        for sex in Sex::ALL {
            let avatar = generated(sex);
            let neutral = means(&avatar, Emotion::Neutral);
            let against = |emotion| {
                let own = means(&avatar, emotion);
                let apart: [f32; 7] = std::array::from_fn(|i| own[i] - neutral[i]);
                println!("{sex:?} {emotion}: {apart:.1?} against {neutral:.1?}");
                assert!(apart.iter().filter(|apart| apart.abs() >= 3.0).count() >= 4, "{emotion}: {apart:?}");
                apart
            };
            let [trunk, head, shoulder, _, _, _, face] = against(Emotion::Sad);
            assert!(trunk > 3.0 && head > 3.0 && shoulder > 3.0 && (9.0..12.0).contains(&face));
            let [trunk, head, _, elbow, abduction, _, face] = against(Emotion::Angry);
            assert!((3.0..6.0).contains(&trunk) && head > face + 3.0 && elbow > 15.0 && abduction > 5.0);
            let [trunk, head, .., face] = against(Emotion::Happy);
            assert!(trunk < -3.0 && head < -3.0 && face < -3.0);
        }
    }

    #[test]
    fn weight_goes_from_the_left_leg_to_the_right_and_the_free_knee_bends() {
        let avatar = generated(Sex::Male);
        for emotion in Emotion::ALL {
            let clip = standing(&avatar, emotion, 0);
            let walk =
                Walk { poses: poses(&avatar, &clip), foot_pitch: Vec::new(), cycle_time: 1.0, travel: 1.0 };
            let root = |frame: usize| walk.poses[frame][Joint::Root as usize].x;
            assert!(root(0) > 0.02 && root(32) < -0.02 && root(16).abs() < 0.005, "{emotion}");
            let knee = |side| walk.curve(Angle::Knee, side).unwrap();
            let (left, right) = (knee(Side::Left), knee(Side::Right));
            println!("{emotion}: knees {:.1} and {:.1} of the free leg", left[0], right[0]);
            assert!(left[0] < 14.0 && right[0] > left[0] + 5.0, "{emotion}: {} {}", left[0], right[0]);
            // of a curve from the side's own strike, a foot that is nowhere foremost begins at the first frame
            assert!((left[32] - right[0]).abs() < 0.5 && (left[0] - right[32]).abs() < 0.5);
            let list = walk.curve(Angle::PelvisList, Side::Left).unwrap();
            assert!(list[0] > 2.0 && list[32] < -2.0);
        }
    }

    #[test]
    fn feet_stay_at_the_same_places_in_every_emotion_and_differ_from_stance_to_stance() {
        for sex in Sex::ALL {
            let avatar = generated(sex);
            let ankles = |emotion, stance| -> Vec<[Vec3; 2]> {
                let clip = standing(&avatar, emotion, stance);
                let of = |pose: &Pose| [Joint::LeftFoot, Joint::RightFoot].map(|foot| pose[foot as usize]);
                poses(&avatar, &clip).iter().map(of).collect()
            };
            for stance in 0..STANCES {
                let first = ankles(Emotion::Happy, stance)[0];
                for emotion in Emotion::ALL {
                    for places in ankles(emotion, stance) {
                        for (place, first) in places.into_iter().zip(first) {
                            assert!(place.distance(first) < 5e-4, "{emotion} {stance}: {place} {first}");
                        }
                    }
                }
                let next = ankles(Emotion::Happy, (stance + 1) % STANCES)[0];
                assert!(first[0].distance(next[0]) > 0.03);
            }
        }
    }
}
