//! Published numbers of people: speed by age, and what traits of personality make of the way people avoid others.

use std::collections::BTreeMap;

/// What a trait makes of neighbour distance, number of neighbours, planning horizon, radius and preferred speed: the
/// published parameters of that trait over those of an average person, 15 m, 10, 30, 0.8 m, 1.4 m/s.
///
/// Guy, Kim, Lin, Manocha, "Simulating heterogeneous crowd behaviors using personality trait theory" (SCA 2011): typical
/// parameters of the three traits of Eysenck and of six adjectives, found from a user study. Numbers checked against a
/// public transcription of the paper's tables, not against its pages. The paper's radii are those of agents drawn as
/// they are simulated; ours follow bodies. So what is taken over is the ratio to the average person.
pub const TRAITS: [(&str, [f32; 5]); 9] = [
    ("psychoticism", [15.0, 40.0, 38.0, 0.4, 1.55]),
    ("extraversion", [15.0, 23.0, 32.0, 0.4, 1.55]),
    ("neuroticism", [15.0, 9.0, 29.0, 1.6, 1.25]),
    ("aggressive", [15.0, 20.0, 31.0, 0.6, 1.55]),
    ("assertive", [15.0, 23.0, 32.0, 0.5, 1.55]),
    ("shy", [15.0, 7.0, 30.0, 1.1, 1.25]),
    ("active", [13.0, 17.0, 40.0, 0.4, 1.55]),
    ("tense", [29.0, 63.0, 12.0, 1.6, 1.55]),
    ("impulsive", [30.0, 2.0, 90.0, 0.4, 1.55]),
];

/// The average person of that study.
const AVERAGE: [f32; 5] = [15.0, 10.0, 30.0, 0.8, 1.4];

/// Half the range of each parameter in that study, by which it is normalised.
const HALF_RANGE: [f32; 5] = [13.5, 49.5, 14.5, 0.85, 0.5];

/// Perceived psychoticism, extraversion and neuroticism from the normalised parameters (the study's regression).
const PERCEIVED: [[f32; 5]; 3] =
    [[0.00, 0.08, 0.08, -0.32, 0.63], [-0.02, 0.13, 0.08, -0.22, 1.06], [0.03, -0.01, -0.03, 0.39, -0.37]];

/// How psychotic, extravert and neurotic a walker looks with these parameters, relative to the average person: the linear
/// map of Guy et al. 2011.
///
/// `parameters`: neighbour distance, number of neighbours, planning horizon, radius and preferred speed on the study's
/// scale (15 m, 10, 30, 0.8 m, 1.4 m/s are average). Its inverse is not used to choose parameters: the rows for
/// psychoticism and extraversion are nearly parallel, so a pure trait would need values far outside every range.
pub fn perceived(parameters: [f32; 5]) -> [f32; 3] {
    PERCEIVED.map(|row| {
        let terms = (0..5).map(|k| row[k] * (parameters[k] - AVERAGE[k]) / HALF_RANGE[k]);
        terms.sum()
    })
}

/// Least and greatest speed at an age, m/s (Weidmann 1993, in the bands of a published run of `RiMEA`'s tests: Zhou 2015).
pub fn speed_of_age(years: f32) -> [f32; 2] {
    if years < 30.0 {
        [0.58, 1.61]
    } else if years <= 50.0 {
        [1.41, 1.54]
    } else {
        [0.68, 1.41]
    }
}

/// The five ratios of a trait: those of `own` (`population.traits`), or the published ones.
pub(super) fn ratios(own: &BTreeMap<String, [f32; 5]>, name: &str) -> Option<[f32; 5]> {
    let published = || TRAITS.into_iter().find(|(known, _)| *known == name);
    let relative = |(_, p): (&str, [f32; 5])| std::array::from_fn(|k| p[k] / AVERAGE[k]);
    own.get(name).copied().or_else(|| published().map(relative))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trait_is_perceived_more_with_its_parameters_than_without() {
        for (index, (name, parameters)) in TRAITS.into_iter().take(3).enumerate() {
            assert!(perceived(parameters)[index] > 0.3, "{name}: {:?}", perceived(parameters));
        }
        // the average person looks average
        assert!(perceived(AVERAGE).iter().all(|p| p.abs() < 1e-6));
        let shy = perceived(TRAITS[5].1);
        assert!(shy[1] < -0.2 && shy[2] > 0.1, "{shy:?}");
    }
}
