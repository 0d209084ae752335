//! Stimuli under their random names: walks as numbers that the page draws, and clips.
//!
//! A walk's camera, colours and thickness are the constants of [`crate::export::figure`], by which clips are drawn, too.

use super::Error;
use super::clip;
use super::reply::Packed;
use crate::emotion::Emotion;
use crate::export::figure;
use crate::gait::{Gait, JOINT_COUNT, Joint};
use crate::library::GaitLibrary;
use crate::study::plan::Stimulus;
use crate::study::store::{Shown, Version};
use axum::http::HeaderMap;
use axum::response::Response;
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

/// Poses of a walk that is sent.
const POSES: u16 = 64;
/// Name by which a study file means the program's own examples.
const EXAMPLES: &str = "practice";
/// How the examples look, in order. Pages do not tell.
const EXAMPLE_LABELS: [Emotion; 3] = [Emotion::Neutral, Emotion::Happy, Emotion::Sad];
/// Missing clips that a message names.
const MOST_NAMED: usize = 10;

/// All stimuli that browsers may ask for.
#[derive(Debug, Default)]
pub(super) struct Stimuli {
    walks: HashMap<String, Packed>,
    clips: HashMap<String, PathBuf>,
}

impl Stimuli {
    /// The stimuli of all versions. Clips lie in `clips` as `NAME.mp4`.
    ///
    /// # Errors
    /// [`Error::Library`] or [`Error::NoGait`] for a library that is not as it was frozen; [`Error::Clips`] names the clips that
    /// are missing.
    pub(super) fn of(versions: &[impl AsRef<Version>], clips: &Path) -> Result<Self, Error> {
        let mut all = Self::default();
        let mut missing = BTreeMap::new();
        for version in versions.iter().map(AsRef::as_ref) {
            let mut libraries = Libraries { version, read: BTreeMap::new() };
            for (name, shown) in &version.stimuli {
                if let Stimulus::Gait { gait } = &shown.stimulus {
                    let gait = libraries.find(shown, gait)?;
                    all.walks.insert(name.clone(), pack(gait)?);
                    continue;
                }
                let path = clips.join(name).with_extension("mp4");
                if path.is_file() {
                    all.clips.insert(name.clone(), path);
                } else {
                    missing.insert(name.clone(), shown);
                }
            }
        }
        if missing.is_empty() { Ok(all) } else { Err(lacking(clips, &missing)) }
    }

    /// The reply to a request for a stimulus; none for an unknown name.
    pub(super) async fn reply(&self, name: &str, headers: &HeaderMap) -> Option<Response> {
        if let Some(walk) = self.walks.get(name) {
            return Some(walk.reply(super::reply::takes_gzip(headers)));
        }
        clip::reply(self.clips.get(name)?.clone(), headers).await
    }
}

fn lacking(folder: &Path, missing: &BTreeMap<String, &Shown>) -> Error {
    let say = |(name, shown): (&String, &&Shown)| {
        let what = match &shown.stimulus {
            Stimulus::Gait { gait } => gait.clone(),
            Stimulus::Scene { scene, condition } => format!("{scene}, {condition}"),
            Stimulus::Agent { emotion, body, condition } => format!("{emotion}, {body}, {condition}"),
        };
        format!("{name}.mp4 ({}: {what}, seed {})", shown.part, shown.seed)
    };
    let named: Vec<String> = missing.iter().take(MOST_NAMED).map(say).collect();
    Error::Clips { folder: folder.to_owned(), count: missing.len(), first: named.join("; ") }
}

fn frozen(path: &Path) -> Result<HashMap<String, Gait>, Error> {
    let read = GaitLibrary::load_glb(path)?;
    Ok(read.gaits().iter().map(|gait| (gait.name.clone(), gait.clone())).collect())
}

/// The gaits of a version's parts.
struct Libraries<'v> {
    version: &'v Version,
    read: BTreeMap<String, HashMap<String, Gait>>,
}

