//! People differ: groups that walk together, classes, priorities; and floors that they walk on.

use gaitway::avatar::{Sex, generated};
use gaitway::ground::is_absent;
use gaitway::kernels::Store;
use gaitway::kernels::layout::{Body, Route, Stage, Stance};
use gaitway::library::GaitLibrary;
use gaitway::reference;
use gaitway::scenario::{Clearance, Scenario, populate};
use gaitway::sim::setup::{
    avoidance, join, scratch, set_floors, set_grid, set_obstacles, set_raised_obstacles,
};
use gaitway::sim::{AvatarSet, Backend, Simulation, measure, order};
use gaitway::verify::cases::crossing::crossing;
use glam::Vec2;

/// People from given places along +x, alone on a plane.
fn people(places: &[[f32; 2]], speeds: &[f32]) -> Store {
    let mut store = crossing(4, 10.0);
    let count = places.len();
    store.step.agent_count = count as u32;
    (store.step.wrap, store.step.perturbation) = (0.0, 0.02);
    store.position = places.to_vec();
    store.velocity = vec![[0.0; 2]; count];
    let body = |speed: f32| Body {
        radius: 0.25,
        max_speed: 1.5 * speed,
        preferred_speed: speed,
        walk_ratio: 0.4,
        ..Body::default()
    };
    store.body = (0..count).map(|i| body(speeds[i % speeds.len()])).collect();
    store.avoidance = vec![avoidance(2.0, 5.0, 10, 0.0); count];
    store.elevation = vec![0.0; count];
    store.heading = vec![0.0; count];
    store.stance = vec![Stance { walk_weight: 1.0, stride: 1.4, ..Stance::default() }; count];
    store.stages = vec![Stage::waypoint([1e4, 0.0], 1.0)];
    store.route = vec![Route::new(0, 1, false, 0); count];
    store.companions.clear();
    let low = Vec2::new(-20.0, -20.0);
    set_grid(&mut store.step, low, Vec2::new(120.0, 20.0), 5600.0, 5.0);
    set_obstacles(&mut store, &[]);
    scratch(&mut store);
    store
}

fn steps(store: &mut Store, count: u32) {
    let dispatches = order::step_dispatches(&store.step);
    for _ in 0..count {
        for dispatch in &dispatches {
            reference::run(dispatch.phase, store, dispatch.immediate);
        }
        store.step.step_index += 1;
    }
}

/// Greatest distance between two of the first `count`, m.
fn spread(store: &Store, count: usize) -> f32 {
    let p = |i: usize| Vec2::from(store.position[i]);
    (0..count).flat_map(|i| (0..i).map(move |j| p(i).distance(p(j)))).fold(0.0, f32::max)
}

#[test]
fn a_pair_walks_side_by_side_at_the_pace_of_the_slower() {
    let mut store = people(&[[0.0, 0.0], [-3.0, 0.5]], &[1.5, 1.0]);
    join(&mut store, &[0, 1]);
    steps(&mut store, 30 * 15);
    let mut across = 0.0;
    for _ in 0..10 {
        steps(&mut store, 30);
        let [a, b] = [store.position[0], store.position[1]];
        assert!((a[0] - b[0]).abs() < 0.45, "one walks ahead: {a:?} {b:?}");
        assert!(spread(&store, 2) < 1.3, "{a:?} {b:?}");
        across += (a[1] - b[1]).abs() * 0.1;
    }
    assert!((0.5..1.2).contains(&across), "{across} m side by side");
    let speed = store.velocity[1][0];
    assert!((0.8..=1.05).contains(&speed), "{speed} m/s");
}

#[test]
fn members_of_a_group_do_not_avoid_one_another_like_strangers() {
    // one comes up from behind at 1.3 m/s; at 0.9 m a stranger would brake for the two seconds ahead
    let speed_behind = |group: &[u32], model: u32| {
        let mut store = people(&[[0.0, 0.0], [0.9, 0.0]], &[1.3]);
        (store.step.crowding, store.step.perturbation) = (0.0, 0.0);
        (store.step.model, store.step.max_acceleration, store.step.collision_weight) = (model, 10.0, 1.0);
        store.velocity = vec![[1.3, 0.0], [0.4, 0.0]];
        if !group.is_empty() {
            join(&mut store, group);
        }
        steps(&mut store, 1);
        let [x, z] = store.velocity[0];
        (x.hypot(z), store)
    };
    for model in order::MODELS {
        let ((stranger, _), (member, mut store)) = (speed_behind(&[], model), speed_behind(&[0, 1], model));
        assert!(stranger < 1.25 && member > 1.29, "model {model}: {stranger} and {member} m/s");
        for _ in 0..30 * 10 {
            steps(&mut store, 1);
            assert_eq!(measure::measures(&store).overlapping_pairs, 0, "model {model}: {:?}", store.position);
        }
        assert!(spread(&store, 2) < 1.0, "model {model}: {:?}", store.position);
    }
}

