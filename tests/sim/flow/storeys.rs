//! Ways over ramps, bridges and storeys: up to a goal above, along under it, from storey to storey, and what leads nowhere.

use super::simulation;
use crate::common::gpu;
use gaitway::kernels::Store;
use gaitway::scenario::Scenario;
use gaitway::sim::{Backend, measure};

/// A ramp along x from the ground to a deck 3 m high, and beside the deck a second ramp back to one at 6 m.
///
/// ```text
/// z  6 +-------+-----------------+
///      | 6 m   |  <- second ramp |     railings on the long sides
///    2 +-------+--+--------------+
///      ramp ->    | 3 m          |
///   -2 -----------+--------------+
///     -14 -12 -4 -2              8  x
/// ```
const STOREYS: [&str; 4] = [
    "polygon = [[-14, -2], [-4, -2], [-4, 2], [-14, 2]]\nheights = [0, 3, 3]\nrailings = [0, 2]",
    "polygon = [[-4, -2], [8, -2], [8, 2], [-4, 2]]\nheights = [3]\nrailings = [0, 1]",
    "polygon = [[8, 2], [8, 6], [-2, 6], [-2, 2]]\nheights = [3, 3, 6]\nrailings = [0, 1]",
    "polygon = [[-2, 2], [-2, 6], [-12, 6], [-12, 2]]\nheights = [6]\nrailings = [1, 2, 3]",
];

/// People in a hall with the first `count` of these floors.
fn hall(count: usize, agents: u32, rest: &str) -> Result<Scenario, String> {
    let floors: String = STOREYS[..count].iter().map(|floor| format!("[[floors]]\n{floor}\n")).collect();
    let text = format!(
        "name = \"hall\"\nbounds = [[-20, -10], [20, -10], [20, 10], [-20, 10]]\n[population]\nagents = {agents}\n\
         [navigation]\ncrowding = 0.0\n[way_finding]\nway = \"auto\"\n{floors}{rest}"
    );
    Scenario::parse(&text, "hall.toml").map_err(|error| error.to_string())
}

fn spawn(x: [f32; 2], z: [f32; 2], elevation: &str) -> String {
    let [[a, b], [c, d]] = [x, z];
    format!("[[spawns]]\npolygon = [[{a}, {c}], [{b}, {c}], [{b}, {d}], [{a}, {d}]]\n{elevation}\n")
}

fn stage(name: &str, kind: &str, at: [f32; 2], elevation: &str) -> String {
    format!(
        "[[stages]]\nname = \"{name}\"\nkind = \"{kind}\"\nposition = {at:?}\nsize = [2.4, 2.4]\n{elevation}\n"
    )
}

fn journey(stages: &str) -> String {
    format!("[[journeys]]\nname = \"go\"\nstages = [{stages}]\n")
}

/// Runs until all have come to the end of their way. Returns the time taken, s, and the greatest height of each, m.
fn arrive(scenario: &Scenario, most: f64) -> (f64, f32, Store) {
    let mut simulation = simulation(scenario, Backend::Cpu).unwrap();
    let mut highest = 0.0_f32;
    while simulation.time() < most {
        simulation.step(15).unwrap();
        let time = simulation.time();
        let store = simulation.state().unwrap();
        let here = store.elevation.iter().zip(&store.position).filter(|(_, at)| at[0] < 1e8);
        highest = here.map(|(elevation, _)| *elevation).fold(highest, f32::max);
        if store.route.iter().all(|route| route.arrivals > 0) {
            return (time, highest, store.clone());
        }
    }
    let store = simulation.state().unwrap();
    let late: Vec<String> = (store.position.iter().zip(&store.elevation).zip(&store.route))
        .filter(|(_, route)| route.arrivals == 0)
        .map(|((at, elevation), route)| {
            format!("{at:?} {elevation} m high on the way to stage {}", route.next)
        })
        .collect();
    panic!("after {most} s on their way: {}", late.join("; "));
}

#[test]
fn a_goal_on_a_bridge_is_reached_over_the_ramp_whose_foot_lies_behind() {
    // straight ahead lies the deck, 3 m above; the foot of the ramp is on the other side of it
    let text = spawn([11.0, 15.0], [-5.0, 5.0], "")
        + &stage("deck", "goal", [5.0, 0.0], "elevation = 3.0")
        + &journey("\"deck\"");
    let (time, _, store) = arrive(&hall(2, 8, &text).unwrap(), 90.0);
    println!("on the deck after {time} s");
    assert!(time > 25.0, "{time} s for a way of about 45 m");
    for (at, elevation) in store.position.iter().zip(&store.elevation) {
        assert!((elevation - 3.0).abs() < 1e-3 && (3.5..6.5).contains(&at[0]), "{at:?} {elevation}");
    }
}

