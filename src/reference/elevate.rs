//! How high each agent stands.

use super::exact::dot2;
use super::shared::is_absent;
use crate::kernels::elevate::Slices;
use crate::kernels::shared::climb::STEP;
use crate::kernels::shared::floors::EDGE;
use crate::kernels::shared::floors::index::FLOOR_STRIDE;
use rayon::prelude::*;

/// Twin of `shaders/elevate.wgsl`.
pub fn elevate(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    let floors = &b.floors[..b.step.floor_count as usize * FLOOR_STRIDE];
    b.elevation[..agents].par_iter_mut().enumerate().with_min_len(1024).for_each(|(agent, elevation)| {
        if !is_absent(b.position[agent]) {
            [*elevation, _] = standing(floors, b.position[agent], *elevation);
        }
    });
}

/// Where an agent stands at a point, from the height `present` it stood at before: height, m, and sheet of the flow grid.
/// Twin of `shaders/shared/floors.wgsl`.
pub fn standing(floors: &[[f32; 4]], at: [f32; 2], present: f32) -> [f32; 2] {
    let (mut nearest, mut found) = (STEP, [0.0; 2]);
    for floor in floors.chunks_exact(FLOOR_STRIDE) {
        let Some((&[a, b, c, sheet], edges)) = floor.split_first() else { continue };
        if edges.iter().all(|&[n, m, d, _]| dot2([n, m], at) + d >= -EDGE) {
            let here = dot2([a, b], at) + c;
            let off = (here - present).abs();
            if off < nearest {
                (nearest, found) = (off, [here, sheet]);
            }
        }
    }
    found
}
