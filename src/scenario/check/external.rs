//! Radii, models and paths of external agents.

use super::ranges::within;
use crate::scenario::error::Error;
use crate::scenario::file::{DAY, ExternalKind, MAX_COORDINATE, Scenario};

/// Most external agents of a scenario.
const MAX_OUTSIDERS: usize = 1024;
/// Most keyframes of a path.
const MAX_KEYFRAMES: usize = 1024;
/// Fastest that an external agent may go, m/s.
pub(crate) const MAX_EXTERNAL_SPEED: f32 = 60.0;

/// Checks radii and paths.
pub(super) fn check(scenario: &Scenario) -> Result<(), Error> {
    if scenario.outsiders.len() > MAX_OUTSIDERS {
        let found = format!("{} outsiders", scenario.outsiders.len());
        return Err(Error::value("outsiders", found, format!("at most {MAX_OUTSIDERS}"), "leave some out"));
    }
    for (index, outsider) in scenario.outsiders.iter().enumerate() {
        let key = |name: &str| format!("outsiders[{index}].{name}");
        within(&key("radius"), outsider.radius(scenario))?;
        within(&key("comfort"), outsider.comfort)?;
        let is_person = outsider.kind == ExternalKind::Person;
        if let Some(file) = outsider.model.as_ref().filter(|file| is_person || file.trim().is_empty()) {
            let allowed = "left out, or for a robot or vehicle the name of a .glb or .gltf file";
            let hint = "people have bodies of their own: population.avatars";
            return Err(Error::value(key("model"), format!("{file:?}"), allowed, hint));
        }
        if let Some(size) = outsider.size {
            for (i, metres) in size.into_iter().enumerate() {
                within(&key(&format!("size[{i}]")), metres)?;
            }
            if outsider.model.is_none() {
                let hint = "without a model it is as large as its radius";
                return Err(Error::value(key("size"), format!("{size:?}"), "left out without a model", hint));
            }
        }
        if outsider.path.len() > MAX_KEYFRAMES {
            let found = format!("{} keyframes", outsider.path.len());
            return Err(Error::value(key("path"), found, format!("at most {MAX_KEYFRAMES}"), "thin it out"));
        }
        let mut before: Option<[f32; 3]> = None;
        for (i, &[time, x, z]) in outsider.path.iter().enumerate() {
            let wrong = |allowed: String, hint: &str| {
                Error::value(
                    format!("outsiders[{index}].path[{i}]"),
                    format!("[{time}, {x}, {z}]"),
                    allowed,
                    hint,
                )
            };
            if !(x.abs() <= MAX_COORDINATE && z.abs() <= MAX_COORDINATE) {
                let allowed = format!("[time, x, z] within {MAX_COORDINATE} m of the origin");
                return Err(wrong(allowed, "shift the scene towards the origin"));
            }
            if !(0.0..=DAY).contains(&time) || before.is_some_and(|[t, ..]| time - t < 0.001) {
                let allowed = format!("a time of 0 to {DAY} s, after the one before");
                return Err(wrong(allowed, "put it in order"));
            }
            if let Some([t, from_x, from_z]) = before {
                let speed = libm::hypotf(x - from_x, z - from_z) / (time - t);
                if speed > MAX_EXTERNAL_SPEED {
                    let allowed = format!("at most {MAX_EXTERNAL_SPEED} m/s (this is {speed:.0})");
                    return Err(wrong(allowed, "give it more time"));
                }
            }
            before = Some([time, x, z]);
        }
    }
    Ok(())
}
