//! Names of other rigs for our 16 joints: presets, maps from TOML files, and a heuristic over common words.
//!
//! "Shoulder" and "hip" are the centres of the ball joints (where the upper arm and the thigh begin), "hand" is
//! the wrist and "foot" the ankle; of a spine of several joints we take the one about 40 % of the way from the
//! pelvis to the base of the neck, as in E-Gait. A joint that a rig lacks can be put between some that it has.
//!
//! A map as a file names each of the 16 joints as the motion file does, or says which rig it is like:
//!
//! ```toml
//! rig = "my markers"                       # for the report
//! like = "Mixamo"                          # take the rest from there; optional
//! head = "Skull"
//! left_hand = "LWRA + LWRB"                # the middle of the two
//! spine = "0.6*Pelvis + 0.4*Sternum"       # weights, which must add up to 1
//! ```

mod file;
mod presets;
mod words;

use super::text::list;
use crate::gait::{JOINT_COUNT, Joint, JointSet, Pose};
use glam::Vec3;
use presets::{PRESETS, Preset};

/// Most joints that one place may be between.
const MAX_BETWEEN: usize = 8;

/// The names that a file uses for the 16 joints.
#[derive(Debug, Clone, PartialEq)]
pub struct JointMap {
    /// Name of the rig, for reports.
    pub rig: String,
    /// Indexed by [`Joint`]: names in the file with weights that add up to 1, nearly always one name. Names are
    /// compared without case, punctuation and `namespace:` prefix.
    pub names: [Vec<(String, f32)>; JOINT_COUNT],
}

/// Where each of the 16 joints stands among the joints of a file: indices with weights that add up to 1, none for a joint
/// that the file lacks.
#[derive(Debug, Clone, PartialEq)]
pub struct Sources([Vec<(usize, f32)>; JOINT_COUNT]);

impl Sources {
    /// One joint of the file for each of ours.
    pub(super) fn single(joints: [usize; JOINT_COUNT]) -> Self {
        Self(joints.map(|joint| vec![(joint, 1.0)]))
    }

    /// The 16 joints, from the position of each joint of the file; those that it lacks at the origin.
    pub fn pose(&self, at: impl Fn(usize) -> Vec3) -> Pose {
        self.0.each_ref().map(|parts| match parts.as_slice() {
            [(one, _)] => at(*one),
            parts => parts.iter().map(|&(joint, weight)| at(joint) * weight).sum(),
        })
    }

    /// The joints that the file lacks.
    pub fn missing(&self) -> JointSet {
        Joint::ALL.into_iter().filter(|&joint| self.of(joint).is_empty()).collect()
    }

    /// The same joints where only some `points` of the file had been named.
    pub(super) fn of_points(mut self, points: &[usize]) -> Self {
        for (joint, _) in self.0.iter_mut().flatten() {
            *joint = points.get(*joint).copied().unwrap_or(*joint);
        }
        self
    }

    /// Indices and weights of one joint.
    pub fn of(&self, joint: Joint) -> &[(usize, f32)] {
        &self.0[joint as usize]
    }

    /// Every joint of the file that is used.
    pub fn used(&self) -> impl Iterator<Item = usize> + '_ {
        self.0.iter().flatten().map(|&(joint, _)| joint)
    }
}

/// Lower-case letters and digits of a name, without a `namespace:` before it.
pub(super) fn plain(name: &str) -> String {
    let name = name.rsplit(':').next().unwrap_or(name);
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

/// `a`, `a + b` (their mean) or `0.6*a + 0.4*b` as names with weights.
pub(super) fn places(text: &str) -> Result<Vec<(String, f32)>, String> {
    let parts: Vec<&str> = text.split('+').map(str::trim).collect();
    if parts.len() > MAX_BETWEEN {
        return Err(format!("{} names; up to {MAX_BETWEEN} are taken", parts.len()));
    }
    let even = 1.0 / parts.len() as f32;
    let mut found = Vec::with_capacity(parts.len());
    for part in &parts {
        let (weight, name) = match part.split_once('*') {
            None => (even, *part),
            Some((weight, name)) => {
                let weight = weight.trim();
                let value = weight.parse::<f32>().ok().filter(|value| value.abs() <= 10.0);
                let value = value.ok_or_else(|| {
                    format!("weight {weight:?} of {name:?}; a number from -10 to 10 was expected")
                })?;
                (value, name.trim())
            }
        };
        if plain(name).is_empty() {
            return Err(format!("an empty name in {text:?}; write a name, \"a + b\" or \"0.6*a + 0.4*b\""));
        }
        found.push((name.to_owned(), weight));
    }
    let sum: f32 = found.iter().map(|(_, weight)| weight).sum();
    if (sum - 1.0).abs() > 1e-3 {
        return Err(format!("the weights in {text:?} add up to {sum}; they must add up to 1"));
    }
    Ok(found)
}

impl JointMap {
    /// The map of a rig known by name, without case; [`JointMap::known`] lists them.
    pub fn named(rig: &str) -> Option<Self> {
        PRESETS.iter().find(|preset| preset.is_called(rig)).map(Preset::map)
    }

    /// Names of the rigs known by name.
    pub fn known() -> Vec<&'static str> {
        PRESETS.iter().map(|preset| preset.rig).collect()
    }

    /// Where each of the 16 joints stands in `names`; of a capture of the legs, those up to the pelvis.
    ///
    /// # Errors
    /// Joints that are not found.
    pub fn resolve<S: AsRef<str>>(&self, names: &[S]) -> Result<Sources, MissingJoints> {
        complete(self.places(names), &format!("rig {:?}", self.rig), names)
    }

    fn places<S: AsRef<str>>(&self, names: &[S]) -> Found {
        let plain_names: Vec<String> = names.iter().map(|name| plain(name.as_ref())).collect();
        let index = |wanted: &str| {
            let wanted = plain(wanted);
            plain_names.iter().position(|name| *name == wanted)
        };
        self.names.each_ref().map(|parts| {
            let parts: Option<Vec<_>> =
                parts.iter().map(|(name, weight)| index(name).map(|at| (at, *weight))).collect();
            parts.filter(|parts| !parts.is_empty())
        })
    }
}

