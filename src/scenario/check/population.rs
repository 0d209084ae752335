//! Numbers of people, emotions, gaits, groups.

use super::people;
use super::ranges::{count, ends, spread, within};
use crate::scenario::error::Error;
use crate::scenario::file::{Bodies, EmotionMode, GaitChoice, GenderChoice, MAX_GROUP, Population};

pub(super) fn check(population: &Population) -> Result<(), Error> {
    count("population.agents", population.agents)?;
    within("population.expression", population.expression)?;
    population.individuals.map_or(Ok(()), |individuals| within("population.individuals", individuals))?;
    ends("population.scale", population.scale, "")?;
    bodies(&population.bodies)?;
    if population.avatars.is_empty() || population.avatars.len() > 256 {
        let found = format!("{} names", population.avatars.len());
        return Err(Error::value(
            "population.avatars",
            found,
            "1 to 256 names",
            "try [\"female\", \"male\"]",
        ));
    }
    genders(population)?;
    if let Some(index) = population.avatars.iter().position(|name| name.trim().is_empty()) {
        let key = format!("population.avatars[{index}]");
        return Err(Error::value(key, "\"\"", "the name or path of an avatar", "try \"female\" or \"male\""));
    }
    let e = population.emotions;
    for (name, share) in [("happy", e.happy), ("angry", e.angry), ("sad", e.sad), ("neutral", e.neutral)] {
        within(&format!("population.emotions.{name}"), share)?;
    }
    if e.normalised().iter().all(|&share| share <= 0.0) {
        let hint = "give at least one emotion a share, such as neutral = 1.0";
        return Err(Error::value("population.emotions", "all 0", "a sum above 0", hint));
    }
    groups(&population.groups.sizes)?;
    people::check(population)
}

/// Builds.
fn bodies(bodies: &Bodies) -> Result<(), Error> {
    within("population.bodies.variety", bodies.variety)?;
    let spreads = [("ages", &bodies.ages), ("body_mass_index", &bodies.body_mass_index)];
    for (key, given) in spreads {
        if let Some(given) = given {
            spread(&format!("population.bodies.{key}"), given)?;
        }
    }
    Ok(())
}

/// Sizes of groups.
fn groups(sizes: &[f32]) -> Result<(), Error> {
    if sizes.len() > MAX_GROUP {
        let (found, allowed) = (format!("{} shares", sizes.len()), format!("at most {MAX_GROUP}"));
        let hint = "shares of groups of 1, 2, ... people; larger ones split up when they walk";
        return Err(Error::value("population.groups.sizes", found, allowed, hint));
    }
    for (index, &share) in sizes.iter().enumerate() {
        let key = format!("population.groups.sizes[{index}]");
        within(&key, share)?;
    }
    if !sizes.is_empty() && sizes.iter().all(|share| *share <= 0.0) {
        let hint = "try [0.5, 0.35, 0.1, 0.05], or leave population.groups out";
        return Err(Error::value("population.groups.sizes", "all 0", "a sum above 0", hint));
    }
    Ok(())
}

/// Genders of avatars, and what gaits are preferred by.
fn genders(population: &Population) -> Result<(), Error> {
    let (avatars, genders) = (population.avatars.len(), population.avatar_genders.len());
    if genders > 0 && genders != avatars {
        let allowed = format!("one for each of the {avatars} avatars, or left out");
        let hint = "female or male, in the order of population.avatars";
        return Err(Error::value("population.avatar_genders", format!("{genders} genders"), allowed, hint));
    }
    let prefer = &population.prefer;
    let by_avatar = matches!(prefer.gender, GenderChoice::Match | GenderChoice::Counter);
    let unknown = (0..avatars).find(|&avatar| population.gender_of(avatar).is_none()).filter(|_| by_avatar);
    if let Some(name) = unknown.and_then(|avatar| population.avatars.get(avatar)) {
        let found = if prefer.gender == GenderChoice::Match { "match" } else { "counter" };
        let hint = format!("the gender of avatar {name:?} is not known: say it in population.avatar_genders");
        return Err(Error::value("population.prefer.gender", found, "any, female or male", hint));
    }
    prefer.speed.map_or(Ok(()), |speed| ends("population.prefer.speed", speed, "a speed or "))?;
    within("population.prefer.speed_tolerance", prefer.speed_tolerance)?;
    let temperature = prefer.margin_temperature;
    temperature.map_or(Ok(()), |points| within("population.prefer.margin_temperature", points))?;
    if !prefer.is_nothing() && population.gaits != GaitChoice::Random {
        let found = if population.gaits == GaitChoice::Cycle { "cycle" } else { "first" };
        let hint = "or leave population.prefer out";
        return Err(Error::value("population.gaits", found, "random where population.prefer is given", hint));
    }
    affect(population)
}

fn affect(population: &Population) -> Result<(), Error> {
    match (population.emotion_mode, population.affect) {
        (EmotionMode::Affect, None) => {
            let allowed = "draw or blend where population.affect is left out";
            let hint = "add affect = { valence = [-1, 1], arousal = [-1, 1] } to [population]";
            Err(Error::value("population.emotion_mode", "affect", allowed, hint))
        }
        (EmotionMode::Draw | EmotionMode::Blend, Some(_)) => {
            let hint = "it would not be heeded: set emotion_mode = \"affect\"";
            Err(Error::value("population.affect", "{..}", "left out with this emotion_mode", hint))
        }
        (_, None) => Ok(()),
        (_, Some(affect)) => {
            ends("population.affect.valence", affect.valence, "a number or ")?;
            ends("population.affect.arousal", affect.arousal, "a number or ")
        }
    }
}
