//! TRC: trajectories of markers as text, as `OpenSim`, Cortex and pose estimators write them.
//!
//! ```text
//! PathFileType  4  (X/Y/Z)  walk.trc
//! DataRate  CameraRate  NumFrames  NumMarkers  Units  OrigDataRate  OrigDataStartFrame  OrigNumFrames
//! 100.00  100.00  250  39  mm  100.00  1  250
//! Frame#  Time  LASI      RASI      ...
//!               X1  Y1  Z1  X2  Y2  Z2  ...
//! 1  0.000  61.2  941.0  -122.4  ...
//! ```
//!
//! Cells stand between tabs (or, in files without any, between blanks). An empty cell, NaN, or zeros say that a marker was
//! not seen. Names become joints as in [`super::c3d`].

use super::points::{Capture, MAX_POINTS, Sightings, unit};
use super::repair::rate_stated;
use super::text::{list, number, shown, syntax};
use super::{MAX_FRAMES, Options};
use crate::gait::{Error, Recording};
use glam::Vec3;

/// Times that tell another rate than the header by more than this share are believed.
const RATE_TOLERANCE: f32 = 0.02;
/// Lines in which the header must be.
const HEADER_LINES: usize = 16;

/// Markers of each frame in the order of their names; frames may end early.
struct Tracks {
    rows: Vec<Vec<Option<Vec3>>>,
    times: Vec<f32>,
}

impl Sightings for Tracks {
    fn frames(&self) -> usize {
        self.rows.len()
    }

    fn point(&self, frame: usize, point: usize) -> Option<Vec3> {
        self.rows.get(frame)?.get(point).copied().flatten()
    }
}

/// What the lines above the data say.
struct Header {
    /// Line of the names, from 1.
    line: usize,
    names: Vec<String>,
    rate: Option<f32>,
    units: String,
    frames: Option<usize>,
    has_tabs: bool,
}

/// Parses a TRC file into a take for each subject. `path` names it in messages.
///
/// # Errors
/// [`Error::Syntax`] with the line of the first fault; [`Error::Unusable`] if a motion is not that of a body.
pub fn parse_trc(text: &str, path: &str, options: &Options) -> Result<Vec<Recording>, Error> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let header = header(text, path)?;
    let tracks = tracks(text, path, &header)?;
    let (unit, unit_name) = unit(&header.units);
    let frames = tracks.rows.len();
    let mut report = vec![format!("TRC: {} markers, {frames} frames, {unit_name}", header.names.len())];
    let (rate, rate_lines) = rate(path, &header, &tracks.times, options)?;
    report.extend(rate_lines);
    if let Some(stated) = header.frames.filter(|&stated| stated != frames) {
        report.push(format!("warning: the header states {stated} frames, but the file has {frames}"));
    }
    Capture { path, format: "TRC", labels: header.names, rate, unit, report }.takes(&tracks, options)
}

fn cells(line: &str, has_tabs: bool) -> Vec<&str> {
    if has_tabs {
        line.trim_end().split('\t').map(str::trim).collect()
    } else {
        line.split_whitespace().collect()
    }
}

fn header(text: &str, path: &str) -> Result<Header, Error> {
    let lines: Vec<&str> = text.lines().take(HEADER_LINES).collect();
    let begins = |line: &str, word: &str| {
        line.trim_start().get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word))
    };
    if !lines.first().is_some_and(|line| begins(line, "PathFileType")) {
        let found = shown(lines.first().copied().unwrap_or_default());
        return Err(syntax(path, 1, format!("begins with {found}; a TRC file begins with PathFileType")));
    }
    let Some(at) = lines.iter().position(|line| begins(line, "Frame#")) else {
        let message =
            format!("none of the first {HEADER_LINES} lines names the markers after Frame# and Time");
        return Err(syntax(path, lines.len(), message));
    };
    let has_tabs = lines[at].contains('\t');
    let words = |line: &str| -> Vec<String> { line.split_whitespace().map(str::to_owned).collect() };
    let keys = lines.iter().position(|line| begins(line, "DataRate")).filter(|keys| keys + 1 < at);
    let (keys, values) = keys.map(|keys| (words(lines[keys]), words(lines[keys + 1]))).unwrap_or_default();
    let value = |key: &str| {
        let at = keys.iter().position(|other| other.eq_ignore_ascii_case(key))?;
        values.get(at).map(String::as_str)
    };
    let names: Vec<String> = cells(lines[at], has_tabs)
        .into_iter()
        .skip(2)
        .filter(|name| !name.is_empty())
        .map(str::to_owned)
        .collect();
    if names.is_empty() || names.len() > MAX_POINTS {
        let message = format!("{} names of markers; from 1 to {MAX_POINTS} are read", names.len());
        return Err(syntax(path, at + 1, message));
    }
    if let Some(stated) = value("NumMarkers").and_then(|text| text.parse::<usize>().ok())
        && stated > names.len()
    {
        let message = format!(
            "{} names of markers, but the header states {stated}; the file has: {}",
            names.len(),
            list(&names)
        );
        return Err(syntax(path, at + 1, message));
    }
    Ok(Header {
        line: at + 1,
        rate: value("DataRate").and_then(|text| text.parse().ok()).filter(|rate: &f32| *rate > 0.0),
        units: value("Units").unwrap_or_default().to_owned(),
        frames: value("NumFrames").and_then(|text| text.parse().ok()),
        names,
        has_tabs,
    })
}

