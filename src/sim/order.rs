//! The order of the kernels in one step, once, for both backends.

use crate::kernels::layout::StepUniforms;
use crate::kernels::{Extent, KernelId, Pass};

/// Cells of one row that a workgroup of `velocity_orca` takes (`TILE` in the shader).
const TILE: u32 = 4;
/// Cells that one invocation of `grid_scan` adds up (`RUN` in the shader).
const RUN: u32 = 64;

/// The launches of one step.
pub fn passes(step: &StepUniforms) -> Vec<Pass> {
    let agents = Extent::Invocations(step.agent_count);
    let cells = Extent::Invocations(step.cell_count);
    let runs = Extent::Invocations(step.cell_count.div_ceil(RUN));
    let tiles = Extent::Groups(step.grid_columns.div_ceil(TILE), step.grid_rows);
    let pass = |kernel, level, extent| Pass { kernel, level, extent };
    vec![
        pass(KernelId::GridCount, 0, agents),
        pass(KernelId::GridScan, 0, runs),
        pass(KernelId::GridScan, 1, Extent::Invocations(1)),
        pass(KernelId::GridScan, 2, runs),
        pass(KernelId::GridScatter, 0, agents),
        pass(KernelId::GridScatter, 1, cells),
        pass(KernelId::Prefer, 0, agents),
        pass(KernelId::VelocityOrca, 0, tiles),
        pass(KernelId::Integrate, 0, agents),
    ]
}
