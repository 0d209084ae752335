//! Texts of columns: the Pedestrian Dynamics Data Archive, ETH's and UCY's obsmat, TrajNet and SGAN, and whatever names its
//! columns: JuPedSim's users, Vadere, Pathfinder, Viswalk, Crowd:it, gaitway.

use super::columns::{Column, Columns, metres_of};
use super::{Error, Format, Found, Options, Row, infer, number, unusable, whole};
use glam::DVec2;
use std::collections::BTreeMap;
use std::path::Path;

/// ETH and UCY were filmed at 15 and 25 frames per second; where the file does not say, 25.
const OBSMAT_RATE: f64 = 25.0;

/// What parts the cells of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Separator {
    Sign(char),
    /// Any white space.
    Space,
    /// Commas and white space.
    Both,
}

impl Separator {
    fn of(row: &str) -> Self {
        if row.contains(';') {
            return Self::Sign(';');
        }
        if !row.contains(',') {
            let row = row.trim();
            let has_words =
                row.contains('\t') && row.contains(' ') && row.contains(|c: char| c.is_ascii_alphabetic());
            return if has_words { Self::Sign('\t') } else { Self::Space };
        }
        // `1 0 3,5 4,2` has decimal commas; in `1, 0, 3.5` a comma ends the words.
        let words: Vec<&str> = row.split_whitespace().collect();
        let is_decimal = |word: &&str| !word.ends_with(',') && word.matches(',').count() <= 1;
        if words.len() >= 4 && words.iter().all(is_decimal) { Self::Space } else { Self::Sign(',') }
    }

    fn cells(self, row: &str) -> Box<dyn Iterator<Item = &str> + '_> {
        match self {
            Self::Sign(sign) => Box::new(row.split(sign)),
            Self::Space => Box::new(row.split_whitespace()),
            Self::Both => {
                Box::new(row.split(|c: char| c.is_whitespace() || c == ',').filter(|cell| !cell.is_empty()))
            }
        }
    }
}

fn is_number(cell: &str) -> bool {
    super::decimal(cell).is_some()
}

/// Rows that hold something: without comments, blank lines and the preamble of Viswalk's files.
fn rows<'a>(text: &'a str, found: &mut Found) -> Vec<(usize, &'a str)> {
    let mut rows = Vec::new();
    // old Macs end lines with a carriage return alone
    let lines: Box<dyn Iterator<Item = &str>> =
        if text.contains('\n') { Box::new(text.lines()) } else { Box::new(text.split('\r')) };
    for (line, row) in (1..).zip(lines) {
        let bare = row.trim();
        if let Some(comment) = bare.strip_prefix('#') {
            read_comment(comment, found);
        } else if !bare.is_empty() && !bare.starts_with('*') && !bare.eq_ignore_ascii_case("$vision") {
            rows.push((line, row));
        }
    }
    rows
}

/// Frame rate, unit and columns out of a comment: `framerate: 25 fps`, `x/cm`, `in m`, `id frame x y z`.
fn read_comment(comment: &str, found: &mut Found) {
    let lower = comment.to_ascii_lowercase();
    if let Some((_, rest)) = lower.split_once("framerate").or_else(|| lower.split_once("frame rate")) {
        let digits: String = rest
            .chars()
            .skip_while(|c| !c.is_ascii_digit())
            .take_while(|c| c.is_ascii_digit() || *c == '.')
            .collect();
        if let Some(rate) = digits.parse().ok().filter(|rate: &f64| *rate > 0.0) {
            found.frame_rate = Some((rate, "file"));
        }
    }
    let unit = if lower.contains("x/cm") || lower.contains("[cm]") || lower.contains("in cm") {
        Some(0.01)
    } else if lower.contains("x/m") || lower.contains("[m]") || lower.contains("in m") {
        Some(1.0)
    } else {
        None
    };
    found.metres_per_unit = unit.map(|unit| (unit, "file")).or(found.metres_per_unit);
    if let Some(columns) = Columns::of_comment(comment) {
        found.columns = Some((columns, "file"));
    }
}

