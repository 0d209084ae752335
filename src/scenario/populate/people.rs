//! What each person of a class is like: numbers drawn from its spreads, changed by personality.

use super::crowd::Avoidance;
use crate::scenario::file::{Class, MAX_NEIGHBOURS, Navigation, Population, Scenario, Spread};
use crate::scenario::personality::{ratios, speed_of_age};
use crate::scenario::random::{Purpose, bits, range, unit};

/// Most draws until a normally distributed number lies within its bounds; then it is put there.
const TRIES: u32 = 16;

impl Spread {
    /// The number of one agent; `stream` tells its quantities apart.
    fn draw(&self, seed: u64, agent: u32, stream: Quantity) -> f32 {
        let first = stream as u32 * 1000;
        let [low, high] = self.ends();
        match self {
            Self::Exactly(value) => *value,
            Self::Between(_) => range(seed, agent, Purpose::Person, first, low, high),
            Self::Normal(n) => {
                // the sum of twelve evenly spread numbers, less 6: no logarithm, so the same on every machine
                let normal = |attempt: u32| {
                    let terms = (0..12).map(|k| unit(seed, agent, Purpose::Person, first + attempt * 12 + k));
                    n.mean + n.deviation * (terms.sum::<f32>() - 6.0)
                };
                let mut drawn = (0..TRIES).map(normal);
                drawn.find(|x| (low..=high).contains(x)).unwrap_or(n.mean).clamp(low, high)
            }
        }
    }
}

impl Scenario {
    /// The class of an agent, by index; none where there are no classes.
    pub fn class_of(&self, agent: u32) -> Option<&Class> {
        class_of(self, agent)
    }
}

/// What is drawn for a person, each from its own stream.
#[derive(Debug, Clone, Copy)]
#[repr(u32)]
enum Quantity {
    Class = 0,
    Age = 1,
    Speed = 2,
    Radius = 3,
    TimeHorizon = 4,
    NeighbourDistance = 5,
    Priority = 6,
    Reaction = 7,
    Avatar = 8,
    AgeSpeed = 9,
    /// The traits, each with a seed of its own.
    Trait = 10,
    BodyAge = 11,
    BodyMassIndex = 12,
}

/// Speeds of people who walk with difficulty, m/s (the same).
const LIMITED_MOBILITY: [f32; 2] = [0.46, 0.76];
/// Range of the factors by which personality may change the radius, and the speed.
const RADIUS_FACTOR: [f32; 2] = [0.5, 2.0];
const SPEED_FACTOR: [f32; 2] = [0.5, 1.5];

/// One person of a class.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Person<'a> {
    pub(crate) class: Option<&'a Class>,
    pub(crate) avoidance: Avoidance,
    /// Disc radius, if the class gives one, m.
    pub(crate) radius: Option<f32>,
    /// By what personality changes the radius and the speed of the gait.
    pub(crate) radius_factor: f32,
    pub(crate) speed_factor: f32,
    /// Preferred speed, if age or class give one, m/s.
    pub(crate) speed: Option<f32>,
    /// Time until the person walks, s.
    pub(crate) reaction: f32,
}

/// The class of an agent; none where there are no classes.
fn class_of(scenario: &Scenario, agent: u32) -> Option<&Class> {
    let classes = &scenario.population.classes;
    let total: f32 = classes.iter().map(|class| class.share).sum();
    let mut left = total * unit(scenario.seed, agent, Purpose::Person, Quantity::Class as u32);
    let drawn = classes.iter().find(|class| {
        left -= class.share;
        left < 0.0
    });
    drawn.or_else(|| classes.iter().rfind(|class| class.share > 0.0))
}

