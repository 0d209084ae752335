//! Tables of a study, and its planned analysis: known numbers, exclusions, effects that were put in.

use gaitway::study::Study;
use gaitway::study::analyse::{
    Analysis, ConfusionBlock, Error, FriedmanBlock, FriedmanTest, Reason, Rule, Sides, Test, analyse,
    markdown,
};
use gaitway::study::file::{Exclude, Front, OnWithdrawal, StudyFile, Test as Planned};
use gaitway::study::plan::Ending;
use gaitway::study::protocol::State;
use gaitway::study::simulate::{Habits, LinearModel, Minds, RatingModel, Run, Setup, hazard, run};
use gaitway::study::tables::{
    Answer, Frames, Participant, Role, Shown, Tables, Trial, Value, ratings, read, write,
};
use std::collections::BTreeSet;

const EMOTIONS: [&str; 4] = ["happy", "angry", "sad", "neutral"];
const CONDITIONS: [&str; 3] = ["baseline", "eva-o", "eva-g"];
const SCENES: [&str; 4] = ["crossing", "garden", "parking", "scifi"];

/// Answers of eight people under three conditions. The numbers below were computed by scipy 1.x and, for exact p, by going through
/// all orders and all signs.
const KNOWN: [[i64; 3]; 8] =
    [[2, 4, 6], [3, 3, 5], [1, 4, 4], [2, 5, 7], [4, 4, 5], [3, 2, 6], [2, 3, 3], [5, 5, 6]];

fn near(found: f64, known: f64) {
    assert!((found - known).abs() < 1e-12 * known.abs().max(1.0), "{found} is not {known}");
}

fn agents() -> StudyFile {
    Study::builtin("eva-agents").unwrap().file
}

pub(super) fn person(name: &str, front: Front) -> Participant {
    let state = State::Ended(Ending::Finished);
    Participant { participant: name.to_owned(), front, state, placed: true, frames: None }
}

pub(super) fn answer(name: &str, page: &str, role: Role, question: &str, value: i64) -> Answer {
    let (part, position) = page.split_once('/').unwrap();
    Answer {
        participant: name.to_owned(),
        front: Front::Web,
        part: part.to_owned(),
        page: page.to_owned(),
        trial: Some(Trial { position: position.parse().unwrap(), role }),
        shown: Shown::default(),
        question: question.to_owned(),
        value: Some(Value::Number(value)),
        ms: Some(2000),
    }
}

/// People with these answers to some items in some scenes.
pub(super) fn people(rows: &[[i64; 3]], scenes: &[&str], items: &[&str]) -> Tables {
    let mut tables = Tables::default();
    for (number, row) in rows.iter().enumerate() {
        let name = format!("p{number}");
        tables.participants.push(person(&name, Front::Web));
        for (block, scene) in scenes.iter().enumerate() {
            for (index, condition) in CONDITIONS.iter().enumerate() {
                for item in items {
                    let page = format!("scenes/{}", 3 * block + index + 1);
                    let mut one =
                        answer(&name, &page, Role::Ordinary, &format!("presence.{item}"), row[index]);
                    one.shown.scene = Some((*scene).to_owned());
                    one.shown.condition = Some((*condition).to_owned());
                    tables.answers.push(one);
                }
            }
        }
    }
    tables
}

/// Two answers a person to each emotion, in the order of this matrix of eight answers a row.
pub(super) fn identify(tables: &mut Tables, matrix: [[usize; 4]; 4]) {
    for (shown, row) in matrix.iter().enumerate() {
        let answers: Vec<usize> =
            row.iter().enumerate().flat_map(|(answered, &count)| vec![answered; count]).collect();
        for (index, &answered) in answers.iter().enumerate() {
            let page = format!("identify/{}", 2 * shown + index % 2 + 1);
            let mut one = answer(
                &format!("p{}", index / 2),
                &page,
                Role::Ordinary,
                "which",
                i64::try_from(answered).unwrap(),
            );
            one.shown.emotion = Some(EMOTIONS[shown].to_owned());
            tables.answers.push(one);
        }
    }
}

fn friedman(analysis: &Analysis, index: usize) -> &Sides<FriedmanBlock> {
    let Test::Friedman(sides) = &analysis.tests[index] else { panic!("{:?}", analysis.tests[index]) };
    sides
}

fn confusion(analysis: &Analysis) -> &Sides<ConfusionBlock> {
    let found = analysis.tests.iter().find_map(|test| match test {
        Test::Confusion(sides) => Some(sides),
        Test::Friedman(_) => None,
    });
    found.unwrap()
}

fn of<'a>(block: &'a FriedmanBlock, item: &str, scene: &str) -> &'a FriedmanTest {
    block.tests.iter().find(|test| test.item == item && test.within.as_deref() == Some(scene)).unwrap()
}

