//! Simulated participants: balance under drop-outs, and what was put in comes out.

use gaitway::emotion::Emotion;
use gaitway::study::plan::{Ending, Plan, Role, Stimulus};
use gaitway::study::protocol::{Event, Session, State, page};
use gaitway::study::simulate::{
    Habits, LinearModel, Minds, PAPER_CONFUSION, RatingModel, Run, Setup, Store, hazard, mean_ratings, run,
};
use gaitway::study::{Materials, Study};
use std::collections::{BTreeMap, BTreeSet};

/// Pages at which a participant of `eva-gaits` may leave: 12 trials, remarks, debrief.
const PAGES: u32 = 14;

/// Most that arrive.
const MOST: u32 = 800;

fn dropping(share: f64) -> Habits {
    Habits { leaving: hazard(share, PAGES), ..Habits::default() }
}

fn label(mean: [f64; 4], theta: f64) -> Option<Emotion> {
    let highest = mean.into_iter().fold(f64::NEG_INFINITY, f64::max);
    Emotion::ALL.into_iter().find(|emotion| mean[emotion.index()] == highest).filter(|_| highest > theta)
}

/// Fewest and most answers, and gap of the counts, of the walks.
fn balance(run: &Run) -> (u32, u32, u32) {
    let (fewest, most) = run.answered["walks"];
    let counts = &run.counts.iter().find(|counts| counts.part == "walks").unwrap().counts;
    (fewest, most, counts.iter().max().unwrap() - counts.iter().min().unwrap())
}

fn walk_study(habits: Habits, at_once: u32, seed: u64) -> (Plan, Run) {
    let plan = super::plan("eva-gaits", 342);
    let minds = Minds { ratings: RatingModel::drawn(&super::walks(342), 5), ..Minds::default() };
    let setup = Setup { participants: MOST, at_once, habits, seed };
    let (_, run) = run(&plan, &minds, setup).unwrap();
    (plan, run)
}

#[test]
fn five_hundred_participants_of_whom_a_third_leave_fill_every_walk() {
    let (_, run) = walk_study(dropping(0.3), 100, 1);
    let (fewest, most, gap) = balance(&run);
    let left = run.participants.iter().filter(|one| one.state == State::Lapsed).count();
    println!("{} placed, {left} left, answers {fewest} to {most}, gap {gap}", run.placed);
    assert!((0.2..0.4).contains(&(left as f64 / run.placed as f64)), "{left}");
    assert!(run.participants.len() <= 500 && run.turned_away == 0);
    assert!(fewest >= 10);
    assert!(gap <= 1, "{gap}");
    assert!(run.placed <= 440, "{}", run.placed);
}

#[test]
#[ignore = "long: the figures of the documentation"]
fn figures() {
    for (share, at_once) in [(0.0, 100), (0.3, 60), (0.3, 100)] {
        let mut placed = Vec::new();
        let mut gaps = Vec::new();
        for seed in 0..20 {
            let (_, run) = walk_study(dropping(share), at_once, seed);
            let (fewest, _, gap) = balance(&run);
            assert!(fewest >= 10);
            placed.push(run.placed);
            gaps.push(gap);
        }
        placed.sort_unstable();
        gaps.sort_unstable();
        println!("{share} {at_once}: placed {placed:?} gaps {gaps:?}");
    }
}

/// Labels that were put in and are right in the answers, of all at a margin of 0.5 or more. The margin is that of the true mean
/// ratings, or else that of the answers; it is against theta and the other emotions.
fn recovered(run: &Run, model: &RatingModel, by_truth: bool) -> (u32, u32) {
    let found = mean_ratings(&run.answers, "walks", "emotions");
    assert_eq!(found.len(), 342);
    let (mut right, mut all) = (0, 0);
    for (gait, (mean, raters)) in &found {
        assert!(*raters >= 10);
        let truth = model.expected(gait, 4000, 1);
        let (known, seen) = (label(truth, 3.5), label(*mean, 3.5));
        let (judged, of) = if by_truth { (known, truth) } else { (seen, *mean) };
        let margin = |own: Emotion| {
            let others = Emotion::ALL.into_iter().filter(|other| *other != own);
            of[own.index()] - others.map(|other| of[other.index()]).fold(3.5, f64::max)
        };
        if judged.is_some_and(|own| margin(own) >= 0.5) {
            all += 1;
            right += u32::from(known == seen);
        }
    }
    (right, all)
}

