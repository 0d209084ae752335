//! Which joint of a rig is which of the 16 driven joints.
//!
//! Names are compared after normalisation: the name space (`mixamorig:`) and common prefixes (`Bip01`, `DEF`,
//! `J_Bip`) are dropped, the side is taken out wherever it stands (`LeftArm`, `arm.l`, `L_Arm`, `upperarm_l`), case
//! and separators do not matter. That covers VRM, Mixamo, Unreal, Unity, KayKit, Quaternius and CMU names by
//! one table. A [`RigMap`] names joints outright and goes before everything else.

use super::Error;
use crate::file;
use crate::gait::{JOINT_COUNT, Joint};
use std::collections::BTreeMap;
use std::path::Path;

/// Longest file of a map, bytes.
const MOST_BYTES: u64 = 1 << 20;

/// Names of a rig's joints, given by the user; joints left out are found by the built-in maps.
///
/// As TOML, keys are the names of [`Joint::name`], values the node names of the file:
///
/// ```toml
/// avatar = "hero"  # the file that it is for: its name without its ending; left out: every file
/// height = 1.7     # m, from sole to crown; left out: measured
///
/// [joints]
/// root = "Bone"
/// left_hip = "Bone.012"
/// neck = ""        # empty: as if left out
/// left_knee = "#7" # a node without a name, by its number
/// ```
///
/// A rig that is not recognised is refused with such a map to fill in ([`Error::Rig`]).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RigMap {
    avatar: Option<String>,
    height: Option<f32>,
    names: [Option<String>; JOINT_COUNT],
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct RigMapFile {
    avatar: Option<String>,
    height: Option<f32>,
    #[serde(default)]
    joints: BTreeMap<String, String>,
}

/// Heights that a map may give, m.
const HEIGHTS: std::ops::RangeInclusive<f32> = 0.3..=5.0;

impl RigMap {
    /// Reads a map from TOML text; `name` is what errors call it.
    ///
    /// # Errors
    /// [`Error::Unusable`] for text that is no such table, with the line, or a joint we do not drive.
    pub fn from_toml(name: &str, text: &str) -> Result<Self, Error> {
        let unusable = |message: String| Error::Unusable { name: name.to_owned(), message };
        let file: RigMapFile = toml::from_str(text).map_err(|error| unusable(format!("rig map: {error}")))?;
        if let Some(height) = file.height.filter(|height| !HEIGHTS.contains(height)) {
            let (least, most) = (HEIGHTS.start(), HEIGHTS.end());
            return Err(unusable(format!("rig map: height = {height}: must be {least} to {most} m")));
        }
        let mut map = Self { avatar: file.avatar, height: file.height, ..Self::default() };
        for (key, node) in file.joints {
            let joint = Joint::ALL.into_iter().find(|joint| joint.name() == key).ok_or_else(|| {
                let known = Joint::ALL.map(Joint::name).join(", ");
                unusable(format!("rig map: no joint is called {key:?}; use one of {known}"))
            })?;
            map.names[joint as usize] = Some(node).filter(|node| !node.is_empty());
        }
        Ok(map)
    }

    /// Reads a map from a TOML file.
    ///
    /// # Errors
    /// [`Error::Read`] when it cannot be read, else as [`Self::from_toml`].
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = file::read_text(path, MOST_BYTES)
            .map_err(|source| Error::Read { path: path.to_owned(), source })?;
        Self::from_toml(&path.display().to_string(), &text)
    }

    /// The file that it is for: its name without its ending; none: every file.
    pub fn avatar(&self) -> Option<&str> {
        self.avatar.as_deref()
    }

    /// The height from sole to crown that it gives, m.
    pub const fn height(&self) -> Option<f32> {
        self.height
    }

    /// Node name given for a joint.
    pub fn name(&self, joint: Joint) -> Option<&str> {
        self.names[joint as usize].as_deref()
    }

    /// Gives a node name for a joint.
    #[must_use]
    pub fn with(mut self, joint: Joint, node: &str) -> Self {
        self.names[joint as usize] = Some(node.to_owned());
        self
    }
}

