//! Tables in text: the one reader of rows and cells, and the one place that quotes a cell.
//!
//! Cells are parted by commas, semicolons or tabs, and may be quoted (RFC 4180): then they hold separators, quotes and line
//! ends. Or they are parted by blanks, without quotes. Lines end with `\n`, `\r\n` or `\r`; a byte order mark is passed over.
//!
//! Cells without quotes are cut at their separators. Quoted ones are read by `csv-core`, the parser of the crate `csv` (1.4).
//! The reader of `csv` itself is not used: it takes a quote that stays open for closed, and a quote behind a blank for a
//! letter. Its numbers of lines are wrong behind blank lines and `\r\n`, and it does not show comments.

use csv_core::{ReadFieldResult, Reader, ReaderBuilder, Terminator};
use std::borrow::Cow;
use std::slice;

/// Blanks that people write between a separator and a quote.
const BLANKS: [char; 2] = [' ', '\u{a0}'];
/// What a table has where nothing is known.
const UNSAID: [&str; 11] =
    ["", "na", "n/a", "nan", "none", "-", "?", "unknown", "unlabelled", "unlabeled", "prefer not to say"];

/// Whether a cell says that nothing is known.
pub(crate) fn is_unsaid(cell: &str) -> bool {
    UNSAID.iter().any(|word| word.eq_ignore_ascii_case(cell))
}

/// Lower-case words joined by `_`.
pub(crate) fn normalised(cell: &str) -> String {
    let words = cell.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect::<Vec<_>>().join("_")
}

/// A cell as it is written: quoted if it must be.
pub(crate) fn cell(text: &str) -> Cow<'_, str> {
    if text.contains([',', '"', '\n', '\r']) { quoted(text).into() } else { text.into() }
}

/// A cell in quotes, those inside doubled.
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// What parts the cells of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Separator {
    /// A comma, a semicolon or a tab; cells may be quoted.
    Sign(u8),
    /// White space of any length.
    Space,
    /// Commas and white space of any length.
    SpaceOrComma,
}

impl Separator {
    /// The sign that is most frequent in a line outside of quotes, if there is one.
    pub(crate) fn of(line: &str) -> Option<Self> {
        let open = outside_quotes(line);
        let count = |sign: u8| open.bytes().filter(|byte| *byte == sign).count();
        let sign = [b',', b';', b'\t'].into_iter().max_by_key(|&sign| (count(sign), sign == b','));
        sign.filter(|&sign| count(sign) > 0).map(Self::Sign)
    }
}

/// A line without what stands in quotes.
pub(crate) fn outside_quotes(line: &str) -> String {
    line.split('"').step_by(2).collect()
}

/// A quote that nothing closes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a quote is opened and never closed; close it, and write a quote inside of a quoted cell twice")]
pub(crate) struct Unclosed {
    /// Line of the quote, from 1.
    pub(crate) line: usize,
}

/// A row.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Record<'a> {
    /// The line it begins in, from 1.
    pub(crate) line: usize,
    /// Its cells, without quotes and blanks around them.
    pub(crate) cells: Vec<Cow<'a, str>>,
}

impl Record<'_> {
    /// A cell, if the row is that long.
    pub(crate) fn get(&self, column: usize) -> Option<&str> {
        self.cells.get(column).map(AsRef::as_ref)
    }
}

/// A place between two rows, to return to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place<'a> {
    rest: &'a str,
    line: usize,
}

/// The rows of a text, from its start; blank lines are passed over.
///
/// As an iterator it also passes over rows of empty cells, which spreadsheets leave behind.
#[derive(Debug)]
pub(crate) struct Records<'a> {
    /// The text from the next row on. It does not begin with a blank line.
    rest: &'a str,
    /// The line in which `rest` begins.
    line: usize,
    line_end: u8,
    separator: Separator,
    most: usize,
    parser: Reader,
    /// Room for a cell that the parser writes.
    room: Vec<u8>,
}

