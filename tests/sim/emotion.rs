//! Claims about feelings that change: contagion, events, decay, and what people show of it.

use crate::common::gpu;
use gaitway::kernels::layout::{Appearance, Body, Heard, MoodUniforms, Paces, Temperament};
use gaitway::kernels::{KernelId, Store};
use gaitway::scenario::{Scenario, populate_from};
use gaitway::sim::{AvatarSet, Backend, Simulation, measure, order};
use gaitway::verify::cases::crossing::crossing;
use gaitway::verify::cases::feelings::feelings;
use gaitway::{avatar, library};

const NEUTRAL: [f32; 4] = [0.0, 0.0, 0.0, 1.0];
const ANGRY: [f32; 4] = [0.0, 1.0, 0.0, 0.0];
const DT: f32 = 1.0 / 30.0;

/// Standing people with emotions, own states and characters (expressiveness, openness, amplification, bias).
fn standing(
    agents: usize,
    mood: MoodUniforms,
    of: impl Fn(usize) -> ([f32; 4], [f32; 4], [f32; 4]),
) -> Store {
    let mut store = crossing(agents, 1.0);
    store.step.wrap = 0.0;
    for body in &mut store.body {
        body.preferred_speed = 0.0;
    }
    store.velocity.fill([0.0; 2]);
    store.step.feels = 1;
    store.mood = mood;
    for agent in 0..agents {
        let (feeling, own, character) = of(agent);
        store.feeling.push(feeling);
        let [expressiveness, openness, amplification, bias] = character;
        store.temperament.push(Temperament { rest: own, expressiveness, openness, amplification, bias });
        store.paces.push(Paces::default());
        store.appearance.push(Appearance::new(0, 3, false, 1.0, [0; 4]));
        store.gait_weights.push(feeling);
    }
    store.heard = vec![Heard::default(); agents];
    store
}

fn run(store: Store, steps: u32) -> Store {
    let mut simulation = Simulation::from_store(store, Backend::Cpu, None).unwrap();
    simulation.step(steps).unwrap();
    simulation.state().unwrap().clone()
}

fn bits(feelings: &[[f32; 4]]) -> Vec<[u32; 4]> {
    feelings.iter().map(|q| q.map(f32::to_bits)).collect()
}

fn contagion(radius: f32) -> MoodUniforms {
    MoodUniforms { radius, contagion: 0.5, decay: 0.0, event_count: 0 }
}

#[test]
fn one_scared_among_a_hundred_calm_people_spreads_it_steadily() {
    let store = standing(100, contagion(3.0), |i| match i {
        42 => (ANGRY, ANGRY, [1.0, 0.0, 0.0, 0.5]),
        _ => (NEUTRAL, NEUTRAL, [0.8, 0.8, 0.0, 0.5]),
    });
    let mut simulation = Simulation::from_store(store, Backend::Cpu, None).unwrap();
    let mut before = vec![0.0; 100];
    for _ in 0..60 {
        simulation.step(30).unwrap();
        let angry: Vec<f32> = simulation.state().unwrap().feeling.iter().map(|q| q[1]).collect();
        assert!(angry.iter().zip(&before).all(|(now, then)| *now >= then - 1e-6), "an agent calmed down");
        before = angry;
    }
    let mean = before.iter().sum::<f32>() / 100.0;
    println!("after a minute {mean} on average, least {:?}", before.iter().copied().reduce(f32::min));
    assert!(mean > 0.3 && before.iter().all(|q| *q > 0.05));
}

#[test]
fn nothing_moves_the_closed_and_what_is_not_shown_is_not_caught() {
    let start = |i: usize| if i.is_multiple_of(3) { ANGRY } else { NEUTRAL };
    for character in [[1.0, 0.0, 1.0, 1.0], [0.0, 1.0, 1.0, 1.0]] {
        let store = standing(50, contagion(4.0), |i| (start(i), start(i), character));
        let first = bits(&store.feeling);
        assert_eq!(bits(&run(store, 200).feeling), first);
    }
}

#[test]
fn a_feeling_halves_in_its_half_life() {
    let mood = MoodUniforms { decay: 0.1, ..contagion(0.0) };
    let half_life = (std::f32::consts::LN_2 / 0.1 / DT).round() as u32;
    let store = run(standing(3, mood, |_| (ANGRY, NEUTRAL, [1.0, 1.0, 0.0, 0.5])), half_life);
    for q in &store.feeling {
        assert!((q[1] - 0.5).abs() < 1e-3 && (q[3] - 0.5).abs() < 1e-3, "{q:?}");
    }
}

