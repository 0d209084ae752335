//! Crowds for the kernels of a simulation step.

use super::case::{nan, unit};
use crate::kernels::layout::{
    Body, Lead, Route, SlotMotion, Source, Stage, Stance, StepUniforms, Teleport, Waiting,
};
use crate::kernels::shared::absent::{ABSENT, NOBODY};
use crate::kernels::shared::floors::index::FLOOR_STRIDE;
use crate::kernels::shared::step::LED;
use crate::kernels::shared::unsolved::index::LISTED;
use crate::kernels::{KernelId, Store};
use crate::reference::exact::hash_u32;
use crate::sim::flow::{Goal, Settings, lay};
use crate::sim::obstacles::{at_heights, cell_depth, cell_lists, segments};
use crate::sim::order;
use crate::sim::setup::{avoidance, empty_cells, join, nothing_measured};

/// A crowd of about one agent per square metre with everything that is hard about crowds in it: agents at one point,
/// head-on, on a lattice (equal distances), outside the bounds, at rest, a dense knot, obstacles with convex and
/// concave corners, the user, and NaN in all spare capacity.
pub fn crowd(agents: usize, seed: u32) -> Store {
    let side = (agents as f32).sqrt().max(4.0);
    let mut store = Store { step: uniforms(agents as u32, side, seed), ..Store::default() };
    agent_arrays(&mut store, agents, side, seed);
    let half = 0.5 * side;
    store.teleports = vec![
        Teleport {
            from_low: [0.3 * half, 0.0],
            from_high: [half, 0.9 * side],
            to_low: [half, 0.0],
            to_high: [side, half],
        },
        Teleport {
            from_low: [half, 0.4 * side],
            from_high: [side, side],
            to_low: [1.0; 2],
            to_high: [1.0; 2],
        },
    ];
    store.step.teleport_count = 2;
    groups(&mut store, agents, seed);
    obstacles(&mut store, side);
    floors(&mut store, side);
    scratch(&mut store, agents);
    if agents > 1 {
        ways(&mut store);
    }
    store
}

/// Parameters of a step, all drawn from the seed: the length of the step and of its horizons, whether opposite sides are
/// joined, where the grid begins.
fn uniforms(agent_count: u32, side: f32, seed: u32) -> StepUniforms {
    let within = |lane: u32, low: f32, high: f32| low + (high - low) * unit(seed ^ 0x57e9_0000, 0, lane);
    let when = |bit: u32, value: f32| if bit & 1 == 1 { value } else { 0.0 };
    let cell_size = within(0, 0.9, 1.4);
    let cells = (side / cell_size).ceil() as u32 + 2;
    // some are so long that a body has turned within one
    let time_step = 1.0 / if seed % 3 == 2 { within(1, 5.0, 6.0) } else { within(1, 15.0, 120.0) };
    let time_horizon_obstacles = within(2, 0.5, 1.5);
    StepUniforms {
        agent_count,
        step_index: seed % 1000 + 3000 * (seed >> 1 & 1),
        seed,
        cell_count: cells * cells,
        grid_columns: cells,
        grid_rows: cells,
        grid_origin: [-within(3, 0.0, 1.0), -within(4, 0.0, 1.0)],
        cell_size,
        inverse_cell_size: 1.0 / cell_size,
        time_step,
        inverse_time_step: 1.0 / time_step,
        inverse_time_horizon_obstacles: 1.0 / time_horizon_obstacles,
        time_horizon_obstacles,
        inverse_time_horizon_dense: 1.0 / within(5, 0.8, 1.2),
        inverse_time_horizon_jam: 1.0 / within(6, 0.1, 0.3),
        safety_margin: within(7, 0.0, 0.03),
        user_position: [side * 0.5, side * 0.5],
        user_velocity: [within(8, -1.5, 1.5), within(9, -1.5, 1.5)],
        user_radius: within(10, 0.2, 0.5),
        user_elevation: if seed & 2 == 2 { 3.4 } else { 0.4 },
        turn_rate: within(11, 2.0, 6.0),
        perturbation: within(12, 1e-4, 1e-2),
        walk_speed: within(13, 0.05, 0.5),
        blend_rate: within(14, 1.0, 5.0),
        responsibility: within(15, 0.4, 1.0),
        crowding: when((agent_count ^ seed) >> 1, within(16, 0.3, 1.0)),
        crowding_reach: within(17, 1.5, 3.5),
        collision_weight: within(18, 0.5, 2.0),
        max_acceleration: within(19, 5.0, 15.0),
        patience: within(20, 0.3, 1.0),
        storey_height: when(agent_count ^ seed, 2.0),
        // some stand beyond it, on either side
        wrap: when((agent_count >> 1) ^ seed, side * within(21, 0.85, 0.95)),
        ..StepUniforms::default()
    }
}

