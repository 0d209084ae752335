//! A column of a row group of Parquet while it is made: pages that are encoded and compressed already, and their dictionary.

use super::parquet_encode::{delta, flags, levels, split, words};
use super::parquet_table::{EXACT_LEVEL, HASTY_LEVEL, Kind, LEVEL, Values};
use super::rounded::{Rounded, STEPS, of_steps};
use bytes::{Buf, Bytes};
use parquet::basic::{Compression, Encoding, ZstdLevel};
use parquet::column::page::{CompressedPage, Page, PageWriter};
use parquet::column::writer::ColumnCloseResult;
use parquet::errors::ParquetError;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::{ChunkReader, Length};
use parquet::file::statistics::Statistics;
use parquet::file::writer::{SerializedPageWriter, TrackedWrite};
use parquet::schema::types::ColumnDescPtr;
use zstd::bulk::Compressor;

/// Numbers of words in a dictionary of all steps as far from zero as a column's values are: 0, -1, 1, -2, 2 and so on. So the number
/// of a word follows from its value, by arithmetic that the compiler turns into vectors, and no word is looked for. Returns how many
/// words there must be.
fn look_up(steps: &[i16], found: &mut Vec<u16>) -> u16 {
    found.clear();
    found.extend(steps.iter().map(|step| (step << 1 ^ step >> 15).cast_unsigned()));
    found.iter().copied().max().unwrap_or(0) + 1 // the farthest steps have the numbers 65,533 and 65,534
}

/// The word of a number.
fn word(number: u16) -> f32 {
    let away = f32::from(number.div_ceil(2)) / STEPS;
    if number.is_multiple_of(2) { away } else { -away }
}

/// Finished pages, and a dictionary before them.
pub(super) struct Pages {
    dictionary: Bytes,
    data: Bytes,
}

impl Length for Pages {
    fn len(&self) -> u64 {
        (self.dictionary.len() + self.data.len()) as u64
    }
}

impl ChunkReader for Pages {
    type T = bytes::buf::Reader<bytes::buf::Chain<Bytes, Bytes>>;

    fn get_read(&self, start: u64) -> Result<Self::T, ParquetError> {
        let mut both = self.dictionary.clone().chain(self.data.clone());
        both.advance(usize::try_from(start).unwrap_or(usize::MAX).min(both.remaining()));
        Ok(both.reader())
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes, ParquetError> {
        let mut rest = self.get_read(start)?.into_inner();
        Ok(rest.copy_to_bytes(length.min(rest.remaining())))
    }
}

/// A column of a row group.
pub(super) struct Chunk {
    kind: Kind,
    pages: Vec<u8>,
    /// Whether speed goes before size.
    is_fast: bool,
    /// Words that the dictionary must have.
    words: u16,
    compressor: Compressor<'static>,
    encodings: Vec<Encoding>,
    rows: u64,
    unfolded: usize,
    /// Least and greatest of whole numbers.
    range: Option<(i32, i32)>,
    // memory of the last page
    found: Vec<u16>,
    plain: Vec<u8>,
    folded: Vec<u8>,
}

impl std::fmt::Debug for Chunk {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Chunk").field("kind", &self.kind).field("rows", &self.rows).finish_non_exhaustive()
    }
}

impl Chunk {
    pub(super) fn new(kind: Kind) -> Result<Self, ParquetError> {
        Ok(Self {
            kind,
            pages: Vec::new(),
            is_fast: false,
            words: 0,
            compressor: Compressor::new(LEVEL)?,
            encodings: vec![Encoding::RLE],
            rows: 0,
            unfolded: 0,
            range: None,
            found: Vec::new(),
            plain: Vec::new(),
            folded: Vec::new(),
        })
    }

    /// Begins a row group that is written fast or, where there are few rows, as small as it gets. Fast, steps are numbers of words in
    /// a dictionary, which need no compression: a fifth of the time, and a third of a byte more a value.
    pub(super) fn begin(&mut self, is_fast: bool) -> Result<(), ParquetError> {
        self.is_fast = is_fast;
        let level = match (self.kind, is_fast) {
            (Kind::Exact, true) => HASTY_LEVEL,
            (Kind::Exact, false) => EXACT_LEVEL,
            _ => LEVEL,
        };
        Ok(self.compressor.set_compression_level(level)?)
    }

    /// Whether pages are numbers of words, as far as these are near zero, and are not compressed.
    fn has_words(&self) -> bool {
        self.is_fast && self.kind == Kind::Step
    }

