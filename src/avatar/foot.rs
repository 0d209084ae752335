//! The foot of a body at rest: what stands on the ground, and where the toes bend.

use super::{Avatar, Clip, Vertex};
use crate::gait::Joint;
use crate::kernels::shared::body::index::{LEFT_TOES, RIGHT_TOES};
use crate::kernels::shared::standing::STANCE_WIDTH;
use glam::Vec3;

/// From heel to ball, share of the foot's length (ANSUR II, public domain: 0.73).
const BALL: f32 = 0.73;

/// The ground under a foot at rest, mesh space, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Footprint {
    /// The rearmost point.
    pub(crate) heel: Vec3,
    /// Where the toes bend.
    pub(crate) ball: Vec3,
    /// The foremost point.
    pub(crate) tip: Vec3,
}

impl Footprint {
    /// As it lies in the buffer `rig`: the ball, and the length of the toes.
    pub(crate) fn in_rig(self) -> [f32; 4] {
        self.ball.extend(self.tip.z - self.ball.z).to_array()
    }
}

/// Shares of a stride between which a foot is flat on the ground, from when it comes down.
const FLAT: [f32; 2] = [0.15, 0.35];

/// Where the left foot of a body comes down in a walk, to the left and ahead of it, m: the mean of both feet, by where they are
/// while they lie flat.
pub(crate) fn foot_down(avatar: &Avatar, clip: &Clip) -> [f32; 2] {
    let count = clip.frames.len() as f32;
    let (mut sum, mut flat) = ([0.0; 2], 0.0);
    for (number, frame) in clip.frames.iter().enumerate() {
        let joints = avatar.model_from_joint(&frame.rotations, frame.root);
        for (later, foot) in [(0.0, Joint::LeftFoot), (0.5, Joint::RightFoot)] {
            let since = (number as f32 / count + later).fract();
            if (FLAT[0]..FLAT[1]).contains(&since) {
                let at = joints[foot as usize].w_axis;
                let [aside, ahead] = &mut sum;
                *aside += at.x.abs();
                *ahead += at.z + since * clip.stride_travel;
                flat += 1.0;
            }
        }
    }
    sum.map(|part| part / f32::max(flat, 1.0))
}

/// Where it is in a stand with the feet side by side, likewise, m.
pub(crate) fn foot_stands(avatar: &Avatar) -> [f32; 2] {
    let rest = avatar.joints.map(|joint| joint.rotation);
    let joints = avatar.model_from_joint(&rest, avatar.joints[0].translation);
    let [left, right] = [Joint::LeftHip, Joint::RightHip].map(|hip| joints[hip as usize].w_axis);
    [0.5 * STANCE_WIDTH * (left.x - right.x), 0.5 * (left.z + right.z)]
}

/// Vertices of the finest mesh that move with a joint more than with all others, mesh space, m.
pub(crate) fn vertices(avatar: &Avatar, joint: Joint) -> impl Iterator<Item = Vec3> {
    let share = move |vertex: &Vertex| -> f32 {
        let pairs = vertex.joints.iter().zip(vertex.weights);
        pairs.filter(|(own, _)| usize::from(**own) == joint as usize).map(|(_, weight)| weight).sum()
    };
    let finest = avatar.levels.iter().take(1).flat_map(|mesh| &mesh.vertices);
    finest.filter(move |vertex| share(vertex) > 0.5).map(|vertex| vertex.position)
}

/// The feet, and the joints of their toes on the device.
const FEET: [(Joint, usize); 2] = [(Joint::LeftFoot, LEFT_TOES), (Joint::RightFoot, RIGHT_TOES)];

/// Share of the foot's length on either side of the ball over which its skin goes from foot to toes.
const BEND: f32 = 0.06;

/// Left and right.
pub(crate) fn footprints(avatar: &Avatar) -> [Footprint; 2] {
    FEET.map(|(foot, _)| {
        let ankle = avatar.joints[foot as usize].joint_from_mesh.inverse().w_axis.truncate();
        footprint(avatar, foot, ankle)
    })
}

/// The vertex with the part of its weight that hangs on a foot but lies before the ball moved to the toes.
pub(crate) fn with_toes(mut vertex: Vertex, prints: &[Footprint; 2]) -> Vertex {
    for ((foot, toes), print) in FEET.into_iter().zip(prints) {
        let Some(slot) = vertex.joints.iter().position(|joint| usize::from(*joint) == foot as usize) else {
            continue;
        };
        let width = BEND * (print.tip.z - print.heel.z);
        let t = ((vertex.position.z - print.ball.z + width) / (2.0 * width).max(1e-6)).clamp(0.0, 1.0);
        let share = t * t * (3.0 - 2.0 * t);
        let moved = vertex.weights[slot] * share;
        let free = (0..4).find(|other| *other != slot && vertex.weights[*other] <= 0.0);
        #[allow(clippy::cast_possible_truncation, reason = "16 or 17")]
        let toes = toes as u8;
        match free {
            Some(free) if moved > 0.0 => {
                vertex.weights[slot] -= moved;
                vertex.joints[free] = toes;
                vertex.weights[free] = moved;
            }
            // no room for both
            None if share > 0.5 => vertex.joints[slot] = toes,
            _ => {}
        }
    }
    vertex
}

/// The footprint of a foot whose joint rests at `ankle`; that of a shoe of usual proportions where no vertex hangs on it.
pub(crate) fn footprint(avatar: &Avatar, foot: Joint, ankle: Vec3) -> Footprint {
    let usual = || {
        let (height, length) = (ankle.y.max(0.0), ankle.y.max(0.02));
        [-0.8, 2.0].map(|z| ankle + Vec3::new(0.0, -height, z * length))
    };
    let own = || vertices(avatar, foot);
    let rear = own().min_by(|a, b| a.z.total_cmp(&b.z));
    let front = own().max_by(|a, b| a.z.total_cmp(&b.z));
    let low = own().map(|p| p.y).min_by(f32::total_cmp);
    let [heel, tip] = match (rear, front, low) {
        (Some(rear), Some(front), Some(low)) => [rear, front].map(|end| end.with_y(low)),
        _ => usual(),
    };
    Footprint { heel, ball: heel.lerp(tip, BALL), tip }
}