/// Side of the body in a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
}

/// Tokens that say nothing about the body part.
const NOISE: [&str; 21] = [
    "mixamorig",
    "bip",
    "bip01",
    "biped",
    "valvebiped",
    "valve",
    "def",
    "org",
    "mch",
    "j",
    "jnt",
    "joint",
    "bone",
    "skeleton",
    "armature",
    "character",
    "rig",
    "cc",
    "base",
    "skel",
    "b",
];

/// Splits at separators, case changes and digits; lower case.
pub(super) fn words(name: &str) -> Vec<String> {
    let letters: Vec<char> = name.chars().collect();
    let mut words: Vec<String> = Vec::new();
    let mut fresh = true;
    for (i, &c) in letters.iter().enumerate() {
        if !c.is_alphanumeric() {
            fresh = true;
            continue;
        }
        let before = i.checked_sub(1).map(|i| letters[i]);
        let after = letters.get(i + 1);
        let starts = before.is_some_and(|b| {
            c.is_numeric() != b.is_numeric()
                || (c.is_uppercase() && (b.is_lowercase() || after.is_some_and(|a| a.is_lowercase())))
        });
        if fresh || starts {
            words.push(String::new());
        }
        fresh = false;
        if let Some(last) = words.last_mut() {
            last.extend(c.to_lowercase());
        }
    }
    words
}

/// Side and body part of a node name.
pub(super) fn normalise(name: &str) -> (Option<Side>, String) {
    let name = name.rsplit(':').next().unwrap_or(name);
    let mut side = None;
    let mut part = String::new();
    let mut after_noise = false;
    for token in words(name) {
        let number = token.chars().all(char::is_numeric);
        match token.as_str() {
            "l" | "left" => side = side.or(Some(Side::Left)),
            "r" | "right" => side = side.or(Some(Side::Right)),
            noise if NOISE.contains(&noise) => after_noise = true,
            // The number of a prefix: Bip001.
            _ if number && after_noise && part.is_empty() => {}
            _ if number => part.push_str(token.trim_start_matches('0')),
            other => part.push_str(other),
        }
    }
    if side.is_none() {
        // lefthand; CMU: lfemur, rradius.
        let prefixes = [("left", Side::Left), ("right", Side::Right), ("l", Side::Left), ("r", Side::Right)];
        for (prefix, found) in prefixes {
            if let Some(rest) = part.strip_prefix(prefix).filter(|rest| known_part(rest)) {
                return (Some(found), rest.to_owned());
            }
        }
    }
    (side, part)
}

fn known_part(part: &str) -> bool {
    Joint::ALL
        .into_iter()
        .filter(|&joint| joint.mirrored() != joint)
        .any(|joint| parts(joint).contains(&part))
}

/// Accepted body parts of a joint, best first.
pub(super) fn parts(joint: Joint) -> &'static [&'static str] {
    match joint {
        Joint::Root => &["hips", "pelvis", "hip"],
        Joint::Spine => &["spine", "spine1", "abdomen", "lowerback", "waist", "torso", "chest"],
        Joint::Neck => &["neck", "neck1", "lowerneck"],
        Joint::Head => &["head"],
        Joint::LeftShoulder | Joint::RightShoulder => {
            &["upperarm", "uparm", "upperarm1", "humerus", "arm", "shoulder"]
        }
        Joint::LeftElbow | Joint::RightElbow => {
            &["lowerarm", "forearm", "lowarm", "lowerarm1", "radius", "elbow"]
        }
        Joint::LeftHand | Joint::RightHand => &["wrist", "hand", "palm", "fist", "wrist1", "hand1", "palm1"],
        Joint::LeftHip | Joint::RightHip => {
            &["upperleg", "upleg", "thigh", "femur", "upperleg1", "hip", "leg"]
        }
        Joint::LeftKnee | Joint::RightKnee => {
            &["lowerleg", "calf", "shin", "tibia", "knee", "lowerleg1", "leg"]
        }
        Joint::LeftFoot | Joint::RightFoot => &["foot", "ankle"],
    }
}

