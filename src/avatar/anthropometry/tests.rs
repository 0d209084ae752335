#![allow(clippy::cast_possible_truncation, reason = "random numbers as f32")]

use super::*;
use crate::random::Random;

/// Normal numbers of a person.
fn numbers<const N: usize>(person: u64) -> [f32; N] {
    let mut random = Random::new(person);
    std::array::from_fn(|_| (0..12).map(|_| random.unit() as f32).sum::<f32>() - 6.0)
}

fn mean_and_deviation(values: impl Iterator<Item = f32> + Clone) -> [f32; 2] {
    let count = values.clone().count() as f32;
    let mean = values.clone().sum::<f32>() / count;
    [mean, (values.map(|x| (x - mean) * (x - mean)).sum::<f32>() / count).sqrt()]
}

/// A thousand adults as in ANSUR II.
fn adults(sex: Sex) -> Vec<Person> {
    (0..1000)
        .map(|number| {
            let [stature, weight] = adult(sex, numbers(number));
            let residuals = correlated(sex, &numbers(number + 5000));
            Person { sex, age: None, stature, weight, residuals }
        })
        .collect()
}

#[test]
fn a_thousand_adults_have_the_means_and_spreads_of_ansur() {
    /// Women and men of ANSUR II, mm: mean and deviation of the measures that were taken, not of what this program makes of them.
    const TAKEN: [(Measure, [f32; 2], [f32; 2]); 8] = [
        (Measure::Chest, [946.9, 82.7], [1058.7, 87.4]),
        (Measure::Waist, [860.9, 99.9], [940.6, 111.7]),
        (Measure::Hips, [1021.2, 75.9], [1019.5, 76.7]),
        (Measure::Thigh, [616.1, 55.8], [625.1, 58.5]),
        (Measure::Calf, [373.3, 28.5], [392.3, 29.7]),
        (Measure::Biceps, [305.6, 30.8], [358.1, 34.6]),
        (Measure::CrotchHeight, [782.3, 44.6], [845.9, 46.5]),
        (Measure::ShoulderBreadth, [365.3, 18.3], [415.7, 19.2]),
    ];
    for sex in Sex::ALL {
        let people = adults(sex);
        let judge = |what: &str, [mean, deviation]: [f32; 2], [want, spread]: [f32; 2]| {
            assert!((mean / want - 1.0).abs() < 0.03, "{sex:?} {what}: {mean} not {want}");
            assert!((deviation / spread - 1.0).abs() < 0.15, "{sex:?} {what}: {deviation} not {spread}");
        };
        let whole = &WHOLE[sex as usize];
        judge("stature", mean_and_deviation(people.iter().map(|p| p.stature)), whole.stature);
        let logs = mean_and_deviation(people.iter().map(|p| libm::logf(p.weight)));
        assert!((logs[0] - whole.log_weight[0]).abs() < 0.03);
        judge("ln weight", logs, whole.log_weight);
        for (measure, women, men) in TAKEN {
            let found = mean_and_deviation(people.iter().map(|p| 1e3 * p.measure(measure)));
            judge(&format!("{measure:?}"), found, [women, men][sex as usize]);
        }
    }
}

#[test]
fn residuals_go_together_as_the_table_has_it() {
    for sex in Sex::ALL {
        let all: Vec<Residuals> = (0..4000).map(|number| correlated(sex, &numbers(number))).collect();
        let mut below = RESIDUALS[sex as usize].iter();
        for row in 0..MEASURES {
            for column in 0..row {
                let product = |r: &Residuals| r[row] * r[column];
                let found = all.iter().map(product).sum::<f32>() / all.len() as f32;
                let want = 0.01 * f32::from(*below.next().unwrap());
                assert!((found - want).abs() < 0.08, "{sex:?} {row} {column}: {found} not {want}");
            }
        }
    }
}

#[test]
fn people_of_every_age_are_as_tall_and_heavy_as_the_tables_say() {
    // NCHS 2021 to 2023 and CDC 2000: years; mean or median stature, cm, and weight, kg, of women and men
    let known = [
        (6.04, [115.4, 20.3], [115.7, 20.8]),
        (14.04, [160.4, 49.5], [164.5, 51.1]),
        (25.0, [161.8, 74.8], [176.3, 86.8]),
        (45.0, [162.0, 80.6], [176.4, 95.3]),
        (75.0, [157.9, 73.7], [172.4, 87.7]),
    ];
    for sex in Sex::ALL {
        for (age, women, men) in known {
            let [want_stature, want_weight] = [women, men][sex as usize];
            let all = (0..2000).map(move |number| of_age(sex, age, numbers(number)));
            let [stature, _] = mean_and_deviation(all.clone().map(|[stature, _]| 100.0 * stature));
            let [weight, _] = mean_and_deviation(all.map(|[_, weight]| weight));
            assert!(
                (stature / want_stature - 1.0).abs() < 0.02,
                "{sex:?} {age}: {stature} not {want_stature}"
            );
            assert!((weight / want_weight - 1.0).abs() < 0.05, "{sex:?} {age}: {weight} not {want_weight}");
        }
    }
}

#[test]
fn girths_follow_age() {
    // waist and hips of men of 70 to 79 years, cm: NCHS 2021 to 2023
    let man = Person { age: Some(75.0), stature: 1.724, weight: 87.7, ..Person::average(Sex::Male, 1.724) };
    let [waist, hips] = [Measure::Waist, Measure::Hips].map(|girth| 100.0 * man.measure(girth));
    assert!((waist - 107.5).abs() < 0.5 && (hips - 105.0).abs() < 0.5, "{waist} {hips}");
    let grown = Person { age: None, ..man };
    let depths = [man, grown].map(|man| man.measure(Measure::WaistDepth));
    assert!(depths[0] > 1.05 * depths[1], "depths grow with girths: {depths:?}");
}

#[test]
fn the_body_mass_index_has_its_mean_and_spread() {
    for sex in Sex::ALL {
        let all = (0..4000).map(move |number| body_mass_index(sex, numbers::<1>(number)[0]));
        let [mean, deviation] = mean_and_deviation(all);
        let [want, spread] = WHOLE[sex as usize].body_mass_index;
        assert!(
            (mean / want - 1.0).abs() < 0.01 && (deviation / spread - 1.0).abs() < 0.05,
            "{mean} {deviation}"
        );
    }
}
