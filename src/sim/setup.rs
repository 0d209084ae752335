//! The buffers of a simulation at its start.

use super::avatar_set::AvatarSet;
use super::obstacles::{at_heights, cell_depth, cell_lists, segments};
use super::optional::{set_feelings, set_outsiders};
use crate::ground::is_absent;
use crate::kernels::layout::{
    Appearance, Attention, Avoidance, Body, GazeState, Lead, Paces, Route, Seen, Segment, SlotMotion, Source,
    Stage, Stance, StepUniforms, Teleport as Boxes, Waiting,
};
use crate::kernels::measure::index::MEASURED_STEPS;
use crate::kernels::shared::absent::{ABSENT, NOBODY};
use crate::kernels::shared::cells::index::CELL_WORDS;
use crate::kernels::shared::stages;
use crate::kernels::shared::step::LED;
use crate::kernels::shared::unsolved::index::LISTED;
use crate::kernels::{KernelId, Store};
use crate::reference::shared::step_word;
use crate::scenario::{
    self, AgentStart, Crowd, Entry, Floors, Geometry, Model, Navigation, Raised, Scenario, SourceStart, Stop,
    StopKind, Teleport,
};
use glam::Vec2;

/// An agent this much higher or lower is not in the way, m; only where there are floors.
const STOREY_HEIGHT: f32 = 2.0;
/// Body turns at most this fast, rad/s.
const TURN_RATE: f32 = 3.5;
/// How far ahead an agent sees how crowded it is, m.
const CROWDING_REACH: f32 = 1.05;
/// Below this share of its preferred speed a body blends to standing.
const WALK_SPEED: f32 = 0.12;
/// How fast it blends, 1/s.
const BLEND_RATE: f32 = 2.5;
/// Agents that a cell should hold where the crowd is evenly spread: best of four sizes measured on lavapipe.
const AGENTS_PER_CELL: f32 = 1.2;
/// No agent is faster than this times its maximum speed. The velocity that violates the least lines may be a little faster.
const EXCESS: f32 = 1.5;
/// Most cells of a grid.
const MAX_CELLS: f32 = 4_000_000.0;
/// `entry` of agents that never come in.
pub const NEVER: u32 = u32::MAX;

/// Fills every buffer that a step needs.
pub fn store(scenario: &Scenario, geometry: &Geometry, crowd: &Crowd, cast: &AvatarSet) -> Store {
    let mut store = Store { step: uniforms(scenario, geometry, crowd), ..Store::default() };
    for agent in crowd.agents.iter().chain(&crowd.external) {
        push_agent(&mut store, agent, &scenario.navigation, cast);
    }
    store.stages = crowd.stages.iter().map(stage).collect();
    crowd.stages.iter().for_each(|stop| set_queue(&mut store, stop));
    if store.stages.is_empty() {
        store.stages.push(Stage::waypoint([0.0, 0.0], 0.0));
    }
    for source in &crowd.sources {
        push_source(&mut store, source);
    }
    let polygons: Vec<Vec<[f32; 2]>> =
        geometry.outlines().map(|o| o.iter().map(Vec2::to_array).collect()).collect();
    set_raised_obstacles(&mut store, &polygons, &geometry.floors.raised);
    set_floors(&mut store, &geometry.floors);
    scratch(&mut store);
    store.step.group_count = groups(&store);
    set_outsiders(&mut store, scenario, crowd);
    set_feelings(&mut store, scenario, crowd, cast);
    store
}

