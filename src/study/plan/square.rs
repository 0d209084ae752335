//! Square: all stimuli of a part, in the orders of a Williams square; row = place mod n.

use super::williams;

/// The orders of some stimuli.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Square {
    rows: Vec<Vec<usize>>,
}

impl Square {
    /// The orders of `items` stimuli, a number within [`williams::SIZES`].
    pub fn new(items: usize) -> Self {
        Self { rows: williams::rows(items) }
    }

    /// Number of rows: balance needs a multiple of it.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// The stimuli of a row in order; empty for a row that is not there.
    pub fn items(&self, row: usize) -> &[usize] {
        self.rows.get(row).map_or(&[], Vec::as_slice)
    }

    /// The order in which the rows of a cycle are handed out: their own, so that without lapses the row is place mod n.
    pub fn cycle(&self) -> Vec<usize> {
        (0..self.rows.len()).collect()
    }
}
