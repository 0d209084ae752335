//! The crossing workload: two streams mixed over one square, density kept constant by joining opposite sides.

use crate::kernels::Store;
use crate::kernels::layout::{Body, Route, Stage, Stance, StepUniforms};
use crate::reference::exact::{hash_u32, unit_f32};
use crate::reference::shared::on_storey;
use crate::scenario::MOST_BY_CHANCE;
use crate::sim::setup::avoidance;

/// Far enough that all agents of a stream walk in the same direction to 1e-4 rad.
const FAR: f32 = 1e7;

/// `agents` at one per `spacing`² square metres; half want to go along x, half along z. They are stored as scenes number theirs: a
/// large crowd row by row, others in arbitrary order. They walk at 1.3 m/s. Radius 0.25 m, maximum speed 2 m/s, neighbour distance 5 m, 10 neighbours, horizon 2 s, 30 steps a second.
pub fn crossing(agents: usize, spacing: f32) -> Store {
    let mut store = walkers(agents, spacing);
    store.step.bare = 0;
    store.heading = vec![0.0; agents];
    let stance = |cell| Stance { phase: hash_u32(cell), walk_weight: 1.0, stride: 1.4, ..Stance::default() };
    store.stance = cells_of(agents).into_iter().map(stance).collect();
    super::step::scratch(&mut store, agents);
    store
}

/// The same agents without bodies.
pub fn bare_crossing(agents: usize, spacing: f32) -> Store {
    let mut store = walkers(agents, spacing);
    super::step::scratch(&mut store, agents);
    store
}

/// In which of the cells that the crossing begins in each agent is.
fn cells_of(agents: usize) -> Vec<u32> {
    let mut order: Vec<u32> = (0..agents as u32).collect();
    if agents <= MOST_BY_CHANCE as usize {
        for i in (1..agents).rev() {
            order.swap(i, ((u64::from(hash_u32(i as u32 ^ 0x5bd1_e995)) * (i as u64 + 1)) >> 32) as usize);
        }
    }
    order
}

/// Agents without bodies, and nothing that a step writes.
fn walkers(agents: usize, spacing: f32) -> Store {
    let columns = (agents as f32).sqrt().ceil() as usize;
    let side = spacing * columns as f32;
    let cell_size = 1.1 * spacing;
    let cells = (side / cell_size).ceil() as u32;
    let u = |value: u32| unit_f32(hash_u32(value)) - 0.5;
    let jitter = (spacing - 0.5).min(0.4);
    let mut store = Store {
        step: StepUniforms {
            agent_count: agents as u32,
            cell_count: cells * cells,
            grid_columns: cells,
            grid_rows: cells,
            cell_size,
            inverse_cell_size: 1.0 / cell_size,
            time_step: 1.0 / 30.0,
            inverse_time_step: 30.0,
            inverse_time_horizon_obstacles: 1.0,
            time_horizon_obstacles: 1.0,
            inverse_time_horizon_dense: 1.0,
            inverse_time_horizon_jam: 1.0 / 0.15,
            safety_margin: 0.01,
            turn_rate: 4.0,
            walk_speed: 0.1,
            blend_rate: 3.0,
            responsibility: 0.5,
            collision_weight: 1.0,
            max_acceleration: 10.0,
            wrap: side,
            bare: 1,
            ..StepUniforms::default()
        },
        stages: vec![Stage::waypoint([FAR, side * 0.5], 1.0), Stage::waypoint([side * 0.5, FAR], 1.0)],
        ..Store::default()
    };
    for cell in cells_of(agents) {
        let column = (cell as usize % columns) as f32 + 0.5;
        let row = (cell as usize / columns) as f32 + 0.5;
        let stream = hash_u32(3 * cell + 3) & 1;
        store
            .position
            .push([spacing * column + jitter * u(3 * cell + 1), spacing * row + jitter * u(3 * cell + 2)]);
        store.velocity.push(if stream == 0 { [1.3, 0.0] } else { [0.0, 1.3] });
        store.body.push(Body {
            radius: 0.25,
            max_speed: 2.0,
            preferred_speed: 1.3,
            walk_ratio: 0.4,
            ..Body::default()
        });
        store.avoidance.push(avoidance(2.0, 5.0, 10, 0.0));
        store.elevation.push(0.0);
        store.route.push(Route::new(stream, 1, true, 0));
    }
    store
}

/// What a crowd of [`crossing`] looks like: the measures by which simulators are compared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CrossingQuality {
    /// Pairs closer than 0.99 of the summed radii, per agent.
    pub overlapping: f64,
    /// Pairs closer than 0.9 of the summed radii, per agent.
    pub deep: f64,
    /// Smallest distance between two agents, m.
    pub min_distance: f64,
    /// Mean velocity along the wanted direction, m/s.
    pub progress: f64,
}

/// Measures agents at least 5 m from the edges.
pub fn crossing_quality(store: &Store) -> CrossingQuality {
    let side = store.step.wrap;
    let inner = |p: &[f32; 2]| p.iter().all(|c| (5.0..=side - 5.0).contains(c));
    let chosen: Vec<u32> =
        (0..store.step.agent_count).filter(|&i| inner(&store.position[i as usize])).collect();
    // in cells of a square metre, those of one behind another
    let columns = side as usize + 2;
    let cell = |agent: u32| {
        let [x, z] = store.position[agent as usize];
        z as usize * columns + x as usize
    };
    let mut ends = vec![0_u32; columns * columns];
    chosen.iter().for_each(|&i| ends[cell(i)] += 1);
    ends.iter_mut().fold(0, |sum, end| {
        *end += sum;
        *end
    });
    let (mut begins, mut listed) = (ends.clone(), vec![0; chosen.len()]);
    for &i in chosen.iter().rev() {
        let begin = &mut begins[cell(i)];
        *begin -= 1;
        listed[*begin as usize] = i;
    }
    let mut quality = CrossingQuality { min_distance: f64::INFINITY, ..CrossingQuality::default() };
    for &i in &chosen {
        let here = cell(i);
        for neighbour in (here - columns - 1..).step_by(columns).take(3).flat_map(|left| left..left + 3) {
            let those = begins[neighbour] as usize..ends[neighbour] as usize;
            for &j in listed[those].iter().filter(|&&j| j > i) {
                let [i, j] = [i, j].map(|agent| agent as usize);
                let (a, b) = (store.position[i], store.position[j]);
                if !on_storey(&store.step, store.elevation[i], store.elevation[j]) {
                    continue;
                }
                let distance = libm::hypot(f64::from(a[0] - b[0]), f64::from(a[1] - b[1]));
                quality.overlapping += f64::from(u8::from(distance < 0.99 * 0.5));
                quality.deep += f64::from(u8::from(distance < 0.9 * 0.5));
                quality.min_distance = quality.min_distance.min(distance);
            }
        }
        let i = i as usize;
        quality.progress += f64::from(store.velocity[i][store.route[i].first as usize]);
    }
    let count = chosen.len().max(1) as f64;
    quality.overlapping /= count;
    quality.deep /= count;
    quality.progress /= count;
    quality
}