/// Parameters of the first step.
fn uniforms(scenario: &Scenario, geometry: &Geometry, crowd: &Crowd) -> StepUniforms {
    let navigation = &scenario.navigation;
    let low = geometry.bounds.iter().copied().fold(Vec2::MAX, Vec2::min);
    let high = geometry.bounds.iter().copied().fold(Vec2::MIN, Vec2::max);
    let avoided = scenario.user.filter(|user| user.avoided);
    let mut step = StepUniforms {
        agent_count: (crowd.agents.len() + crowd.external.len()) as u32,
        source_count: crowd.sources.len() as u32,
        seed: (scenario.seed ^ (scenario.seed >> 32)) as u32,
        time_step: navigation.time_step,
        inverse_time_step: 1.0 / navigation.time_step,
        inverse_time_horizon_obstacles: 1.0 / navigation.time_horizon_obstacles,
        time_horizon_obstacles: navigation.time_horizon_obstacles,
        inverse_time_horizon_dense: inverse_or_none(navigation.time_horizon_dense),
        inverse_time_horizon_jam: inverse_or_none(navigation.time_horizon_jam),
        safety_margin: navigation.safety_margin,
        user_position: geometry.user.unwrap_or_default().to_array(),
        user_elevation: geometry.user_elevation,
        user_radius: avoided.map_or(0.0, |user| user.radius + user.comfort),
        turn_rate: TURN_RATE,
        perturbation: navigation.perturbation,
        walk_speed: WALK_SPEED,
        blend_rate: BLEND_RATE,
        responsibility: 0.5,
        crowding: navigation.crowding,
        crowding_reach: CROWDING_REACH,
        model: match navigation.model {
            Model::Orca => 0,
            Model::Rvo => 1,
        },
        collision_weight: navigation.collision_weight,
        max_acceleration: navigation.max_acceleration,
        patience: navigation.patience,
        ..StepUniforms::default()
    };
    set_grid(&mut step, low, high, geometry.walkable_area() as f32, navigation.neighbour_distance);
    step
}

/// 1 / `seconds`, or 0 for none.
fn inverse_or_none(seconds: f32) -> f32 {
    if seconds > 0.0 { 1.0 / seconds } else { 0.0 }
}

/// Lays the grid over a rectangle, with cells that hold about one agent on the walkable `area`, m².
///
/// Cells never exceed half the neighbour distance: with cells that large, two rings of them are always enough.
pub fn set_grid(step: &mut StepUniforms, low: Vec2, high: Vec2, area: f32, neighbour_distance: f32) {
    let extent = (high - low).max(Vec2::splat(1.0));
    let by_density = (AGENTS_PER_CELL * area.max(1.0) / step.agent_count.max(1) as f32).sqrt();
    let smallest = (extent.x * extent.y / MAX_CELLS).sqrt().max(0.5);
    step.cell_size = by_density.clamp(smallest, (0.5 * neighbour_distance).max(smallest));
    step.inverse_cell_size = 1.0 / step.cell_size;
    step.grid_origin = low.to_array();
    step.grid_columns = (extent.x / step.cell_size).ceil() as u32;
    step.grid_rows = (extent.y / step.cell_size).ceil() as u32;
    step.cell_count = step.grid_columns * step.grid_rows;
}

/// Puts obstacle polygons into the store; its bodies must be there, since their speed decides which segments they can reach.
pub fn set_obstacles(store: &mut Store, polygons: &[Vec<[f32; 2]>]) {
    set_raised_obstacles(store, polygons, &[]);
}

/// The same with obstacles that stand at some heights only.
pub fn set_raised_obstacles(store: &mut Store, polygons: &[Vec<[f32; 2]>], raised: &[Raised]) {
    let seconds = store.step.time_horizon_obstacles.max(store.step.time_step);
    let fastest = store.body.iter().map(|body| seconds * body.max_speed + body.radius).fold(0.0, f32::max);
    let mut all = segments(polygons);
    for solid in raised {
        let outline: Vec<[f32; 2]> = solid.outline.iter().map(Vec2::to_array).collect();
        all.extend(segments(&[outline]).into_iter().map(|s| at_heights(s, solid.low, solid.high)));
    }
    store.step.obstacle_count = all.len() as u32;
    store.obstacle_cells = cell_lists(&all, &store.step, fastest);
    store.cell_depth = cell_depth(&all, &store.step);
    store.obstacles = all;
    if store.obstacles.is_empty() {
        store.obstacles.push(Segment::default());
    }
}

/// Walking groups, counted by their first members.
fn groups(store: &Store) -> u32 {
    let is_first = |(agent, others): (usize, &[u32; 4])| {
        others.iter().any(|other| *other != NOBODY) && others.iter().all(|other| *other as usize > agent)
    };
    store.companions.iter().enumerate().map(|member| u32::from(is_first(member))).sum()
}

