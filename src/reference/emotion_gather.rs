//! Sums what each agent hears, for its feelings.

use super::exact::{dot2, lesser};
use super::shared::grid_cell;
use crate::kernels::emotion_gather::{MOST_HEARD, MOST_TURNS, ROWS_BETWEEN, SHARE, Slices};
use crate::kernels::layout::Heard;
use rayon::prelude::*;

/// Twin of `shaders/emotion_gather.wgsl`.
pub fn emotion_gather(mut b: Slices<'_>) {
    let heard = std::mem::take(&mut b.heard);
    let b = &b;
    let has_turn = |slot: &usize| {
        let row = grid_cell(b.slot_position[*slot], b.step)[1] as u32;
        b.step.step_index == 0 || (row + b.step.step_index).is_multiple_of(ROWS_BETWEEN)
    };
    let present = b.cell_start[b.step.cell_count as usize] as usize;
    let slots: Vec<usize> = (0..present).filter(has_turn).collect();
    let all: Vec<Heard> = slots.par_iter().with_min_len(64).map(|&slot| of_all(sums(b, slot))).collect();
    for (slot, found) in slots.into_iter().zip(all) {
        heard[b.slot_motion[slot].agent as usize] = found;
    }
}

/// How strongly all are heard together, and their mean feelings.
fn of_all([voices, happy, angry, sad]: [u32; 4]) -> Heard {
    if voices == 0 {
        return Heard::default();
    }
    let voices = total(voices);
    let mean = |sum: u32| lesser(total(sum) / voices, 1.0);
    Heard { strength: voices / SHARE, happy: mean(happy), angry: mean(angry), sad: mean(sad) }
}

fn total(sum: u32) -> f32 {
    (sum >> 8) as f32 * 256.0 + (sum & 255) as f32
}

fn sums(b: &Slices<'_>, slot: usize) -> [u32; 4] {
    let (step, reach) = (b.step, b.mood.radius);
    let ([x, y], elevation) = (b.slot_position[slot], b.slot_motion[slot].elevation);
    let agent = b.slot_motion[slot].agent as usize;
    let mut sums = [0_u32; 4];
    if !(reach > 0.0 && b.temperament[agent].openness > 0.0) {
        return sums;
    }
    let low = grid_cell([x - reach, y - reach], step);
    let high = grid_cell([x + reach, y + reach], step);
    let (mut count, mut turns) = (0, 0);
    for row in low[1]..=high[1] {
        let first = row * step.grid_columns as i32;
        let end = b.cell_start[(first + high[0] + 1) as usize] as usize;
        for other in b.cell_start[(first + low[0]) as usize] as usize..end {
            if turns >= MOST_TURNS {
                break;
            }
            turns += 1;
            let [their_x, their_y] = b.slot_position[other];
            let to = [their_x - x, their_y - y];
            let distance2 = dot2(to, to);
            if !(distance2 < reach * reach) || other == slot || count >= MOST_HEARD {
                continue;
            }
            let apart = (b.slot_motion[other].elevation - elevation).abs();
            if step.storey_height > 0.0 && apart >= step.storey_height {
                continue;
            }
            count += 1;
            let speaker = b.slot_motion[other].agent as usize;
            let voice = b.temperament[speaker].expressiveness * (1.0 - distance2.sqrt() / reach);
            let [happy, angry, sad, _] = b.feeling[speaker];
            let added = [voice, voice * happy, voice * angry, voice * sad];
            for (sum, share) in sums.iter_mut().zip(added) {
                *sum = sum.wrapping_add((share * SHARE + 0.5) as u32);
            }
        }
    }
    sums
}
