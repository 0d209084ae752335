//! ORCA against RVO2's own trajectories, where they are present (`GAITWAY_DATA` or `../shared/data`); the layouts
//! themselves are also run without them.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test: small counts, and a failure is a panic that prints"
)]

use gaitway::kernels::layout::StepUniforms;
use gaitway::kernels::{KernelId, Store};
use gaitway::{reference, sim};
use glam::Vec2;
use std::path::PathBuf;

/// A layout of the reference runs: its notice states the parameters.
struct Layout {
    name: &'static str,
    time_step: f32,
    distance: f32,
    horizon: f32,
    radius: f32,
    max_speed: f32,
    start: Vec<[f32; 2]>,
    goal: Vec<[f32; 2]>,
    speed: Vec<f32>,
    /// Slow down over one metre before the goal, as RVO2's Circle example does, instead of over one step.
    gentle: bool,
    /// RVO2's algorithm to the letter; else with the shorter horizons and the margin that scenarios use by default.
    strict: bool,
}

fn pair(name: &'static str, start: [[f32; 2]; 2], goal: [[f32; 2]; 2], speed: [f32; 2]) -> Layout {
    let (start, goal, speed) = (start.to_vec(), goal.to_vec(), speed.to_vec());
    let (gentle, strict) = (false, true);
    Layout {
        strict,
        name,
        time_step: 0.1,
        distance: 10.0,
        horizon: 3.0,
        radius: 0.3,
        max_speed: 2.0,
        start,
        goal,
        speed,
        gentle,
    }
}

fn circle(count: usize, radius: f64) -> (Vec<[f32; 2]>, Vec<[f32; 2]>) {
    let at = |i: usize| {
        let angle = std::f64::consts::TAU * i as f64 / count as f64;
        [(radius * angle.cos()) as f32, (radius * angle.sin()) as f32]
    };
    let start: Vec<_> = (0..count).map(at).collect();
    let goal = start.iter().map(|p| [-p[0], -p[1]]).collect();
    (start, goal)
}

fn circle12() -> Layout {
    let (start, goal) = circle(12, 6.0);
    let speed = (0..12).map(|i| 1.0 + 0.05 * i as f32).collect();
    Layout { start, goal, speed, ..pair("circle12", [[0.0; 2]; 2], [[0.0; 2]; 2], [0.0; 2]) }
}

fn circle250() -> Layout {
    let (start, goal) = circle(250, 200.0);
    Layout {
        name: "circle250",
        time_step: 0.25,
        distance: 15.0,
        horizon: 10.0,
        radius: 1.5,
        max_speed: 2.0,
        start,
        goal,
        speed: vec![1.0; 250],
        gentle: true,
        strict: false,
    }
}

fn store(layout: &Layout) -> Store {
    let count = layout.start.len();
    let mut store = Store {
        step: StepUniforms {
            agent_count: count as u32,
            time_step: layout.time_step,
            inverse_time_step: 1.0 / layout.time_step,
            inverse_time_horizon_dense: if layout.strict { 0.0 } else { 2.0 / layout.horizon },
            inverse_time_horizon_jam: if layout.strict { 0.0 } else { 40.0 / (3.0 * layout.horizon) },
            safety_margin: if layout.strict { 0.0 } else { 0.04 * layout.radius },
            inverse_time_horizon_obstacles: 1.0 / layout.horizon,
            responsibility: 0.5,
            turn_rate: 4.0,
            ..StepUniforms::default()
        },
        position: layout.start.clone(),
        velocity: vec![[0.0; 2]; count],
        body: vec![[layout.radius, layout.max_speed, 1.0, 1.4]; count],
        manners: vec![sim::setup::manners(layout.horizon, layout.distance, 10, 0.0); count],
        elevation: vec![0.0; count],
        stance: vec![[0.0; 2]; count],
        phase: vec![0; count],
        route: vec![[0, 1, 0, 0]; count],
        stages: reference::stages::waypoint(0.0, 0.0, 0.0).to_vec(),
        ..Store::default()
    };
    let extent = layout.start.iter().flatten().fold(1.0_f32, |m, c| m.max(c.abs())) + 1.0;
    sim::setup::set_grid(
        &mut store.step,
        Vec2::splat(-extent),
        Vec2::splat(extent),
        4.0 * extent * extent,
        layout.distance,
    );
    sim::setup::set_obstacles(&mut store, &[]);
    sim::setup::scratch(&mut store);
    store
}