/// Lets agents of a store walk together (two to five; more are left out).
pub fn join(store: &mut Store, members: &[u32]) {
    store.companions.resize(store.position.len(), [NOBODY; 4]);
    for member in members.iter().take(5) {
        let mut others = members.iter().take(5).filter(|other| *other != member);
        store.companions[*member as usize] =
            std::array::from_fn(|_| others.next().copied().unwrap_or(NOBODY));
    }
    store.step.group_count += 1;
}

/// Puts floors into the store. With any, an agent on another storey is not in the way.
pub fn set_floors(store: &mut Store, floors: &Floors) {
    if floors.count() > 0 {
        store.step.floor_count = floors.count() as u32;
        store.step.storey_height = STOREY_HEIGHT;
        store.floors.clone_from(&floors.elements);
    }
}

/// The lists of the cells, empty, for as many agents.
pub fn empty_cells(store: &mut Store, agents: usize) {
    let cells = store.step.cell_count as usize;
    store.cells = vec![0; CELL_WORDS * cells];
    store.next_in_cell = vec![0; agents];
    store.cell_start = vec![0; step_word(&store.step) + 1];
}

/// What `measure` finds, with nothing measured yet.
pub fn nothing_measured(store: &mut Store) {
    let is_there = |position: &[f32; 2]| u32::from(!is_absent(*position));
    let unseen = |position| Seen { is_there: is_there(position), ..Seen::default() };
    store.seen = store.position.iter().map(unseen).collect();
    store.measured = vec![0; 1 + 2 * MEASURED_STEPS];
    store.measured[0] = u32::MAX;
    let bodies = || store.body.iter().take(store.step.agent_count as usize);
    let widest = bodies().map(|body| body.radius).fold(0.0, f32::max);
    let with_feelings = |own: &Paces| own.preferred_speeds.into_iter().fold(own.max_speed, f32::max);
    let speeds = bodies().map(|body| body.max_speed).chain(store.paces.iter().map(with_feelings));
    let led = if store.step.led_count > 0 { scenario::MAX_EXTERNAL_SPEED } else { 0.0 };
    let fastest = speeds.map(|speed| EXCESS * speed).fold(led, f32::max);
    (store.step.widest_radius, store.step.fastest) = (widest, fastest);
    store.cell_depth.resize(store.step.cell_count.max(1) as usize, 0);
}

/// Everything that a step writes before it reads, and empty journeys and sources where there are none.
pub fn scratch(store: &mut Store) {
    let agents = store.step.agent_count as usize;
    empty_cells(store, agents);
    store.step_count = vec![store.step.step_index];
    nothing_measured(store);
    store.agent_slot = vec![0; agents];
    store.unsolved = vec![0; LISTED + agents];
    store.slot_position = vec![[0.0; 2]; agents];
    store.slot_motion = vec![SlotMotion::default(); agents];
    store.new_velocity = vec![[0.0; 2]; agents];
    store.waiting = vec![Waiting::default(); agents];
    store.preferred_velocity = vec![[0.0; 2]; agents];
    store.floors.resize(store.floors.len().max(1), [0.0; 4]);
    store.companions.resize(agents, [NOBODY; 4]);
    store.stage_progress.resize(agents, 0);
    store.entry.resize(agents, 0);
    store.queues.resize(store.queues.len().max(8), 0);
    store.sources.resize(store.sources.len().max(1), Source::default());
    store.source_places.resize(store.source_places.len().max(1), [0.0; 2]);
    store.reaction.resize(agents, 0);
    store.failure = vec![u32::MAX; KernelId::ALL.len()];
    if store.lead.is_empty() {
        store.lead.push(Lead::default());
    }
    if store.teleports.is_empty() {
        store.teleports.push(Boxes::default());
    }
    store.teleport_of.resize(agents, NOBODY);
}

