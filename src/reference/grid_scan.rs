//! Where each cell's agents begin among all.

use super::shared::step_word;
use crate::kernels::grid_scan::Slices;
use crate::kernels::shared::cells::index::{CELL_WORDS, GROUP_CELLS};
use crate::kernels::shared::unsolved::index::LISTED;

/// Twin of `shaders/grid_scan.wgsl`.
pub fn grid_scan(b: Slices<'_>) {
    let cell_count = b.step.cell_count as usize;
    b.cell_start[step_word(b.step)] = b.step.step_index;
    let (starts, in_groups) = b.cell_start.split_at_mut(cell_count + 1);
    let cells = b.cells[..CELL_WORDS * cell_count].chunks_mut(CELL_WORDS * GROUP_CELLS);
    let mut total = 0;
    for (cells, before) in cells.zip(in_groups) {
        *before = total;
        let mut agents = 0;
        for cell in cells.chunks_exact_mut(CELL_WORDS) {
            agents += std::mem::replace(&mut cell[0], agents);
        }
        total += agents;
    }
    starts[cell_count] = total;
    b.unsolved[..LISTED].copy_from_slice(&[0, 1, 1, 0, 0]);
}
