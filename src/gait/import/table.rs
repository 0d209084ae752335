//! Tables that people write: CSV with a header, in any of the forms that spreadsheets save.
//!
//! Separated by commas, semicolons or tabs, with or without a byte order mark; cells may be quoted (RFC 4180) and then
//! hold separators and line ends. The index files beside motion files and the sheets of raters are read by this.

/// What a table has where nothing is known.
const UNSAID: [&str; 11] =
    ["", "na", "n/a", "nan", "none", "-", "?", "unknown", "unlabelled", "unlabeled", "prefer not to say"];

/// Whether a cell says that nothing is known.
pub(crate) fn is_unsaid(cell: &str) -> bool {
    UNSAID.iter().any(|word| word.eq_ignore_ascii_case(cell))
}

/// A row that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Broken {
    /// Line, from 1.
    pub(crate) line: usize,
    /// What is wrong.
    pub(crate) message: String,
}

/// Lower-case words joined by `_`.
pub(crate) fn normalised(cell: &str) -> String {
    let words = cell.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect::<Vec<_>>().join("_")
}

/// A row and the line it begins in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Record {
    pub(crate) line: usize,
    pub(crate) cells: Vec<String>,
}

/// The rows of a CSV text; blank lines are passed over.
pub(crate) struct Records<'a> {
    rest: &'a str,
    line: usize,
    separator: char,
}

impl<'a> Records<'a> {
    pub(crate) fn new(text: &'a str) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let first = text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
        let count = |separator: char| first.matches(separator).count();
        let separator = [',', ';', '\t'].into_iter().max_by_key(|&s| (count(s), s == ',')).unwrap_or(',');
        Self { rest: text, line: 1, separator }
    }

    /// One cell; what follows it stays in `rest`, beginning with the separator or the line's end.
    fn cell(&mut self) -> Result<String, ()> {
        let start = self.rest.trim_start_matches([' ', '\u{a0}']);
        let Some(mut inner) = start.strip_prefix('"') else {
            let end = self.rest.find([self.separator, '\n', '\r']).unwrap_or(self.rest.len());
            let (cell, rest) = self.rest.split_at(end);
            self.rest = rest;
            return Ok(cell.trim().to_owned());
        };
        let mut text = String::new();
        loop {
            let end = inner.find('"').ok_or(())?;
            text.push_str(&inner[..end]);
            inner = &inner[end + 1..];
            let Some(rest) = inner.strip_prefix('"') else { break };
            text.push('"');
            inner = rest;
        }
        self.line += text.matches('\n').count();
        // Between the closing quote and the separator there should be nothing; if there is, it belongs to the cell.
        let end = inner.find([self.separator, '\n', '\r']).unwrap_or(inner.len());
        text.push_str(&inner[..end]);
        self.rest = &inner[end..];
        Ok(text.trim().to_owned())
    }
}

impl Iterator for Records<'_> {
    type Item = Result<Record, Broken>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.rest.is_empty() {
            let line = self.line;
            let mut cells = Vec::new();
            loop {
                let Ok(cell) = self.cell() else {
                    self.rest = "";
                    let message = "a quote is opened and never closed".to_owned();
                    return Some(Err(Broken { line, message }));
                };
                cells.push(cell);
                match self.rest.strip_prefix(self.separator) {
                    Some(rest) => self.rest = rest,
                    None => break,
                }
            }
            let rest = self.rest.strip_prefix('\r').unwrap_or(self.rest);
            self.rest = rest.strip_prefix('\n').unwrap_or(rest);
            self.line += 1;
            if cells.iter().any(|cell| !cell.is_empty()) {
                return Some(Ok(Record { line, cells }));
            }
        }
        None
    }
}