impl<'a> Records<'a> {
    /// Rows of cells between white space, until [`Self::part_by`] tells otherwise.
    pub(crate) fn new(text: &'a str) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        // Old Macs end lines with a carriage return alone.
        let line_end = if text.contains('\n') { b'\n' } else { b'\r' };
        let mut records = Self {
            rest: text,
            line: 1,
            line_end,
            separator: Separator::Space,
            most: usize::MAX,
            parser: Reader::new(),
            room: Vec::new(),
        };
        records.pass(0);
        records
    }

    /// Rows of a table whose first line names its columns: they tell the separator.
    pub(crate) fn with_header(text: &'a str) -> Self {
        let mut records = Self::new(text);
        records.part_by(Separator::of(records.first_line()).unwrap_or(Separator::Sign(b',')));
        records
    }

    /// Sets what parts the cells of the following rows.
    pub(crate) fn part_by(&mut self, separator: Separator) {
        self.separator = separator;
        if let Separator::Sign(sign) = separator {
            let line_end = Terminator::Any(self.line_end);
            self.parser = ReaderBuilder::new().delimiter(sign).terminator(line_end).build();
        }
    }

    /// Keeps this many cells of each following row, and reads over those behind.
    pub(crate) fn keep(&mut self, most: usize) {
        self.most = most;
    }

