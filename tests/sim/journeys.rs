//! Journeys: sources, goals, waiting areas and exits, as scenario files ask for them.

use crate::common::gpu;
use gaitway::avatar::{Sex, generated};
use gaitway::kernels::Store;
use gaitway::library::GaitLibrary;
use gaitway::scenario::{Crowd, Entry, Scenario, populate};
use gaitway::sim::measure::{self, Measures};
use gaitway::sim::{AvatarSet, Backend, Simulation};
use glam::Vec2;
use std::sync::OnceLock;

/// A hall of 40 m by 20 m, its user far out of the way.
const HALL: &str = "
bounds = [[-20, -10], [20, -10], [20, 10], [-20, 10]]
[user]
avoided = false
";

fn library() -> &'static (GaitLibrary, AvatarSet) {
    static ALL: OnceLock<(GaitLibrary, AvatarSet)> = OnceLock::new();
    ALL.get_or_init(|| {
        let library = GaitLibrary::built_in().unwrap();
        let cast = AvatarSet::new(library.gaits(), Sex::ALL.map(generated).to_vec()).unwrap();
        (library, cast)
    })
}

fn scenario(agents: u32, more: &str) -> Scenario {
    let text = format!("name = \"hall\"\n{HALL}\n{more}").replace("AGENTS", &agents.to_string());
    Scenario::parse(&text, "test").unwrap().with_agents(agents)
}

fn fill(scenario: &Scenario) -> Crowd {
    populate(scenario, |emotion| library().0.gaits_for(emotion)).unwrap()
}

fn simulation(scenario: &Scenario, backend: Backend) -> Simulation {
    Simulation::new(scenario, &fill(scenario), &library().1, backend, None).unwrap()
}

fn refused(more: &str) -> String {
    let text = format!("name = \"hall\"\n{HALL}\n{more}");
    match Scenario::parse(&text, "hall.toml") {
        Ok(scenario) => match populate(&scenario, |emotion| library().0.gaits_for(emotion)) {
            Ok(_) => panic!("accepted: {more}"),
            Err(error) => error.to_string(),
        },
        Err(error) => error.to_string(),
    }
}

fn moment(simulation: &mut Simulation) -> Measures {
    measure::measures(simulation.state().unwrap())
}

fn present(store: &Store, agent: usize) -> bool {
    store.position[agent][0] < 1e8
}

