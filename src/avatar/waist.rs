//! What a physique needs of a body: its waist, and where its bones lie in the mesh.

use super::{Avatar, Vertex};
use crate::gait::{JOINT_COUNT, Joint};
use crate::kernels::shared::body::index::WAIST;
use glam::Vec3;

/// The vertex with what it shares between root and spine hung on the waist, which is half way between them. It moves as before
/// where the waist has no shape of its own.
pub(crate) fn with_waist(mut vertex: Vertex) -> Vertex {
    let slot_of = |joint: Joint| {
        let mut slots = vertex.joints.iter().zip(vertex.weights);
        slots.position(|(own, weight)| *own == joint as u8 && weight > 0.0)
    };
    let (Some(root), Some(spine)) = (slot_of(Joint::Root), slot_of(Joint::Spine)) else { return vertex };
    let [lower, upper] = [root, spine].map(|slot| vertex.weights[slot]);
    let (more, less) = if lower > upper { (root, spine) } else { (spine, root) };
    #[allow(clippy::cast_possible_truncation, reason = "18")]
    let waist = WAIST as u8;
    vertex.weights[more] = (lower - upper).abs();
    vertex.joints[less] = waist;
    vertex.weights[less] = 2.0 * lower.min(upper);
    vertex
}

/// Where each joint stands in the mesh at rest, m, and the direction of its bone there: to the next joint of its limb, and on
/// from the one before at its end. Up the trunk.
pub(crate) fn bones(avatar: &Avatar) -> [[Vec3; JOINT_COUNT]; 2] {
    let places = avatar.joints.map(|joint| joint.joint_from_mesh.inverse().w_axis.truncate());
    let directions = std::array::from_fn(|joint| {
        if joint <= Joint::Head as usize {
            return Vec3::Y;
        }
        let child = (0..JOINT_COUNT).find(|child| *child != joint && Joint::PARENT[*child] == joint);
        let (from, to) = child.map_or((Joint::PARENT[joint], joint), |child| (joint, child));
        (places[to] - places[from]).try_normalize().unwrap_or(Vec3::NEG_Y)
    });
    [places, directions]
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "halves and quarters are exact")]
mod tests {
    use super::super::{Material, Sex, generated};
    use super::*;

    #[test]
    fn weights_of_the_waist_come_from_root_and_spine_alone_and_leave_their_shares() {
        let of = |root: f32, spine: f32| {
            with_waist(Vertex {
                position: Vec3::ZERO,
                normal: Vec3::Y,
                color: Vec3::ONE,
                alpha: 1.0,
                material: Material::Top,
                joints: [Joint::Spine as u8, Joint::LeftHip as u8, Joint::Root as u8, 0],
                weights: [spine, 1.0 - root - spine, root, 0.0],
            })
        };
        for (root, spine) in [(0.5, 0.5), (0.25, 0.5), (0.5, 0.125), (0.0, 0.75), (1.0, 0.0)] {
            let own = of(root, spine);
            let share = |joint: usize| -> f32 {
                let pairs = own.joints.iter().zip(own.weights);
                pairs.filter(|(j, _)| usize::from(**j) == joint).map(|(_, w)| w).sum()
            };
            let waist = share(WAIST);
            assert_eq!(share(Joint::Root as usize) + 0.5 * waist, root);
            assert_eq!(share(Joint::Spine as usize) + 0.5 * waist, spine);
            assert!(share(Joint::Root as usize) * share(Joint::Spine as usize) == 0.0);
            assert_eq!(own.weights.iter().sum::<f32>(), 1.0);
        }
    }

    #[test]
    fn bones_of_a_body_at_rest_lead_up_its_trunk_and_down_its_limbs() {
        let avatar = generated(Sex::Male);
        let [places, directions] = bones(&avatar);
        for joint in Joint::ALL {
            let direction = directions[joint as usize];
            assert!((direction.length() - 1.0).abs() < 1e-6);
            if (joint as usize) <= Joint::Head as usize {
                assert_eq!(direction, Vec3::Y);
            } else if joint != Joint::LeftFoot && joint != Joint::RightFoot {
                assert!(direction.y < -0.9, "{}: {direction}", joint.name());
            }
        }
        let [knee, foot] = [Joint::LeftKnee, Joint::LeftFoot].map(|joint| places[joint as usize]);
        assert!(directions[Joint::LeftKnee as usize].angle_between(foot - knee) < 1e-3);
    }
}
