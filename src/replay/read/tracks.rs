//! Rows to people: sorted, without duplicates, cut at absences, in metres on our ground.

use super::columns::Columns;
use super::infer::{self, Measures};
use super::{
    Error, Format, Found, MAX_COORDINATE, MAX_MEDIAN_SPEED, MAX_PEOPLE, MAX_SECONDS, Options, Row, syntax,
    unusable,
};
use glam::{DVec2, Vec2};
use serde::Serialize;
use std::path::Path;

/// A gap between two samples that is longer than this is an absence, s.
const LONGEST_GAP: f64 = 2.0;
/// Corners of the walkable area are farther apart than this, m.
const CORNERS: f32 = 1.5e-3;
/// Two rows of one person and one frame that are nearer than this say the same, m.
const SAME: f64 = 0.01;

/// A person at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Since the first frame of the recording, s.
    pub time: f64,
    /// Ground (x, z), m.
    pub position: Vec2,
    /// Heading of body or head about +y as the file has it, rad.
    pub heading: Option<f32>,
}

/// One person from entering to leaving. A later return is another track of the same person.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// The person's number in the file.
    pub person: i64,
    /// In order of time, at least one, at strictly increasing times.
    pub samples: Vec<Sample>,
}

/// A recorded crowd.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectories {
    /// Ordered by person, then time.
    pub tracks: Vec<Track>,
    /// Frames per second of the file.
    pub frame_rate: f64,
    /// Outer outline of the walkable area and its holes (x, z), m, if the file has one.
    pub area: Option<Vec<Vec<Vec2>>>,
    /// What was read and inferred.
    pub report: Report,
}

/// What was read and inferred.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The format.
    pub format: Format,
    /// People.
    pub people: usize,
    /// Positions.
    pub samples: usize,
    /// From the first to the last frame, s.
    pub seconds: f64,
    /// What stands in which column of a text; `None`: not a text of columns.
    pub columns: Option<Columns>,
    /// Where that is from: `file` (names), `format`, `inferred` (tracks are smooth in this order), `asked for`.
    pub columns_from: Option<&'static str>,
    /// Frames per second.
    pub frame_rate: f64,
    /// Where the frame rate is from: `file`, `times`, `velocities` (columns of them beside the places), `steps` (samples
    /// are 0.4 s apart, as data sets for the prediction of ways have them), `format`, `asked for`.
    pub frame_rate_from: &'static str,
    /// Metres per unit of the file.
    pub metres_per_unit: f64,
    /// Where that is from: `file`, `heights` (of people), `speeds`, `velocities`, `format`, `usual`, `asked for`.
    pub metres_per_unit_from: &'static str,
    /// Rows that repeat a person and frame.
    pub duplicates: usize,
    /// Of those, rows that say another place; the first one is taken.
    pub contradictions: usize,
    /// Whether rows were not in order.
    pub unsorted: bool,
    /// Absences: gaps after which the same person came back.
    pub absences: usize,
    /// Frames missing within tracks, filled in along the path.
    pub gaps: usize,
    /// The longest time within a track without a sample, s.
    pub longest_gap: f64,
    /// Greatest speed between two samples, m/s.
    pub fastest: f64,
    /// Median speed between two samples, m/s; `None` where no person has two samples.
    pub median_speed: Option<f64>,
    /// What else was inferred.
    pub notes: Vec<String>,
}

impl Trajectories {
    /// From the first to the last sample of all, s.
    pub fn seconds(&self) -> f64 {
        self.report.seconds
    }
}

/// Turns rows into tracks.
pub(super) fn gather(path: &Path, mut found: Found, options: &Options) -> Result<Trajectories, Error> {
    if found.rows.is_empty() {
        return Err(unusable(path, "it holds no positions", "a recording has at least one"));
    }
    let unsorted = !found.is_curve && !infer::is_in_order(&mut found.rows);
    infer::sort(&mut found.rows);
    let measures = infer::measures(path, &mut found, options)?;
    let seconds = seconds(path, &found.rows, measures)?;
    let (columns, columns_from) = found.columns.take().unzip();
    let mut report = Report {
        format: found.format,
        people: 0,
        samples: 0,
        seconds,
        columns,
        columns_from,
        frame_rate: measures.rate,
        frame_rate_from: measures.rate_from,
        metres_per_unit: measures.metres,
        metres_per_unit_from: measures.metres_from,
        duplicates: 0,
        contradictions: 0,
        unsorted,
        absences: 0,
        gaps: 0,
        longest_gap: 0.0,
        fastest: 0.0,
        median_speed: None,
        notes: std::mem::take(&mut found.notes),
    };
    let tracks = cut(&found, measures, options, &mut report);
    if tracks.len() > MAX_PEOPLE {
        let message = format!("{} tracks of people; at most {MAX_PEOPLE} are read", tracks.len());
        return Err(unusable(path, message, "cut the recording into parts"));
    }
    check_speed(path, &report, options)?;
    let sign = sign(options);
    let area = found.area.map(|rings| {
        let ring =
            |ring: Vec<DVec2>| -> Vec<Vec2> { ring.into_iter().map(|corner| ground(corner, sign)).collect() };
        let rings: Vec<Vec<Vec2>> = rings.into_iter().map(|one| thinned(ring(one))).collect();
        rings.into_iter().filter(|ring| ring.len() > 2).collect()
    });
    Ok(Trajectories { tracks, frame_rate: measures.rate, area, report })
}

