//! Acclaim skeleton and motion (ASF/AMC), as of the CMU motion capture database.
//!
//! A bone turns by `L = C M C^-1` about its axis frame `C` and carries `direction * length` of the rest pose;
//! Euler letters apply first to last (`XYZ` means `Rz Ry Rx`). Lengths are inches divided by the `length` of
//! `:units` (CMU: 0.45). Joints are named by the bone that begins there: `lfemur` is the left hip joint.

mod asf;

use super::joint_map::{self, Sources};
use super::repair::{Unit, finish, rate_or};
use super::text::{list, number, shown, syntax};
use super::{MAX_FRAMES, Options, of_file, stem};
use crate::gait::{Error, Pose, Recording};
use asf::{Bone, Freedom};
pub use asf::{Skeleton, parse_asf};
use glam::{Quat, Vec3};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Frame rate of the CMU recordings; AMC files do not carry one.
const CMU_RATE: f32 = 120.0;

/// Fewest degrees of freedom of a skeleton. (Also what keeps the frames in proportion to the text.)
const LEAST_FREEDOMS: usize = 12;

/// The ASF that belongs to an AMC: `35_01.amc` takes `35_01.asf`, else `35.asf`, else the only one in its folder.
///
/// # Errors
/// [`Error::Read`] if the folder cannot be listed, [`Error::Syntax`] if none or several could be meant.
pub fn skeleton_beside(amc: &Path) -> Result<PathBuf, Error> {
    let same = amc.with_extension("asf");
    if same.is_file() {
        return Ok(same);
    }
    let name = amc.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let subject = name.split('_').next().unwrap_or_default();
    let by_subject = amc.with_file_name(format!("{subject}.asf"));
    if by_subject.is_file() {
        return Ok(by_subject);
    }
    let folder = match amc.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let failed = |source| Error::Read { path: folder.to_owned(), source };
    let mut found: Vec<PathBuf> = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)?.take(10_000) {
        let path = entry.map_err(failed)?.path();
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("asf")) {
            found.push(path);
        }
    }
    match <[PathBuf; 1]>::try_from(found) {
        Ok([only]) => Ok(only),
        Err(found) => {
            let message = format!(
                "needs its skeleton: looked for {name}.asf and {subject}.asf beside it, and its folder has {} \
                 .asf files; name the one to use",
                found.len()
            );
            Err(syntax(&amc.display().to_string(), 0, message))
        }
    }
}

/// Lines that are not empty or comments, with their numbers.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}

/// Parses an AMC motion on its skeleton. `path` names it in messages.
///
/// # Errors
/// [`Error::Syntax`] with the line of the first fault; [`Error::Unusable`] if the motion is not that of a body.
pub fn parse_amc(text: &str, path: &str, skeleton: &Skeleton, options: &Options) -> Result<Recording, Error> {
    let names = skeleton.names();
    let (rig, joints) =
        joint_map::choose(options.joint_map.as_ref(), &names).map_err(|message| syntax(path, 0, message))?;
    let (rate, rate_line) = rate_or(options, path, CMU_RATE)?;
    let poses = frames(text, path, skeleton, &joints)?;
    let report = vec![
        format!("ASF/AMC: {} bones, {} frames", skeleton.bones.len() - 1, poses.len()),
        rate_line,
        format!("joint map: {rig}"),
    ];
    let provenance = of_file(path, "AMC");
    let missing = joints.missing();
    let take = Recording { provenance, report, missing, ..Recording::new(stem(path), rate, poses) };
    finish(take, Unit::Stated(skeleton.metres_per_unit), options)
}

