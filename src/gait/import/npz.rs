//! `NumPy` arrays of joint positions (`.npy`, `.npz`): E-Gait's layout, Human3.6M, SMPL joints, AMASS pose parameters.
//!
//! | array | is |
//! | --- | --- |
//! | `[T][48]`, `[T][16][3]` | one take in E-Gait's order of joints, repaired as E-Gait ([`super::egait`]) |
//! | `[T][17][3]`, `[T][32][3]` | Human3.6M joints |
//! | `[T][22][3]`, `[T][24][3]`, `[T][52][3]`, `[T][55][3]` | SMPL, SMPL-H, SMPL-X joints |
//! | `[T][J][3]` beside `names` `[J]` | joints by name, as in any other file |
//! | `[N][T][48]`, `[N][T][J][3]` | N takes; zeros at their ends are padding |
//! | `poses` `[T][66 or more]` beside `trans` `[T][3]` | AMASS: joint rotations, posed on a skeleton of our own |
//!
//! Every such array of an `.npz` is a take named by it (or by the file, if it is the only one). `fps`, `frame_rate`,
//! `framerate`, `mocap_framerate` or `mocap_frame_rate` gives the rate, else 30 Hz is assumed. With a joint map and
//! no `names`, joints go by their number: `head = "15"`.
//!
//! # The authors' HDF5
//! HDF5 is not read (its library is large and written in C). E-Gait's `features.h5` holds one `[T][48]` array a key and
//! `labels.h5` one number a key; this turns them into what is read here, labels included:
//! ```python
//! import h5py, numpy
//! f, l = h5py.File("features.h5"), h5py.File("labels.h5")
//! numpy.savez_compressed("features.npz", **{k: f[k][:] for k in f})
//! names = ["happy", "angry", "sad", "neutral"]                  # 0 to 3, not the order of the released scripts
//! with open("labels.csv", "w") as out:
//!     print("key,label", file=out)
//!     for k in l: print(k, names[int(l[k][()])], sep=",", file=out)
//! ```

mod amass;
mod npy;

use super::joint_map::{self, Sources};
use super::repair::{Unit, finish, rate_or, rate_stated};
use super::text::{MAX_MAGNITUDE, syntax};
use super::{MAX_FRAMES, MAX_JOINTS, Options, egait, of_data_set, of_file, stem};
use crate::gait::{Error, JOINT_COUNT, Joint, Pose, Recording};
use glam::Vec3;
use npy::Array;
use std::io::{Cursor, Read as _};

/// Frame rate of arrays that do not say: E-Gait's.
const DEFAULT_RATE: f32 = 30.0;
/// Name of the format.
const FORMAT: &str = "NumPy";
/// Most arrays in a file.
const MAX_ARRAYS: usize = 20_000;
/// Unpacked, a file may have this many bytes and 8 times its own (joint positions pack to about a third).
const FREE_BYTES: usize = 1 << 20;
const MAX_RATIO: usize = 8;
/// Our poses may have this many bytes and 6 times the file's.
const FREE_POSE_BYTES: usize = 1 << 20;
const MAX_POSE_RATIO: usize = 6;
/// Names of arrays that hold the rate.
const RATE_KEYS: [&str; 6] =
    ["fps", "frame_rate", "framerate", "rate", "mocap_framerate", "mocap_frame_rate"];
/// Names of arrays that hold the joints' names.
const NAME_KEYS: [&str; 5] = ["names", "joint_names", "joints", "labels", "keypoints"];
/// Joints of Human3.6M in its order, as far as they are used; the others are numbers.
const H36M_17: [&str; 17] = [
    "Hip",
    "RHip",
    "RKnee",
    "RFoot",
    "LHip",
    "LKnee",
    "LFoot",
    "Spine",
    "Thorax",
    "Nose",
    "Head",
    "LShoulder",
    "LElbow",
    "LWrist",
    "RShoulder",
    "RElbow",
    "RWrist",
];
/// Where [`H36M_17`] stand among the 32.
const H36M_32: [usize; 17] = [0, 1, 2, 3, 6, 7, 8, 12, 13, 14, 15, 17, 18, 19, 25, 26, 27];
/// The first joints of SMPL and its kin.
pub(super) const SMPL: [&str; 22] = [
    "pelvis",
    "left_hip",
    "right_hip",
    "spine1",
    "left_knee",
    "right_knee",
    "spine2",
    "left_ankle",
    "right_ankle",
    "spine3",
    "left_toes",
    "right_toes",
    "neck",
    "left_collar",
    "right_collar",
    "head",
    "left_shoulder",
    "right_shoulder",
    "left_elbow",
    "right_elbow",
    "left_wrist",
    "right_wrist",
];

