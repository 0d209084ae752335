//! The rigs known by name.
//!
//! A place is the name of a joint, or several with `+` between them for their mean, each with a weight before it if
//! they differ: `0.6*pelvis + 0.4*sternum`.

use super::{JointMap, places};
use crate::gait::Joint;

/// Middle of the body, then left arm and leg; `{}` stands for the side as that rig writes it.
pub(super) struct Preset {
    pub(super) rig: &'static str,
    /// Other names of the rig.
    also: &'static [&'static str],
    /// A name that only this rig has, where the others' names are the same.
    pub(super) mark: Option<&'static str>,
    middle: [&'static str; 4],
    side: [&'static str; 6],
    left_right: [&'static str; 2],
}

/// Shoulder, elbow, hand, hip, knee, foot as Mixamo, the CMU conversions and many others say it.
const ARM_FOREARM: [&str; 6] = ["{}arm", "{}forearm", "{}hand", "{}upleg", "{}leg", "{}foot"];
const SHOULDER_ELBOW: [&str; 6] = ["{}shoulder", "{}elbow", "{}hand", "{}hip", "{}knee", "{}foot"];
const SHOULDER_WRIST: [&str; 6] = ["{}shoulder", "{}elbow", "{}wrist", "{}hip", "{}knee", "{}ankle"];
const LONG: [&str; 2] = ["left", "right"];
const SHORT: [&str; 2] = ["l", "r"];

/// In the order in which they are tried.
pub(super) const PRESETS: [Preset; 14] = [
    Preset {
        rig: "gaitway",
        also: &[],
        mark: None,
        middle: ["root", "spine", "neck", "head"],
        side: SHOULDER_ELBOW,
        left_right: LONG,
    },
    Preset {
        rig: "E-Gait",
        also: &["EWalk", "STEP"],
        mark: None,
        middle: ["root", "spine", "neck", "head"],
        side: SHOULDER_ELBOW,
        left_right: SHORT,
    },
    Preset {
        rig: "CMU ASF",
        also: &["CMU"],
        mark: None,
        middle: ["root", "upperback", "lowerneck", "head"],
        side: ["{}humerus", "{}radius", "{}hand", "{}femur", "{}tibia", "{}foot"],
        left_right: SHORT,
    },
    // Xia's stylised motions (the paper's SIG) come on the skeleton of the CMU conversions.
    Preset {
        rig: "CMU BVH",
        also: &["Xia", "SIG"],
        mark: Some("lowerback"),
        middle: ["hips", "spine", "neck", "head"],
        side: ARM_FOREARM,
        left_right: LONG,
    },
    // 32 joints; "Spine1" is the thorax, between the shoulders.
    Preset {
        rig: "Human3.6M 32",
        also: &["Human3.6M", "H36M"],
        mark: Some("lwristend"),
        middle: ["hips", "spine", "spine1", "head"],
        side: ARM_FOREARM,
        left_right: LONG,
    },
    // The 17 joints that pose estimators keep.
    Preset {
        rig: "Human3.6M 17",
        also: &["H36M 17"],
        mark: None,
        middle: ["hip", "spine", "thorax", "head"],
        side: ["{}shoulder", "{}elbow", "{}wrist", "{}hip", "{}knee", "{}foot"],
        left_right: SHORT,
    },
    Preset {
        rig: "SMPL",
        also: &["AMASS", "SMPL-H", "SMPL-X"],
        mark: None,
        middle: ["pelvis", "spine2", "neck", "head"],
        side: SHOULDER_WRIST,
        left_right: LONG,
    },
    // Pose estimators of 26 joints (Pose2Sim and others): no spine.
    Preset {
        rig: "HALPE 26",
        also: &["HALPE", "Pose2Sim", "BODY 25"],
        mark: Some("rbigtoe"),
        middle: ["hip", "0.6*hip + 0.4*neck", "neck", "head"],
        side: ["{}shoulder", "{}elbow", "{}wrist", "{}hip", "{}knee", "{}ankle"],
        left_right: SHORT,
    },
    // 15 virtual joints: no neck, no spine (they are put where a body has them).
    Preset {
        rig: "BML",
        also: &["Body Movement Library"],
        mark: Some("sternum"),
        middle: ["pelvis", "0.6*pelvis + 0.4*sternum", "lshoulder + rshoulder", "head"],
        side: SHOULDER_WRIST,
        left_right: SHORT,
    },
    // Origins of the segments that the model of Plug-in Gait writes beside the markers.
    Preset {
        rig: "Plug-in Gait bones",
        also: &["Plug-in Gait", "PiG"],
        mark: Some("pelo"),
        middle: ["pelo", "0.6*pelo + 0.4*trxo", "trxo", "hedo"],
        side: ["{}clo", "{}huo", "{}rao", "{}fep", "{}feo", "{}tio"],
        left_right: SHORT,
    },
    Preset {
        rig: "Bandai-Namco",
        also: &[],
        mark: None,
        middle: ["hips", "spine", "neck", "head"],
        side: ["upperarm{}", "lowerarm{}", "hand{}", "upperleg{}", "lowerleg{}", "foot{}"],
        left_right: SHORT,
    },
    Preset {
        rig: "100STYLE",
        also: &[],
        mark: None,
        middle: ["hips", "chest2", "neck", "head"],
        side: SHOULDER_WRIST,
        left_right: LONG,
    },
    Preset {
        rig: "Mixamo",
        also: &[],
        mark: None,
        middle: ["hips", "spine1", "neck", "head"],
        side: ARM_FOREARM,
        left_right: LONG,
    },
    Preset {
        rig: "VRM",
        also: &[],
        mark: None,
        middle: ["hips", "chest", "neck", "head"],
        side: ["{}upperarm", "{}lowerarm", "{}hand", "{}upperleg", "{}lowerleg", "{}foot"],
        left_right: LONG,
    },
];

impl Preset {
    /// Whether the rig goes by this name.
    pub(super) fn is_called(&self, name: &str) -> bool {
        self.rig.eq_ignore_ascii_case(name) || self.also.iter().any(|also| also.eq_ignore_ascii_case(name))
    }

    /// The preset spelt out.
    pub(super) fn map(&self) -> JointMap {
        let text = |joint: Joint| match joint as usize {
            index @ 0..=3 => self.middle[index].to_owned(),
            index => {
                let (limb, right) = match index {
                    4..=6 => (index - 4, 0),
                    7..=9 => (index - 7, 1),
                    10..=12 => (index - 7, 0),
                    _ => (index - 10, 1),
                };
                self.side[limb].replace("{}", self.left_right[right])
            }
        };
        // A preset is written as it must be; what is not would show in `presets_are_well_formed`.
        let names = Joint::ALL.map(|joint| places(&text(joint)).unwrap_or_default());
        JointMap { rig: self.rig.to_owned(), names }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_well_formed() {
        for preset in &PRESETS {
            let map = preset.map();
            for (joint, place) in Joint::ALL.iter().zip(&map.names) {
                assert!(!place.is_empty(), "{}: {joint:?}", preset.rig);
                let sum: f32 = place.iter().map(|(_, weight)| weight).sum();
                assert!((sum - 1.0).abs() < 1e-6, "{}: {joint:?} weighs {sum}", preset.rig);
            }
        }
    }
}
