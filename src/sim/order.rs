//! The order of the kernels in one step and in one picture, once, for both backends.

use crate::kernels::compact::index::COLUMNS;
use crate::kernels::layout::{FlowUniforms, FrameUniforms, StepUniforms};
use crate::kernels::shared::dispatch::RUN;
use crate::kernels::shared::step::{AGAIN, CROWDED, GROUPS, STOREYS, UNLIKE, USER, WALLS};
use crate::kernels::{BufferId, Extent, KernelId, Pass};

/// The launches of one step.
pub fn step_passes(step: &StepUniforms) -> Vec<Pass> {
    let agents = Extent::Invocations(step.agent_count);
    let runs = Extent::Invocations(step.cell_count.div_ceil(RUN));
    let pass = |kernel, level, extent| Pass { kernel, level, extent };
    let mut passes = vec![
        pass(KernelId::FollowPaths, 0, Extent::Invocations(step.path_count)),
        pass(KernelId::LeadAgents, 0, agents),
        pass(KernelId::Teleport, 0, agents),
        pass(KernelId::Journey, 0, agents),
        pass(KernelId::Queue, 0, Extent::Invocations(step.queue_count)),
        pass(KernelId::GridCount, 0, agents),
        pass(KernelId::GridScan, 0, runs),
        pass(KernelId::GridScan, 1, Extent::Invocations(1)),
        pass(KernelId::GridScan, 2, runs),
        pass(KernelId::GridScatter, 0, agents),
        pass(KernelId::GridScatter, 1, Extent::Invocations(step.cell_count.max(step.agent_count))),
        pass(KernelId::GridPack, contents(step), agents),
        pass(KernelId::Hear, 0, agents),
        pass(KernelId::Feel, 0, agents),
        pass(KernelId::Express, 0, agents),
    ];
    if step.source_count > 0 {
        passes.push(pass(KernelId::Enter, 0, Extent::Invocations(step.source_count)));
    }
    passes.push(pass(KernelId::Prefer, 0, agents));
    if step.group_count > 0 {
        passes.push(pass(KernelId::Accompany, 0, agents));
    }
    if step.step_index < step.reaction_steps {
        passes.push(pass(KernelId::React, 0, agents));
    }
    passes.extend([
        pass(KernelId::LeadAgents, 1, agents),
        pass(KernelId::Persevere, 0, agents),
        pass(KernelId::Persevere, 1, agents),
        pass(velocity_kernel(step.model), contents(step), agents),
    ]);
    passes.extend([
        pass(velocity_kernel(step.model), contents(step) | AGAIN, Extent::Indirect(BufferId::Unsolved, 0)),
        pass(KernelId::Contain, 0, agents),
        pass(KernelId::Integrate, 0, agents),
    ]);
    if step.floor_count > 0 {
        passes.push(pass(KernelId::Elevate, 0, agents));
    }
    passes.retain(|pass| match pass.kernel {
        KernelId::LeadAgents => step.led_count > 0,
        KernelId::FollowPaths => step.path_count > 0,
        KernelId::Hear | KernelId::Feel | KernelId::Express => step.feels > 0,
        KernelId::Persevere => step.patience > 0.0 && (pass.level == 0 || step.obstacle_count > 0),
        KernelId::Teleport => step.teleport_count > 0,
        KernelId::Queue => step.queue_count > 0,
        KernelId::Contain => step.obstacle_count > 0,
        _ => true,
    });
    passes
}

