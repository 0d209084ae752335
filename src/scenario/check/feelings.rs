//! Feelings that change, and events.

use super::ranges::{ends, point, within};
use crate::scenario::error::Error;
use crate::scenario::file::Scenario;

/// Most events of a scenario.
const MAX_EVENTS: usize = 256;

/// Checks both.
pub(super) fn check(scenario: &Scenario) -> Result<(), Error> {
    if let Some(dynamics) = &scenario.emotion_dynamics {
        let key = |name: &str| format!("emotion_dynamics.{name}");
        within(&key("radius"), dynamics.radius)?;
        within(&key("contagion"), dynamics.contagion)?;
        within(&key("decay"), dynamics.decay)?;
        for (name, spread) in [
            ("expressiveness", dynamics.expressiveness),
            ("openness", dynamics.openness),
            ("amplification", dynamics.amplification),
            ("bias", dynamics.bias),
        ] {
            ends(&key(name), spread, "a number or ")?;
        }
    } else if !scenario.events.is_empty() {
        let hint = "add an [emotion_dynamics] table: without one feelings do not change";
        return Err(Error::value("events", "[..]", "left out without emotion_dynamics", hint));
    }
    if scenario.events.len() > MAX_EVENTS {
        let found = format!("{} events", scenario.events.len());
        return Err(Error::value("events", found, format!("at most {MAX_EVENTS}"), "leave some out"));
    }
    for (index, event) in scenario.events.iter().enumerate() {
        let key = |name: &str| format!("events[{index}].{name}");
        within(&key("time"), event.time)?;
        within(&key("duration"), event.duration)?;
        point(&key("place"), event.place)?;
        within(&key("radius"), event.radius)?;
        within(&key("strength"), event.strength)?;
    }
    Ok(())
}
