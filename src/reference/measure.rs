//! Measures the crowd after a step.

use super::exact::{det2, dot2, greater, lesser};
use super::shared::{cell_index, grid_cell, is_absent, on_storey, step_word};
use crate::kernels::layout::Seen;
use crate::kernels::measure::index::MEASURED_STEPS;
use crate::kernels::measure::{NEAR, OVERLAP, Slices};
use crate::kernels::shared::absent::NOBODY;
use crate::kernels::shared::orca::RAISED;
use rayon::prelude::*;

/// What one agent adds.
#[derive(Clone, Copy)]
struct Found {
    /// Least gap to another of a higher slot, m, or the least that was known before.
    least: f32,
    overlapping: u32,
    outside: u32,
}

/// Twin of `shaders/measure.wgsl`.
pub fn measure(mut b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    let seen = std::mem::take(&mut b.seen);
    let measured = std::mem::take(&mut b.measured);
    let b = &b;
    seen[..agents]
        .par_iter_mut()
        .enumerate()
        .with_min_len(1024)
        .for_each(|(agent, seen)| see(b, agent, seen));

    let known = if measured[0] < in_order(NEAR) { from_order(measured[0]) } else { NEAR };
    let none = Found { least: known, overlapping: 0, outside: 0 };
    let both = |a: Found, b: Found| Found {
        least: lesser(a.least, b.least),
        overlapping: a.overlapping + b.overlapping,
        outside: a.outside + b.outside,
    };
    let slots = b.slot_motion[..agents].par_iter().enumerate().with_min_len(256);
    let there = slots.filter(|(_, own)| own.agent != NOBODY && !is_absent(b.position[own.agent as usize]));
    let all = there.map(|(slot, own)| {
        let agent = own.agent as usize;
        let is_out = b.step.obstacle_count > 0 && is_outside(b, b.position[agent]);
        Found { outside: u32::from(is_out), ..pairs(b, slot, agent, none) }
    });
    let found = all.reduce(|| none, both);
    let number = b.cell_start[step_word(b.step)] as usize % MEASURED_STEPS;
    if found.least < NEAR {
        measured[0] = in_order(found.least);
    }
    measured[1 + number] += found.overlapping;
    measured[1 + MEASURED_STEPS + number] += found.outside;
}

/// Notes whether an agent is there, and how fast it walks.
fn see(b: &Slices<'_>, agent: usize, own: &mut Seen) {
    if is_absent(b.position[agent]) {
        if own.is_there == 1 {
            own.gone = b.cell_start[step_word(b.step)] + 1;
        }
        own.is_there = 0;
    } else {
        let v = b.velocity[agent];
        let speed_sum = own.speed_sum + dot2(v, v).sqrt();
        *own = Seen { speed_sum, steps: own.steps.wrapping_add(1), is_there: 1, gone: 0 };
    }
}

/// The overlaps of an agent with those of higher slots, and the gaps below the least so far, but for others that are faster
/// than any may be.
fn pairs(b: &Slices<'_>, slot: usize, agent: usize, mut found: Found) -> Found {
    let ([x, y], radius) = (b.position[agent], b.body[agent].radius);
    let way = b.step.fastest * b.step.time_step;
    let reach = radius + b.step.widest_radius + greater(found.least, 0.0) + way;
    let low = grid_cell([x - reach, y - reach], b.step);
    let high = grid_cell([x + reach, y + reach], b.step);
    for row in low[1]..=high[1] {
        let first = row * b.step.grid_columns as i32;
        let end = b.cell_start[(first + high[0] + 1) as usize] as usize;
        for other in (b.cell_start[(first + low[0]) as usize] as usize).max(slot + 1)..end {
            let start = [b.slot_position[other][0] - x, b.slot_position[other][1] - y];
            if dot2(start, start) > reach * reach {
                continue;
            }
            let them = b.slot_motion[other].agent as usize;
            let to = [b.position[them][0] - x, b.position[them][1] - y];
            let distance = dot2(to, to).sqrt();
            let sum = radius + b.body[them].radius;
            let gap = distance - sum;
            let farthest = sum + greater(gap, 0.0) + way;
            if dot2(start, start) <= farthest * farthest
                && on_storey(b.step, b.elevation[agent], b.elevation[them])
            {
                found.least = lesser(found.least, gap);
                found.overlapping += u32::from(distance < OVERLAP * sum);
            }
        }
    }
    found
}

/// Bits that are in the order of the numbers.
pub fn in_order(number: f32) -> u32 {
    let bits = number.to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 0x8000_0000 }
}

/// The number of such bits.
pub fn from_order(bits: u32) -> f32 {
    f32::from_bits(if bits >> 31 == 1 { bits & 0x7fff_ffff } else { !bits })
}

/// Whether a point lies in something solid.
fn is_outside(b: &Slices<'_>, at: [f32; 2]) -> bool {
    let (step, cell) = (b.step, cell_index(at, b.step));
    let (column, row) = (cell as u32 % step.grid_columns, cell as u32 / step.grid_columns);
    let [left, below] = step.grid_origin;
    let middle = [left + (column as f32 + 0.5) * step.cell_size, below + (row as f32 + 0.5) * step.cell_size];
    let from = |a: [f32; 2], b: [f32; 2]| [b[0] - a[0], b[1] - a[1]];
    let way = from(middle, at);
    let mut depth = b.cell_depth[cell];
    for &number in &b.obstacle_cells[b.obstacle_cells[cell] as usize..b.obstacle_cells[cell + 1] as usize] {
        let wall = b.obstacles[number as usize];
        let is_left = |corner: [f32; 2]| det2(way, from(middle, corner)) > 0.0;
        if is_left(wall.a) != is_left(wall.b) && wall.corners[0].abs() < 0.5 * RAISED {
            let ab = from(wall.a, wall.b);
            let is_solid = |point: [f32; 2]| i32::from(det2(ab, from(wall.a, point)) > 0.0);
            depth += is_solid(at) - is_solid(middle);
        }
    }
    depth > 0
}
