//! Rows of a design, handed out so that each is used equally often: fill with m = 1.
//!
//! A new participant gets the row of least c = finished + leased. Of several it is the first in the order of the cycle, whose
//! number is that least c. Without lapses the orders of the cycles follow one another unchanged, and rows never differ by more
//! than one; a lapsed row is handed out next.

use std::ops::Range;

/// How often each row was handed out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rows {
    finished: Vec<u32>,
    leased: Vec<u32>,
}

impl Rows {
    /// Rows that no participant has.
    pub fn new(rows: usize) -> Self {
        Self { finished: vec![0; rows], leased: vec![0; rows] }
    }

    /// Finished and leased together, by row.
    pub fn counts(&self) -> Vec<u32> {
        self.finished.iter().zip(&self.leased).map(|(a, b)| a + b).collect()
    }

    /// Greatest count minus least count; 0 without rows.
    pub fn gap(&self) -> u32 {
        let counts = self.counts();
        counts.iter().max().unwrap_or(&0) - counts.iter().min().unwrap_or(&0)
    }

    /// Number of rows.
    pub fn count(&self) -> usize {
        self.finished.len()
    }

    /// The row of a new participant, of those in `among` if it is given; `order` gives the order of rows in a cycle. None
    /// without rows.
    pub fn admit(&mut self, among: Option<&Range<u32>>, order: impl Fn(u32) -> Vec<usize>) -> Option<usize> {
        let counts = self.counts();
        let (from, to) = among.map_or((0, counts.len()), |rows| (rows.start as usize, rows.end as usize));
        let least = *counts.get(from..to.min(counts.len()))?.iter().min()?;
        let row = order(least)
            .into_iter()
            .find(|&row| (from..to).contains(&row) && counts.get(row) == Some(&least))?;
        self.leased[row] += 1;
        Some(row)
    }

    /// The row's trials are all answered.
    pub fn finish(&mut self, row: usize) {
        self.lapse(row);
        self.finished[row] += 1;
    }

    /// The row's lease lapses.
    pub fn lapse(&mut self, row: usize) {
        self.leased[row] = self.leased[row].saturating_sub(1);
    }

    /// The row's participant is back.
    pub fn lease_again(&mut self, row: usize) {
        self.leased[row] += 1;
    }

    /// The row's trials were all answered after its lease had lapsed: they are kept.
    pub fn finish_late(&mut self, row: usize) {
        self.finished[row] += 1;
    }

    /// The answers of a finished row are deleted, since its participant withdrew.
    pub fn delete(&mut self, row: usize) {
        self.finished[row] = self.finished[row].saturating_sub(1);
    }
}
