//! Interpolates every agent between the last two snapshots.

use super::between::index_of;
use super::exact::{dot2, lesser, wrap};
use crate::kernels::interpolate::{Slices, TURN_LIMIT};
use crate::kernels::layout::Stance;

fn on_the_way(a: f32, b: f32, share: f32) -> f32 {
    if share >= 1.0 { b } else { a + (b - a) * share }
}

/// Twin of `shaders/interpolate.wgsl`.
pub fn interpolate(b: Slices<'_>) {
    for agent in 0..b.between.agent_count as usize {
        let was = b.snapshots[index_of(b.between, 1 - b.between.newest, agent)];
        let now = b.snapshots[index_of(b.between, b.between.newest, agent)];
        let way = [now.position[0] - was.position[0], now.position[1] - was.position[1]];
        let walked = dot2(way, way) <= b.between.reach * b.between.reach
            && (now.heading - was.heading).abs() < TURN_LIMIT;
        let share = if walked { b.between.share } else { 1.0 };

        b.position[agent] = [0, 1].map(|axis| on_the_way(was.position[axis], now.position[axis], share));
        let both = |was: [f32; 2], now: [f32; 2]| [0, 1].map(|i| on_the_way(was[i], now[i], share));
        let turned = wrap(was.heading + wrap(now.heading - was.heading) * share);
        b.heading[agent] = if share >= 1.0 { now.heading } else { turned };
        let strides = ((now.phase.wrapping_sub(was.phase) >> 8) as f32 * lesser(share, 0.999_999_94)) as u32;
        b.stance[agent] = Stance {
            phase: if share >= 1.0 { now.phase } else { was.phase.wrapping_add(strides << 8) },
            walk_weight: on_the_way(was.walk_weight, now.walk_weight, share),
            left: both(was.left, now.left),
            right: both(was.right, now.right),
            turns: both(was.turns, now.turns),
            lean: both(was.lean, now.lean),
            heights: both(was.heights, now.heights),
            slopes: both(was.slopes, now.slopes),
            stride: on_the_way(was.stride, now.stride, share),
            foresight: on_the_way(was.foresight, now.foresight, share),
        };
        b.elevation[agent] = on_the_way(was.elevation, now.elevation, share);
        b.gait_weights[agent] =
            std::array::from_fn(|gait| on_the_way(was.gait_weights[gait], now.gait_weights[gait], share));
    }
}