    /// Appends a page: values, and of an optional column which rows have one.
    pub(super) fn page(
        &mut self,
        values: &Values<'_>,
        has_value: Option<&[bool]>,
    ) -> Result<(), ParquetError> {
        self.plain.clear();
        let rows = has_value.map_or(values.len(), <[bool]>::len);
        if let Some(has_value) = has_value {
            levels(&mut self.plain, has_value);
        }
        let encoding = self.encode(values)?;
        if !self.encodings.contains(&encoding) {
            self.encodings.push(encoding);
        }
        let unfolded = self.plain.len();
        let stored = if self.has_words() {
            &mut self.plain
        } else {
            self.folded.clear();
            self.folded.reserve(zstd::zstd_safe::compress_bound(unfolded));
            self.compressor.compress_to_buffer(&self.plain, &mut self.folded)?;
            &mut self.folded
        };
        let bytes = Bytes::from(std::mem::take(stored));
        let page = Page::DataPage {
            buf: bytes.clone(),
            num_values: u32::try_from(rows).unwrap_or(u32::MAX), // of a page: far less
            encoding,
            def_level_encoding: Encoding::RLE,
            rep_level_encoding: Encoding::RLE,
            statistics: None,
        };
        self.unfolded += put(&mut self.pages, CompressedPage::new(page, unfolded))?;
        *stored = Vec::from(bytes); // its memory: the page is gone
        self.rows += rows as u64;
        Ok(())
    }

    /// Appends values to the page.
    fn encode(&mut self, values: &Values<'_>) -> Result<Encoding, ParquetError> {
        let has_words = self.has_words();
        let out = &mut self.plain;
        match values {
            // nothing: no reader looks for a dictionary that no page needs
            Values::Float([]) => Ok(Encoding::PLAIN),
            Values::Rounded(Rounded::Near(steps)) if has_words && !steps.is_empty() => {
                let needed = look_up(steps, &mut self.found);
                words(out, &self.found, needed);
                self.words = self.words.max(needed);
                Ok(Encoding::RLE_DICTIONARY)
            }
            Values::Rounded(Rounded::Near(steps)) => {
                let values: Vec<f32> = steps.iter().map(|step| of_steps(*step)).collect();
                self.encode(&Values::Float(&values))
            }
            Values::Rounded(Rounded::Far(values)) => self.encode(&Values::Float(values)),
            Values::Float(values) => {
                split(out, values);
                Ok(Encoding::BYTE_STREAM_SPLIT)
            }
            Values::Whole(values) => {
                let (least, greatest) = self.range.unwrap_or((i32::MAX, i32::MIN));
                let own = values.iter().fold((least, greatest), |(low, high), v| (low.min(*v), high.max(*v)));
                self.range = Some(own);
                delta(out, values);
                Ok(Encoding::DELTA_BINARY_PACKED)
            }
            Values::Flag(values) => {
                flags(out, values);
                Ok(Encoding::PLAIN)
            }
            Values::Double(_) | Values::Word(_) => {
                Err(ParquetError::NYI("pages of doubles and words".to_owned()))
            }
        }
    }

    /// Ends the column: hands its bytes over, with what the file says of them, and is empty again.
    pub(super) fn hand_over(
        &mut self,
        column: ColumnDescPtr,
        append: impl FnOnce(&Pages, ColumnCloseResult) -> Result<(), ParquetError>,
    ) -> Result<(), ParquetError> {
        let mut head = Vec::new();
        let count = std::mem::take(&mut self.words);
        if count > 0 {
            let words: Vec<u8> = (0..count).flat_map(|number| word(number).to_le_bytes()).collect();
            let size = words.len();
            let page = Page::DictionaryPage {
                buf: words.into(),
                num_values: count.into(),
                encoding: Encoding::PLAIN,
                is_sorted: false,
            };
            self.unfolded += put(&mut head, CompressedPage::new(page, size))?;
            self.encodings.push(Encoding::PLAIN);
        }
        let head = Bytes::from(head);
        let pages = Pages { data: Bytes::from(std::mem::take(&mut self.pages)), dictionary: head };
        let compression = match self.has_words() {
            true => Compression::UNCOMPRESSED,
            false => Compression::ZSTD(ZstdLevel::default()),
        };
        let signed = |size: u64| i64::try_from(size).unwrap_or(i64::MAX); // of memory
        let mut metadata = ColumnChunkMetaData::builder(column)
            .set_compression(compression)
            .set_encodings(std::mem::replace(&mut self.encodings, vec![Encoding::RLE]))
            .set_total_compressed_size(signed(pages.len()))
            .set_total_uncompressed_size(signed(self.unfolded as u64))
            .set_num_values(signed(self.rows))
            .set_dictionary_page_offset((!pages.dictionary.is_empty()).then_some(0))
            .set_data_page_offset(signed(pages.dictionary.len() as u64));
        if let Some((least, greatest)) = self.range.take() {
            metadata =
                metadata.set_statistics(Statistics::int32(Some(least), Some(greatest), None, Some(0), false));
        }
        let close = ColumnCloseResult {
            bytes_written: pages.len(),
            rows_written: std::mem::take(&mut self.rows),
            metadata: metadata.build()?,
            bloom_filter: None,
            column_index: None,
            offset_index: None,
        };
        self.unfolded = 0;
        append(&pages, close)?;
        self.pages = Vec::from(pages.data);
        self.pages.clear();
        Ok(())
    }
}

/// Appends a page with its header. Returns its bytes before compression, with the header.
fn put(out: &mut Vec<u8>, page: CompressedPage) -> Result<usize, ParquetError> {
    let mut sink = TrackedWrite::new(out);
    let mut writer = SerializedPageWriter::new(&mut sink);
    let written = writer.write_page(page)?;
    writer.close()?;
    Ok(written.uncompressed_size)
}
