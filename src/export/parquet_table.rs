//! Parquet files of flat tables: columns of numbers and words, each with its encoding, compressed with zstd. The library encodes
//! small tables; of large ones it takes chunks that are encoded already.

use super::Error;
use super::atomic::wrong;
use super::columns::VERSION_KEY;
use super::long_file::LongFile;
use super::parquet_chunk::Chunk;
use super::rounded::Rounded;
use crate::file::Partial;
use parquet::basic::{Compression, Encoding, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int32Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterVersion};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{ColumnDescPtr, ColumnPath, SchemaDescriptor, Type};
use std::io::{BufWriter, IntoInnerError};
use std::path::Path;
use std::sync::Arc;

/// Level of zstd: the fastest but for those that leave literals as they are.
pub(super) const LEVEL: i32 = 1;
/// Level for numbers whose low bits are noise: mantissas hardly compress at any, and this one soon gives up.
pub(super) const EXACT_LEVEL: i32 = -4;
/// The same where there are so many numbers that time counts: half of it, and a third of a byte more a number.
pub(super) const HASTY_LEVEL: i32 = -32;
/// Rows of a page. A byte of so many numbers is a block of zstd, so bytes of different weight have codes of their own.
pub(super) const PAGE: usize = 1 << 17;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Whole numbers, as differences of successive ones.
    Whole,
    /// `f32`, bytes of equal weight side by side.
    Float,
    /// The same to the last bit, which is noise. In chunks only.
    Exact,
    /// `f32` of few values, multiples of a step. In chunks only; fast ones write each value once.
    Step,
    /// `f64`, the same.
    Double,
    /// Yes or no.
    Flag,
    /// Words, each written once.
    Word,
}

/// A column of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ColumnOf {
    pub(super) name: &'static str,
    pub(super) kind: Kind,
    /// Whether values may be missing.
    pub(super) is_optional: bool,
}