/// A study with the presence questions of 24 simulated participants.
fn simulated(effect: f64, seed: u64) -> Run {
    let plan = super::plan("eva-agents", 0);
    let conditions = [("baseline", -effect), ("eva-o", 0.0), ("eva-g", effect)];
    let conditions = conditions.iter().map(|&(name, value)| (name.to_owned(), value)).collect();
    let scenes = LinearModel { conditions, ..LinearModel::default() };
    let minds = Minds { scenes, ..Minds::default() };
    let setup = Setup { participants: 24, at_once: 6, habits: Habits::default(), seed };
    run(&plan, &minds, setup).unwrap().1
}

#[test]
fn a_table_made_by_hand_gives_the_numbers_of_scipy_and_of_enumeration() {
    let mut tables = people(&KNOWN, &["garden"], &["q1", "q2"]);
    identify(&mut tables, [[5, 1, 0, 2], [1, 4, 1, 2], [0, 0, 8, 0], [1, 0, 1, 6]]);
    let analysis = analyse(&agents(), &tables).unwrap();
    let sides = friedman(&analysis, 0);
    assert!(sides.everyone.is_none());
    assert_eq!((sides.kept.tests.len(), &sides.kept.levels[..]), (20, &CONDITIONS.map(str::to_owned)[..]));
    let test = of(&sides.kept, "presence.q1", "garden");
    assert_eq!((test.people, test.short_of), (8, Some(24)));
    assert_eq!(test.text, "It was as if the people and I were in one place");
    let found = test.outcome.as_ref().unwrap();
    near(found.friedman.chi_square, 12.074_074_074_074_074);
    assert_eq!(found.friedman.degrees, 2);
    near(found.friedman.p, 0.002_388_625_848_835_549_3);
    near(found.p_exact.unwrap(), 0.000_457_247_370_827_617_67);
    near(found.p_holm, 2.0 * found.friedman.p);
    near(found.friedman.w, 0.754_629_629_629_629_6);
    assert!(found.w_interval[0] > 0.4 && found.w_interval[1] <= 1.0, "{:?}", found.w_interval);
    let known = [(2.75, 1.281_739_89), (3.75, 1.035_098_34), (5.25, 1.281_739_89)];
    for (level, (mean, deviation)) in found.levels.iter().zip(known) {
        near(level.answers.mean, mean);
        assert!((level.answers.deviation.unwrap() - deviation).abs() < 1e-8);
    }
    // first, second, ranked, p, Bonferroni, Holm, r, rank-biserial, Hodges-Lehmann
    let known = [
        ("baseline", "eva-o", 5, 0.1875, 0.5625, 0.1875, 0.730_296_743_340_221_4, 0.8, 1.0),
        ("baseline", "eva-g", 8, 0.007_812_5, 0.023_437_5, 0.023_437_5, 0.896_643_866_495_092_2, 1.0, 2.5),
        ("eva-o", "eva-g", 6, 0.031_25, 0.093_75, 0.062_5, 0.911_322_376_865_767_2, 1.0, 1.5),
    ];
    let pairs = found.pairs.as_ref().unwrap();
    assert_eq!(pairs.len(), 3);
    for (pair, (first, second, ranked, p, bonferroni, holm, r, biserial, estimate)) in pairs.iter().zip(known)
    {
        assert_eq!((&*pair.first, &*pair.second, pair.wilcoxon.ranked), (first, second, ranked));
        assert!(pair.wilcoxon.exact);
        for (found, known) in [
            (pair.wilcoxon.p, p),
            (pair.p_adjusted, bonferroni),
            (pair.p_holm, holm),
            (pair.wilcoxon.r, r),
            (pair.wilcoxon.rank_biserial, biserial),
            (pair.shift.estimate, estimate),
        ] {
            near(found, known);
        }
    }
    let none = of(&sides.kept, "presence.q1", "scifi");
    assert!(none.people == 0 && none.outcome.is_none());
    let block = &confusion(&analysis).kept;
    assert_eq!(block.classes, EMOTIONS);
    assert_eq!(block.counts, [[5, 1, 0, 2], [1, 4, 1, 2], [0, 0, 8, 0], [1, 0, 1, 6]]);
    let found = block.statistics.as_ref().unwrap();
    near(found.accuracy, 0.718_75);
    near(found.kappa.unwrap().kappa, 0.625);
    near(found.accuracy_interval[0], 0.546_254_905_740_834_2);
    near(found.accuracy_interval[1], 0.844_354_195_022_572_3);
    near(found.p_above_chance, 3.410_731_025_675_672e-8);
    assert_eq!(found.classes[2].recall, Some(1.0));
    assert_eq!(found.classes[2].precision, Some(0.8));
    let over = block.over_people.unwrap();
    assert_eq!((over.people, block.people, block.short_of), (4, 4, Some(8)));
    near(over.accuracy, 0.718_75);
    assert!(over.interval[0] < 0.718_75 && over.interval[1] > 0.718_75);
    assert!(analysis.is_short && !analysis.participants.is_simulated);
    let json = serde_json::to_value(&analysis).unwrap();
    let test = &json["tests"][0]["kept"]["tests"][1];
    assert_eq!((&json["tests"][0]["kind"], &test["within"]), (&"friedman".into(), &"garden".into()));
    assert_eq!(test["outcome"]["levels"][1]["mean"], 3.75);
    assert_eq!(test["outcome"]["pairs"][0]["rank_biserial"], 0.8);
}

