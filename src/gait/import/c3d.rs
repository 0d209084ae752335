//! C3D: trajectories of markers or joints, as motion capture and gait laboratories store them.
//!
//! The reader takes Intel, DEC and MIPS files, integers and floats, any number of points, with their units and gaps. Points
//! named as joints go through the joint map. The usual markers of gait analysis (Plug-in Gait and its kin) become joints by
//! the regressions of Bell (1990) and a few widths of ours; markers of the legs alone will do. Every subject whose points
//! have a prefix (`Anna:LASI`) is a take of its own.
//!
//! Layout (www.c3d.org): a header of 512 bytes, parameters in named groups, then frames of points and analogue
//! samples. What the parameters say holds over what the header says. Our own reader, because the crates there are
//! panic on broken files.

mod parameters;

use super::points::{Capture, MAX_POINTS, Sightings, unit};
use super::repair::rate_stated;
use super::text::{MAX_MAGNITUDE, syntax};
use super::{MAX_FRAMES, Options};
use crate::gait::{Error, Recording};
use glam::Vec3;
use parameters::{Number, Parameters};

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

impl Sightings for Frames<'_> {
    fn frames(&self) -> usize {
        self.count
    }

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
    let (unit, unit_name) = unit(&parameters.texts("POINT", "UNITS").into_iter().next().unwrap_or_default());
    let report =
        vec![format!("C3D: {} points, {} frames, {unit_name}", labels.len(), frames.count), rate_line];
    Capture { path, format: "C3D", labels, rate, unit, report }.takes(&frames, options)
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
