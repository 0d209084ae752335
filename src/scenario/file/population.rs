//! The crowd of a scenario file: how many, who they are, how they feel, how they walk.

use super::bodies::{Bodies, MOST_SCALE, Sizes};
use super::people::Class;
use crate::gait::walker::{EXPRESSION, Sex};
use crate::library::choose::SPEED_TOLERANCE;
use serde::{Deserialize, Deserializer, Serialize, de};
use std::collections::BTreeMap;

/// How a gait is chosen out of GEA(e) (S-18).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum GaitChoice {
    /// At random, as in the paper, all alike or as [`Prefer`] weighs them.
    #[default]
    Random,
    /// In turn, by agent index: every gait is used equally often.
    Cycle,
    /// Always the first one.
    First,
}

/// How `emotions` becomes the emotion of one agent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum EmotionMode {
    /// Each agent draws one emotion; `emotions` are the shares (the paper).
    #[default]
    Draw,
    /// Each agent is the same mixture; `emotions` are its weights (S-32).
    Blend,
    /// Each agent is the mixture of its valence and arousal, drawn out of `affect` (S-32).
    Affect,
}

/// What the people of the generated bodies wear.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Clothes {
    /// Each agent its own outfit: tops, jackets, coats, trousers, skirts, shoes, hair, hats, glasses, bags.
    #[default]
    Varied,
    /// All women a short-sleeved top and a skirt, all men long sleeves and trousers; colours differ.
    Plain,
}

/// Which gaits out of GEA(e) are more likely with [`GaitChoice::Random`]; by default all alike, as in the paper.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Prefer {
    /// Least and greatest preferred speed, m/s: each agent draws its own and takes a gait near it. One number: the same
    /// for all. The gait's speed is that of its own walker; size and avatar change it a little. Left out: any speed.
    #[serde(deserialize_with = "maybe_range", skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Range>"))]
    pub speed: Option<[f32; 2]>,
    /// How far around the preferred speed gaits spread (a standard deviation), m/s; 0: the nearest.
    pub speed_tolerance: f32,
    /// Walked by whom, as far as the library knows and has such gaits.
    pub gender: GenderChoice,
    /// Prefer gaits that show the emotion clearly: one whose mean rating of it leads the next emotion by this many points
    /// more is 2.7 times as likely; 0: the clearest always. Left out: clear or not, all are alike.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub margin_temperature: Option<f32>,
}

impl Default for Prefer {
    fn default() -> Self {
        Self {
            speed: None,
            speed_tolerance: SPEED_TOLERANCE,
            gender: GenderChoice::default(),
            margin_temperature: None,
        }
    }
}

impl Prefer {
    #[allow(clippy::float_cmp, reason = "asks whether anything was set")]
    fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// Whether all gaits of an emotion are alike, as in the paper.
    pub fn is_nothing(&self) -> bool {
        self.speed.is_none() && self.gender == GenderChoice::Any && self.margin_temperature.is_none()
    }
}

/// Whose gait an agent walks with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum GenderChoice {
    /// Anyone's.
    #[default]
    Any,
    /// That of a person of the avatar's gender.
    Match,
    /// That of a person of the other gender.
    Counter,
    /// A woman's.
    Female,
    /// A man's.
    Male,
}

/// Where on the circumplex agents feel: least and greatest, or one number, -1 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Affect {
    /// Unpleasant to pleasant.
    #[serde(deserialize_with = "range")]
    #[cfg_attr(feature = "schema", schemars(with = "Range"))]
    pub valence: [f32; 2],
    /// Calm to excited.
    #[serde(deserialize_with = "range")]
    #[cfg_attr(feature = "schema", schemars(with = "Range"))]
    pub arousal: [f32; 2],
}

/// What [`range`] reads.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[schemars(untagged)]
#[allow(dead_code, reason = "a schema alone")]
pub(super) enum Range {
    /// The same for all.
    Exactly(f32),
    /// Least and greatest.
    Between([f32; 2]),
}

/// One number, or least and greatest.
pub(super) fn range<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f32; 2], D::Error> {
    struct Range;

    #[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "settings are f32")]
    impl<'de> de::Visitor<'de> for Range {
        type Value = [f32; 2];

        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str("a number or [least, greatest]")
        }
        fn visit_f64<E>(self, value: f64) -> Result<Self::Value, E> {
            Ok([value as f32; 2])
        }
        fn visit_i64<E>(self, value: i64) -> Result<Self::Value, E> {
            Ok([value as f32; 2])
        }
        fn visit_seq<A: de::SeqAccess<'de>>(self, mut sequence: A) -> Result<Self::Value, A::Error> {
            let mut ends = Vec::new();
            while let Some(end) = sequence.next_element::<f32>()? {
                ends.push(end);
            }
            <[f32; 2]>::try_from(ends).map_err(|ends| de::Error::invalid_length(ends.len(), &self))
        }
    }
    deserializer.deserialize_any(Range)
}

