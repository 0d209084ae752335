//! CSV of joint positions: one row per frame, three columns per joint; several takes per file.
//!
//! The header names the columns: `NAME_x`, `NAME.y`, `NAME Z` ... for the joints (any rig the joint map knows),
//! optionally `key` (rows with the same key are one take), `frame` (ignored) and `time` in seconds. Separators
//! are comma, semicolon, tab or blanks; cells may be quoted. Lines that begin with `#` are comments.
//! Files in E-Gait's layout, and files of 48 bare numbers a row (E-Gait's own), are repaired by [`egait`].

use super::joint_map::{self, Sources};
use super::repair::{Unit, finish, rate_or};
use super::text::{frame_rate, list, number, shown, syntax};
use super::{MAX_FRAMES, Options, egait, of_data_set, of_file, stem};
use crate::gait::{Error, JOINT_COUNT, Joint, Pose, Recording};
use crate::table::{Record, Records, Separator};
use glam::Vec3;
use std::borrow::Cow;
use std::collections::HashSet;

/// Frame rate of a CSV that does not say: E-Gait's.
const DEFAULT_RATE: f32 = 30.0;
/// Name of the format.
const FORMAT: &str = "CSV";
/// Most columns read.
const MAX_COLUMNS: usize = 4096;

/// Where the values stand in a row.
struct Columns {
    count: usize,
    key: Option<usize>,
    time: Option<usize>,
    /// Columns of x, y, z of each joint of the file.
    triples: Vec<[usize; 3]>,
    /// The 16 joints among them.
    joints: Sources,
    /// Name of each joint of the file, for messages.
    names: Vec<String>,
    rig: String,
    egait: bool,
}

/// One take while it is read.
struct Rows {
    name: String,
    line: usize,
    poses: Vec<Pose>,
    /// The line and the time of each row.
    times: Vec<(usize, f32)>,
}

/// The rows of a file without its comments.
struct File<'a> {
    path: &'a str,
    records: Records<'a>,
}

impl<'a> File<'a> {
    fn new(text: &'a str, path: &'a str) -> Self {
        let mut file = Self { path, records: Records::new(text) };
        file.pass_comments();
        file.records.part_by(Separator::of(file.records.first_line()).unwrap_or(Separator::Space));
        file.records.keep(MAX_COLUMNS + 1);
        file
    }

    fn pass_comments(&mut self) {
        while self.records.rest().starts_with('#') {
            self.records.pass_line();
        }
    }

    /// Reads the next row; false at the end.
    fn read(&mut self, row: &mut Record<'a>) -> Result<bool, Error> {
        self.pass_comments();
        self.records.read(row).map_err(|unclosed| syntax(self.path, unclosed.line, unclosed.to_string()))
    }
}

/// Parses a CSV of joint positions into its takes. `path` names it in messages.
///
/// # Errors
/// [`Error::Syntax`] with the line of the first fault; [`Error::Unusable`] if a motion is not that of a body.
pub fn parse_csv(text: &str, path: &str, options: &Options) -> Result<Vec<Recording>, Error> {
    let (mut file, mut row) = (File::new(text, path), Record::default());
    let start = file.records.place();
    if !file.read(&mut row)? {
        return Err(syntax(path, 0, "the file is empty; a header and rows of joint positions were expected"));
    }
    let header_line = row.line;
    let columns = if row.cells.iter().all(|cell| cell.parse::<f32>().is_ok()) {
        file.records.return_to(start);
        bare_columns(path, &row)?
    } else {
        columns(path, &row, options)?
    };

    let mut takes: Vec<Rows> = Vec::new();
    let mut keys: HashSet<Cow<'_, str>> = HashSet::new();
    let mut current_key = None;
    let mut points = vec![Vec3::ZERO; columns.triples.len()];
    let mut frames = 0;
    while file.read(&mut row)? {
        let line = row.line;
        if row.cells.len() != columns.count {
            let message = format!("{} cells; the header has {}", count_of(&row), columns.count);
            return Err(syntax(path, line, message));
        }
        frames += 1;
        if frames > MAX_FRAMES {
            return Err(syntax(path, line, format!("more than {MAX_FRAMES} frames")));
        }
        let key = columns.key.and_then(|column| row.get(column));
        if takes.is_empty() || key != current_key.as_deref() {
            current_key = columns.key.map(|column| row.cells[column].clone());
            if let Some(key) = &current_key
                && !keys.insert(key.clone())
            {
                let message =
                    format!("take {} again after another; its rows must stand together", shown(key));
                return Err(syntax(path, line, message));
            }
            let name = current_key.as_deref().map_or_else(|| stem(path), str::to_owned);
            takes.push(Rows { name, line, poses: Vec::new(), times: Vec::new() });
        }
        if let Some(take) = takes.last_mut() {
            take.poses.push(pose(path, &row, &columns, &mut points)?);
            if let Some(column) = columns.time {
                take.times.push((line, number(path, line, &row.cells[column], "time")?));
            }
        }
    }
    if takes.is_empty() {
        return Err(syntax(path, header_line, "no rows after the header"));
    }
    takes.into_iter().map(|take| recording(take, path, &columns, options)).collect()
}

/// The number of cells of a row, for messages.
fn count_of(row: &Record<'_>) -> String {
    match row.cells.len() {
        ..=MAX_COLUMNS => row.cells.len().to_string(),
        _ => format!("more than {MAX_COLUMNS}"),
    }
}

