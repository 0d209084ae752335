//! What retargeting must know of an avatar: its rest pose in model space, limb lengths, soles.

use super::super::foot::{self, Footprint};
use super::super::{Avatar, Error};
use crate::gait::{JOINT_COUNT, Joint};
use glam::{Mat3, Quat, Vec3};

/// Shoulder, elbow, hand or hip, knee, foot, and which way the middle joint turns.
#[derive(Debug, Clone, Copy)]
pub(in crate::avatar) struct Limb {
    /// The three joints from the trunk outward.
    pub(in crate::avatar) chain: [Joint; 3],
    /// Rest directions of the two bones, unit, model space.
    pub(in crate::avatar) rest: [Vec3; 2],
    /// Lengths of the two bones, m.
    pub(in crate::avatar) length: [f32; 2],
    /// Rest axis of the hinge, unit, about perpendicular to both bones: flexion is a positive turn about it.
    pub(in crate::avatar) hinge: Vec3,
}

/// The underside of a foot relative to its joint at rest, m.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::avatar) struct Sole {
    /// The point on which a foot rolls at the strike.
    pub(in crate::avatar) heel: Vec3,
    /// The point over which it leaves; the toes beyond it bend.
    pub(in crate::avatar) ball: Vec3,
    /// Length of the toes beyond it, m.
    pub(in crate::avatar) toes: f32,
    /// Points up to the ball of which one is the lowest at any pitch.
    pub(in crate::avatar) edge: Vec<Vec3>,
}

impl Sole {
    /// Height of the lowest point relative to the foot joint at a pitch (toe up is positive), m.
    pub(in crate::avatar) fn lowest(&self, pitch: f32) -> f32 {
        let (sine, cosine) = libm::sincosf(pitch);
        self.edge.iter().map(|p| p.y * cosine + p.z * sine).fold(f32::MAX, f32::min)
    }
}

/// An avatar's rest pose.
#[derive(Debug, Clone)]
pub(in crate::avatar) struct Rig {
    pub(in crate::avatar) position: [Vec3; JOINT_COUNT],
    pub(in crate::avatar) rotation: [Quat; JOINT_COUNT],
    /// Left, right.
    pub(in crate::avatar) arms: [Limb; 2],
    /// Left, right.
    pub(in crate::avatar) legs: [Limb; 2],
    /// Left, right.
    pub(in crate::avatar) soles: [Sole; 2],
    /// Half the width of the trunk or skirt beside the hanging hands, with room for the hand, m.
    pub(in crate::avatar) hand_clearance: f32,
}

/// The anatomical axis about which an elbow (`sign` -1) or knee (+1) flexes when the limb's upper bone points
/// along `direction`, in the frame of the trunk: the axis of the hanging limb carried along the shortest arc.
pub(in crate::avatar) fn anatomical_hinge(direction: Vec3, sign: f32) -> Vec3 {
    Quat::from_rotation_arc(Vec3::NEG_Y, direction.normalize_or(Vec3::NEG_Y)) * (Vec3::X * sign)
}

/// Hinge from the bend of the limb where it is bent (`narrow`, `wide`: sines between which the plane of the limb
/// takes over) and from `fallback` where it is straight or bent the impossible way.
pub(in crate::avatar) fn hinge(upper: Vec3, lower: Vec3, fallback: Vec3, narrow: f32, wide: f32) -> Vec3 {
    let cross = upper.cross(lower);
    let sine = cross.length();
    let Some(plane) = cross.try_normalize() else { return fallback };
    let bent = ((sine - narrow) / (wide - narrow)).clamp(0.0, 1.0);
    // A plane far from the anatomical one is noise of an almost straight limb or an overstretched joint.
    let trusted = ((plane.dot(fallback) + 0.1) / 0.5).clamp(0.0, 1.0);
    let weight = bent * bent * (3.0 - 2.0 * bent) * trusted;
    fallback.lerp(plane, weight).normalize_or(fallback)
}

/// Rotation of the frame given by a bone's direction and its hinge.
pub(in crate::avatar) fn frame(direction: Vec3, hinge: Vec3) -> Quat {
    let y = direction.normalize_or(Vec3::NEG_Y);
    let x = (hinge - y * hinge.dot(y)).try_normalize().unwrap_or_else(|| y.any_orthonormal_vector());
    Quat::from_mat3(&Mat3::from_cols(x, y, x.cross(y)))
}

impl Limb {
    fn new(position: &[Vec3; JOINT_COUNT], chain: [Joint; 3], sign: f32) -> Self {
        let [a, b, c] = chain.map(|joint| position[joint as usize]);
        let rest = [(b - a).normalize_or(Vec3::NEG_Y), (c - b).normalize_or(Vec3::NEG_Y)];
        let fallback = anatomical_hinge(rest[0], sign);
        Self {
            chain,
            rest,
            length: [a.distance(b), b.distance(c)],
            hinge: hinge(rest[0], rest[1], fallback, 0.1, 0.3),
        }
    }

    /// Lengths of both bones together, m.
    pub(in crate::avatar) fn reach(&self) -> f32 {
        self.length[0] + self.length[1]
    }

    /// Model-space turns from the rest pose that bring the two bones into the given directions and hinge.
    pub(in crate::avatar) fn turns(&self, directions: [Vec3; 2], hinge: Vec3) -> [Quat; 2] {
        [0, 1].map(|bone| frame(directions[bone], hinge) * frame(self.rest[bone], self.hinge).inverse())
    }
}

