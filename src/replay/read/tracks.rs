//! Rows to people: sorted, without duplicates, cut where somebody is away, in metres on our ground.

use super::{Error, Format, Found, MAX_COORDINATE, MAX_PEOPLE, MAX_SECONDS, Options, Row, syntax, unusable};
use glam::{DVec2, Vec2};
use serde::Serialize;
use std::path::Path;

/// A person who is not seen for longer than this is absent meanwhile, s.
const LONGEST_GAP: f64 = 2.0;
/// Two rows of one person and one frame that are nearer than this say the same, m.
const SAME: f64 = 0.01;

/// Somebody at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Since the first frame of the recording, s.
    pub time: f64,
    /// Ground (x, z), m.
    pub position: Vec2,
    /// Heading of body or head about +y as the file has it, rad.
    pub heading: Option<f32>,
}

/// One person from entering to leaving; who comes back later is another track of the same person.
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
    /// Frames per second, and who says so.
    pub frame_rate: f64,
    /// Where the frame rate is from: `file`, `format`, `asked for`.
    pub frame_rate_from: &'static str,
    /// Metres per unit of the file.
    pub metres_per_unit: f64,
    /// Rows that repeat a person and frame.
    pub duplicates: usize,
    /// Of those, rows that say another place; the first one is taken.
    pub contradictions: usize,
    /// Whether rows were not in order.
    pub unsorted: bool,
    /// Times somebody was away for a while and came back.
    pub absences: usize,
    /// Frames missing within tracks, filled in along the path.
    pub gaps: usize,
    /// The longest time within a track without a sample, s.
    pub longest_gap: f64,
    /// Fastest anybody moves between two samples, m/s.
    pub fastest: f64,
    /// What else was inferred.
    pub notes: Vec<String>,
}

impl Trajectories {
    /// From the first to the last moment anybody is there, s.
    pub fn seconds(&self) -> f64 {
        self.report.seconds
    }
}

/// Turns rows into tracks.
pub(super) fn gather(
    path: &Path,
    format: Format,
    mut found: Found,
    options: &Options,
) -> Result<Trajectories, Error> {
    let (rate, rate_from) = frame_rate(path, &found, options)?;
    let metres = options.metres_per_unit.or(found.metres_per_unit).unwrap_or(1.0);
    if !(1e-4..=1e4).contains(&metres) {
        let message = format!("{metres} metres per unit; it must be 0.0001 to 10000");
        return Err(unusable(path, message, "1 is metres, 0.01 centimetres"));
    }
    if found.rows.is_empty() {
        return Err(unusable(path, "it holds no positions", "a recording has at least one"));
    }
    let unsorted = !found.rows.is_sorted_by_key(|row| (row.id, row.frame))
        && !found.rows.is_sorted_by_key(|row| (row.frame, row.id));
    found.rows.sort_by_key(|row| (row.id, row.frame)); // stable: the first of duplicates stays first
    let mut far =
        found.rows.iter().filter(|row| !(row.place * metres).abs().max_element().le(&MAX_COORDINATE));
    if let Some(row) = far.next() {
        let place = row.place * metres;
        let message =
            format!("person {} is at {place} m, more than {MAX_COORDINATE} m from the origin", row.id);
        return Err(syntax(path, row.line, message));
    }
    let frames = found.rows.iter().map(|row| row.frame);
    let (first, last) = (frames.clone().min().unwrap_or(0), frames.max().unwrap_or(0));
    let seconds = since(first, last, rate);
    if seconds > MAX_SECONDS {
        let message =
            format!("frames {first} to {last} at {rate} a second last {seconds:.0} s; at most a day is read");
        return Err(unusable(path, message, "check the column of frames, or give the right --fps"));
    }
    let mut report = Report {
        format,
        people: 0,
        samples: 0,
        seconds,
        frame_rate: rate,
        frame_rate_from: rate_from,
        metres_per_unit: metres,
        duplicates: 0,
        contradictions: 0,
        unsorted,
        absences: 0,
        gaps: 0,
        longest_gap: 0.0,
        fastest: 0.0,
        notes: std::mem::take(&mut found.notes),
    };
    let longest_gap = if found.is_curve { f64::INFINITY } else { options.longest_gap.unwrap_or(LONGEST_GAP) };
    let usual = usual_interval(&found.rows);
    let sign = if options.mirror { 1.0 } else { -1.0 };
    let mut tracks: Vec<Track> = Vec::new();
    let mut before: Option<Row> = None;
    for row in found.rows {
        let same = before.filter(|last| last.id == row.id);
        if same.is_none() {
            report.people += 1;
        }
        if let Some(last) = same.filter(|last| last.frame == row.frame) {
            report.duplicates += 1;
            report.contradictions += usize::from((last.place - row.place).length() * metres > SAME);
            continue;
        }
        let away = same.map(|last| since(last.frame, row.frame, rate));
        let sample = Sample {
            time: since(first, row.frame, rate),
            position: ground(row.place * metres, sign),
            heading: row.facing.map(|angle| heading(angle, sign)),
        };
        match (away.filter(|away| *away <= longest_gap), tracks.last_mut(), same) {
            (Some(away), Some(track), Some(last)) => {
                let frames = row.frame - last.frame;
                report.gaps += usize::from(!found.is_curve && frames > usual);
                report.longest_gap = report.longest_gap.max(away);
                report.fastest = report.fastest.max((row.place - last.place).length() * metres / away);
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
    if tracks.len() > MAX_PEOPLE {
        let message = format!("{} tracks of people; at most {MAX_PEOPLE} are read", tracks.len());
        return Err(unusable(path, message, "cut the recording into parts"));
    }
    let area = found.area.map(|rings| {
        let ring = |ring: Vec<DVec2>| ring.into_iter().map(|corner| ground(corner, sign)).collect();
        rings.into_iter().map(ring).collect()
    });
    Ok(Trajectories { tracks, frame_rate: rate, area, report })
}

fn frame_rate(path: &Path, found: &Found, options: &Options) -> Result<(f64, &'static str), Error> {
    let said = [(options.frame_rate, "asked for"), (found.frame_rate, "file"), (found.usual_rate, "format")];
    let Some((rate, from)) = said.into_iter().find_map(|(rate, from)| Some((rate?, from))) else {
        return Err(unusable(
            path,
            "the file does not say how many frames a second it has",
            "give --fps; the recordings of Juelich have 16 or 25",
        ));
    };
    if (0.1..=1000.0).contains(&rate) {
        return Ok((rate, from));
    }
    Err(unusable(path, format!("{rate} frames per second; it must be 0.1 to 1000"), "give --fps"))
}

/// Seconds from one frame to another.
fn since(first: i64, frame: i64, rate: f64) -> f64 {
    #[allow(
        clippy::cast_precision_loss,
        reason = "an absurd difference is refused, a plausible one is exact"
    )]
    let frames = frame.saturating_sub(first) as f64;
    frames / rate
}

/// Frames between two samples of a person: the middle value.
fn usual_interval(rows: &[Row]) -> i64 {
    let pairs = rows.windows(2).filter(|two| two[0].id == two[1].id && two[1].frame > two[0].frame);
    let mut intervals: Vec<i64> = pairs.map(|two| two[1].frame.saturating_sub(two[0].frame)).collect();
    intervals.sort_unstable();
    intervals.get(intervals.len() / 2).copied().unwrap_or(1)
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
