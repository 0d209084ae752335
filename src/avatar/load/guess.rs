//! A rig map to fill in: what was found, what the shape of the skeleton suggests, and the file's joints as comments.

use super::rig::{Driven, common, needed, upward};
use super::source::Source;
use crate::gait::{JOINT_COUNT, Joint};
use glam::Vec3;
use std::fmt::Write as _;

/// Most nodes that are listed.
const MOST_LINES: usize = 600;

/// The map as TOML. `driven`: what was found; `place`: position of every node.
pub(super) fn map(name: &str, source: &Source, driven: &Driven, place: &[Vec3]) -> String {
    let guessed = completed(source, driven);
    let mut text = format!(
        "# Rig map of {name:?}: which node of the file is which joint. Fill in what is empty, check what is a guess.\n\
         # A node without a name is \"#\" and its number.\n\
         avatar = {}  # the file that it is for: its name without its ending\n\
         # height = 1.7  # m, from sole to crown without headwear; left out: measured\n\n[joints]\n",
        toml::Value::String(name.to_owned())
    );
    for joint in Joint::ALL {
        let index = joint as usize;
        let (value, remark) = match (driven[index], guessed[index]) {
            (Some(node), _) => (source.label(node), "found"),
            (None, Some(node)) => (source.label(node), "a guess"),
            (None, None) if needed(joint) => ("\"\"".to_owned(), "needed"),
            (None, None) => ("\"\"".to_owned(), "may stay empty"),
        };
        let _ = writeln!(text, "{} = {value}  # {remark}; {}", joint.name(), meaning(joint));
    }
    text += "\n# The joints of the file, each below its parent, with their places in its unit: left, up, ahead.\n";
    let listed = listed(source);
    for &node in listed.iter().take(MOST_LINES) {
        let depth = upward(source, node).skip(1).filter(|above| listed.contains(above)).count();
        let Vec3 { x, y, z } = place.get(node).copied().unwrap_or_default();
        let _ = writeln!(text, "# {}{}  ({x:.3}, {y:.3}, {z:.3})", "  ".repeat(depth), source.label(node));
    }
    if listed.len() > MOST_LINES {
        let _ = writeln!(text, "# and {} more", listed.len() - MOST_LINES);
    }
    text
}

/// Where a joint is.
fn meaning(joint: Joint) -> &'static str {
    match joint {
        Joint::Root => "the pelvis",
        Joint::Spine => "where the trunk bends",
        Joint::Neck => "where the neck begins",
        Joint::Head => "where the head begins",
        Joint::LeftShoulder | Joint::RightShoulder => "the upper arm, not the collar bone",
        Joint::LeftElbow | Joint::RightElbow => "the forearm",
        Joint::LeftHand | Joint::RightHand => "the hand or wrist",
        Joint::LeftHip | Joint::RightHip => "the thigh",
        Joint::LeftKnee | Joint::RightKnee => "the shin",
        Joint::LeftFoot | Joint::RightFoot => "the foot or ankle, not the toes",
    }
}

/// The joints of the skins, or all nodes of a file without any; parents before their children.
fn listed(source: &Source) -> Vec<usize> {
    let is_joint = |node: &usize| source.skins.iter().any(|skin| skin.joints.contains(node));
    let all: Vec<usize> = (0..source.nodes.len()).collect();
    let joints: Vec<usize> = all.iter().copied().filter(is_joint).collect();
    let mut listed = if joints.is_empty() { all } else { joints };
    listed.sort_by_cached_key(|node| {
        let mut way: Vec<usize> = upward(source, *node).collect();
        way.reverse();
        way
    });
    listed
}

/// What was found, and beside it what the tree of joints suggests.
fn completed(source: &Source, driven: &Driven) -> Driven {
    let mut all = *driven;
    let put = |all: &mut Driven, joint: Joint, node: Option<usize>| {
        if all[joint as usize].is_none() && !all.contains(&node) {
            all[joint as usize] = node;
        }
    };
    let parent = |node: Option<usize>| node.and_then(|node| source.nodes[node].parent);
    for first in [Joint::LeftShoulder, Joint::RightShoulder, Joint::LeftHip, Joint::RightHip] {
        let [top, middle, end] = [0, 1, 2].map(|k| Joint::ALL[(first as usize + k) % JOINT_COUNT]);
        put(&mut all, middle, parent(driven[end as usize]));
        let above = parent(all[middle as usize]);
        put(&mut all, top, above);
        let child = largest_child(source, all[top as usize]);
        put(&mut all, middle, child);
        let child = largest_child(source, all[middle as usize]);
        put(&mut all, end, child);
    }
    put(&mut all, Joint::Neck, parent(driven[Joint::Head as usize]));
    let legs = [Joint::LeftHip, Joint::RightHip].map(|hip| all[hip as usize]);
    if let [Some(left), Some(right)] = legs {
        put(&mut all, Joint::Root, common(source, &[left, right]));
    }
    all
}

/// The child that most joints hang on.
fn largest_child(source: &Source, node: Option<usize>) -> Option<usize> {
    let node = node?;
    let below = |top: usize| {
        (0..source.nodes.len()).filter(|&other| upward(source, other).any(|above| above == top)).count()
    };
    let children = (0..source.nodes.len()).filter(|&other| source.nodes[other].parent == Some(node));
    children.max_by_key(|&child| (below(child), std::cmp::Reverse(child)))
}
