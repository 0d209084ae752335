//! Claims about turns to look at the user: a crowd never stares at once.

use gaitway::Emotion;
use gaitway::kernels::layout::{Appearance, Attention, Stance};
use gaitway::kernels::shared::attention::{ATTENDS, ENGAGED, VALID};
use gaitway::kernels::{KernelId, Store};
use gaitway::reference;
use gaitway::scenario::{Budget, Gaze, GazeMode, Scenario};
use gaitway::sim::{bodies, order};
use gaitway::verify::cases::animation::{animation, dispatches};

/// Milliseconds between pictures.
const PICTURE: u32 = 50;

/// Agents of an emotion on a spiral about the user, all facing the user, all drawn.
fn around(agents: u32, emotion: Emotion, gaze: &Gaze) -> Store {
    let mut store = animation(agents as usize, 0);
    let user = [store.frame.user_eyes[0], store.frame.user_eyes[2]];
    for i in 0..agents as usize {
        let away = 1.0 + 6.5 * (i as f32 + 0.5) / agents as f32;
        let angle = i as f32 * 2.4;
        store.position[i] = [user[0] + away * angle.sin(), user[1] + away * angle.cos()];
        store.heading[i] = angle + std::f32::consts::PI;
        store.stance[i] = Stance { phase: store.stance[i].phase, ..Stance::default() };
        store.appearance[i] = Appearance::new(0, emotion as u32, true, 1.0, [0; 4]);
        store.gaits[i] = [0; 4];
        store.gait_weights[i] = [1.0, 0.0, 0.0, 0.0];
        store.gaze_frame[i] = 0;
        store.attention[i] = Attention::default();
        store.elevation[i] = 0.0;
    }
    store.frame.planes = [[0.0, 0.0, 0.0, 1.0]; 12];
    store.frame.gaze_time = 0;
    bodies::set_gaze(&mut store.frame, gaze);
    store
}

fn budget(most: u32) -> Gaze {
    Gaze { budget: Some(Budget::Most(most)), ..Gaze::default() }
}

/// Draws the next frame and returns the agents that look at the user.
fn picture(store: &mut Store) -> Vec<usize> {
    store.frame.frame_index += 1;
    store.frame.gaze_time += PICTURE;
    store.frame.frame_time = PICTURE as f32 * 1e-3;
    let drawn = [KernelId::Palette, KernelId::Eyes, KernelId::Skin];
    for dispatch in dispatches(store).into_iter().filter(|dispatch| !drawn.contains(&dispatch.kernel())) {
        reference::run(dispatch.phase, store, dispatch.immediate);
    }
    let agents = store.frame.agent_count as usize;
    let now = store.frame.frame_index & 0x1fff_ffff;
    let looks = |i: &usize| {
        let word = store.gaze_frame[*i];
        word & VALID != 0 && word & ENGAGED != 0 && word & 0x1fff_ffff == now
    };
    (0..agents).filter(looks).collect()
}

#[test]
fn a_thousand_happy_people_never_stare_at_once() {
    for (mode, emotion) in [(GazeMode::Natural, Emotion::Happy), (GazeMode::Paper, Emotion::Angry)] {
        let mut store = around(1000, emotion, &Gaze { mode, ..budget(12) });
        let mut ever = vec![false; 1000];
        let mut full = 0;
        for _ in 0..400 {
            let looking = picture(&mut store);
            assert!(looking.len() <= 12, "{} look at once", looking.len());
            full += u32::from(looking.len() >= 11);
            for agent in looking {
                ever[agent] = true;
            }
        }
        assert!(full > 350, "the budget is used in {full} of 400 pictures");
        assert!(ever.iter().filter(|e| **e).count() > 60, "they take turns");
    }
}

#[test]
fn everyone_gets_a_turn_of_one_to_four_seconds_and_then_rests() {
    let mut store = around(50, Emotion::Happy, &budget(5));
    let mut since = [0_u32; 50]; // pictures in a row
    let mut last = [0_u32; 50];
    let mut turns = [0_u32; 50];
    let (mut shortest, mut longest, mut worst_wait) = (u32::MAX, 0, 0);
    for number in 1..=3000 {
        let looking = picture(&mut store);
        assert!(looking.len() <= 5);
        for agent in 0..50 {
            if looking.contains(&agent) {
                if since[agent] == 0 {
                    worst_wait = worst_wait.max(number - last[agent]);
                    turns[agent] += 1;
                }
                since[agent] += 1;
                last[agent] = number;
            } else if since[agent] > 0 {
                shortest = shortest.min(since[agent]);
                longest = longest.max(since[agent]);
                since[agent] = 0;
            }
        }
    }
    let seconds = |pictures: u32| pictures * PICTURE;
    assert!(turns.iter().all(|t| *t >= 2), "{turns:?}");
    assert!(seconds(longest) <= 4000 && seconds(shortest) >= 950, "{shortest} to {longest} pictures");
    // ten groups of five, four seconds each at most, and a factor of two for near agents
    assert!(seconds(worst_wait) < 80_000, "an agent waited {} ms", seconds(worst_wait));
    println!(
        "turns of {} to {} ms, longest wait {} ms",
        seconds(shortest),
        seconds(longest),
        seconds(worst_wait)
    );
}

