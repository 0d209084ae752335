//! Puts everyone where they are between the last two snapshots.

use super::between::moment_start;
use super::exact::{dot2, wrap};
use crate::kernels::interpolate::{Slices, TURN_LIMIT};

fn on_the_way(a: f32, b: f32, share: f32) -> f32 {
    if share >= 1.0 { b } else { a + (b - a) * share }
}

/// Twin of `shaders/interpolate.wgsl`.
pub fn interpolate(b: Slices<'_>) {
    for agent in 0..b.between.agent_count as usize {
        let old = moment_start(b.between, 1 - b.between.newest, agent);
        let new = moment_start(b.between, b.between.newest, agent);
        let stood = b.snapshots[old].map(f32::from_bits);
        let stands = b.snapshots[new].map(f32::from_bits);
        let way = [stands[0] - stood[0], stands[1] - stood[1]];
        let walked =
            dot2(way, way) <= b.between.reach * b.between.reach && (stands[2] - stood[2]).abs() < TURN_LIMIT;
        let share = if walked { b.between.share } else { 1.0 };

        b.position[agent] = [0, 1].map(|axis| on_the_way(stood[axis], stands[axis], share));
        let turned = wrap(stood[2] + wrap(stands[2] - stood[2]) * share);
        let heading = if share >= 1.0 { stands[2] } else { turned };
        b.stance[agent] = [heading, on_the_way(stood[3], stands[3], share)];

        let (was, now) = (b.snapshots[old + 1], b.snapshots[new + 1]);
        let strides = ((now[0].wrapping_sub(was[0]) >> 8) as f32 * share.min(0.999_999_94)) as u32;
        b.phase[agent] = if share >= 1.0 { now[0] } else { was[0].wrapping_add(strides << 8) };
        b.elevation[agent] = on_the_way(f32::from_bits(was[1]), f32::from_bits(now[1]), share);

        let (showed, shows) =
            (b.snapshots[old + 2].map(f32::from_bits), b.snapshots[new + 2].map(f32::from_bits));
        b.gait_weights[agent] = std::array::from_fn(|gait| on_the_way(showed[gait], shows[gait], share));
    }
}