fn maybe_range<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<[f32; 2]>, D::Error> {
    range(deserializer).map(Some)
}

/// Most agents of one scenario.
pub const MAX_AGENTS: u32 = 1_000_000;
/// Most people who walk together.
pub const MAX_GROUP: usize = 5;

#[allow(clippy::float_cmp, clippy::trivially_copy_pass_by_ref, reason = "was anything set? as serde asks")]
fn is_usual(expression: &f32) -> bool {
    f64::from(*expression) == EXPRESSION
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde asks")]
fn is_default_clothes(clothes: &Clothes) -> bool {
    *clothes == Clothes::default()
}

/// The crowd.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Population {
    /// How many agents, 0 to 1,000,000: all that there are at any time, with those of the sources.
    pub agents: u32,
    /// Share of the agents that are there from the start, 0 to 1; left out: 1 without sources, 0 with them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub present: Option<f32>,
    /// How a gait is chosen.
    pub gaits: GaitChoice,
    /// How strongly the generated gaits and the faces show their emotion: 0 not at all, 1 as people do who are perceived so, 2 as
    /// actors do, 3 as on a stage. Gaits of a library are walked as they are.
    #[serde(skip_serializing_if = "is_usual")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = EXPRESSION)))]
    pub expression: f32,
    /// Whether faces show the emotion, too. Left out: yes, but not in a study, whose people show it by gait and gaze alone. In the
    /// baseline and with `gaze.mode = "paper"` faces are at rest whatever this says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub faces: Option<bool>,
    /// How much each agent differs from the person whose gait it walks with: 0 not at all, 1 as people differ. Left out: 1 of the
    /// generated gaits; 0 of a library, whose gaits are walked as they are, and of the baseline, which has one gait for all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub individuals: Option<f32>,
    /// What `emotions` means.
    pub emotion_mode: EmotionMode,
    /// Least and greatest body size relative to the avatar.
    pub scale: [f32; 2],
    /// How tall, heavy and built the people of the generated bodies are; avatars of files keep their shape.
    #[serde(skip_serializing_if = "Bodies::is_default")]
    pub bodies: Bodies,
    /// What they wear. Left out: each an outfit of its own.
    #[serde(skip_serializing_if = "is_default_clothes")]
    pub clothes: Clothes,
    /// The avatars in use: `female`, `male`, or the path of a rigged glTF or VRM file beside the scenario's.
    pub avatars: Vec<String>,
    /// Files beside the scenario's that name the joints of avatars whose rigs are not recognised.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rig_maps: Vec<String>,
    /// Gender of each avatar, in their order; left out: that of the built-in ones is known, that of files is not.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub avatar_genders: Vec<Sex>,
    /// Share (or weight) of each emotion; any scale, left out means 0.
    pub emotions: Shares,
    /// Where agents feel; given with `emotion_mode = "affect"`, else left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub affect: Option<Affect>,
    /// Which gaits out of GEA(e) are more likely.
    #[serde(skip_serializing_if = "Prefer::is_default")]
    pub prefer: Prefer,
    /// Who walks together.
    #[serde(skip_serializing_if = "Groups::is_default")]
    pub groups: Groups,
    /// Traits of personality besides the published ones: ratios to an average person of neighbour distance, neighbours,
    /// horizon, radius, speed.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub traits: BTreeMap<String, [f32; 5]>,
    /// Kinds of people; none: all are alike but for their size and gait.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub classes: Vec<Class>,
}

/// Groups that walk together (`shaders/group_cohesion.wgsl`).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Groups {
    /// Shares of groups (not of people) of one, two, ... five; any scale, left out means 0. Empty: everyone walks alone.
    pub sizes: Vec<f32>,
}

impl Groups {
    fn is_default(&self) -> bool {
        self.sizes.is_empty()
    }
}

impl Population {
    /// The greatest size of a body over its avatar's.
    pub(crate) fn largest_scale(&self) -> f32 {
        let [_, most] = self.scale;
        match self.bodies.sizes {
            Sizes::Avatar | Sizes::Scale => most,
            Sizes::Ansur | Sizes::Nhanes => most.max(MOST_SCALE),
        }
    }

