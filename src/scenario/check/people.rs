//! Classes of people and their traits.

use super::ranges::{count, spread, within};
use crate::scenario::error::Error;
use crate::scenario::file::{Class, Population};
use crate::scenario::personality::{TRAITS, ratios};

/// Checks classes and traits.
pub(super) fn check(population: &Population) -> Result<(), Error> {
    for (name, ratios) in &population.traits {
        for (index, ratio) in ratios.iter().enumerate() {
            let key = format!("population.traits.{name}[{index}]");
            within(&key, *ratio)?;
        }
    }
    for (index, class) in population.classes.iter().enumerate() {
        self::class(population, class, &|field| format!("population.classes[{index}].{field}"))?;
    }
    if !population.classes.is_empty() && population.classes.iter().all(|class| class.share <= 0.0) {
        let hint = "give at least one class a share, such as share = 1.0";
        return Err(Error::value("population.classes", "all shares 0", "a sum above 0", hint));
    }
    Ok(())
}

fn class(population: &Population, class: &Class, key: &dyn Fn(&str) -> String) -> Result<(), Error> {
    within(&key("share"), class.share)?;
    let spreads = [
        ("age", class.age),
        ("speed", class.speed),
        ("radius", class.radius),
        ("time_horizon", class.time_horizon),
        ("neighbour_distance", class.neighbour_distance),
        ("priority", class.priority),
        ("reaction", class.reaction),
    ];
    for (field, given) in spreads {
        given.map_or(Ok(()), |given| spread(&key(field), &given))?;
    }
    if class.speed.is_some() && (class.age.is_some() || class.limited_mobility) {
        let hint = "the age and limited_mobility give a speed too: keep one of them";
        return Err(Error::value(key("speed"), "given", "left out where age or limited_mobility is", hint));
    }
    class.neighbour_cap.map_or(Ok(()), |cap| count(&key("neighbour_cap"), cap))?;
    for (name, given) in &class.personality {
        if ratios(&population.traits, name).is_none() {
            let known: Vec<&str> = TRAITS.iter().map(|(name, _)| *name).collect();
            let hint = format!(
                "nobody has published numbers for others: define it in [population.traits], five ratios to an average \
                 person of neighbour distance, neighbours, horizon, radius, speed; known are {}",
                known.join(", ")
            );
            return Err(Error::value(key("personality"), format!("{name:?}"), "a known trait", hint));
        }
        spread(&key(&format!("personality.{name}")), given)?;
    }
    if let Some(name) = class.avatars.iter().find(|name| !population.avatars.contains(name)) {
        let allowed = format!("one of population.avatars: {}", population.avatars.join(", "));
        return Err(Error::value(key("avatars"), format!("{name:?}"), allowed, "add it there too"));
    }
    Ok(())
}
