//! How people differ: classes of the population, their spreads, and personality as parameters of the way they avoid others.

use super::error::Error;
use super::population::Population;
use super::random::{Purpose, bits, range, unit};
use super::schema::{Navigation, Scenario};
use super::validate::{MAX_NEIGHBOURS, within};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Most draws until a normally distributed number lies within its bounds; then it is put there.
const TRIES: u32 = 16;

/// A number, or how it is spread over people.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Spread {
    /// The same for all.
    Exactly(f32),
    /// Evenly between least and greatest.
    Between([f32; 2]),
    /// Normally, cut off.
    Normal(Normal),
}

/// A normal distribution, cut off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Normal {
    /// Mean.
    pub mean: f32,
    /// Standard deviation.
    pub deviation: f32,
    /// Least; left out: three deviations below the mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least: Option<f32>,
    /// Greatest; left out: three deviations above the mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub greatest: Option<f32>,
}

impl Spread {
    /// Least and greatest that can be drawn.
    pub fn ends(&self) -> [f32; 2] {
        match *self {
            Self::Exactly(value) => [value; 2],
            Self::Between(ends) => ends,
            Self::Normal(n) => [
                n.least.unwrap_or(n.mean - 3.0 * n.deviation),
                n.greatest.unwrap_or(n.mean + 3.0 * n.deviation),
            ],
        }
    }

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

    fn check(&self, key: &str, [least, greatest]: [f32; 2], hint: &str) -> Result<(), Error> {
        if let Self::Normal(n) = self {
            within(&format!("{key}.deviation"), n.deviation, 0.0, greatest - least, "0 is the same for all")?;
        }
        let [low, high] = self.ends();
        if low >= least && low <= high && high <= greatest {
            return Ok(());
        }
        let allowed =
            format!("a number, [least, greatest] or {{ mean, deviation }} within {least} to {greatest}");
        Err(Error::value(key, format!("{low} to {high}"), allowed, hint))
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
    /// The first trait; the others follow.
    Trait = 10,
}

/// Some of the people, and how they differ from what `[navigation]` says and from one another.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Class {
    /// Name, for people.
    pub name: String,
    /// Share of the agents, relative to the other classes; 0: nobody.
    pub share: f32,
    /// Age, years: gives the speed after Weidmann (1993), see [`speed_of_age`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub age: Option<Spread>,
    /// Walks with difficulty: 0.46 to 0.76 m/s (Weidmann 1993, in test 7 of `RiMEA`).
    #[serde(skip_serializing_if = "is_false")]
    pub limited_mobility: bool,
    /// Preferred speed, m/s; left out: that of the age or else of the gait. The gait is walked at another cadence.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed: Option<Spread>,
    /// Disc radius, m; left out: `navigation.radius` times the size of the body.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<Spread>,
    /// Horizon, s; left out: `navigation.time_horizon`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_horizon: Option<Spread>,
    /// Neighbours are considered up to this distance, m; left out: `navigation.neighbour_distance`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neighbour_distance: Option<Spread>,
    /// Most neighbours considered; left out: `navigation.neighbour_cap`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neighbour_cap: Option<u32>,
    /// Priority, 0 to 1: of two people the one of higher priority takes clamp(0.5 - half the difference) of the avoidance. Where people
    /// press the same way (`navigation.crowding`), a difference of 0.1 counts like 0.2 m further ahead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub priority: Option<Spread>,
    /// Time from the start until the person begins to walk, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reaction: Option<Spread>,
    /// Traits, -1 to 1: names of [`TRAITS`] or of `population.traits`.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub personality: BTreeMap<String, Spread>,
    /// Names of the avatars of this class, out of `population.avatars`; empty: any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub avatars: Vec<String>,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde wants it so")]
fn is_false(value: &bool) -> bool {
    !value
}

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

/// Speeds of people who walk with difficulty, m/s (the same).
const LIMITED_MOBILITY: [f32; 2] = [0.46, 0.76];
/// Range of the factors by which personality may change the radius, and the speed.
const RADIUS_FACTOR: [f32; 2] = [0.5, 2.0];
const SPEED_FACTOR: [f32; 2] = [0.5, 1.5];

/// How an agent deals with others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Manners {
    /// Horizon, s.
    pub time_horizon: f32,
    /// Neighbours are considered up to this distance, m.
    pub neighbour_distance: f32,
    /// Most neighbours considered.
    pub neighbour_cap: u32,
    /// Priority, 0 to 1.
    pub priority: f32,
}