#[test]
fn only_people_with_an_answer_under_every_condition_count_and_repeats_do_not() {
    let mut tables = people(&KNOWN, &["garden"], &["q1"]);
    let mut again = tables.answers[0].clone();
    again.trial = Some(Trial { position: 13, role: Role::Repeat });
    again.page = "scenes/13".to_owned();
    again.value = Some(Value::Number(7));
    tables.answers.push(again);
    let found = |tables: &Tables| {
        let analysis = analyse(&agents(), tables).unwrap();
        of(&friedman(&analysis, 0).kept, "presence.q1", "garden").clone()
    };
    near(found(&tables).outcome.unwrap().friedman.chi_square, 12.074_074_074_074_074);
    tables.answers[1].value = None;
    tables.answers.remove(8);
    let test = found(&tables);
    assert_eq!((test.people, test.outcome.unwrap().levels[0].answers.count), (6, 6));
    // two ordinary answers to one cell are no data of this design
    let mut twice = tables.answers[0].clone();
    twice.page = "scenes/9".to_owned();
    tables.answers.push(twice);
    let message = analyse(&agents(), &tables).unwrap_err().to_string();
    assert!(message.contains("presence.q1 of garden under baseline") && message.contains("p0"), "{message}");
}

#[test]
fn without_a_fixed_factor_each_person_counts_by_a_mean() {
    let mut study = agents();
    let Planned::Friedman { of, within, .. } = &mut study.analysis.tests[0] else { panic!() };
    (*of, *within) = ("scenes.presence.q3".to_owned(), None);
    let mut tables = people(&KNOWN, &SCENES, &["q3"]);
    let by_mean =
        |study: &StudyFile, tables: &Tables| friedman(&analyse(study, tables).unwrap(), 0).kept.clone();
    let block = by_mean(&study, &tables);
    assert_eq!((block.tests.len(), block.within, &block.tests[0].within), (1, None, &None));
    let found = block.tests[0].outcome.as_ref().unwrap();
    near(found.friedman.chi_square, 12.074_074_074_074_074);
    near(found.levels[2].answers.mean, 5.25);
    near(found.pairs.as_ref().unwrap()[1].shift.estimate, 2.5);
    // the mean of 2, 2, 2 and 6 is 3: as person 1 has in the first two conditions
    tables.answers[9].value = Some(Value::Number(6));
    let found = by_mean(&study, &tables).tests[0].outcome.clone().unwrap();
    near(found.levels[0].answers.mean, 2.875);
    let Planned::Friedman { by, .. } = &mut study.analysis.tests[0] else { panic!() };
    *by = "scene".to_owned();
    let block = by_mean(&study, &people(&KNOWN, &SCENES, &["q3"]));
    let found = block.tests[0].outcome.as_ref().unwrap();
    assert_eq!((block.levels, found.friedman.tied_rows), (SCENES.map(str::to_owned).to_vec(), 8));
    assert!(found.pairs.is_none() && found.friedman.p >= 1.0, "scenes do not differ, so no pair follows");
}