/// Has an agent led from outside ([`super::Simulation::lead`]). It is absent until the host leads it somewhere. It goes there
/// whatever stands in its way, and all others make way for it. Call this before the simulation begins.
pub fn set_led(store: &mut Store, agent: u32) {
    let (agent, agents) = (agent as usize, store.step.agent_count as usize);
    let nowhere = Lead { place: [ABSENT, ABSENT], velocity: [0.0, 0.0] };
    store.lead.resize(agents, nowhere);
    if store.step.led_count == 0 {
        store.lead.fill(nowhere);
    }
    if !store.avoidance[agent].is_led() {
        store.avoidance[agent].priority = LED;
        store.avoidance[agent].inverse_time_horizon = 0.0; // of an agent led from outside the comfort distance, m
        store.step.led_count += 1;
    }
    store.position[agent] = [ABSENT, ABSENT];
    store.velocity[agent] = [0.0, 0.0];
    if store.flow_grid.field_count == 0 {
        super::flow::clear(store);
    }
}

/// The speed that an agent would walk at alone, m/s: its own, or that of its gaits.
pub fn preferred_speed(agent: &AgentStart, cast: &AvatarSet) -> f32 {
    let mut speed = 0.0;
    for (gait, weight) in agent.gaits.iter().zip(agent.gait_weights) {
        speed += weight * cast.clip(cast.clip_index(agent.avatar, *gait)).speed * agent.scale;
    }
    agent.speed.unwrap_or(speed) * agent.speed_factor
}

fn push_agent(store: &mut Store, agent: &AgentStart, navigation: &Navigation, cast: &AvatarSet) {
    let clips = agent.gaits.map(|gait| cast.clip_index(agent.avatar, gait));
    let mut walk_ratio = 0.0;
    for (clip, weight) in clips.iter().zip(agent.gait_weights) {
        walk_ratio += weight * cast.clip(*clip).walk_ratio() * agent.scale;
    }
    let preferred_speed = preferred_speed(agent, cast);
    let max_speed =
        (preferred_speed * navigation.max_speed_factor).min(navigation.max_speed).max(preferred_speed);
    store.position.push(agent.position.to_array());
    store.velocity.push(agent.velocity.to_array());
    let [foot_down, foot_stands] = cast.feet_of(agent.avatar, clips[0], agent.scale);
    let body = Body { radius: agent.radius, max_speed, preferred_speed, walk_ratio, foot_down, foot_stands };
    store.body.push(body);
    let own = agent.avoidance.unwrap_or_else(|| scenario::Avoidance::of(navigation));
    store.avoidance.push(avoidance(
        own.time_horizon,
        own.neighbour_distance,
        own.neighbour_cap,
        own.priority,
    ));
    store.companions.push(agent.companions);
    store.elevation.push(agent.elevation);
    store.entry.push(match agent.entry {
        Entry::Start => 0,
        Entry::Step(step) => step.min(NEVER - 2) + 1,
        Entry::Never => NEVER,
    });
    // counted from the start, or from when the agent comes in
    let reaction = (agent.reaction / navigation.time_step).ceil() as u32;
    let until = match agent.entry {
        Entry::Step(step) if reaction > 0 => step.saturating_add(reaction),
        _ => reaction,
    };
    store.step.reaction_steps = store.step.reaction_steps.max(until);
    store.reaction.push(until);
    push_teleport(store, agent);
    store.heading.push(agent.heading);
    store.stance.push(Stance {
        phase: agent.phase,
        walk_weight: f32::from(u8::from(reaction == 0)),
        stride: body.stride_at(preferred_speed),
        ..Stance::default()
    });
    let length = agent.route_length.max(1);
    store.route.push(Route::new(agent.route_start, length, agent.loops, agent.waypoint));
    store.gaits.push(clips);
    store.gait_weights.push(agent.gait_weights);
    store.appearance.push(appearance(agent));
    store.physique.push(agent.build.physique);
    store.gaze_state.push(GazeState::default());
    store.gaze_frame.push(u32::MAX);
    store.attention.push(Attention::default());
}

