//! C3D: trajectories of markers or joints, as motion capture and gait laboratories store them.
//!
//! Read are Intel, DEC and MIPS files, integers and floats, any number of points, with their units and gaps. Points
//! named as joints go through the joint map; the usual markers of gait analysis (Plug-in Gait and its kin) become
//! joints by the regressions of Bell (1990) and a few widths of ours. Every subject whose points have a prefix (`Anna:LASI`) is a take of its own.
//!
//! Layout (www.c3d.org): a header of 512 bytes, parameters in named groups, then frames of points and analogue
//! samples. What the parameters say holds over what the header says. Our own reader, because the crates there are
//! panic on broken files.

mod gaps;
mod markers;
mod parameters;

use super::joint_map::{self, Sources};
use super::repair::{Unit, finish, rate_stated};
use super::text::{MAX_MAGNITUDE, syntax};
use super::{MAX_FRAMES, Options, file_name, stem};
use crate::gait::{Error, Pose, Recording};
use glam::Vec3;
use markers::Markers;
use parameters::{Number, Parameters};

/// Most points of a frame.
const MAX_POINTS: usize = 8192;
/// Most subjects of a file.
const MAX_SUBJECTS: usize = 64;

/// How the frames stand in the file.
struct Frames<'a> {
    data: &'a [u8],
    number: Number,
    /// Bytes of a frame.
    stride: usize,
    count: usize,
    /// Length of one unit of an integer coordinate; floats are scaled already.
    scale: f32,
    is_float: bool,
}

impl Frames<'_> {
    /// Position of a point in a frame, file units; `None` where it was not seen.
    fn point(&self, frame: usize, point: usize) -> Option<Vec3> {
        let width = if self.is_float { 4 } else { 2 };
        let at = frame * self.stride + point * 4 * width;
        let words = self.data.get(at..at + 4 * width)?;
        let value = |word: usize| {
            let bytes = &words[word * width..];
            if self.is_float {
                self.number.float(bytes)
            } else {
                f32::from(self.number.integer(bytes)) * self.scale
            }
        };
        let position = Vec3::new(value(0), value(1), value(2));
        // A negative fourth word says that no camera saw the point; some programs write zeros instead.
        let seen = value(3) >= 0.0 && position != Vec3::ZERO;
        (seen && position.abs().max_element() <= MAX_MAGNITUDE).then_some(position)
    }
}

/// How points become joints.
enum Way {
    Joints(Sources),
    Markers(Markers),
}

impl Way {
    fn used(&self) -> Vec<usize> {
        let mut used: Vec<usize> = match self {
            Self::Joints(sources) => sources.used().collect(),
            Self::Markers(markers) => markers.used(),
        };
        used.sort_unstable();
        used.dedup();
        used
    }

    fn pose(&self, at: impl Fn(usize) -> Vec3) -> Pose {
        match self {
            Self::Joints(sources) => sources.pose(at),
            Self::Markers(markers) => markers.pose(at),
        }
    }
}