#[test]
fn known_labels_are_recovered() {
    let (_, run) = walk_study(dropping(0.3), 100, 2);
    let model = RatingModel::drawn(&super::walks(342), 5);
    for by_truth in [true, false] {
        let (right, all) = recovered(&run, &model, by_truth);
        println!("{right} of {all}");
        assert!(all > 100 && f64::from(right) >= 0.97 * f64::from(all), "{right} of {all}");
    }
}

#[test]
#[ignore = "long: the figures of the documentation"]
fn figures_of_recovery() {
    for noise in [0.7, 1.0, 1.3] {
        for by_truth in [true, false] {
            let mut sums = (0, 0);
            for seed in 0..10 {
                let plan = super::plan("eva-gaits", 342);
                let mut model = RatingModel::drawn(&super::walks(342), 100 + seed);
                model.noise = noise;
                let minds = Minds { ratings: model.clone(), ..Minds::default() };
                let setup = Setup { participants: MOST, at_once: 100, habits: dropping(0.3), seed };
                let (_, run) = run(&plan, &minds, setup).unwrap();
                let (right, all) = recovered(&run, &model, by_truth);
                sums = (sums.0 + right, sums.1 + all);
            }
            let share = 100.0 * f64::from(sums.0) / f64::from(sums.1);
            println!("noise {noise}, margin of truth {by_truth}: {sums:?} {share:.1} %");
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_study_and_another_one_another() {
    let habits =
        Habits { careless: 0.1, withdrawing: 0.2, returning: 0.3, leaving_early: 0.02, ..dropping(0.3) };
    let (_, first) = walk_study(habits, 20, 3);
    assert_eq!(first, walk_study(habits, 20, 3).1);
    assert_ne!(first.answers, walk_study(habits, 20, 4).1.answers);
}

#[test]
fn with_withdrawals_and_late_returns_every_walk_still_gets_its_answers() {
    for (seed, at_once) in [(1, 100), (2, 20), (3, 5)] {
        let habits =
            Habits { careless: 0.1, withdrawing: 0.2, returning: 0.4, leaving_early: 0.02, ..dropping(0.3) };
        let (_, run) = walk_study(habits, at_once, seed);
        let (fewest, most, gap) = balance(&run);
        println!(
            "{} arrived, {} placed, answers {fewest} to {most}, gap {gap}",
            run.participants.len(),
            run.placed
        );
        assert!(fewest >= 10);
        assert!(gap <= 2 && run.placed <= 470, "{} {gap}", run.placed);
        let ended = |ending| run.participants.iter().filter(|one| one.state == State::Ended(ending)).count();
        assert!(ended(Ending::Withdrawn) > 3 && ended(Ending::ScreenedOut) > 3);
        // what the ledger counts is what the tables hold
        let found = mean_ratings(&run.answers, "walks", "emotions");
        assert_eq!(found.values().map(|(_, raters)| *raters as u32).min(), Some(fewest));
        assert_eq!(
            found.values().map(|(_, raters)| *raters as u32).max(),
            Some(most),
            "repeats are no answers"
        );
    }
}

#[test]
fn sessions_and_ledger_are_rebuilt_from_events_whatever_the_order_of_participants() {
    let plan = super::plan("eva-gaits", 60);
    let habits = Habits { withdrawing: 0.2, returning: 0.5, ..dropping(0.4) };
    let setup = Setup { participants: 90, at_once: 30, habits, seed: 9 };
    let (store, _) = run(&plan, &Minds::default(), setup).unwrap();
    let logs: Vec<_> = store.logs().map(|(person, entries)| (person, entries.to_vec())).collect();
    let kinds = |is: fn(&Event) -> bool| {
        logs.iter().flat_map(|(_, log)| log).filter(|entry| is(&entry.event)).count()
    };
    assert!(kinds(|event| matches!(event, Event::Returned { .. })) > 5);
    assert!(kinds(|event| matches!(event, Event::Returned { swaps } if !swaps.is_empty())) > 0);
    assert!(kinds(|event| matches!(event, Event::Withdrawn)) > 2);
    let backwards = Store::rebuilt(&plan, logs.iter().rev().cloned());
    let forwards = Store::rebuilt(&plan, logs.iter().cloned());
    for rebuilt in [&backwards, &forwards] {
        assert_eq!(rebuilt.ledger().counts(), store.ledger().counts());
        assert_eq!(rebuilt.ledger().answered("walks"), store.ledger().answered("walks"));
        assert_eq!(rebuilt.ledger().participants(), store.ledger().participants());
    }
    for (person, log) in &logs {
        let session = store.session(*person).unwrap();
        assert_eq!(&Session::replay(&plan, log), session);
        assert_eq!(page(&plan, log), session.page(&plan));
    }
}

#[test]
fn careless_participants_fail_instructed_trials_and_careful_ones_do_not() {
    let habits = Habits { careless: 0.3, ..Habits::default() };
    let (_, run) = walk_study(habits, 50, 6);
    let careless: BTreeSet<u64> =
        run.participants.iter().filter(|one| one.is_careless).map(|one| one.number).collect();
    let mut failed = BTreeSet::new();
    for row in &run.answers {
        if let Some(Role::Catch { answer }) = row.trial.as_ref().map(|trial| trial.role)
            && row.value != Some(answer)
        {
            failed.insert(row.participant);
        }
    }
    assert!(failed.is_subset(&careless));
    let placed = run.participants.iter().filter(|one| one.is_careless && one.was_placed).count();
    // four answers of five at random are all right once in 625 times
    assert!(failed.len() + 2 >= placed && placed > 10, "{} of {placed}", failed.len());
}

/// Means by a key of all counted answers about scenes.
fn means<K: Ord>(run: &Run, key: impl Fn(&str, &str, u32) -> K) -> BTreeMap<K, f64> {
    let mut sums: BTreeMap<K, (f64, f64)> = BTreeMap::new();
    for row in &run.answers {
        let (Some(trial), Some(Stimulus::Scene { scene, condition }), Some(value)) =
            (&row.trial, &row.stimulus, row.value)
        else {
            continue;
        };
        if row.question.starts_with("presence.") {
            let sum = sums.entry(key(scene, condition, trial.position)).or_default();
            *sum = (sum.0 + value as f64, sum.1 + 1.0);
        }
    }
    sums.into_iter().map(|(key, (sum, count))| (key, sum / count)).collect()
}

#[test]
fn effects_and_confusions_that_were_put_in_come_out_of_the_agents_study() {
    let mut plan = super::plan("eva-agents", 0);
    plan.most_participants = 480;
    let named = |pairs: &[(&str, f64)]| pairs.iter().map(|&(name, value)| (name.to_owned(), value)).collect();
    let scenes = LinearModel {
        scenes: named(&[("crossing", 4.2), ("garden", 3.8), ("parking", 4.0), ("scifi", 4.0)]),
        conditions: named(&[("baseline", -0.6), ("eva-o", 0.0), ("eva-g", 0.6)]),
        person_deviation: 0.5,
        trend: 0.02,
        noise: 0.8,
    };
    let minds = Minds { scenes, ..Minds::default() };
    let setup = Setup { participants: 600, at_once: 60, habits: Habits::default(), seed: 1 };
    let (_, run) = run(&plan, &minds, setup).unwrap();
    assert_eq!(run.placed, 480);
    assert!(run.counts[0].counts.iter().all(|&count| count == 20), "480 are 20 times 24 rows");
    assert!(run.counts[1].counts.iter().all(|&count| count == 60), "and 60 times 8");
    let by_condition = means(&run, |_, condition, _| condition.to_owned());
    for (low, high, effect) in
        [("baseline", "eva-o", 0.6), ("eva-o", "eva-g", 0.6), ("baseline", "eva-g", 1.2)]
    {
        let found = by_condition[high] - by_condition[low];
        assert!((found - effect).abs() < 0.05, "{low} {high} {found}");
    }
    let by_scene = means(&run, |scene, _, _| scene.to_owned());
    assert!((by_scene["crossing"] - by_scene["garden"] - 0.4).abs() < 0.05, "{by_scene:?}");
    let by_trial = means(&run, |_, _, position| position);
    assert!((by_trial[&12] - by_trial[&1] - 0.22).abs() < 0.12, "{by_trial:?}");
    let mut counts = [[0.0; 4]; 4];
    for row in run.answers.iter().filter(|row| row.question == "which") {
        let Some(Stimulus::Agent { emotion, .. }) = &row.stimulus else { panic!("{row:?}") };
        counts[emotion.parse::<Emotion>().unwrap().index()][row.value.unwrap() as usize] += 1.0;
    }
    for (found, paper) in counts.iter().zip(PAPER_CONFUSION) {
        assert_eq!(found.iter().sum::<f64>(), 960.0, "two bodies for each of 480");
        for (count, share) in found.iter().zip(paper) {
            assert!((count / 960.0 - share / 48.0).abs() < 0.05, "{counts:?}");
        }
    }
}

#[test]
fn rows_that_participants_leave_are_handed_out_again_until_all_are_full() {
    let plan = super::plan("eva-agents", 0);
    let habits = Habits { leaving: hazard(0.3, 30), ..Habits::default() };
    let setup = Setup { participants: 200, at_once: 12, habits, seed: 4 };
    let (_, run) = run(&plan, &Minds::default(), setup).unwrap();
    let finished = run.participants.iter().filter(|one| one.state == State::Ended(Ending::Finished)).count();
    println!("{} placed, {finished} finished, rows {:?}", run.placed, run.counts[0].counts);
    assert_eq!(finished, 48);
    assert!(run.counts[1].counts.iter().all(|&count| count == 6), "{:?}", run.counts);
    // a participant who left in the last part has answered the row of the scenes whole: it stays and counts
    assert!(run.counts[0].counts.iter().all(|count| (2..=3).contains(count)), "{:?}", run.counts);
    assert!(run.placed > 55 && run.placed < 90, "{}", run.placed);
}

#[test]
fn the_hazard_gives_the_share() {
    for (share, pages) in [(0.3, 14), (0.05, 3), (0.9, 40), (0.0, 5)] {
        let left = 1.0 - (1.0 - hazard(share, pages)).powi(i32::try_from(pages).unwrap());
        assert!((left - share).abs() < 1e-9, "{left}");
    }
}

#[test]
fn simulated_participants_keep_to_the_options_and_the_scale_of_the_file() {
    let change = |name: &str, pairs: &[(&str, &str)]| {
        let mut text = Study::builtin(name).unwrap().text;
        for (old, new) in pairs {
            assert!(text.contains(old), "{old}");
            text = text.replace(old, new);
        }
        let materials = Materials::default().with_gaits("library.glb", super::walks(12));
        Plan::of(&Study::parse(&text, "x").unwrap().file, &materials).unwrap()
    };
    let answered = |plan: &Plan, part: &str| -> Vec<(Option<Stimulus>, i64)> {
        let setup = Setup { participants: 24, at_once: 6, habits: Habits::default(), seed: 3 };
        let (_, run) = run(plan, &Minds::default(), setup).unwrap();
        let rows = run.answers.into_iter().filter(|row| row.page.starts_with(part));
        rows.filter_map(|row| Some((row.stimulus, row.value?))).collect()
    };
    // sad, who is always recognised, is the first of three options here
    let named = [(
        "options = [\"happy\", \"angry\", \"sad\", \"neutral\"]",
        "options = [\"sad\", \"neutral\", \"happy\"]",
    )];
    let named = answered(&change("eva-agents", &named), "identify");
    assert!(named.len() > 100 && named.iter().all(|(_, value)| (0..3).contains(value)), "{named:?}");
    for (stimulus, value) in named {
        if matches!(&stimulus, Some(Stimulus::Agent { emotion, .. }) if emotion == "sad") {
            assert_eq!(value, 0, "{stimulus:?}");
        }
    }
    let points = "points = [\"strongly disagree\", \"disagree\", \"neither\", \"agree\", \"strongly agree\"]";
    let short =
        answered(&change("eva-gaits", &[(points, "points = [\"no\", \"rather\", \"yes\"]")]), "walks");
    assert!(short.len() > 100 && short.iter().all(|(_, value)| (1..=3).contains(value)), "{short:?}");
}