/// The 16 joints of one row; `points` is room for the joints of the file.
fn pose(path: &str, row: &Record<'_>, columns: &Columns, points: &mut [Vec3]) -> Result<Pose, Error> {
    for joint in columns.joints.used() {
        for (axis, &column) in columns.triples[joint].iter().enumerate() {
            points[joint][axis] = number(path, row.line, &row.cells[column], &columns.names[joint])?;
        }
    }
    Ok(columns.joints.pose(|joint| points[joint]))
}

fn recording(rows: Rows, path: &str, columns: &Columns, options: &Options) -> Result<Recording, Error> {
    let (rate, rate_line) = match (rows.times.first(), rows.times.last()) {
        (Some((_, first)), Some((_, last))) if rows.times.len() > 1 && options.frame_rate.is_none() => {
            if let Some([before, now]) = rows.times.array_windows().find(|[before, now]| now.1 <= before.1) {
                return Err(syntax(path, now.0, format!("time does not increase after {} s", before.1)));
            }
            let rate = (rows.times.len() - 1) as f32 / (last - first);
            (frame_rate(path, rows.line, rate)?, format!("frame rate: {rate:.2} Hz, from the times"))
        }
        _ => rate_or(options, path, DEFAULT_RATE)?,
    };
    let report =
        vec![format!("CSV: {} frames", rows.poses.len()), rate_line, format!("joint map: {}", columns.rig)];
    let provenance = match columns.key {
        Some(_) => of_data_set(path, FORMAT, &rows.name),
        None => of_file(path, FORMAT),
    };
    let missing = columns.joints.missing();
    let take = Recording { provenance, report, missing, ..Recording::new(rows.name, rate, rows.poses) };
    if columns.egait { egait::repair(take, options) } else { finish(take, Unit::Unstated, options) }
}

/// The columns of a file without header: E-Gait's 48 numbers, right arm and leg before the left ones.
fn bare_columns(path: &str, row: &Record<'_>) -> Result<Columns, Error> {
    let count = row.cells.len();
    if count != 3 * JOINT_COUNT {
        let message = format!(
            "{} numbers and no header; without one, E-Gait's 48 numbers a row are expected",
            count_of(row)
        );
        return Err(syntax(path, row.line, message));
    }
    // the data's README names the left side first, the authors' code the right; the data have both. Whichever
    // is taken here, the bend of the knees decides.
    let joints = Sources::single(Joint::ALL.map(|joint| joint.mirrored() as usize));
    let triples = (0..JOINT_COUNT).map(|joint| [3 * joint, 3 * joint + 1, 3 * joint + 2]).collect();
    let names = Joint::ALL.map(|joint| joint.mirrored().name().to_owned()).to_vec();
    let rig = "E-Gait's order, right side first".to_owned();
    Ok(Columns { count, key: None, time: None, triples, joints, names, rig, egait: true })
}

fn columns(path: &str, row: &Record<'_>, options: &Options) -> Result<Columns, Error> {
    let (line, header) = (row.line, &row.cells);
    if header.len() > MAX_COLUMNS {
        return Err(syntax(path, line, format!("{} columns; up to {MAX_COLUMNS} are read", count_of(row))));
    }
    let single = |names: &[&str]| {
        header.iter().position(|cell| names.iter().any(|name| cell.eq_ignore_ascii_case(name)))
    };
    let mut names: Vec<&str> = Vec::new();
    let mut triples: Vec<[Option<usize>; 3]> = Vec::new();
    for (column, cell) in header.iter().enumerate() {
        let Some((name, axis)) = joint_and_axis(cell) else { continue };
        let index = names.iter().position(|&other| other == name).unwrap_or_else(|| {
            names.push(name);
            triples.push([None; 3]);
            names.len() - 1
        });
        if triples[index][axis].replace(column).is_some() {
            return Err(syntax(path, line, format!("column {} twice", shown(cell))));
        }
    }
    // A joint needs all three of its columns.
    let whole: Vec<(&str, [usize; 3])> = names
        .into_iter()
        .zip(triples)
        .filter_map(|(name, triple)| match triple {
            [Some(x), Some(y), Some(z)] => Some((name, [x, y, z])),
            _ => None,
        })
        .collect();
    let names: Vec<&str> = whole.iter().map(|(name, _)| *name).collect();
    if names.is_empty() {
        let message = format!(
            "no columns of joint positions such as head_x, head_y, head_z; the header has: {}",
            list(header)
        );
        return Err(syntax(path, line, message));
    }
    let (rig, joints) = joint_map::choose(options.joint_map.as_ref(), &names)
        .map_err(|message| syntax(path, line, message))?;
    let key = single(&["key", "take", "gait"]);
    Ok(Columns {
        count: header.len(),
        key,
        time: single(&["time", "t", "seconds", "timestamp"]),
        triples: whole.iter().map(|(_, triple)| *triple).collect(),
        names: names.into_iter().map(str::to_owned).collect(),
        joints,
        egait: key.is_some() && rig == "E-Gait",
        rig,
    })
}

/// `LeftFoot_x`, `LeftFoot.X`, `LeftFoot X` and `LeftFootX` to (`LeftFoot`, 0).
fn joint_and_axis(cell: &str) -> Option<(&str, usize)> {
    let last = cell.chars().next_back()?;
    let axis = "xyz".find(last.to_ascii_lowercase())?;
    let name = cell.strip_suffix(last)?;
    let stripped = name.trim_end_matches(['_', '.', ' ', '-', ':']);
    // Without a separator only a capital counts, so that a column "index" is no joint "inde".
    let separated = stripped.len() < name.len() || last.is_ascii_uppercase();
    (separated && !stripped.is_empty()).then_some((stripped, axis))
}