/// Parses a C3D file into a take for each subject. `path` names it in messages.
///
/// # Errors
/// [`Error::Syntax`] if it is no C3D file, is cut off, or lacks joints; [`Error::Unusable`] if a motion is not that of a
/// body.
pub fn parse_c3d(bytes: &[u8], path: &str, options: &Options) -> Result<Vec<Recording>, Error> {
    let wrong = |message: String| syntax(path, 0, message);
    let parameters = Parameters::read(bytes).map_err(wrong)?;
    let header = bytes.get(..512).ok_or_else(|| wrong("the file ends in its header".to_owned()))?;
    let frames = frames(bytes, header, &parameters).map_err(wrong)?;
    let stated = parameters.float("POINT", "RATE").filter(|stated| *stated > 0.0);
    let stated = stated.unwrap_or_else(|| parameters.number().float(&header[20..]));
    let (rate, rate_line) = rate_stated(options, path, 0, stated)?;
    let labels = labels(&parameters, options);
    let (unit, unit_name) = unit(&parameters);
    let subjects = subjects(&labels);
    let is_only = subjects.len() == 1;
    let (mut takes, mut first_error) = (Vec::new(), None);
    for (prefix, points) in subjects {
        match way(&labels, &points, options) {
            Err(message) => {
                first_error.get_or_insert(message);
            }
            Ok((rig, way)) => {
                let name = if is_only { stem(path) } else { format!("{}-{prefix}", stem(path)) };
                let (poses, gap_line) =
                    gaps::poses(&frames, &way, rate).map_err(|m| wrong(format!("{name}: {m}")))?;
                let report = vec![
                    format!("C3D: {} points, {} frames, {unit_name}", labels.len(), frames.count),
                    rate_line.clone(),
                    format!("joint map: {rig}"),
                    gap_line,
                ];
                let source = format!("{} (C3D)", file_name(path));
                let subject = Some(prefix).filter(|prefix| !prefix.is_empty()).map(str::to_owned);
                let take = Recording { source, report, subject, ..Recording::new(name, rate, poses) };
                takes.push(finish(take, unit, options)?);
            }
        }
    }
    match (takes.is_empty(), first_error) {
        (true, Some(message)) => Err(wrong(message)),
        (true, None) => Err(wrong("no points with names".to_owned())),
        _ => Ok(takes),
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

/// How the points of one subject become joints: by the given map, by their names, or as markers.
fn way(labels: &[String], points: &[usize], options: &Options) -> Result<(String, Way), String> {
    let names: Vec<&str> = points.iter().map(|&point| labels[point].as_str()).collect();
    let by_name = joint_map::choose(options.joint_map.as_ref(), &names);
    if options.joint_map.is_none()
        && by_name.is_err()
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

fn unit(parameters: &Parameters<'_>) -> (Unit, String) {
    let stated = parameters.texts("POINT", "UNITS").into_iter().next().unwrap_or_default();
    let metres = match stated.trim().to_ascii_lowercase().as_str() {
        "mm" => Some(0.001),
        "cm" => Some(0.01),
        "dm" => Some(0.1),
        "m" => Some(1.0),
        "in" | "inch" | "inches" => Some(0.0254),
        "ft" => Some(0.3048),
        _ => None,
    };
    match metres {
        Some(metres) => (Unit::Stated(metres), stated.trim().to_owned()),
        None => (Unit::Unstated, "no unit".to_owned()),
    }
}

/// Names of the points; further ones stand in LABELS2 and so on, because an extent has one byte.
fn labels(parameters: &Parameters<'_>, options: &Options) -> Vec<String> {
    let mut labels = parameters.texts("POINT", "LABELS");
    for more in 2..=MAX_POINTS / 255 {
        let next = parameters.texts("POINT", &format!("LABELS{more}"));
        if next.is_empty() {
            break;
        }
        labels.extend(next);
    }
    let used = parameters.integer("POINT", "USED").map_or(labels.len(), usize::from);
    labels.truncate(used.min(MAX_POINTS));
    if labels.is_empty() && options.joint_map.is_some() {
        // Without names, a joint map may use numbers.
        labels.extend((0..used.min(MAX_POINTS)).map(|point| point.to_string()));
    }
    for label in &mut labels {
        label.truncate(label.trim_end().len());
    }
    labels
}

/// Where the frames are and how many.
fn frames<'a>(bytes: &'a [u8], header: &[u8], parameters: &Parameters<'_>) -> Result<Frames<'a>, String> {
    let number = parameters.number();
    let word = |index: usize| usize::from(number.word(&header[2 * (index - 1)..]));
    let points = parameters.integer("POINT", "USED").map_or_else(|| word(2), usize::from);
    if points == 0 || points > MAX_POINTS {
        return Err(format!("{points} points; from 1 to {MAX_POINTS} are read"));
    }
    let scale = parameters.float("POINT", "SCALE").unwrap_or_else(|| number.float(&header[12..]));
    if !(scale.is_finite() && scale != 0.0) {
        return Err(format!("POINT:SCALE is {scale}; negative for floats, positive for integers"));
    }
    let is_float = scale < 0.0;
    let width = if is_float { 4 } else { 2 };
    let start_block = parameters.integer("POINT", "DATA_START").map_or(0, usize::from);
    let start_block = if start_block > 0 { start_block } else { word(9) };
    let start = start_block.saturating_sub(1).saturating_mul(512);
    let data = bytes.get(start..).filter(|_| start >= 512);
    let data =
        data.ok_or_else(|| format!("the data begin at block {start_block}, which is not in the file"))?;
    let stride = width * (4 * points + word(3));
    let there = data.len() / stride;
    // 16 bits in the header; longer takes have their numbers in two words each.
    let (first, last) = (word(4), word(5));
    let long = |name: &str| parameters.long("TRIAL", name);
    let claimed = match (long("ACTUAL_START_FIELD"), long("ACTUAL_END_FIELD")) {
        (Some(first), Some(last)) if last >= first && last > 0 => last - first + 1,
        _ if last >= first && last > 0 && last < 65535 => last - first + 1,
        _ => there,
    };
    if claimed > MAX_FRAMES {
        return Err(format!("{claimed} frames; up to {MAX_FRAMES} are read"));
    }
    if claimed > there {
        return Err(format!("the file ends after {there} of {claimed} frames; is it cut off?"));
    }
    Ok(Frames { data, number, stride, count: claimed, scale: scale.abs(), is_float })
}
