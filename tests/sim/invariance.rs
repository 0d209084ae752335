//! What must not change a crowd: the order of its agents, and which way the scene is turned. And what must never happen,
//! whatever the scene: that an agent leaves the walkable area.

use gaitway::kernels::layout::{Route, Stage};
use gaitway::kernels::{KernelId, Phase, Store};
use gaitway::reference;
use gaitway::reference::exact::{hash_u32, unit_f32};
use gaitway::scenario::Clearance;
use gaitway::sim::{order, setup};
use gaitway::verify::cases::crossing::crossing;
use glam::Vec2;

/// Number `lane` of item `index`, in [0, 1).
fn unit(seed: u32, index: usize, lane: u32) -> f32 {
    unit_f32(hash_u32(hash_u32(seed ^ (index as u32).wrapping_mul(0x9e37_79b9)).wrapping_add(lane)))
}

fn steps(store: &mut Store, count: u32) {
    for _ in 0..count {
        for dispatch in order::step_dispatches(&store.step) {
            reference::run(dispatch.phase, store, dispatch.immediate);
        }
        store.step.step_index += 1;
    }
}

/// A dense crossing around posts, on an open plane, without random draws.
fn scene(model: u32) -> Store {
    let mut store = crossing(400, 0.9);
    store.step.wrap = 0.0;
    store.step.model = model;
    store
}

fn posts() -> Vec<Vec<[f32; 2]>> {
    let post = |i: usize| {
        let (x, z) = (unit(5, i, 0) * 18.0, unit(5, i, 1) * 18.0);
        vec![[x, z], [x + 0.5, z + 0.1], [x + 0.3, z + 0.6]]
    };
    (0..8).map(post).collect()
}

/// Grid, obstacles and scratch for the agents and the obstacles as they now stand.
fn lay_out(store: &mut Store, solids: &[Vec<[f32; 2]>]) {
    let low = store.position.iter().copied().map(Vec2::from).fold(Vec2::MAX, Vec2::min) - 5.0;
    let high = store.position.iter().copied().map(Vec2::from).fold(Vec2::MIN, Vec2::max) + 5.0;
    setup::set_grid(&mut store.step, low, high, (high - low).element_product(), 5.0);
    setup::set_obstacles(store, solids);
    setup::scratch(store);
}

#[test]
fn permuting_the_agents_permutes_the_crowd_exactly() {
    for model in order::MODELS {
        let mut plain = scene(model);
        let mut mixed = plain.clone();
        let count = plain.position.len();
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by_key(|i| hash_u32(*i as u32));
        assert_ne!(order[..9], [0, 1, 2, 3, 4, 5, 6, 7, 8]);
        for (new, &old) in order.iter().enumerate() {
            mixed.position[new] = plain.position[old];
            mixed.velocity[new] = plain.velocity[old];
            mixed.body[new] = plain.body[old];
            mixed.stance[new] = plain.stance[old];
            mixed.heading[new] = plain.heading[old];
            mixed.route[new] = plain.route[old];
        }
        for store in [&mut plain, &mut mixed] {
            lay_out(store, &posts());
            steps(store, 90);
        }
        for (new, &old) in order.iter().enumerate() {
            assert_eq!(mixed.position[new], plain.position[old], "model {model}, agent {old}");
            assert_eq!(mixed.velocity[new], plain.velocity[old], "model {model}, agent {old}");
        }
    }
}

#[test]
fn turning_the_scene_by_a_right_angle_turns_the_crowd() {
    let turned = |[x, z]: [f32; 2]| [-z, x];
    for model in order::MODELS {
        let mut plain = scene(model);
        let mut other = plain.clone();
        other.position.iter_mut().chain(&mut other.velocity).for_each(|p| *p = turned(*p));
        other.stages.iter_mut().for_each(|stage| stage.place = turned(stage.place));
        let turned_posts: Vec<Vec<[f32; 2]>> =
            posts().into_iter().map(|post| post.into_iter().map(turned).collect()).collect();
        lay_out(&mut plain, &posts());
        lay_out(&mut other, &turned_posts);
        steps(&mut plain, 90);
        steps(&mut other, 90);
        let mut worst = 0.0_f32;
        for (a, b) in plain.position.iter().zip(&other.position) {
            let a = turned(*a);
            worst = worst.max((a[0] - b[0]).hypot(a[1] - b[1]));
        }
        println!("model {model}: {worst} m after 90 steps");
        assert!(worst < 1e-3, "model {model}: {worst} m");
    }
}

/// A polygon around a point, its corners `least` to `most` away; counter-clockwise in the plane of x and z.
fn star(seed: u32, centre: Vec2, corners: usize, least: f32, most: f32) -> Vec<Vec2> {
    let corner = |i: usize| {
        let angle = std::f32::consts::TAU * (i as f32 + 0.8 * unit(seed, i, 0)) / corners as f32;
        centre + Vec2::from_angle(angle) * (least + (most - least) * unit(seed, i, 1))
    };
    (0..corners).map(corner).collect()
}

