//! Layouts in which simulated people get stuck where real ones do not. Everyone arrives within twice the free time plus ten
//! seconds, no one ever stands outside the walkable area, and the same seed gives the same crowd.
//!
//! One layout does not hold for every seed, and the test says so instead of choosing seeds: the door of 0.8 m with four people
//! on either side. With 64 seeds and either model 8 of the 128 crowds are late; without `navigation.patience` most are. A
//! circle of 64 was late once in 32 with ORCA (54 s, of 53).

use gaitway::avatar::{Sex, generated};
use gaitway::kernels::Store;
use gaitway::library::GaitLibrary;
use gaitway::scenario::{AgentStart, Clearance, Crowd, Model, Scenario, Stop, populate};
use gaitway::sim::{AvatarSet, Backend, Simulation, measure, setup};
use glam::Vec2;
use std::f32::consts::TAU;
use std::sync::OnceLock;

const SPEED: f32 = 1.3;

/// Start and way of one agent; the last point is the goal.
type Walk = (Vec2, Vec<Vec2>);

struct Layout {
    name: String,
    /// Outline of the walkable area.
    bounds: Vec<Vec2>,
    /// Solids in it.
    solids: Vec<Vec<Vec2>>,
    walks: Vec<Walk>,
    /// How near counts as arrived, m.
    near: f32,
    /// How many seeds are run, and how many of them may miss the limit.
    seeds: (u64, usize),
}

fn v(x: f32, z: f32) -> Vec2 {
    Vec2::new(x, z)
}

fn rectangle(low: Vec2, high: Vec2) -> Vec<Vec2> {
    vec![low, v(high.x, low.y), high, v(low.x, high.y)]
}

fn plane(name: &str, walks: Vec<Walk>) -> Layout {
    let bounds = rectangle(v(-20.0, -20.0), v(20.0, 20.0));
    Layout { name: name.to_owned(), bounds, solids: Vec::new(), walks, near: 0.4, seeds: (3, 0) }
}

fn corridor(name: &str, width: f32, length: f32, walks: Vec<Walk>) -> Layout {
    let bounds = rectangle(v(-0.5 * length, -0.5 * width), v(0.5 * length, 0.5 * width));
    Layout { bounds, near: 0.6, ..plane(name, walks) }
}

/// A straight way.
fn to(from: Vec2, goal: Vec2) -> Walk {
    (from, vec![goal])
}

fn head_on() -> Layout {
    plane("head-on, exactly", vec![to(v(-6.0, 0.0), v(6.0, 0.0)), to(v(6.0, 0.0), v(-6.0, 0.0))])
}

/// Two files of `each` that meet exactly head-on, whose goals lie behind the other file.
fn files(name: &str, width: f32, each: i32) -> Layout {
    let walks = (0..each).flat_map(|i| {
        let x = 3.0 + i as f32;
        let goal = 14.0 - i as f32;
        [to(v(-x, 0.0), v(goal, 0.0)), to(v(x, 0.0), v(-goal, 0.0))]
    });
    corridor(name, width, 32.0, walks.collect())
}

/// Four streams that cross between the corners of four blocks.
fn four_way() -> Layout {
    let turned = |p: Vec2, turns: i32| (0..turns).fold(p, |p, _| v(-p.y, p.x));
    let mut walks = Vec::new();
    for turns in 0..4 {
        for i in 0..8 {
            let (x, z) = (-3.0 - 0.9 * (i / 2) as f32, -0.5 + (i % 2) as f32);
            walks.push(to(turned(v(x, z), turns), turned(v(10.0 - 0.9 * (i / 2) as f32, z), turns)));
        }
    }
    let blocks = (0..4).map(|turns| {
        rectangle(v(2.0, 2.0), v(12.0, 12.0)).into_iter().map(|p| turned(p, turns)).collect::<Vec<_>>()
    });
    let bounds = rectangle(v(-12.5, -12.5), v(12.5, 12.5));
    Layout { bounds, solids: blocks.collect(), near: 0.6, ..plane("four-way crossing of streams", walks) }
}

/// A pocket that opens towards the walker.
fn u_trap() -> Layout {
    let pocket = vec![
        v(-2.0, -2.0),
        v(2.0, -2.0),
        v(2.0, 2.0),
        v(-2.0, 2.0),
        v(-2.0, 1.7),
        v(1.7, 1.7),
        v(1.7, -1.7),
        v(-2.0, -1.7),
    ];
    let walks = vec![to(v(-6.0, 0.0), v(6.0, 0.0))];
    Layout { solids: vec![pocket], ..plane("concave trap: a U", walks) }
}

fn l_trap() -> Layout {
    let wall = vec![v(0.0, -2.0), v(0.3, -2.0), v(0.3, 2.0), v(-3.0, 2.0), v(-3.0, 1.7), v(0.0, 1.7)];
    let walks = vec![to(v(-6.0, -0.5), v(6.0, 3.0)), to(v(-7.0, 0.5), v(6.0, 1.0))];
    Layout { solids: vec![wall], ..plane("concave trap: an L", walks) }
}

