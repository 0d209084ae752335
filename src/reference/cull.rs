//! Which agents may be seen and how finely.

use super::exact::is_finite2;
use super::shared::is_absent;
use crate::kernels::KernelId;
use crate::kernels::cull::{ELEVATION_LIMIT, HEADING_LIMIT, SCALE_LIMIT, STRIDE_LIMIT, Slices, WEIGHT_LIMIT};
use crate::kernels::layout::{FrameUniforms, Stance};
use crate::kernels::shared::body::NONE;

fn gait_is_usable(clip_count: u32, clip: u32, weight: f32) -> bool {
    (0.0..WEIGHT_LIMIT).contains(&weight) && (weight == 0.0 || clip < clip_count)
}

fn is_usable(b: &Slices<'_>, agent: usize, avatar: u32, scale: f32) -> bool {
    let Stance { phase: _, walk_weight, left, right, turns, lean, heights, slopes, stride, foresight } =
        b.stance[agent];
    let (clips, weights) = (b.gaits[agent], b.gait_weights[agent]);
    is_finite2(b.position[agent])
        && b.elevation[agent].abs() < ELEVATION_LIMIT
        && b.heading[agent].abs() < HEADING_LIMIT
        && walk_weight.abs() < WEIGHT_LIMIT
        && stride.abs() < STRIDE_LIMIT
        && [left, right, turns, lean, heights, slopes].into_iter().all(is_finite2)
        && foresight.abs() < HEADING_LIMIT
        && scale > 0.0
        && scale < SCALE_LIMIT
        && b.frame.clip_count > 0
        && (avatar + 1) * b.frame.level_count <= b.frame.bucket_count
        && (0..4).all(|i| gait_is_usable(b.frame.clip_count, clips[i], weights[i]))
}

fn eye_sees(frame: &FrameUniforms, eye: usize, x: f32, low: f32, high: f32, z: f32, radius: f32) -> bool {
    frame.planes[eye * 6..eye * 6 + 6].iter().all(|&[nx, ny, nz, offset]| {
        let foot = nx * x + ny * low + nz * z + offset;
        let top = nx * x + ny * high + nz * z + offset;
        foot >= -radius || top >= -radius
    })
}

/// Twin of `shaders/cull.wgsl`.
pub fn cull(b: Slices<'_>) {
    let frame = b.frame;
    for agent in 0..frame.agent_count as usize {
        let info = b.appearance[agent];
        let (avatar, scale) = (info.avatar(), info.scale);
        b.agent_bucket[agent] = NONE;
        if !is_usable(&b, agent, avatar, scale) {
            let first = &mut b.failure[KernelId::Cull as usize];
            *first = (*first).min(agent as u32);
            continue;
        }
        if is_absent(b.position[agent]) || info.is_bodiless() {
            continue;
        }
        let [x, z] = b.position[agent];
        let height = frame.agent_height * scale * info.stature();
        let radius = frame.agent_radius * scale * if info.breadth() < 1.0 { 1.0 } else { info.breadth() };
        let foot = b.elevation[agent];
        let low = foot + radius;
        let high = foot + if height - radius > radius { height - radius } else { radius };
        if !(eye_sees(frame, 0, x, low, high, z, radius)
            || (frame.eye_count > 1 && eye_sees(frame, 1, x, low, high, z, radius)))
        {
            continue;
        }
        let [camera_x, camera_y, camera_z, lod4_distance] = frame.camera;
        let [lod1_distance, lod2_distance, far_plane, lod3_distance] = frame.level_distance;
        let dx = x - camera_x;
        let dy = foot + 0.5 * height - camera_y;
        let dz = z - camera_z;
        let distance = (dx * dx + dy * dy + dz * dz).sqrt();
        if !(distance <= far_plane) {
            continue;
        }
        let mut level = 0;
        if frame.level_count > 1 && distance >= lod1_distance {
            level = 1;
        }
        if frame.level_count > 2 && distance >= lod2_distance {
            level = 2;
        }
        let mut bucket = avatar * frame.level_count + level;
        if lod3_distance > 0.0 && distance >= lod3_distance {
            bucket = frame.bucket_count + avatar;
            if lod4_distance > 0.0 && distance >= lod4_distance {
                bucket += frame.bucket_count / frame.level_count.max(1);
            }
        }
        b.agent_bucket[agent] = bucket;
    }
}
