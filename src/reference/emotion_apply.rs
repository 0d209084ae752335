//! What people show of how they feel: gait, speed, gaze.

use crate::kernels::emotion_apply::{MARGIN, Slices};

/// Twin of `shaders/emotion_apply.wgsl`.
pub fn emotion_apply(b: Slices<'_>) {
    for agent in 0..b.step.agent_count as usize {
        let q = b.feeling[agent];
        let limits = b.paces[agent * 3 + 2];
        if !(limits[0] > 0.0) {
            continue;
        }
        b.gait_weights[agent] = q;
        let speed = sum_of(q, b.paces[agent * 3]);
        let travel = sum_of(q, b.paces[agent * 3 + 1]);
        let most = speed.max((speed * limits[0]).min(limits[1]));
        b.body[agent] = [b.body[agent][0], most, speed, travel];

        let shown = ((b.appearance[agent][0] >> 8 & 255) as usize).min(3);
        let strongest = (0..4).fold(shown, |best, emotion| if q[emotion] > q[best] { emotion } else { best });
        if q[strongest] > q[shown] + MARGIN {
            b.appearance[agent][0] = (b.appearance[agent][0] & 0xffff_00ff) | (strongest as u32) << 8;
        }
    }
}

fn sum_of(a: [f32; 4], b: [f32; 4]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
}