fn circle(count: u32, radius: f32) -> Vec<Walk> {
    let at = |i: u32| Vec2::from_angle(TAU * i as f32 / count as f32) * radius;
    (0..count).map(|i| to(at(i), -at(i))).collect()
}

fn shared_goal() -> Layout {
    let walks = circle(12, 6.0).into_iter().map(|(from, _)| to(from, Vec2::ZERO)).collect();
    Layout { near: 1.6, ..plane("one goal point for twelve", walks) }
}

fn ring() -> Layout {
    let mut walks = circle(30, 5.0);
    walks.push(to(Vec2::ZERO, v(8.0, 0.0)));
    plane("ring of thirty around one", walks)
}

fn within_another() -> Layout {
    let goals = circle(5, 6.0);
    let walks = goals.into_iter().map(|(goal, _)| to(Vec2::ZERO, goal)).collect();
    plane("five at one point", walks)
}

fn within_a_wall() -> Layout {
    let solids = vec![rectangle(v(-1.0, -3.0), v(1.0, 3.0))];
    let walks =
        vec![to(v(0.9, 0.0), v(6.0, 0.0)), to(v(-0.5, 1.0), v(-6.0, 0.0)), to(v(1.1, 1.0), v(6.0, 2.0))];
    Layout { solids, ..plane("in a wall, and half in it", walks) }
}

fn box_in_the_way() -> Layout {
    let solids = vec![rectangle(v(-1.0, -2.0), v(1.0, 2.0))];
    let walks = vec![to(v(-6.0, 0.0), v(6.0, 0.0)), to(v(-8.0, 0.0), v(8.0, 0.0))];
    Layout { solids, ..plane("a box exactly in the way", walks) }
}

fn disc_in_the_way() -> Layout {
    let solids = vec![(0..24).map(|i| Vec2::from_angle(TAU * i as f32 / 24.0) * 1.5).collect()];
    let walks = vec![to(v(-6.0, 0.0), v(6.0, 0.0)), to(v(6.0, 0.0), v(-6.0, 0.0))];
    Layout { solids, ..plane("a round pillar exactly in the way of two", walks) }
}

/// Two blocks of nine, face to face.
fn facing() -> Layout {
    let mut walks = Vec::new();
    for i in 0..9 {
        let (x, z) = (2.0 + 0.6 * (i / 3) as f32, 0.6 * (i % 3 - 1) as f32);
        walks.push(to(v(-x, z), v(10.0 - x, z)));
        walks.push(to(v(x, z), v(x - 10.0, z)));
    }
    plane("two blocks of nine, face to face", walks)
}

/// A wall with a door of 0.8 m, `each` people on either side.
fn door(each: i32) -> Layout {
    let solids = vec![rectangle(v(-0.1, 0.4), v(0.1, 7.0)), rectangle(v(-0.1, -7.0), v(0.1, -0.4))];
    let mut walks = Vec::new();
    for i in 0..each {
        let (x, z) = (2.5 + 0.8 * (i / 2) as f32, 0.8 * ((i % 2) as f32 - 0.5));
        for side in [-1.0, 1.0] {
            let goal = v(-side * (8.0 - 0.9 * (i / 2) as f32), side * (1.0 + z));
            walks.push((v(side * x, z), vec![v(-side * 0.8, 0.0), goal]));
        }
    }
    let bounds = rectangle(v(-12.0, -7.0), v(12.0, 7.0));
    let seeds = if each > 1 { (12, 3) } else { (3, 0) };
    Layout {
        bounds,
        solids,
        near: 0.6,
        seeds,
        ..plane(&format!("door of 0.8 m, {each} from each side"), walks)
    }
}

fn group_against_one(width: f32) -> Layout {
    let mut walks: Vec<Walk> = [-0.6, 0.0, 0.6].into_iter().map(|z| to(v(-6.0, z), v(8.0, z))).collect();
    walks.push(to(v(6.0, 0.0), v(-8.0, 0.0)));
    corridor(&format!("three abreast and one, {width} m wide"), width, 20.0, walks)
}

fn layouts() -> Vec<Layout> {
    let mut all = vec![
        head_on(),
        files("files of four, 1.2 m corridor", 1.2, 4),
        files("files of six, 2 m corridor", 2.0, 6),
        four_way(),
        u_trap(),
        l_trap(),
        shared_goal(),
        ring(),
        within_another(),
        within_a_wall(),
        box_in_the_way(),
        disc_in_the_way(),
        facing(),
        door(1),
        door(4),
        group_against_one(2.0),
        group_against_one(20.0),
    ];
    for (count, radius) in [(2, 4.0), (4, 4.0), (8, 5.0), (16, 6.0), (64, 14.0)] {
        all.push(plane(&format!("circle of {count}"), circle(count, radius)));
    }
    all
}

/// Bodies, and an agent to make others of.
fn people() -> &'static (AvatarSet, AgentStart) {
    static PEOPLE: OnceLock<(AvatarSet, AgentStart)> = OnceLock::new();
    PEOPLE.get_or_init(|| {
        let library = GaitLibrary::built_in().unwrap();
        let cast = AvatarSet::new(library.gaits(), Sex::ALL.map(generated).to_vec()).unwrap();
        let scenario = Scenario::builtin("crossing").unwrap().with_agents(1);
        let crowd = populate(&scenario, |emotion| library.gaits_for(emotion)).unwrap();
        (cast, crowd.agents[0].clone())
    })
}

