//! The crowds that are timed, and what they look like.

use crate::avatar::{self, Sex};
use crate::emotion::Emotion;
use crate::gait::walker;
use crate::kernels::layout::{Appearance, Attention, GazeState};
use crate::kernels::{BufferId, Store};
use crate::reference::exact::hash_u32;
use crate::sim::bodies::{self, MeshBuffers};
use crate::sim::{AvatarSet, Simulation, order};
use crate::verify::cases::crossing::{CrossingQuality, crossing, crossing_quality};
use serde::Serialize;

/// Metres between agents of the crossing: one to a square metre.
pub(super) const SPACING: f32 = 1.0;
/// Height of the user's eyes, m.
pub(super) const EYE_HEIGHT: f32 = 1.65;

/// What the crowd of the timed steps looked like at their end: speed means nothing without it.
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quality {
    /// Name of the row whose crowd this is.
    pub name: &'static str,
    /// Agents.
    pub agents: usize,
    /// Steps since the start.
    pub steps: u32,
    /// Pairs closer than 0.99 of the summed radii, per agent.
    pub overlapping: f64,
    /// Pairs closer than 0.9 of the summed radii, per agent.
    pub deep: f64,
    /// Smallest distance between two agents, m.
    pub min_distance: f64,
    /// Mean velocity along the wanted direction, m/s (wanted: 1.3).
    pub progress: f64,
    /// Bytes of all buffers of a step, over the agents.
    pub bytes_per_agent: f64,
}

/// What a crossing looks like now; `name` is that of the row which it belongs to.
pub(super) fn quality_of(
    name: &'static str,
    agents: usize,
    simulation: &mut Simulation,
) -> Result<Quality, crate::Error> {
    let bytes = step_bytes(simulation);
    let steps = simulation.steps_done();
    let CrossingQuality { overlapping, deep, min_distance, progress } = crossing_quality(simulation.state()?);
    #[allow(clippy::cast_precision_loss, reason = "up to gigabytes")]
    let bytes_per_agent = bytes as f64 / agents.max(1) as f64;
    Ok(Quality { name, agents, steps, overlapping, deep, min_distance, progress, bytes_per_agent })
}

/// Bytes of the buffers that a step touches.
pub(super) fn step_bytes(simulation: &Simulation) -> usize {
    let store = simulation.store();
    let mut buffers: Vec<BufferId> = order::step_dispatches(&store.step)
        .iter()
        .flat_map(|dispatch| dispatch.phase.entry().bindings.iter().map(|binding| binding.buffer))
        .collect();
    buffers.sort_unstable();
    buffers.dedup();
    buffers.into_iter().map(|buffer| store.bytes(buffer).len()).sum()
}

/// One gait of each emotion on the two generated bodies.
pub(super) fn cast() -> Result<AvatarSet, crate::Error> {
    let gaits = Emotion::ALL.map(|emotion| walker::person(emotion, walker::Sex::Female, 1, 0));
    let gaits = gaits.into_iter().collect::<Result<Vec<_>, _>>()?;
    let cast = AvatarSet::new(&gaits, Sex::ALL.map(avatar::generated).to_vec())?;
    Ok(cast)
}

/// A crowd as a simulation has it: nothing is measured in its steps, and all avoid others alike.
pub(super) fn plain(mut store: Store) -> Store {
    (store.step.measured, store.step.alike) = (0, 1);
    store
}

/// A crowd of agents without bodies, as peers have them: they neither turn nor walk on feet. Nothing is kept for kernels that do
/// not run.
pub(super) fn bare(store: Store) -> Store {
    let mut store = Store {
        heading: Vec::new(),
        stance: Vec::new(),
        waiting: Vec::new(),
        companions: Vec::new(),
        entry: Vec::new(),
        teleport_of: Vec::new(),
        reaction: Vec::new(),
        seen: Vec::new(),
        cell_depth: Vec::new(),
        ..plain(store)
    };
    store.step.bare = 1;
    store
}

/// The crossing of bare agents with bodies, and their meshes.
pub(super) fn dressed(agents: usize) -> Result<(Store, MeshBuffers), crate::Error> {
    let cast = cast()?;
    let mut store = plain(crossing(agents, SPACING));
    dress(&mut store, &cast);
    let meshes = bodies::fill(&mut store, &cast, bodies::SMALLEST_STORAGE_RANGE);
    // as the people of scenes
    store.frame.individuals = 1.0;
    Ok((store, meshes))
}

/// Gives the agents of a bare crowd a body, a gait and an emotion each.
pub(super) fn dress(store: &mut Store, cast: &AvatarSet) {
    for agent in 0..store.step.agent_count {
        let dice = hash_u32(agent);
        let (avatar, emotion) = (dice & 1, dice >> 1 & 3);
        store.appearance.push(Appearance {
            skin_and_hair: dice,
            top_and_bottom: hash_u32(dice),
            ..Appearance::new(avatar, emotion, true, 1.0, [0; 4])
        });
        store.gaits.push([cast.clip_index(avatar, emotion); 4]);
        store.gait_weights.push([1.0, 0.0, 0.0, 0.0]);
        store.gaze_state.push(GazeState::default());
        store.gaze_frame.push(u32::MAX);
        store.attention.push(Attention::default());
    }
}
