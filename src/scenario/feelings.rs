//! How feelings change in time, and events that rouse them.

use super::error::Error;
use super::population::range;
use super::random::{Purpose, range as drawn};
use super::schema::{Point, Scenario};
use super::validate::{point, within};
use crate::emotion::Emotion;
use serde::{Deserialize, Serialize};

/// Most events of a scenario.
const MAX_EVENTS: usize = 256;

/// How feelings change: everyone catches them from those around and returns to the own state, with which it started.
///
/// The model is the emotion part of ASCRIBE, after Bosse, Duell, Memon, Treur and van der Wal (2009; 2015), applied to the
/// weight of each emotion; `shaders/emotion_update.wgsl` states it. It has not been validated for walking crowds, nor have its
/// numbers: they are to be chosen for a scene. Each of the four traits is one number or `[least, greatest]`, of which
/// every agent draws its own.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct EmotionDynamics {
    /// Feelings pass between people who are nearer than this, the more the nearer, m; 0: they do not.
    pub radius: f32,
    /// How fast they pass, 1/s, for one neighbour at no distance of expressiveness 1 to somebody of openness 1.
    pub contagion: f32,
    /// How fast a feeling returns to the own state, 1/s: half of it in 0.69 over this.
    pub decay: f32,
    /// How much people show of what they feel, 0 to 1 (epsilon).
    #[serde(deserialize_with = "range")]
    pub expressiveness: [f32; 2],
    /// How much they take from what others show, 0 to 1 (delta).
    #[serde(deserialize_with = "range")]
    pub openness: [f32; 2],
    /// Whether they take over what they see (0) or amplify it (1) (eta).
    #[serde(deserialize_with = "range")]
    pub amplification: [f32; 2],
    /// Whether amplification lowers (0) or raises (1) feelings (beta).
    #[serde(deserialize_with = "range")]
    pub bias: [f32; 2],
}

impl Default for EmotionDynamics {
    fn default() -> Self {
        Self {
            radius: 3.0,
            contagion: 0.2,
            decay: 0.05,
            expressiveness: [0.3, 0.9],
            openness: [0.3, 0.9],
            amplification: [0.0; 2],
            bias: [0.5; 2],
        }
    }
}

impl EmotionDynamics {
    /// Expressiveness, openness, amplification and bias of an agent.
    pub fn character(&self, seed: u64, agent: u32) -> [f32; 4] {
        let traits = [self.expressiveness, self.openness, self.amplification, self.bias];
        let mut drawn_traits = [0.0; 4];
        for ((draw, [low, high]), own) in (0..).zip(traits).zip(&mut drawn_traits) {
            *own = drawn(seed, agent, Purpose::Temperament, draw, low, high);
        }
        drawn_traits
    }
}

/// Something that happens at a place and time and rouses an emotion, such as a scare.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// When it begins, s.
    pub time: f32,
    /// How long it lasts, s.
    pub duration: f32,
    /// Where, on the ground, m.
    pub place: Point,
    /// How far it reaches, m.
    pub radius: f32,
    /// The emotion it rouses. There are the paper's four; a scare is best told as `angry`, the excited, unpleasant one.
    pub emotion: Emotion,
    /// The weight of the emotion that it rouses where it happens, 0 to 1, falling to 0 at the radius.
    pub strength: f32,
}

/// Checks both.
pub(super) fn validate(scenario: &Scenario) -> Result<(), Error> {
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
