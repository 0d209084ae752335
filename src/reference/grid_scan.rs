//! Exclusive prefix sum of the cell counts.

use crate::kernels::grid_scan::Slices;
use crate::kernels::shared::dispatch::index::RUN;

/// Cells of each run.
fn runs(cells: u32) -> impl ExactSizeIterator<Item = std::ops::Range<usize>> {
    let cells = cells as usize;
    (0..cells.div_ceil(RUN)).map(move |run| run * RUN..((run + 1) * RUN).min(cells))
}

/// Twin of phase `sum` of `shaders/grid_scan.wgsl`.
pub fn grid_scan_sum(b: Slices<'_>) {
    for (run, cells) in runs(b.step.cell_count).enumerate() {
        b.run_sums[run] = b.cell_counts[cells].iter().sum();
    }
}

/// Twin of phase `runs` of `shaders/grid_scan.wgsl`.
pub fn grid_scan_runs(b: Slices<'_>) {
    let mut total = 0;
    for run in 0..runs(b.step.cell_count).len() {
        let sum = b.run_sums[run];
        b.run_sums[run] = total;
        total += sum;
    }
    b.cell_start[b.step.cell_count as usize] = total;
    b.unsolved[..4].copy_from_slice(&[0, 1, 1, 0]);
}

/// Twin of phase `cells` of `shaders/grid_scan.wgsl`.
pub fn grid_scan_cells(b: Slices<'_>) {
    for (run, cells) in runs(b.step.cell_count).enumerate() {
        let mut sum = b.run_sums[run];
        for cell in cells {
            b.cell_start[cell] = sum;
            sum += b.cell_counts[cell];
            b.cell_counts[cell] = 0;
        }
    }
}
