//! A table of a dataset.

use crate::table::cell;

/// A table with its columns.
pub(super) struct Sheet {
    /// Name of its file.
    pub(super) file: String,
    /// What a row is.
    pub(super) row: &'static str,
    /// Names of the columns.
    pub(super) columns: Vec<&'static str>,
    /// Cells, one a column.
    pub(super) rows: Vec<Vec<String>>,
}

impl Sheet {
    /// A table without the columns that are empty in every row, but for those in `always`.
    pub(super) fn new(
        (file, row): (String, &'static str),
        columns: &[&'static str],
        always: &[&str],
        rows: Vec<Vec<String>>,
    ) -> Self {
        let is_kept = |index: usize| {
            always.contains(&columns[index])
                || rows.iter().any(|row| row.get(index).is_some_and(|cell| !cell.is_empty()))
        };
        let kept: Vec<usize> = (0..columns.len()).filter(|&index| is_kept(index)).collect();
        let choose = |row: Vec<String>| kept.iter().filter_map(|&index| row.get(index).cloned()).collect();
        Self {
            file,
            row,
            columns: kept.iter().map(|&index| columns[index]).collect(),
            rows: rows.into_iter().map(choose).collect(),
        }
    }

    /// The table as CSV.
    pub(super) fn csv(&self) -> String {
        let line = |cells: Vec<&str>| cells.into_iter().map(cell).collect::<Vec<_>>().join(",") + "\n";
        let rows = self.rows.iter().map(|row| line(row.iter().map(String::as_str).collect()));
        line(self.columns.clone()) + &rows.collect::<String>()
    }
}
