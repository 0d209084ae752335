//! The order of the kernels in one step and in one picture, once, for both backends.

use crate::kernels::layout::{FrameUniforms, StepUniforms};
use crate::kernels::{BufferId, Extent, KernelId, Pass};
use crate::reference::body::COLUMNS;

/// Cells that one invocation of `grid_scan` adds up (`RUN` in the shader).
const RUN: u32 = 64;

/// The launches of one step.
pub fn step_passes(step: &StepUniforms) -> Vec<Pass> {
    let agents = Extent::Invocations(step.agent_count);
    let storeys = u32::from(step.storey_height > 0.0);
    let runs = Extent::Invocations(step.cell_count.div_ceil(RUN));
    let pass = |kernel, level, extent| Pass { kernel, level, extent };
    let mut passes = vec![
        pass(KernelId::LeadAgents, 0, agents),
        pass(KernelId::GridCount, 0, agents),
        pass(KernelId::GridScan, 0, runs),
        pass(KernelId::GridScan, 1, Extent::Invocations(1)),
        pass(KernelId::GridScan, 2, runs),
        pass(KernelId::GridScatter, 0, agents),
        pass(KernelId::GridScatter, 1, Extent::Invocations(step.cell_count.max(step.agent_count))),
        pass(KernelId::GridPack, 0, agents),
        pass(KernelId::Prefer, 0, agents),
    ];
    if step.group_count > 0 {
        passes.push(pass(KernelId::Accompany, 0, agents));
    }
    passes.extend([
        pass(KernelId::LeadAgents, 1, agents),
        pass(velocity_kernel(step.model), storeys, agents),
        pass(KernelId::Contain, 0, agents),
        pass(KernelId::Integrate, 0, agents),
    ]);
    if step.led_count == 0 {
        passes.retain(|pass| pass.kernel != KernelId::LeadAgents);
    }
    if step.obstacle_count == 0 {
        passes.retain(|pass| pass.kernel != KernelId::Contain);
    }
    passes
}

/// Whether agents must take turns in looking at the user: more might than may.
pub const fn has_turns(frame: &FrameUniforms) -> bool {
    frame.gaze_limit > 1 && frame.gaze_limit <= frame.agent_count
}

/// The kernel that avoids others, by the number of its model ([`StepUniforms`]' `model`).
pub const fn velocity_kernel(model: u32) -> KernelId {
    match model {
        1 => KernelId::VelocityRvo,
        _ => KernelId::VelocityOrca,
    }
}

/// Numbers of models.
pub const MODELS: std::ops::Range<u32> = 0..2;

/// The launches that prepare the bodies for one picture.
pub fn frame_passes(frame: &FrameUniforms) -> Vec<Pass> {
    let agents = frame.agent_count;
    let runs = Extent::Invocations(agents.div_ceil(RUN));
    let avatars = frame.bucket_count / frame.level_count.max(1);
    let pass = |kernel, level, extent| Pass { kernel, level, extent };
    let per_visible = Extent::Indirect(BufferId::DispatchArgs, 0);
    let mut passes = vec![
        pass(KernelId::Cull, 0, Extent::Invocations(agents)),
        pass(KernelId::Compact, 0, runs),
        pass(KernelId::Compact, 1, Extent::Invocations(2)),
        pass(KernelId::Compact, 2, runs),
        pass(KernelId::Compact, 3, Extent::Invocations(COLUMNS as u32)),
        pass(KernelId::Compact, 4, Extent::Invocations(1)),
        pass(KernelId::Compact, 5, runs),
        pass(KernelId::Pose, 0, per_visible),
    ];
    if has_turns(frame) {
        let one = Extent::Invocations(1);
        let levels = [per_visible, one, per_visible, one, per_visible];
        passes.extend((0..).zip(levels).map(|(level, extent)| pass(KernelId::Attend, level, extent)));
    }
    passes.push(pass(KernelId::Gaze, 0, per_visible));
    passes.push(pass(KernelId::Palette, 0, per_visible));
    for avatar in 0..avatars {
        passes.push(pass(KernelId::Skin, avatar, Extent::Indirect(BufferId::DispatchArgs, 3 + 3 * avatar)));
    }
    passes
}