fn scenario(layout: &Layout, model: Model, seed: u64) -> Scenario {
    let mut scenario = Scenario::builtin("crossing").unwrap().expanded();
    scenario.seed = seed;
    scenario.navigation.model = model;
    scenario.navigation.patience = 1.0;
    scenario.user = None;
    scenario.routes.clear();
    scenario.spawns.clear();
    scenario.environment.props.clear();
    scenario.bounds = layout.bounds.iter().map(Vec2::to_array).collect();
    scenario.obstacles = layout
        .solids
        .iter()
        .map(|solid| gaitway::scenario::Obstacle {
            polygon: solid.iter().map(Vec2::to_array).collect(),
            low: None,
            high: None,
        })
        .collect();
    scenario
}

fn store(layout: &Layout, model: Model, seed: u64) -> Store {
    let (cast, person) = people();
    let mut crowd = Crowd::default();
    for (start, way) in &layout.walks {
        crowd.agents.push(AgentStart {
            position: *start,
            velocity: Vec2::ZERO,
            radius: 0.25,
            route_start: u32::try_from(crowd.stages.len()).unwrap(),
            route_length: u32::try_from(way.len()).unwrap(),
            waypoint: 0,
            loops: false,
            ..person.clone()
        });
        crowd.stages.extend(way.iter().map(|p| Stop::waypoint(*p, layout.near)));
    }
    let scenario = scenario(layout, model, seed);
    let mut store = setup::store(&scenario, &scenario.geometry(), &crowd, cast);
    for body in &mut store.body {
        (body.max_speed, body.preferred_speed) = (1.5 * SPEED, SPEED);
    }
    store
}

struct Outcome {
    free: f32,
    needed: Option<f32>,
    outside: u32,
    overlaps: u32,
    hash: u64,
}

fn run(layout: &Layout, model: Model, seed: u64) -> Outcome {
    let free = layout.walks.iter().map(|(start, way)| {
        let (mut length, mut at) = (0.0, *start);
        for point in way {
            length += at.distance(*point);
            at = *point;
        }
        length / SPEED
    });
    let free = free.fold(0.0, f32::max);
    let scenario = scenario(layout, model, seed);
    let geometry = scenario.geometry();
    let walkable = Clearance::new(&geometry.bounds, &geometry.obstacles);
    let mut simulation = Simulation::from_store(store(layout, model, seed), Backend::Cpu, None).unwrap();
    let mut been_in: Vec<bool> = vec![false; layout.walks.len()];
    let (mut outside, mut overlaps, mut needed) = (0, 0, None);
    let limit = 2.0 * free + 10.0;
    while needed.is_none() && simulation.time() < f64::from(limit) {
        simulation.step(1).unwrap();
        let store = simulation.state().unwrap();
        for (been, p) in been_in.iter_mut().zip(&store.position) {
            let is_in = walkable.walkable(Vec2::from_array(*p));
            outside += u32::from(*been && !is_in);
            *been |= is_in;
        }
        overlaps = overlaps.max(measure::measures(store).overlapping_pairs);
        if store.route.iter().all(|route| route.arrivals > 0) {
            needed = Some(store.step.step_index as f32 * store.step.time_step);
        }
    }
    let hash = measure::state_hash(simulation.state().unwrap());
    Outcome { free, needed, outside, overlaps, hash }
}

fn resolve(model: Model) {
    let wanted = std::env::var("GAITWAY_JAM").unwrap_or_default();
    let mut stuck = Vec::new();
    println!("{model:?}: layout | free time, s | time needed, s | most pairs overlapping by a tenth");
    for layout in layouts().into_iter().filter(|layout| layout.name.contains(&wanted)) {
        let (mut late, mut outside) = (Vec::new(), 0);
        for seed in 1..=layout.seeds.0 {
            let found = run(&layout, model, seed);
            let needed = found.needed.map_or("never".to_owned(), |t| format!("{t:.1}"));
            println!("{} (seed {seed}) | {:.1} | {needed} | {}", layout.name, found.free, found.overlaps);
            outside += found.outside;
            if found.needed.is_none() {
                late.push(seed);
            }
        }
        if late.len() > layout.seeds.1 || outside > 0 {
            stuck.push(format!("{}: late with seeds {late:?}, {outside} outside", layout.name));
        }
    }
    assert!(stuck.is_empty(), "{stuck:#?}");
}

#[test]
fn every_layout_resolves_with_orca() {
    resolve(Model::Orca);
}

#[test]
fn every_layout_resolves_with_rvo() {
    resolve(Model::Rvo);
}

#[test]
fn the_same_seed_gives_the_same_jam_and_another_seed_another() {
    let hash = |seed| run(&facing(), Model::Orca, seed).hash;
    assert_eq!(hash(7), hash(7));
    assert_ne!(hash(7), hash(8));
}
