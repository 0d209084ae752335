//! Inputs for `occlude` and `occlusion_compact`: the crowd of [`super::animation`] as `cull` and `compact` leave it, and a depth that
//! hides some of it.
//!
//! Hard by design: agents at and behind the eye, far too near or large for the test, out of one eye's image, tiles where
//! nothing is drawn, fewer agents than the test is worth, and poison in everything that must not be read.

use super::animation;
use super::case::unit;
use crate::kernels::layout::SightUniforms;
use crate::kernels::shared::block::BLOCK;
use crate::kernels::shared::scan::index::LANES;
use crate::kernels::{Dispatch, KernelId, Store};
use crate::reference;
use crate::sim::order;
use glam::camera::rh::{proj::vulkan, view::look_at_mat4};
use glam::{Mat4, Vec3};

const POISON: u32 = 0xdead_beef;
const ASPECT: f32 = 1.6;

/// Clip from world space of an eye `aside` of the made-up user. The user looks towards +z.
fn clip_from_world(user_eyes: Vec3, aside: f32) -> [[f32; 4]; 4] {
    let eye = user_eyes + Vec3::X * aside;
    let view: Mat4 = look_at_mat4(eye, eye + Vec3::new(0.15, -0.1, 1.0), Vec3::new(0.1, 1.0, 0.0));
    let mut clip = vulkan::perspective_infinite_reverse(1.2, ASPECT, 0.05) * view;
    // a depth that is not the same everywhere at one distance
    clip.x_axis.z += 1e-4;
    clip.y_axis.z -= 2e-4;
    clip.z_axis.z += 3e-5;
    clip.to_cols_array_2d()
}

/// Every buffer that the kernels touch. Seeds differ in kind. With even seeds only some agents have room for a pose, so that
/// near agents are far bodies. Seeds with bit 1 set see with one eye. One in five of them has too few agents. In another one
/// in five the eye looks down on most agents.
pub fn hidden(agents: usize, seed: u32) -> Store {
    let kind = seed.wrapping_mul(3).wrapping_add(1); // with far bodies
    let mut store = animation::animation(agents, kind);
    for dispatch in animation::dispatches(&store) {
        if matches!(dispatch.kernel(), KernelId::Cull | KernelId::Compact) {
            reference::run(dispatch.phase, &mut store, dispatch.immediate);
        }
    }
    let [x, y, z, _] = store.frame.user_eyes;
    // whole blocks of tiles of one pixel, or one tile more each way
    let ([width, height], tile) = if seed % 2 == 1 { ([80, 64], [1, 1]) } else { ([322, 193], [4, 3]) };
    let (columns, rows) = (u32::div_ceil(width, tile[0]), u32::div_ceil(height, tile[1]));
    let mut bounds = [[[f32::NAN; 4]; 2]; 32];
    let far = store.frame.bucket_count..store.mesh_table.len() as u32;
    for bucket in far.clone() {
        bounds[bucket as usize] =
            [[0.3 + 0.02 * bucket as f32, -0.03, 1.45, f32::NAN], [0.12, 1.4, 1.75, f32::NAN]];
    }
    store.sight = SightUniforms {
        clip_from_world: [-0.03, 0.03].map(|aside| clip_from_world(Vec3::new(x, y, z), aside)),
        bounds,
        width: width as f32,
        height: height as f32,
        eye_count: if seed & 2 == 0 { 2 } else { 1 },
        tile_width: tile[0],
        tile_height: tile[1],
        tile_columns: columns,
        tile_rows: rows,
        first_bucket: far.start,
        bucket_end: far.end,
        start_shift: 1,
        eye_height: y + if seed % 5 == 3 { 1.0 } else { 0.0 },
        fewest: 2,
    };
    let judged = store.bucket_start[far.end as usize + 1] - store.bucket_start[far.start as usize + 1];
    store.sight.fewest = [2, judged + 1, judged, 2, u32::MAX][seed as usize % 5];
    // heads just as high as the eye may look down on
    for agent in (0..agents).step_by(9) {
        let head = 1.75 * store.appearance[agent].scale;
        store.elevation[agent] = store.sight.eye_height - head - 0.3;
    }
    let tiles = (2 * columns * rows) as usize;
    store.wanted = vec![0; 2 * (columns.div_ceil(BLOCK) * rows.div_ceil(BLOCK)) as usize];
    // walls before some columns of tiles, nothing before others
    let wall = |tile: usize| {
        let column = tile % columns as usize;
        let depth = unit(kind, column / 6, 0) * 0.02;
        if unit(kind, tile, 1) < 0.01 { 0.0 } else { depth }
    };
    store.tile_depth = (0..tiles).map(wall).collect();
    store.hidden = vec![POISON; store.visible.len()];
    store.shown = vec![POISON; store.visible.len()];
    store.group_shown = vec![POISON; agents.div_ceil(LANES) + 1];
    store.bucket_shown = vec![POISON; store.mesh_table.len() + 1];
    store.shown_args = vec![POISON; store.mesh_table.len() * 5];
    store
}

/// The dispatches of one sifting.
pub fn dispatches(store: &Store) -> Vec<Dispatch> {
    let agents = store.frame.agent_count;
    order::marking_dispatches(agents).into_iter().chain(order::occlusion_dispatches(agents)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_are_hidden_and_some_are_not_and_the_list_holds_the_others_in_their_order() {
        let mut all = [0, 0];
        for seed in 0..10 {
            let mut store = hidden(700, seed);
            for dispatch in dispatches(&store) {
                reference::run(dispatch.phase, &mut store, dispatch.immediate);
            }
            let shift = store.sight.start_shift;
            let of = |bucket: u32| store.bucket_start[(bucket + shift) as usize];
            let total = of(store.sight.bucket_end) - of(store.sight.first_bucket);
            for bucket in store.sight.first_bucket..store.sight.bucket_end {
                let [start, end] =
                    [bucket, bucket + 1].map(|bucket| store.bucket_start[(bucket + shift) as usize]);
                let seen: Vec<u32> = (start..end).filter(|slot| store.hidden[*slot as usize] == 0).collect();
                let count = store.shown_args[bucket as usize * 5 + 1] as usize;
                assert_eq!(store.shown[start as usize..][..count], seen, "seed {seed}, bucket {bucket}");
                let hidden = (end - start) as usize - count;
                assert!(total >= store.sight.fewest || hidden == 0);
                all = [all[0] + count, all[1] + hidden];
            }
            let marked = store.wanted.iter().filter(|tile| **tile == 1).count();
            assert!(marked < store.wanted.len() && (marked > 0 || store.sight.fewest > 2));
        }
        assert!(all[0] > 300 && all[1] > 100, "{all:?}");
    }
}
