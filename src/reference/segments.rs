//! The obstacle segments near an agent; twin of `shaders/shared/segments.wgsl`.

use super::orca::{SEGMENTS, Segment, segment_distance2};
use super::shared::cell_index;
use crate::kernels::layout::StepUniforms;

/// All obstacle segments, and which of them matter in which cell.
#[derive(Debug, Clone, Copy)]
pub struct Walls<'a> {
    /// Parameters of the step.
    pub step: &'a StepUniforms,
    /// `[segment][3]`, see [`Segment`].
    pub obstacles: &'a [[f32; 4]],
    /// `[cell + 1]` where the cell's list begins in this array, then the lists.
    pub obstacle_cells: &'a [u32],
}

/// Segments near an agent, by (squared distance, number).
#[derive(Debug, Clone, Copy, Default)]
pub struct NearSegments {
    /// Numbers, nearest first.
    pub numbers: [u32; SEGMENTS],
    /// How many.
    pub count: usize,
}

impl Walls<'_> {
    /// The numbers of the segments that may matter to somebody at `position`, rising.
    pub fn listed(&self, position: [f32; 2]) -> &[u32] {
        if self.step.obstacle_count == 0 {
            return &[];
        }
        let cell = cell_index(position, self.step);
        &self.obstacle_cells[self.obstacle_cells[cell] as usize..self.obstacle_cells[cell + 1] as usize]
    }

    /// The segments nearer than `reach`, m, whose open side the position is on.
    pub fn near(&self, position: [f32; 2], reach: f32) -> NearSegments {
        let mut near = NearSegments::default();
        let mut distances = [0.0_f32; SEGMENTS];
        for &number in self.listed(position) {
            let distance2 = segment_distance2(&self.segment(number), position);
            if !(distance2 < reach * reach) {
                continue;
            }
            // numbers rise within a cell's list, so equal distances stay in order of number
            let mut hole = near.count;
            while hole > 0 && distance2 < distances[hole - 1] {
                if hole < SEGMENTS {
                    (near.numbers[hole], distances[hole]) = (near.numbers[hole - 1], distances[hole - 1]);
                }
                hole -= 1;
            }
            if hole < SEGMENTS {
                (near.numbers[hole], distances[hole]) = (number, distance2);
                near.count = (near.count + 1).min(SEGMENTS);
            }
        }
        near
    }

    /// A segment by its number.
    pub fn segment(&self, number: u32) -> Segment {
        let at = number as usize * 3;
        [self.obstacles[at], self.obstacles[at + 1], self.obstacles[at + 2]]
    }
}
