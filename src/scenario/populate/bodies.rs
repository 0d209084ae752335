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
    /// The size, and how the body is built, of an agent with an avatar and a size out of `population.scale`. Avatars of files are
    /// as they are.
    pub(crate) fn build_of(&self, agent: u32, avatar: u32, scale: f32) -> (f32, Build) {
        let name = self.population.avatars.get(avatar as usize);
        let sex = Sex::ALL.into_iter().find(|sex| name.is_some_and(|name| name == sex.name()));
        let person = sex.and_then(|sex| self.person_of(agent, sex, scale));
        let Some(person) = person else { return (scale, Build::default()) };
        let scale = match self.population.bodies.sizes {
            Sizes::Avatar | Sizes::Scale => scale,
            Sizes::Ansur | Sizes::Nhanes => Build::scale(&person).clamp(LEAST_SCALE, MOST_SCALE),
        };
        (scale, Build::of(&person, scale))
    }

    /// Whose measures the body of an agent has; none: the avatar's own.
    fn person_of(&self, agent: u32, sex: Sex, scale: f32) -> Option<Person> {
        let (bodies, seed) = (&self.population.bodies, self.seed);
        let mut draws = SHAPE..;
        let independent = Residuals::default().map(|_| normal(seed, agent, draws.next().unwrap_or(SHAPE)));
        let residuals = correlated(sex, &independent).map(|own| own * bodies.variety);
        let sizes = [0, 1].map(|draw| normal(seed, agent, draw));
        let [_, heavy] = sizes;
        let mut age = None;
        let [stature, weight] = match bodies.sizes {
            Sizes::Avatar => return None,
            Sizes::Scale => {
                let stature = Build::stature_at(sex, scale, residuals[Measure::CrotchHeight as usize]);
                [stature, body_mass_index(sex, heavy) * stature * stature]
            }
            Sizes::Ansur => adult(sex, sizes),
            Sizes::Nhanes => {
                let any = || people::body_age(bodies.ages.unwrap_or(AGES), seed, agent);
                let own = people::age(self, agent).unwrap_or_else(any);
                age = Some(own);
                of_age(sex, own, sizes)
            }
        };
        let wanted = people::body_mass_index(&self.population, seed, agent);
        let weight = wanted.map_or(weight, |index| index * stature * stature);
        Some(Person { sex, age, stature, weight, residuals })
    }
}
