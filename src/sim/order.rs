//! The order of the kernels in one step and in one picture, once, for both backends.

use crate::kernels::compact::COLUMNS;
use crate::kernels::layout::{FlowUniforms, FrameUniforms, StepUniforms};
use crate::kernels::shared::contents::{CROWDED, GROUPS, STOREYS, UNLIKE, USER, WALLS};
use crate::kernels::shared::dispatch::RUN;
use crate::kernels::{BufferId, Extent, KernelId, Pass, Phase};

/// The launches of one step.
pub fn step_passes(step: &StepUniforms) -> Vec<Pass> {
    let agents = |phase| Pass::of(phase, step.agent_count);
    let runs = |phase| Pass::of(phase, step.cell_count.div_ceil(RUN));
    let contents = contents(step);
    let mut passes = vec![
        Pass::of(Phase::FollowPaths, step.path_count),
        agents(Phase::LeadAgentsAppear),
        agents(Phase::Teleport),
        agents(Phase::Journey),
        Pass::of(Phase::Queue, step.queue_count),
        agents(Phase::GridCount),
        runs(Phase::GridScanSum),
        Pass::of(Phase::GridScanRuns, 1),
        runs(Phase::GridScanCells),
        agents(Phase::GridScatterPlace),
        Pass::of(Phase::GridScatterSort, step.cell_count.max(step.agent_count)),
        agents(Phase::GridPack).with(contents),
        agents(Phase::Hear),
        agents(Phase::Feel),
        agents(Phase::Express),
    ];
    if step.source_count > 0 {
        passes.push(Pass::of(Phase::Enter, step.source_count));
    }
    passes.push(agents(Phase::Prefer));
    if step.group_count > 0 {
        passes.push(agents(Phase::Accompany));
    }
    if step.step_index < step.reaction_steps {
        passes.push(agents(Phase::React));
    }
    let [first, again] = velocity_phases(step.model);
    passes.extend([
        agents(Phase::LeadAgentsSteer),
        agents(Phase::PersevereTurns),
        agents(Phase::PersevereWalls),
        agents(first).with(contents),
        Pass::new(again, Extent::Indirect(BufferId::Unsolved, 0)).with(contents),
        agents(Phase::Contain),
        agents(Phase::Integrate),
    ]);
    if step.floor_count > 0 {
        passes.push(agents(Phase::Elevate));
    }
    passes.retain(|pass| match pass.phase {
        Phase::LeadAgentsAppear | Phase::LeadAgentsSteer => step.led_count > 0,
        Phase::FollowPaths => step.path_count > 0,
        Phase::Hear | Phase::Feel | Phase::Express => step.feels > 0,
        Phase::PersevereTurns => step.patience > 0.0,
        Phase::PersevereWalls => step.patience > 0.0 && step.obstacle_count > 0,
        Phase::Teleport => step.teleport_count > 0,
        Phase::Queue => step.queue_count > 0,
        Phase::Contain => step.obstacle_count > 0,
        _ => true,
    });
    passes
}

/// What there is in a crowd, as flags of the immediate `contents`.
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
    .fold(0, |contents, (bit, _)| contents | bit)
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

/// Its phases: the first attempt of all, and what comes after it for those who have to try again.
const fn velocity_phases(model: u32) -> [Phase; 2] {
    match velocity_kernel(model) {
        KernelId::VelocityRvo => [Phase::VelocityRvo, Phase::VelocityRvoAgain],
        _ => [Phase::VelocityOrca, Phase::VelocityOrcaAgain],
    }
}

/// Numbers of models.
pub const MODELS: std::ops::Range<u32> = 0..2;

/// The launches that count people on the flow grid and price its cells by their density.
pub fn density_passes(step: &StepUniforms, grid: &FlowUniforms) -> Vec<Pass> {
    vec![
        Pass::of(Phase::FlowDensityClear, grid.cell_count),
        Pass::of(Phase::FlowDensityCount, step.agent_count),
        Pass::of(Phase::FlowDensityRows, grid.cell_count),
        Pass::of(Phase::FlowDensityCost, grid.cell_count),
    ]
}

/// The launches that begin to solve the fields.
pub fn flow_start(grid: &FlowUniforms) -> Vec<Pass> {
    vec![Pass::of(Phase::FlowReset, tiles_or_lists(grid)), Pass::of(Phase::FlowSow, grid.seed_count)]
}

