//! Finds the 16 driven joints in a file's nodes: the user's map, VRM's humanoid, names, then the shape of the tree.

use super::super::rig_map::{RigMap, normalise, parts, side, vrm_bone};
use super::source::Source;
use super::{Fault, guess};
use crate::gait::{JOINT_COUNT, Joint};
use glam::Vec3;

/// Node of each driven joint; `Spine`, `Neck` may be missing in a rig.
pub(super) type Driven = [Option<usize>; JOINT_COUNT];

/// Joints a rig cannot do without.
pub(super) fn needed(joint: Joint) -> bool {
    !matches!(joint, Joint::Neck | Joint::Spine)
}

/// Nodes from `node` up to the root of the file.
pub(super) fn upward(source: &Source, node: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(node), |&node| source.nodes[node].parent)
}

/// Lowest common ancestor.
pub(super) fn common(source: &Source, nodes: &[usize]) -> Option<usize> {
    let (&first, others) = nodes.split_first()?;
    upward(source, first).find(|&above| others.iter().all(|&node| upward(source, node).any(|n| n == above)))
}

/// Finds the driven joints. `place`: position of every node in the chosen pose.
///
/// # Errors
/// A message naming the joints that were not found, and a rig map to fill in.
pub(super) fn find(name: &str, source: &mut Source, map: &RigMap, place: &[Vec3]) -> Result<Driven, Fault> {
    let mut driven: Driven = [None; JOINT_COUNT];
    let fault = |source: &Source, driven: &Driven, message| Fault::Rig {
        message,
        map: guess::map(name, source, driven, place),
    };
    let mut unknown = None;
    for joint in Joint::ALL {
        let Some(given) = map.name(joint) else { continue };
        driven[joint as usize] = source.node(given);
        if driven[joint as usize].is_none() {
            unknown.get_or_insert((joint, given));
        }
    }
    if let Some((joint, given)) = unknown {
        let message =
            format!("the rig map calls {} {given:?}, but no node of the file has that name", joint.name());
        return Err(fault(source, &driven, message));
    }
    for joint in Joint::ALL {
        let humanoid =
            source.humanoid.iter().find(|(bone, _)| bone == vrm_bone(joint)).map(|(_, node)| *node);
        driven[joint as usize] = driven[joint as usize].or(humanoid);
    }
    if source.humanoid.is_empty() {
        by_name(source, &mut driven);
    } else {
        source.report.push("joints: from the VRM humanoid".to_owned());
    }
    let missing: Vec<Joint> =
        Joint::ALL.into_iter().filter(|&joint| needed(joint) && driven[joint as usize].is_none()).collect();
    if !missing.is_empty() {
        let names = missing.iter().map(|joint| joint.name()).collect::<Vec<_>>().join(", ");
        match by_shape(source, place) {
            Some(found) => {
                source
                    .report
                    .push(format!("joints: {names} found by the shape of the skeleton, not by name"));
                // Names that were understood in part are not mixed with guesses.
                let mapped = Joint::ALL.map(|joint| map.name(joint).and(driven[joint as usize]));
                driven = std::array::from_fn(|joint| mapped[joint].or(found[joint]));
            }
            None => {
                let message = format!(
                    "no humanoid: found no joint for {names} among the names of its {} skin joints, nor two legs, two \
                     arms and a head in its skeleton",
                    source.skins.iter().map(|skin| skin.joints.len()).max().unwrap_or(0)
                );
                return Err(fault(source, &driven, message));
            }
        }
    }
    complete(source, &mut driven, place);
    let mut seen = Vec::new();
    for joint in Joint::ALL {
        let Some(node) = driven[joint as usize] else { continue };
        if seen.contains(&node) {
            let message =
                format!("{} and another joint are both the node {}", joint.name(), source.label(node));
            return Err(fault(source, &driven, message));
        }
        seen.push(node);
    }
    Ok(driven)
}

fn by_name(source: &mut Source, driven: &mut Driven) {
    let is_joint = |node: usize| source.skins.iter().any(|skin| skin.joints.contains(&node));
    let depth = |node: usize| upward(source, node).count();
    let names: Vec<_> = source.nodes.iter().map(|node| normalise(&node.name)).collect();
    for joint in Joint::ALL {
        if driven[joint as usize].is_some() || joint == Joint::Spine {
            continue;
        }
        let fits = |node: &usize, part: &str| {
            names[*node].0 == side(joint) && names[*node].1 == part && !driven.contains(&Some(*node))
        };
        let found = parts(joint).iter().find_map(|part| {
            let nodes = (0..names.len()).filter(|node| is_joint(*node) && fits(node, part));
            nodes.min_by_key(|&node| depth(node))
        });
        driven[joint as usize] = found;
    }
    let found = driven.iter().filter(|node| node.is_some()).count();
    if found > 0 {
        source.report.push(format!("joints: {found} of 16 found by name"));
    }
}

