//! Walkers.

use super::ranges::{point, within};
use crate::scenario::error::Error;
use crate::scenario::file::{MAX_AGENTS, Scenario};

/// Most waypoints of one walker.
const MAX_WAYPOINTS: usize = 4096;

/// Checks the walkers of a scenario.
pub(super) fn check(scenario: &Scenario) -> Result<(), Error> {
    let walkers = &scenario.walkers;
    let total = walkers.len() + scenario.population.agents as usize;
    if total > MAX_AGENTS as usize {
        let allowed = format!("at most {MAX_AGENTS} together with population.agents");
        return Err(Error::value("walkers", walkers.len(), allowed, "split the crowd over several runs"));
    }
    for (index, walker) in walkers.iter().enumerate() {
        let key = |name: &str| format!("walkers[{index}].{name}");
        point(&key("position"), walker.position)?;
        if walker.waypoints.len() > MAX_WAYPOINTS {
            let found = walker.waypoints.len();
            return Err(Error::value(
                key("waypoints"),
                found,
                format!("at most {MAX_WAYPOINTS}"),
                "leave some out",
            ));
        }
        for (k, place) in walker.waypoints.iter().enumerate() {
            point(&format!("walkers[{index}].waypoints[{k}]"), *place)?;
        }
        within(&key("arrival"), walker.arrival)?;
        let given =
            [("goal_arrival", walker.goal_arrival), ("radius", walker.radius), ("speed", walker.speed)];
        for (name, value) in given {
            value.map_or(Ok(()), |value| within(&key(name), value))?;
        }
        for (name, [low, high]) in walker.teleport.iter().flat_map(|t| [("from", t.from), ("to", t.to)]) {
            let key = key(&format!("teleport.{name}"));
            point(&key, low)?;
            point(&key, high)?;
            if low[0] > high[0] || low[1] > high[1] {
                let found = format!("{low:?}, {high:?}");
                return Err(Error::value(key, found, "the least corner, then the greatest", "swap them"));
            }
        }
    }
    Ok(())
}
