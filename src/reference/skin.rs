//! Linear blend skinning of the near agents of one avatar.

use super::body::{JOINTS, PALETTE_STRIDE, SKINNED_STRIDE, VERTEX_STRIDE};
use super::quaternion::{add4, dot3, scale4, xyz};
use crate::kernels::skin::Slices;
use rayon::prelude::*;

/// Twin of `shaders/skin.wgsl`.
pub fn skin(b: Slices<'_>) {
    let Slices { frame, bucket_start, mesh_table, mesh_vertices, palettes, skinned, level } = b;
    let levels = frame.level_count as usize;
    let bucket = level as usize * levels;
    let near = |bucket: usize| (bucket_start[bucket + 1] - bucket_start[bucket]) as usize;
    let [_, _, first_vertex, vertex_count] = mesh_table[bucket].map(|word| word as usize);
    let first: usize = (0..bucket).step_by(levels).map(|b| near(b) * mesh_table[b][3] as usize).sum();
    let end = first + near(bucket) * vertex_count;
    if first == end {
        return;
    }
    let agents = skinned[first * SKINNED_STRIDE..end * SKINNED_STRIDE]
        .par_chunks_exact_mut(vertex_count * SKINNED_STRIDE);
    agents.enumerate().for_each(|(agent, out)| {
        let matrices = &palettes[(bucket_start[bucket] as usize + agent) * PALETTE_STRIDE..][..PALETTE_STRIDE];
        for (vertex, out) in out.chunks_exact_mut(SKINNED_STRIDE).enumerate() {
            let source = &mesh_vertices[(first_vertex + vertex) * VERTEX_STRIDE..][..VERTEX_STRIDE];
            let (position, normal) = skin_vertex(source, matrices);
            out.copy_from_slice(&[position, normal]);
        }
    });
}

fn row_at(row: [f32; 4], p: [f32; 3]) -> f32 {
    row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]
}

fn skin_vertex(source: &[[f32; 4]], matrices: &[[f32; 4]]) -> ([f32; 4], [f32; 4]) {
    let joints = source[1][3].to_bits();
    let of_joint = |i: usize| {
        let joint = (joints >> (8 * i)) as usize & (JOINTS - 1);
        [0, 1, 2].map(|axis| scale4(matrices[joint * 3 + axis], source[2][i]))
    };
    let mut rows = of_joint(0);
    for i in 1..4 {
        for (row, part) in rows.iter_mut().zip(of_joint(i)) {
            *row = add4(*row, part);
        }
    }
    let n = xyz(source[1]);
    let normal = rows.map(|row| dot3(xyz(row), n));
    let square = dot3(normal, normal);
    let length = if square > 1e-12 { square.sqrt() } else { 1.0 };
    let [x, y, z] = rows.map(|row| row_at(row, xyz(source[0])));
    ([x, y, z, 1.0], [normal[0] / length, normal[1] / length, normal[2] / length, 0.0])
}