    /// Where the next row begins.
    pub(crate) fn place(&self) -> Place<'a> {
        Place { rest: self.rest, line: self.line }
    }

    /// Goes back to a place of the same text.
    pub(crate) fn return_to(&mut self, place: Place<'a>) {
        (self.rest, self.line) = (place.rest, place.line);
    }

    /// The text from the next row on; empty at the end.
    pub(crate) fn rest(&self) -> &'a str {
        self.rest
    }

    /// The line in which the next row begins; empty at the end.
    pub(crate) fn first_line(&self) -> &'a str {
        self.rest.split(char::from(self.line_end)).next().unwrap_or_default()
    }

    /// Takes the next line as it is, such as a comment, with its number.
    pub(crate) fn pass_line(&mut self) -> Option<(usize, &'a str)> {
        let taken = (self.line, self.first_line());
        self.pass(taken.1.len());
        (!taken.1.is_empty()).then_some(taken)
    }

    /// Reads the next row into `record`; false at the end.
    ///
    /// # Errors
    /// When a quote is not closed. No row follows then.
    pub(crate) fn read(&mut self, record: &mut Record<'a>) -> Result<bool, Unclosed> {
        record.cells.clear();
        record.line = self.line;
        let line = self.first_line();
        if line.is_empty() {
            return Ok(false);
        }
        let (cells, most) = (&mut record.cells, self.most);
        match self.separator {
            Separator::Sign(sign) if line.contains('"') => {
                return self.read_quoted(sign, record).map(|()| true);
            }
            Separator::Sign(sign) => {
                cells.extend(line.split(char::from(sign)).take(most).map(|cell| Cow::Borrowed(cell.trim())));
            }
            Separator::Space => cells.extend(line.split_whitespace().take(most).map(Cow::Borrowed)),
            Separator::SpaceOrComma => {
                let words = line.split(|c: char| c.is_whitespace() || c == ',');
                cells.extend(words.filter(|word| !word.is_empty()).take(most).map(Cow::Borrowed));
            }
        }
        self.pass(line.len());
        Ok(true)
    }

    /// Reads a row with quotes, over as many lines as it has.
    fn read_quoted(&mut self, sign: u8, record: &mut Record<'a>) -> Result<(), Unclosed> {
        let (text, line_end) = (self.rest, self.line_end);
        let (mut at, mut is_last) = (0, false);
        while !is_last {
            let rest = &text[at..];
            let bare = rest.trim_start_matches(BLANKS);
            let cell = if bare.starts_with('"') {
                let start = at + rest.len() - bare.len();
                let Some((cell, end, is_end)) = self.quoted_cell(start) else {
                    let line = self.line + self.line_ends(start);
                    self.rest = "";
                    return Err(Unclosed { line });
                };
                (at, is_last) = (end, is_end);
                cell
            } else {
                let length = rest.bytes().position(|byte| byte == sign || byte == line_end);
                let length = length.unwrap_or(rest.len());
                is_last = rest.as_bytes().get(length) != Some(&sign);
                at += length + usize::from(!is_last);
                Cow::Borrowed(rest[..length].trim())
            };
            if record.cells.len() < self.most {
                record.cells.push(cell);
            }
        }
        self.line += self.line_ends(at);
        self.pass(at);
        Ok(())
    }

    /// Parses the quoted cell that begins at a byte of `rest`. Returns it, the byte behind its separator, and whether it ends
    /// the row; `None` if it has no end.
    fn quoted_cell(&mut self, start: usize) -> Option<(Cow<'a, str>, usize, bool)> {
        self.parser.reset();
        let (text, mut at, mut length) = (self.rest, start, 0);
        let is_last = loop {
            let is_over = at == text.len();
            // The text may end without a line end, which the parser needs.
            let input = if is_over { slice::from_ref(&self.line_end) } else { &text.as_bytes()[at..] };
            let (result, read, written) = self.parser.read_field(input, &mut self.room[length..]);
            at += if is_over { 0 } else { read };
            length += written;
            match result {
                ReadFieldResult::Field { record_end } => break record_end,
                ReadFieldResult::OutputFull => self.room.resize((2 * self.room.len()).max(256), 0),
                ReadFieldResult::InputEmpty if is_over => return None,
                ReadFieldResult::InputEmpty => {}
                ReadFieldResult::End => break true,
            }
        };
        let cell = &self.room[..length];
        // What the parser only copied is borrowed.
        let copied = text.get(start + 1..start + 1 + length).filter(|copied| copied.as_bytes() == cell);
        let cell = match copied {
            Some(cell) => Cow::Borrowed(cell.trim()),
            None => Cow::Owned(String::from_utf8_lossy(cell).trim().to_owned()),
        };
        Some((cell, at, is_last))
    }

    /// Line ends in the first bytes of `rest`.
    fn line_ends(&self, bytes: usize) -> usize {
        self.rest.as_bytes()[..bytes].iter().filter(|byte| **byte == self.line_end).count()
    }

    /// Passes over so many bytes, whose lines are counted, and over the line ends and blank lines behind them.
    fn pass(&mut self, bytes: usize) {
        self.rest = &self.rest[bytes..];
        let blank = self.rest.len() - self.rest.trim_start().len();
        let is_over = blank == self.rest.len();
        let lines = self.rest[..blank].rfind(char::from(self.line_end)).map_or(0, |end| end + 1);
        let bytes = if is_over { blank } else { lines };
        self.line += self.line_ends(bytes);
        self.rest = &self.rest[bytes..];
    }
}

impl<'a> Iterator for Records<'a> {
    type Item = Result<Record<'a>, Unclosed>;

