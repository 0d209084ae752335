//! The order of the kernels in one step and in one frame, once, for both backends.

use crate::kernels::layout::{FlowUniforms, FrameUniforms, StepUniforms};
use crate::kernels::shared::cells::LANE_CELLS;
use crate::kernels::shared::ranks::COLUMNS;
use crate::kernels::shared::scan::LANES;
use crate::kernels::{BufferId, Dispatch, Extent, KernelId, Phase, Store};

/// The schedule of one step, from top to bottom: whether a dispatch is due, and the dispatch.
pub fn step_dispatches(step: &StepUniforms) -> Vec<Dispatch> {
    let agents = |phase| Dispatch::of(phase, step.agent_count);
    let agents_and_cells = |phase| Dispatch::of(phase, step.cell_count.max(step.agent_count));
    let contents = step.contents();
    let [first, again] = velocity_phases(step.model);
    let (is_led, feels, is_patient) = (step.led_count > 0, step.feels > 0, step.patience > 0.0);
    let has_walls = step.obstacle_count > 0;
    due([
        (step.path_count > 0, Dispatch::of(Phase::FollowPaths, step.path_count)),
        (is_led, agents(Phase::LeadAgentsAppear)),
        (step.teleport_count > 0, agents(Phase::Teleport)),
        (true, agents(Phase::AdvanceJourney)),
        (step.queue_count > 0, Dispatch::of(Phase::Queue, step.queue_count)),
        (true, Dispatch::of(Phase::GridScan, step.cell_count.div_ceil(LANE_CELLS))),
        (true, agents_and_cells(Phase::GridScatter).with(contents)),
        (feels, agents(Phase::EmotionGather)),
        (feels, agents(Phase::EmotionUpdate)),
        (feels, agents(Phase::EmotionApply)),
        (step.source_count > 0, Dispatch::of(Phase::Spawn, step.source_count)),
        (step.group_count > 0, agents(Phase::GroupCohesion)),
        (step.step_index < step.reaction_steps, agents(Phase::React)),
        (is_led, agents(Phase::LeadAgentsSteer)),
        (is_patient, agents(Phase::UnjamTurns)),
        (is_patient && has_walls, agents(Phase::UnjamWalls)),
        (true, agents(first).with(contents)),
        (true, Dispatch::new(again, Extent::Indirect(BufferId::Unsolved, 0)).with(contents)),
        (has_walls, agents(Phase::ClipToWalls)),
        (true, agents_and_cells(Phase::Integrate).with(contents)),
        (step.floor_count > 0, agents(Phase::Elevate)),
        (step.measured > 0, agents(Phase::Measure)),
    ])
}

