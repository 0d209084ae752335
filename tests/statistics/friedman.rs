//! Friedman's test.

use crate::generator::Random;
use crate::yardsticks::{Comparison, answers, real, rows};
use gaitway::statistics::friedman::{concordance_interval, exact_p, friedman};
use gaitway::statistics::power::simulate;
use gaitway::statistics::{Alternative, Error, binomial_test, ranks};

/// Answers of people who see no difference, 1 to 7 with many ties.
fn null_study(seed: u64, people: usize, conditions: usize) -> Vec<Vec<f64>> {
    let mut random = Random::new(seed);
    (0..people)
        .map(|_| {
            let person = random.unit() * 3.0;
            (0..conditions).map(|_| (person + 1.0 + random.unit() * 4.0).floor().min(7.0)).collect()
        })
        .collect()
}

#[test]
fn five_hundred_tables_agree_with_scipy() {
    let (mut q, mut p) = (Comparison::default(), Comparison::default());
    for row in rows("friedman") {
        let found = friedman(&answers(&row[0], &row[1])).unwrap();
        q.see(found.chi_square, real(&row[2]), row);
        p.see(found.p, real(&row[3]), row);
    }
    q.tell("Friedman, Q", 500);
    p.tell("Friedman, p", 500);
}

#[test]
fn exact_p_is_that_of_all_orders_of_all_rows() {
    let mut p = Comparison::default();
    for row in rows("friedman_exact") {
        p.see(exact_p(&answers(&row[0], &row[1])).unwrap(), real(&row[2]), row);
    }
    p.tell("Friedman, exact p", 80);
}