#[test]
fn an_effect_that_was_put_in_is_found_by_24_participants() {
    let run = simulated(0.8, 1);
    let analysis = analyse(&agents(), &Tables::simulated(&run)).unwrap();
    assert!(analysis.participants.is_simulated && !analysis.is_short, "{:?}", analysis.parts);
    assert_eq!(
        analysis.parts.iter().map(|part| (part.people, part.complete)).collect::<Vec<_>>(),
        [(24, 24); 2]
    );
    let tests = &friedman(&analysis, 0).kept.tests;
    assert!(tests.iter().all(|test| test.people == 24 && test.short_of.is_none()));
    let outcomes: Vec<_> = tests.iter().map(|test| test.outcome.as_ref().unwrap()).collect();
    let found = outcomes.iter().filter(|found| found.p_holm < 0.05).count();
    println!("{found} of 20 by Holm");
    assert!(found >= 18, "{found}");
    for found in outcomes.iter().filter(|found| found.friedman.p < 0.05) {
        let pair = &found.pairs.as_ref().unwrap()[1];
        assert!(pair.p_adjusted < 0.05 && pair.shift.estimate > 0.0, "{pair:?}");
        assert!(found.w_interval[0] <= found.friedman.w && found.friedman.w <= found.w_interval[1]);
    }
    let mean =
        outcomes.iter().map(|found| found.levels[2].answers.mean - found.levels[0].answers.mean).sum::<f64>();
    assert!((mean / 20.0 - 1.6).abs() < 0.2, "{}", mean / 20.0);
    let accuracy = confusion(&analysis).kept.statistics.as_ref().unwrap().accuracy;
    assert!((accuracy - 0.708).abs() < 0.1, "{accuracy}");
}

#[test]
fn without_an_effect_few_tests_find_one_and_no_pair_follows_the_others() {
    let (mut found, mut by_holm) = (0, 0);
    for seed in 0..4 {
        let analysis = analyse(&agents(), &Tables::simulated(&simulated(0.0, seed))).unwrap();
        for test in &friedman(&analysis, 0).kept.tests {
            let outcome = test.outcome.as_ref().unwrap();
            assert_eq!(outcome.pairs.is_some(), outcome.friedman.p < 0.05);
            found += u32::from(outcome.friedman.p < 0.05);
            by_holm += u32::from(outcome.p_holm < 0.05);
        }
    }
    println!("{found} of 80, {by_holm} by Holm");
    assert!(found <= 11 && by_holm <= 1, "{found} {by_holm}");
}

#[test]
fn two_hundred_null_studies_have_the_false_positives_of_the_level() {
    let mut study = agents();
    study.analysis.tests.truncate(1);
    let Planned::Friedman { of, within, .. } = &mut study.analysis.tests[0] else { panic!() };
    (*of, *within) = ("scenes.presence.q1".to_owned(), None);
    let mut positives = 0;
    let mut exact = 0;
    for seed in 0..200 {
        let (answers, participants) = write(&Tables::simulated(&simulated(0.0, 1000 + seed)));
        let analysis = analyse(&study, &read(&answers, &participants, "run").unwrap()).unwrap();
        let [test] = &friedman(&analysis, 0).kept.tests[..] else { panic!() };
        let outcome = test.outcome.as_ref().unwrap();
        positives += u32::from(outcome.friedman.p < 0.05);
        exact += u32::from(outcome.p_exact.unwrap() < 0.05);
    }
    println!("{positives} of 200, exact {exact}");
    assert!((4..=18).contains(&positives) && (4..=18).contains(&exact), "{positives} {exact}");
}