/// The dispatches of a schedule that are due, in its order.
fn due<const N: usize>(schedule: [(bool, Dispatch); N]) -> Vec<Dispatch> {
    schedule.into_iter().filter(|(is_due, _)| *is_due).map(|(_, dispatch)| dispatch).collect()
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

/// The dispatches that count people on the flow grid and price its cells by their density.
pub fn density_dispatches(step: &StepUniforms, grid: &FlowUniforms) -> Vec<Dispatch> {
    vec![
        Dispatch::of(Phase::FlowDensityClear, grid.cell_count),
        Dispatch::of(Phase::FlowDensityCount, step.agent_count),
        Dispatch::of(Phase::FlowDensityRows, grid.cell_count),
        Dispatch::of(Phase::FlowDensityCost, grid.cell_count),
    ]
}

/// The dispatches that begin to solve the fields.
pub fn flow_start(grid: &FlowUniforms) -> Vec<Dispatch> {
    vec![Dispatch::of(Phase::FlowReset, tiles_or_lists(grid)), Dispatch::of(Phase::FlowSow, grid.seed_count)]
}

/// The dispatch that enlists tiles with solid cells. After the sweeps that follow, solid cells lead out, too.
pub fn flow_solid(grid: &FlowUniforms) -> Dispatch {
    Dispatch::of(Phase::FlowEnlistSolid, grid.field_count * grid.tile_columns * grid.tile_rows)
}

/// `count` turns from number `first`, before or after [`flow_solid`], for as long as there are tiles on the lists; more do no harm.
pub fn flow_turns(first: u32, count: u32, with_solid: bool) -> Vec<Dispatch> {
    let phase = if with_solid { Phase::FlowSweepSolid } else { Phase::FlowSweep };
    let turn = |number: u32| {
        let list = number % 4;
        Dispatch::new(phase, Extent::Indirect(BufferId::FlowArgs, 4 * list)).with(list)
    };
    (first..first + count).map(turn).collect()
}

/// The dispatch that joins sheets, where there are several. If it puts tiles on lists, the turns go on from one whose number
/// is a multiple of four.
pub fn flow_joint(grid: &FlowUniforms) -> Dispatch {
    Dispatch::of(Phase::FlowJoin, grid.field_count * grid.joint_count)
}

/// The dispatches that end it.
pub fn flow_end(grid: &FlowUniforms) -> Vec<Dispatch> {
    vec![Dispatch::of(Phase::FlowPoint, tiles_or_lists(grid)), Dispatch::of(Phase::FlowMark, grid.seed_count)]
}

fn tiles_or_lists(grid: &FlowUniforms) -> u32 {
    // at least the four lists
    (grid.field_count * grid.tile_columns * grid.tile_rows).max(4)
}

/// The dispatches before a frame that shows the crowd between two snapshots. With `keep` the first keeps the present snapshot
/// at that place.
pub fn between_dispatches(agent_count: u32, keep: Option<u32>) -> Vec<Dispatch> {
    let keep = keep.map(|place| Dispatch::of(Phase::KeepSnapshot, agent_count).with(place));
    keep.into_iter().chain([Dispatch::of(Phase::Interpolate, agent_count)]).collect()
}

/// The dispatches that mark where the occlusion test needs the image's depth.
pub fn marking_dispatches(agent_count: u32) -> Vec<Dispatch> {
    vec![Dispatch::of(Phase::OccludeMark, agent_count)]
}

/// The dispatches that leave out agents hidden behind that depth.
pub fn occlusion_dispatches(agent_count: u32) -> Vec<Dispatch> {
    vec![
        Dispatch::of(Phase::OccludeJudge, agent_count),
        Dispatch::of(Phase::OcclusionCompactCount, agent_count),
        Dispatch::of(Phase::OcclusionCompactScan, LANES),
        // the end of the last bucket, too
        Dispatch::of(Phase::OcclusionCompactStarts, agent_count + 1),
        Dispatch::of(Phase::OcclusionCompactList, agent_count.max(COLUMNS)),
    ]
}

/// The schedule of the bodies for one frame, from top to bottom: whether a dispatch is due, and the dispatch.
pub fn frame_dispatches(frame: &FrameUniforms) -> Vec<Dispatch> {
    let agents = |phase| Dispatch::of(phase, frame.agent_count);
    let per_visible = |phase| Dispatch::new(phase, Extent::Indirect(BufferId::DispatchArgs, 0));
    let takes_turns = has_turns(frame);
    let [.., far_distance] = frame.level_distance;
    let mut dispatches = due([
        (true, agents(Phase::Cull)),
        (true, agents(Phase::CompactCount)),
        (true, Dispatch::of(Phase::CompactScanVisible, 2 * LANES)),
        (true, agents(Phase::CompactDemote)),
        (true, Dispatch::of(Phase::CompactScanBuckets, COLUMNS * LANES)),
        (true, Dispatch::of(Phase::CompactArguments, LANES)),
        (true, agents(Phase::CompactList)),
        (far_distance > 0.0, agents(Phase::PoseFar)),
        (true, per_visible(Phase::Pose)),
        (true, per_visible(Phase::Feet)),
        (frame.individuals > 0.0, per_visible(Phase::Manner)),
        (true, per_visible(Phase::Idle)),
        (true, per_visible(Phase::Stand)),
        (takes_turns, per_visible(Phase::GazeScheduleLook)),
        (takes_turns, Dispatch::of(Phase::GazeScheduleBorder, LANES)),
        (takes_turns, per_visible(Phase::GazeScheduleCount)),
        (takes_turns, Dispatch::of(Phase::GazeScheduleLeast, LANES)),
        (takes_turns, per_visible(Phase::GazeScheduleBegin)),
        (true, per_visible(Phase::Gaze)),
        (true, per_visible(Phase::Palette)),
        (true, per_visible(Phase::Eyes)),
    ]);
    let avatars = frame.bucket_count / frame.level_count.max(1);
    dispatches.extend((0..avatars).map(|avatar| {
        let near = Extent::Indirect(BufferId::DispatchArgs, 3 + 3 * avatar);
        Dispatch::new(Phase::Skin, near).with(avatar)
    }));
    dispatches
}

/// The kernels of a crowd's steps and frames.
pub fn kernels(store: &Store) -> Vec<KernelId> {
    let model = velocity_kernel(store.step.model);
    let others = MODELS.map(velocity_kernel).filter(|kernel| *kernel != model);
    let others: Vec<KernelId> =
        others.chain([KernelId::Arithmetic, KernelId::Numerics, KernelId::GaitFeatures]).collect();
    let has_snapshots = !store.snapshots.is_empty();
    let is_wanted = |kernel: &KernelId| {
        !others.contains(kernel)
            && (has_snapshots || !matches!(kernel, KernelId::KeepSnapshot | KernelId::Interpolate))
    };
    KernelId::ALL.into_iter().filter(is_wanted).collect()
}
