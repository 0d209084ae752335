//! Coarser levels of detail by vertex clustering.

use super::super::body::pack;
use super::super::{Mesh, Vertex};
use crate::gait::JOINT_COUNT;
use glam::{IVec3, Vec3};
use std::collections::{BTreeMap, HashMap};

/// Merges vertices in ever larger cells until at most `most` triangles are left.
///
/// Vertices merge only within one driven joint and one side of the surface, so that arms do not grow onto the
/// trunk and thin parts keep their back. Deterministic: cells are kept in order. What is more glass than not is left out:
/// from where coarse levels are seen, faces matter more than the glasses before them.
pub(super) fn simplify(mesh: &Mesh, most: usize, height: f32) -> Mesh {
    let mesh = &solid(mesh);
    let mut cell = height / 128.0;
    let mut coarse = mesh.clone();
    // Each step shrinks the count by about 1.6; 24 steps reach a cell of the whole figure.
    for _ in 0..24 {
        if coarse.indices.len() / 3 <= most {
            break;
        }
        coarse = cluster(mesh, cell, true);
        cell *= 1.25;
    }
    // Very few triangles: limbs may lose their sides.
    cell = height / 24.0;
    for _ in 0..12 {
        if coarse.indices.len() / 3 <= most {
            break;
        }
        coarse = cluster(mesh, cell, false);
        cell *= 1.25;
    }
    coarse
}

/// The mesh without triangles that hide less than half of what is behind them; the others hide all of it.
fn solid(mesh: &Mesh) -> Mesh {
    let alpha = |index: &u32| mesh.vertices.get(*index as usize).map_or(0.0, |v| v.alpha);
    let is_solid = |t: &&[u32]| t.iter().map(alpha).sum::<f32>() >= 1.5;
    Mesh {
        vertices: mesh.vertices.iter().map(|v| Vertex { alpha: 1.0, ..*v }).collect(),
        indices: mesh.indices.chunks_exact(3).filter(is_solid).flatten().copied().collect(),
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Cell {
    joint: u8,
    material: u32,
    at: [i32; 3],
    facing: u8,
}

struct Sum {
    count: f32,
    position: Vec3,
    normal: Vec3,
    /// Colours and how many vertices have them: mixing hair and skin would give neither.
    colors: Vec<(Vec3, u32)>,
    shares: [f32; JOINT_COUNT],
    first: Vertex,
}

/// Which way a surface looks, coarsely: sheets and limbs thinner than a cell keep their sides.
fn facing(normal: Vec3) -> u8 {
    let across = if normal.x.abs() > normal.y.abs() { normal.x } else { normal.y };
    u8::from(normal.z > 0.0) + 2 * u8::from(across > 0.0)
}

fn cluster(mesh: &Mesh, cell: f32, keep_sides: bool) -> Mesh {
    let mut cells: BTreeMap<Cell, usize> = BTreeMap::new();
    let mut sums: Vec<Sum> = Vec::new();
    // Flat-shaded meshes have many normals in one place; a common one keeps them together, without cracks.
    let place = |p: Vec3| (p * 1e4).round().as_ivec3().to_array();
    let mut normals: HashMap<[i32; 3], Vec3> = HashMap::new();
    for v in &mesh.vertices {
        *normals.entry(place(v.position)).or_default() += v.normal;
    }
    let mut slot_of = Vec::with_capacity(mesh.vertices.len());
    for v in &mesh.vertices {
        let at: IVec3 = (v.position / cell).floor().as_ivec3();
        let facing = if !keep_sides {
            0
        } else {
            facing(normals.get(&place(v.position)).copied().unwrap_or(v.normal))
        };
        let key = Cell { joint: v.joints[0], material: v.material as u32, at: at.to_array(), facing };
        let slot = *cells.entry(key).or_insert(sums.len());
        if slot == sums.len() {
            let zero = Vec3::ZERO;
            sums.push(Sum {
                count: 0.0,
                position: zero,
                normal: zero,
                colors: Vec::new(),
                shares: [0.0; JOINT_COUNT],
                first: *v,
            });
        }
        let sum = &mut sums[slot];
        sum.count += 1.0;
        sum.position += v.position;
        sum.normal += v.normal;
        match sum.colors.iter_mut().find(|(color, _)| color.distance(v.color) < 0.05) {
            Some((_, votes)) => *votes += 1,
            None => sum.colors.push((v.color, 1)),
        }
        for (joint, weight) in v.joints.iter().zip(v.weights) {
            sum.shares[usize::from(*joint)] += weight;
        }
        slot_of.push(slot);
    }
    let mut triangles: Vec<[usize; 3]> = Vec::new();
    for t in mesh.indices.chunks_exact(3) {
        let mut slots = [t[0], t[1], t[2]].map(|i| slot_of[i as usize]);
        if slots[0] == slots[1] || slots[1] == slots[2] || slots[0] == slots[2] {
            continue;
        }
        // Rotated to begin with the smallest, so that doubles are found while the winding stays.
        let least = (0..3).min_by_key(|&i| slots[i]).unwrap_or(0);
        slots.rotate_left(least);
        triangles.push(slots);
    }
    triangles.sort_unstable();
    triangles.dedup();
    let mut used = vec![u32::MAX; sums.len()];
    let mut out = Mesh::default();
    for slot in triangles.into_iter().flatten() {
        if used[slot] == u32::MAX {
            used[slot] = u32::try_from(out.vertices.len()).unwrap_or(u32::MAX);
            let sum = &sums[slot];
            let (joints, weights) = pack(&sum.shares);
            out.vertices.push(Vertex {
                position: sum.position / sum.count,
                normal: sum.normal.try_normalize().unwrap_or(sum.first.normal),
                color: sum
                    .colors
                    .iter()
                    .max_by_key(|(_, votes)| *votes)
                    .map_or(sum.first.color, |(color, _)| *color),
                alpha: sum.first.alpha,
                material: sum.first.material,
                joints,
                weights,
            });
        }
        out.indices.push(used[slot]);
    }
    out
}
