//! Names of other rigs for our 16 joints: presets, and a heuristic over common words.
//!
//! "Shoulder" and "hip" are the centres of the ball joints (where the upper arm and the thigh begin), "hand" is
//! the wrist and "foot" the ankle; of a spine of several joints we take the one about 40 % of the way from the
//! pelvis to the base of the neck, as in E-Gait.

use super::text::list;
use crate::gait::{JOINT_COUNT, Joint};

/// The names that a file uses for the 16 joints.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JointMap {
    /// Name of the rig, for reports.
    pub rig: String,
    /// Name in the file, indexed by [`Joint`]; compared without case, punctuation and `namespace:` prefix.
    pub names: [String; JOINT_COUNT],
}

/// Middle of the body, then left arm and leg; `{L}` stands for the side as that rig writes it.
struct Preset {
    rig: &'static str,
    /// A name that only this rig has, where the others' names are the same.
    mark: Option<&'static str>,
    middle: [&'static str; 4],
    side: [&'static str; 6],
    left_right: [&'static str; 2],
}

const PRESETS: [Preset; 8] = [
    Preset {
        rig: "gaitway",
        mark: None,
        middle: ["root", "spine", "neck", "head"],
        side: ["{}shoulder", "{}elbow", "{}hand", "{}hip", "{}knee", "{}foot"],
        left_right: ["left", "right"],
    },
    Preset {
        rig: "E-Gait",
        mark: None,
        middle: ["root", "spine", "neck", "head"],
        side: ["{}shoulder", "{}elbow", "{}hand", "{}hip", "{}knee", "{}foot"],
        left_right: ["l", "r"],
    },
    Preset {
        rig: "CMU ASF",
        mark: None,
        middle: ["root", "upperback", "lowerneck", "head"],
        side: ["{}humerus", "{}radius", "{}hand", "{}femur", "{}tibia", "{}foot"],
        left_right: ["l", "r"],
    },
    Preset {
        rig: "CMU BVH",
        mark: Some("lowerback"),
        middle: ["hips", "spine", "neck", "head"],
        side: ["{}arm", "{}forearm", "{}hand", "{}upleg", "{}leg", "{}foot"],
        left_right: ["left", "right"],
    },
    Preset {
        rig: "Bandai-Namco",
        mark: None,
        middle: ["hips", "spine", "neck", "head"],
        side: ["upperarm{}", "lowerarm{}", "hand{}", "upperleg{}", "lowerleg{}", "foot{}"],
        left_right: ["l", "r"],
    },
    Preset {
        rig: "100STYLE",
        mark: None,
        middle: ["hips", "chest2", "neck", "head"],
        side: ["{}shoulder", "{}elbow", "{}wrist", "{}hip", "{}knee", "{}ankle"],
        left_right: ["left", "right"],
    },
    Preset {
        rig: "Mixamo",
        mark: None,
        middle: ["hips", "spine1", "neck", "head"],
        side: ["{}arm", "{}forearm", "{}hand", "{}upleg", "{}leg", "{}foot"],
        left_right: ["left", "right"],
    },
    Preset {
        rig: "VRM",
        mark: None,
        middle: ["hips", "chest", "neck", "head"],
        side: ["{}upperarm", "{}lowerarm", "{}hand", "{}upperleg", "{}lowerleg", "{}foot"],
        left_right: ["left", "right"],
    },
];

/// Words for the middle joints in order of preference.
const MIDDLE_WORDS: [&[&str]; 4] = [
    &["hips", "pelvis", "hip", "root", "lowertorso"],
    &[
        "spine1",
        "chest2",
        "spine02",
        "spine",
        "chest",
        "upperback",
        "spine01",
        "torso",
        "abdomen",
        "thorax",
        "back",
    ],
    &["neck", "lowerneck", "neck1", "neck01", "neckbase"],
    &["head", "skull", "head1"],
];

/// Words for the joints of one side in order of preference: shoulder, elbow, hand, hip, knee, foot.
const SIDE_WORDS: [&[&str]; 6] = [
    &["upperarm", "uparm", "humerus", "arm", "shoulder", "shldr"],
    &["elbow", "forearm", "lowerarm", "lowarm", "radius", "farm"],
    &["hand", "wrist"],
    &["upleg", "upperleg", "thigh", "femur", "hip", "leg"],
    &["knee", "lowerleg", "lowleg", "calf", "shin", "tibia", "leg"],
    &["ankle", "foot"],
];

/// Lower-case letters and digits of a name, without a `namespace:` before it.
fn plain(name: &str) -> String {
    let name = name.rsplit(':').next().unwrap_or(name);
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

impl JointMap {
    /// The map of a rig known by name ("CMU ASF", "CMU BVH", "Bandai-Namco", "100STYLE", "Mixamo", "VRM",
    /// "E-Gait", "gaitway"), without case.
    pub fn named(rig: &str) -> Option<Self> {
        PRESETS.iter().find(|preset| preset.rig.eq_ignore_ascii_case(rig)).map(Preset::map)
    }

    /// Index into `names` for each of the 16 joints.
    ///
    /// # Errors
    /// A message that lists the joints not found and the names the file has.
    pub fn resolve<S: AsRef<str>>(&self, names: &[S]) -> Result<[usize; JOINT_COUNT], String> {
        let plain_names: Vec<String> = names.iter().map(|name| plain(name.as_ref())).collect();
        let found = self.names.each_ref().map(|wanted| {
            let wanted = plain(wanted);
            plain_names.iter().position(|name| *name == wanted)
        });
        complete(&found, &format!("rig {:?}", self.rig), names)
    }
}

impl Preset {
    fn map(&self) -> JointMap {
        let names = Joint::ALL.map(|joint| match joint as usize {
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
        });
        JointMap { rig: self.rig.to_owned(), names }
    }
}

/// Finds the 16 joints among the names of a file: the known rigs first, then by common words.
///
/// Returns the rig's name (or "words") and the index into `names` of each joint.
///
/// # Errors
/// A message that lists the joints not found and the names the file has.
pub fn find<S: AsRef<str>>(names: &[S]) -> Result<(String, [usize; JOINT_COUNT]), String> {
    let has = |mark: &str| names.iter().any(|name| plain(name.as_ref()) == mark);
    for preset in &PRESETS {
        if preset.mark.is_none_or(has)
            && let Ok(joints) = preset.map().resolve(names)
        {
            return Ok((preset.rig.to_owned(), joints));
        }
    }
    let parts: Vec<(Side, String)> = names.iter().map(|name| part_of(name.as_ref())).collect();
    let pick = |side: Side, words: &[&str], taken: Option<usize>| {
        words.iter().find_map(|word| {
            parts.iter().enumerate().position(|(i, (s, part))| *s == side && part == word && Some(i) != taken)
        })
    };
    let mut found = [None; JOINT_COUNT];
    for (joint, words) in MIDDLE_WORDS.iter().enumerate() {
        found[joint] = pick(Side::Middle, words, None);
    }
    for (side, arm, leg) in [(Side::Left, 4, 10), (Side::Right, 7, 13)] {
        for (part, words) in SIDE_WORDS.iter().enumerate() {
            let joint = if part < 3 { arm + part } else { leg + part - 3 };
            // "leg" is the knee of one rig and the hip of another: never both.
            let taken = if part == 4 { found[leg] } else { None };
            found[joint] = pick(side, words, taken);
        }
    }
    Ok(("words".to_owned(), complete(&found, "any known rig", names)?))
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Left,
    Right,
    Middle,
}

/// Side of the body and the rest of a name, such as (left, "upperarm") of `J_Bip_L_UpperArm`.
fn part_of(name: &str) -> (Side, String) {
    let name = name.rsplit(':').next().unwrap_or(name);
    let mut words: Vec<String> = vec![String::new()];
    let mut previous = ' ';
    for c in name.chars() {
        let starts = c.is_ascii_uppercase() && !previous.is_ascii_uppercase();
        if (starts || !c.is_ascii_alphanumeric()) && words.last().is_some_and(|word| !word.is_empty()) {
            words.push(String::new());
        }
        if c.is_ascii_alphanumeric()
            && let Some(word) = words.last_mut()
        {
            word.push(c.to_ascii_lowercase());
        }
        previous = c;
    }
    let mut side = Side::Middle;
    words.retain(|word| match word.as_str() {
        "l" | "left" => {
            side = Side::Left;
            false
        }
        "r" | "right" => {
            side = Side::Right;
            false
        }
        "mixamorig" | "bip" | "bip01" | "bip001" | "j" | "c" | "joint" | "def" | "org" | "bn" | "b"
        | "jnt" | "" => false,
        _ => true,
    });
    let part = words.concat();
    if side == Side::Middle {
        for (prefix, prefix_side) in
            [("left", Side::Left), ("right", Side::Right), ("l", Side::Left), ("r", Side::Right)]
        {
            if let Some(rest) = part.strip_prefix(prefix)
                && SIDE_WORDS.iter().any(|words| words.contains(&rest))
            {
                return (prefix_side, rest.to_owned());
            }
        }
    }
    (side, part)
}

fn complete<S: AsRef<str>>(
    found: &[Option<usize>; JOINT_COUNT],
    rig: &str,
    names: &[S],
) -> Result<[usize; JOINT_COUNT], String> {
    let missing: Vec<&str> =
        Joint::ALL.into_iter().filter(|&j| found[j as usize].is_none()).map(Joint::name).collect();
    if missing.is_empty() {
        return Ok(found.map(Option::unwrap_or_default));
    }
    Err(format!(
        "{} of the 16 joints not found under the names of {rig}: {}; the file has: {}; give a joint map",
        missing.len(),
        missing.join(", "),
        list(names)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names as each rig writes them, with what should become of some joints.
    fn check(names: &[&str], rig: &str, expected: &[(Joint, &str)]) {
        let (found_rig, joints) = find(names).unwrap();
        assert_eq!(found_rig, rig);
        for (joint, name) in expected {
            assert_eq!(names[joints[*joint as usize]], *name, "{rig} {joint:?}");
        }
    }

    fn sided(middle: &[&str], limbs: &[&str], sides: [&str; 2]) -> Vec<String> {
        let mut names: Vec<String> = middle.iter().map(|&s| s.to_owned()).collect();
        for side in sides {
            names.extend(limbs.iter().map(|limb| limb.replace("{}", side)));
        }
        names
    }

    #[test]
    fn rigs_are_recognised_by_their_names() {
        let names = sided(
            &[
                "mixamorig:Hips",
                "mixamorig:Spine",
                "mixamorig:Spine1",
                "mixamorig:Spine2",
                "mixamorig:Neck",
                "mixamorig:Head",
            ],
            &[
                "mixamorig:{}Shoulder",
                "mixamorig:{}Arm",
                "mixamorig:{}ForeArm",
                "mixamorig:{}Hand",
                "mixamorig:{}UpLeg",
                "mixamorig:{}Leg",
                "mixamorig:{}Foot",
            ],
            ["Left", "Right"],
        );
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        check(
            &names,
            "Mixamo",
            &[(Joint::LeftShoulder, "mixamorig:LeftArm"), (Joint::Spine, "mixamorig:Spine1")],
        );

        let names = sided(
            &["J_Bip_C_Hips", "J_Bip_C_Spine", "J_Bip_C_Chest", "J_Bip_C_Neck", "J_Bip_C_Head"],
            &[
                "J_Bip_{}_Shoulder",
                "J_Bip_{}_UpperArm",
                "J_Bip_{}_LowerArm",
                "J_Bip_{}_Hand",
                "J_Bip_{}_UpperLeg",
                "J_Bip_{}_LowerLeg",
                "J_Bip_{}_Foot",
            ],
            ["L", "R"],
        );
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        check(
            &names,
            "words",
            &[(Joint::RightShoulder, "J_Bip_R_UpperArm"), (Joint::LeftKnee, "J_Bip_L_LowerLeg")],
        );

        let names = sided(
            &["Bip01", "Bip01 Pelvis", "Bip01 Spine", "Bip01 Spine1", "Bip01 Neck", "Bip01 Head"],
            &[
                "Bip01 {} Clavicle",
                "Bip01 {} UpperArm",
                "Bip01 {} Forearm",
                "Bip01 {} Hand",
                "Bip01 {} Thigh",
                "Bip01 {} Calf",
                "Bip01 {} Foot",
            ],
            ["L", "R"],
        );
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        check(&names, "words", &[(Joint::Root, "Bip01 Pelvis"), (Joint::RightHip, "Bip01 R Thigh")]);

        let names = sided(
            &["pelvis", "spine_01", "spine_02", "spine_03", "neck_01", "head"],
            &["clavicle_{}", "upperarm_{}", "lowerarm_{}", "hand_{}", "thigh_{}", "calf_{}", "foot_{}"],
            ["l", "r"],
        );
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        check(&names, "words", &[(Joint::Spine, "spine_02"), (Joint::LeftElbow, "lowerarm_l")]);
    }

    #[test]
    fn a_missing_joint_is_named_with_what_the_file_has() {
        let mut map = JointMap::named("mixamo").unwrap().names.to_vec();
        map.retain(|name| name != "leftleg");
        let message = find(&map).unwrap_err();
        assert!(message.contains("left_knee") && message.contains("rightupleg"), "{message}");
        assert!(message.starts_with("1 of the 16"), "{message}");
    }
}