/// A stage as it lies in the buffer (`shaders/shared/stages.wgsl`).
fn stage(stop: &Stop) -> Stage {
    let kind = match stop.kind {
        StopKind::Waypoint => stages::WAYPOINT,
        StopKind::Goal => stages::GOAL,
        StopKind::Waiting => stages::WAITING,
        StopKind::Queue { .. } => stages::QUEUE,
        StopKind::Exit => stages::EXIT,
    };
    let [along, mut across] = stop.half_axes;
    if let StopKind::Queue { number, places } = stop.kind {
        across = Vec2::new(places as f32, number as f32);
    }
    Stage {
        place: stop.position.to_array(),
        radius: stop.radius,
        kind,
        along: along.to_array(),
        across: across.to_array(),
        field: stop.field.map_or(-1.0, |field| field as f32),
        least_wait: stop.wait as f32,
        first_leave: stop.until as f32,
        number: stop.number as f32,
        elevation: stop.elevation.unwrap_or(0.0),
        has_elevation: f32::from(u8::from(stop.elevation.is_some())),
        ..Stage::default()
    }
}

/// Makes the queue of a stage, if it is one (`shaders/queue.wgsl`); several journeys may lead to the same.
fn set_queue(store: &mut Store, stop: &Stop) {
    let StopKind::Queue { number, places } = stop.kind else { return };
    store.step.queue_count = store.step.queue_count.max(number + 1);
    store.queues.resize(store.step.queue_count as usize * 8, 0);
    let queue = [NOBODY, 0, 0, 0, 0, places.max(1), stop.wait, 0];
    store.queues[number as usize * 8..][..8].copy_from_slice(&queue);
}

/// A source and its places (`shaders/spawn.wgsl`); the bodies must be there.
fn push_source(store: &mut Store, source: &SourceStart) {
    let widest = store.body.iter().map(|body| body.radius).fold(0.0, f32::max);
    store.sources.push(Source {
        first_place: store.source_places.len() as u32,
        places: source.places.len() as u32,
        first_agent: source.first_agent,
        agents: source.agents,
        widest,
        ..Source::default()
    });
    store.source_places.extend(source.places.iter().map(Vec2::to_array));
}

/// Walkers mostly share their teleports.
fn push_teleport(store: &mut Store, agent: &AgentStart) {
    let Some(Teleport { from, to }) = agent.teleport else {
        store.teleport_of.push(NOBODY);
        return;
    };
    let ([from_low, from_high], [to_low, to_high]) = (from, to);
    let boxes = Boxes { from_low, from_high, to_low, to_high };
    let known = store.teleports.iter().position(|known| *known == boxes);
    let number = known.unwrap_or(store.teleports.len());
    if known.is_none() {
        store.teleports.push(boxes);
    }
    store.teleport_of.push(number as u32);
    store.step.teleport_count = store.teleports.len() as u32;
}

/// How an agent avoids others: horizon in s, distance of the neighbours it considers in m, how many at most, priority.
pub fn avoidance(time_horizon: f32, neighbour_distance: f32, neighbour_cap: u32, priority: f32) -> Avoidance {
    Avoidance {
        inverse_time_horizon: 1.0 / time_horizon,
        neighbour_distance,
        neighbour_cap: neighbour_cap as f32,
        priority,
    }
}

/// What the draw shaders read of an agent.
fn appearance(agent: &AgentStart) -> Appearance {
    let strongest = (0..4).fold(0, |best, i| if agent.emotion[i] > agent.emotion[best] { i } else { best });
    let mut own = Appearance::new(agent.avatar, strongest as u32, agent.gazes, agent.scale, agent.colors);
    own.set_size(agent.build.stature, agent.build.breadth);
    own
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_covers_the_bounds_with_cells_no_larger_than_half_the_neighbour_distance() {
        for agents in [0, 1, 100, 1_000_000] {
            let mut step = StepUniforms { agent_count: agents, ..StepUniforms::default() };
            set_grid(&mut step, Vec2::new(-30.0, 5.0), Vec2::new(70.0, 55.0), 4000.0, 5.0);
            assert!(step.cell_size <= 2.5 && step.cell_count <= 4_200_000, "{agents}: {step:?}");
            assert!(
                step.grid_columns as f32 * step.cell_size >= 100.0
                    && step.grid_rows as f32 * step.cell_size >= 50.0
            );
        }
    }
}