#[test]
fn every_rule_excludes_whom_it_names_and_tests_are_given_with_and_without_them() {
    let mut tables = people(&KNOWN, &SCENES, &["q1", "q2"]);
    for (index, one) in tables.answers.iter_mut().enumerate() {
        // p6 alone answers one number nearly always: 2, 3, 3 becomes 3, 3, 3 but once
        if one.participant == "p6" && index % 24 != 0 {
            one.value = Some(Value::Number(3));
        }
        if one.participant == "p1" {
            one.ms = Some(if index % 3 == 0 { 5000 } else { 700 });
        }
        if one.participant == "p2" {
            one.ms = Some(1200);
        }
    }
    for (name, value) in [("p0", 4), ("p3", 5), ("p4", 4)] {
        tables.answers.push(answer(name, "scenes/14", Role::Catch(4), "presence.q1", value));
        tables.answers.push(answer(name, "scenes/14", Role::Catch(4), "presence.q2", 4));
    }
    tables.answers.push(answer("p4", "scenes/15", Role::Catch(1), "presence.q1", 2));
    tables.participants[5].frames = Some(Frames { all: 1000, late: 201 });
    tables.participants[2].frames = Some(Frames { all: 1000, late: 200 });
    tables.participants[7].state = State::Ended(Ending::Excluded);
    let all = Exclude {
        failed_catch: Some(1),
        median_ms_below: Some(1200),
        same_answer_share: Some(0.95),
        late_frames_share: Some(0.2),
    };
    let mut study = agents();
    let mut excluded = |exclude: Exclude| {
        study.exclude = exclude;
        let analysis = analyse(&study, &tables).unwrap();
        assert!(analysis.exclusions.not_judged.is_empty());
        let of = |one: &gaitway::study::analyse::Excluded| (one.participant.clone(), one.reasons.clone());
        (analysis.exclusions.excluded.iter().map(of).collect::<Vec<_>>(), analysis)
    };
    let mut only = |exclude: Exclude| {
        let (mut found, _) = excluded(exclude);
        // the operator's decision stands beside every rule
        assert_eq!(found.pop().unwrap(), ("p7".to_owned(), vec![Reason::Operator]));
        found
    };
    let none = Exclude::default();
    let one = |name: &str, reason: Reason| (name.to_owned(), vec![reason]);
    assert_eq!(only(none.clone()), []);
    assert_eq!(
        only(Exclude { failed_catch: Some(1), ..none.clone() }),
        [
            one("p3", Reason::FailedCatch { failed: 1, least: 1 }),
            one("p4", Reason::FailedCatch { failed: 1, least: 1 })
        ]
    );
    assert_eq!(only(Exclude { failed_catch: Some(2), ..none.clone() }), []);
    assert_eq!(
        only(Exclude { median_ms_below: Some(1200), ..none.clone() }),
        [one("p1", Reason::MedianMsBelow { median: 700.0, below: 1200 })]
    );
    let share = 23.0 / 24.0;
    assert_eq!(
        only(Exclude { same_answer_share: Some(0.95), ..none.clone() }),
        [one("p6", Reason::SameAnswerShare { question: "presence".to_owned(), share, above: 0.95 })]
    );
    assert_eq!(
        only(Exclude { late_frames_share: Some(0.2), ..none }),
        [one("p5", Reason::LateFramesShare { share: 0.201, above: 0.2 })]
    );
    let (found, analysis) = excluded(all.clone());
    assert_eq!(
        found.iter().map(|(name, _)| &**name).collect::<Vec<_>>(),
        ["p1", "p3", "p4", "p5", "p6", "p7"]
    );
    let sides = friedman(&analysis, 0);
    let people = |block: &FriedmanBlock| of(block, "presence.q1", "garden").people;
    assert_eq!((people(&sides.kept), people(sides.everyone.as_ref().unwrap())), (2, 8));
    assert!(confusion(&analysis).everyone.is_some());
    assert_eq!(analysis.parts[0].people, 2);
    // what cannot be judged is named
    study.exclude = all;
    let bare = people_without_extras();
    let analysis = analyse(&study, &bare).unwrap();
    assert_eq!(
        analysis.exclusions.not_judged,
        [Rule::FailedCatch, Rule::SameAnswerShare, Rule::LateFramesShare]
    );
    assert!(markdown(&analysis).contains("The rule `late_frames_share` could not be applied"));
}

/// Three answers a person, no instructed trials, no frames.
fn people_without_extras() -> Tables {
    people(&KNOWN, &["garden"], &["q1"])
}

#[test]
fn careless_simulated_raters_are_excluded_by_the_file_and_the_fill_is_counted() {
    let plan = super::plan("eva-gaits", 40);
    let minds = Minds { ratings: RatingModel::drawn(&super::walks(40), 5), ..Minds::default() };
    let setup = Setup {
        participants: 200,
        at_once: 20,
        habits: Habits { careless: 0.6, ..Habits::default() },
        seed: 3,
    };
    let (_, run) = run(&plan, &minds, setup).unwrap();
    let study = Study::builtin("eva-gaits").unwrap().file;
    let analysis = analyse(&study, &Tables::simulated(&run)).unwrap();
    let names = |keeps: fn(&gaitway::study::simulate::Participant) -> bool| -> BTreeSet<String> {
        run.participants.iter().filter(|one| keeps(one)).map(|one| one.number.to_string()).collect()
    };
    let excluded: BTreeSet<String> =
        analysis.exclusions.excluded.iter().map(|one| one.participant.clone()).collect();
    let careless = names(|one| one.is_careless && one.was_placed);
    println!("{} excluded of {} careless", excluded.len(), careless.len());
    assert!(careless.len() > 3 && excluded.is_subset(&careless) && excluded.len() + 1 >= careless.len());
    assert_eq!(analysis.exclusions.not_judged, [Rule::LateFramesShare]);
    let part = &analysis.parts[0];
    let gaits = part.gaits.clone().unwrap();
    assert_eq!((part.part.as_str(), gaits.count), ("walks", 40));
    // ten answers each, of which the excluded gave some
    assert!(gaits.fewest < 10 && part.short_of == Some(10) && analysis.is_short, "{gaits:?}");
    let whole =
        analyse(&StudyFile { exclude: Exclude::default(), ..study }, &Tables::simulated(&run)).unwrap();
    let gaits = whole.parts[0].gaits.clone().unwrap();
    assert_eq!((gaits.fewest, gaits.most.min(11)), (run.answered["walks"].0 as usize, gaits.most));
    assert_eq!((whole.parts[0].short_of, whole.is_short), (None, false));
}