/// In at the left, out at the right.
const THROUGH: &str = "
[[stages]]
name = \"out\"
kind = \"exit\"
position = [18, 0]
size = [2, 12]
[[journeys]]
name = \"through\"
stages = [\"out\"]
";

#[test]
fn people_come_in_at_the_rate_of_their_source_walk_and_leave_by_the_exit() {
    let hall = scenario(
        60,
        &format!(
            "{THROUGH}[[sources]]\npolygon = [[-19, -8], [-15, -8], [-15, 8], [-19, 8]]\nrate = 2.0\nbegin = 3.0\n"
        ),
    );
    let mut simulation = simulation(&hall, Backend::Cpu);
    assert_eq!(moment(&mut simulation).entered, 0);
    let mut gone = Vec::new();
    for second in 1..=75_u32 {
        for _ in 0..30 {
            simulation.step(1).unwrap();
            let now = moment(&mut simulation);
            assert_eq!(now.overlapping_pairs, 0, "second {second}: {now:?}");
        }
        let now = moment(&mut simulation);
        // one each half second from 3 s on; the step at a whole second is done at its end
        let due = (2 * second).saturating_sub(6).min(60);
        assert_eq!((now.entered, now.waiting_outside), (due, 0), "second {second}");
        assert_eq!(now.entered - now.left, now.present);
        assert_eq!(now.arrived, u64::from(now.left));
        let store = simulation.state().unwrap();
        for agent in 0..60 {
            let was_there = store.route[agent].arrivals > 0;
            assert!(!(was_there && present(store, agent)), "{agent} came back");
            if was_there && !gone.contains(&agent) {
                gone.push(agent);
            }
        }
    }
    let end = moment(&mut simulation);
    assert_eq!((end.entered, end.present, end.left, end.never), (60, 0, 60, 0), "the room is empty");
    assert_eq!(end.mean_speed, 0.0);
    assert_eq!(gone.len(), 60);
}

#[test]
fn a_schedule_is_kept_one_a_step_and_those_without_a_time_never_come() {
    let hall = scenario(
        50,
        &format!(
            "{THROUGH}[[sources]]\npolygon = [[-19, -8], [-9, -8], [-9, 8], [-19, 8]]\n\
             schedule = [{{ time = 1, count = 12 }}, {{ time = 4.5, count = 20 }}]\n"
        ),
    );
    let crowd = fill(&hall);
    assert_eq!(crowd.agents.iter().filter(|agent| agent.entry == Entry::Never).count(), 18);
    let mut simulation = simulation(&hall, Backend::Cpu);
    for (steps, entered) in [(30, 0), (1, 1), (11, 12), (60, 12), (33, 12), (20, 32), (60, 32)] {
        simulation.step(steps).unwrap();
        let now = moment(&mut simulation);
        assert_eq!((now.entered, now.never), (entered, 18), "after {} steps", simulation.steps_done());
    }
}

#[test]
fn who_finds_no_room_waits_outside_and_keeps_its_place_in_the_order() {
    // forty people a second into two square metres, which they cannot leave quickly
    let hall = scenario(
        120,
        &format!(
            "{THROUGH}[[sources]]\npolygon = [[-19, 0], [-17, 0], [-17, 1], [-19, 1]]\nrate = 20.0\nend = 6.0\n"
        ),
    );
    let mut simulation = simulation(&hall, Backend::Cpu);
    let (mut most, mut last) = (0, 0);
    for _ in 0..30 * 80 {
        simulation.step(1).unwrap();
        let now = moment(&mut simulation);
        most = most.max(now.waiting_outside);
        assert!(now.entered <= last + 1, "at most one a step");
        // a press at the door may overlap by some millimetres; who comes in on top of another does so by decimetres
        assert!(now.min_clearance > -0.01, "an agent came in on top of another: {now:?}");
        let store = simulation.state().unwrap();
        let inside = |agent: usize| present(store, agent) || store.route[agent].arrivals > 0;
        assert!((0..120).all(|agent| inside(agent) == (agent < now.entered as usize)), "out of order");
        last = now.entered;
    }
    assert!(most > 40, "only {most} had to wait");
    assert_eq!((last, moment(&mut simulation).waiting_outside), (120, 0));
}

#[test]
fn two_hundred_people_share_a_goal_arrive_and_stand_still() {
    let hall = scenario(
        200,
        "[[stages]]\nname = \"stage\"\nkind = \"goal\"\nposition = [10, 0]\nsize = [12, 14]\nheading_deg = 20\n\
         [[journeys]]\nname = \"gather\"\nstages = [\"stage\"]\n\
         [[spawns]]\npolygon = [[-19, -9], [-3, -9], [-3, 9], [-19, 9]]\njourneys = [\"gather\"]\n",
    );
    let mut simulation = simulation(&hall, Backend::Cpu);
    simulation.step(30 * 120).unwrap();
    let (before, speeds): (Vec<[f32; 2]>, Vec<f32>) = {
        let store = simulation.state().unwrap();
        (store.position.clone(), store.velocity.iter().map(|v| v[0].hypot(v[1])).collect())
    };
    assert_eq!(moment(&mut simulation).arrived, 200);
    assert_eq!(moment(&mut simulation).overlapping_pairs, 0);
    let moving = speeds.iter().filter(|speed| **speed > 0.02).count();
    assert_eq!(moving, 0, "{moving} still move");
    simulation.step(30 * 10).unwrap();
    let after = &simulation.state().unwrap().position;
    let farthest =
        before.iter().zip(after).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f32::max);
    assert!(farthest < 0.05, "an agent crept {farthest} m in ten seconds");
}

#[test]
fn a_waiting_area_holds_people_for_their_time_and_until_its_time() {
    let hall = scenario(
        20,
        "[[stages]]\nname = \"hall\"\nkind = \"waiting\"\nposition = [0, 0]\nsize = [8, 8]\nwait = 5\nuntil = 30\n\
         [[stages]]\nname = \"out\"\nkind = \"exit\"\nposition = [18, 0]\nsize = [3, 16]\n\
         [[journeys]]\nname = \"wait\"\nstages = [\"hall\", \"out\"]\n\
         [[sources]]\npolygon = [[-19, -8], [-10, -8], [-10, 8], [-19, 8]]\nrate = 0.5\n",
    );
    let mut simulation = simulation(&hall, Backend::Cpu);
    let mut waited = [0_u32; 20];
    for step in 0..30 * 90_u32 {
        simulation.step(1).unwrap();
        let store = simulation.state().unwrap();
        for (agent, waited) in waited.iter_mut().enumerate() {
            assert!(step >= 30 * 30 || store.route[agent].next == 0, "left before its time");
            *waited += u32::from(store.stage_progress[agent] > 0);
        }
    }
    assert_eq!(moment(&mut simulation).left, 20);
    assert!(waited.iter().all(|steps| *steps >= 150), "{waited:?}");
    assert!(waited[19] <= 152, "the last came after 30 s and waits its own time only: {}", waited[19]);
}