#[test]
fn members_ahead_wait_for_one_that_fell_behind() {
    let mut store = people(&[[12.0, 0.0], [0.0, 0.0]], &[1.3]);
    join(&mut store, &[0, 1]);
    steps(&mut store, 60);
    let speed = Vec2::from(store.velocity[0]).length();
    assert!(speed < 0.3, "the one ahead walks on at {speed} m/s");
    steps(&mut store, 30 * 10);
    assert!(spread(&store, 2) < 1.6, "{:?}", store.position);
}

#[test]
fn a_group_splits_at_a_pillar_and_comes_together_behind_it() {
    for size in 2..=4_u32 {
        let places: Vec<[f32; 2]> =
            (0..size).map(|i| [0.0, 0.8 * i as f32 - 0.4 * (size - 1) as f32]).collect();
        let mut store = people(&places, &[1.3]);
        join(&mut store, &(0..size).collect::<Vec<_>>());
        let pillar = vec![[8.0, 0.1], [9.0, -0.9], [10.0, 0.1], [9.0, 1.1]];
        set_obstacles(&mut store, &[pillar]);
        let mut widest = 0.0_f32;
        for _ in 0..30 * 14 {
            steps(&mut store, 1);
            widest = widest.max(spread(&store, size as usize));
            assert_eq!(measure::measures(&store).overlapping_pairs, 0, "{:?}", store.position);
        }
        assert!(store.position.iter().all(|p| p[0] > 12.0), "{size}: {:?}", store.position);
        assert!(spread(&store, size as usize) < 0.9 * size as f32, "{size}: {:?}", store.position);
        assert!(widest < 6.0);
    }
}

#[test]
fn members_who_turn_back_at_different_times_do_not_hold_each_other_up() {
    let mut store = people(&[[0.0, 0.0], [-4.0, 0.0]], &[1.3]);
    store.stages = vec![Stage::waypoint([6.0, 0.0], 0.8), Stage::waypoint([-6.0, 0.0], 0.8)];
    store.route = vec![Route::new(0, 2, true, 0); 2];
    join(&mut store, &[0, 1]);
    steps(&mut store, 30 * 120);
    // 12 m there and back at 1.3 m/s: five rounds or six, fewer with the waiting
    assert!(store.route.iter().all(|route| route.arrivals >= 4), "{:?}", store.route);
    assert!(spread(&store, 2) < 2.0, "{:?}", store.position);
}

#[test]
fn groups_in_a_corridor_stay_together_abreast_and_do_not_overlap() {
    // 30 m by 8 m at 0.5 people/m2, walked round and round
    let text = r#"
        name = "corridor"
        bounds = [[-20, -4], [20, -4], [20, 4], [-20, 4]]
        [population]
        agents = 120
        groups.sizes = [0.2, 0.4, 0.25, 0.15]
        [[routes]]
        name = "along"
        waypoints = [[-18, 0], [18, 0]]
        width = 5.0
    "#;
    let scenario: Scenario = toml::from_str(text).unwrap();
    let library = GaitLibrary::built_in().unwrap();
    let cast = AvatarSet::new(library.gaits(), Sex::ALL.map(generated).to_vec()).unwrap();
    let crowd = populate(&scenario, |emotion| library.gaits_for(emotion)).unwrap();
    let mut simulation = Simulation::new(&scenario, &crowd, &cast, Backend::Cpu, None).unwrap();
    assert!(simulation.store().step.group_count > 20, "{}", simulation.store().step.group_count);
    let geometry = scenario.geometry();
    let walkable = Clearance::new(&geometry.bounds, &geometry.obstacles);
    let (mut distance, mut along, mut across, mut samples) = (0.0, 0.0, 0.0, 0.0_f32);
    for second in 0..40 {
        simulation.step(30).unwrap();
        let store = simulation.state().unwrap();
        assert_eq!(measure::measures(store).overlapping_pairs, 0, "second {second}");
        assert_eq!(measure::outside(store, |p| walkable.walkable(p)), 0, "second {second}");
        for (agent, others) in store.companions.iter().enumerate().filter(|_| second >= 10) {
            let at = Vec2::from(store.position[agent]);
            assert!(!is_absent(store.position[agent]));
            let others: Vec<Vec2> = others
                .iter()
                .filter_map(|o| store.position.get(*o as usize))
                .map(|p| Vec2::from(*p))
                .collect();
            if others.is_empty() {
                continue;
            }
            let centre = (others.iter().sum::<Vec2>() + at) / (others.len() as f32 + 1.0);
            distance += at.distance(centre);
            along += (at.x - centre.x).abs();
            across += (at.y - centre.y).abs();
            samples += 1.0;
        }
    }
    let (distance, along, across) = (distance / samples, along / samples, across / samples);
    println!("{distance:.2} m from the centre: {along:.2} m along, {across:.2} m across");
    assert!(distance < 1.2, "{distance} m from the centre of the group on average");
}

