//! ORCA against a plain statement of its paper (`rvo2/plain.rs`), whose trajectories are made here, and against RVO2's own
//! trajectories, where they are present (`GAITWAY_DATA` or `../shared/data`).

mod plain;

use crate::common;
use gaitway::kernels::layout::{Body, Route, Stage, Stance, StepUniforms};
use gaitway::kernels::{KernelId, Store};
use gaitway::reference::exact::{hash_u32, unit_f32};
use gaitway::reference::orca::{self, Line};
use gaitway::{reference, sim};
use glam::{DVec2, Vec2};
use plain::{Crowd, Disc, HalfPlane};

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
        body: vec![
            Body {
                radius: layout.radius,
                max_speed: layout.max_speed,
                preferred_speed: 1.0,
                walk_ratio: 0.4,
                ..Body::default()
            };
            count
        ],
        avoidance: vec![sim::setup::avoidance(layout.horizon, layout.distance, 10, 0.0); count],
        elevation: vec![0.0; count],
        heading: vec![0.0; count],
        stance: vec![Stance::default(); count],
        route: vec![Route::new(0, 1, false, 0); count],
        stages: vec![Stage::waypoint([0.0, 0.0], 0.0)],
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

/// The velocity that an agent prefers: towards its goal.
fn preferred(layout: &Layout, agent: usize, at: DVec2) -> DVec2 {
    let to = Vec2::from(layout.goal[agent]).as_dvec2() - at;
    let distance = to.length();
    let near = if layout.gentle { distance } else { distance / f64::from(layout.time_step) };
    to.normalize_or_zero() * f64::from(layout.speed[agent]).min(near)
}

/// The same crowd in the plain statement.
fn plain(layout: &Layout, store: &Store) -> Crowd {
    let vector = |v: &[f32; 2]| Vec2::from(*v).as_dvec2();
    let disc = |(position, velocity)| Disc { position: vector(position), velocity: vector(velocity) };
    Crowd {
        discs: store.position.iter().zip(&store.velocity).map(disc).collect(),
        radius: layout.radius.into(),
        max_speed: layout.max_speed.into(),
        horizon: layout.horizon.into(),
        distance: layout.distance.into(),
        neighbours: 10,
        time_step: layout.time_step.into(),
    }
}