/// Arrays by name.
struct Arrays<'a> {
    path: &'a str,
    /// Frames that the size of the file allows.
    most_frames: usize,
    named: Vec<(String, Array<'a>)>,
}

impl<'a> Arrays<'a> {
    fn get(&self, names: &[&str]) -> Option<&Array<'a>> {
        let is = |name: &&str| self.named.iter().find(|(other, _)| other.eq_ignore_ascii_case(name));
        names.iter().find_map(is).map(|(_, array)| array)
    }

    /// Frames per second and the line for the report.
    fn rate(&self, options: &Options) -> Result<(f32, String), Error> {
        let stated = self.get(&RATE_KEYS).filter(|array| array.len() == 1);
        match stated.and_then(|array| array.number(&vec![0; array.shape.len()])) {
            Some(hertz) => rate_stated(options, self.path, 0, single(hertz)),
            None => rate_or(options, self.path, DEFAULT_RATE),
        }
    }

    /// Whether the file is large enough to have so many frames.
    fn check_frames(&self, frames: usize) -> Result<(), Error> {
        if frames > self.most_frames {
            let most = self.most_frames;
            return Err(self.error(format!(
                "{frames} frames; from a file of this size up to {most} are read (save it without compression, or in \
                 parts)"
            )));
        }
        Ok(())
    }

    fn error(&self, message: impl Into<String>) -> Error {
        syntax(self.path, 0, message)
    }
}

/// Parses one `NumPy` array. `path` names it in messages.
///
/// # Errors
/// [`Error::Syntax`] if it is no array of joint positions; [`Error::Unusable`] if a motion is not that of a body.
pub fn parse_npy(bytes: &[u8], path: &str, options: &Options) -> Result<Vec<Recording>, Error> {
    let array = Array::new(bytes).map_err(|message| syntax(path, 0, message))?;
    takes(&Arrays { path, most_frames: most_frames(bytes), named: vec![(stem(path), array)] }, options)
}

/// Parses an archive of `NumPy` arrays. `path` names it in messages.
///
/// # Errors
/// [`Error::Syntax`] if it is no archive or has no array of joint positions; [`Error::Unusable`] if a motion is not that
/// of a body.
pub fn parse_npz(bytes: &[u8], path: &str, options: &Options) -> Result<Vec<Recording>, Error> {
    let members = unpack(bytes).map_err(|message| syntax(path, 0, message))?;
    let mut named = Vec::with_capacity(members.len());
    for (name, bytes) in &members {
        // What cannot be read may not be needed: AMASS files carry pickled objects.
        if let Ok(array) = Array::new(bytes) {
            named.push((name.clone(), array));
        }
    }
    takes(&Arrays { path, most_frames: most_frames(bytes), named }, options)
}

/// How many frames a file of so many bytes may have: what packs better than any motion is no motion.
fn most_frames(bytes: &[u8]) -> usize {
    let allowed = bytes.len().saturating_mul(MAX_POSE_RATIO).saturating_add(FREE_POSE_BYTES);
    (allowed / size_of::<Pose>()).min(MAX_FRAMES)
}