/// Two people head-on, the first a little to the side and of a priority; how far each leaves its line, m.
fn deviations(priority: f32) -> [f32; 2] {
    let mut store = people(&[[0.0, 0.05], [12.0, 0.0]], &[1.3]);
    store.step.perturbation = 0.0;
    store.stages = vec![Stage::waypoint([1e4, 0.0], 1.0), Stage::waypoint([-1e4, 0.0], 1.0)];
    store.route = vec![Route::new(0, 1, false, 0), Route::new(1, 1, false, 0)];
    store.avoidance[0].priority = priority;
    let mut most = [0.0_f32; 2];
    for _ in 0..30 * 10 {
        steps(&mut store, 1);
        most = [most[0].max((store.position[0][1] - 0.05).abs()), most[1].max(store.position[1][1].abs())];
    }
    assert!(store.position[0][0] > 8.0 && store.position[1][0] < 4.0, "{:?}", store.position);
    most
}

#[test]
fn an_agent_with_priority_leaves_its_way_less() {
    let [equal, half, full] = [0.0, 0.5, 1.0].map(deviations);
    println!("leaves its line by {equal:?}, {half:?}, {full:?} m");
    assert!((equal[0] - equal[1]).abs() < 0.1, "equal priorities: {equal:?}");
    // of the avoidance it takes 1/2, 1/4, nothing
    assert!(half[0] < 0.75 * equal[0] && half[1] > half[0], "{half:?}");
    assert!(full[0] < 0.02 && full[1] > 0.35, "{full:?}");
}

fn cast_of(library: &GaitLibrary) -> AvatarSet {
    AvatarSet::new(library.gaits(), Sex::ALL.map(generated).to_vec()).unwrap()
}

#[test]
fn a_class_walks_at_its_speed_with_the_strides_of_its_gaits() {
    let library = GaitLibrary::built_in().unwrap();
    let cast = cast_of(&library);
    let simulation = |text: &str| {
        let mut scenario = Scenario::builtin("crossing").unwrap().with_agents(40);
        scenario.population = toml::from_str(&format!("agents = 40\n{text}")).unwrap();
        let crowd = populate(&scenario, |emotion| library.gaits_for(emotion)).unwrap();
        Simulation::new(&scenario, &crowd, &cast, Backend::Cpu, None).unwrap()
    };
    let plain = simulation("");
    let mut slow =
        simulation("[[classes]]\nshare = 1\nspeed = [0.7, 0.9]\npriority = 0.5\nneighbour_cap = 6");
    for (own, before) in slow.store().body.iter().zip(&plain.store().body) {
        assert!(
            (0.7..=0.9).contains(&own.preferred_speed)
                && own.walk_ratio.to_bits() == before.walk_ratio.to_bits(),
            "{own:?} {before:?}"
        );
    }
    assert!(slow.store().avoidance.iter().all(|own| own.priority == 0.5 && own.neighbour_cap == 6.0));
    // a stride of the feet for every stride of the way: they do not slide
    let before = slow.store().clone();
    slow.step(1).unwrap();
    let after = slow.state().unwrap();
    for i in 0..40 {
        let way = Vec2::from(after.position[i]).distance(Vec2::from(before.position[i]));
        let strides =
            f64::from(after.stance[i].phase.wrapping_sub(before.stance[i].phase)) / f64::from(u32::MAX);
        assert!((strides * f64::from(after.stance[i].stride) - f64::from(way)).abs() < 1e-4, "agent {i}");
    }
}

/// A bridge along x, three metres above a path along z.
const BRIDGE: &str = r#"
    name = "bridge"
    bounds = [[-32, -20], [32, -20], [32, 20], [-32, 20]]
    [population]
    agents = 60
    [[floors]]
    polygon = [[-20, -2], [-6, -2], [-6, 2], [-20, 2]]
    heights = [0, 3, 3]
    railings = [0, 2]
    [[floors]]
    polygon = [[-6, -2], [6, -2], [6, 2], [-6, 2]]
    heights = [3]
    railings = [0, 2]
    [[floors]]
    polygon = [[6, -2], [20, -2], [20, 2], [6, 2]]
    heights = [3, 0, 0]
    railings = [0, 2]
    [[routes]]
    name = "over"
    waypoints = [[-29, 0], [29, 0]]
    width = 2.2
    [[routes]]
    name = "under"
    waypoints = [[0, -18], [0, 18]]
    width = 8.0