/// Reads a text of columns.
pub(super) fn parse(path: &Path, text: &str, options: &Options) -> Result<Found, Error> {
    let mut found = Found::default();
    let rows = rows(text, &mut found);
    let Some(&(line, first)) = rows.first() else {
        return Err(unusable(
            path,
            "it has no rows",
            "a recording has one for every person and frame, of id, frame, x, y",
        ));
    };
    let mut separator = Separator::of(first);
    if separator == Separator::Sign(',') && !separator.cells(first).all(is_number) && first.contains(' ') {
        // `1 0, 3.5 4.2`: anything goes that parts numbers
        if Separator::Both.cells(first).all(is_number) {
            separator = Separator::Both;
        }
    }
    let cells: Vec<&str> = separator.cells(first).take(256).collect();
    let has_head = !cells.iter().all(|cell| is_number(cell) || cell.trim().is_empty());
    let (columns, from) = match (&options.columns, has_head) {
        (Some(columns), _) => (columns.clone(), "asked for"),
        (None, true) => {
            let (columns, metres) = Columns::of_head(path, line, &cells)?;
            found.metres_per_unit = metres.map(|metres| (metres, "file")).or(found.metres_per_unit);
            (columns, "file")
        }
        (None, false) => {
            bare(path, line, cells.iter().filter(|c| !c.trim().is_empty()).count(), options, &found)?
        }
    };
    found.format = match (from, options.format) {
        (_, Some(format)) => format,
        ("format", None) => Format::Obsmat,
        (_, None) if has_head => Format::Csv,
        _ if columns.0.starts_with(&[Column::Id, Column::Frame]) => Format::Archive,
        _ => Format::Columns,
    };
    let mut body = rows.get(usize::from(has_head)..).unwrap_or(&[]);
    if let Some((&(_, units), rest)) = body.split_first().filter(|_| has_head)
        && is_units(separator, units, &columns, &mut found)
    {
        body = rest;
    }
    if body.is_empty() {
        return Err(unusable(path, "no rows below the head", "a recording has at least one"));
    }
    read_rows(path, separator, body, &columns, &mut found)?;
    if found.format == Format::Obsmat {
        found.usual_rate = Some(OBSMAT_RATE);
    }
    found.columns = Some((columns, from));
    if from == "inferred" {
        infer::order(&mut found);
    }
    Ok(found)
}

/// The columns of a text that does not name them.
fn bare(
    path: &Path,
    line: usize,
    count: usize,
    options: &Options,
    found: &Found,
) -> Result<(Columns, &'static str), Error> {
    use Column::{Frame, Id, Skip, Vx, Vy, X, Y, Z};
    if let Some((columns, from)) = &found.columns {
        return Ok((columns.clone(), from));
    }
    match (count, options.format) {
        (8, None | Some(Format::Obsmat)) => {
            Ok((Columns(vec![Frame, Id, X, Skip, Y, Vx, Skip, Vy]), "format"))
        }
        (4, Some(Format::Archive)) => Ok((Columns(vec![Id, Frame, X, Y]), "asked for")),
        (5.., Some(Format::Archive)) => Ok((Columns(vec![Id, Frame, X, Y, Z]), "asked for")),
        (4, _) => Ok((Columns(vec![Id, Frame, X, Y]), "inferred")),
        (5, _) => Ok((Columns(vec![Id, Frame, X, Y, Z]), "inferred")),
        _ => {
            let message =
                format!("line {line} has {count} columns without names; no format that is read looks so");
            let hint = "say what they are, such as --columns id,frame,x,y or frame,id,x,-,y; read without that are .sqlite \
                        (JuPedSim), .vsp, named columns, and texts of 4, 5 or 8";
            Err(unusable(path, message, hint))
        }
    }
}

/// Whether the row below a head holds units (as Pathfinder's does) instead of a person's place.
fn is_units(separator: Separator, row: &str, columns: &Columns, found: &mut Found) -> bool {
    let cells: Vec<&str> = separator.cells(row).take(256).collect();
    let cell = |column| columns.find(column).and_then(|at| cells.get(at)).map_or("", |cell| cell.trim());
    let (x, time) =
        (cell(Column::X), if columns.find(Column::Time).is_some() { cell(Column::Time) } else { "" });
    let is_unit = metres_of(x).is_some() && !is_number(time);
    if is_unit {
        found.metres_per_unit = metres_of(x).map(|metres| (metres, "file"));
    }
    is_unit
}