impl Rig {
    /// # Errors
    /// [`Error::Unusable`] when a joint is not finite or a leg has no length.
    pub(in crate::avatar) fn new(avatar: &Avatar) -> Result<Self, Error> {
        let unusable = |message: String| Error::Unusable { name: avatar.name.clone(), message };
        let local = avatar.joints.map(|joint| joint.rotation.normalize());
        let model = avatar.model_from_joint(&local, avatar.joints[0].translation);
        let position = model.map(|matrix| matrix.w_axis.truncate());
        let mut rotation = local;
        for joint in 1..JOINT_COUNT {
            rotation[joint] = rotation[Joint::PARENT[joint]] * local[joint];
        }
        for joint in Joint::ALL {
            let (p, q) = (position[joint as usize], rotation[joint as usize]);
            if !p.is_finite() || !q.is_finite() {
                return Err(unusable(format!("rest pose of joint {} is not finite: {p} {q}", joint.name())));
            }
        }
        use Joint as J;
        let arms =
            [[J::LeftShoulder, J::LeftElbow, J::LeftHand], [J::RightShoulder, J::RightElbow, J::RightHand]];
        let legs = [[J::LeftHip, J::LeftKnee, J::LeftFoot], [J::RightHip, J::RightKnee, J::RightFoot]];
        let arms = arms.map(|chain| Limb::new(&position, chain, -1.0));
        let legs = legs.map(|chain| Limb::new(&position, chain, 1.0));
        for leg in &legs {
            for (bone, length) in leg.length.into_iter().enumerate() {
                if length < 1e-3 {
                    return Err(unusable(format!(
                        "the bone below {} is {length} m long; a leg needs a thigh and a shin of 1 mm or more",
                        leg.chain[bone].name()
                    )));
                }
            }
        }
        let soles =
            [0, 1].map(|side| sole(avatar, legs[side].chain[2], position[legs[side].chain[2] as usize]));
        let hand_clearance = hand_clearance(avatar, &position, &arms);
        Ok(Self { position, rotation, arms, legs, soles, hand_clearance })
    }

    /// Rest position of a joint in model space, m.
    pub(in crate::avatar) fn at(&self, joint: Joint) -> Vec3 {
        self.position[joint as usize]
    }

    /// Mean length of the legs from hip to ankle, m.
    pub(in crate::avatar) fn leg_length(&self) -> f32 {
        0.5 * (self.legs[0].reach() + self.legs[1].reach())
    }

    /// Midpoint of the hips at rest, m.
    pub(in crate::avatar) fn hips(&self) -> Vec3 {
        self.at(Joint::LeftHip).midpoint(self.at(Joint::RightHip))
    }
}

/// Underside of the vertices that hang on `foot`, up to its ball; a shoe of usual proportions where there are none.
fn sole(avatar: &Avatar, joint: Joint, ankle: Vec3) -> Sole {
    const STEPS: i16 = 24;
    let Footprint { heel, ball, tip } = foot::footprint(avatar, joint, ankle);
    let toes = tip.z - ball.z;
    let flat = |p: Vec3| (p - ankle).with_x(0.0);
    let ball = flat(ball);
    let mut points: Vec<Vec3> = foot::vertices(avatar, joint).map(flat).filter(|p| p.z <= ball.z).collect();
    points.push(ball);
    if points.len() == 1 {
        points.push(flat(heel));
    }
    let lowest = |pitch: f32| {
        let (sine, cosine) = libm::sincosf(pitch);
        let height = |p: &Vec3| p.y * cosine + p.z * sine;
        points.iter().copied().min_by(|a, b| height(a).total_cmp(&height(b))).unwrap_or(Vec3::ZERO)
    };
    // From 1.4 rad toe down to 0.6 rad toe up, which is more than any walk asks for.
    let mut edge: Vec<Vec3> =
        (0..=STEPS).map(|k| lowest(-1.4 + 2.0 * f32::from(k) / f32::from(STEPS))).collect();
    edge.dedup();
    Sole { heel: lowest(0.25), ball, toes, edge }
}

/// How far from the middle a hanging hand must stay to be clear of the body.
fn hand_clearance(avatar: &Avatar, position: &[Vec3; JOINT_COUNT], arms: &[Limb; 2]) -> f32 {
    let shoulder = position[arms[0].chain[0] as usize].y;
    let [upper, fore] = arms[0].length;
    let (low, high) = (shoulder - upper - 1.3 * fore, shoulder - upper - 0.5 * fore);
    let trunk = [Joint::Root, Joint::Spine, Joint::LeftHip, Joint::RightHip].map(|joint| joint as usize);
    let widest = avatar
        .levels
        .iter()
        .take(1)
        .flat_map(|mesh| &mesh.vertices)
        .filter(|v| (low..high).contains(&v.position.y))
        .filter(|v| {
            let slots = v.joints.iter().zip(v.weights);
            slots.filter(|(joint, _)| trunk.contains(&usize::from(**joint))).map(|(_, w)| w).sum::<f32>()
                > 0.5
        })
        .map(|v| v.position.x.abs())
        .fold(0.0, f32::max);
    if widest > 0.0 { widest + 0.1 * fore } else { 0.0 }
}