#[test]
fn people_part_by_shares_and_the_way_of_each_depends_on_its_number_alone() {
    let text = |count: u32| {
        scenario(
            count,
            "[[stages]]\nname = \"a\"\nkind = \"waypoint\"\nposition = [0, 5]\n\
             [[stages]]\nname = \"b\"\nkind = \"waypoint\"\nposition = [0, -5]\n\
             [[stages]]\nname = \"out\"\nkind = \"exit\"\nposition = [18, 0]\nsize = [3, 16]\n\
             [[journeys]]\nname = \"fork\"\nstages = [{ a = 3, b = 1 }, \"out\"]\n\
             [[sources]]\npolygon = [[-19, -8], [-10, -8], [-10, 8], [-19, 8]]\nrate = 0.5\n",
        )
    };
    let first = |crowd: &Crowd| -> Vec<f32> {
        crowd.agents.iter().map(|a| crowd.stages[a.route_start as usize].position.y).collect()
    };
    let all = first(&fill(&text(1000)));
    let upper = all.iter().filter(|z| **z == 5.0).count();
    assert!((690..810).contains(&upper), "{upper} of 1000 go by a, wanted three quarters");
    assert_eq!(first(&fill(&text(100))), all[..100]);
    let again = Scenario::parse(&text(100).to_toml().unwrap(), "again").unwrap();
    assert_eq!(again, text(100), "written and read");
}

#[test]
fn the_population_is_divided_among_start_and_sources_as_the_file_says() {
    let hall = scenario(
        100,
        &format!(
            "{THROUGH}[population]\npresent = 0.2\n\
             [[spawns]]\npolygon = [[-4, -9], [4, -9], [4, 9], [-4, 9]]\njourneys = [\"through\"]\n\
             [[sources]]\npolygon = [[-19, -9], [-15, -9], [-15, -5], [-19, -5]]\nrate = 1.0\n\
             [[sources]]\npolygon = [[-19, -4], [-15, -4], [-15, 0], [-19, 0]]\nrate = 1.0\nend = 12.0\n\
             [[sources]]\npolygon = [[-19, 1], [-15, 1], [-15, 5], [-19, 5]]\nrate = 1.0\nshare = 0.25\n"
        ),
    );
    let crowd = fill(&hall);
    let counts: Vec<u32> = crowd.sources.iter().map(|source| source.agents).collect();
    assert_eq!(counts, [43, 12, 25]);
    assert_eq!(crowd.agents.iter().filter(|agent| agent.entry == Entry::Start).count(), 20);
    for (source, (low, high)) in crowd.sources.iter().zip([(-9.0, -5.0), (-4.0, 0.0), (1.0, 5.0)]) {
        let inside = |p: &Vec2| (-19.0..=-15.0).contains(&p.x) && (low..=high).contains(&p.y);
        assert!(source.places.len() > 60 && source.places.iter().all(inside));
    }
}

