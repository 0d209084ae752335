//! Goals and obstacles of a running simulation, and the flow fields of these goals.

use super::{Error, Simulation, flow, order, setup};
use crate::kernels::{BufferId, Dispatch, Op};

/// What [`flow::lay`] fills.
const FLOW: [BufferId; 13] = [
    BufferId::FlowGrid,
    BufferId::FlowCells,
    BufferId::FlowSeeds,
    BufferId::FlowJoints,
    BufferId::Floors,
    BufferId::FlowDistance,
    BufferId::FlowWay,
    BufferId::FlowTiles,
    BufferId::FlowLists,
    BufferId::FlowArgs,
    BufferId::FlowCounts,
    BufferId::FlowSums,
    BufferId::FlowRoom,
];

impl Simulation {
    /// Lays the flow grid with one field for each goal and solves the fields. `outlines` are as in [`Self::set_obstacles`].
    ///
    /// # Errors
    /// As [`flow::lay`] and [`Self::solve_ways`].
    pub fn set_goals(
        &mut self,
        outlines: &[Vec<[f32; 2]>],
        goals: Vec<flow::Goal>,
        settings: flow::Settings,
    ) -> Result<(), crate::Error> {
        flow::lay_on(&mut self.store, outlines, &self.ways.floors, &goals, &settings)?;
        (self.ways.goals, self.ways.settings) = (goals, settings);
        self.machine.replace(&self.store, &FLOW)?;
        self.solve_ways()
    }

    /// Changes what agents must not cross, while they walk: doors open and close, vehicles come and go. `outlines` replaces all
    /// outlines, m on the ground. Those that run clockwise on (x, z) are walkable inside (the bounds), others are solid inside,
    /// and two corners are a wall ([`crate::scenario::Geometry::outlines`] has them so). The scenario's outlines that stand at
    /// some heights only stay. Agents keep their state, and the flow fields are solved again. A failure changes nothing.
    ///
    /// # Errors
    /// [`Error::Goal`] when no agent can stand at a goal any more; when the device fails.
    pub fn set_obstacles(&mut self, outlines: &[Vec<[f32; 2]>]) -> Result<(), crate::Error> {
        let ways = &self.ways;
        flow::lay_on(&mut self.store, outlines, &ways.floors, &ways.goals, &ways.settings)?;
        setup::set_raised_obstacles(&mut self.store, outlines, &ways.floors.raised);
        let places = [BufferId::Obstacles, BufferId::ObstacleCells, BufferId::CellDepth];
        self.machine.replace(&self.store, &places)?;
        self.machine.replace(&self.store, &FLOW)?;
        self.solve_ways()
    }

    /// Solves the flow fields of all goals, by the present density of people if `density_weight` is above 0. [`Self::step`] then calls
    /// it every so many steps. The fields of a new simulation are solved already.
    ///
    /// # Errors
    /// When the device fails.
    pub fn solve_ways(&mut self) -> Result<(), crate::Error> {
        let grid = self.store.flow_grid;
        if grid.field_count == 0 {
            return Ok(());
        }
        let mut dispatches =
            if grid.every > 0 { order::density_dispatches(&self.store.step, &grid) } else { Vec::new() };
        dispatches.extend(order::flow_start(&grid));
        let tiles = grid.field_count * grid.tile_columns * grid.tile_rows;
        let most = tiles.saturating_mul(8).saturating_add(1024);
        let open = flow::tiles_to_cross(&grid, &self.store.flow_seeds[..grid.seed_count as usize]);
        for with_solid in [false, true] {
            if with_solid {
                dispatches.push(order::flow_solid(&grid));
            }
            // in an open place it takes so many turns and the few that look back; then so many at a time
            let mut batch = if with_solid { 16 } else { open + 8 };
            let mut turns = 0;
            loop {
                dispatches.extend(order::flow_turns(turns, batch, with_solid));
                self.solve(&dispatches, &[BufferId::FlowArgs])?;
                dispatches.clear();
                turns += batch;
                batch = 32;
                let mut is_done = self.lists_are_empty();
                if is_done && grid.joint_count > 0 && !with_solid {
                    self.solve(&[order::flow_joint(&grid)], &[BufferId::FlowArgs])?;
                    turns = turns.next_multiple_of(4);
                    is_done = self.lists_are_empty();
                }
                if is_done {
                    break;
                }
                if turns > most {
                    return Err(Error::FlowTurns { turns }.into());
                }
            }
        }
        self.solve(&order::flow_end(&grid), &[])?;
        self.keep_ways()
    }

    /// Runs dispatches of the solver, which no times are taken of, and brings buffers into the store.
    fn solve(&mut self, dispatches: &[Dispatch], wanted: &[BufferId]) -> Result<(), crate::Error> {
        let ops: Vec<Op> = dispatches.iter().copied().map(Op::Dispatch).collect();
        self.machine.run(&mut self.store, &ops, |_, _| Vec::new(), None)?;
        self.machine.fetch(&mut self.store, wanted)
    }

    /// Whether no tile waits for its turn.
    fn lists_are_empty(&self) -> bool {
        (0..4).all(|list| self.store.flow_args[4 * list + 3] == 0)
    }
}
