//! Where agents that are led on a scripted path are to be at the end of the step.

use super::exact::lesser;
use crate::kernels::follow_paths::Slices;
use crate::kernels::layout::{Keyframe, Lead};

/// Twin of `shaders/follow_paths.wgsl`.
pub fn follow_paths(b: Slices<'_>) {
    let time = b.step.step_index.wrapping_add(1) as f32 * b.step.time_step;
    for path in &b.paths[..b.step.path_count as usize] {
        if path.keyframes == 0 {
            continue; // led by hand
        }
        let first = path.first_keyframe as usize;
        let keyframes = &b.keyframes[first..first + path.keyframes as usize];
        let mut lead = Lead { place: place_of(&keyframes[0]), velocity: [0.0, 0.0] };
        for pair in keyframes.windows(2) {
            let (start, end) = (&pair[0], &pair[1]);
            if time >= start.time {
                let span = end.time - start.time;
                let share = lesser((time - start.time) / span, 1.0);
                let ([x, z], way) = (place_of(start), [end.x - start.x, end.z - start.z]);
                lead.place = [x + way[0] * share, z + way[1] * share];
                lead.velocity = if share < 1.0 { [way[0] / span, way[1] / span] } else { [0.0, 0.0] };
            }
        }
        b.lead[path.agent as usize] = lead;
    }
}

const fn place_of(keyframe: &Keyframe) -> [f32; 2] {
    [keyframe.x, keyframe.z]
}
