//! CSV of joint positions: one row per frame, three columns per joint; several takes per file.
//!
//! The header names the columns: `NAME_x`, `NAME.y`, `NAME Z` ... for the joints (any rig the joint map knows),
//! optionally `key` (rows with the same key are one take), `frame` (ignored) and `time` in seconds. Separators
//! are comma, semicolon, tab or blanks. Files in E-Gait's layout, and files of 48 bare numbers a row (E-Gait's
//! own), are repaired by [`egait`].

use super::joint_map::{self, Sources};
use super::repair::{Unit, finish, rate_or};
use super::text::{frame_rate, list, number, shown, syntax};
use super::{MAX_FRAMES, Options, egait, of_data_set, of_file, stem};
use crate::gait::{Error, JOINT_COUNT, Joint, Pose, Recording};
use glam::Vec3;
use std::collections::HashSet;

/// Frame rate of a CSV that does not say: E-Gait's.
const DEFAULT_RATE: f32 = 30.0;
/// Name of the format.
const FORMAT: &str = "CSV";
/// Most columns read.
const MAX_COLUMNS: usize = 4096;

/// Where the values stand in a row.
struct Columns {
    separator: char,
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
    times: Vec<f32>,
}

/// The cells of a row without blanks and quotation marks around them.
pub(super) fn cells(line: &str, separator: char) -> Vec<&str> {
    if separator == ' ' {
        line.split_whitespace().collect()
    } else {
        line.split(separator).map(|cell| cell.trim().trim_matches('"').trim()).collect()
    }
}

/// Parses a CSV of joint positions into its takes. `path` names it in messages.
///
/// # Errors
/// [`Error::Syntax`] with the line of the first fault; [`Error::Unusable`] if a motion is not that of a body.
pub fn parse_csv(text: &str, path: &str, options: &Options) -> Result<Vec<Recording>, Error> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let rows = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim_end_matches('\r')));
    let mut rows = rows.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#')).peekable();
    let Some(&(header_line, header)) = rows.peek() else {
        return Err(syntax(path, 0, "the file is empty; a header and rows of joint positions were expected"));
    };
    let columns = if first_row_is_data(header) {
        bare_columns(path, header_line, header)?
    } else {
        rows.next();
        columns(path, header_line, header, options)?
    };

    let mut takes: Vec<Rows> = Vec::new();
    let mut keys: HashSet<&str> = HashSet::new();
    let mut current_key = None;
    let mut points = vec![Vec3::ZERO; columns.triples.len()];
    let mut frames = 0;
    for (line, row) in rows {
        let row = cells(row, columns.separator);
        if row.len() != columns.count {
            let message = format!("{} cells; the header has {}", row.len(), columns.count);
            return Err(syntax(path, line, message));
        }
        frames += 1;
        if frames > MAX_FRAMES {
            return Err(syntax(path, line, format!("more than {MAX_FRAMES} frames")));
        }
        let key = columns.key.map(|column| row[column]);
        if takes.is_empty() || key != current_key {
            if key.is_some_and(|key| !keys.insert(key)) {
                let message = format!(
                    "take {} again after another; its rows must stand together",
                    shown(key.unwrap_or_default())
                );
                return Err(syntax(path, line, message));
            }
            current_key = key;
            let name = key.map_or_else(|| stem(path), str::to_owned);
            takes.push(Rows { name, line, poses: Vec::new(), times: Vec::new() });
        }
        if let Some(take) = takes.last_mut() {
            take.poses.push(pose(path, line, &row, &columns, &mut points)?);
            if let Some(column) = columns.time {
                take.times.push(number(path, line, row[column], "time")?);
            }
        }
    }
    if takes.is_empty() {
        return Err(syntax(path, header_line, "no rows after the header"));
    }
    takes.into_iter().map(|take| recording(take, path, &columns, options)).collect()
}

/// The 16 joints of one row; `points` is room for the joints of the file.
fn pose(
    path: &str,
    line: usize,
    row: &[&str],
    columns: &Columns,
    points: &mut [Vec3],
) -> Result<Pose, Error> {
    for joint in columns.joints.used() {
        for (axis, &column) in columns.triples[joint].iter().enumerate() {
            points[joint][axis] = number(path, line, row[column], &columns.names[joint])?;
        }
    }
    Ok(columns.joints.pose(|joint| points[joint]))
}

fn recording(rows: Rows, path: &str, columns: &Columns, options: &Options) -> Result<Recording, Error> {
    let (rate, rate_line) = match (rows.times.first(), rows.times.last()) {
        (Some(first), Some(last)) if rows.times.len() > 1 && options.frame_rate.is_none() => {
            if let Some(at) = rows.times.windows(2).position(|pair| pair[1] <= pair[0]) {
                let message = format!("time does not increase after {} s", rows.times[at]);
                return Err(syntax(path, rows.line + at + 1, message));
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

fn separator_of(line: &str) -> char {
    [',', ';', '\t'].into_iter().find(|&separator| line.contains(separator)).unwrap_or(' ')
}

fn first_row_is_data(line: &str) -> bool {
    cells(line, separator_of(line)).iter().all(|cell| cell.parse::<f32>().is_ok())
}

/// The columns of a file without header: E-Gait's 48 numbers, right arm and leg before the left ones.
fn bare_columns(path: &str, line: usize, row: &str) -> Result<Columns, Error> {
    let separator = separator_of(row);
    let count = cells(row, separator).len();
    if count != 3 * JOINT_COUNT {
        let message =
            format!("{count} numbers and no header; without one, E-Gait's 48 numbers a row are expected");
        return Err(syntax(path, line, message));
    }
    // the data's README names the left side first, the authors' code the right; the data have both. Whichever
    // is taken here, the bend of the knees decides.
    let joints = Sources::single(Joint::ALL.map(|joint| joint.mirrored() as usize));
    let triples = (0..JOINT_COUNT).map(|joint| [3 * joint, 3 * joint + 1, 3 * joint + 2]).collect();
    let names = Joint::ALL.map(|joint| joint.mirrored().name().to_owned()).to_vec();
    let rig = "E-Gait's order, right side first".to_owned();
    Ok(Columns { separator, count, key: None, time: None, triples, joints, names, rig, egait: true })
}

fn columns(path: &str, line: usize, header: &str, options: &Options) -> Result<Columns, Error> {
    let separator = separator_of(header);
    let header = cells(header, separator);
    if header.len() > MAX_COLUMNS {
        return Err(syntax(path, line, format!("{} columns; up to {MAX_COLUMNS} are read", header.len())));
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
            list(&header)
        );
        return Err(syntax(path, line, message));
    }
    let (rig, joints) = joint_map::choose(options.joint_map.as_ref(), &names)
        .map_err(|message| syntax(path, line, message))?;
    let key = single(&["key", "take", "gait"]);
    Ok(Columns {
        separator,
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