#[test]
fn what_is_wrong_with_a_journey_is_said_with_key_value_range_and_way_out() {
    let source = "[[sources]]\npolygon = [[-19, -9], [-15, -9], [-15, -5], [-19, -5]]\nrate = 1.0\n";
    let goal = |extra: &str| {
        format!(
            "[[stages]]\nname = \"g\"\nkind = \"goal\"\nposition = [0, 0]\n{extra}\n[[journeys]]\nname = \"j\"\nstages = [\"g\"]\n{source}"
        )
    };
    for (text, parts) in [
        (goal(""), ["stages[0].size", "width, depth", "hall.toml:7"]),
        (goal("size = [4, 4]\nradius = 2"), ["stages[0].radius", "left out", "size"]),
        (goal("size = [4, 4]\nwait = 2"), ["stages[0].wait", "left out", "waiting"]),
        (
            goal("size = [4, 4]").replace("[0, 0]", "[0, 90]"),
            ["stages[0].position", "outside the bounds", "walkable"],
        ),
        (
            goal("size = [4, 4]").replace("[\"g\"]", "[\"h\"]"),
            ["journeys[0].stages[0]", "\"h\"", "did you mean \"g\""],
        ),
        (
            goal("size = [4, 4]").replace("[\"g\"]", "[{ g = 0 }]"),
            ["journeys[0].stages[0]", "all 0", "above 0"],
        ),
        (goal("size = [4, 4]").replace("[\"g\"]", "[5]"), ["journeys", "name of a stage", "shares"]),
        (format!("{THROUGH}repeat = true\n{source}"), ["journeys[0].stages", "1 stages", "2 to 64"]),
        (
            format!("{}{source}", THROUGH.replace("[\"out\"]", "[\"out\", \"out\"]")),
            ["journeys[0].stages[0]", "exit", "last"],
        ),
        (format!("{THROUGH}{}", source.replace("rate = 1.0", "")), ["sources[0].rate", "none", "schedule"]),
        (format!("{THROUGH}{source}{source}"), ["sources[1].polygon", "overlaps sources[0]", "move"]),
        (
            format!("{THROUGH}{source}journeys = [\"trough\"]"),
            ["sources[0].journeys[0]", "trough", "through"],
        ),
        (
            format!("{THROUGH}{}", source.replace("-15", "-18.9")),
            ["sources[0].polygon", "walkable ground", "wider"],
        ),
        (THROUGH.to_owned(), ["journeys", "begun", "[[sources]]"]),
        (
            format!("{THROUGH}{source}[[spawns]]\npolygon = [[0, 0], [5, 0], [5, 5], [0, 5]]\n"),
            ["population.present", "none", "both"],
        ),
    ] {
        let message = refused(&text);
        for part in parts {
            assert!(message.contains(part), "{part:?} is missing in: {message}\n{text}");
        }
    }
}

#[test]
fn the_same_hall_gives_the_same_bits_on_both_backends() {
    let hall = scenario(
        150,
        &format!(
            "{THROUGH}[[stages]]\nname = \"mill\"\nkind = \"waiting\"\nposition = [0, 0]\nsize = [6, 12]\nwait = 4\n\
             [[journeys]]\nname = \"linger\"\nstages = [\"mill\", \"out\"]\n\
             [[sources]]\npolygon = [[-19, -8], [-15, -8], [-15, 8], [-19, 8]]\nrate = 5.0\n"
        ),
    );
    let run = |backend| {
        let made = Simulation::new(&hall, &fill(&hall), &library().1, backend, None);
        let mut simulation = gpu::on_device(made)?;
        simulation.step(30 * 40).unwrap();
        assert!(moment(&mut simulation).left > 10);
        Some(measure::state_hash(simulation.state().unwrap()))
    };
    if let Some(on_vulkan) = run(Backend::Vulkan) {
        assert_eq!(Some(on_vulkan), run(Backend::Cpu));
    }
}

/// Forty people come to one counter with room for ten.
fn counter(backend: Backend) -> Option<Simulation> {
    let mut hall = scenario(
        40,
        "[[stages]]\nname = \"till\"\nkind = \"queue\"\nposition = [8, 0]\nheading_deg = -90\nplaces = 10\nservice_time = 1.5\n\
         [[stages]]\nname = \"out\"\nkind = \"exit\"\nposition = [18, 6]\nsize = [3, 6]\n\
         [[journeys]]\nname = \"buy\"\nstages = [\"till\", \"out\"]\n\
         [[sources]]\npolygon = [[-19, -8], [-15, -8], [-15, 8], [-19, 8]]\nrate = 1.0\n",
    );
    // else the agent that was served does not get past the waiting ones
    hall.navigation.patience = 1.0;
    gpu::on_device(Simulation::new(&hall, &fill(&hall), &library().1, backend, None))
}

#[test]
fn a_queue_serves_in_the_order_of_arrival_one_for_each_service_time() {
    let mut simulation = counter(Backend::Cpu).unwrap();
    let (mut joined, mut served, mut longest, mut pressed) = (Vec::new(), Vec::new(), 0, 0);
    for step in 0..30 * 180 {
        simulation.step(1).unwrap();
        let now = moment(&mut simulation);
        // where all press to the end of the line, the agent ahead squeezes through at 0.8 of the radii
        assert!(now.min_clearance > -0.2 * 0.42, "step {step}: {now:?}");
        pressed += u32::from(now.overlapping_pairs > 0);
        let store = simulation.state().unwrap();
        for agent in 0..40_usize {
            if store.stage_progress[agent] > 0 && !joined.contains(&agent) {
                joined.push(agent);
                assert_eq!(store.stage_progress[agent] as usize, joined.len(), "tickets are given in order");
            }
            if store.route[agent].next > 0 && served.iter().all(|(other, _)| *other != agent) {
                served.push((agent, step));
            }
        }
        longest = longest.max(store.queues[2] - store.queues[1]);
    }
    // nine seeds have 0 to 16 such steps
    assert!(pressed <= 30, "who squeezes through is past in a second of three minutes: {pressed} steps");
    assert_eq!((joined.len(), longest), (40, 10), "the line was full and no agent was forgotten");
    assert_eq!(served.iter().map(|(agent, _)| *agent).collect::<Vec<_>>(), joined);
    for pair in served.windows(2) {
        let between = pair[1].1 - pair[0].1;
        assert!((45..45 + 120).contains(&between), "{between} steps between two who were served for 45");
    }
    let end = moment(&mut simulation);
    assert_eq!((end.left, end.present), (40, 0));
}

