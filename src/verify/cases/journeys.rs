//! A crowd on journeys: stages of every kind, people about to come in, people about to leave.

use super::case::unit;
use super::step::crowd;
use crate::kernels::Store;
use crate::kernels::layout::{Route, Source, Stage};
use crate::kernels::shared::absent::{ABSENT, NOBODY};
use crate::kernels::shared::stages::{EXIT, GOAL, QUEUE, WAITING, WAYPOINT};

/// Kinds of the stages, in turn; the last one of every journey may be an exit.
const KINDS: [f32; 5] = [WAYPOINT, GOAL, WAITING, QUEUE, EXIT];
/// Sources: two that let people in, one whose time has not come, one that has let all in, one without a place.
const SOURCES: usize = 5;

/// The crowd of [`crowd`] on journeys through regions that many of them stand in, with a part of it outside, in sources:
/// due and not due, with places that are free and places that are not.
pub fn journeys(agents: usize, seed: u32) -> Store {
    let mut store = crowd(agents, seed);
    let side = (agents as f32).sqrt().max(4.0);
    stages(&mut store, side, seed);
    for agent in 0..agents {
        let u = |lane| unit(seed, agent, lane);
        let loops = u(21) < 0.3;
        let next = (u(22) * 6.0) as u32; // 5: all done
        store.route[agent] = Route::new(5 * (agent as u32 % 7), 5, loops, next);
        let arrived = u(23) * (store.step.step_index + 2) as f32;
        store.stage_progress[agent] = if u(24) < 0.5 { 0 } else { arrived as u32 };
    }
    sources(&mut store, agents, side, seed);
    queues(&mut store, agents, seed);
    store
}

/// A queue for every journey: empty, full, with people in it and without, served and about to be done.
fn queues(store: &mut Store, agents: usize, seed: u32) {
    store.step.queue_count = 7;
    store.queues.clear();
    for queue in 0..7_usize {
        let u = |lane: u32| unit(seed, queue, 60 + lane);
        let (first, places) = ((u(0) * 100.0) as u32, 1 + (u(1) * 6.0) as u32);
        let (length, service) = ((u(2) * (places + 1) as f32) as u32, (u(3) * 4.0) as u32);
        let served = (u(4) * (service + 1) as f32) as u32;
        // only those of its own journey ask to join: two queues that took one agent would write its ticket at the same time
        let asking = (u(6) * agents as f32) as usize / 7 * 7 + queue;
        let joins = if u(5) < 0.5 || asking >= agents { NOBODY } else { asking as u32 };
        let is_served = u32::from(u(7) < 0.5);
        store.queues.extend([joins, first, first + length, is_served, served, places, service, 0]);
        let stage = &mut store.stages[5 * queue + 3];
        stage.along = [u(8) - 0.5, u(9) - 0.5];
        stage.across = [places as f32, queue as f32];
        let [counter_x, counter_z] = stage.place;
        // of those on their way to the queue: some with a ticket behind, some at the counter, some in the line, some without
        let mine = (0..agents).filter(|agent| agent % 7 == queue && store.route[*agent].next == 3);
        let in_line: Vec<usize> = mine.collect();
        for (k, agent) in in_line.into_iter().enumerate() {
            store.stage_progress[agent] =
                if k % 3 == 0 { 0 } else { first + 1 + k as u32 % 4 - u32::from(k % 8 == 7) };
            if k % 4 == 0 && store.position[agent][0] < 1e8 {
                store.position[agent] = [counter_x + 0.05, counter_z];
            }
        }
    }
    // A spare queue stands behind the last one. It must serve no agent.
    store.queues.extend([0, 5, 7, 1, 1, 3, 2, 0]);
}

/// Seven journeys of five stages.
fn stages(store: &mut Store, side: f32, seed: u32) {
    store.stages.clear();
    for stage in 0..35_usize {
        let u = |lane: u32| unit(seed, stage, 30 + lane);
        let (long, wide, turn) = (0.2 + u(2) * 0.2 * side, 0.2 + u(3) * 0.2 * side, u(4));
        let kind = if stage % 5 == 4 && stage > 20 { GOAL } else { KINDS[stage % 5] };
        let wait = (u(5) * 8.0).floor();
        let until = if u(6) < 0.5 { 0.0 } else { store.step.step_index as f32 - 1.0 + (u(7) * 3.0).floor() };
        store.stages.push(Stage {
            place: [u(0) * side, u(1) * side],
            radius: 0.3 + 2.0 * u(11),
            kind,
            along: [long * turn, long * (1.0 - turn)],
            across: [wide * (turn - 1.0), wide * turn],
            field: -1.0,
            least_wait: wait,
            first_leave: until.max(0.0),
            number: stage as f32,
            // some on a floor, and agents on another storey do not come to them
            elevation: 3.0,
            has_elevation: (u(10) * 1.5).floor(),
            ..Stage::default()
        });
    }
}

/// The last third of the agents belongs to the sources, and is outside.
fn sources(store: &mut Store, agents: usize, side: f32, seed: u32) {
    store.step.source_count = SOURCES as u32;
    store.sources = vec![Source::default(); SOURCES];
    store.source_places.clear();
    let each = agents / (3 * SOURCES);
    let widest = store.body[..agents].iter().map(|body| body.radius).fold(0.0, f32::max);
    for source in 0..SOURCES {
        let first = agents - (SOURCES - source) * each;
        let places = if source == 4 { 0 } else { 3 + 10 * source };
        let begin = store.source_places.len();
        for place in 0..places {
            // those of source 0 are far outside; those of source 1 stand on people
            let at = match source {
                0 => [-20.0 - place as f32, side + 30.0],
                1 if agents > 1 => store.position[place % (agents / 2)],
                _ => [unit(seed, begin + place, 50) * side, unit(seed, begin + place, 51) * side],
            };
            store.source_places.push(at);
        }
        let let_in = if source == 3 { each } else { 0 };
        let word = |value: usize| value as u32;
        store.sources[source] = Source {
            first_place: word(begin),
            places: word(places),
            first_agent: word(first),
            agents: word(each),
            entered: word(let_in),
            widest,
            ..Source::default()
        };
        for agent in first + let_in..first + each {
            store.position[agent] = [ABSENT; 2];
            store.velocity[agent] = [0.0; 2];
            let due = store.step.step_index + word(agent - first);
            store.entry[agent] = if source == 2 { due + 3 } else { due.max(1) };
        }
    }
}