/// Values of a column: those that are there, and for an optional column a level for every row, 1 where it has one.
#[derive(Debug)]
pub(super) enum Values<'a> {
    Whole(&'a [i32]),
    Float(&'a [f32]),
    /// In chunks only.
    Rounded(&'a Rounded),
    Double(&'a [f64]),
    Flag(&'a [bool]),
    Word(&'a [ByteArray]),
}

impl Values<'_> {
    /// How many there are.
    pub(super) fn len(&self) -> usize {
        match self {
            Values::Whole(values) => values.len(),
            Values::Float(values) => values.len(),
            Values::Rounded(Rounded::Near(steps)) => steps.len(),
            Values::Rounded(Rounded::Far(values)) => values.len(),
            Values::Double(values) => values.len(),
            Values::Flag(values) => values.len(),
            Values::Word(values) => values.len(),
        }
    }
}

/// Bytes that are written to the file at once: the library hands over 8 KiB, and a system spends most of such a write on
/// its pages.
const BUFFER: usize = 1 << 18;

/// A file of a table being written in a temporary neighbour of its place.
pub(super) struct Table {
    writer: SerializedFileWriter<BufWriter<LongFile>>,
    columns: Vec<ColumnDescPtr>,
}

impl std::fmt::Debug for Table {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Table").finish_non_exhaustive()
    }
}

/// Turns an error of Parquet into ours.
pub(super) fn refused(path: &Path) -> impl Fn(ParquetError) -> Error + '_ {
    move |source| Error::Parquet { path: path.to_owned(), source: source.into() }
}

impl Table {
    /// Begins a file of these columns.
    pub(super) fn create(path: &Path, columns: &[ColumnOf]) -> Result<Self, Error> {
        let partial = Partial::create(path).map_err(wrong(path))?;
        let make = || -> Result<_, ParquetError> {
            let schema = Arc::new(schema(columns)?);
            let columns_of_it = SchemaDescriptor::new(schema.clone()).columns().to_vec();
            let file = BufWriter::with_capacity(BUFFER, LongFile::new(partial));
            let writer = SerializedFileWriter::new(file, schema, Arc::new(properties(columns)?))?;
            Ok(Self { writer, columns: columns_of_it })
        };
        make().map_err(refused(path))
    }

    /// Appends rows: values and levels of every column, in order.
    pub(super) fn write(&mut self, columns: &[(Values<'_>, Option<&[i16]>)]) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for (values, levels) in columns {
            let Some(mut open) = group.next_column()? else { break };
            match values {
                Values::Whole(values) => put::<Int32Type>(&mut open, values, *levels)?,
                Values::Float(values) => put::<FloatType>(&mut open, values, *levels)?,
                Values::Double(values) => put::<DoubleType>(&mut open, values, *levels)?,
                Values::Flag(values) => put::<BoolType>(&mut open, values, *levels)?,
                Values::Word(values) => put::<ByteArrayType>(&mut open, values, *levels)?,
                Values::Rounded(_) => {
                    return Err(ParquetError::NYI("rounded numbers outside of chunks".to_owned()));
                }
            }
            open.close()?;
        }
        group.close().map(drop)
    }

    /// Appends a row group of columns that are encoded already. The chunks are empty afterwards.
    pub(super) fn append(&mut self, chunks: &mut [Chunk]) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for (chunk, column) in chunks.iter_mut().zip(&self.columns) {
            chunk.hand_over(column.clone(), |pages, close| group.append_column(pages, close))?;
        }
        group.close().map(drop)
    }

    /// Notes a fact about the whole file.
    pub(super) fn note(&mut self, key: &str, value: String) {
        self.writer.append_key_value_metadata(KeyValue::new(key.to_owned(), value));
    }

    /// Completes the bytes; the file has no name yet.
    pub(super) fn complete(self) -> Result<Partial, ParquetError> {
        let file = self.writer.into_inner()?.into_inner().map_err(IntoInnerError::into_error)?;
        Ok(file.into_inner())
    }
}

fn put<T: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    values: &[T::T],
    levels: Option<&[i16]>,
) -> Result<(), ParquetError> {
    column.typed::<T>().write_batch(values, levels, None).map(drop)
}

fn schema(columns: &[ColumnOf]) -> Result<Type, ParquetError> {
    let field = |column: &ColumnOf| {
        let (physical, logical) = match column.kind {
            Kind::Whole => (Physical::INT32, None),
            Kind::Float | Kind::Exact | Kind::Step => (Physical::FLOAT, None),
            Kind::Double => (Physical::DOUBLE, None),
            Kind::Flag => (Physical::BOOLEAN, None),
            Kind::Word => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let repetition = if column.is_optional { Repetition::OPTIONAL } else { Repetition::REQUIRED };
        let builder = Type::primitive_type_builder(column.name, physical);
        builder.with_repetition(repetition).with_logical_type(logical).build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<Vec<_>, _>>()?;
    Type::group_type_builder("table").with_fields(fields).build()
}

fn properties(columns: &[ColumnOf]) -> Result<WriterProperties, ParquetError> {
    let version = env!("CARGO_PKG_VERSION");
    // Pages of version 1 are read everywhere; the encodings do not depend on it.
    let mut properties = WriterProperties::builder()
        .set_writer_version(WriterVersion::PARQUET_1_0)
        .set_created_by(format!("gaitway version {version}"))
        .set_key_value_metadata(Some(vec![KeyValue::new(VERSION_KEY.to_owned(), version.to_owned())]))
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(LEVEL)?))
        .set_dictionary_enabled(false)
        .set_data_page_row_count_limit(PAGE)
        .set_statistics_enabled(EnabledStatistics::None);
    for column in columns {
        let path = ColumnPath::from(column.name);
        properties = match column.kind {
            Kind::Whole => properties
                .set_column_encoding(path.clone(), Encoding::DELTA_BINARY_PACKED)
                .set_column_statistics_enabled(path, EnabledStatistics::Chunk),
            Kind::Float | Kind::Double => properties.set_column_encoding(path, Encoding::BYTE_STREAM_SPLIT),
            Kind::Flag | Kind::Exact | Kind::Step => properties,
            Kind::Word => properties.set_column_dictionary_enabled(path, true),
        };
    }
    Ok(properties.build())
}