/// The side a joint must have.
pub(super) fn side(joint: Joint) -> Option<Side> {
    match joint as usize {
        4..=6 | 10..=12 => Some(Side::Left),
        7..=9 | 13..=15 => Some(Side::Right),
        _ => None,
    }
}

/// The joint's bone in VRM's humanoid (0.x and 1.0 agree on these).
pub(super) fn vrm_bone(joint: Joint) -> &'static str {
    match joint {
        Joint::Root => "hips",
        Joint::Spine => "spine",
        Joint::Neck => "neck",
        Joint::Head => "head",
        Joint::LeftShoulder => "leftUpperArm",
        Joint::LeftElbow => "leftLowerArm",
        Joint::LeftHand => "leftHand",
        Joint::RightShoulder => "rightUpperArm",
        Joint::RightElbow => "rightLowerArm",
        Joint::RightHand => "rightHand",
        Joint::LeftHip => "leftUpperLeg",
        Joint::LeftKnee => "leftLowerLeg",
        Joint::LeftFoot => "leftFoot",
        Joint::RightHip => "rightUpperLeg",
        Joint::RightKnee => "rightLowerLeg",
        Joint::RightFoot => "rightFoot",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_the_usual_rigs_are_understood() {
        use Side::{Left, Right};
        for (name, side, part) in [
            ("mixamorig:LeftUpLeg", Some(Left), "upleg"),
            ("mixamorig:Spine1", None, "spine1"),
            ("upperarm_l", Some(Left), "upperarm"),
            ("spine_01", None, "spine1"),
            ("RightLowerArm", Some(Right), "lowerarm"),
            ("UpperArm.R", Some(Right), "upperarm"),
            ("wrist.l", Some(Left), "wrist"),
            ("J_Bip_L_UpperLeg", Some(Left), "upperleg"),
            ("Bip001 R Calf", Some(Right), "calf"),
            ("LHipJoint", Some(Left), "hip"),
            ("lfemur", Some(Left), "femur"),
            ("rradius", Some(Right), "radius"),
            ("Left knee", Some(Left), "knee"),
            ("LowerBack", None, "lowerback"),
            ("radius", None, "radius"),
            ("Palm.L", Some(Left), "palm"),
            ("PalmR", Some(Right), "palm"),
            ("palm_01_l", Some(Left), "palm1"),
            ("leftpalm", Some(Left), "palm"),
            ("rpalm", Some(Right), "palm"),
        ] {
            assert_eq!(normalise(name), (side, part.to_owned()), "{name}");
        }
    }

    #[test]
    fn maps_are_read_from_toml_and_unknown_joints_are_refused() {
        let map = RigMap::from_toml("map", "[joints]\nroot = \"Bone\"\nleft_hip = \"Bone.012\"").unwrap();
        assert_eq!((map.name(Joint::Root), map.name(Joint::LeftHip)), (Some("Bone"), Some("Bone.012")));
        assert_eq!(map, RigMap::default().with(Joint::Root, "Bone").with(Joint::LeftHip, "Bone.012"));
        let message = RigMap::from_toml("map", "[joints]\ntail = \"Bone\"").unwrap_err().to_string();
        assert!(message.contains("\"tail\"") && message.contains("left_hip"), "{message}");
        let map = RigMap::from_toml("map", "avatar = \"a\"\nheight = 1.8\n[joints]\nneck = \"\"").unwrap();
        assert_eq!((map.avatar(), map.height(), map.name(Joint::Neck)), (Some("a"), Some(1.8), None));
        let message = RigMap::from_toml("map", "height = 170").unwrap_err().to_string();
        assert!(message.contains("0.3 to 5 m"), "{message}");
        let message = RigMap::from_toml("map", "[joints]\nroot = 3").unwrap_err().to_string();
        assert!(message.contains("line 2"), "{message}");
    }
}