#[test]
fn people_and_simulated_participants_never_mix_and_withdrawn_answers_do_not_count() {
    let mut tables = people(&KNOWN, &["garden"], &["q1"]);
    let mut study = agents();
    tables.participants[0].state = State::Ended(Ending::Withdrawn);
    let people = |study: &StudyFile, tables: &Tables| {
        of(&friedman(&analyse(study, tables).unwrap(), 0).kept, "presence.q1", "garden").people
    };
    assert_eq!(people(&study, &tables), 7);
    study.consent.on_withdrawal = OnWithdrawal::KeepAnonymous;
    assert_eq!(people(&study, &tables), 8);
    tables.participants[1].front = Front::Headset;
    assert_eq!(people(&study, &tables), 8, "browser and headset are both people");
    tables.participants[2].front = Front::Simulated;
    let wrong = analyse(&study, &tables).unwrap_err();
    assert!(matches!(wrong, Error::Mixed { people: 7, simulated: 1 }), "{wrong}");
    assert_eq!(people(&study, &tables.only(|one| one.front != Front::Simulated)), 7);
}

#[test]
fn wrong_tests_are_refused_with_key_value_and_what_is_allowed() {
    let tables = people(&KNOWN, &["garden"], &["q1"]);
    let refused = |change: &dyn Fn(&mut StudyFile)| {
        let mut study = agents();
        change(&mut study);
        analyse(&study, &tables).unwrap_err().to_string()
    };
    let with_of = |to: &'static str| {
        move |study: &mut StudyFile| match &mut study.analysis.tests[0] {
            Planned::Friedman { of, .. } | Planned::Confusion { of } => to.clone_into(of),
        }
    };
    for (of, part) in [
        ("scenes.presence", "PART.QUESTION.ITEM"),
        ("nowhere.presence.q1", "a part with counted trials"),
        ("practice.presence.q1", "a part with counted trials"),
        ("identify.which.x", "shows scenes"),
        ("scenes.which.*", "likert"),
        ("scenes.presence.q9", "q1, q2, q3, q4, q5, or *"),
    ] {
        let message = refused(&with_of(of));
        assert!(message.starts_with("analysis.test[0].of = ") && message.contains(part), "{message}");
    }
    let message = refused(&|study| {
        let Planned::Friedman { within, .. } = &mut study.analysis.tests[0] else { panic!() };
        *within = Some("condition".to_owned());
    });
    assert!(message.contains("analysis.test[0].within = \"condition\": must be scene"), "{message}");
    let message = refused(&|study| {
        let agents = study.parts.get_mut("identify").unwrap();
        let gaitway::study::file::Part::Trials(trials) = agents else { panic!() };
        trials.show.agents.as_mut().unwrap().each_of[0] = "bored".to_owned();
    });
    assert!(message.contains("each_of = \"bored\"") && message.contains("option of which"), "{message}");
    let mut tables = tables.clone();
    identify(&mut tables, [[8, 0, 0, 0]; 4]);
    tables.answers.last_mut().unwrap().value = Some(Value::Number(4));
    let message = analyse(&agents(), &tables).unwrap_err().to_string();
    assert!(message.contains("value = \"4\": must be 0 to 3") && message.contains("identify/8"), "{message}");
}

#[test]
fn the_page_says_who_took_part_who_was_excluded_and_what_was_found() {
    let mut tables = people(&KNOWN, &["garden"], &["q1", "q2"]);
    identify(&mut tables, [[5, 1, 0, 2], [1, 4, 1, 2], [0, 0, 8, 0], [1, 0, 1, 6]]);
    tables.participants[7].state = State::Ended(Ending::Excluded);
    tables.participants[7].participant = "a|b".to_owned();
    tables.answers.iter_mut().filter(|one| one.participant == "p7").for_each(|one| {
        "a|b".clone_into(&mut one.participant);
    });
    let mut text = answer("p1", "comments/1", Role::Ordinary, "remarks", 0);
    (text.trial, text.value) = (None, Some(Value::Text("it | was fun".to_owned())));
    tables.answers.push(text);
    let page = markdown(&analyse(&agents(), &tables).unwrap());
    println!("{page}");
    for line in [
        "# Walking among people",
        "8 participants arrived (8 web). 8 got a place.",
        "| finished | 7 |",
        "| excluded | 1 |",
        "| a\\|b | excluded by the operator |",
        "## `scenes.presence.*`, without the excluded",
        "## `scenes.presence.*`, with the excluded",
        "- presence.q1: It was as if the people and I were in one place",
        "| presence.q1 | garden | 8 | 2.75 (1.28) | 3.75 (1.04) | 5.25 (1.28) | 12.07 | 0.002 | < 0.001 | 0.005 | 0.75 |",
        "| presence.q1 | garden | baseline to eva-g | 8 | 0.008 | 0.023 | 0.023 | 0.90 | 1.00 | 2.50 |",
        "| presence.q1 | scifi | 0 |",
        "| happy | 5 | 1 | 0 | 2 | 62.5 % |",
        "- 23 of 32 answers right, by 4 people",
        "- kappa 0.62 (95 %",
        "- chance 25.0 %; p < 0.001 of so many right answers by chance",
        "## Remarks",
        "- Part scenes: 0 people answered all trials; the plan is complete with 24.",
        "- Test `identify.which` has as few as 4 people; the plan is complete with 8.",
        "- Participants wrote 1 free text. The table of answers has them.",
    ] {
        assert!(page.lines().any(|found| found.starts_with(line)), "{line}\n{page}");
    }
    assert!(!page.contains("simulated") && !page.contains("it | was fun"));
    // every row of a table has the cells of its head
    let mut width = 0;
    for line in page.lines() {
        let cells = line.replace("\\|", "").matches('|').count();
        width = if cells == 0 || width == 0 { cells } else { width };
        assert_eq!(cells, width, "{line}");
    }
}