/// Spine and neck are wherever the rig puts them between hips and head.
fn complete(source: &Source, driven: &mut Driven, place: &[Vec3]) {
    let (Some(root), Some(head)) = (driven[Joint::Root as usize], driven[Joint::Head as usize]) else {
        return;
    };
    let (Some(left), Some(right)) =
        (driven[Joint::LeftShoulder as usize], driven[Joint::RightShoulder as usize])
    else {
        return;
    };
    let column: Vec<usize> = upward(source, head).skip(1).take_while(|&node| node != root).collect();
    let trunk = |node: usize| {
        let arms = [left, right];
        arms.iter().any(|&arm| upward(source, arm).any(|above| above == node))
    };
    if driven[Joint::Neck as usize].is_none() {
        // The lowest joint of the column that carries no arm.
        driven[Joint::Neck as usize] = column.iter().copied().take_while(|&node| !trunk(node)).last();
    }
    if driven[Joint::Spine as usize].is_none() {
        let height = place[head].distance(place[root]);
        let carries = |node: &usize| trunk(*node) && place[*node].distance(place[root]) > 0.02 * height;
        // From the hips upward, the first joint that is not the hips themselves.
        driven[Joint::Spine as usize] = column.iter().rev().copied().find(carries);
    }
}

/// Two feet, two hands, a head: the ends of the skeleton's chains, judged by where they are.
fn by_shape(source: &Source, place: &[Vec3]) -> Option<Driven> {
    let skin = source.skins.iter().max_by_key(|skin| skin.joints.len())?;
    let joints = &skin.joints;
    if joints.len() < 14 {
        return None;
    }
    let leaf = |node: &usize| !joints.iter().any(|&other| source.nodes[other].parent == Some(*node));
    let leaves: Vec<usize> = joints.iter().copied().filter(leaf).collect();
    let (low, high) =
        joints.iter().fold((Vec3::MAX, Vec3::MIN), |(l, h), &n| (l.min(place[n]), h.max(place[n])));
    let height = high.y - low.y;
    let middle = 0.5 * (low.x + high.x);
    let out = |node: usize| (place[node].x - middle) / height;
    let up = |node: usize| (place[node].y - low.y) / height;
    let pick = |fits: &dyn Fn(usize) -> bool, score: &dyn Fn(usize) -> f32| -> Option<usize> {
        leaves.iter().copied().filter(|&n| fits(n)).max_by(|&a, &b| score(a).total_cmp(&score(b)))
    };
    let head = pick(&|n| out(n).abs() < 0.1, &up)?;
    let mut driven: Driven = [None; JOINT_COUNT];
    let foot = |sign: f32| pick(&|n| out(n) * sign > 0.02 && up(n) < 0.2, &|n| -up(n));
    let hand = |sign: f32| pick(&|n| out(n) * sign > 0.08 && up(n) > 0.2, &|n| out(n) * sign);
    let (feet, hands) = ([foot(1.0)?, foot(-1.0)?], [hand(1.0)?, hand(-1.0)?]);
    let root = common(source, &[feet[0], feet[1], head])?;
    let chest = common(source, &[hands[0], hands[1]])?;
    let chain = |end: usize, top: usize| -> Vec<usize> {
        let mut nodes: Vec<usize> = upward(source, end)
            .take_while(|&node| node != top)
            .filter(|node| joints.contains(node))
            .collect();
        nodes.reverse();
        nodes
    };
    for side in 0..2 {
        let leg: Vec<usize> =
            chain(feet[side], root).into_iter().skip_while(|&node| out(node).abs() < 0.01).collect();
        // The last joint of a longer chain is a toe.
        let ankle = if leg.len() > 3 { leg.len() - 2 } else { leg.len().checked_sub(1)? };
        let knee = (1..ankle).min_by(|&a, &b| {
            let half = |i: usize| (up(leg[i]) - 0.5 * (up(leg[0]) + up(leg[ankle]))).abs();
            half(a).total_cmp(&half(b))
        })?;
        let arm = chain(hands[side], chest);
        // A chain of four or more begins with a collar bone.
        let first = usize::from(arm.len() > 3);
        let arm = arm.get(first..first + 3)?;
        let at = |joint: Joint| joint as usize + 3 * side;
        for (joint, node) in [
            (Joint::LeftHip, leg[0]),
            (Joint::LeftKnee, leg[knee]),
            (Joint::LeftFoot, leg[ankle]),
            (Joint::LeftShoulder, arm[0]),
            (Joint::LeftElbow, arm[1]),
            (Joint::LeftHand, arm[2]),
        ] {
            driven[at(joint)] = Some(node);
        }
    }
    driven[Joint::Root as usize] = Some(root);
    driven[Joint::Head as usize] = Some(head);
    Some(driven)
}
