//! The order of the kernels in one step and in one picture, once, for both backends.

use crate::kernels::compact::COLUMNS;
use crate::kernels::layout::{FlowUniforms, FrameUniforms, StepUniforms};
use crate::kernels::shared::contents::{CROWDED, GROUPS, STOREYS, UNLIKE, USER, WALLS};
use crate::kernels::shared::dispatch::RUN;
use crate::kernels::{BufferId, Extent, KernelId, Pass, Phase};

/// The schedule of one step, from top to bottom: whether a launch is due, and the launch.
pub fn step_passes(step: &StepUniforms) -> Vec<Pass> {
    let agents = |phase| Pass::of(phase, step.agent_count);
    let runs = |phase| Pass::of(phase, step.cell_count.div_ceil(RUN));
    let contents = contents(step);
    let [first, again] = velocity_phases(step.model);
    let (is_led, feels, is_patient) = (step.led_count > 0, step.feels > 0, step.patience > 0.0);
    let has_walls = step.obstacle_count > 0;
    due([
        (step.path_count > 0, Pass::of(Phase::FollowPaths, step.path_count)),
        (is_led, agents(Phase::LeadAgentsAppear)),
        (step.teleport_count > 0, agents(Phase::Teleport)),
        (true, agents(Phase::Journey)),
        (step.queue_count > 0, Pass::of(Phase::Queue, step.queue_count)),
        (true, agents(Phase::GridCount)),
        (true, runs(Phase::GridScanSum)),
        (true, Pass::of(Phase::GridScanRuns, 1)),
        (true, runs(Phase::GridScanCells)),
        (true, agents(Phase::GridScatterPlace)),
        (true, Pass::of(Phase::GridScatterSort, step.cell_count.max(step.agent_count))),
        (true, agents(Phase::GridPack).with(contents)),
        (feels, agents(Phase::Hear)),
        (feels, agents(Phase::Feel)),
        (feels, agents(Phase::Express)),
        (step.source_count > 0, Pass::of(Phase::Enter, step.source_count)),
        (true, agents(Phase::Prefer)),
        (step.group_count > 0, agents(Phase::Accompany)),
        (step.step_index < step.reaction_steps, agents(Phase::React)),
        (is_led, agents(Phase::LeadAgentsSteer)),
        (is_patient, agents(Phase::PersevereTurns)),
        (is_patient && has_walls, agents(Phase::PersevereWalls)),
        (true, agents(first).with(contents)),
        (true, Pass::new(again, Extent::Indirect(BufferId::Unsolved, 0)).with(contents)),
        (has_walls, agents(Phase::Contain)),
        (true, agents(Phase::Integrate)),
        (step.floor_count > 0, agents(Phase::Elevate)),
    ])
}

/// The launches of a schedule that are due, in its order.
fn due<const N: usize>(schedule: [(bool, Pass); N]) -> Vec<Pass> {
    schedule.into_iter().filter(|(is_due, _)| *is_due).map(|(_, pass)| pass).collect()
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

/// Its phases: the first attempt of all agents, then the second one of agents whose first attempt failed.
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

/// The launch that enlists tiles with solid cells. After the sweeps that follow, solid cells lead out, too.
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

/// The schedule of the bodies for one picture, from top to bottom: whether a launch is due, and the launch.
pub fn frame_passes(frame: &FrameUniforms) -> Vec<Pass> {
    let runs = |phase| Pass::of(phase, frame.agent_count.div_ceil(RUN));
    let per_visible = |phase| Pass::new(phase, Extent::Indirect(BufferId::DispatchArgs, 0));
    let takes_turns = has_turns(frame);
    let mut passes = due([
        (true, Pass::of(Phase::Cull, frame.agent_count)),
        (true, runs(Phase::CompactCount)),
        (true, Pass::of(Phase::CompactScanVisible, 2)),
        (true, runs(Phase::CompactDemote)),
        (true, Pass::of(Phase::CompactScanBuckets, COLUMNS)),
        (true, Pass::of(Phase::CompactArguments, 1)),
        (true, runs(Phase::CompactList)),
        (true, per_visible(Phase::Pose)),
        (true, per_visible(Phase::Stand)),
        (takes_turns, per_visible(Phase::AttendLook)),
        (takes_turns, Pass::of(Phase::AttendBorder, 1)),
        (takes_turns, per_visible(Phase::AttendCount)),
        (takes_turns, Pass::of(Phase::AttendLeast, 1)),
        (takes_turns, per_visible(Phase::AttendBegin)),
        (true, per_visible(Phase::Gaze)),
        (true, per_visible(Phase::Palette)),
    ]);
    let avatars = frame.bucket_count / frame.level_count.max(1);
    passes.extend((0..avatars).map(|avatar| {
        let near = Extent::Indirect(BufferId::DispatchArgs, 3 + 3 * avatar);
        Pass::new(Phase::Skin, near).with(avatar)
    }));
    passes
}