"#;

#[test]
fn people_on_a_bridge_and_under_it_do_not_meet() {
    let scenario: Scenario = toml::from_str(BRIDGE).unwrap();
    assert_eq!(toml::from_str::<Scenario>(&scenario.to_toml().unwrap()).unwrap(), scenario);
    let library = GaitLibrary::built_in().unwrap();
    let crowd = populate(&scenario, |emotion| library.gaits_for(emotion)).unwrap();
    let cast = cast_of(&library);
    let mut simulation = Simulation::new(&scenario, &crowd, &cast, Backend::Cpu, None).unwrap();
    let over: Vec<bool> =
        crowd.agents.iter().map(|a| crowd.stages[a.route_start as usize].position.x.abs() > 12.0).collect();
    assert!(over.iter().any(|o| *o) && over.iter().any(|o| !o));
    assert!(crowd.agents.iter().any(|agent| agent.elevation > 2.9), "no agent starts on the bridge");
    let (mut crossed, mut apart) = (0, f32::INFINITY);
    let (mut climbed, mut above) = (0, 0);
    for _ in 0..30 * 40 {
        simulation.step(1).unwrap();
        let store = simulation.state().unwrap();
        for i in 0..60 {
            let ([x, z], height) = (store.position[i], store.elevation[i]);
            let deck = 3.0 - ((x.abs() - 6.0).max(0.0) * 3.0 / 14.0).min(3.0);
            if over[i] && x.abs() < 19.0 {
                assert!((height - deck).abs() < 0.15, "agent {i} at {x}, {z}: {height} m instead of {deck}");
                assert!(z.abs() < 1.8, "agent {i} at {x}, {z} is beyond the railing");
                climbed += 1;
            } else if !over[i] && x.abs() < 5.0 {
                assert!(height.abs() < 1e-6, "agent {i} at {x}, {z} is at {height} m");
            }
            for j in 0..i {
                let distance = Vec2::from(store.position[i]).distance(Vec2::from(store.position[j]));
                if (store.elevation[j] - height).abs() > 2.5 {
                    crossed += u32::from(distance < 0.3);
                    above += 1;
                } else {
                    apart = apart.min(distance - store.body[i].radius - store.body[j].radius);
                }
            }
        }
    }
    println!("{crossed} times one above another, least gap on one storey {apart} m");
    assert!(climbed > 1000 && above > 1000);
    assert!(crossed > 10, "no agent ever walked above another");
    assert!(apart > -0.06, "people on one storey overlap: {apart} m");
}

#[test]
fn a_railing_holds_agents_on_the_bridge_and_none_under_it() {
    let mut scenario: Scenario = toml::from_str(BRIDGE).unwrap();
    scenario.population.agents = 0;
    let geometry = scenario.geometry();
    for (height, passes) in [(3.0, false), (0.0, true)] {
        let mut store = people(&[[0.0, 0.0]], &[1.3]);
        store.stages = vec![Stage::waypoint([0.0, 12.0], 1.0)];
        store.elevation = vec![height];
        set_raised_obstacles(&mut store, &[], &geometry.floors.raised);
        set_floors(&mut store, &geometry.floors);
        for model in order::MODELS {
            let mut store = store.clone();
            store.step.model = model;
            steps(&mut store, 30 * 12);
            let [_, z] = store.position[0];
            assert_eq!(z > 5.0, passes, "model {model}: at {height} m it came to {z}");
            assert!(passes || z < 1.9, "{z}");
            assert!((store.elevation[0] - height).abs() < 1e-5);
        }
    }
}

