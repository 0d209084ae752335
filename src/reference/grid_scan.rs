//! Exclusive prefix sum of the cell counts.

use crate::kernels::grid_scan::Slices;
use crate::kernels::shared::scan::index::LANES;

/// Cells of each group.
fn groups(cells: u32) -> impl ExactSizeIterator<Item = std::ops::Range<usize>> {
    let cells = cells as usize;
    (0..cells.div_ceil(LANES)).map(move |group| group * LANES..((group + 1) * LANES).min(cells))
}

/// Twin of phase `sum` of `shaders/grid_scan.wgsl`.
pub fn grid_scan_sum(b: Slices<'_>) {
    for (group, cells) in groups(b.step.cell_count).enumerate() {
        b.group_sums[group] = b.cell_counts[cells].iter().sum();
    }
}

/// Twin of phase `groups` of `shaders/grid_scan.wgsl`.
pub fn grid_scan_groups(b: Slices<'_>) {
    let mut total = 0;
    for group in 0..groups(b.step.cell_count).len() {
        let sum = b.group_sums[group];
        b.group_sums[group] = total;
        total += sum;
    }
    b.cell_start[b.step.cell_count as usize] = total;
    b.unsolved[..4].copy_from_slice(&[0, 1, 1, 0]);
}

/// Twin of phase `cells` of `shaders/grid_scan.wgsl`.
pub fn grid_scan_cells(b: Slices<'_>) {
    for (group, cells) in groups(b.step.cell_count).enumerate() {
        let mut sum = b.group_sums[group];
        for cell in cells {
            b.cell_start[cell] = sum;
            sum += b.cell_counts[cell];
            b.cell_counts[cell] = 0;
        }
    }
}
