//! How feelings change in time, and events that rouse them.

#[cfg(feature = "schema")]
use super::population::Range;
use super::population::range;
use super::regions::Point;
use crate::emotion::Emotion;
use serde::{Deserialize, Serialize};

/// How feelings change: everyone catches them from those around and returns to the own state, with which it started.
///
/// The model is the emotion part of ASCRIBE, after Bosse, Duell, Memon, Treur and van der Wal (2009; 2015), applied to the
/// weight of each emotion; `shaders/emotion_update.wgsl` states it. It has not been validated for walking crowds, nor have its
/// numbers: they are to be chosen for a scene. Each of the four traits is one number or `[least, greatest]`, of which
/// every agent draws its own.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct EmotionDynamics {
    /// Feelings pass between people who are nearer than this, the more the nearer, m; 0: they do not.
    pub radius: f32,
    /// How fast they pass, 1/s, for one neighbour at no distance of expressiveness 1 to an agent of openness 1.
    pub contagion: f32,
    /// How fast a feeling returns to the own state, 1/s: half of it in 0.69 over this.
    pub decay: f32,
    /// How much people show of what they feel, 0 to 1 (epsilon).
    #[serde(deserialize_with = "range")]
    #[cfg_attr(feature = "schema", schemars(with = "Range"))]
    pub expressiveness: [f32; 2],
    /// How much they take from what others show, 0 to 1 (delta).
    #[serde(deserialize_with = "range")]
    #[cfg_attr(feature = "schema", schemars(with = "Range"))]
    pub openness: [f32; 2],
    /// Whether they take over what they see (0) or amplify it (1) (eta).
    #[serde(deserialize_with = "range")]
    #[cfg_attr(feature = "schema", schemars(with = "Range"))]
    pub amplification: [f32; 2],
    /// Whether amplification lowers (0) or raises (1) feelings (beta).
    #[serde(deserialize_with = "range")]
    #[cfg_attr(feature = "schema", schemars(with = "Range"))]
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

/// Something that happens at a place and time and rouses an emotion, such as a scare.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