fn frames(text: &str, path: &str, skeleton: &Skeleton, joints: &Sources) -> Result<Vec<Pose>, Error> {
    let bones = &skeleton.bones;
    let freedoms: usize = bones.iter().map(|bone| bone.freedoms.len()).sum();
    if freedoms < LEAST_FREEDOMS {
        let message = format!(
            "the skeleton has {freedoms} degrees of freedom; a body that walks has at least {LEAST_FREEDOMS}"
        );
        return Err(syntax(path, 0, message));
    }
    let index: HashMap<&str, usize> = bones.iter().enumerate().map(|(i, b)| (b.name.as_str(), i)).collect();
    let mut scale = if skeleton.degrees { 1.0_f32.to_radians() } else { 1.0 };
    let mut motion = vec![(Quat::IDENTITY, Vec3::ZERO); bones.len()];
    let mut world = motion.clone();
    let mut seen = vec![false; bones.len()];
    let mut poses: Vec<Pose> = Vec::new();
    let mut frame_line = 0;
    for (line, row) in lines(text) {
        if let Some(keyword) = row.strip_prefix(':') {
            match keyword.trim().to_ascii_uppercase().as_str() {
                "DEGREES" => scale = 1.0_f32.to_radians(),
                "RADIANS" => scale = 1.0,
                _ => {}
            }
            continue;
        }
        let mut words = row.split_whitespace();
        let name = words.next().unwrap_or_default();
        if name.bytes().all(|b| b.is_ascii_digit()) {
            if frame_line > 0 {
                close_frame(path, frame_line, bones, &mut seen, &motion, &mut world)?;
                poses.push(joints.pose(|bone| world[bone].1));
            }
            if poses.len() == MAX_FRAMES {
                return Err(syntax(path, line, format!("more than {MAX_FRAMES} frames")));
            }
            frame_line = line;
            continue;
        }
        if frame_line == 0 {
            return Err(syntax(path, line, format!("found {} before the first frame number", shown(name))));
        }
        let Some(&bone) = index.get(name) else {
            let message =
                format!("the skeleton has no bone {}; it has: {}", shown(name), list(&skeleton.names()));
            return Err(syntax(path, line, message));
        };
        if std::mem::replace(&mut seen[bone], true) {
            return Err(syntax(
                path,
                line,
                format!("bone {} twice in the frame of line {frame_line}", shown(name)),
            ));
        }
        motion[bone] = bone_motion(path, line, &bones[bone], words, scale, skeleton.position)?;
    }
    if frame_line > 0 {
        close_frame(path, frame_line, bones, &mut seen, &motion, &mut world)?;
        poses.push(joints.pose(|bone| world[bone].1));
    }
    Ok(poses)
}

/// Rotation and translation that the values on one line ask of a bone.
fn bone_motion<'a>(
    path: &str,
    line: usize,
    bone: &Bone,
    words: impl Iterator<Item = &'a str>,
    scale: f32,
    root_position: Vec3,
) -> Result<(Quat, Vec3), Error> {
    let mut rotation = Quat::IDENTITY;
    let mut translation = if bone.name == "root" { root_position } else { Vec3::ZERO };
    let mut found = 0;
    for word in words {
        let value = number(path, line, word, "a joint value")?;
        match bone.freedoms.get(found) {
            Some(Freedom::Rotation(axis)) => {
                rotation = Quat::from_axis_angle(Vec3::AXES[*axis], value * scale) * rotation;
            }
            Some(Freedom::Translation(axis)) => translation[*axis] += value,
            None => {}
        }
        found += 1;
    }
    if found != bone.freedoms.len() {
        let message =
            format!("bone {} has {found} values; its dof ask for {}", bone.name, bone.freedoms.len());
        return Err(syntax(path, line, message));
    }
    Ok((bone.axis * rotation * bone.axis.inverse(), translation))
}

/// Forward kinematics of one frame: rotation of each bone and where it begins.
fn close_frame(
    path: &str,
    line: usize,
    bones: &[Bone],
    seen: &mut [bool],
    motion: &[(Quat, Vec3)],
    world: &mut [(Quat, Vec3)],
) -> Result<(), Error> {
    for (index, bone) in bones.iter().enumerate() {
        if !seen[index] && !bone.freedoms.is_empty() {
            let message = format!("the frame has no values for bone {}; is the file cut off?", bone.name);
            return Err(syntax(path, line, message));
        }
        let (rotation, translation) = motion[index];
        world[index] = if index == 0 {
            (rotation, translation)
        } else {
            let (parent_rotation, parent_begin) = world[bone.parent];
            let begin = parent_begin + parent_rotation * (bones[bone.parent].vector + translation);
            ((parent_rotation * rotation).normalize(), begin)
        };
    }
    seen.fill(false);
    Ok(())
}
