//! The paper recomputed from its own tables.

use gaitway::statistics::paper::{CONFUSION, PAIRS, markdown, recompute};

#[test]
fn all_printed_p_follow_and_holm_keeps_the_same_eighteen() {
    let facts = recompute().unwrap();
    assert_eq!((facts.friedman.len(), facts.p_that_follow), (20, 20));
    assert_eq!((facts.significant, facts.significant_by_holm), (18, 18));
    for fact in &facts.friedman {
        assert_eq!(fact.p < 0.05, fact.p_holm < 0.05, "{fact:?}");
        let insignificant = fact.question == "Q1" && ["Garden", "Scifi"].contains(&fact.scenario);
        assert_eq!(fact.p >= 0.05, insignificant, "{fact:?}");
    }
    let w: Vec<String> = facts.friedman[..4].iter().map(|fact| format!("{:.2}", fact.w)).collect();
    assert_eq!(w, ["0.16", "0.08", "0.25", "0.04"]);
}

#[test]
fn most_chi_squares_need_ties() {
    let facts = recompute().unwrap();
    assert_eq!((facts.need_ties_if_rounded, facts.need_ties), (19, 17));
}

#[test]
fn holm_adds_four_pairs() {
    let facts = recompute().unwrap();
    assert_eq!((facts.pairs, facts.pairs_significant, facts.pairs_by_holm), (54, 36, 40));
    let added: Vec<_> = facts
        .holm_adds
        .iter()
        .map(|pair| (pair.question, pair.scenario, pair.pair, pair.printed_p))
        .collect();
    assert_eq!(
        added,
        [
            ("Q1", "Crossing", PAIRS[0], 0.018),
            ("Q1", "Parking", PAIRS[1], 0.019),
            ("Q2", "Crossing", PAIRS[0], 0.037),
            ("Q4", "Parking", PAIRS[1], 0.035),
        ]
    );
    assert!(facts.holm_loses.is_empty());
}

#[test]
fn the_confusion_matrix_gives_the_accuracy_and_one_misprint() {
    let facts = recompute().unwrap();
    let found = &facts.confusion;
    assert_eq!((found.right, found.answers), (136, 192));
    let percent = |[low, high]: [f64; 2]| [(1000.0 * low).round() / 10.0, (1000.0 * high).round() / 10.0];
    assert_eq!(percent(found.accuracy_interval), [64.0, 76.8]);
    assert!((found.kappa.unwrap().kappa - 0.611).abs() < 1e-3);
    let recall = found.classes.iter().map(|class| percent(class.recall_interval).map(f64::round));
    assert_eq!(recall.collect::<Vec<_>>(), [[46.0, 73.0], [38.0, 66.0], [93.0, 100.0], [57.0, 82.0]]);
    assert!((found.classes[3].precision.unwrap() - 34.0 / 63.0).abs() < 1e-15);
    assert!(found.p_above_chance < 1e-30);
    let [misprint] = facts.misprinted[..] else { panic!("{:?}", facts.misprinted) };
    assert_eq!((misprint.desired, misprint.answered, misprint.count), ("happy", "happy", CONFUSION[0][0]));
    assert_eq!([misprint.printed, misprint.rounded], [60.41, 60.42]);
}

#[test]
fn power_of_what_was_seen() {
    let facts = recompute().unwrap();
    let power = |w: f64, people: usize| {
        let fact =
            facts.power.iter().find(|fact| (fact.w - w).abs() < 1e-9 && fact.people == people).unwrap();
        (100.0 * fact.power).round()
    };
    assert_eq!([power(0.16, 24), power(0.16, 30), power(0.08, 30)], [70.0, 80.0, 49.0]);
}

#[test]
fn every_fact_is_a_field_of_the_serialized_form() {
    let value = serde_json::to_value(recompute().unwrap()).unwrap();
    assert_eq!(value["pairs_by_holm"], 40);
    assert_eq!(value["friedman"][0]["chi_square"], 9.75);
    assert_eq!(value["not_recoverable"].as_array().unwrap().len(), 3);
    assert!(!value.to_string().contains("null"));
}

#[test]
fn the_page_holds_the_tables_as_the_program_writes_them() {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/statistics.md")).unwrap();
    let tables = markdown(&recompute().unwrap());
    println!("{tables}");
    assert!(page.contains(&tables), "docs/statistics.md must contain the tables printed above");
}
