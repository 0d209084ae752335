//! How agents are built.

use super::people;
use crate::avatar::Sex;
use crate::avatar::anthropometry::{
    Build, Measure, Person, Residuals, adult, body_mass_index, correlated, of_age,
};
use crate::scenario::file::{LEAST_SCALE, MOST_SCALE, Scenario, Sizes, Spread};
use crate::scenario::random::{Purpose, bits};

/// Ages where neither a class nor `population.bodies` has any, years: the tables' decades.
const AGES: Spread = Spread::Between([20.0, 79.0]);

/// The first draws are of stature and weight.
const SHAPE: u32 = 2;

/// A normal number of an agent: the sum of four bytes, scaled. It stays within 3.5 deviations.
fn normal(seed: u64, agent: u32, draw: u32) -> f32 {
    /// Mean and deviation of that sum.
    const SUM: [f32; 2] = [510.0, 147.8];
    let bytes = bits(seed, agent, Purpose::Build, draw).to_le_bytes();
    let sum: u16 = bytes.into_iter().map(u16::from).sum();
    let [mean, deviation] = SUM;
    (f32::from(sum) - mean) / deviation
}

impl Scenario {
    /// The size, and how the body is built, of an agent with an avatar and a size out of `population.scale`.
    pub(crate) fn build_of(&self, agent: u32, avatar: u32, scale: f32) -> (f32, Build) {
        build(self, agent, avatar, scale)
    }
}

fn build(scenario: &Scenario, agent: u32, avatar: u32, scale: f32) -> (f32, Build) {
    let (population, seed) = (&scenario.population, scenario.seed);
    let bodies = &population.bodies;
    let name = population.avatars.get(avatar as usize);
    let sex = Sex::ALL.into_iter().find(|sex| name.is_some_and(|name| name == sex.name()));
    let Some(sex) = sex.filter(|_| bodies.sizes != Sizes::Avatar) else { return (scale, Build::default()) };
    let sizes = [0, 1].map(|draw| normal(seed, agent, draw));
    let [_, heavy] = sizes;
    let independent: Residuals = std::array::from_fn(|number| normal(seed, agent, SHAPE + number as u32));
    let residuals = correlated(sex, &independent).map(|own| own * bodies.variety);
    let age = people::age(scenario, agent)
        .unwrap_or_else(|| people::body_age(bodies.ages.unwrap_or(AGES), seed, agent));
    let [stature, weight] = match bodies.sizes {
        Sizes::Avatar | Sizes::Scale => {
            let stature = Build::stature_at(sex, scale, residuals[Measure::CrotchHeight as usize]);
            [stature, body_mass_index(sex, heavy) * stature * stature]
        }
        Sizes::Ansur => adult(sex, sizes),
        Sizes::Nhanes => of_age(sex, age, sizes),
    };
    let weight =
        people::body_mass_index(population, seed, agent).map_or(weight, |index| index * stature * stature);
    let age = (bodies.sizes == Sizes::Nhanes).then_some(age);
    let person = Person { sex, age, stature, weight, residuals };
    let scale = if bodies.sizes == Sizes::Scale {
        scale
    } else {
        Build::scale(&person).clamp(LEAST_SCALE, MOST_SCALE)
    };
    (scale, Build::of(&person, scale))
}
