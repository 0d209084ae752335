//! Classes of people and their traits.

use super::ranges::within;
use crate::scenario::error::Error;
use crate::scenario::file::{Class, MAX_NEIGHBOURS, Population, Spread};
use crate::scenario::personality::{TRAITS, ratios};

/// Checks classes and traits.
pub(super) fn check(population: &Population) -> Result<(), Error> {
    for (name, ratios) in &population.traits {
        for (index, ratio) in ratios.iter().enumerate() {
            let key = format!("population.traits.{name}[{index}]");
            within(&key, *ratio, 0.0, 100.0, "times the value of an average person; 1 changes nothing")?;
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
            self::spread(&spread, &key(field), ends, hint)?;
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
        if ratios(&population.traits, name).is_none() {
            let known: Vec<&str> = TRAITS.iter().map(|(name, _)| *name).collect();
            let hint = format!(
                "nobody has published numbers for others: define it in [population.traits], five ratios to an average \
                 person of neighbour distance, neighbours, horizon, radius, speed; known are {}",
                known.join(", ")
            );
            return Err(Error::value(key("personality"), format!("{name:?}"), "a known trait", hint));
        }
        self::spread(spread, &key(&format!("personality.{name}")), [-1.0, 1.0], "0 is average")?;
    }
    if let Some(name) = class.avatars.iter().find(|name| !population.avatars.contains(name)) {
        let allowed = format!("one of population.avatars: {}", population.avatars.join(", "));
        return Err(Error::value(key("avatars"), format!("{name:?}"), allowed, "add it there too"));
    }
    Ok(())
}

fn spread(spread: &Spread, key: &str, [least, greatest]: [f32; 2], hint: &str) -> Result<(), Error> {
    if let Spread::Normal(n) = spread {
        within(&format!("{key}.deviation"), n.deviation, 0.0, greatest - least, "0 is the same for all")?;
    }
    let [low, high] = spread.ends();
    if low >= least && low <= high && high <= greatest {
        return Ok(());
    }
    let allowed =
        format!("a number, [least, greatest] or {{ mean, deviation }} within {least} to {greatest}");
    Err(Error::value(key, format!("{low} to {high}"), allowed, hint))
}