#[test]
fn one_step_of_two_people_is_the_equation() {
    let (eta, beta) = (0.4_f64, 0.7_f64);
    let start = [[0.2, 0.5, 0.1, 0.2], [0.6, 0.1, 0.0, 0.3]];
    let mut store =
        standing(2, contagion(3.0), |i| (start[i], start[i], [0.9, 0.6, eta as f32, beta as f32]));
    store.position = vec![[1.0, 1.0], [2.0, 1.0]]; // alpha = 1 - 1 / 3
    let found = run(store, 1).feeling;
    for (who, other) in [(0, 1), (1, 0)] {
        let gamma = 0.9 * (2.0 / 3.0) * 0.6;
        let take = 1.0 - (-0.5 * gamma * f64::from(DT)).exp();
        let mut want = [0.0; 4];
        for e in 0..3 {
            let (q, heard) = (f64::from(start[who][e]), f64::from(start[other][e]));
            let rising = 1.0 - (1.0 - heard) * (1.0 - q);
            let goal = eta * (beta * rising + (1.0 - beta) * heard * q) + (1.0 - eta) * heard;
            want[e] = q + take * (goal - q);
        }
        want[3] = 1.0 - want[0] - want[1] - want[2];
        for e in 0..4 {
            assert!((f64::from(found[who][e]) - want[e]).abs() < 2e-6, "{:?} {want:?}", found[who]);
        }
    }
}

#[test]
fn whom_one_hears_is_less_than_eight_steps_old_and_the_first_step_hears_all() {
    // one walks past a row of angry people, to and fro over the rows of cells
    let mut store = standing(20, contagion(3.0), |i| {
        if i == 0 { (NEUTRAL, NEUTRAL, [0.0, 1.0, 0.0, 0.5]) } else { (ANGRY, ANGRY, [1.0, 0.0, 0.0, 0.5]) }
    });
    for i in 1..20 {
        store.position[i] = [2.0, i as f32];
    }
    store.position[0] = [3.5, 1.0];
    let mut simulation = Simulation::from_store(store, Backend::Cpu, None).unwrap();
    let voices = |store: &Store| -> f32 {
        let [x, z] = store.position[0];
        let distance = |i: usize| (store.position[i][0] - x).hypot(store.position[i][1] - z);
        (1..20).map(|i| (1.0 - distance(i) / 3.0).max(0.0)).sum()
    };
    let mut lately = Vec::new();
    for step in 0..200 {
        let mut moved = simulation.state().unwrap().clone();
        moved.position[0][1] = 1.0 + 17.0 * (step as f32 / 200.0);
        lately.push(voices(&moved));
        simulation = Simulation::from_store(moved, Backend::Cpu, None).unwrap();
        simulation.step(1).unwrap();
        let heard = simulation.state().unwrap().heard[0];
        let age = lately.iter().rev().position(|voices| (voices - heard.strength).abs() < 1e-5);
        assert!(age.is_some_and(|age| age < 8), "step {step}: {heard:?}, lately {lately:?}");
        assert!(step > 0 || age == Some(0));
        assert_eq!([heard.angry, heard.sad], [1.0, 0.0]);
    }
}

#[test]
fn weights_stay_weights_for_ten_thousand_steps() {
    let mut simulation = Simulation::from_store(feelings(40, 2), Backend::Cpu, None).unwrap();
    for _ in 0..100 {
        simulation.step(100).unwrap();
        let store = simulation.state().unwrap();
        for q in &store.feeling[..40] {
            let sum: f32 = q.iter().sum();
            assert!(q.iter().all(|w| (0.0..=1.0).contains(w)) && (sum - 1.0).abs() < 1e-5, "{q:?}");
        }
    }
}

