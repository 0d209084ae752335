//! Agents that are led from outside: robots, vehicles, tracked people.

use super::casting::Cast;
use super::crowd::AgentStart;
use super::error::Error;
use super::schema::Scenario;
use super::validate::{MAX_COORDINATE, within};
use crate::emotion::Emotion;
use crate::ground::heading_from_ground;
use glam::Vec2;
use serde::{Deserialize, Serialize};

/// Most outsiders of a scenario.
const MAX_OUTSIDERS: usize = 1024;
/// Most keyframes of a path.
const MAX_KEYFRAMES: usize = 1024;
/// Fastest an outsider may go, m/s.
const MAX_SPEED: f32 = 60.0;

/// What an outsider is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OutsiderKind {
    /// Radius 0.4 m unless said otherwise; a cart.
    Robot,
    /// Radius 1 m unless said otherwise; a small car.
    Vehicle,
    /// A person, tracked or played: the crowd's radius, walks with a neutral gait.
    Person,
}

/// Somebody or something that goes its own way, whatever the crowd does; everyone else takes all of the avoidance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outsider {
    /// What it is.
    pub kind: OutsiderKind,
    /// Disc radius, m; left out: as its kind has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f32>,
    /// How much farther away than the radius the crowd stays if it can, m.
    #[serde(default)]
    pub comfort: f32,
    /// What a robot or vehicle looks like: a glTF model beside the scenario, in metres, its front towards +z, standing on
    /// y = 0 about the origin. Left out: as its kind has it, as large as its radius.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// Width (x), height (y), length (z) that the model is scaled to, and put on the ground about its middle, m; left out:
    /// as it is in its file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<[f32; 3]>,
    /// Where it is when: `[time, x, z]`, s and m, times rising; straight in between, at rest before the first and after the
    /// last. Left out: it is not there until `Simulation::lead` says where it is.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub path: Vec<[f32; 3]>,
}

impl Outsider {
    /// Its radius in a scenario, m.
    pub fn radius(&self, scenario: &Scenario) -> f32 {
        self.radius.unwrap_or(match self.kind {
            OutsiderKind::Robot => 0.4,
            OutsiderKind::Vehicle => 1.0,
            OutsiderKind::Person => scenario.navigation.radius,
        })
    }

    /// Where it starts, if it has a path.
    pub fn start(&self) -> Option<Vec2> {
        self.path.first().map(|[_, x, z]| Vec2::new(*x, *z))
    }
}

/// The outsiders as agents; their ids follow those of the crowd.
pub(super) fn cast(scenario: &Scenario, cast: &Cast<'_>) -> Result<Vec<AgentStart>, Error> {
    let first = scenario.population.agents;
    let one = |(index, outsider): (u32, &Outsider)| {
        let way = match outsider.path.as_slice() {
            [[_, x, z], [_, to_x, to_z], ..] => Vec2::new(to_x - x, to_z - z),
            _ => Vec2::Y,
        };
        let mut start = cast.body(first + index, Emotion::Neutral, outsider.kind == OutsiderKind::Person)?;
        start.position = outsider.start().unwrap_or_default();
        start.heading = heading_from_ground(way.normalize_or(Vec2::Y));
        start.radius = outsider.radius(scenario);
        Ok(start)
    };
    (0..).zip(&scenario.outsiders).map(one).collect()
}

/// Checks radii and paths.
pub(super) fn validate(scenario: &Scenario) -> Result<(), Error> {
    if scenario.outsiders.len() > MAX_OUTSIDERS {
        let found = format!("{} outsiders", scenario.outsiders.len());
        return Err(Error::value("outsiders", found, format!("at most {MAX_OUTSIDERS}"), "leave some out"));
    }
    for (index, outsider) in scenario.outsiders.iter().enumerate() {
        let key = |name: &str| format!("outsiders[{index}].{name}");
        within(&key("radius"), outsider.radius(scenario), 0.05, 5.0, "metres; a car is 1 wide each side")?;
        within(&key("comfort"), outsider.comfort, 0.0, 5.0, "metres; 0.5 is usual")?;
        let is_person = outsider.kind == OutsiderKind::Person;
        if let Some(file) = outsider.model.as_ref().filter(|file| is_person || file.trim().is_empty()) {
            let allowed = "left out, or for a robot or vehicle the name of a .glb or .gltf file";
            let hint = "people have bodies of their own: population.avatars";
            return Err(Error::value(key("model"), format!("{file:?}"), allowed, hint));
        }
        if let Some(size) = outsider.size {
            for (axis, metres) in ["width", "height", "length"].iter().zip(size) {
                within(&key("size"), metres, 0.05, 50.0, &format!("metres: {axis}"))?;
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
            if !(0.0..=86_400.0).contains(&time) || before.is_some_and(|[t, ..]| time - t < 0.001) {
                return Err(wrong(
                    "a time of 0 to 86400 s, after the one before".to_owned(),
                    "put it in order",
                ));
            }
            if let Some([t, from_x, from_z]) = before {
                let speed = libm::hypotf(x - from_x, z - from_z) / (time - t);
                if speed > MAX_SPEED {
                    let allowed = format!("at most {MAX_SPEED} m/s (this is {speed:.0})");
                    return Err(wrong(allowed, "give it more time"));
                }
            }
            before = Some([time, x, z]);
        }
    }
    Ok(())
}