#[test]
fn exact_p_is_that_of_the_published_table() {
    // Hollander and Wolfe 1999, table A.22: k = 3, n = 4, P(S >= 6.5) = .042, and P(S >= 8) = .005
    let agree = [1.0, 2.0, 3.0];
    let one_off = [[1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [1.0, 3.0, 2.0]];
    assert!((friedman(&one_off).unwrap().chi_square - 6.5).abs() < 1e-12);
    assert!((exact_p(&one_off).unwrap() - 0.042).abs() < 5e-4);
    assert!((exact_p(&[agree; 4]).unwrap() - 6.0 / 1296.0).abs() < 1e-15);
}

#[test]
fn two_conditions_are_the_sign_test() {
    for (people, better) in [(9, 7), (150, 90), (1000, 540)] {
        let rows: Vec<[f64; 2]> =
            (0..people).map(|i| if i < better { [1.0, 2.0] } else { [2.0, 1.0] }).collect();
        let sign = binomial_test(better, people, 0.5, Alternative::TwoSided).unwrap();
        let exact = exact_p(&rows).unwrap();
        assert!((exact / sign - 1.0).abs() < 1e-11, "{exact} {sign}");
    }
}

#[test]
fn thirty_people_with_ties_are_as_rare_as_when_their_answers_are_shuffled() {
    let study = null_study(14, 30, 3);
    let (q, exact) = (friedman(&study).unwrap().chi_square, exact_p(&study).unwrap());
    let shuffled = simulate(10_000, 6, 0.5, |seed| {
        let mut random = Random::new(seed);
        let rows: Vec<[f64; 3]> = study
            .iter()
            .map(|row| {
                let order = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
                order[(random.unit() * 6.0) as usize].map(|j| row[j])
            })
            .collect();
        // "significant" stands for a Q at least as great
        friedman(&rows).map(|test| if test.chi_square >= q - 1e-9 { 0.0 } else { 1.0 })
    })
    .unwrap();
    let [low, high] = shuffled.interval;
    println!("exact p {exact:.4}, shuffled {:.4}", shuffled.power);
    assert!(exact > low - 0.005 && exact < high + 0.005, "{exact} {shuffled:?}");
}

#[test]
fn thirty_people_with_ties_have_an_exact_p_in_time_for_three_and_four_conditions() {
    for conditions in [3, 4] {
        let study = null_study(5, 30, conditions);
        let (exact, by_chi_square) = (exact_p(&study).unwrap(), friedman(&study).unwrap().p);
        assert!((exact - by_chi_square).abs() < 0.03, "{exact} {by_chi_square}");
    }
    let refused = exact_p(&null_study(5, 400, 4));
    assert!(matches!(refused, Err(Error::TooMany { what: "steps of the exact test", .. })), "{refused:?}");
}

#[test]
fn null_studies_are_significant_in_five_of_a_hundred() {
    let found =
        simulate(2000, 20_190_919, 0.05, |seed| friedman(&null_study(seed, 30, 3)).map(|test| test.p))
            .unwrap();
    println!("false positives of Friedman: {} of {}", found.significant, found.studies);
    assert!((0.04..=0.06).contains(&found.power), "{found:?}");
    let exact = simulate(1000, 7, 0.05, |seed| exact_p(&null_study(seed, 12, 3))).unwrap();
    assert!(exact.power <= 0.065, "exact p must not exceed its level: {exact:?}");
}

#[test]
fn rows_that_are_all_one_tie_have_a_result() {
    let test = friedman(&[[3.0; 3]; 8]).unwrap();
    assert_eq!([test.chi_square, test.p, test.w], [0.0, 1.0, 0.0]);
    assert_eq!((test.tied_rows, test.mean_ranks), (8, vec![2.0; 3]));
    assert_eq!(exact_p(&[[3.0; 3]; 8]).unwrap(), 1.0);
    assert_eq!(concordance_interval(&[[3.0; 3]; 8], 100, 0.95, 1).unwrap(), [0.0, 0.0]);
    // Such rows change nothing else.
    let rows = [[1.0, 2.0, 5.0], [2.0, 3.0, 3.0], [1.0, 1.0, 4.0]];
    let more: Vec<[f64; 3]> = rows.iter().copied().chain([[2.0; 3]; 4]).collect();
    let (few, many) = (friedman(&rows).unwrap(), friedman(&more).unwrap());
    assert!((few.chi_square - many.chi_square).abs() < 1e-12 && many.tied_rows == 4);
    assert!((exact_p(&rows).unwrap() - exact_p(&more).unwrap()).abs() < 1e-15);
}

#[test]
fn perfect_agreement_is_one_and_its_interval_has_no_width() {
    let rows = [[1.0, 4.0, 6.0]; 10];
    let test = friedman(&rows).unwrap();
    assert!((test.w - 1.0).abs() < 1e-15 && test.mean_ranks == [1.0, 2.0, 3.0]);
    assert_eq!(concordance_interval(&rows, 200, 0.95, 3).unwrap(), [1.0, 1.0]);
}

#[test]
fn people_are_drawn_with_replacement_from_all() {
    // Two people who contradict each other: half of the draws take one of them twice (W = 1), half take both (W = 0).
    let rows = [[1.0, 2.0], [2.0, 1.0]];
    assert_eq!(concordance_interval(&rows, 2000, 0.2, 8).unwrap(), [0.0, 1.0]);
    assert_eq!(concordance_interval(&[[1.0, 2.0], [1.0, 2.0]], 2000, 0.2, 8).unwrap(), [1.0, 1.0]);
}

#[test]
fn the_interval_of_w_covers_it_and_depends_on_the_seed_alone() {
    let study: Vec<Vec<f64>> =
        null_study(9, 40, 3).into_iter().map(|row| vec![row[0], row[1] + 1.0, row[2] + 2.0]).collect();
    let w = friedman(&study).unwrap().w;
    let [low, high] = concordance_interval(&study, 2000, 0.95, 1).unwrap();
    assert!(low < w && w < high && high - low < 0.5, "{low} {w} {high}");
    assert_eq!(concordance_interval(&study, 2000, 0.95, 1).unwrap(), [low, high]);
    assert_ne!(concordance_interval(&study, 2000, 0.95, 2).unwrap(), [low, high]);
    // The 90 % interval lies within.
    let [inner_low, inner_high] = concordance_interval(&study, 2000, 0.9, 1).unwrap();
    assert!(low < inner_low && inner_high < high);
}

#[test]
fn mid_ranks_share_the_mean_of_their_places() {
    let found = ranks(&[2.0, -0.0, 2.0, 0.0, 9.0, 2.0]).unwrap();
    assert_eq!(found.mid(), [4.0, 1.5, 4.0, 1.5, 6.0, 4.0]);
    assert_eq!(found.ties, 24 + 6);
}
