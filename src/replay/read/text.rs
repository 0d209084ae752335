//! Texts of columns: the Pedestrian Dynamics Data Archive, ETH's and UCY's obsmat, TrajNet and SGAN, and whatever names its
//! columns: JuPedSim's users, Vadere, Pathfinder, Viswalk, Crowd:it, gaitway.

use super::columns::{Column, Columns, metres_of};
use super::{Error, Format, Found, Options, Row, infer, number, syntax, unusable, whole};
use crate::table::{Record, Records, Separator, outside_quotes};
use glam::DVec2;
use std::collections::BTreeMap;
use std::path::Path;

/// Most columns of which names are read.
const MOST_NAMES: usize = 256;
/// ETH and UCY were filmed at 15 and 25 frames per second; where the file does not say, 25.
const OBSMAT_RATE: f64 = 25.0;

/// What parts the cells of a text that begins with this row.
fn separator_of(row: &str) -> Separator {
    let open = outside_quotes(row);
    if open.contains(';') {
        return Separator::Sign(b';');
    }
    if !open.contains(',') {
        let row = row.trim();
        let has_words =
            row.contains('\t') && row.contains(' ') && row.contains(|c: char| c.is_ascii_alphabetic());
        return if has_words { Separator::Sign(b'\t') } else { Separator::Space };
    }
    // `1 0 3,5 4,2` has decimal commas; in `1, 0, 3.5` a comma ends the words.
    let words: Vec<&str> = open.split_whitespace().collect();
    let is_decimal = |word: &&str| !word.ends_with(',') && word.matches(',').count() <= 1;
    if words.len() >= 4 && words.iter().all(is_decimal) {
        return Separator::Space;
    }
    // `1 0, 3.5 4.2`: anything goes that parts numbers
    let is_mixed = row.contains(' ')
        && !row.split(',').all(|cell| is_number(cell.trim()))
        && row.split(|c: char| c.is_whitespace() || c == ',').all(|word| word.is_empty() || is_number(word));
    if is_mixed { Separator::SpaceOrComma } else { Separator::Sign(b',') }
}

fn is_number(cell: &str) -> bool {
    super::decimal(cell).is_some()
}

/// A text without its comments and the preamble of Viswalk's files.
struct Rows<'a> {
    path: &'a Path,
    records: Records<'a>,
}

impl<'a> Rows<'a> {
    /// Reads over comments, and what they tell into `found`.
    fn pass_comments(&mut self, found: &mut Found) {
        loop {
            let is_preamble = match self.records.rest().trim_start().as_bytes().first() {
                Some(b'#' | b'*') => true,
                Some(b'$') => self.records.first_line().trim().eq_ignore_ascii_case("$vision"),
                _ => false,
            };
            if !is_preamble {
                return;
            }
            if let Some((_, line)) = self.records.pass_line()
                && let Some(comment) = line.trim().strip_prefix('#')
            {
                read_comment(comment, found);
            }
        }
    }

    /// Reads the next row; false at the end.
    fn read(&mut self, row: &mut Record<'a>, found: &mut Found) -> Result<bool, Error> {
        self.pass_comments(found);
        self.records.read(row).map_err(|quote| syntax(self.path, quote.line, quote.to_string()))
    }
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
    let (mut found, mut row) = (Found::default(), Record::default());
    let mut rows = Rows { path, records: Records::new(text) };
    rows.pass_comments(&mut found);
    rows.records.part_by(separator_of(rows.records.first_line()));
    rows.records.keep(MOST_NAMES);
    let mut body = rows.records.place();
    if !rows.read(&mut row, &mut found)? {
        return Err(unusable(
            path,
            "it has no rows",
            "a recording has one for every person and frame, of id, frame, x, y",
        ));
    }
    let has_head = !row.cells.iter().all(|cell| is_number(cell) || cell.is_empty());
    let mut unit = None;
    let (columns, from) = match (&options.columns, has_head) {
        (Some(columns), _) => (columns.clone(), "asked for"),
        (None, true) => {
            let head: Vec<&str> = row.cells.iter().map(AsRef::as_ref).collect();
            let (columns, metres) = Columns::of_head(path, row.line, &head)?;
            unit = metres;
            (columns, "file")
        }
        (None, false) => {
            bare(path, row.line, row.cells.iter().filter(|c| !c.is_empty()).count(), options, &found)?
        }
    };
    found.format = match (from, options.format) {
        (_, Some(format)) => format,
        ("format", None) => Format::Obsmat,
        (_, None) if has_head => Format::Csv,
        _ if columns.0.starts_with(&[Column::Id, Column::Frame]) => Format::Archive,
        _ => Format::Columns,
    };
    if has_head {
        body = rows.records.place();
        if rows.read(&mut row, &mut found)?
            && let Some(metres) = unit_of(&row, &columns)
        {
            (body, unit) = (rows.records.place(), Some(metres));
        }
    }
    rows.records.return_to(body);
    rows.pass_comments(&mut found);
    if rows.records.rest().is_empty() {
        return Err(unusable(path, "no rows below the head", "a recording has at least one"));
    }
    read_rows(rows, &columns, &mut found)?;
    found.metres_per_unit = unit.map(|metres| (metres, "file")).or(found.metres_per_unit);
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

/// Metres per unit where the row below a head holds units (as Pathfinder's does) instead of a person's place.
fn unit_of(row: &Record<'_>, columns: &Columns) -> Option<f64> {
    let cell = |column| columns.find(column).and_then(|at| row.get(at)).unwrap_or_default();
    metres_of(cell(Column::X)).filter(|_| !is_number(cell(Column::Time)))
}

/// The last known end of each person's step.
type Ends = BTreeMap<i64, Row>;

fn read_rows(mut rows: Rows<'_>, columns: &Columns, found: &mut Found) -> Result<(), Error> {
    let last = columns.0.iter().rposition(|column| *column != Column::Skip).unwrap_or(0);
    rows.records.keep(last + 1);
    let (path, mut row) = (rows.path, Record::default());
    let (mut ends, mut times) = (Ends::new(), Times::default());
    while rows.read(&mut row, found)? {
        let line = row.line;
        let cell = |column| columns.find(column).map(|at| row.get(at));
        let need = |column: Column, name: &str| number(path, line, name, cell(column).flatten());
        if cell(Column::Kind).flatten().is_some_and(|kind| matches!(kind, "robot" | "vehicle")) {
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
