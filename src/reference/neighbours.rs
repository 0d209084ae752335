//! The nearest agents of one; twin of `shaders/shared/neighbours.wgsl`.

use super::exact::dot2;
use super::orca::NEIGHBOURS;
use super::shared::grid_cell;
use crate::kernels::layout::StepUniforms;

/// A cell's border is computed with rounding; a neighbour that near to it is looked for in the next ring as well.
const SAFE: f32 = 0.999;

/// All agents in cell order, as `grid_pack` leaves them.
#[derive(Debug, Clone, Copy)]
pub struct Slots<'a> {
    /// Parameters of the step.
    pub step: &'a StepUniforms,
    /// `[slot][2]` position, velocity; radius, maximum speed, priority, elevation.
    pub slot_motion: &'a [[f32; 4]],
    /// `[slot]`
    pub slot_agent: &'a [u32],
    /// `[cell + 1]`
    pub cell_start: &'a [u32],
    /// Whether people walk above one another, so that those of another storey do not count.
    pub has_storeys: bool,
}

/// The nearest so far, sorted by (squared distance, id).
#[derive(Debug)]
pub struct Nearest {
    /// Slots, nearest first.
    pub slots: [u32; NEIGHBOURS],
    distance2: [f32; NEIGHBOURS],
    /// How many.
    pub count: usize,
    /// Nobody farther than this can come in.
    limit: f32,
}

impl Slots<'_> {
    /// The nearest agents: the square of five by five cells first, then ring by ring, stopping when no farther ring
    /// can hold a nearer one.
    ///
    /// At most `cap` of them (and at most [`NEIGHBOURS`]), nearer than `range`, m.
    pub fn neighbours(&self, slot: usize, position: [f32; 2], range: f32, cap: u32) -> Nearest {
        let step = self.step;
        let cap = (cap as usize).min(NEIGHBOURS);
        let range2 = range * range;
        let mut nearest =
            Nearest { slots: [0; NEIGHBOURS], distance2: [0.0; NEIGHBOURS], count: 0, limit: range2 };
        if cap == 0 {
            return nearest;
        }
        let [cx, cy] = grid_cell(position, step);
        let (columns, rows) = (step.grid_columns as i32, step.grid_rows as i32);
        let mut ring = 2;
        loop {
            let (left, right) = ((cx - ring).max(0), (cx + ring).min(columns - 1));
            for row in (cy - ring).max(0)..=(cy + ring).min(rows - 1) {
                let cell = |column: i32| (row * columns + column) as usize;
                if ring == 2 || row == cy - ring || row == cy + ring {
                    self.scan(cell(left), cell(right), slot, position, cap, &mut nearest);
                    continue;
                }
                if cx - ring >= 0 {
                    self.scan(cell(left), cell(left), slot, position, cap, &mut nearest);
                }
                if cx + ring < columns {
                    self.scan(cell(right), cell(right), slot, position, cap, &mut nearest);
                }
            }
            let safe = self.safe_distance(position, cx, cy, ring);
            let full = nearest.count == cap && nearest.limit < safe * safe;
            if full || safe >= range {
                return nearest;
            }
            ring += 1;
        }
    }

    /// Offers everyone in a run of cells of one row.
    fn scan(&self, first: usize, last: usize, own: usize, at: [f32; 2], cap: usize, nearest: &mut Nearest) {
        let slots = self.cell_start[first] as usize..self.cell_start[last + 1] as usize;
        for (slot, motion) in
            slots.clone().zip(self.slot_motion[slots.start * 2..slots.end * 2].chunks_exact(2))
        {
            let to = [motion[0][0] - at[0], motion[0][1] - at[1]];
            let distance2 = dot2(to, to);
            if distance2 <= nearest.limit && slot != own && self.same_storey(slot, own) {
                self.insert(nearest, cap, slot as u32, distance2);
            }
        }
    }

    /// Whether the agents of two slots are in the same storey.
    pub fn same_storey(&self, slot: usize, other: usize) -> bool {
        let elevation = |slot: usize| self.slot_motion[slot * 2 + 1][3];
        !self.has_storeys || (elevation(slot) - elevation(other)).abs() < self.step.storey_height
    }

    /// Insertion by (squared distance, id): a total order, so the order of the cells does not matter.
    fn insert(&self, nearest: &mut Nearest, cap: usize, slot: u32, distance2: f32) {
        let id = self.slot_agent[slot as usize];
        let before = |i: usize, nearest: &Nearest| {
            let other = nearest.distance2[i];
            distance2 < other || (distance2 == other && id < self.slot_agent[nearest.slots[i] as usize])
        };
        let full = nearest.count == cap;
        // the neighbour distance itself is out of range
        if if full { !before(cap - 1, nearest) } else { distance2 >= nearest.limit } {
            return;
        }
        let mut hole = nearest.count.min(cap - 1);
        while hole > 0 && before(hole - 1, nearest) {
            nearest.slots[hole] = nearest.slots[hole - 1];
            nearest.distance2[hole] = nearest.distance2[hole - 1];
            hole -= 1;
        }
        (nearest.slots[hole], nearest.distance2[hole]) = (slot, distance2);
        nearest.count = (nearest.count + 1).min(cap);
        if nearest.count == cap {
            nearest.limit = nearest.distance2[cap - 1];
        }
    }

    /// Everyone outside the square of `2 ring + 1` cells is at least this far away. Cells at the border of the grid
    /// reach to infinity, since they hold the agents outside.
    fn safe_distance(&self, at: [f32; 2], cx: i32, cy: i32, ring: i32) -> f32 {
        let step = self.step;
        let mut safe = f32::MAX;
        for (axis, (cell, cells)) in [(cx, step.grid_columns), (cy, step.grid_rows)].into_iter().enumerate() {
            let from_origin = at[axis] - step.grid_origin[axis];
            if cell - ring > 0 {
                safe = safe.min(from_origin - (cell - ring) as f32 * step.cell_size);
            }
            if cell + ring < cells as i32 - 1 {
                safe = safe.min((cell + ring + 1) as f32 * step.cell_size - from_origin);
            }
        }
        safe.max(0.0) * SAFE
    }
}