/// The reference's preferred velocities, then one step.
fn step(store: &mut Store, layout: &Layout) {
    for pass in sim::order::step_passes(&store.step) {
        if pass.kernel != KernelId::Prefer {
            reference::run(pass.kernel, store, pass.level);
            continue;
        }
        for (agent, goal) in layout.goal.iter().enumerate() {
            let at = store.position[agent];
            let to = [goal[0] - at[0], goal[1] - at[1]];
            let distance = to[0].hypot(to[1]);
            let near = if layout.gentle { distance } else { distance / layout.time_step };
            let scale = if distance > 0.0 { layout.speed[agent].min(near) / distance } else { 0.0 };
            store.preferred_velocity[agent] = [to[0] * scale, to[1] * scale];
        }
    }
}

/// Smallest centre distance.
fn closest(store: &Store) -> f32 {
    let mut least = f32::MAX;
    for (i, a) in store.position.iter().enumerate() {
        for b in &store.position[..i] {
            least = least.min((a[0] - b[0]).hypot(a[1] - b[1]));
        }
    }
    least
}

fn arrived(store: &Store, layout: &Layout) -> bool {
    let near = |(p, g): (&[f32; 2], &[f32; 2])| (p[0] - g[0]).hypot(p[1] - g[1]) < layout.radius;
    store.position.iter().zip(&layout.goal).all(near)
}

fn data(name: &str) -> Option<Vec<(usize, usize, [f32; 2])>> {
    let root = std::env::var_os("GAITWAY_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from);
    let text = std::fs::read_to_string(root.join(format!("crowd-rvo2-reference/{name}.csv"))).ok();
    if text.is_none() {
        println!("skipped: no reference trajectory of {name} under {}", root.display());
    }
    let rows = text?.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
    let number = |field: Option<&str>| field.and_then(|f| f.trim().parse::<f64>().ok()).unwrap();
    let row = |line: &String| {
        let mut fields = line.split(',');
        let (step, agent) = (number(fields.next()) as usize, number(fields.next()) as usize);
        (step, agent, [number(fields.next()) as f32, number(fields.next()) as f32])
    };
    Some(rows.iter().map(row).collect())
}

/// Runs until arrival; the largest distance to the reference within the first `compared` steps, the step of arrival and
/// the smallest centre distance.
fn run(layout: &Layout, compared: usize, limit: usize) -> (f32, usize, f32) {
    let reference = data(layout.name).unwrap_or_default();
    let mut store = store(layout);
    let (mut worst, mut least) = (0.0_f32, f32::MAX);
    let mut rows = reference.iter().peekable();
    for number in 0..=limit {
        while let Some((_, agent, want)) = rows.next_if(|row| row.0 <= number) {
            let at = store.position[*agent];
            if number <= compared {
                worst = worst.max((at[0] - want[0]).hypot(at[1] - want[1]));
            }
        }
        least = least.min(closest(&store));
        if arrived(&store, layout) {
            return (worst, number, least);
        }
        step(&mut store, layout);
    }
    panic!("{}: not everyone arrived within {limit} steps", layout.name);
}

#[test]
fn two_head_on_follow_rvo2_within_ten_micrometres() {
    let layout = pair("headon2", [[-5.0, 0.0], [5.0, 0.1]], [[5.0, 0.0], [-5.0, 0.1]], [1.3, 1.3]);
    let (worst, steps, least) = run(&layout, usize::MAX, 200);
    println!("headon2: worst {worst} m, arrival {steps}, least {least} m");
    assert!(worst < 1e-5 && steps.abs_diff(75) <= 2 && (least - 0.6084).abs() < 1e-3);
}

#[test]
fn two_crossing_follow_rvo2_within_ten_micrometres() {
    let layout = pair("cross2", [[-5.0, 0.0], [0.0, -5.2]], [[5.0, 0.0], [0.0, 5.2]], [1.3, 1.0]);
    let (worst, steps, least) = run(&layout, usize::MAX, 300);
    println!("cross2: worst {worst} m, arrival {steps}, least {least} m");
    assert!(worst < 1e-5 && steps.abs_diff(102) <= 2 && (least - 1.0762).abs() < 1e-3);
}

#[test]
fn a_circle_of_twelve_follows_rvo2_until_they_meet_and_arrives_with_it() {
    let layout = circle12();
    let (worst, steps, least) = run(&layout, 30, 400);
    println!("circle12: worst {worst} m in 30 steps, arrival {steps}, least {least} m");
    assert!(worst < 1e-5 && steps.abs_diff(133) <= 2 && least > 0.5999);
}

#[test]
fn a_circle_of_250_arrives_no_closer_than_rvo2() {
    let (_, steps, least) = run(&circle250(), 0, 6000);
    println!("circle250: arrival {steps} (RVO2 3547), least {least} m (RVO2 2.344)");
    assert!(least >= 2.344);
}
