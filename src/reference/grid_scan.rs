//! Where each cell's agents begin among all.

use super::shared::step_word;
use crate::kernels::grid_scan::Slices;
use crate::kernels::shared::cells::index::{CELL_WORDS, GROUP_CELLS};
use crate::kernels::shared::unsolved::index::LISTED;

/// Twin of `shaders/grid_scan.wgsl`.
pub fn grid_scan(b: Slices<'_>) {
    let cell_count = b.step.cell_count as usize;
    b.cell_start[step_word(b.step)] = b.step.step_index;
    let (starts, rest) = b.cell_start.split_at_mut(cell_count + 1);
    let (in_group, in_groups) = rest.split_at_mut(cell_count);
    let cells = b.cells[..CELL_WORDS * cell_count].chunks(CELL_WORDS * GROUP_CELLS);
    let mut total = 0;
    for ((cells, in_group), before) in cells.zip(in_group.chunks_mut(GROUP_CELLS)).zip(in_groups) {
        *before = total;
        let mut agents = 0;
        for (cell, before) in cells.chunks_exact(CELL_WORDS).zip(in_group) {
            *before = agents;
            agents += cell[0];
        }
        total += agents;
    }
    starts[cell_count] = total;
    b.unsolved[..LISTED].copy_from_slice(&[0, 1, 1, 0, 0]);
}
