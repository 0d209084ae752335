//! Puts the agents in cell order, within a cell by id, and copies what neighbours read of each to its slot.

use super::shared::{cell_index, is_absent};
use crate::kernels::grid_scatter::Slices;
use crate::kernels::layout::SlotMotion;
use crate::kernels::shared::absent::NOBODY;
use crate::kernels::shared::cells::index::{CELL_WORDS, GROUP_CELLS};
use crate::kernels::shared::contents::{STOREYS, UNLIKE, WALLS};
use crate::kernels::shared::step::LED_BIT;
use rayon::prelude::*;

/// Twin of `shaders/grid_scatter.wgsl`.
pub fn grid_scatter(mut b: Slices<'_>) {
    let (agents, cells) = (b.step.agent_count as usize, b.step.cell_count as usize);
    let (cell_start, agent_slot) = (std::mem::take(&mut b.cell_start), std::mem::take(&mut b.agent_slot));
    let (positions, motions) = (std::mem::take(&mut b.slot_position), std::mem::take(&mut b.slot_motion));
    let b = &b;
    let (starts, in_groups) = cell_start.split_at_mut(cells + 1);
    let start_of = |cell: usize| b.cells[CELL_WORDS * cell] + in_groups[cell / GROUP_CELLS];
    let slots = agent_slot[..agents].par_iter_mut().enumerate().with_min_len(1024);
    slots.for_each(|(agent, slot)| {
        *slot = NOBODY;
        if !is_absent(b.position[agent]) {
            let cell = cell_index(b.position[agent], b.step);
            *slot = start_of(cell) + lower_ids(b, cell, agent as u32);
        }
    });
    starts[..cells].iter_mut().enumerate().for_each(|(cell, start)| *start = start_of(cell));

    let mut in_order = vec![NOBODY; agents];
    for (agent, slot) in agent_slot[..agents].iter().enumerate().filter(|(_, slot)| **slot != NOBODY) {
        in_order[*slot as usize] = agent as u32;
    }
    let slots = positions.par_iter_mut().zip(motions).zip(in_order).with_min_len(1024);
    slots.for_each(|((position, motion), agent)| {
        if agent == NOBODY {
            *motion = SlotMotion { agent, ..SlotMotion::default() };
        } else {
            *position = b.position[agent as usize];
            *motion = motion_of(b, agent as usize);
        }
    });
}

/// How many agents of a cell have a lower id.
fn lower_ids(b: &Slices<'_>, cell: usize, agent: u32) -> u32 {
    let (mut lower, mut other) = (0, b.cells[CELL_WORDS * cell + 1]);
    while other > 0 {
        lower += u32::from(other <= agent); // other is an id plus 1
        other = b.next_in_cell[other as usize - 1];
    }
    lower
}

/// What others read of an agent.
fn motion_of(b: &Slices<'_>, agent: usize) -> SlotMotion {
    let own = b.avoidance[if b.contents & UNLIKE == 0 { 0 } else { agent }];
    let comfort = if own.is_led() { own.inverse_time_horizon } else { 0.0 };
    SlotMotion {
        velocity: b.velocity[agent],
        radius: b.body[agent].radius + comfort,
        max_speed: b.body[agent].max_speed,
        priority: own.priority,
        elevation: if b.contents & (STOREYS | WALLS) == 0 { 0.0 } else { b.elevation[agent] },
        agent: agent as u32,
        limits: own.neighbour_cap as u32 | if own.is_led() { LED_BIT } else { 0 },
    }
}