    fn next(&mut self) -> Option<Self::Item> {
        let mut record = Record::default();
        loop {
            match self.read(&mut record) {
                Ok(false) => return None,
                Ok(true) if record.cells.iter().all(|cell| cell.is_empty()) => {}
                Ok(true) => return Some(Ok(record)),
                Err(unclosed) => return Some(Err(unclosed)),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines and cells of all rows.
    fn rows(records: Records<'_>) -> Vec<(usize, Vec<String>)> {
        let rows = records.map(|record| record.unwrap());
        rows.map(|row| (row.line, row.cells.into_iter().map(Cow::into_owned).collect())).collect()
    }

    fn row(line: usize, cells: &[&str]) -> (usize, Vec<String>) {
        (line, cells.iter().map(|cell| (*cell).to_owned()).collect())
    }

    #[test]
    fn quoted_cells_hold_separators_quotes_and_line_ends_and_later_rows_keep_their_lines() {
        for end in ["\n", "\r\n", "\r"] {
            let text = [
                "\u{feff}a,\"b, c\", \"d\", e",
                "1, \"x",
                "",
                "\"\"y\"\", z\" ,3\",",
                "",
                ",\"\",,",
                "\"é\",5,6\"\"",
            ];
            let found = rows(Records::with_header(&text.join(end)));
            let lines = format!("x{end}{end}\"y\", z");
            let wanted = [
                row(1, &["a", "b, c", "d", "e"]),
                row(2, &["1", &lines, "3\"", ""]),
                row(7, &["é", "5", "6\"\""]),
            ];
            assert_eq!(found, wanted, "{end:?}");
        }
        assert!(rows(Records::with_header(" \n\t\n")).is_empty());
    }

    #[test]
    fn a_row_is_the_same_with_and_without_needless_quotes() {
        for separator in [',', ';', '\t'] {
            let plain = "a,b b,\r\n 1 ,é,2.5\n\n,x,\u{a0}y\n".replace(',', &separator.to_string());
            let cell = |cell: &str| quoted(cell.trim());
            let line = |line: &str| line.split(separator).map(cell).collect::<Vec<_>>();
            let all: Vec<String> = plain.lines().map(|row| line(row).join(&separator.to_string())).collect();
            assert_eq!(rows(Records::with_header(&all.join("\n"))), rows(Records::with_header(&plain)));
        }
    }

    #[test]
    fn a_quote_that_stays_open_is_an_error_in_its_line_and_ends_the_table() {
        for (text, line) in [
            ("a,b\n1,\"2\n3,4\n", 2),
            ("a,b\n\n\"1\n2\",\"3\n4,5", 4),
            ("a,b\n1,\"2\"\"\n", 2),
            ("a,b\n1,\"", 2),
            ("\"", 1),
        ] {
            let mut records = Records::with_header(text);
            let wrong = records.by_ref().find_map(Result::err);
            assert_eq!(wrong, Some(Unclosed { line }), "{text:?}");
            assert_eq!(records.next(), None, "{text:?}");
        }
        let none = |text: &str| Records::with_header(text).all(|record| record.is_ok());
        assert!(none("a,b\n1,\"2\"") && none("a,5\" pipe\n") && none("a,\"b\"\"\"\r\n"));
    }

    #[test]
    fn the_separator_is_the_most_frequent_sign_outside_of_quotes() {
        let of = |line: &str| Separator::of(line);
        assert_eq!(of("\"a;b;c\",d"), Some(Separator::Sign(b',')));
        assert_eq!(of("\"a, b, c\";d"), Some(Separator::Sign(b';')));
        assert_eq!((of("a\tb"), of("a b"), of("")), (Some(Separator::Sign(b'\t')), None, None));
        assert_eq!(of("a;b,c"), Some(Separator::Sign(b',')));
    }

    #[test]
    fn cells_that_are_not_kept_are_read_over() {
        for text in ["1,2,3,4\n5,6,7\n", "1,2,\"3\",\"\n4\"\n5,6,7\n"] {
            let mut records = Records::with_header(text);
            records.keep(2);
            assert_eq!(
                rows(records).into_iter().map(|row| row.1).collect::<Vec<_>>(),
                [["1", "2"], ["5", "6"]]
            );
        }
    }

    #[test]
    fn what_is_written_is_read_again() {
        let names = ["plain", "a, b", "say \"so\"", "two\nlines", "a\rb", "\"", ",", "x;y"];
        let text: String = names.iter().map(|name| format!("{},{}\n", cell(name), quoted(name))).collect();
        let mut records = Records::new(&text);
        records.part_by(Separator::Sign(b','));
        let wanted: Vec<[&str; 2]> = names.iter().map(|name| [*name; 2]).collect();
        assert_eq!(rows(records).into_iter().map(|row| row.1).collect::<Vec<_>>(), wanted);
        assert_eq!((cell("x;y"), cell("a,b")), ("x;y".into(), "\"a,b\"".into()));
    }
}