#[test]
fn agents_avoid_a_user_on_their_storey_and_ignore_one_on_another() {
    let library = GaitLibrary::built_in().unwrap();
    let cast = cast_of(&library);
    // one over the bridge, one under it; the user in the way of both, upstairs, below, or nowhere
    let way = "[[walkers]]\nposition = [-24, 0]\nwaypoints = [[12, 0]]\nspeed = 1.3\n\
               [[walkers]]\nposition = [0, -16]\nwaypoints = [[0, 16]]\nspeed = 1.3\n";
    let aside = |model: &str, user: &str, goes_up: bool| {
        let scene = BRIDGE.replace("agents = 60", "agents = 0");
        let text = format!("{scene}{way}[navigation]\nmodel = \"{model}\"\nperturbation = 0.0\n{user}");
        let scenario = Scenario::parse(&text, "bridge").unwrap();
        let crowd = populate(&scenario, |emotion| library.gaits_for(emotion)).unwrap();
        let mut simulation = Simulation::new(&scenario, &crowd, &cast, Backend::Cpu, None).unwrap();
        if goes_up {
            simulation.set_user(Vec2::splat(0.1), 3.0, Vec2::ZERO);
        }
        let mut farthest = [0.0_f32; 2];
        for _ in 0..30 * 29 {
            simulation.step(1).unwrap();
            let store = simulation.state().unwrap();
            farthest[0] = farthest[0].max(store.position[0][1].abs());
            farthest[1] = farthest[1].max(store.position[1][0].abs());
        }
        let store = simulation.state().unwrap();
        assert!(store.position[0][0] > 8.0 && store.position[1][1] > 14.0, "{model}: {:?}", store.position);
        farthest
    };
    for model in ["orca", "rvo"] {
        let [over, under] = aside(model, "[user]\nposition = [0.1, 0.1]\n", false);
        assert!(
            over < 0.05 && under > 0.3,
            "{model}, below: {over} m aside on the bridge, {under} m under it"
        );
        for (user, goes_up) in [("elevation = 3.2\n", false), ("", true)] {
            let [over, under] = aside(model, &format!("[user]\nposition = [0.1, 0.1]\n{user}"), goes_up);
            assert!(
                over > 0.3 && under < 0.05,
                "{model}, above: {over} m aside on the bridge, {under} m under it"
            );
        }
    }
}

#[test]
fn the_user_stands_on_the_floor_that_the_scenario_says() {
    let place = |user: &str| Scenario::parse(&format!("{BRIDGE}[user]\n{user}"), "bridge");
    let eyes = |user: &str| {
        let scenario = place(user).unwrap();
        scenario.geometry().eyes(&scenario).unwrap().y
    };
    assert!((eyes("position = [0, 0]") - 1.65).abs() < 1e-5);
    assert!((eyes("position = [0, 0]\nelevation = 2.6") - 4.65).abs() < 1e-5);
    // on the ramp, half way up
    assert!((eyes("position = [-13, 0]\nelevation = 1.5\neye_height = 1.2") - 2.7).abs() < 1e-5);
    for (wrong, says) in [
        (
            "position = [0, 0]\nelevation = 2",
            "user.elevation = 2: must be within a step of 0.6 m of a floor at (0, 0): 0.00, 3.00",
        ),
        ("position = [0, 9]\nelevation = 3", "of a floor at (0, 9): 0.00"),
        ("elevation = nan", "user.elevation"),
    ] {
        let text = place(wrong).unwrap_err().to_string();
        assert!(text.contains(says), "{text}");
    }
}

#[test]
fn everyone_begins_to_walk_after_their_own_reaction_time() {
    // RiMEA's test 5: ten people in a room, reaction times from 1 to 10 s (there: 10 to 100)
    let text = r#"
        name = "reaction"
        bounds = [[-30, -20], [30, -20], [30, 20], [-30, 20]]
        [population]
        agents = 10
        [[population.classes]]
        share = 1
        reaction = [1, 10]
        [[routes]]
        name = "out"
        waypoints = [[-28, 0], [28, 0]]
        width = 34.0
    "#;
    let scenario: Scenario = toml::from_str(text).unwrap();
    let library = GaitLibrary::built_in().unwrap();
    let crowd = populate(&scenario, |emotion| library.gaits_for(emotion)).unwrap();
    let mut simulation = Simulation::new(&scenario, &crowd, &cast_of(&library), Backend::Cpu, None).unwrap();
    let mut began = [0.0_f32; 10];
    for step in 0..30 * 12 {
        simulation.step(1).unwrap();
        let store = simulation.state().unwrap();
        for (i, began) in began.iter_mut().enumerate() {
            // a standing agent may step aside, but does not walk
            let speed = Vec2::from(store.velocity[i]).length();
            if *began == 0.0 && speed > 0.7 * store.body[i].preferred_speed {
                *began = (step + 1) as f32 / 30.0;
            }
        }
    }
    for (began, agent) in began.iter().zip(&crowd.agents) {
        assert!(
            (began - agent.reaction - 1.0 / 30.0).abs() < 0.05,
            "{began} s instead of {}",
            agent.reaction
        );
    }
    let spread =
        began.iter().fold(0.0, |most, b| b.max(most)) - began.iter().fold(99.0, |least, b| b.min(least));
    assert!(spread > 4.0, "{began:?}");
}