#[test]
fn the_order_of_people_does_not_matter_to_the_last_bit() {
    let of = |i: usize| {
        let mixed = [0.1 + 0.03 * (i % 7) as f32, 0.02 * (i % 11) as f32, 0.05 * (i % 3) as f32];
        let q = [mixed[0], mixed[1], mixed[2], 1.0 - mixed.iter().sum::<f32>()];
        (q, NEUTRAL, [0.3 + 0.05 * (i % 13) as f32, 0.5 + 0.03 * (i % 5) as f32, 0.2, 0.6])
    };
    let agents = 200;
    let swapped = |i: usize| (i * 77 + 5) % agents; // a permutation: 77 and 200 have no common factor
    let first = standing(agents, contagion(4.0), of);
    let mut second = standing(agents, contagion(4.0), |i| of(swapped(i)));
    second.position = (0..agents).map(|i| first.position[swapped(i)]).collect();
    let (first, second) = (run(first, 100), run(second, 100));
    let permuted: Vec<_> = (0..agents).map(|i| first.feeling[swapped(i)]).collect();
    assert_eq!(bits(&permuted), bits(&second.feeling));
}

#[test]
fn people_out_of_reach_feel_nothing_of_each_other() {
    let build = |angry: bool| {
        let mut store = standing(60, contagion(3.0), |i| {
            let q = if i == 0 && angry { ANGRY } else { [0.1, 0.0, 0.3, 0.6] };
            (q, NEUTRAL, [0.9, 0.9, 0.0, 0.5])
        });
        for (i, position) in store.position.iter_mut().enumerate() {
            *position = [(i % 10) as f32 * 0.7, (i / 10 % 3) as f32 * 0.7 + if i < 30 { 0.0 } else { 4.5 }];
        }
        run(store, 300).feeling
    };
    let (with, without) = (build(true), build(false));
    assert_eq!(bits(&with[30..]), bits(&without[30..]), "3.1 m apart");
    assert!(with[1..30].iter().zip(&without[1..30]).all(|(a, b)| a[1] > b[1]));
}

#[test]
fn both_backends_feel_the_same_bits() {
    let mut hashes = Vec::new();
    for backend in [Backend::Cpu, Backend::Vulkan] {
        let made = Simulation::from_store(feelings(700, 1), backend, None);
        let Some(mut simulation) = gpu::on_device(made) else { continue };
        simulation.step(90).unwrap();
        hashes.push(measure::state_hash(simulation.state().unwrap()));
    }
    assert!(hashes.windows(2).all(|pair| pair[0] == pair[1]), "{hashes:?}");
}

const PLACE: &str = "name = \"place\"\nbounds = [[0, 0], [30, 0], [30, 30], [0, 30]]\n\
    [[routes]]\nname = \"a\"\nwaypoints = [[2, 15], [28, 15]]\nwidth = 16\n";

fn simulation(text: &str) -> Simulation {
    let scenario = Scenario::parse(&format!("{PLACE}{text}"), "place").unwrap();
    let library = library::GaitLibrary::built_in().unwrap();
    let crowd = populate_from(&scenario, &library).unwrap();
    let cast = AvatarSet::new(library.gaits(), vec![avatar::generated(avatar::Sex::ALL[0])]).unwrap();
    Simulation::new(&scenario, &crowd, &cast, Backend::Cpu, None).unwrap()
}

