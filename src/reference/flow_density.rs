//! What a metre costs on each cell of the flow grid.

use super::elevate::standing;
use super::shared::is_absent;
use super::way::{first_row, with_step};
use crate::kernels::flow_density::Slices;
use crate::kernels::shared::floors::index::FLOOR_STRIDE;
use crate::kernels::shared::way::SOLID;
use rayon::prelude::*;

/// Twin of phase `clear` of `shaders/flow_density.wgsl`.
pub fn flow_density_clear(b: Slices<'_>) {
    b.flow_counts[..b.flow_grid.cell_count as usize].fill(0);
}

/// Twin of phase `count` of `shaders/flow_density.wgsl`.
pub fn flow_density_count(b: Slices<'_>) {
    let grid = b.flow_grid;
    let floors = &b.floors[..b.step.floor_count as usize * FLOOR_STRIDE];
    let agents = b.position[..b.step.agent_count as usize].iter().enumerate();
    for (agent, at) in agents.filter(|(_, at)| !is_absent(**at)) {
        let [x, z] = [0, 1].map(|axis| (at[axis] - grid.origin[axis]) * grid.inverse_cell_size);
        if x >= 0.0 && z >= 0.0 && x < grid.columns as f32 && z < grid.sheet_rows as f32 {
            let mut first = 0;
            if grid.sheet_rows < grid.rows {
                first = first_row(grid, standing(floors, *at, b.elevation[agent]).sheet as u32) as usize;
            }
            b.flow_counts[(first + z as usize) * grid.columns as usize + x as usize] += 1;
        }
    }
}

/// Twin of phase `rows` of `shaders/flow_density.wgsl`.
pub fn flow_density_rows(b: Slices<'_>) {
    let (columns, window) = (b.flow_grid.columns as usize, b.flow_grid.window as usize);
    let (counts, sums) = (&*b.flow_counts, &mut b.flow_sums[..b.flow_grid.cell_count as usize]);
    sums.par_iter_mut().enumerate().with_min_len(4096).for_each(|(cell, sum)| {
        let (column, row) = (cell % columns, cell / columns);
        let low = column.saturating_sub(window);
        let high = (column + window).min(columns - 1);
        *sum = counts[row * columns + low..=row * columns + high].iter().sum();
    });
}

/// Twin of phase `cost` of `shaders/flow_density.wgsl`.
pub fn flow_density_cost(b: Slices<'_>) {
    let grid = b.flow_grid;
    let (columns, rows, window) = (grid.columns as usize, grid.rows as usize, grid.window as usize);
    let (sums, cells) = (&*b.flow_sums, &mut b.flow_cells[..grid.cell_count as usize]);
    cells.par_iter_mut().enumerate().with_min_len(4096).for_each(|(cell, word)| {
        let (column, row) = (cell % columns, cell / columns);
        let (low, high) = (row.saturating_sub(window), (row + window).min(rows - 1));
        let sum: u32 = (low..=high).map(|z| sums[z * columns + column]).sum();
        let mut size = grid.solid_step;
        if *word & SOLID == 0 {
            let density = sum as f32 / b.flow_room[cell];
            size = grid.cell_size * (1.0 + grid.density_weight * density);
        }
        *word = with_step(*word, size);
    });
}