fn tracks(text: &str, path: &str, header: &Header) -> Result<Tracks, Error> {
    let (mut rows, mut times) = (Vec::new(), Vec::new());
    for (index, line) in text.lines().enumerate().skip(header.line) {
        let is_axes = rows.is_empty() && line.trim_start().starts_with(['X', 'x']);
        if line.trim().is_empty() || is_axes {
            continue;
        }
        let at = index + 1;
        if rows.len() == MAX_FRAMES {
            return Err(syntax(path, at, format!("more than {MAX_FRAMES} frames")));
        }
        let row = cells(line, header.has_tabs);
        let (least, most) = (2, 2 + 3 * header.names.len());
        let least = if header.has_tabs { least } else { most };
        let found = row.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1);
        if !(least..=most).contains(&found) {
            let message = format!("{found} cells; {} markers ask for {most}", header.names.len());
            return Err(syntax(path, at, message));
        }
        number(path, at, row[0], "the number of the frame")?;
        times.push(number(path, at, row[1], "the time")?);
        let points = row[2..found].chunks(3).map(|cells| point(path, at, cells)).collect::<Result<_, _>>()?;
        rows.push(points);
    }
    if rows.is_empty() {
        return Err(syntax(path, header.line, "no frames after the names of the markers"));
    }
    Ok(Tracks { rows, times })
}

/// Three cells as a position; `None` where the marker was not seen.
fn point(path: &str, line: usize, cells: &[&str]) -> Result<Option<Vec3>, Error> {
    let mut position = Vec3::ZERO;
    let is_lost = |cell: &&str| cell.is_empty() || cell.eq_ignore_ascii_case("nan");
    if cells.len() < 3 || cells.iter().any(is_lost) {
        // What is there must still be numbers.
        for cell in cells.iter().filter(|cell| !is_lost(cell)) {
            number(path, line, cell, "a coordinate")?;
        }
        return Ok(None);
    }
    for (axis, cell) in cells.iter().enumerate() {
        position[axis] = number(path, line, cell, "a coordinate")?;
    }
    Ok((position != Vec3::ZERO).then_some(position))
}

/// Frames per second: as given, else by the times, else as the header states.
fn rate(path: &str, header: &Header, times: &[f32], options: &Options) -> Result<(f32, Vec<String>), Error> {
    let rises = times.len() > 1 && times.windows(2).all(|pair| pair[1] > pair[0]);
    let by_times = rises.then(|| (times.len() - 1) as f32 / (times[times.len() - 1] - times[0]));
    let (hertz, warning) = match (header.rate, by_times) {
        (Some(stated), Some(told)) if (told / stated - 1.0).abs() > RATE_TOLERANCE => {
            (told, Some(format!("warning: the header states {stated:.2} Hz, the times tell {told:.2} Hz")))
        }
        (Some(stated), _) => (stated, None),
        (None, Some(told)) => (told, Some("frame rate: from the times".to_owned())),
        (None, None) if options.frame_rate.is_some() => (0.0, None),
        (None, None) => {
            return Err(syntax(
                path,
                header.line,
                "neither the header nor the times tell a frame rate; give one",
            ));
        }
    };
    let (rate, line) = rate_stated(options, path, header.line, hertz)?;
    let warning = warning.filter(|_| options.frame_rate.is_none());
    Ok((rate, std::iter::once(line).chain(warning).collect()))
}
