//! Power, planned and simulated.

use crate::generator::Random;
use gaitway::statistics::Error;
use gaitway::statistics::distribution::normal_quantile;
use gaitway::statistics::friedman::friedman;
use gaitway::statistics::power::{
    Simulated, friedman_people, friedman_power, friedman_power_finite, simulate,
};

/// A study in which condition j is `effect * j` better, in standard deviations of an answer.
fn study(seed: u64, people: usize, effect: f64) -> Vec<[f64; 3]> {
    let mut random = Random::new(seed);
    let mut normal = || normal_quantile(random.unit().max(1e-300));
    (0..people).map(|_| [0.0, 1.0, 2.0].map(|j| normal() + effect * j)).collect()
}

/// W of a population: that of very many people.
fn population_w(effect: f64) -> f64 {
    let test = friedman(&study(1, 100_000, effect)).unwrap();
    test.w
}

#[test]
fn simulated_power_is_within_two_points_of_the_finite_formula_and_not_below_the_limit() {
    for (people, effect) in [(100, 0.2), (30, 0.2), (48, 0.3), (24, 0.4), (30, 0.5), (12, 0.6)] {
        let w = population_w(effect);
        let limit = friedman_power(people, 3, w, 0.05).unwrap();
        let finite = friedman_power_finite(people, 3, w, 0.05).unwrap();
        let found = simulate(4000, 3, 0.05, |seed| friedman(&study(seed, people, effect)).map(|test| test.p))
            .unwrap();
        println!("| {people} | {w:.3} | {limit:.3} | {finite:.3} | {:.3} |", found.power);
        assert!((found.power - finite).abs() < 0.02, "{finite} {found:?}");
        assert!(found.power > limit - 0.01 && found.power < limit + 0.07, "{limit} {found:?}");
    }
}

#[test]
fn power_without_an_effect_is_the_level_and_grows_with_people() {
    assert!((friedman_power(30, 3, 0.0, 0.05).unwrap() - 0.05).abs() < 1e-12);
    assert!((friedman_power_finite(30, 3, 0.0, 0.05).unwrap() - 0.05).abs() < 1e-12);
    assert_eq!(friedman_power_finite(30, 3, 1.0, 0.05).unwrap(), 1.0);
    assert!(friedman_power(1_000_000, 3, 0.9, 0.05).unwrap() > 1.0 - 1e-12);
    let people = friedman_people(3, 0.16, 0.05, 0.8).unwrap();
    assert!(friedman_power(people, 3, 0.16, 0.05).unwrap() >= 0.8);
    assert!(friedman_power(people - 1, 3, 0.16, 0.05).unwrap() < 0.8);
}

#[test]
fn a_simulation_is_the_same_on_any_number_of_threads() {
    let run = |threads: usize| -> Simulated {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            simulate(501, 77, 0.05, |seed| friedman(&study(seed, 12, 0.3)).map(|test| test.p)).unwrap()
        })
    };
    let one = run(1);
    assert_eq!([run(2), run(5)], [one; 2]);
    assert!(one.interval[0] < one.power && one.power < one.interval[1]);
}

#[test]
fn the_first_study_that_fails_is_the_error() {
    let failed = simulate(100, 1, 0.05, |seed| {
        let first = Random::new(1).bits();
        if seed == first { Err(Error::Constant { what: "answers", statistic: "p" }) } else { Ok(f64::NAN) }
    });
    assert!(matches!(failed, Err(Error::Constant { .. })), "{failed:?}");
    let nan = simulate(3, 1, 0.05, |_| Ok::<_, Error>(f64::NAN));
    assert!(matches!(nan, Err(Error::Range { what: "p", .. })), "{nan:?}");
}
