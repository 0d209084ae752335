//! Ways to goals: distances against exact ones, traps, doors, crowds, and the same bits on both backends.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a test: a failure is a panic"
)]

use gaitway::kernels::Store;
use gaitway::reference::way::{FAR, SOLID, flow_direction};
use gaitway::sim::flow::{Goal, Settings, lay};
use gaitway::sim::{Backend, Simulation};
use glam::Vec2;

type Outlines = Vec<Vec<[f32; 2]>>;

/// A rectangle to walk in.
fn floor(width: f32, depth: f32) -> Vec<[f32; 2]> {
    vec![[0.0, 0.0], [0.0, depth], [width, depth], [width, 0.0]]
}

/// Something solid.
fn block(x: [f32; 2], z: [f32; 2]) -> Vec<[f32; 2]> {
    vec![[x[0], z[0]], [x[1], z[0]], [x[1], z[1]], [x[0], z[1]]]
}

fn goal(x: f32, z: f32) -> Goal {
    Goal { name: "there".into(), center: Vec2::new(x, z), radius: 0.5, region: Vec::new() }
}

fn solved(outlines: &Outlines, goals: &[Goal], settings: &Settings, backend: Backend) -> Store {
    let mut store = Store::default();
    gaitway::sim::setup::scratch(&mut store);
    lay(&mut store, outlines, goals, settings).unwrap();
    let mut simulation = Simulation::from_store(store, backend, None).unwrap();
    use gaitway::kernels::BufferId;
    simulation.read(&[BufferId::FlowDistance, BufferId::FlowWay, BufferId::FlowArgs]).unwrap().clone()
}

/// Free cells of field 0: middle and distance, m.
fn cells(store: &Store) -> Vec<(Vec2, f32)> {
    let grid = &store.flow_grid;
    (0..grid.cell_count)
        .filter(|cell| store.flow_cells[*cell as usize] & SOLID == 0)
        .map(|cell| {
            let at = Vec2::new((cell % grid.columns) as f32 + 0.5, (cell / grid.columns) as f32 + 0.5);
            (Vec2::from_array(grid.origin) + at * grid.cell_size, store.flow_distance[cell as usize])
        })
        .collect()
}

/// Mean and largest of |found / wanted - 1| over cells farther than `from` m.
fn errors(store: &Store, from: f32, wanted: impl Fn(Vec2) -> f32) -> (f32, f32) {
    let (mut sum, mut worst, mut count) = (0.0, 0.0_f32, 0);
    for (at, found) in cells(store) {
        let wanted = wanted(at);
        if wanted > from {
            let error = (found / wanted - 1.0).abs();
            (sum, worst, count) = (sum + error, worst.max(error), count + 1);
        }
    }
    (sum / count as f32, worst)
}

#[test]
fn distances_in_the_open_are_euclidean() {
    for cell in [0.25, 0.5] {
        let settings = Settings { cell: Some(cell), ..Settings::default() };
        let store = solved(&vec![floor(60.0, 40.0)], &[goal(23.1, 17.7)], &settings, Backend::Cpu);
        let (mean, worst) = errors(&store, 4.0 * cell, |at| at.distance(Vec2::new(23.1, 17.7)));
        println!("cells {cell}: mean {mean} worst {worst}");
        assert!(mean < 0.012 && worst < 0.025, "cells of {cell} m: mean {mean}, worst {worst}");
    }
}

#[test]
fn distances_round_a_block_are_those_over_its_corners() {
    let outlines = vec![floor(60.0, 40.0), block([20.0, 24.0], [10.0, 40.0])];
    let (target, r) = (Vec2::new(10.0, 30.0), 0.25);
    let corners = [Vec2::new(20.0 - r, 10.0 - r), Vec2::new(24.0 + r, 10.0 - r)];
    let store = solved(&outlines, &[goal(target.x, target.y)], &Settings::default(), Backend::Cpu);
    let wanted = |at: Vec2| {
        if at.x < 20.0 {
            return at.distance(target);
        }
        let first = target.distance(corners[0]);
        let round = first + corners[0].distance(corners[1]) + corners[1].distance(at);
        // seen past the first corner alone
        let line = (at - corners[0]).perp_dot(corners[1] - corners[0]);
        if (at.x < corners[1].x && at.y < 10.0) || line >= 0.0 {
            // or from the goal itself
            let sees = (corners[0] - target).perp_dot(at - target) <= 0.0;
            return if sees { at.distance(target) } else { first + corners[0].distance(at) };
        }
        round
    };
    let (mean, worst) = errors(&store, 2.0, wanted);
    println!("block: mean {mean} worst {worst}");
    assert!(mean < 0.015 && worst < 0.04, "mean {mean}, worst {worst}");
}