/// The reference's preferred velocities, then one step.
fn step(store: &mut Store, layout: &Layout) {
    for dispatch in sim::order::step_dispatches(&store.step) {
        reference::run(dispatch.phase, store, dispatch.immediate);
        if dispatch.kernel() != KernelId::AdvanceJourney {
            continue;
        }
        for agent in 0..layout.goal.len() {
            // in 32 bits, as RVO2 does
            let at = store.position[agent];
            let to = [layout.goal[agent][0] - at[0], layout.goal[agent][1] - at[1]];
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

/// Step, agent, place and velocity.
type Row = (usize, usize, [f32; 2], [f32; 2]);

fn data(name: &str) -> Option<Vec<Row>> {
    let folder = common::data_set("crowd-rvo2-reference")?;
    let text = std::fs::read_to_string(folder.join(format!("{name}.csv"))).unwrap();
    let rows = text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
    let number = |field: Option<&str>| field.and_then(|f| f.trim().parse::<f64>().ok()).unwrap();
    let row = |line: &String| {
        let mut fields = line.split(',');
        let (step, agent) = (number(fields.next()) as usize, number(fields.next()) as usize);
        let mut vector = || [number(fields.next()) as f32, number(fields.next()) as f32];
        (step, agent, vector(), vector())
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
        while let Some((_, agent, want, _)) = rows.next_if(|row| row.0 <= number) {
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

/// Two blocks of nine that walk through one another: the crossing of the paper's demonstrations.
fn blocks() -> Layout {
    let place = |i: usize| [0.97 * (i % 3) as f32 + 0.03 * (i / 3) as f32, 1.01 * (i / 3) as f32 - 1.0];
    let (mut start, mut goal) = (Vec::new(), Vec::new());
    for i in 0..18 {
        let [x, y] = place(i % 9);
        let (from, to) = if i < 9 { ([-6.0 + x, y], [6.0 + x, y]) } else { ([y, 5.1 - x], [y, -6.2 - x]) };
        start.push(from);
        goal.push(to);
    }
    let speed = (0..18).map(|i| 1.0 + 0.02 * i as f32).collect();
    Layout { start, goal, speed, ..pair("blocks", [[0.0; 2]; 2], [[0.0; 2]; 2], [0.0; 2]) }
}

/// The largest distance between the kernel's trajectories and those of the plain statement over so many steps, and the
/// smallest distance between two centres, m.
fn beside_plain(layout: &Layout, steps: usize) -> (f64, f32) {
    let mut store = store(layout);
    let mut plain = plain(layout, &store);
    let (mut worst, mut least) = (0.0_f64, f32::MAX);
    for _ in 0..steps {
        let wanted: Vec<DVec2> =
            plain.discs.iter().enumerate().map(|(i, disc)| preferred(layout, i, disc.position)).collect();
        plain.step(&wanted);
        step(&mut store, layout);
        for (disc, at) in plain.discs.iter().zip(&store.position) {
            worst = worst.max(disc.position.distance(Vec2::from(*at).as_dvec2()));
        }
        least = least.min(closest(&store));
    }
    (worst, least)
}

#[test]
fn published_scenes_give_the_trajectories_of_the_plain_statement_within_ten_micrometres() {
    let headon = pair("headon2", [[-5.0, 0.0], [5.0, 0.1]], [[5.0, 0.0], [-5.0, 0.1]], [1.3, 1.3]);
    let cross = pair("cross2", [[-5.0, 0.0], [0.0, -5.2]], [[5.0, 0.0], [0.0, 5.2]], [1.3, 1.0]);
    // the larger ones until they come near: from then on the error of 32 bits doubles every few steps
    for (layout, steps) in [(headon, 80), (cross, 105), (circle12(), 15), (blocks(), 25)] {
        let (worst, least) = beside_plain(&layout, steps);
        println!("{}: worst {worst:.1e} m in {steps} steps, least {least} m", layout.name);
        assert!(worst < 1e-5, "{}: {worst} m", layout.name);
    }
}

/// How the velocities of the kernel's steps compare with those of the plain statement from the same states.
#[derive(Debug, Default)]
struct Compared {
    asked: usize,
    /// Agents that cannot avoid all others.
    jammed: usize,
    /// Those more than a millimetre a second from the plain statement's.
    rough: usize,
}

impl Compared {
    /// Does one step.
    fn step(&mut self, store: &mut Store, layout: &Layout) {
        let plain = plain(layout, store);
        step(store, layout);
        for (agent, velocity) in store.velocity.iter().enumerate() {
            let choice = plain.choice(agent, preferred(layout, agent, plain.discs[agent].position));
            self.asked += 1;
            self.jammed += usize::from(choice.violation > 0.0);
            self.rough += usize::from(choice.velocity.distance(Vec2::from(*velocity).as_dvec2()) > 1e-3);
        }
    }
}

#[test]
fn published_scenes_are_the_plain_statements_step_for_step_also_where_all_meet() {
    for (layout, steps) in [(circle12(), 133), (blocks(), 130)] {
        let (mut store, mut compared) = (store(&layout), Compared::default());
        (0..steps).for_each(|_| compared.step(&mut store, &layout));
        println!("{}: {compared:?}", layout.name);
        assert!(compared.jammed > 5 && compared.rough == 0, "{}: {compared:?}", layout.name);
    }
}

/// A number in -1..1.
fn dice(seed: &mut u32) -> f32 {
    *seed = hash_u32(*seed);
    2.0 * unit_f32(*seed) - 1.0
}

#[test]
fn in_a_jam_each_takes_the_velocity_that_the_plain_statement_takes() {
    let mut compared = Compared::default();
    for crowd in 0..40 {
        let seed = &mut (crowd * 77 + 1);
        let mut somewhere =
            |scale: f32| (0..40).map(|_| [scale * dice(seed), scale * dice(seed)]).collect::<Vec<_>>();
        let (start, goal, velocity) = (somewhere(2.4), somewhere(6.0), somewhere(0.9));
        let base = pair("jam", [[0.0; 2]; 2], [[0.0; 2]; 2], [0.0; 2]);
        let layout = Layout { start, goal, speed: vec![1.2; 40], ..base };
        let mut store = store(&layout);
        store.velocity = velocity;
        compared.step(&mut store, &layout);
    }
    println!("{compared:?}");
    // two lines that are nearly parallel meet far away, where 32 bits are coarse
    assert!(compared.jammed * 2 > compared.asked && compared.rough * 500 <= compared.asked, "{compared:?}");
}

/// The half-plane of a line of the kernel.
fn half_plane(line: &Line) -> HalfPlane {
    let [x, y, u, v] = line.map(f64::from);
    HalfPlane { point: DVec2::new(x, y), normal: DVec2::new(-v, u).normalize() }
}

#[test]
fn least_bad_violates_as_little_as_can_be_and_never_a_wall() {
    const MOST: f32 = 1.6;
    let (mut jammed, mut walled, mut rough) = (0, 0, 0);
    for case in 0..6000_u32 {
        let seed = &mut (case + 1);
        let hard = (case % 4) as usize;
        let count = hard + 2 + (case / 4 % 9) as usize;
        let mut line = |number: usize| {
            let angle = std::f32::consts::PI * dice(seed);
            let normal = Vec2::from_angle(angle);
            // walls leave standing still; the others leave little
            let offset = if number < hard { -0.4 - 0.4 * dice(seed) } else { 0.7 + 0.8 * dice(seed) };
            let (point, along) = (normal * offset + normal.perp() * dice(seed), -normal.perp());
            [point.x, point.y, along.x, along.y]
        };
        let lines: Vec<Line> = (0..count).map(&mut line).collect();
        let preferred = [1.5 * dice(seed), 1.5 * dice(seed)];
        let (satisfied, start) = orca::within(&lines, MOST, preferred, false);
        let planes: Vec<HalfPlane> = lines.iter().map(half_plane).collect();
        let wanted = Vec2::from(preferred).as_dvec2();
        let choice = plain::choose(&planes, hard, MOST.into(), wanted).expect("walls leave standing still");
        let found =
            if satisfied == count { start } else { orca::least_bad(&lines, hard, satisfied, MOST, start) };
        let found = Vec2::from(found).as_dvec2();
        let violation = |planes: &[HalfPlane]| planes.iter().map(|p| p.violation(found)).fold(0.0, f64::max);
        assert!(violation(&planes[..hard]) < 1e-3, "case {case}: {found} is in a wall");
        assert!(violation(&planes) < choice.violation + 1e-3, "case {case}: {found}, {choice:?}");
        if choice.violation > 1e-3 {
            jammed += 1;
            walled += usize::from(hard > 0);
            rough += usize::from(found.distance(choice.velocity) > 1e-3);
        }
    }
    println!(
        "{jammed} without a permitted velocity, {walled} of them with walls; {rough} more than 1 mm/s apart"
    );
    // where two lines are nearly parallel, they meet far away, and 32 bits are coarse there
    assert!(jammed > 2000 && walled > 1000 && rough * 200 < jammed, "{jammed}, {walled}, {rough}");
}

#[test]
fn each_step_of_rvo2_in_its_jam_is_ours_and_the_plain_statements() {
    let layout = circle12();
    let Some(rows) = data(layout.name) else { return };
    let steps: Vec<&[Row]> = rows.chunk_by(|a, b| a.0 == b.0).collect();
    let (mut jammed, mut worst) = (0, [0.0_f64; 2]);
    for pair in steps.windows(2) {
        let mut store = store(&layout);
        for &(_, agent, place, velocity) in pair[0] {
            (store.position[agent], store.velocity[agent]) = (place, velocity);
        }
        let plain = plain(&layout, &store);
        step(&mut store, &layout);
        for &(_, agent, _, theirs) in pair[1] {
            let theirs = Vec2::from(theirs).as_dvec2();
            let choice = plain.choice(agent, preferred(&layout, agent, plain.discs[agent].position));
            jammed += usize::from(choice.violation > 0.0);
            worst[0] = worst[0].max(theirs.distance(Vec2::from(store.velocity[agent]).as_dvec2()));
            worst[1] = worst[1].max(theirs.distance(choice.velocity));
        }
    }
    println!(
        "{} steps, {jammed} velocities out of a jam: ours {:.1e}, plain {:.1e} m/s from RVO2's",
        steps.len(),
        worst[0],
        worst[1]
    );
    assert!(jammed > 50 && worst[0] < 1e-4 && worst[1] < 1e-3, "{jammed}, {worst:?}");
}
