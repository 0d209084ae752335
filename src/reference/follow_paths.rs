//! Where agents that are led on a scripted path are to be at the end of the step.

use crate::kernels::follow_paths::Slices;

/// Twin of `shaders/follow_paths.wgsl`.
pub fn follow_paths(b: Slices<'_>) {
    let time = b.step.step_index.wrapping_add(1) as f32 * b.step.time_step;
    for &[agent, first, count, _] in &b.paths[..b.step.path_count as usize] {
        if count == 0 {
            continue; // somebody leads it by hand
        }
        let keyframes = &b.keyframes[first as usize..(first + count) as usize];
        let mut lead = [keyframes[0][1], keyframes[0][2], 0.0, 0.0];
        for pair in keyframes.windows(2) {
            let ([start, x, z, _], [end, to_x, to_z, _]) = (pair[0], pair[1]);
            if time >= start {
                let span = end - start;
                let share = ((time - start) / span).min(1.0);
                let way = [to_x - x, to_z - z];
                let moves = share < 1.0;
                lead = [
                    x + way[0] * share,
                    z + way[1] * share,
                    if moves { way[0] / span } else { 0.0 },
                    if moves { way[1] / span } else { 0.0 },
                ];
            }
        }
        b.lead[agent as usize] = lead;
    }
}