/// How long the recording lasts, s; refuses what no recording can be.
fn seconds(path: &Path, rows: &[Row], measures: Measures) -> Result<f64, Error> {
    let Measures { rate, metres, .. } = measures;
    let mut far = rows.iter().filter(|row| !(row.place * metres).abs().max_element().le(&MAX_COORDINATE));
    if let Some(row) = far.next() {
        let place = row.place * metres;
        let message =
            format!("person {} is at {place} m, more than {MAX_COORDINATE} m from the origin", row.id);
        return Err(syntax(path, row.line, message));
    }
    let frames = || rows.iter().map(|row| row.frame);
    let (first, last) = (frames().fold(f64::INFINITY, f64::min), frames().fold(f64::NEG_INFINITY, f64::max));
    let seconds = (last - first) / rate;
    if seconds > MAX_SECONDS {
        let message =
            format!("frames {first} to {last} at {rate} a second last {seconds:.0} s; at most a day is read");
        let hint = "check the column of frames (--columns), or give the right --fps";
        return Err(unusable(path, message, hint));
    }
    Ok(seconds)
}

/// Cuts sorted rows into tracks, and counts what is odd.
fn cut(found: &Found, measures: Measures, options: &Options, report: &mut Report) -> Vec<Track> {
    let Measures { rate, metres, .. } = measures;
    let longest_gap = if found.is_curve { f64::INFINITY } else { options.longest_gap.unwrap_or(LONGEST_GAP) };
    let usual = infer::usual_interval(&found.rows);
    let first = found.rows.iter().map(|row| row.frame).fold(f64::INFINITY, f64::min);
    let mut tracks: Vec<Track> = Vec::new();
    let mut speeds = Vec::new();
    let mut before: Option<Row> = None;
    for &row in &found.rows {
        let same = before.filter(|last| last.id == row.id);
        if same.is_none() {
            report.people += 1;
        }
        if let Some(last) = same.filter(|last| last.frame >= row.frame) {
            report.duplicates += 1;
            report.contradictions += usize::from((last.place - row.place).length() * metres > SAME);
            continue;
        }
        let away = same.map(|last| (row.frame - last.frame) / rate);
        let sample = Sample {
            time: (row.frame - first) / rate,
            position: ground(row.place * metres, sign(options)),
            heading: row.facing.map(|angle| heading(angle, sign(options))),
        };
        match (away.filter(|away| *away <= longest_gap), tracks.last_mut(), same) {
            (Some(away), Some(track), Some(last)) => {
                report.gaps += usize::from(!found.is_curve && row.frame - last.frame > usual);
                report.longest_gap = report.longest_gap.max(away);
                speeds.push((row.place - last.place).length() * metres / away);
                track.samples.push(sample);
            }
            _ => {
                report.absences += usize::from(same.is_some());
                tracks.push(Track { person: row.id, samples: vec![sample] });
            }
        }
        report.samples += 1;
        before = Some(row);
    }
    report.fastest = speeds.iter().copied().fold(0.0, f64::max);
    report.median_speed = infer::median(speeds);
    tracks
}

/// Refuses a recording whose people are faster than people walk: its columns, rate or unit were misread.
fn check_speed(path: &Path, report: &Report, options: &Options) -> Result<(), Error> {
    let Some(speed) = report.median_speed.filter(|speed| *speed > MAX_MEDIAN_SPEED && !options.accept_speed)
    else {
        return Ok(());
    };
    let columns =
        report.columns.as_ref().map_or_else(String::new, |columns| format!("the columns {columns}, "));
    let message = format!(
        "half of the steps are faster than {speed:.1} m/s, and people walk at less than {MAX_MEDIAN_SPEED}; taken were \
         {columns}{} frames a second, {}",
        report.frame_rate,
        infer::name_of_unit(report.metres_per_unit)
    );
    let hint =
        "say what is otherwise with --columns, --fps or --unit, or take it as it is with --accept-speed";
    Err(unusable(path, message, hint))
}

const fn sign(options: &Options) -> f64 {
    if options.mirror { 1.0 } else { -1.0 }
}

/// A ring without corners that are nearer to the one before than any wall is thick.
fn thinned(ring: Vec<Vec2>) -> Vec<Vec2> {
    let mut kept: Vec<Vec2> = Vec::with_capacity(ring.len());
    for corner in ring {
        if kept.last().is_none_or(|last| last.distance(corner) > CORNERS) {
            kept.push(corner);
        }
    }
    while kept.len() > 1 && kept[0].distance(kept[kept.len() - 1]) <= CORNERS {
        kept.pop();
    }
    kept
}

/// Their plane (y up the page, or down it with `sign` 1) as our ground (x, z).
fn ground(place: DVec2, sign: f64) -> Vec2 {
    #[allow(clippy::cast_possible_truncation, reason = "within 50 km of the origin")]
    Vec2::new(place.x as f32, (sign * place.y) as f32)
}

/// The heading about +y of an angle from their x axis.
fn heading(angle: f64, sign: f64) -> f32 {
    let ahead = ground(DVec2::from_angle(angle), sign);
    crate::ground::heading_from_ground(ahead)
}
