//! Exclusive prefix sum of the cell counts.

use crate::kernels::grid_scan::Slices;
use crate::kernels::shared::dispatch::index::RUN;

/// Twin of `shaders/grid_scan.wgsl`.
pub fn grid_scan(b: Slices<'_>) {
    let cells = b.step.cell_count as usize;
    let runs = cells.div_ceil(RUN);
    if b.level == 1 {
        let mut total = 0;
        for run in 0..runs {
            let sum = b.run_sums[run];
            b.run_sums[run] = total;
            total += sum;
        }
        b.cell_start[cells] = total;
        b.unsolved[..4].copy_from_slice(&[0, 1, 1, 0]);
        return;
    }
    for run in 0..runs {
        let (first, last) = (run * RUN, ((run + 1) * RUN).min(cells));
        if b.level == 0 {
            b.run_sums[run] = b.cell_counts[first..last].iter().sum();
        } else {
            let mut sum = b.run_sums[run];
            for cell in first..last {
                b.cell_start[cell] = sum;
                sum += b.cell_counts[cell];
                b.cell_counts[cell] = 0;
            }
        }
    }
}