    /// The gender of an avatar, if it is known.
    pub fn gender_of(&self, avatar: usize) -> Option<Sex> {
        match self.avatar_genders.get(avatar) {
            Some(gender) => Some(*gender),
            None => Sex::ALL
                .into_iter()
                .find(|sex| self.avatars.get(avatar).is_some_and(|name| name == sex.name())),
        }
    }
}

impl Default for Population {
    fn default() -> Self {
        Self {
            agents: 8,
            present: None,
            gaits: GaitChoice::default(),
            #[allow(clippy::cast_possible_truncation, reason = "2")]
            expression: EXPRESSION as f32,
            faces: None,
            individuals: None,
            clothes: Clothes::default(),
            emotion_mode: EmotionMode::default(),
            scale: [0.93, 1.07],
            bodies: Bodies::default(),
            avatars: vec!["female".into(), "male".into()],
            rig_maps: Vec::new(),
            avatar_genders: Vec::new(),
            emotions: Shares { happy: 1.0, angry: 1.0, sad: 1.0, neutral: 1.0 },
            affect: None,
            prefer: Prefer::default(),
            groups: Groups::default(),
            traits: BTreeMap::new(),
            classes: Vec::new(),
        }
    }
}

/// One number per emotion.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Shares {
    /// Share of people who look happy; left out: 0.
    pub happy: f32,
    /// Share of people who look angry; left out: 0.
    pub angry: f32,
    /// Share of people who look sad; left out: 0.
    pub sad: f32,
    /// Share of people who look neutral; left out: 0.
    pub neutral: f32,
}

/// Text that is no [`Shares`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SharesError {
    /// A share is no number.
    #[error("{found:?}: {reason}")]
    Number {
        /// What stands in its place.
        found: String,
        /// Why that is none.
        reason: std::num::ParseFloatError,
    },
    /// A share is out of range.
    #[error("{name} = {share}: a share is 0 to 1000000")]
    Range {
        /// The emotion.
        name: String,
        /// The share.
        share: f32,
    },
    /// A name is no emotion's.
    #[error("{name:?} is no emotion; use happy, angry, sad or neutral")]
    Emotion {
        /// The name.
        name: String,
    },
    /// All shares are 0.
    #[error("all shares are 0; give at least one emotion a share, such as happy=1")]
    Zero,
}

impl std::str::FromStr for Shares {
    type Err = SharesError;

    /// `happy=1,sad=0.5`: those left out are 0, a name alone is 1.
    fn from_str(text: &str) -> Result<Self, SharesError> {
        let mut shares = Self::default();
        for part in text.split(',') {
            let (name, share) = part.split_once('=').unwrap_or((part, "1"));
            let number = share.trim().parse();
            let share: f32 =
                number.map_err(|reason| SharesError::Number { found: share.to_owned(), reason })?;
            if !(0.0..=1e6).contains(&share) {
                return Err(SharesError::Range { name: name.trim().to_owned(), share });
            }
            match name.trim() {
                "happy" => shares.happy = share,
                "angry" => shares.angry = share,
                "sad" => shares.sad = share,
                "neutral" => shares.neutral = share,
                _ => return Err(SharesError::Emotion { name: name.to_owned() }),
            }
        }
        if shares.normalised().iter().all(|share| *share <= 0.0) {
            return Err(SharesError::Zero);
        }
        Ok(shares)
    }
}

impl Shares {
    /// In the order of [`crate::Emotion::ALL`], scaled to sum 1 (all zero if they sum to 0).
    pub fn normalised(self) -> [f32; 4] {
        let raw = [self.happy, self.angry, self.sad, self.neutral];
        let sum: f32 = raw.iter().sum();
        if sum > 0.0 { raw.map(|share| share / sum) } else { [0.0; 4] }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;

    #[test]
    fn shares_are_read_and_wrong_ones_refused_with_the_way_out() {
        let read = |text: &str| text.parse::<Shares>();
        assert_eq!(read("happy=1, sad=0.5").unwrap(), Shares { happy: 1.0, sad: 0.5, ..Shares::default() });
        assert_eq!(read("angry").unwrap(), Shares { angry: 1.0, ..Shares::default() });
        assert!(read("cheerful=1").unwrap_err().to_string().contains("happy, angry"));
        assert!(read("happy=0,sad=0").unwrap_err().to_string().contains("happy=1"));
        for wrong in ["happy=x", "happy=-1", "happy=nan", "happy=1e9", ""] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