impl Libraries<'_> {
    fn find(&mut self, shown: &Shown, gait: &str) -> Result<&Gait, Error> {
        let part = &shown.part;
        if !self.read.contains_key(part) {
            let gaits = match self.version.library(part) {
                Some(path) => frozen(&path)?,
                None => self.examples()?,
            };
            self.read.insert(part.clone(), gaits);
        }
        let found = self.read.get(part).and_then(|gaits| gaits.get(gait));
        found.ok_or_else(|| Error::NoGait { part: part.clone(), gait: gait.to_owned() })
    }

    /// The program's examples, in the order of their names in the materials.
    fn examples(&self) -> Result<HashMap<String, Gait>, Error> {
        let library = GaitLibrary::built_in()?;
        let names = self.version.materials.gaits.get(EXAMPLES).into_iter().flatten();
        let gait = |emotion| {
            let id = *library.gaits_for(emotion).first()?;
            library.gaits().get(id as usize).cloned()
        };
        let gaits = names.zip(EXAMPLE_LABELS).filter_map(|(name, label)| Some((name.clone(), gait(label)?)));
        Ok(gaits.collect())
    }
}

/// A walk as a page draws it. Lengths of `poses` are mm, other lengths m, colours 0 to 255.
#[derive(Debug, Serialize)]
struct Walk {
    size: [u32; 2],
    camera: [f32; 3],
    focus: f32,
    centre: [f32; 2],
    nearest: f32,
    paper: [u8; 4],
    stripes: Stripes,
    body: [[f32; 3]; 2],
    depth: f32,
    thick: [f32; 2],
    /// Index of each joint's parent.
    parents: [usize; JOINT_COUNT],
    head: usize,
    /// How long a cycle takes, ms.
    cycle: i32,
    /// mm/s.
    speed: i32,
    poses: Vec<[[i32; 3]; JOINT_COUNT]>,
}

#[derive(Debug, Serialize)]
struct Stripes {
    every: f32,
    range: [i16; 2],
    half: f32,
    thick: f32,
    color: [u8; 4],
}

fn pack(gait: &Gait) -> Result<Packed, Error> {
    let json = serde_json::to_vec(&walk(gait)).map_err(|source| Error::Encode { source })?;
    Packed::new("application/json", json)
}

fn walk(gait: &Gait) -> Walk {
    let cycle = gait.cycle_time();
    let pose = |index: u16| {
        let pose = figure::pose_at(gait, f32::from(index) / f32::from(POSES) * cycle);
        pose.map(|joint| joint.to_array().map(thousandths))
    };
    Walk {
        size: [figure::SIZE.0, figure::SIZE.1],
        camera: figure::CAMERA.to_array(),
        focus: figure::FOCUS,
        centre: figure::CENTRE.to_array(),
        nearest: figure::NEAREST,
        paper: figure::PAPER,
        stripes: Stripes {
            every: figure::STRIPES,
            range: figure::STRIPE_RANGE,
            half: figure::STRIPE_HALF,
            thick: figure::STRIPE_THICK,
            color: figure::GROUND,
        },
        body: figure::BODY,
        depth: figure::BODY_DEPTH,
        thick: figure::THICK,
        parents: Joint::PARENT,
        head: Joint::Head as usize,
        cycle: thousandths(cycle),
        speed: thousandths(gait.speed),
        poses: (0..POSES).map(pose).collect(),
    }
}

#[allow(clippy::cast_possible_truncation, reason = "lengths of a body and times of a stride")]
fn thousandths(value: f32) -> i32 {
    (value * 1000.0).round() as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::walker::{Sex, person};

    #[test]
    fn a_walk_is_small_whole_millimetres_and_names_nothing() {
        let gait = person(Emotion::Angry, Sex::Female, 1, 0).unwrap();
        let packed = pack(&gait).unwrap();
        let json = serde_json::to_string(&walk(&gait)).unwrap();
        assert!(packed.gzipped.len() < 9_000, "{} bytes of {}", packed.gzipped.len(), json.len());
        for word in ["angry", "emotion", "label", "name", "sex", "female", &gait.name] {
            assert!(!json.to_lowercase().contains(&word.to_lowercase()), "{word}");
        }
        let walk = walk(&gait);
        for index in [0, 13, 63] {
            let time = gait.cycle_time() * f32::from(u16::try_from(index).unwrap()) / 64.0;
            let pose = figure::pose_at(&gait, time);
            for (own, joint) in walk.poses[index].iter().zip(pose) {
                for (mm, metres) in own.iter().zip(joint.to_array()) {
                    assert!((f64::from(*mm) / 1000.0 - f64::from(metres)).abs() < 6e-4, "{mm} {metres}");
                }
            }
        }
        assert!((f64::from(walk.cycle) / 1000.0 - f64::from(gait.cycle_time())).abs() < 6e-4);
    }
}