#[test]
fn a_goal_below_is_reached_under_the_bridge_without_going_up() {
    let text = spawn([-3.0, 5.0], [4.0, 8.0], "")
        + &stage("behind", "goal", [1.0, -7.0], "elevation = 0.0")
        + &journey("\"behind\"");
    let (time, highest, _) = arrive(&hall(2, 8, &text).unwrap(), 30.0);
    println!("under the bridge in {time} s, at most {highest} m high");
    assert!(time < 20.0 && highest < 1e-3, "{time} s, {highest} m high");
    // nor does a goal on the deck count for agents below it
    let text = spawn([2.0, 4.0], [-8.0, -5.0], "")
        + &stage("deck", "goal", [3.0, 0.0], "elevation = 3.0")
        + &journey("\"deck\"");
    let (_, _, store) = arrive(&hall(2, 3, &text).unwrap(), 90.0);
    assert!(store.elevation.iter().all(|elevation| (elevation - 3.0).abs() < 1e-3), "{:?}", store.elevation);
}

/// Up to the second storey with a stop on the first, and from the second storey out.
fn up_and_down(agents: u32, keys: &str) -> Scenario {
    let text = spawn([11.0, 17.0], [-8.0, 8.0], "weight = 1\njourneys = [\"go\"]")
        + &spawn([-11.0, -3.0], [2.7, 5.3], "weight = 1\nelevation = 6.0\njourneys = [\"leave\"]")
        + &stage("first", "goal", [6.0, 0.0], "elevation = 3.0")
        + &stage("second", "goal", [-10.0, 4.0], "elevation = 6.0")
        + &stage("out", "exit", [17.0, 0.0], "")
        + &journey("\"first\", \"second\"")
        + "[[journeys]]\nname = \"leave\"\nstages = [\"out\"]\n";
    let mut scenario = hall(4, agents, &text).unwrap();
    if !keys.is_empty() {
        scenario.way_finding.density_weight = 0.7;
    }
    scenario
}

#[test]
fn people_walk_from_storey_to_storey_and_out() {
    let (time, highest, store) = arrive(&up_and_down(12, ""), 180.0);
    println!("all at the end of their way after {time} s");
    assert!((highest - 6.0).abs() < 1e-3, "{highest}");
    let here: Vec<f32> = (store.position.iter().zip(&store.elevation))
        .filter(|(at, _)| at[0] < 1e8)
        .map(|(_, elevation)| *elevation)
        .collect();
    assert!(!here.is_empty() && here.len() < 12, "some left: {here:?}");
    assert!(here.iter().all(|elevation| (elevation - 6.0).abs() < 1e-3), "{here:?}");
}

#[test]
fn ways_over_storeys_are_the_same_bits_on_both_backends() {
    let run = |backend| {
        let mut simulation = gpu::on_device(simulation(&up_and_down(40, "density"), backend))?;
        simulation.step(30 * 12).unwrap();
        Some(measure::state_hash(simulation.state().unwrap()))
    };
    let cpu = run(Backend::Cpu);
    if let Some(hash) = run(Backend::Vulkan) {
        assert_eq!(cpu, Some(hash));
    }
}

#[test]
fn a_storey_that_no_ramp_leads_to_is_an_error_that_says_so() {
    let up = spawn([11.0, 15.0], [-5.0, 5.0], "") + &journey("\"there\"");
    let refused = |count: usize, rest: String| {
        let scenario = match hall(count, 4, &rest) {
            Ok(scenario) => scenario,
            Err(said) => return said,
        };
        simulation(&scenario, Backend::Cpu).map(|_| ()).unwrap_err().to_string()
    };
    // the upper deck without its ramp: three floors, of which the third is the deck
    let deck = stage("there", "goal", [-8.0, 4.0], "elevation = 6.0");
    let lonely = format!("[[floors]]\n{}\n{up}{deck}", STOREYS[3]);
    let said = refused(2, lonely);
    for part in ["\"there\"", "(-8.00, 4.00) m (6.00 m high)", "cannot be reached", "no ramp"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    // an agent up there that is to come down
    let down = spawn([-11.0, -3.0], [2.7, 5.3], "elevation = 6.0") + &journey("\"there\"");
    let lonely = format!("[[floors]]\n{}\n{down}{}", STOREYS[3], stage("there", "exit", [15.0, 0.0], ""));
    let said = refused(2, lonely);
    assert!(said.contains("cannot be reached from (") && said.contains("6.00 m high"), "{said}");
    // a railing across the head of the ramp
    let closed = up
        + &stage("there", "goal", [5.0, 0.0], "elevation = 3.0")
        + "[[obstacles]]\npolygon = [[-4.1, -2], [-3.9, -2], [-3.9, 2], [-4.1, 2]]\nlow = 2.9\nhigh = 4.0\n";
    let said = refused(2, closed);
    assert!(said.contains("cannot be reached"), "{said}");
    // no floor at that height: with file and line
    let wrong = journey("\"there\"") + &stage("there", "goal", [5.0, 0.0], "elevation = 5.0");
    let said = refused(2, wrong);
    assert!(
        said.contains("hall.toml:")
            && said.contains("stages[0].elevation = 5")
            && said.contains("0.00, 3.00"),
        "{said}"
    );
}