/// A random scene: a jagged outline, solids in it that may overlap, up to three people per square metre thrown in at random,
/// each on its way to points anywhere, behind walls too. Returns the number of agent-steps, and how many were outside.
fn random_scene(seed: u32) -> (u64, u32) {
    let u = |lane| unit(seed, 1_000_000, lane);
    let size = 5.0 + 10.0 * u(0);
    let mut bounds = star(seed ^ 1, Vec2::ZERO, 6 + (u(1) * 12.0) as usize, 0.4 * size, size);
    bounds.reverse();
    let solids: Vec<Vec<Vec2>> = (0..(u(2) * 8.0) as u32)
        .map(|i| {
            let at = Vec2::new(unit(seed, 7, 2 * i) - 0.5, unit(seed, 7, 2 * i + 1) - 0.5) * 1.2 * size;
            star(seed ^ (i + 2), at, 3 + (i as usize % 5), 0.2, 0.25 * size)
        })
        .collect();
    let walkable = Clearance::new(&bounds, &solids);
    let wanted = (u(3) * 3.0 * size * size) as usize;
    let mut store = crossing(wanted.clamp(1, 600), 1.0);
    let count = store.position.len();
    let mut draw = 0;
    for i in 0..count {
        let mut at = Vec2::NAN;
        while !(at.is_finite() && walkable.walkable(at)) {
            draw += 1;
            assert!(draw < 200 * count, "seed {seed}: no room");
            at = Vec2::new(unit(seed, draw, 3) - 0.5, unit(seed, draw, 4) - 0.5) * 2.0 * size;
        }
        store.position[i] = at.to_array();
        store.route[i] = Route::new((i % 16) as u32 * 3, 3, true, 0);
        store.body[i].radius = 0.15 + 0.2 * unit(seed, i, 9);
    }
    store.stages = (0..48)
        .map(|w| {
            let at = |lane| (unit(seed, w, lane) - 0.5) * 2.2 * size;
            Stage::waypoint([at(5), at(6)], 0.5)
        })
        .collect();
    store.step.wrap = 0.0;
    store.step.model = seed % order::MODELS.end;
    store.step.patience = 1.0;
    store.step.perturbation = 0.02;
    store.step.seed = seed;
    store.step.time_step = [1.0 / 30.0, 0.1, 1.0 / 60.0][(seed / 2 % 3) as usize];
    store.step.inverse_time_step = 1.0 / store.step.time_step;
    setup::set_grid(&mut store.step, Vec2::splat(-size), Vec2::splat(size), 4.0 * size * size, 5.0);
    let outlines: Vec<Vec<[f32; 2]>> = std::iter::once(&bounds)
        .chain(&solids)
        .map(|outline| outline.iter().map(Vec2::to_array).collect())
        .collect();
    setup::set_obstacles(&mut store, &outlines);
    setup::scratch(&mut store);
    let mut outside = 0;
    for _ in 0..120 {
        steps(&mut store, 1);
        outside += store.position.iter().filter(|p| !walkable.walkable(Vec2::from_array(**p))).count() as u32;
    }
    assert!(store.failure.iter().all(|word| *word == u32::MAX), "seed {seed}");
    (120 * count as u64, outside)
}

#[test]
fn no_agent_ever_leaves_the_walkable_area() {
    // 10^7 agent-steps: GAITWAY_AGENT_STEPS=10000000 cargo test --release --test sim invariance
    let wanted: u64 =
        std::env::var("GAITWAY_AGENT_STEPS").ok().and_then(|text| text.parse().ok()).unwrap_or(150_000);
    let (mut done, mut seed) = (0, 0);
    while done < wanted {
        let (agent_steps, outside) = random_scene(seed);
        assert_eq!(outside, 0, "scene {seed}: agent-steps outside");
        (done, seed) = (done + agent_steps, seed + 1);
    }
    println!("{done} agent-steps in {seed} scenes, none outside");
}

#[test]
fn without_the_last_resort_an_agent_does_leave_it() {
    // the test above would see it: a velocity straight through a wall, with and without `clip_to_walls`
    let mut store = crossing(1, 1.0);
    store.position = vec![[0.0, 0.3]];
    store.step.wrap = 0.0;
    setup::set_grid(&mut store.step, Vec2::splat(-5.0), Vec2::splat(5.0), 100.0, 5.0);
    setup::set_obstacles(&mut store, &[vec![[-1.0, -1.0], [1.0, -1.0], [1.0, 0.0], [-1.0, 0.0]]]);
    setup::scratch(&mut store);
    let run = |store: &mut Store, phase| reference::run(phase, store, 0);
    for (contained, inside) in [(true, false), (false, true)] {
        let mut store = store.clone();
        let grid = [KernelId::AdvanceJourney, KernelId::GridScan, KernelId::GridScatter];
        order::step_dispatches(&store.step)
            .into_iter()
            .filter(|dispatch| grid.contains(&dispatch.kernel()))
            .for_each(|dispatch| reference::run(dispatch.phase, &mut store, dispatch.immediate));
        store.new_velocity[0] = [3.0, -30.0];
        if contained {
            run(&mut store, Phase::ClipToWalls);
        }
        run(&mut store, Phase::Integrate);
        assert_eq!(store.position[0][1] < 0.0, inside, "{:?}", store.position[0]);
        assert!(store.position[0][0] > 0.05, "it slides along: {:?}", store.position[0]);
    }
}