#[test]
fn tables_that_are_written_are_read_as_they_were() {
    let plan = super::plan("eva-gaits", 60);
    let habits = Habits {
        careless: 0.1,
        withdrawing: 0.2,
        returning: 0.4,
        leaving: hazard(0.3, 14),
        leaving_early: 0.02,
    };
    let (_, found) =
        run(&plan, &Minds::default(), Setup { participants: 120, at_once: 30, habits, seed: 2 }).unwrap();
    let mut tables = Tables::simulated(&found);
    let roles: BTreeSet<String> =
        tables.answers.iter().map(|one| format!("{:?}", one.trial.map(|trial| trial.role))).collect();
    assert!(
        roles.iter().any(|role| role.contains("Catch")) && roles.iter().any(|role| role.contains("Repeat"))
    );
    let states: BTreeSet<String> = tables.participants.iter().map(|one| format!("{:?}", one.state)).collect();
    assert!(states.len() >= 4, "{states:?}");
    let (answers, participants) = write(&tables);
    assert!(answers.starts_with("participant,front,part,page,position,role,wanted,gait,scene,"));
    assert!(participants.starts_with("participant,front,state,placed\n0,simulated,"));
    assert_eq!(read(&answers, &participants, "run").unwrap(), tables);
    // free text of every kind, frames, an answer that was taken back
    let texts = ["=1+1", "+4", "-", "@x", "'tis", "''", "7", "-7", "a, \"b\"\nc", "plain", "é;\tx"];
    for (index, text) in texts.iter().enumerate() {
        let mut one = tables.answers[0].clone();
        (one.page, one.trial) = (format!("comments-{index}"), None);
        one.value = Some(Value::Text((*text).to_owned()).clone()).filter(|_| index != 9);
        one.ms = None;
        tables.answers.push(one);
    }
    tables.participants[3].frames = Some(Frames { all: 900, late: 3 });
    let (answers, participants) = write(&tables);
    assert_eq!(read(&answers, &participants, "run").unwrap(), tables);
    for cell in [",'=1+1,", ",'+4,", ",'-,", ",'@x,", ",''tis,", ",'7,", ",'-7,"] {
        assert!(answers.contains(cell), "{cell}");
    }
    let columns: BTreeSet<&str> = answers.lines().flat_map(|line| line.split(',').nth(13)).collect();
    assert!(columns.iter().all(|cell| !cell.starts_with(['=', '+', '@'])));
}

#[test]
fn numbers_below_zero_stay_numbers() {
    let mut tables = people(&KNOWN[..1], &["garden"], &["q1"]);
    tables.answers[0].value = Some(Value::Number(-3));
    let (answers, participants) = write(&tables);
    assert!(answers.contains(",presence.q1,-3,2000\n"), "{answers}");
    assert_eq!(read(&answers, &participants, "").unwrap(), tables);
}