/// The last known end of each person's step.
type Ends = BTreeMap<i64, Row>;

fn read_rows(
    path: &Path,
    separator: Separator,
    body: &[(usize, &str)],
    columns: &Columns,
    found: &mut Found,
) -> Result<(), Error> {
    let last = columns.0.iter().rposition(|column| *column != Column::Skip).unwrap_or(0);
    let mut cells: Vec<&str> = Vec::with_capacity(last + 1);
    let (mut ends, mut times) = (Ends::new(), Times::default());
    found.rows.reserve(body.len());
    for &(line, row) in body {
        cells.clear();
        cells.extend(separator.cells(row).take(last + 1));
        let cell = |column| columns.find(column).map(|at| cells.get(at).copied());
        let need = |column: Column, name: &str| number(path, line, name, cell(column).flatten());
        if cell(Column::Kind).flatten().is_some_and(|kind| matches!(kind.trim(), "robot" | "vehicle")) {
            continue;
        }
        let id = whole(path, line, "the id", cell(Column::Id).flatten())?;
        let time = cell(Column::Time).map(|cell| number(path, line, "the time", cell)).transpose()?;
        #[allow(clippy::cast_precision_loss, reason = "exact: a whole number of 53 bits")]
        let frame = match cell(Column::Frame) {
            Some(cell) => whole(path, line, "the frame", cell)? as f64,
            None => time.unwrap_or(0.0),
        };
        let x = need(Column::X, "x")?;
        let is_ours = columns.find(Column::Down).is_some();
        let y = if is_ours { -need(Column::Down, "z")? } else { need(Column::Y, "y")? };
        if let (Some(time), Some(_)) = (time, cell(Column::Frame)) {
            times.add(frame, time);
        }
        if let Some(Some(height)) = cell(Column::Z) {
            found.heights.push(number(path, line, "z", Some(height))?);
        }
        let heading =
            cell(Column::Heading).map(|cell| number(path, line, "the heading", cell)).transpose()?;
        let velocity = match (cell(Column::Vx), cell(Column::Vy)) {
            (Some(vx), Some(vy)) => Some([number(path, line, "vx", vx)?, number(path, line, "vy", vy)?]),
            _ => None,
        };
        let row = Row {
            id,
            frame,
            place: DVec2::new(x, y),
            #[allow(clippy::cast_possible_truncation, reason = "a velocity")]
            velocity: velocity.map(|v| v.map(|part| part as f32)),
            facing: heading.map(|heading| heading - std::f64::consts::FRAC_PI_2),
            line,
        };
        if columns.find(Column::EndTime).is_some() && columns.find(Column::EndY).is_some() {
            let place = DVec2::new(need(Column::EndX, "the end's x")?, need(Column::EndY, "the end's y")?);
            let end = Row { frame: need(Column::EndTime, "the end's time")?, place, velocity: None, ..row };
            if end.frame > row.frame && ends.get(&id).is_none_or(|known| known.frame < end.frame) {
                ends.insert(id, end);
            }
        }
        found.rows.push(row);
    }
    if columns.find(Column::Frame).is_some() {
        found.frame_rate = times.rate().map(|rate| (rate, "times")).or(found.frame_rate);
        return Ok(());
    }
    found.rows.extend(ends.into_values());
    infer::frames_of_times(path, found)
}

/// The first and the last frame with their times, where a text has both.
#[derive(Debug, Default)]
struct Times(Option<[(f64, f64); 2]>);

impl Times {
    fn add(&mut self, frame: f64, time: f64) {
        let now = (frame, time);
        let [first, last] = self.0.get_or_insert([now; 2]);
        *first = if now.0 < first.0 { now } else { *first };
        *last = if now.0 > last.0 { now } else { *last };
    }

    fn rate(&self) -> Option<f64> {
        let [first, last] = self.0.filter(|[first, last]| last.1 > first.1)?;
        let rate = (last.0 - first.0) / (last.1 - first.1);
        // Times are written to the microsecond, which leaves the rate of a short file uncertain in the fifth place.
        Some((rate * 1000.0).round() / 1000.0)
    }
}