#[test]
fn gait_speed_and_gaze_follow_the_feeling_smoothly_and_feet_do_not_slide() {
    let mut simulation = simulation(
        "[population]\nagents = 40\nemotions = { sad = 1 }\navatars = [\"female\"]\n[emotion_dynamics]\ndecay = 0.2\n\
         [[events]]\ntime = 1\nduration = 3\nplace = [15, 15]\nradius = 60\nemotion = \"angry\"\nstrength = 1\n",
    );
    let start = simulation.state().unwrap().clone();
    let mut shown = vec![2; 40];
    let mut changes = [0; 40];
    let mut before = start.clone();
    for step in 0..900 {
        simulation.step(1).unwrap();
        let store = simulation.state().unwrap();
        for i in 0..40 {
            assert_eq!(bits(&[store.gait_weights[i]]), bits(&[store.feeling[i]]));
            // at most a fifteenth of the way by the event and a little by the others; a switch would be all of it
            let speeds = store.paces[i].preferred_speeds;
            let span = speeds.iter().fold(0.0_f32, |span, speed| span.max((speed - speeds[2]).abs()));
            let change = (store.body[i].preferred_speed - before.body[i].preferred_speed).abs();
            assert!(change <= 0.1 * span + 1e-4, "step {step}: {change} m/s of {span}");
            let emotion = store.appearance[i].emotion();
            changes[i] += u32::from(emotion != shown[i]);
            shown[i] = emotion;
            let moved = f32::hypot(store.velocity[i][0], store.velocity[i][1]) * DT;
            let strides = store.stance[i].phase.wrapping_sub(before.stance[i].phase) as f32 / u32::MAX as f32;
            assert!((strides * store.stance[i].stride - moved).abs() < 1e-4, "step {step}: the feet slide");
            let ratios = store.paces[i].walk_ratios.iter().zip(store.feeling[i]);
            let blended: f32 = ratios.map(|(ratio, weight)| ratio * weight).sum();
            assert!(
                (store.body[i].walk_ratio - blended).abs() < 1e-5,
                "step {step}: not the walk ratio of what it feels"
            );
        }
        if step == 115 {
            let mean = measure::mean_feeling(store).unwrap();
            assert!(mean[1] > 0.6, "{mean:?}");
            let faster = (0..40)
                .filter(|i| store.body[*i].preferred_speed > start.body[*i].preferred_speed + 0.05)
                .count();
            assert!(faster > 30, "{faster} of 40 walk faster");
            assert!(store.body.iter().all(|body| body.max_speed >= body.preferred_speed));
            assert!(shown.iter().all(|emotion| *emotion == 1), "{shown:?}");
        }
        before = store.clone();
    }
    assert!(changes.iter().all(|count| *count == 2), "to angry and back, no flicker: {changes:?}");
    for i in 0..40 {
        assert!(
            (before.body[i].preferred_speed - start.body[i].preferred_speed).abs() < 0.1,
            "back to its own speed"
        );
    }
}

#[test]
fn without_the_table_no_pass_is_recorded_and_the_start_is_the_same_with_it() {
    let crowd = "[population]\nagents = 50\n";
    let (without, with) = (simulation(crowd), simulation(&format!("{crowd}[emotion_dynamics]\n")));
    let feels = |s: &Simulation| {
        order::step_dispatches(&s.store().step).iter().any(|p| p.kernel() == KernelId::EmotionUpdate)
    };
    assert!(!feels(&without) && feels(&with));
    assert!(without.store().feeling.is_empty() && measure::mean_feeling(without.store()).is_none());
    assert_eq!(without.store().position, with.store().position);
    let numbers = |body: &Body| [body.radius, body.max_speed, body.preferred_speed, body.walk_ratio];
    for (a, b) in without.store().body.iter().zip(&with.store().body) {
        assert!(numbers(a).iter().zip(numbers(b)).all(|(a, b)| (a - b).abs() < 1e-5), "{a:?} {b:?}");
    }
}

#[test]
fn tables_are_read_and_wrong_ones_refused() {
    let check =
        |text: &str| Scenario::parse(&format!("{PLACE}{text}"), "x").and_then(|s| s.validate().map(|()| s));
    let scene = check("[emotion_dynamics]\nopenness = 0.5\nbias = [0.2, 0.8]\n").unwrap();
    let dynamics = scene.emotion_dynamics.unwrap();
    assert_eq!((dynamics.openness, dynamics.bias), ([0.5; 2], [0.2, 0.8]));
    let traits: Vec<_> = (0..50).map(|agent| dynamics.character(1, agent)).collect();
    assert!(traits.iter().all(|t| t[1] == 0.5 && (0.2..0.8).contains(&t[3])));
    assert!(traits.iter().any(|t| t[3] < 0.4) && traits.iter().any(|t| t[3] > 0.6));
    let again = Scenario::parse(&scene.to_toml().unwrap(), "again").unwrap();
    assert_eq!(again, scene);
    let event =
        "[[events]]\ntime = 1\nduration = 2\nplace = [1, 1]\nradius = 5\nemotion = \"angry\"\nstrength = ";
    for (text, word) in [
        ("[emotion_dynamics]\nopenness = 1.5\n".to_owned(), "emotion_dynamics.openness"),
        ("[emotion_dynamics]\nradius = nan\n".to_owned(), "emotion_dynamics.radius"),
        ("[emotion_dynamics]\ndecay = -1\n".to_owned(), "emotion_dynamics.decay"),
        (format!("{event}1\n"), "emotion_dynamics"),
        (format!("[emotion_dynamics]\n{event}2\n"), "events[0].strength"),
        (format!("[emotion_dynamics]\n{event}1\nloudness = 3\n"), "loudness"),
    ] {
        let error = check(&text).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(word), "{text}: {error}");
    }
}
