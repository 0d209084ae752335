//! Lets people in.

use super::exact::{dot2, hash_u32};
use super::shared::{grid_cell, on_storey};
use crate::kernels::spawn::{GAP, MOST, Slices, TRIES};

/// Twin of `shaders/spawn.wgsl`.
pub fn spawn(b: Slices<'_>) {
    for source in 0..b.step.source_count {
        let own = b.sources[source as usize];
        if own.entered >= own.agents || own.places == 0 {
            continue;
        }
        let agent = (own.first_agent + own.entered) as usize;
        if b.step.step_index + 1 < b.entry[agent] {
            continue;
        }
        let begin = hash_u32(source ^ hash_u32(b.step.step_index ^ b.step.seed)) % own.places;
        let free = (0..TRIES.min(own.places))
            .map(|t| b.source_places[(own.first_place + (begin + t) % own.places) as usize])
            .find(|place| is_free(&b, *place, b.body[agent].radius, own.widest, b.elevation[agent]));
        if let Some(place) = free {
            b.position[agent] = place;
            b.sources[source as usize].entered = own.entered + 1;
        }
    }
}

/// Whether no agent is too near a place for an agent of that radius and elevation.
fn is_free(b: &Slices<'_>, place: [f32; 2], radius: f32, widest: f32, height: f32) -> bool {
    let step = b.step;
    let meets_user = step.user_radius > 0.0 && on_storey(step, height, step.user_elevation);
    if meets_user && is_near(place, step.user_position, radius + step.user_radius + GAP) {
        return false;
    }
    let reach = radius + widest + GAP;
    let low = grid_cell([place[0] - reach, place[1] - reach], step);
    let high = grid_cell([place[0] + reach, place[1] + reach], step);
    let mut seen = 0;
    for row in low[1] as u32..=high[1] as u32 {
        let cell = |column: i32| (row * step.grid_columns + column as u32) as usize;
        let (first, end) = (b.cell_start[cell(low[0])], b.cell_start[cell(high[0]) + 1]);
        seen += end - first;
        if seen > MOST {
            return false;
        }
        for slot in first as usize..end as usize {
            let other = b.slot_motion[slot];
            if on_storey(step, other.elevation, height)
                && is_near(place, b.slot_position[slot], radius + other.radius + GAP)
            {
                return false;
            }
        }
    }
    true
}

fn is_near(a: [f32; 2], b: [f32; 2], distance: f32) -> bool {
    let to = [b[0] - a[0], b[1] - a[1]];
    dot2(to, to) < distance * distance
}