/// Fields to some of the stages, round the solids.
fn ways(store: &mut Store) {
    let goals: Vec<Goal> = store.stages[..3]
        .iter()
        .map(|stage| Goal { center: stage.place.into(), radius: 5.0, ..Goal::default() })
        .collect();
    let mut outlines: Vec<Vec<[f32; 2]>> = solids(store.step.user_position[0] * 2.0).to_vec();
    // a wall that some have to walk round
    let side = store.step.user_position[0] * 2.0;
    outlines.push(vec![[side * 0.2, side * 0.5], [side * 0.7, side * 0.55]]);
    let settings = Settings { cell: Some(0.5), clearance: 0.2, ..Settings::default() };
    if lay(store, &outlines, &goals, &settings).is_err() {
        return;
    }
    let grid = store.flow_grid;
    let turns = (grid.tile_columns * grid.tile_rows).min(400) + 16;
    let mut dispatches = order::flow_start(&grid);
    dispatches.extend(order::flow_turns(0, turns, false));
    dispatches.push(order::flow_solid(&grid));
    dispatches.extend(order::flow_turns(0, turns, true));
    dispatches.extend(order::flow_end(&grid));
    for dispatch in dispatches {
        crate::reference::run(dispatch.phase, store, dispatch.immediate);
    }
    // what the fields say of the upper half of the area is taken as that of a second storey
    if grid.rows > 1 && store.step.agent_count % 2 == 1 {
        store.flow_grid.sheet_rows = grid.rows / 2;
    }
    for (number, stage) in store.stages.iter_mut().enumerate() {
        // the fourth is a field that is not there
        stage.field = (number % 5) as f32 - 1.0;
    }
}

/// [`crowd`] with another model of avoidance (the number in `StepUniforms`).
pub fn crowd_with(model: u32, agents: usize, seed: u32) -> Store {
    let mut store = crowd(agents, seed);
    store.step.model = model;
    store
}