#[test]
fn a_queue_is_the_same_on_both_backends() {
    let run = |backend| {
        let mut simulation = counter(backend)?;
        simulation.step(30 * 60).unwrap();
        Some(measure::state_hash(simulation.state().unwrap()))
    };
    if let Some(on_vulkan) = run(Backend::Vulkan) {
        assert_eq!(Some(on_vulkan), run(Backend::Cpu));
    }
}

#[test]
fn what_is_wrong_with_a_queue_is_said() {
    let queue = |keys: &str, stages: &str| {
        format!(
            "[[stages]]\nname = \"q\"\nkind = \"queue\"\nposition = [0, 0]\n{keys}\n\
             [[stages]]\nname = \"g\"\nkind = \"goal\"\nposition = [9, 0]\nsize = [4, 4]\n\
             [[journeys]]\nname = \"j\"\nstages = {stages}\n\
             [[sources]]\npolygon = [[-19, -9], [-15, -9], [-15, -5], [-19, -5]]\nrate = 1.0\n"
        )
    };
    for (text, parts) in [
        (queue("places = 5", "[\"q\", \"g\"]"), ["stages[0].service_time", "none", "seconds"]),
        (queue("service_time = 1", "[\"q\", \"g\"]"), ["stages[0].places", "1 to 1000", "stand"]),
        (
            queue("service_time = 1\nplaces = 50", "[\"q\", \"g\"]"),
            ["stages[0].places", "outside the bounds", "fewer"],
        ),
        (
            queue("service_time = 1\nplaces = 5", "[\"q\"]"),
            ["journeys[0].stages[0]", "no queue as the last", "behind it"],
        ),
        (
            queue("service_time = 1\nplaces = 5\nwait = 3", "[\"q\", \"g\"]"),
            ["stages[0].wait", "left out", "waiting"],
        ),
    ] {
        let message = refused(&text);
        for part in parts {
            assert!(message.contains(part), "{part:?} is missing in: {message}\n{text}");
        }
    }
}

#[test]
fn the_station_of_the_assets_works_as_its_comments_say() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes/station.toml");
    let scenario = Scenario::load(&path).unwrap();
    let geometry = scenario.geometry();
    let mut simulation = simulation(&scenario, Backend::Cpu);
    let people = 0..scenario.population.agents as usize;
    let mut served = false;
    let mut most = 0;
    for second in 1..=75 {
        simulation.step(30).unwrap();
        let store = simulation.state().unwrap();
        let there: Vec<Vec2> =
            people.clone().filter(|i| present(store, *i)).map(|i| store.position[i].into()).collect();
        let inside = |at: &&Vec2| {
            gaitway::scenario::polygon::contains(&geometry.bounds, **at)
                && !geometry.obstacles.iter().any(|o| gaitway::scenario::polygon::contains(o, **at))
        };
        assert_eq!(there.iter().find(|at| !inside(at)), None, "second {second}");
        served |= there.iter().any(|at| at.distance(Vec2::new(5.0, 11.0)) < 0.3);
        most = most.max(there.len());
        // both trains bring their eighty within a few seconds
        assert!(second != 20 || there.len() > 80, "{}", there.len());
        assert!(second != 45 || there.len() < 170, "those of the first train have left: {}", there.len());
    }
    assert!(served, "no agent came to the counter");
    assert!(most > 130, "{most} at most");
    // the robot goes where its path says: 50, 30 at 40 s, half way back at 60 s
    let store = simulation.state().unwrap();
    let robot = store.position[scenario.population.agents as usize];
    assert!((robot[0] - 15.0).abs() < 0.5 && (robot[1] - 30.0).abs() < 0.01, "{robot:?}");
}