/// What there is in a crowd, as bits of a level.
fn contents(step: &StepUniforms) -> u32 {
    [
        (STOREYS, step.storey_height > 0.0),
        // with patience, and in groups, some are given the right of way for a while
        (UNLIKE, step.alike == 0 || step.patience > 0.0 || step.group_count > 0),
        (WALLS, step.obstacle_count > 0),
        (USER, step.user_radius > 0.0),
        (CROWDED, step.crowding > 0.0),
        (GROUPS, step.group_count > 0),
    ]
    .into_iter()
    .filter(|(_, is_there)| *is_there)
    .fold(0, |level, (bit, _)| level | bit)
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

/// The launches that count people on the flow grid and price its cells by their density.
pub fn density_passes(step: &StepUniforms, grid: &FlowUniforms) -> Vec<Pass> {
    let pass =
        |level, count| Pass { kernel: KernelId::FlowDensity, level, extent: Extent::Invocations(count) };
    vec![
        pass(0, grid.cell_count),
        pass(1, step.agent_count),
        pass(2, grid.cell_count),
        pass(3, grid.cell_count),
    ]
}

/// The launches that begin to solve the fields.
pub fn flow_start(grid: &FlowUniforms) -> Vec<Pass> {
    vec![flow_pass(0, tiles_or_lists(grid)), flow_pass(1, grid.seed_count)]
}

/// The launch after whose turns cells where nobody can stand have a way out, too.
pub fn flow_solid(grid: &FlowUniforms) -> Pass {
    flow_pass(6, grid.field_count * grid.tile_columns * grid.tile_rows)
}

/// `count` turns from number `first`, before or after [`flow_solid`], for as long as there are tiles on the lists; more do no harm.
pub fn flow_turns(first: u32, count: u32, with_solid: bool) -> Vec<Pass> {
    let turn = |number: u32| Pass {
        kernel: KernelId::Flow,
        level: if with_solid { 7 } else { 2 } + number % 4,
        extent: Extent::Indirect(BufferId::FlowArgs, 4 * (number % 4)),
    };
    (first..first + count).map(turn).collect()
}

/// The launch that joins sheets, where there are several: if it puts tiles on lists, the turns go on from one whose number
/// is a multiple of four.
pub fn flow_joint(grid: &FlowUniforms) -> Pass {
    flow_pass(13, grid.field_count * grid.joint_count)
}

/// The launches that end it.
pub fn flow_end(grid: &FlowUniforms) -> Vec<Pass> {
    vec![flow_pass(11, tiles_or_lists(grid)), flow_pass(12, grid.seed_count)]
}

fn flow_pass(level: u32, count: u32) -> Pass {
    Pass { kernel: KernelId::Flow, level, extent: Extent::Invocations(count) }
}

fn tiles_or_lists(grid: &FlowUniforms) -> u32 {
    // at least the four lists
    (grid.field_count * grid.tile_columns * grid.tile_rows).max(4)
}

/// The launches before a picture that shows what lies between two moments: the present one is kept at a place first, if
/// it is to be.
pub fn between_passes(agent_count: u32, keep: Option<u32>) -> Vec<Pass> {
    let extent = Extent::Invocations(agent_count);
    let keep = keep.map(|place| Pass { kernel: KernelId::Remember, level: place, extent });
    keep.into_iter().chain([Pass { kernel: KernelId::Interpolate, level: 0, extent }]).collect()
}

/// The launches that mark where the picture's depth is wanted to see who is hidden.
pub fn marking_passes(agent_count: u32) -> Vec<Pass> {
    vec![Pass { kernel: KernelId::Occlude, level: 0, extent: Extent::Invocations(agent_count) }]
}

/// The launches that leave out who is hidden behind that depth.
pub fn sifting_passes(agent_count: u32) -> Vec<Pass> {
    let pass = |kernel, level, count| Pass { kernel, level, extent: Extent::Invocations(count) };
    // at least as many as there are buckets
    let runs = agent_count.div_ceil(RUN).max(COLUMNS as u32);
    vec![
        pass(KernelId::Occlude, 1, agent_count),
        pass(KernelId::Admit, 0, runs),
        pass(KernelId::Admit, 1, 1),
        pass(KernelId::Admit, 2, runs),
    ]
}

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
        pass(KernelId::Stand, 0, per_visible),
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