/// Finds the 16 joints among the names of a file: the known rigs first, then by common words; if none has them all, those
/// of the legs in the same order.
///
/// Returns the rig's name (or "words") and where each joint stands in `names`.
///
/// # Errors
/// Joints that are not found.
pub fn find<S: AsRef<str>>(names: &[S]) -> Result<(String, Sources), MissingJoints> {
    let has = |mark: &str| names.iter().any(|name| plain(name.as_ref()) == mark);
    let presets = PRESETS.iter().filter(|preset| preset.mark.is_none_or(has));
    let mut found: Vec<(&str, Found)> =
        presets.map(|preset| (preset.rig, preset.map().places(names))).collect();
    found.push(("words", words::by_words(names).map(|joint| joint.map(|joint| vec![(joint, 1.0)]))));
    let chosen = found.iter().position(|(_, found)| found.iter().all(Option::is_some));
    let chosen = chosen.or_else(|| found.iter().position(|(_, found)| is_of_legs(found)));
    let (rig, joints) = found.swap_remove(chosen.unwrap_or(found.len() - 1));
    Ok((rig.to_owned(), complete(joints, "any known rig", names)?))
}

/// A file does not have all joints under the names of a rig.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "{} of the 16 joints not found under the names of {rig}: {}; the file has: {}; give a joint map",
    missing.len(),
    missing.join(", "),
    list(names)
)]
pub struct MissingJoints {
    /// The rig, in words.
    pub rig: String,
    /// Joints that were not found.
    pub missing: Vec<&'static str>,
    /// The names that the file has.
    pub names: Vec<String>,
}

impl From<MissingJoints> for String {
    fn from(error: MissingJoints) -> Self {
        error.to_string()
    }
}

/// Places of the joints, as far as they were found.
type Found = [Option<Vec<(usize, f32)>>; JOINT_COUNT];

/// Whether these are the joints of the legs and no head, arm or neck: a capture of the legs. Where some of the upper body
/// is there, what is not found has another name.
fn is_of_legs(found: &Found) -> bool {
    Joint::ALL.into_iter().all(|joint| match joint {
        Joint::Spine => true,
        _ => found[joint as usize].is_some() != Joint::UPPER_BODY.contains(&joint),
    })
}

/// The given map, or the one that fits; with the rig's name for the report.
pub(super) fn choose<S: AsRef<str>>(
    given: Option<&JointMap>,
    names: &[S],
) -> Result<(String, Sources), String> {
    match given {
        Some(map) => Ok((map.rig.clone(), map.resolve(names)?)),
        None => Ok(find(names)?),
    }
}

fn complete<S: AsRef<str>>(found: Found, rig: &str, names: &[S]) -> Result<Sources, MissingJoints> {
    let missing: Vec<&'static str> =
        Joint::ALL.into_iter().filter(|&j| found[j as usize].is_none()).map(Joint::name).collect();
    if missing.is_empty() || is_of_legs(&found) {
        return Ok(Sources(found.map(Option::unwrap_or_default)));
    }
    let names = names.iter().map(|name| name.as_ref().to_owned()).collect();
    Err(MissingJoints { rig: rig.to_owned(), missing, names })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names as each rig writes them, with what should become of some joints.
    fn check(names: &[&str], rig: &str, expected: &[(Joint, &str)]) {
        let (found_rig, joints) = find(names).unwrap();
        assert_eq!(found_rig, rig);
        for (joint, name) in expected {
            assert_eq!(
                joints.of(*joint).iter().map(|&(i, _)| names[i]).collect::<Vec<_>>(),
                [*name],
                "{rig} {joint:?}"
            );
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
        let map = JointMap::named("mixamo").unwrap().names;
        let mut map: Vec<String> = map.iter().flatten().map(|(name, _)| name.clone()).collect();
        map.retain(|name| name != "leftleg");
        let message = find(&map).unwrap_err().to_string();
        assert!(message.contains("left_knee") && message.contains("rightupleg"), "{message}");
        assert!(message.starts_with("1 of the 16"), "{message}");
    }
}