/// The launch after whose turns cells where nobody can stand have a way out, too.
pub fn flow_solid(grid: &FlowUniforms) -> Pass {
    Pass::of(Phase::FlowEnlistSolid, grid.field_count * grid.tile_columns * grid.tile_rows)
}

/// `count` turns from number `first`, before or after [`flow_solid`], for as long as there are tiles on the lists; more do no harm.
pub fn flow_turns(first: u32, count: u32, with_solid: bool) -> Vec<Pass> {
    let phase = if with_solid { Phase::FlowSweepSolid } else { Phase::FlowSweep };
    let turn = |number: u32| {
        let list = number % 4;
        Pass::new(phase, Extent::Indirect(BufferId::FlowArgs, 4 * list)).with(list)
    };
    (first..first + count).map(turn).collect()
}

/// The launch that joins sheets, where there are several: if it puts tiles on lists, the turns go on from one whose number
/// is a multiple of four.
pub fn flow_joint(grid: &FlowUniforms) -> Pass {
    Pass::of(Phase::FlowJoin, grid.field_count * grid.joint_count)
}

/// The launches that end it.
pub fn flow_end(grid: &FlowUniforms) -> Vec<Pass> {
    vec![Pass::of(Phase::FlowPoint, tiles_or_lists(grid)), Pass::of(Phase::FlowMark, grid.seed_count)]
}

fn tiles_or_lists(grid: &FlowUniforms) -> u32 {
    // at least the four lists
    (grid.field_count * grid.tile_columns * grid.tile_rows).max(4)
}

/// The launches before a picture that shows what lies between two moments: the present one is kept at a place first, if
/// it is to be.
pub fn between_passes(agent_count: u32, keep: Option<u32>) -> Vec<Pass> {
    let keep = keep.map(|place| Pass::of(Phase::Remember, agent_count).with(place));
    keep.into_iter().chain([Pass::of(Phase::Interpolate, agent_count)]).collect()
}

/// The launches that mark where the picture's depth is wanted to see who is hidden.
pub fn marking_passes(agent_count: u32) -> Vec<Pass> {
    vec![Pass::of(Phase::OccludeMark, agent_count)]
}

/// The launches that leave out who is hidden behind that depth.
pub fn sifting_passes(agent_count: u32) -> Vec<Pass> {
    // at least as many as there are buckets
    let runs = agent_count.div_ceil(RUN).max(COLUMNS);
    vec![
        Pass::of(Phase::OccludeJudge, agent_count),
        Pass::of(Phase::AdmitCount, runs),
        Pass::of(Phase::AdmitScan, 1),
        Pass::of(Phase::AdmitList, runs),
    ]
}

/// The launches that prepare the bodies for one picture.
pub fn frame_passes(frame: &FrameUniforms) -> Vec<Pass> {
    let runs = |phase| Pass::of(phase, frame.agent_count.div_ceil(RUN));
    let avatars = frame.bucket_count / frame.level_count.max(1);
    let per_visible = |phase| Pass::new(phase, Extent::Indirect(BufferId::DispatchArgs, 0));
    let mut passes = vec![
        Pass::of(Phase::Cull, frame.agent_count),
        runs(Phase::CompactCount),
        Pass::of(Phase::CompactScanVisible, 2),
        runs(Phase::CompactDemote),
        Pass::of(Phase::CompactScanBuckets, COLUMNS),
        Pass::of(Phase::CompactArguments, 1),
        runs(Phase::CompactList),
        per_visible(Phase::Pose),
        per_visible(Phase::Stand),
    ];
    if has_turns(frame) {
        passes.extend([
            per_visible(Phase::AttendLook),
            Pass::of(Phase::AttendBorder, 1),
            per_visible(Phase::AttendCount),
            Pass::of(Phase::AttendLeast, 1),
            per_visible(Phase::AttendBegin),
        ]);
    }
    passes.push(per_visible(Phase::Gaze));
    passes.push(per_visible(Phase::Palette));
    for avatar in 0..avatars {
        let near = Extent::Indirect(BufferId::DispatchArgs, 3 + 3 * avatar);
        passes.push(Pass::new(Phase::Skin, near).with(avatar));
    }
    passes
}
