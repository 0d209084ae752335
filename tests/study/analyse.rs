//! Analyses: numbers by scipy, rules of exclusion, planted effects, and studies without an effect.

use gaitway::study::analyse::{Analysis, ConditionTest, Finding, Reason};
use gaitway::study::file::StudyFile;
use gaitway::study::plan::Plan;
use gaitway::study::simulate::{Habits, LinearModel, Minds, Setup, run};
use gaitway::study::tables::{Answer, Person, Tables};
use gaitway::study::{Materials, Study, analyse};

/// Six people under three conditions.
const ROWS: [[i64; 3]; 6] = [[1, 3, 5], [2, 2, 6], [3, 4, 4], [1, 5, 7], [4, 3, 6], [2, 4, 5]];
const CONDITIONS: [&str; 3] = ["baseline", "eva-o", "eva-g"];

fn file() -> StudyFile {
    let mut file = Study::builtin("eva-agents").unwrap().file;
    file.analysis.tests.truncate(1);
    file.exclude = Default::default();
    file
}

fn person(number: usize, state: &str) -> Person {
    let participant = number.to_string();
    Person { participant, front: "web".to_owned(), state: state.to_owned(), placed: true }
}

fn answer(participant: usize, condition: &str, value: i64) -> Answer {
    Answer {
        participant: participant.to_string(),
        part: "scenes".to_owned(),
        page: format!("scenes/{condition}"),
        position: Some(1),
        role: "ordinary".to_owned(),
        scene: "garden".to_owned(),
        condition: condition.to_owned(),
        question: "presence.q1".to_owned(),
        value: Some(value),
        ms: 2000,
        front: "web".to_owned(),
        ..Answer::default()
    }
}

fn small() -> Tables {
    let cells = ROWS.into_iter().enumerate().flat_map(|(number, row)| {
        CONDITIONS.into_iter().zip(row).map(move |(condition, value)| answer(number, condition, value))
    });
    Tables {
        answers: cells.collect(),
        people: (0..ROWS.len()).map(|number| person(number, "finished")).collect(),
    }
}

fn tests(findings: &[Finding]) -> Vec<&ConditionTest> {
    let mut all = Vec::new();
    for finding in findings {
        if let Finding::Friedman(found) = finding {
            all.extend(&found.tests);
        }
    }
    all
}

fn only(found: &Analysis) -> &ConditionTest {
    let [test] = tests(&found.results)[..] else { panic!("one test") };
    test
}

#[test]
fn a_small_table_has_the_numbers_of_scipy() {
    let found = analyse(&file(), &small()).unwrap();
    let test = only(&found);
    assert!((test.friedman.chi_square - 9.363_636_363_636_363).abs() < 1e-12, "{}", test.friedman.chi_square);
    assert!((test.friedman.p - 0.009_262_158_280_646_627).abs() < 1e-12 && test.p_holm == test.friedman.p);
    let Finding::Friedman(block) = &found.results[0] else { panic!("conditions") };
    assert_eq!(block.levels, CONDITIONS, "in the order of the study file");
    let means = test.answers.iter().map(|one| one.mean).collect::<Vec<_>>();
    assert_eq!(means, [13.0 / 6.0, 3.5, 5.5]);
    let last = test.pairs.iter().find(|pair| pair.levels == ["baseline", "eva-g"]).unwrap();
    // all six differences are positive: 2 of 64 signs
    assert_eq!((last.wilcoxon.p, last.wilcoxon.rank_biserial), (2.0 / 64.0, 1.0));
    assert_eq!(last.p_adjusted, 6.0 / 64.0, "three pairs, by Bonferroni");
    assert_eq!(last.shift.estimate, 3.5, "the middle of 21 averages");
    let page = found.to_string();
    assert!(page.contains("| presence.q1 | garden | 6 | 2.17"), "{page}");
}

#[test]
fn only_whole_rows_of_people_that_finished_count_and_of_one_kind() {
    let mut tables = small();
    tables.people.push(person(6, "lapsed"));
    tables.answers.extend(CONDITIONS.map(|condition| answer(6, condition, 7)));
    tables.people.push(person(7, "finished"));
    tables.answers.push(answer(7, "baseline", 7));
    let found = analyse(&file(), &tables).unwrap();
    assert_eq!((found.finished, only(&found).friedman.people, only(&found).incomplete), (7, 6, 1));
    tables.people[0].front = "simulated".to_owned();
    let message = analyse(&file(), &tables).unwrap_err().to_string();
    assert!(message.contains("mixed with people"), "{message}");
    tables.people.iter_mut().for_each(|one| one.state = "lapsed".to_owned());
    tables.people[0].front = "web".to_owned();
    assert!(analyse(&file(), &tables).unwrap_err().to_string().contains("no participant finished"));
}

