//! What keeps a statistic from being computed.

/// A statistic could not be computed. Each message states what was wrong, where, the value and the allowed range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Less data than the formula needs.
    #[error("{what}: {found} found, at least {least} needed")]
    TooFew {
        /// What is counted.
        what: &'static str,
        /// The count found.
        found: usize,
        /// The least count that suffices.
        least: usize,
    },
    /// More data than the method can work through.
    #[error("{what}: {found} found, at most {most} allowed")]
    TooMany {
        /// What is counted.
        what: &'static str,
        /// The count found.
        found: usize,
        /// The greatest count allowed.
        most: usize,
    },
    /// A number outside its range.
    #[error("{what} {value} lies outside {range}")]
    Range {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The allowed range, as an interval or a list.
        range: &'static str,
    },
    /// A number that is infinite or NaN.
    #[error("{what} {place} is {value}, a finite number is needed")]
    NotFinite {
        /// The quantity.
        what: &'static str,
        /// Its index in the slice given.
        place: usize,
        /// Its value.
        value: f64,
    },
    /// Rows of different lengths.
    #[error("row {row} of {what} has {found} columns, {expected} expected")]
    Ragged {
        /// The table.
        what: &'static str,
        /// Index of the first row of another length.
        row: usize,
        /// Its length.
        found: usize,
        /// The length of row 0, or of a square table's side.
        expected: usize,
    },
    /// Data without the variation that the statistic divides by.
    #[error("{what} do not vary, so {statistic} is undefined")]
    Constant {
        /// The data.
        what: &'static str,
        /// The statistic.
        statistic: &'static str,
    },
}

/// Fails unless `count` reaches `least`.
pub(super) const fn at_least(what: &'static str, found: usize, least: usize) -> Result<(), Error> {
    if found < least { Err(Error::TooFew { what, found, least }) } else { Ok(()) }
}

/// Fails unless all numbers are finite.
pub(super) fn finite(what: &'static str, values: &[f64]) -> Result<(), Error> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(place) => Err(Error::NotFinite { what, place, value: values[place] }),
        None => Ok(()),
    }
}

/// Fails unless `value` lies strictly between 0 and 1.
pub(super) fn inside_unit(what: &'static str, value: f64) -> Result<(), Error> {
    if value > 0.0 && value < 1.0 { Ok(()) } else { Err(Error::Range { what, value, range: "(0, 1)" }) }
}

/// Fails unless all rows have one length; returns it.
pub(super) fn columns<T, R: AsRef<[T]>>(what: &'static str, rows: &[R]) -> Result<usize, Error> {
    let expected = rows.first().map_or(0, |row| row.as_ref().len());
    match rows.iter().position(|row| row.as_ref().len() != expected) {
        Some(row) => Err(Error::Ragged { what, row, found: rows[row].as_ref().len(), expected }),
        None => Ok(expected),
    }
}