fn agent_arrays(store: &mut Store, agents: usize, side: f32, seed: u32) {
    for i in 0..agents {
        let u = |lane| unit(seed, i, lane);
        let mut position = [u(0) * side, u(1) * side];
        let mut velocity = [u(2) * 3.0 - 1.5, u(3) * 3.0 - 1.5];
        match i % 16 {
            0 => position = [position[0].round(), position[1].round()], // on a lattice: ties of distance
            1 if i > 16 => (position, velocity) = (store.position[i - 16], store.velocity[i - 16]), // at one point
            2 => position = [position[0] * 3.0 - side, -u(4) * side], // outside the bounds
            3 => velocity = [0.0, 0.0],
            6 if i % 32 == 6 => position = [ABSENT; 2],
            4 if i % 64 == 4 => position = [side * 0.25 + u(4), side * 0.25 + u(5)], // a dense knot
            5 if i > 16 => {
                // head-on with another, exactly
                let other = store.position[i - 3];
                position = [other[0] + 3.0, other[1]];
                velocity = [-1.3, 0.0];
            }
            _ => {}
        }
        store.position.push(position);
        store.velocity.push(velocity);
        let preferred_speed = 0.6 + u(6);
        store.body.push(Body {
            radius: 0.12 + 0.3 * u(7),
            max_speed: preferred_speed * 1.5,
            preferred_speed,
            walk_ratio: 0.3 + 0.2 * u(8),
            foot_down: hash_u32(seed ^ !(i as u32)) & 0x0fff_03ff,
            foot_stands: hash_u32(i as u32) & 0x01ff_03ff,
        });
        let cap = if i % 8 == 6 { (u(14) * 11.0) as u32 } else { 10 };
        // led from outside: there, leaving, appearing, standing; and some that stay absent
        let is_led = i % 128 == 7 || i % 64 == 38;
        let priority = if is_led { LED } else { (u(15) * 3.0).floor() * 0.5 };
        let speed = if i % 256 == 38 { 0.02 } else { 3.0 };
        let place = if (i / 64) % 4 == 3 { [ABSENT; 2] } else { [u(20) * side, u(21) * side] };
        // taken away from two boxes, in which many stand and many do not
        store.teleport_of.push(if i % 16 == 9 { u32::from(i % 64 == 9) } else { NOBODY });
        store.lead.push(Lead { place, velocity: [(u(22) - 0.5) * speed, (u(23) - 0.5) * speed] });
        store.step.led_count += u32::from(is_led);
        store.avoidance.push(avoidance(1.0 + 2.0 * u(16), 3.0 + 2.0 * u(17), cap, priority));
        store.elevation.push((u(18) * 2.0).floor() * 3.0 + u(19));
        store.reaction.push(if i % 32 == 9 { (u(21) * 16.0) as u32 } else { 0 });
        let foot = |lane: u32| {
            if i % 4 == 1 { [0.0; 2] } else { [u(lane) - 0.5, u(lane + 1) - 0.5].map(|off| 0.6 * off) }
        };
        store.heading.push(u(9) * 6.2 - 3.1);
        store.stance.push(Stance {
            phase: hash_u32(seed ^ i as u32),
            walk_weight: [u(10), 0.0][usize::from(i % 3 == 1)],
            left: foot(25),
            right: foot(27),
            turns: foot(29).map(|off| 3.0 * off),
            lean: foot(31).map(|off| 0.2 * off),
            heights: foot(33),
            slopes: foot(35),
            stride: 1.6 * u(24),
            foresight: 0.5 - u(37),
        });
        store.route.push(Route::new((i as u32 % 5) * 3, 3, u(11) < 0.5, i as u32 % 4));
    }
    for w in 0..15 {
        let place = [unit(seed, w, 12) * side, unit(seed, w, 13) * side];
        store.stages.push(Stage::waypoint(place, 0.3 + 2.0 * unit(seed, w, 14)));
    }
    for spare in 0..3 {
        // the first is like an agent, so that what is done to it shows; what reads the others is not a number
        let like = (spare == 0 && agents > 0).then_some(agents / 2);
        store.position.push(like.map_or([f32::NAN; 2], |_| [0.5 * side; 2]));
        store.velocity.push(of(&store.velocity, like));
        store.body.push(of(&store.body, like));
        store.avoidance.push(of(&store.avoidance, like));
        store.elevation.push(like.map_or(f32::NAN, |_| 0.5));
        store.lead.push(of(&store.lead, like));
        store.reaction.push(u32::MAX);
        store.teleport_of.push(0);
        store.heading.push(of(&store.heading, like));
        store.stance.push(of(&store.stance, like));
        store.route.push(Route::new(0, 3, false, 0));
    }
}

/// The element of an agent; without one no number.
fn of<T: bytemuck::Pod>(buffer: &[T], agent: Option<usize>) -> T {
    agent.map_or_else(nan, |agent| buffer[agent])
}

/// Groups of one to five, of which some are absent, at one point, or farther along the route.
fn groups(store: &mut Store, agents: usize, seed: u32) {
    store.companions = vec![[NOBODY; 4]; agents + 3];
    let mut first = 0;
    while first < agents {
        let size = (1 + (unit(seed, first, 20) * 5.0) as usize).min(agents - first);
        let members: Vec<u32> = (first..first + size).map(|i| i as u32).collect();
        for &member in &members[1..] {
            let near = [unit(seed, member as usize, 21), unit(seed, member as usize, 22)];
            if member % 4 != 0 && member % 16 != 6 {
                store.position[member as usize] = [
                    store.position[first][0] + near[0] * 2.0 - 1.0,
                    store.position[first][1] + near[1] * 2.0 - 1.0,
                ];
            }
        }
        join(store, &members);
        first += size;
    }
    store.step.group_count = 1; // also where everyone is alone
    store.step.reaction_steps = u32::MAX;
}