/// The arrays of an archive, unpacked within bounds.
fn unpack(bytes: &[u8]) -> Result<Vec<(String, Vec<u8>)>, String> {
    let broken = |error: zip::result::ZipError| format!("no archive of arrays: {error}");
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
    if archive.len() > MAX_ARRAYS {
        return Err(format!("{} arrays; up to {MAX_ARRAYS} are read", archive.len()));
    }
    let allowed = bytes.len().saturating_mul(MAX_RATIO).saturating_add(FREE_BYTES);
    let (mut members, mut total) = (Vec::new(), 0);
    for index in 0..archive.len() {
        let file = archive.by_index(index).map_err(broken)?;
        let name = file.name().map_err(broken)?.into_owned();
        let Some(name) = name.strip_suffix(".npy").map(str::to_owned) else { continue };
        let rest = allowed - total;
        let mut content = Vec::new();
        let limit = u64::try_from(rest).unwrap_or(u64::MAX).saturating_add(1);
        file.take(limit).read_to_end(&mut content).map_err(|error| format!("array {name}: {error}"))?;
        if content.len() > rest {
            return Err(format!(
                "unpacked, the arrays have more than {allowed} bytes, for a file of {}; refused (save it without \
                 compression if this is no mistake)",
                bytes.len()
            ));
        }
        total += content.len();
        content.shrink_to_fit();
        members.push((name, content));
    }
    Ok(members)
}

/// All takes of the arrays.
fn takes(arrays: &Arrays<'_>, options: &Options) -> Result<Vec<Recording>, Error> {
    let (rate, rate_line) = arrays.rate(options)?;
    if let (Some(poses), Some(travel)) = (arrays.get(&["poses"]), arrays.get(&["trans"])) {
        let take =
            amass::recording(arrays.path, poses, travel, rate).map_err(|message| arrays.error(message))?;
        let mut take = take;
        take.report.insert(1, rate_line);
        return Ok(vec![finish(take, Unit::Stated(1.0), options)?]);
    }
    let names = arrays.get(&NAME_KEYS).and_then(Array::texts);
    let (mut layouts, mut frames, mut doubt) = (Vec::new(), 0_usize, None);
    for (name, array) in arrays.named.iter().filter(|(_, array)| array.is_numeric()) {
        match Layout::of(array, names.as_deref(), options) {
            Ok(Some(layout)) => {
                frames = frames.saturating_add(layout.takes.saturating_mul(layout.frames));
                layouts.push((name, array, layout));
            }
            Ok(None) => {}
            // Other arrays may hold the motion.
            Err(message) => doubt = doubt.or_else(|| Some(format!("array {name}: {message}"))),
        }
    }
    arrays.check_frames(frames)?;
    if let (true, Some(message)) = (layouts.is_empty(), doubt) {
        return Err(arrays.error(message));
    }
    let is_only = layouts.len() == 1;
    let mut found = Vec::new();
    for (name, array, layout) in &layouts {
        let name = if is_only { stem(arrays.path) } else { (*name).clone() };
        for take in 0..layout.takes {
            let name = if layout.takes > 1 { format!("{name}-{take}") } else { name.clone() };
            let poses =
                layout.poses(array, take).map_err(|message| arrays.error(format!("{name}: {message}")))?;
            let report = vec![
                format!("NumPy: {} of shape {:?}, {} frames", name, array.shape, poses.len()),
                rate_line.clone(),
                format!("joint map: {}", layout.rig),
            ];
            let provenance = if is_only && layout.takes == 1 {
                of_file(arrays.path, FORMAT)
            } else {
                of_data_set(arrays.path, FORMAT, &name)
            };
            let missing = layout.sources.missing();
            let take = Recording { provenance, report, missing, ..Recording::new(name, rate, poses) };
            found.push(if layout.egait {
                egait::repair(take, options)?
            } else {
                finish(take, Unit::Unstated, options)?
            });
        }
    }
    if found.is_empty() {
        let shapes: Vec<String> =
            arrays.named.iter().map(|(name, array)| format!("{name} {:?}", array.shape)).collect();
        return Err(arrays.error(format!(
            "no array of joint positions such as [frames][16][3] or [frames][48]; the file has: {}",
            super::text::list(&shapes)
        )));
    }
    Ok(found)
}

/// How joint positions stand in an array.
struct Layout {
    takes: usize,
    frames: usize,
    joints: usize,
    /// Whether x, y and z have a dimension of their own.
    split: bool,
    /// Whether the takes have a dimension of their own.
    many: bool,
    sources: Sources,
    rig: String,
    egait: bool,
}