/// What an agent is like, from the seed and its number alone.
pub(crate) fn person(scenario: &Scenario, agent: u32) -> Person<'_> {
    let mut avoidance = Avoidance::of(&scenario.navigation);
    let plain = Person {
        class: None,
        avoidance,
        radius: None,
        radius_factor: 1.0,
        speed_factor: 1.0,
        speed: None,
        reaction: 0.0,
    };
    let Some(class) = class_of(scenario, agent) else { return plain };
    let draw = |spread: Option<Spread>, stream| spread.map(|s| s.draw(scenario.seed, agent, stream));
    let by_age = draw(class.age, Quantity::Age).map(speed_of_age);
    let band = class.limited_mobility.then_some(LIMITED_MOBILITY).or(by_age).map(Spread::Between);
    let factors = factors(&scenario.population, class, |index, spread| {
        // streams of one trait lie apart by more than the draws of a spread
        let stream = scenario.seed ^ (u64::from(index) << 32);
        spread.draw(stream, agent, Quantity::Trait)
    });
    avoidance.neighbour_distance =
        draw(class.neighbour_distance, Quantity::NeighbourDistance).unwrap_or(avoidance.neighbour_distance);
    avoidance.neighbour_distance = (avoidance.neighbour_distance * factors[0]).clamp(0.5, 50.0);
    let cap = class.neighbour_cap.unwrap_or(avoidance.neighbour_cap);
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "1 to 10"
    )]
    let capped = (cap as f32 * factors[1] + 0.5).clamp(1.0, MAX_NEIGHBOURS as f32) as u32;
    avoidance.neighbour_cap = capped;
    avoidance.time_horizon =
        draw(class.time_horizon, Quantity::TimeHorizon).unwrap_or(avoidance.time_horizon);
    avoidance.time_horizon = (avoidance.time_horizon * factors[2]).clamp(0.1, 20.0);
    avoidance.priority = draw(class.priority, Quantity::Priority).unwrap_or(0.0);
    Person {
        class: Some(class),
        avoidance,
        radius: draw(class.radius, Quantity::Radius),
        radius_factor: factors[3].clamp(RADIUS_FACTOR[0], RADIUS_FACTOR[1]),
        speed_factor: factors[4].clamp(SPEED_FACTOR[0], SPEED_FACTOR[1]),
        speed: draw(class.speed, Quantity::Speed).or_else(|| draw(band, Quantity::AgeSpeed)),
        reaction: draw(class.reaction, Quantity::Reaction).unwrap_or(0.0),
    }
}

/// The age of an agent, if its class gives one, years.
pub(super) fn age(scenario: &Scenario, agent: u32) -> Option<f32> {
    let age = class_of(scenario, agent)?.age?;
    Some(age.draw(scenario.seed, agent, Quantity::Age))
}

/// The age of a body whose class gives none, years.
pub(super) fn body_age(spread: Spread, seed: u64, agent: u32) -> f32 {
    spread.draw(seed, agent, Quantity::BodyAge)
}

/// The body-mass index that the population asks of an agent, kg/m².
pub(super) fn body_mass_index(population: &Population, seed: u64, agent: u32) -> Option<f32> {
    population.bodies.body_mass_index.map(|spread| spread.draw(seed, agent, Quantity::BodyMassIndex))
}

/// By what the traits of a class multiply neighbour distance, neighbours, horizon, radius and speed.
fn factors(population: &Population, class: &Class, value: impl Fn(u32, &Spread) -> f32) -> [f32; 5] {
    let mut factors = [1.0_f32; 5];
    for (index, (name, spread)) in (0_u32..).zip(&class.personality) {
        let Some(ratios) = ratios(&population.traits, name) else { continue };
        let weight = value(index, spread);
        for (factor, ratio) in factors.iter_mut().zip(ratios) {
            *factor += weight * (ratio - 1.0);
        }
    }
    factors
}

impl Person<'_> {
    /// Disc radius of a body of this size, m.
    pub(crate) fn radius(&self, navigation: &Navigation, scale: f32) -> f32 {
        match self.class {
            None => navigation.radius * scale,
            Some(_) => self.radius.unwrap_or(navigation.radius * scale) * self.radius_factor,
        }
    }

    /// The avatar, if the class names any: an index into the population's.
    pub(crate) fn avatar(&self, scenario: &Scenario, agent: u32) -> Option<u32> {
        let names = &self.class?.avatars;
        let random = bits(scenario.seed, agent, Purpose::Person, Quantity::Avatar as u32 * 1000) as usize;
        let name = names.get(random % names.len().max(1))?;
        let index = scenario.population.avatars.iter().position(|known| known == name)?;
        u32::try_from(index).ok()
    }
}

/// The radius below which everyone's lies, m.
pub(crate) fn largest_radius(scenario: &Scenario) -> f32 {
    let (navigation, population) = (&scenario.navigation, &scenario.population);
    let plain = navigation.radius * population.largest_scale();
    let of_class = |class: &Class| {
        let own = class.radius.map_or(plain, |spread| spread.ends()[1]);
        // a factor is linear in every trait, so it is greatest at ends
        let mut factor = 1.0;
        for (name, spread) in &class.personality {
            let slope = ratios(&population.traits, name).map_or(0.0, |ratios| ratios[3] - 1.0);
            let [low, high] = spread.ends();
            factor += (low * slope).max(high * slope);
        }
        own * if class.personality.is_empty() {
            1.0
        } else {
            factor.clamp(RADIUS_FACTOR[0], RADIUS_FACTOR[1])
        }
    };
    let used = population.classes.iter().filter(|class| class.share > 0.0).map(of_class);
    used.reduce(f32::max).unwrap_or(plain)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::cast_precision_loss, reason = "tests")]
mod tests;