impl Manners {
    /// What the scenario says of everyone.
    pub fn of(navigation: &Navigation) -> Self {
        Self {
            time_horizon: navigation.time_horizon,
            neighbour_distance: navigation.neighbour_distance,
            neighbour_cap: navigation.neighbour_cap,
            priority: 0.0,
        }
    }
}

/// One person of a class.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Person<'a> {
    pub(super) class: Option<&'a Class>,
    pub(super) manners: Manners,
    /// Disc radius, if the class gives one, m.
    pub(super) radius: Option<f32>,
    /// By what personality changes the radius and the speed of the gait.
    pub(super) radius_factor: f32,
    pub(super) speed_factor: f32,
    /// Preferred speed, if age or class give one, m/s.
    pub(super) speed: Option<f32>,
    /// Time until the person walks, s.
    pub(super) reaction: f32,
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
pub(super) fn person(scenario: &Scenario, agent: u32) -> Person<'_> {
    let mut manners = Manners::of(&scenario.navigation);
    let plain = Person {
        class: None,
        manners,
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
    manners.neighbour_distance =
        draw(class.neighbour_distance, Quantity::NeighbourDistance).unwrap_or(manners.neighbour_distance);
    manners.neighbour_distance = (manners.neighbour_distance * factors[0]).clamp(0.5, 50.0);
    let cap = class.neighbour_cap.unwrap_or(manners.neighbour_cap);
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "1 to 10"
    )]
    let capped = (cap as f32 * factors[1] + 0.5).clamp(1.0, MAX_NEIGHBOURS as f32) as u32;
    manners.neighbour_cap = capped;
    manners.time_horizon = draw(class.time_horizon, Quantity::TimeHorizon).unwrap_or(manners.time_horizon);
    manners.time_horizon = (manners.time_horizon * factors[2]).clamp(0.1, 20.0);
    manners.priority = draw(class.priority, Quantity::Priority).unwrap_or(0.0);
    Person {
        class: Some(class),
        manners,
        radius: draw(class.radius, Quantity::Radius),
        radius_factor: factors[3].clamp(RADIUS_FACTOR[0], RADIUS_FACTOR[1]),
        speed_factor: factors[4].clamp(SPEED_FACTOR[0], SPEED_FACTOR[1]),
        speed: draw(class.speed, Quantity::Speed).or_else(|| draw(band, Quantity::AgeSpeed)),
        reaction: draw(class.reaction, Quantity::Reaction).unwrap_or(0.0),
    }
}

/// By what the traits of a class multiply neighbour distance, neighbours, horizon, radius and speed.
fn factors(population: &Population, class: &Class, value: impl Fn(u32, &Spread) -> f32) -> [f32; 5] {
    let mut factors = [1.0_f32; 5];
    for (index, (name, spread)) in (0_u32..).zip(&class.personality) {
        let Some(ratios) = ratios(population, name) else { continue };
        let weight = value(index, spread);
        for (factor, ratio) in factors.iter_mut().zip(ratios) {
            *factor += weight * (ratio - 1.0);
        }
    }
    factors
}

/// The five ratios of a trait: the scenario's own, or those published.
fn ratios(population: &Population, name: &str) -> Option<[f32; 5]> {
    let published = || TRAITS.into_iter().find(|(known, _)| *known == name);
    let relative = |(_, p): (&str, [f32; 5])| std::array::from_fn(|k| p[k] / AVERAGE[k]);
    population.traits.get(name).copied().or_else(|| published().map(relative))
}

impl Person<'_> {
    /// Disc radius of a body of this size, m.
    pub(super) fn radius(&self, navigation: &Navigation, scale: f32) -> f32 {
        match self.class {
            None => navigation.radius * scale,
            Some(_) => self.radius.unwrap_or(navigation.radius * scale) * self.radius_factor,
        }
    }

    /// The avatar, if the class names any: an index into the population's.
    pub(super) fn avatar(&self, scenario: &Scenario, agent: u32) -> Option<u32> {
        let names = &self.class?.avatars;
        let random = bits(scenario.seed, agent, Purpose::Person, Quantity::Avatar as u32 * 1000) as usize;
        let name = names.get(random % names.len().max(1))?;
        let index = scenario.population.avatars.iter().position(|known| known == name)?;
        u32::try_from(index).ok()
    }
}