#[test]
fn each_rule_leaves_out_whom_it_names_and_both_results_are_there() {
    let mut file = file();
    file.exclude.failed_catch = Some(1);
    file.exclude.median_ms_below = Some(1200);
    file.exclude.same_answer_share = Some(0.9);
    let mut tables = small();
    let catch = |participant, value| Answer {
        page: "scenes/catch".to_owned(),
        role: "catch".to_owned(),
        wanted: Some(2),
        scene: String::new(),
        condition: String::new(),
        ..answer(participant, "", value)
    };
    tables.answers.extend([catch(0, 2), catch(1, 3)]);
    for one in tables.answers.iter_mut().filter(|one| one.participant == "2") {
        one.ms = 900;
    }
    for one in tables.answers.iter_mut().filter(|one| one.participant == "3") {
        one.value = Some(4);
    }
    let found = analyse(&file, &tables).unwrap();
    let out: Vec<(&str, &[Reason])> =
        found.excluded.iter().map(|one| (one.participant.as_str(), one.reasons.as_slice())).collect();
    let [one, two, three] = [
        Reason::FailedCatch { found: 1 },
        Reason::MedianMsBelow { found: 900 },
        Reason::SameAnswerShare { found: 1.0 },
    ];
    assert_eq!(out, [("1", &[one][..]), ("2", &[two][..]), ("3", &[three][..])]);
    assert_eq!(only(&found).friedman.people, 3);
    assert_eq!(tests(&found.with_excluded)[0].friedman.people, 6);
}

fn simulated(effect: f64, seed: u64, people: u32) -> Analysis {
    let study = Study::builtin("eva-agents").unwrap();
    let plan = Plan::of(&study.file, &Materials::default()).unwrap();
    let conditions = [("eva-g".to_owned(), effect)].into();
    let minds = Minds { scenes: LinearModel { conditions, ..LinearModel::default() }, ..Minds::default() };
    let setup = Setup { participants: people, at_once: 10, habits: Habits::default(), seed };
    let (_, found) = run(&plan, &minds, setup).unwrap();
    let tables = Tables::of(&found);
    let names = ["answers.csv", "participants.csv"];
    let back = Tables::parse([&tables.answers_csv(), &tables.people_csv()], names).unwrap();
    assert_eq!(back, tables);
    analyse(&study.file, &back).unwrap()
}

#[test]
fn a_planted_effect_is_found_and_the_papers_confusion_comes_back() {
    let found = simulated(1.5, 1, 24);
    let all = tests(&found.results);
    assert_eq!((all.len(), all.iter().filter(|test| test.p_holm < 0.05).count()), (20, 20));
    for test in all {
        let shift = &test.pairs.iter().find(|pair| pair.levels == ["baseline", "eva-g"]).unwrap().shift;
        assert!(shift.interval[0] <= 1.5 && shift.interval[1] >= 1.0, "{shift:?}");
    }
    let Some(Finding::Confusion(table)) = found.results.last() else { panic!("a confusion") };
    assert_eq!((table.confusion.answers, table.counts[2]), (192, [0, 0, 48, 0]));
    assert!((table.confusion.accuracy - 136.0 / 192.0).abs() < 0.08, "{}", table.confusion.accuracy);
}

#[test]
fn studies_without_an_effect_find_one_in_5_percent_of_their_tests() {
    let (mut all, mut found) = (0, 0);
    for seed in 0..40 {
        let analysis = simulated(0.0, seed, 24);
        let own = tests(&analysis.results);
        all += own.len();
        found += own.iter().filter(|test| test.friedman.p < 0.05).count();
        assert!(own.iter().all(|test| test.p_holm >= test.friedman.p));
    }
    println!("{found} of {all}");
    assert!(all == 800 && (24..=56).contains(&found), "{found} of {all}");
}

#[test]
fn tables_that_are_wrong_are_refused_with_line_column_and_what_is_allowed() {
    let tables = small();
    let [answers, people] = [tables.answers_csv(), tables.people_csv()];
    let bad = |answers: &str, people: &str| {
        Tables::parse([answers, people], ["answers.csv", "participants.csv"]).unwrap_err().to_string()
    };
    let message = bad(&answers.replacen(",2000,", ",soon,", 1), &people);
    assert_eq!(message, "answers.csv:2: ms = \"soon\": must be a whole number, or empty");
    let message = bad(&answers, &people.replacen("true", "yes", 1));
    assert_eq!(message, "participants.csv:2: placed = \"yes\": must be true, false");
    assert!(bad("", &people).starts_with("answers.csv:1: the first line must be participant,part"));
    assert!(bad(&answers, "participant,front\n").contains("participants.csv:1: the first line must be"));
    assert!(bad(&answers, &format!("{people}7,web\n")).contains("participants.csv:8: 2 cells; a row has 4"));
}