#[test]
fn wrong_cells_are_refused_with_file_line_column_value_and_what_is_allowed() {
    let people = "participant,front,state,placed\np,web,finished,true\n";
    let head = "participant,front,part,page,position,role,wanted,gait,scene,condition,emotion,body,question,value,ms\n";
    let good = "p,web,walks,walks/1,1,ordinary,,g,,,,,emotions.sad,4,900\n";
    assert_eq!(read(&format!("{head}{good}"), people, "run").unwrap().answers.len(), 1);
    for (row, line, parts) in [
        ("q,web,w,w/1,,,,,,,,,x,1,1", 3, &["participant = \"q\"", "participants.csv"][..]),
        ("p,headset,w,w/1,,,,,,,,,x,1,1", 3, &["front = \"headset\"", "must be web"]),
        ("p,tv,w,w/1,,,,,,,,,x,1,1", 3, &["front = \"tv\"", "web, headset or simulated"]),
        ("p,web,,w/1,,,,,,,,,x,1,1", 3, &["part = \"\"", "a text"]),
        ("p,web,w,w/1,0,ordinary,,,,,,,x,1,1", 3, &["position = \"0\"", "from 1"]),
        ("p,web,w,w/1,one,ordinary,,,,,,,x,1,1", 3, &["position = \"one\""]),
        ("p,web,w,w/1,2,,,,,,,,x,1,1", 3, &["role = \"\"", "ordinary, repeat or catch"]),
        ("p,web,w,w/1,,ordinary,,,,,,,x,1,1", 3, &["position = \"\""]),
        ("p,web,w,w/1,2,Catch,4,,,,,,x,1,1", 3, &["role = \"Catch\""]),
        ("p,web,w,w/1,2,catch,,,,,,,x,1,1", 3, &["wanted = \"\"", "where role is catch"]),
        ("p,web,w,w/1,2,repeat,4,,,,,,x,1,1", 3, &["wanted = \"4\"", "empty"]),
        ("p,web,w,w/1,,,,,,,,,,1,1", 3, &["question = \"\""]),
        ("p,web,w,w/1,,,,,,,,,x,1,-5", 3, &["ms = \"-5\"", "milliseconds"]),
        (
            "p,web,walks,walks/1,1,repeat,,g,,,,,emotions.sad,4,900",
            3,
            &["question = \"emotions.sad\"", "line 2"],
        ),
        ("p,web,w", 3, &["3 cells", "15 columns"]),
        ("\"p,web", 3, &["quote"]),
    ] {
        let message = read(&format!("{head}{good}{row}\n"), people, "run").unwrap_err().to_string();
        assert!(message.starts_with(&format!("run/answers.csv:{line}: ")), "{row}: {message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{row}: {message}");
    }
    for (text, line, parts) in [
        ("", 1, &["no header", "participant, front, state, placed"][..]),
        (
            "participant,front,state\np,web,finished\n",
            1,
            &["no column \"placed\"", "found: participant, front, state"],
        ),
        ("participant,front,state,placed,front\n", 1, &["two columns \"front\""]),
        ("participant,front,state,placed\np,web,dead,true\n", 2, &["state = \"dead\"", "screened-out"]),
        ("participant,front,state,placed\np,web,lapsed,maybe\n", 2, &["placed = \"maybe\"", "true or false"]),
        ("participant,front,state,placed\np,web,full,true\n\np,web,full,true\n", 4, &["participant = \"p\""]),
        (
            "participant,front,state,placed,frames,late_frames\np,web,full,true,5,6\n",
            2,
            &["late_frames = \"6\""],
        ),
        (
            "participant,front,state,placed,frames,late_frames\np,web,full,true,5,\n",
            2,
            &["late_frames = \"\""],
        ),
    ] {
        let message = read(head, text, "run").unwrap_err().to_string();
        assert!(message.starts_with(&format!("run/participants.csv:{line}: ")), "{text}: {message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{text}: {message}");
    }
}

#[test]
fn ratings_are_the_ordinary_trials_that_are_answered_whole() {
    let mut tables = Tables::default();
    for (name, page, role, gait, scores) in [
        ("p2", "walks/1", Role::Ordinary, "walk, 1", [5, 1, 2, 3]),
        ("p1", "walks/1", Role::Ordinary, "b", [1, 2, 3, 4]),
        ("p1", "walks/2", Role::Repeat, "b", [4, 4, 4, 4]),
        ("p1", "walks/3", Role::Catch(2), "", [2, 2, 2, 2]),
        ("p1", "other/4", Role::Ordinary, "c", [2, 2, 2, 2]),
        ("p1", "walks/5", Role::Ordinary, "d", [2, 2, 2, 2]),
    ] {
        for (emotion, score) in EMOTIONS.iter().zip(scores) {
            let mut one = answer(name, page, role, &format!("emotions.{emotion}"), score);
            one.shown.gait = Some(gait.to_owned()).filter(|gait| !gait.is_empty());
            tables.answers.push(one);
        }
    }
    tables.answers.pop();
    let sheet = "participant,video,happy,angry,sad,neutral\np2,\"walk, 1\",5,1,2,3\np1,b,1,2,3,4\n";
    assert_eq!(ratings(&tables, "walks", "emotions"), sheet);
    assert_eq!(ratings(&tables, "walks", "else").lines().count(), 1);
}