/// The radius below which everyone's lies, m.
pub(super) fn largest_radius(scenario: &Scenario) -> f32 {
    let (navigation, population) = (&scenario.navigation, &scenario.population);
    let plain = navigation.radius * population.scale[1];
    let of_class = |class: &Class| {
        let own = class.radius.map_or(plain, |spread| spread.ends()[1]);
        // a factor is linear in every trait, so it is greatest at ends
        let mut factor = 1.0;
        for (name, spread) in &class.personality {
            let slope = ratios(population, name).map_or(0.0, |ratios| ratios[3] - 1.0);
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

/// Checks classes and traits.
pub(super) fn validate(population: &Population) -> Result<(), Error> {
    for (name, ratios) in &population.traits {
        for (index, ratio) in ratios.iter().enumerate() {
            let key = format!("population.traits.{name}[{index}]");
            within(&key, *ratio, 0.0, 100.0, "times the value of an average person; 1 changes nothing")?;
        }
    }
    for (index, class) in population.classes.iter().enumerate() {
        check(population, class, &|field| format!("population.classes[{index}].{field}"))?;
    }
    if !population.classes.is_empty() && population.classes.iter().all(|class| class.share <= 0.0) {
        let hint = "give at least one class a share, such as share = 1.0";
        return Err(Error::value("population.classes", "all shares 0", "a sum above 0", hint));
    }
    Ok(())
}

fn check(population: &Population, class: &Class, key: &dyn Fn(&str) -> String) -> Result<(), Error> {
    within(&key("share"), class.share, 0.0, 1e6, "shares are relative: 1 and 1 is half each")?;
    let spreads = [
        ("age", class.age, [3.0, 120.0], "years"),
        ("speed", class.speed, [0.1, 5.0], "people walk at 0.5 to 1.8 m/s"),
        ("radius", class.radius, [0.05, 2.0], "metres; 0.2 is usual"),
        ("time_horizon", class.time_horizon, [0.1, 20.0], "seconds; 2 is usual"),
        ("neighbour_distance", class.neighbour_distance, [0.5, 50.0], "metres; 5 is usual"),
        ("priority", class.priority, [0.0, 1.0], "0 is usual"),
        ("reaction", class.reaction, [0.0, 3600.0], "seconds; [0, 60] is a slow start"),
    ];
    for (field, spread, ends, hint) in spreads {
        if let Some(spread) = spread {
            spread.check(&key(field), ends, hint)?;
        }
    }
    if class.speed.is_some() && (class.age.is_some() || class.limited_mobility) {
        let hint = "the age and limited_mobility give a speed too: keep one of them";
        return Err(Error::value(key("speed"), "given", "left out where age or limited_mobility is", hint));
    }
    if let Some(cap) = class.neighbour_cap
        && !(1..=MAX_NEIGHBOURS).contains(&cap)
    {
        let allowed = format!("1 to {MAX_NEIGHBOURS}");
        return Err(Error::value(key("neighbour_cap"), cap, allowed, "10 is usual"));
    }
    for (name, spread) in &class.personality {
        if ratios(population, name).is_none() {
            let known: Vec<&str> = TRAITS.iter().map(|(name, _)| *name).collect();
            let hint = format!(
                "nobody has published numbers for others: define it in [population.traits], five ratios to an average \
                 person of neighbour distance, neighbours, horizon, radius, speed; known are {}",
                known.join(", ")
            );
            return Err(Error::value(key("personality"), format!("{name:?}"), "a known trait", hint));
        }
        spread.check(&key(&format!("personality.{name}")), [-1.0, 1.0], "0 is average")?;
    }
    if let Some(name) = class.avatars.iter().find(|name| !population.avatars.contains(name)) {
        let allowed = format!("one of population.avatars: {}", population.avatars.join(", "));
        return Err(Error::value(key("avatars"), format!("{name:?}"), allowed, "add it there too"));
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::cast_precision_loss, reason = "tests")]
mod tests;