/// Level and sloping floors, some above one another, within a step of where people stand and not.
fn floors(store: &mut Store, side: f32) {
    const FLOORS: usize = 6;
    for number in 0..FLOORS {
        let u = |lane| unit(77, number, lane);
        let [x, z] = [u(0) * side, u(1) * side];
        let (width, depth) = (side * (0.2 + 0.4 * u(2)), side * (0.2 + 0.4 * u(3)));
        let slope = if number % 2 == 0 { [0.0, 0.0] } else { [u(4) - 0.5, u(5) - 0.5] };
        let sheet = (number % 2) as f32;
        store.floors.push([slope[0], slope[1], u(6) * 4.0 - slope[0] * x - slope[1] * z, sheet]);
        let edges =
            [[1.0, 0.0, width - x], [-1.0, 0.0, width + x], [0.0, 1.0, depth - z], [0.0, -1.0, depth + z]];
        store.floors.extend(edges.map(|[n, m, d]| [n, m, d, 0.0]));
        store.floors.extend([[0.0, 0.0, 1.0, 0.0]; FLOOR_STRIDE - 5]);
    }
    store.step.floor_count = FLOORS as u32;
}

/// Two solids: a box, and an L with a concave corner.
fn obstacles(store: &mut Store, side: f32) {
    let solids = solids(side);
    let mut segments = segments(&solids);
    // the second stands at some heights only: people walk under it and over it
    segments[4..].iter_mut().for_each(|segment| *segment = at_heights(*segment, 2.1, 3.4));
    store.step.obstacle_count = segments.len() as u32;
    store.obstacle_cells = cell_lists(&segments, &store.step, 3.0);
    store.obstacles = segments;
}

/// Some wait, some longer than they like, some follow a wall to either side, nearer to their goal than before or not.
fn waiting(agent: usize) -> Waiting {
    let u = |lane| unit(77, agent, lane);
    Waiting { stuck: u(0), lost: u(1) - 0.5, side: (u(2) * 3.0).floor() - 1.0, unused: 0.0 }
}

/// Everything a step writes before it reads, with NaN where nothing may read.
pub(super) fn scratch(store: &mut Store, agents: usize) {
    let spare = agents + 3;
    empty_cells(store, spare);
    store.step_count = vec![0];
    store.cell_depth = cell_depth(&store.obstacles, &store.step);
    nothing_measured(store);
    store.step.measured = 1;
    store.agent_slot = vec![0; spare];
    // what is left of another step
    store.unsolved = vec![1_000_000; LISTED + spare];
    store.slot_position = vec![[f32::NAN; 2]; spare];
    store.slot_motion = vec![SlotMotion { agent: 0, limits: 0, ..nan() }; spare];
    store.new_velocity = vec![[f32::NAN; 2]; spare];
    store.waiting = (0..spare).map(waiting).collect();
    store.preferred_velocity = vec![[f32::NAN; 2]; spare];
    store.stage_progress = vec![0; spare];
    store.entry = vec![0; spare];
    store.queues = vec![0; 8];
    store.sources = vec![Source::default()];
    store.source_places = vec![[f32::NAN; 2]];
    store.failure = vec![u32::MAX; KernelId::ALL.len()];
    store.teleport_of.resize(spare, NOBODY);
    if store.teleports.is_empty() {
        store.teleports.push(Teleport::default());
    }
    if store.lead.is_empty() {
        store.lead.push(Lead::default());
    }
    crate::sim::flow::clear(store);
}

pub(super) fn solids(side: f32) -> [Vec<[f32; 2]>; 2] {
    let at = |x: f32, z: f32| [side * 0.6 + x, side * 0.3 + z];
    [
        vec![at(0.0, 0.0), at(1.5, 0.0), at(1.5, 1.0), at(0.0, 1.0)],
        vec![at(-3.0, 1.0), at(-1.0, 1.0), at(-1.0, 2.0), at(-2.0, 2.0), at(-2.0, 3.0), at(-3.0, 3.0)],
    ]
}