#[test]
fn following_the_field_leads_out_of_a_trap_and_never_through_a_wall() {
    // a cup open to the left, the goal behind it
    let outlines = vec![
        floor(40.0, 30.0),
        block([10.0, 25.0], [8.0, 9.0]),
        block([10.0, 25.0], [21.0, 22.0]),
        block([24.0, 25.0], [8.5, 21.5]),
    ];
    let target = Vec2::new(35.0, 15.0);
    for size in [0.25, 0.5] {
        let settings = Settings { cell: Some(size), ..Settings::default() };
        let store = solved(&outlines, &[goal(target.x, target.y)], &settings, Backend::Cpu);
        for start in
            [Vec2::new(23.0, 15.0), Vec2::new(23.6, 9.4), Vec2::new(12.0, 20.6), Vec2::new(24.5, 15.0)]
        {
            let (mut at, mut walked) = (start, 0.0);
            while at.distance(target) > 0.3 && walked < 100.0 {
                let to = target - at;
                let way = flow_direction(&store.flow_grid, &store.flow_way, 0, at.to_array(), to.to_array());
                let before = at;
                at += Vec2::from_array(way).normalize() * 0.05;
                walked += 0.05;
                // a start inside a wall may leave it, but nobody may enter one
                for wall in &outlines[1..] {
                    let inside = |p: Vec2| {
                        p.x > wall[0][0] && p.x < wall[1][0] && p.y > wall[0][1] && p.y < wall[2][1]
                    };
                    assert!(
                        inside(start) || inside(before) || !inside(at),
                        "cells {size} m, from {start}: into a wall at {at}"
                    );
                }
            }
            println!("from {start}: {walked} m");
            assert!(walked < 60.0, "cells {size} m, from {start}: lost at {at} after {walked} m");
        }
    }
}

#[test]
fn a_goal_in_a_wall_is_refused_by_name_and_a_pocket_leads_nowhere() {
    let outlines = vec![floor(20.0, 20.0), block([5.0, 10.0], [5.0, 10.0])];
    let mut store = Store::default();
    gaitway::sim::setup::scratch(&mut store);
    let error = lay(&mut store, &outlines, &[goal(7.5, 7.5)], &Settings::default()).unwrap_err().to_string();
    assert!(error.contains("\"there\"") && error.contains("(7.50, 7.50)"), "{error}");
    assert_eq!(store.flow_grid.field_count, 0, "nothing has changed");
    let error = lay(&mut store, &outlines, &[goal(70.5, 7.5)], &Settings::default()).unwrap_err().to_string();
    assert!(error.contains("outside"), "{error}");
    let tiny = Settings { cell: Some(0.001), ..Settings::default() };
    let error = lay(&mut store, &outlines, &[goal(2.0, 2.0)], &tiny).unwrap_err().to_string();
    assert!(error.contains("way_finding.cell") && error.contains("0.05"), "{error}");
    // a closed room
    let walls = [
        [[12.0, 12.0], [18.0, 12.0]],
        [[18.0, 12.0], [18.0, 18.0]],
        [[18.0, 18.0], [12.0, 18.0]],
        [[12.0, 18.0], [12.0, 12.0]],
    ];
    let mut outlines = outlines;
    outlines.extend(walls.map(|wall| wall.to_vec()));
    let store = solved(&outlines, &[goal(2.0, 2.0)], &Settings::default(), Backend::Cpu);
    let inside = |at: Vec2| at.cmpgt(Vec2::splat(12.0)).all() && at.cmplt(Vec2::splat(18.0)).all();
    for (at, distance) in cells(&store) {
        assert_eq!(distance >= FAR, inside(at), "{at}: {distance}");
    }
    let way = flow_direction(&store.flow_grid, &store.flow_way, 0, [15.0, 15.0], [-3.0, -4.0]);
    assert!(
        (way[0] + 3.0).abs() < 1e-6 && (way[1] + 4.0).abs() < 1e-6,
        "straight, for want of a way: {way:?}"
    );
}

