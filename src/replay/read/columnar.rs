//! Parquet: ours, and tables of others with columns of names as texts have them (id, frame or time, x, y).
//!
//! A few bytes may stand for a million equal values, so rows are bounded by the file's size: [`ROWS_A_BYTE`] of them a byte
//! and [`ROWS_BESIDE`] more. [`pages`] looks at what pages claim before the library believes it.

use super::pages::{self, Bounds};
use super::{Column, Columns, Error, Format, Found, MAX_BYTES, Row, area, infer, syntax, unusable};
use crate::export::columns::{AREA_KEY, FRAME_RATE_KEY, HEADING, IS_PERSON, VERSION_KEY};
use crate::file;
use bytes::Bytes;
use glam::DVec2;
use parquet::basic::Type as Physical;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData};
use parquet::file::reader::{FileReader as _, RowGroupReader, SerializedFileReader};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// Rows that a byte of a file may stand for: a standing person takes a twentieth of a byte.
const ROWS_A_BYTE: usize = 64;
/// Rows of the smallest files.
const ROWS_BESIDE: usize = 1 << 16;
/// Values that are decoded together.
const TOGETHER: usize = 1 << 12;
/// A page may claim so many bytes, and so many times the file's.
const PAGE: u64 = 4 << 20;
const PAGE_TIMES: u64 = 8;
/// Whole numbers up to this are exact as `f64`.
const MOST_WHOLE: i64 = 1 << 53;

pub(super) fn read(path: &Path) -> Result<Found, Error> {
    let read = |source| Error::Read { path: path.to_owned(), source };
    let bytes = file::read(path, MAX_BYTES).map_err(read)?.into();
    // The library's decoders index beyond their input where a broken page says so. Nothing of theirs is used after that.
    catch_unwind(AssertUnwindSafe(|| parse(path, &bytes))).unwrap_or_else(|_| {
        Err(unusable(path, "a page of it is broken", "write it again, or write its rows as .csv"))
    })
}

/// Turns an error of the library into ours.
fn refused(path: &Path) -> impl Fn(ParquetError) -> Error + '_ {
    move |source| Error::Parquet { path: path.to_owned(), source: source.into() }
}

/// Which column of the file holds what.
#[derive(Debug)]
struct Layout {
    columns: Columns,
    /// Ours alone.
    heading: Option<usize>,
    /// Ours alone: false for robots and vehicles.
    is_person: Option<usize>,
}

fn parse(path: &Path, bytes: &Bytes) -> Result<Found, Error> {
    let reader = SerializedFileReader::new(bytes.clone()).map_err(refused(path))?;
    let metadata = reader.metadata();
    let mut found = Found { format: Format::Parquet, ..Found::default() };
    let layout = layout(path, metadata, &mut found)?;
    let counts = counts(path, metadata, bytes.len())?;
    let most = PAGE + PAGE_TIMES * bytes.len() as u64;
    for (group, rows) in counts.into_iter().enumerate() {
        let open = reader.get_row_group(group).map_err(refused(path))?;
        let part = Part { path, bytes, group: open.as_ref(), rows, most };
        rows_of(&part, &layout, &mut found)?;
    }
    let Layout { columns, .. } = layout;
    let has_frames = columns.find(Column::Frame).is_some();
    found.columns = Some((columns, "file"));
    if !has_frames {
        infer::frames_of_times(path, &mut found)?;
    }
    Ok(found)
}

