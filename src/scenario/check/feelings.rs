//! Feelings that change, and events.

use super::ranges::{point, within};
use crate::scenario::error::Error;
use crate::scenario::file::Scenario;

/// Most events of a scenario.
const MAX_EVENTS: usize = 256;

/// Checks both.
pub(super) fn check(scenario: &Scenario) -> Result<(), Error> {
    if let Some(dynamics) = &scenario.emotion_dynamics {
        let key = |name: &str| format!("emotion_dynamics.{name}");
        within(&key("radius"), dynamics.radius, 0.0, 10.0, "metres; 3 is usual, 0 is no contagion")?;
        within(&key("contagion"), dynamics.contagion, 0.0, 100.0, "1/s; 0.2 is usual")?;
        within(&key("decay"), dynamics.decay, 0.0, 100.0, "1/s; 0.05 is usual, 0 is never")?;
        let traits = [
            ("expressiveness", dynamics.expressiveness),
            ("openness", dynamics.openness),
            ("amplification", dynamics.amplification),
            ("bias", dynamics.bias),
        ];
        for (name, [low, high]) in traits {
            if !(low >= 0.0 && low <= high && high <= 1.0) {
                let allowed = "a number or [least, greatest] within 0 to 1";
                return Err(Error::value(key(name), format!("[{low}, {high}]"), allowed, "try [0.3, 0.9]"));
            }
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
        within(&key("time"), event.time, 0.0, 86_400.0, "seconds since the start")?;
        within(&key("duration"), event.duration, 0.0, 86_400.0, "seconds; 1 to 5 is usual")?;
        point(&key("place"), event.place)?;
        within(&key("radius"), event.radius, 0.1, 10_000.0, "metres; 10 is usual")?;
        within(&key("strength"), event.strength, 0.0, 1.0, "the weight that the emotion gets")?;
    }
    Ok(())
}