impl Layout {
    /// The layout of an array; `None` if it holds no joint positions.
    fn of(array: &Array<'_>, names: Option<&[String]>, options: &Options) -> Result<Option<Self>, String> {
        let named = names.map_or(0, <[String]>::len);
        let fits = |width: usize| width == 3 * JOINT_COUNT || (named > 0 && width == 3 * named);
        let (takes, frames, joints, split, many) = match *array.shape {
            [frames, joints, 3] => (1, frames, joints, true, false),
            [takes, frames, joints, 3] => (takes, frames, joints, true, true),
            [frames, width] if fits(width) => (1, frames, width / 3, false, false),
            [takes, frames, width] if fits(width) => (takes, frames, width / 3, false, true),
            _ => return Ok(None),
        };
        if takes == 0 || frames == 0 || joints > MAX_JOINTS {
            return Ok(None);
        }
        let numbers = || (0..joints).map(|joint| joint.to_string());
        let (rig, sources, egait) = if let (Some(names), true) = (names, named == joints) {
            let (rig, sources) = joint_map::choose(options.joint_map.as_ref(), names)?;
            (rig, sources, false)
        } else if let Some(map) = &options.joint_map {
            (map.rig.clone(), map.resolve(&numbers().collect::<Vec<_>>())?, false)
        } else {
            match joints {
                JOINT_COUNT => {
                    ("E-Gait's order".to_owned(), Sources::single(Joint::ALL.map(|j| j as usize)), true)
                }
                17 => {
                    let (rig, sources) = joint_map::find(&H36M_17)?;
                    (rig, sources, false)
                }
                32 => {
                    let mut names: Vec<String> = numbers().collect();
                    for (&at, name) in H36M_32.iter().zip(H36M_17) {
                        name.clone_into(&mut names[at]);
                    }
                    let (rig, sources) = joint_map::find(&names)?;
                    (rig, sources, false)
                }
                22 | 24 | 52 | 55 => {
                    let (rig, sources) = joint_map::find(&SMPL)?;
                    (rig, sources, false)
                }
                _ if named > 0 => return Ok(None),
                _ => {
                    return Err(format!(
                        "{joints} joints without names; known are 16 (E-Gait), 17 and 32 (Human3.6M), 22, 24, 52 and 55 \
                         (SMPL); add an array of their \"names\" or give a joint map of their numbers"
                    ));
                }
            }
        };
        Ok(Some(Self { takes, frames, joints, split, many, sources, rig, egait }))
    }

    /// The poses of one take in file units, without padding.
    fn poses(&self, array: &Array<'_>, take: usize) -> Result<Vec<Pose>, String> {
        let mut points = vec![Vec3::ZERO; self.joints];
        let mut poses: Vec<Pose> = Vec::with_capacity(self.frames);
        let mut index = [0_usize; 4];
        let rank = array.shape.len().min(4);
        for frame in 0..self.frames {
            for joint in self.sources.used() {
                for (axis, coordinate) in points[joint].as_mut().iter_mut().enumerate() {
                    let tail = if self.split { [joint, axis] } else { [3 * joint + axis, 0] };
                    let all = [take, frame, tail[0], tail[1]];
                    index[..rank].copy_from_slice(&all[usize::from(!self.many)..][..rank]);
                    let value = array.number(&index[..rank]).unwrap_or(f64::NAN);
                    if value.is_nan() || value.abs() > f64::from(MAX_MAGNITUDE) {
                        return Err(format!(
                            "frame {frame}, joint {joint} is {value}; it must be a finite number from -{MAX_MAGNITUDE} \
                             to {MAX_MAGNITUDE}"
                        ));
                    }
                    *coordinate = single(value);
                }
            }
            poses.push(self.sources.pose(|joint| points[joint]));
        }
        let is_empty = |pose: &Pose| pose.iter().all(|point| point.length_squared() <= 0.0);
        poses.truncate(poses.iter().rposition(|pose| !is_empty(pose)).map_or(0, |last| last + 1));
        Ok(poses)
    }
}

#[allow(clippy::cast_possible_truncation, reason = "rounding to f32 is the purpose")]
fn single(value: f64) -> f32 {
    value as f32
}