/// What the file says of itself, and its columns.
fn layout(path: &Path, metadata: &ParquetMetaData, found: &mut Found) -> Result<Layout, Error> {
    let file = metadata.file_metadata();
    let notes = file.key_value_metadata();
    let noted = |key: &str| {
        let note = notes.into_iter().flatten().find(|note| note.key == key);
        note.and_then(|note| note.value.as_deref())
    };
    let is_ours = noted(VERSION_KEY).is_some();
    found.frame_rate = noted(FRAME_RATE_KEY).and_then(|rate| rate.parse().ok()).map(|rate| (rate, "file"));
    area::take(noted(AREA_KEY), found);
    // of nested columns there is no name: they hold lists
    let columns = file.schema_descr().columns().iter();
    let names: Vec<&str> =
        columns
            .map(|column| {
                if column.path().parts().len() == 1 && column.max_rep_level() == 0 {
                    column.name()
                } else {
                    ""
                }
            })
            .collect();
    let (columns, unit, missing) = Columns::of_names(&names);
    if let Some(missing) = missing {
        let list = super::clip(&names.join(", "));
        let person = if missing == "id" { "the person (id)" } else { missing };
        let hint =
            "a person's id, a frame or a time, x and y are needed; rename columns, or write them as .csv";
        return Err(unusable(path, format!("no column for {person} among {list:?}"), hint));
    }
    found.metres_per_unit = if is_ours { Some((1.0, "format")) } else { unit.map(|unit| (unit, "file")) };
    let ours = |name: &str| names.iter().position(|one| is_ours && *one == name);
    Ok(Layout { columns, heading: ours(HEADING), is_person: ours(IS_PERSON) })
}

/// Rows of every group, if they are as many as such a file may hold.
fn counts(path: &Path, metadata: &ParquetMetaData, size: usize) -> Result<Vec<usize>, Error> {
    let most = ROWS_BESIDE + ROWS_A_BYTE * size;
    let mut sum = 0_usize;
    let mut counts = Vec::new();
    for group in metadata.row_groups() {
        let count = usize::try_from(group.num_rows()).ok().filter(|count| *count <= most - sum);
        let Some(count) = count else {
            let message = format!(
                "{} rows in a group of a file of {size} bytes; at most {most} are read",
                group.num_rows()
            );
            return Err(unusable(path, message, "write its rows as .csv"));
        };
        sum += count;
        counts.push(count);
    }
    Ok(counts)
}

/// A row group.
struct Part<'a> {
    path: &'a Path,
    bytes: &'a Bytes,
    group: &'a dyn RowGroupReader,
    rows: usize,
    /// Bytes that a page may claim.
    most: u64,
}

impl Part<'_> {
    /// The values of a column, NaN where there is none.
    fn column(&self, at: usize) -> Result<Vec<f64>, Error> {
        let named = |message: String| {
            let name = self.group.metadata().column(at).column_descr().name();
            unusable(self.path, format!("column {name:?}: {message}"), "write its rows as .csv")
        };
        let of = self.group.metadata().column(at);
        let is_optional = of.column_descr().max_def_level() > 0;
        let width = match of.column_type() {
            Physical::INT64 | Physical::DOUBLE => 8,
            _ => 4,
        };
        let bounds =
            Bounds { most: self.most, rows: self.rows as u64, width: (!is_optional).then_some(width) };
        let chunk = chunk(self.bytes, of).ok_or("it lies outside the file");
        chunk.map_err(str::to_owned).and_then(|chunk| pages::check(chunk, bounds)).map_err(named)?;
        let values = Decoding { rows: self.rows, is_optional };
        #[allow(clippy::cast_precision_loss, reason = "within 53 bits, or refused as no number")]
        let whole = |value: &i64| if value.abs() <= MOST_WHOLE { *value as f64 } else { f64::INFINITY };
        let read = match self.group.get_column_reader(at).map_err(refused(self.path))? {
            ColumnReader::Int32ColumnReader(reader) => values.all(reader, |value| f64::from(*value)),
            ColumnReader::Int64ColumnReader(reader) => values.all(reader, whole),
            ColumnReader::FloatColumnReader(reader) => values.all(reader, |value| f64::from(*value)),
            ColumnReader::DoubleColumnReader(reader) => values.all(reader, |value| *value),
            ColumnReader::BoolColumnReader(reader) => values.all(reader, |value| f64::from(u8::from(*value))),
            _ => return Err(named("it holds no numbers".to_owned())),
        };
        match read.map_err(refused(self.path))? {
            Some(values) => Ok(values),
            None => Err(named(format!("its values are not those of {} rows", self.rows))),
        }
    }
}