#[test]
fn both_backends_find_the_same_ways_bit_for_bit() {
    if Simulation::from_store(Store::default(), Backend::Vulkan, None).is_err() {
        assert!(std::env::var("GAITWAY_REQUIRE_GPU").as_deref() != Ok("1"), "no Vulkan device");
        return println!("skipped: no Vulkan");
    }
    for (width, depth) in [(0.6, 0.6), (3.0, 3.0), (4.0, 29.7), (16.0, 16.0), (61.3, 8.2), (70.0, 50.0)] {
        let mut outlines = vec![floor(width, depth)];
        if width > 2.0 {
            outlines.push(block([width * 0.4, width * 0.5], [depth * 0.2, depth * 0.9]));
        }
        let goals = [goal(width * 0.8, depth * 0.5), goal(width * 0.1 + 0.2, depth * 0.5)];
        let [cpu, gpu] = [Backend::Cpu, Backend::Vulkan]
            .map(|backend| solved(&outlines, &goals, &Settings::default(), backend));
        assert!(cpu.flow_way == gpu.flow_way, "{width} x {depth}");
        let bits = |store: &Store| store.flow_distance.iter().map(|d| d.to_bits()).collect::<Vec<_>>();
        assert!(bits(&cpu) == bits(&gpu), "{width} x {depth}");
        assert_eq!(cpu.flow_args, gpu.flow_args);
    }
}

#[test]
fn closing_a_door_leads_to_the_other_one_and_opening_it_back() {
    let wall = |doors: &[[f32; 2]]| {
        let mut outlines = vec![floor(20.0, 20.0)];
        let mut from = 0.0;
        for door in doors {
            outlines.push(block([9.9, 10.1], [from, door[0]]));
            from = door[1];
        }
        outlines.push(block([9.9, 10.1], [from, 20.0]));
        outlines
    };
    let (near, far) = ([4.0, 5.2], [15.0, 16.2]);
    for backend in [Backend::Cpu, Backend::Vulkan] {
        let mut store = Store::default();
        gaitway::sim::setup::scratch(&mut store);
        let Ok(mut simulation) = Simulation::from_store(store, backend, None) else { continue };
        simulation.set_goals(&wall(&[near, far]), vec![goal(18.0, 4.5)], Settings::default()).unwrap();
        let distance = |simulation: &mut Simulation| {
            let store = simulation.read(&[gaitway::kernels::BufferId::FlowDistance]).unwrap();
            let found = cells(store);
            found.iter().find(|(at, _)| at.distance(Vec2::new(2.0, 4.5)) < 0.2).unwrap().1
        };
        let open = distance(&mut simulation);
        assert!((open - 16.0).abs() < 0.4, "{open}");
        simulation.set_obstacles(&wall(&[far])).unwrap();
        let closed = distance(&mut simulation);
        assert!(closed > 26.0 && closed < 30.0, "{closed}");
        let error = simulation.set_obstacles(&[wall(&[far]), vec![block([17.0, 19.0], [4.0, 5.0])]].concat());
        assert!(error.unwrap_err().to_string().contains("there"));
        assert!((distance(&mut simulation) - closed).abs() < 1e-6, "nothing has changed");
        simulation.set_obstacles(&wall(&[near, far])).unwrap();
        assert!((distance(&mut simulation) - open).abs() < 1e-6);
    }
}

/// 500 m by 500 m at 0.5 m with a thousand blocks, timed; run with `--ignored --nocapture`, optimised.
#[test]
#[ignore = "a measurement"]
fn time_of_a_million_cells() {
    for (name, blocks) in [("open", 0), ("blocks", 1000)] {
        let mut outlines = vec![floor(500.0, 500.0)];
        for i in 0..blocks {
            let (x, z) = ((i % 32) as f32 * 15.5 + 4.0, (i / 32) as f32 * 15.5 + 4.0);
            outlines.push(block([x, x + 9.0], [z, z + 7.0]));
        }
        let settings = Settings { cell: Some(0.5), ..Settings::default() };
        for backend in [Backend::Cpu, Backend::Vulkan] {
            let mut store = Store::default();
            gaitway::sim::setup::scratch(&mut store);
            let begin = std::time::Instant::now();
            lay(&mut store, &outlines, &[goal(251.3, 247.9)], &settings).unwrap();
            let laid = begin.elapsed().as_secs_f64() * 1e3;
            let Ok(mut simulation) = Simulation::from_store(store, backend, None) else { continue };
            let mut times: Vec<f64> = (0..7)
                .map(|_| {
                    let begin = std::time::Instant::now();
                    simulation.solve_ways().unwrap();
                    begin.elapsed().as_secs_f64() * 1e3
                })
                .collect();
            times.sort_by(f64::total_cmp);
            println!("{name}, {}: laid in {laid:.0} ms, solved in {times:.0?} ms", simulation.device());
        }
    }
}
