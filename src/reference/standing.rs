//! Twin of `shaders/shared/standing.wgsl`: how much and in which emotions people stand, and what is an agent's own.

use super::exact::hash_u32;
use super::quaternion::limit;
use crate::kernels::shared::standing::{FEET, STANCE_AHEAD, STANCES};

/// Which places of the feet are an agent's: side by side, left ahead, right ahead.
pub fn stance_of(agent: u32) -> u32 {
    own_draw(agent, FEET, 0) % STANCES
}

/// How far the left foot is ahead in a stance, and the right one behind, in lengths of the leg.
pub fn left_ahead(stance: u32) -> f32 {
    match stance {
        1 => STANCE_AHEAD,
        2 => -STANCE_AHEAD,
        _ => 0.0,
    }
}

/// How much an agent walks, 0 to 1.
pub fn walk_share([x, y, z, w]: [f32; 4], walk_weight: f32) -> f32 {
    let sum = x + y + z + w;
    if sum > 1e-6 { limit(walk_weight, 0.0, 1.0) } else { 0.0 }
}

/// Shares of the emotions in which it stands.
pub fn moods_of([x, y, z, w]: [f32; 4], shown: u32) -> [f32; 4] {
    if y == 0.0 && z == 0.0 && w == 0.0 {
        return [shown == 0, shown == 1, shown == 2, shown > 2].map(|is_it| if is_it { 1.0 } else { 0.0 });
    }
    let sum = x + y + z + w;
    [x, y, z, w].map(|weight| weight / sum)
}

/// What an agent draws for a purpose; `number` counts the draws.
pub fn own_draw(agent: u32, purpose: u32, number: u32) -> u32 {
    hash_u32(agent ^ hash_u32(purpose ^ hash_u32(number)))
}

/// From 0 to 1, with no speed at either end.
pub fn eased(x: f32) -> f32 {
    x * x * (3.0 - 2.0 * x)
}