/// The bytes of a column in a group.
fn chunk<'a>(bytes: &'a [u8], column: &ColumnChunkMetaData) -> Option<&'a [u8]> {
    let begin = column.dictionary_page_offset().unwrap_or_else(|| column.data_page_offset());
    let (begin, length) = (usize::try_from(begin).ok()?, usize::try_from(column.compressed_size()).ok()?);
    bytes.get(begin..begin.checked_add(length)?)
}

/// How a column is decoded.
#[derive(Debug, Clone, Copy)]
struct Decoding {
    rows: usize,
    is_optional: bool,
}

impl Decoding {
    /// All values as numbers; none where they are more or fewer than the rows.
    fn all<T: DataType>(
        self,
        mut reader: ColumnReaderImpl<T>,
        number: impl Fn(&T::T) -> f64,
    ) -> Result<Option<Vec<f64>>, ParquetError> {
        let (mut all, mut values, mut levels) = (Vec::new(), Vec::new(), Vec::new());
        loop {
            values.clear();
            levels.clear();
            let (count, ..) =
                reader.read_records(TOGETHER, self.is_optional.then_some(&mut levels), None, &mut values)?;
            if count == 0 {
                return Ok((all.len() == self.rows).then_some(all));
            }
            let mut there = values.iter().map(&number);
            if self.is_optional {
                all.extend(
                    levels
                        .iter()
                        .map(|level| if *level > 0 { there.next() } else { None }.unwrap_or(f64::NAN)),
                );
            } else {
                all.extend(there);
            }
            if all.len() > self.rows {
                return Ok(None);
            }
        }
    }
}

/// Reads the rows of a group.
fn rows_of(part: &Part<'_>, layout: &Layout, found: &mut Found) -> Result<(), Error> {
    let of = |at: Option<usize>| at.map(|at| part.column(at)).transpose();
    let named = |column| of(layout.columns.find(column));
    let (ids, frames, times) = (named(Column::Id)?, named(Column::Frame)?, named(Column::Time)?);
    let (x, y, z) = (named(Column::X)?, named(Column::Y)?, named(Column::Z)?);
    let (down, vx, vy) = (named(Column::Down)?, named(Column::Vx)?, named(Column::Vy)?);
    let (headings, are_people) = (of(layout.heading)?, of(layout.is_person)?);
    let at = |column: &Option<Vec<f64>>, row: usize| column.as_ref().and_then(|all| all.get(row)).copied();
    let known = |column: &Option<Vec<f64>>, row| at(column, row).filter(|value: &f64| value.is_finite());
    let first = found.rows.len();
    for row in 0..part.rows {
        let line = first + row + 1;
        if at(&are_people, row) == Some(0.0) {
            continue;
        }
        let need = |name: &str, value: Option<f64>| {
            value.ok_or_else(|| syntax(part.path, line, format!("{name} is missing, or no finite number")))
        };
        let whole = |name: &str, value: f64| {
            #[allow(clippy::cast_possible_truncation, reason = "a whole number of 53 bits")]
            let number = value as i64;
            let is_whole = value.fract() == 0.0 && number.abs() <= MOST_WHOLE;
            is_whole.then_some(number).ok_or_else(|| {
                syntax(part.path, line, format!("{name} is {value}, not a whole number of up to 53 bits"))
            })
        };
        let id = whole("the id", need("the id", known(&ids, row))?)?;
        let frame = match &frames {
            Some(_) => {
                let frame = need("the frame", known(&frames, row))?;
                whole("the frame", frame)?;
                frame
            }
            None => need("the time", known(&times, row))?,
        };
        let y = known(&y, row).or_else(|| known(&down, row).map(|z| -z));
        #[allow(clippy::cast_possible_truncation, reason = "a velocity")]
        let velocity = known(&vx, row).zip(known(&vy, row)).map(|(vx, vy)| [vx as f32, vy as f32]);
        found.heights.extend(known(&z, row));
        found.rows.push(Row {
            id,
            frame,
            place: DVec2::new(need("x", known(&x, row))?, need("y", y)?),
            velocity,
            facing: known(&headings, row).map(|heading| heading - std::f64::consts::FRAC_PI_2),
            line,
        });
    }
    Ok(())
}
