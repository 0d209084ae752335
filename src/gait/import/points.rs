//! What C3D and TRC share: points with names, seen or lost frame by frame, become takes of 16 joints.
//!
//! Points named as joints go through the joint map; the usual markers of gait analysis become joints by [`Markers`]. Every
//! subject whose points have a prefix (`Anna:LASI`) is a take of its own.

use super::joint_map::{self, Sources};
use super::markers::{self, Markers};
use super::repair::{Unit, finish};
use super::{Options, gaps, of_file, stem, text};
use crate::gait::{Error, JointSet, Pose, Provenance, Recording};
use glam::Vec3;

/// Most points of a frame.
pub(super) const MAX_POINTS: usize = 8192;
/// Most subjects of a file.
const MAX_SUBJECTS: usize = 64;

/// Where points were seen.
pub(super) trait Sightings {
    /// Number of frames.
    fn frames(&self) -> usize;

    /// Position of a point in a frame, file units; `None` where it was not seen.
    fn point(&self, frame: usize, point: usize) -> Option<Vec3>;
}

/// How points become joints.
pub(super) enum Way {
    Joints(Sources),
    Markers(Markers),
}

impl Way {
    /// Every point that is used, rising.
    pub(super) fn used(&self) -> Vec<usize> {
        let mut used: Vec<usize> = match self {
            Self::Joints(sources) => sources.used().collect(),
            Self::Markers(markers) => markers.used(),
        };
        used.sort_unstable();
        used.dedup();
        used
    }

    /// The joints for which there are no points.
    fn missing(&self) -> JointSet {
        match self {
            Self::Joints(sources) => sources.missing(),
            Self::Markers(markers) => markers.missing(),
        }
    }

    pub(super) fn pose(&self, at: impl Fn(usize) -> Vec3) -> Pose {
        match self {
            Self::Joints(sources) => sources.pose(at),
            Self::Markers(markers) => markers.pose(at),
        }
    }
}

/// A file of points, but for where they are.
pub(super) struct Capture<'a> {
    /// Names the file in messages.
    pub(super) path: &'a str,
    /// Name of the format.
    pub(super) format: &'a str,
    /// Names of the points.
    pub(super) labels: Vec<String>,
    /// Frames per second, Hz.
    pub(super) rate: f32,
    pub(super) unit: Unit,
    /// First lines of the report.
    pub(super) report: Vec<String>,
}

impl Capture<'_> {
    /// A take for each subject.
    pub(super) fn takes(
        &self,
        sightings: &impl Sightings,
        options: &Options,
    ) -> Result<Vec<Recording>, Error> {
        let wrong = |message: String| text::syntax(self.path, 0, message);
        let subjects = subjects(&self.labels);
        let is_only = subjects.len() == 1;
        let (mut takes, mut first_error) = (Vec::new(), None);
        for (prefix, points) in subjects {
            let (rig, way) = match way(&self.labels, &points, options) {
                Ok(found) => found,
                Err(message) => {
                    first_error.get_or_insert(message);
                    continue;
                }
            };
            let stem = stem(self.path);
            let name = if is_only { stem } else { format!("{stem}-{prefix}") };
            let (poses, gap_line) =
                gaps::poses(sightings, &way, self.rate).map_err(|m| wrong(format!("{name}: {m}")))?;
            let mut report = self.report.clone();
            report.extend([format!("joint map: {rig}"), gap_line]);
            let take = Recording {
                provenance: Provenance {
                    take: name.clone(),
                    subject: Some(prefix).filter(|prefix| !prefix.is_empty()).map(str::to_owned),
                    ..of_file(self.path, self.format)
                },
                report,
                missing: way.missing(),
                ..Recording::new(name, self.rate, poses)
            };
            takes.push(finish(take, self.unit, options)?);
        }
        match (takes.is_empty(), first_error) {
            (true, Some(message)) => Err(wrong(message)),
            (true, None) => Err(wrong("no points with names".to_owned())),
            _ => Ok(takes),
        }
    }
}

/// The part of a label before a colon, and the points that carry it, in the order of their first point.
fn subjects(labels: &[String]) -> Vec<(&str, Vec<usize>)> {
    let mut found: Vec<(&str, Vec<usize>)> = Vec::new();
    for (index, label) in labels.iter().enumerate() {
        let prefix = label.rsplit_once(':').map_or("", |(prefix, _)| prefix);
        match found.iter().position(|(other, _)| *other == prefix) {
            Some(known) => found[known].1.push(index),
            None if found.len() < MAX_SUBJECTS => found.push((prefix, vec![index])),
            None => {}
        }
    }
    found
}

/// How the points of one subject become joints: by the given map, by their names, or as markers; whatever gives all joints
/// first.
fn way(labels: &[String], points: &[usize], options: &Options) -> Result<(String, Way), String> {
    let names: Vec<&str> = points.iter().map(|&point| labels[point].as_str()).collect();
    let by_name = joint_map::choose(options.joint_map.as_ref(), &names);
    let is_whole = by_name.as_ref().is_ok_and(|(_, sources)| sources.missing().is_empty());
    if options.joint_map.is_none()
        && !is_whole
        && let Some(markers) = Markers::find(&names)
    {
        let used = markers.count();
        return Ok((
            format!("{used} markers of gait analysis, joints between them"),
            Way::Markers(markers.of(points)),
        ));
    }
    let (rig, sources) = by_name
        .map_err(|message| format!("{message} (or the markers of gait analysis: {})", markers::NEEDED))?;
    Ok((rig, Way::Joints(sources.of_points(points))))
}

/// A unit of length by the name that the file states, and words for it.
pub(super) fn unit(stated: &str) -> (Unit, String) {
    let stated = stated.trim();
    let metres = match stated.to_ascii_lowercase().as_str() {
        "mm" | "millimeters" | "millimetres" => Some(0.001),
        "cm" | "centimeters" | "centimetres" => Some(0.01),
        "dm" => Some(0.1),
        "m" | "meters" | "metres" => Some(1.0),
        "in" | "inch" | "inches" => Some(0.0254),
        "ft" => Some(0.3048),
        _ => None,
    };
    match metres {
        Some(metres) => (Unit::Stated(metres), stated.to_owned()),
        None => (Unit::Unstated, "no unit".to_owned()),
    }
}
