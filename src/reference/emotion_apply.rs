//! What people show of how they feel: gait, speed, gaze.

use super::exact::{greater, lesser};
use crate::kernels::emotion_apply::{MARGIN, Slices};
use crate::kernels::layout::Body;

/// Twin of `shaders/emotion_apply.wgsl`.
pub fn emotion_apply(b: Slices<'_>) {
    for agent in 0..b.step.agent_count as usize {
        let q = b.feeling[agent];
        let own = b.paces[agent];
        if !(own.max_speed_factor > 0.0) {
            continue;
        }
        b.gait_weights[agent] = q;
        let speed = sum_of(q, own.preferred_speeds);
        let walk_ratio = sum_of(q, own.walk_ratios);
        let max_speed = greater(speed, lesser(speed * own.max_speed_factor, own.max_speed));
        b.body[agent] = Body { max_speed, preferred_speed: speed, walk_ratio, ..b.body[agent] };

        let shown = (b.appearance[agent].emotion() as usize).min(3);
        let strongest = (0..4).fold(shown, |best, emotion| if q[emotion] > q[best] { emotion } else { best });
        if q[strongest] > q[shown] + MARGIN {
            b.appearance[agent].set_emotion(strongest as u32);
        }
    }
}

fn sum_of([ax, ay, az, aw]: [f32; 4], [bx, by, bz, bw]: [f32; 4]) -> f32 {
    ax * bx + ay * by + az * bz + aw * bw
}