#[test]
fn no_agent_looks_with_a_budget_of_none_and_sad_heads_hang_whatever_the_budget() {
    let mut store = around(100, Emotion::Angry, &budget(0));
    assert_eq!(picture(&mut store), Vec::<usize>::new());
    let with = |gaze: &Gaze| {
        let mut store = around(100, Emotion::Sad, gaze);
        let _ = picture(&mut store);
        store.local_rotations
    };
    assert_eq!(bits(&with(&budget(0))), bits(&with(&Gaze { budget: Some(Budget::All), ..Gaze::default() })));
}

fn bits(rotations: &[[f32; 4]]) -> Vec<[u32; 4]> {
    rotations.iter().map(|q| q.map(f32::to_bits)).collect()
}

#[test]
fn a_budget_of_all_or_of_enough_changes_nothing() {
    for mode in [GazeMode::Natural, GazeMode::Paper] {
        let film = |budget| {
            let mut store =
                around(40, Emotion::Happy, &Gaze { mode, budget: Some(budget), ..Gaze::default() });
            let mut shots = Vec::new();
            for _ in 0..10 {
                let _ = picture(&mut store);
                shots.push((bits(&store.local_rotations), store.gaze_frame.clone()));
            }
            (shots, order::has_turns(&store.frame))
        };
        let (all, enough, fewer) = (film(Budget::All), film(Budget::Most(40)), film(Budget::Most(39)));
        assert!(all == enough && !all.1, "{mode:?}");
        assert!(all.0 != fewer.0 && fewer.1, "{mode:?}");
    }
    let paper = Gaze { mode: GazeMode::Paper, ..Gaze::default() };
    assert_eq!(paper.effective_budget(), Budget::All, "the paper has no budget");
    for name in Scenario::builtin_names() {
        let scene = Scenario::builtin(name).unwrap_or_else(|error| panic!("{error}"));
        assert!(scene.gaze.effective_budget() == Budget::Most(12) && scene.population.agents <= 12, "{name}");
    }
}

#[test]
fn fewer_turns_from_now_on_are_kept_at_once_and_a_turn_ends_when_the_user_is_out_of_view() {
    let mut store = around(60, Emotion::Happy, &budget(10));
    for _ in 0..10 {
        assert!(picture(&mut store).len() <= 10);
    }
    bodies::set_gaze(&mut store.frame, &budget(3));
    for _ in 0..10 {
        assert!(picture(&mut store).len() <= 3);
    }
    let looking = picture(&mut store);
    assert!(!looking.is_empty());
    for agent in &looking {
        store.heading[*agent] += std::f32::consts::PI; // turns its back
    }
    let others = picture(&mut store);
    assert!(looking.iter().all(|agent| !others.contains(agent)));
    assert!(looking.iter().all(|agent| store.gaze_frame[*agent] & ATTENDS == 0));
}

#[test]
fn budgets_are_read_and_wrong_ones_refused() {
    let scene = |gaze: &str| {
        let text = format!(
            "name = \"x\"\nbounds = [[0, 0], [9, 0], [9, 9], [0, 9]]\n[population]\nagents = 0\n[gaze]\n{gaze}\n"
        );
        Scenario::parse(&text, "x.toml").and_then(|scene| scene.validate().map(|()| scene.gaze))
    };
    let gaze = scene("budget = \"all\"").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(gaze.budget, Some(Budget::All));
    let gaze = scene("budget = 5\nturn = [2, 3]").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((gaze.budget, gaze.turn), (Some(Budget::Most(5)), [2.0, 3.0]));
    for (text, word) in [
        ("budget = -1", "number of agents"),
        ("budget = \"some\"", "number of agents"),
        ("budget = 2000000", "gaze.budget"),
        ("turn = [3, 2]", "gaze.turn"),
        ("turn = [nan, 2]", "gaze.turn"),
    ] {
        let error = scene(text).map(|_| ()).expect_err(text).to_string();
        assert!(error.contains(word), "{text}: {error}");
    }
}
