//! Goals and obstacles of a simulation that runs, and the ways from everywhere to these goals.

use super::{Error, Simulation, flow, order, setup};
use crate::kernels::BufferId;

/// What [`flow::lay`] fills.
#[cfg(feature = "vulkan")]
const FLOW: [BufferId; 11] = [
    BufferId::FlowGrid,
    BufferId::FlowCells,
    BufferId::FlowSeeds,
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
    /// Lays the flow grid with one field for each goal and solves them. `outlines` are those of [`Self::set_obstacles`].
    ///
    /// # Errors
    /// As [`flow::lay`] and [`Self::solve_ways`].
    pub fn set_goals(
        &mut self,
        outlines: &[Vec<[f32; 2]>],
        goals: Vec<flow::Goal>,
        settings: flow::Settings,
    ) -> Result<(), crate::Error> {
        flow::lay(&mut self.store, outlines, &goals, &settings)?;
        (self.ways.goals, self.ways.settings) = (goals, settings);
        #[cfg(feature = "vulkan")]
        if let Some(engine) = &mut self.engine {
            engine.replace(&self.store, &FLOW)?;
        }
        self.solve_ways()
    }

    /// Changes what agents must not cross, while they walk: doors open and close, vehicles come and go. All outlines
    /// are given anew, m on the ground: those that run clockwise on (x, z) are walkable inside (the bounds), others
    /// solid inside, two corners are a wall ([`crate::scenario::Geometry::outlines`] has them so); those of the scenario that stand at some heights only stay. Agents
    /// keep their state; the ways to goals are found again. Nothing has changed when it fails.
    ///
    /// # Errors
    /// [`Error::Goal`] when nobody can stand at a goal any more; when the device fails.
    pub fn set_obstacles(&mut self, outlines: &[Vec<[f32; 2]>]) -> Result<(), crate::Error> {
        flow::lay(&mut self.store, outlines, &self.ways.goals, &self.ways.settings)?;
        setup::set_raised_obstacles(&mut self.store, outlines, &self.ways.raised);
        #[cfg(feature = "vulkan")]
        if let Some(engine) = &mut self.engine {
            engine.replace(&self.store, &[BufferId::Obstacles, BufferId::ObstacleCells])?;
            engine.replace(&self.store, &FLOW)?;
        }
        self.solve_ways()
    }

    /// Finds the ways to all goals, by the density of people as they stand now if that matters. [`Self::step`] does it
    /// by itself every so many steps; the fields of a new simulation are solved already.
    ///
    /// # Errors
    /// When the device fails.
    pub fn solve_ways(&mut self) -> Result<(), crate::Error> {
        let grid = self.store.flow_grid;
        if grid.field_count == 0 {
            return Ok(());
        }
        let mut passes =
            if grid.every > 0 { order::density_passes(&self.store.step, &grid) } else { Vec::new() };
        passes.extend(order::flow_start(&grid));
        let tiles = grid.field_count * grid.tile_columns * grid.tile_rows;
        let most = tiles.saturating_mul(8).saturating_add(1024);
        let open = flow::tiles_to_cross(&grid, &self.store.flow_seeds[..grid.seed_count as usize]);
        for with_solid in [false, true] {
            if with_solid {
                passes.push(order::flow_solid(&grid));
            }
            // in an open place it takes so many turns and the few that look back; then so many at a time
            let mut batch = if with_solid { 16 } else { open + 8 };
            let mut turns = 0;
            loop {
                passes.extend(order::flow_turns(turns, batch, with_solid));
                self.run(&passes, &[BufferId::FlowArgs])?;
                passes.clear();
                turns += batch;
                batch = 32;
                if (0..4).all(|list| self.store.flow_args[4 * list + 3] == 0) {
                    break;
                }
                if turns > most {
                    return Err(Error::FlowTurns { turns }.into());
                }
            }
        }
        self.run(&order::flow_end(&grid), &[])
    }
}
