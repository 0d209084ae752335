//! The numbers of a walk: their ranges, mixtures and individuals.

use crate::spelling::{UnknownName, by_name};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Which of the two mean bodies a walker has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[allow(missing_docs, reason = "the variants say it")]
pub enum Sex {
    Female,
    Male,
}

impl Sex {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Female, Self::Male];

    /// Lower-case name, as written in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Female => "female",
            Self::Male => "male",
        }
    }
}

impl fmt::Display for Sex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Sex {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        by_name("sex", &Self::ALL, Self::name, text)
    }
}

/// The walker's body. Segment lengths are shares of the height (Drillis and Contini 1966), widths are given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Standing height of the person with soles and scalp, m. (The foot joint, 0.042 of it up, is y = 0.)
    pub height: f64,
    /// Distance between the shoulder joints as a share of the height.
    pub shoulders: f64,
    /// Distance between the hip joints as a share of the height.
    pub hips: f64,
    /// Length of the arms against that of most people of the height.
    #[serde(default = "of_most")]
    pub arms: f64,
    /// Length of the legs against that of most people of the height; the trunk makes up for it.
    #[serde(default = "of_most")]
    pub legs: f64,
}

/// The length that most people of a height have.
const fn of_most() -> f64 {
    1.0
}

/// Segments as shares of the height.
const THIGH: f64 = 0.245;
const SHANK: f64 = 0.246;
const SPINE: f64 = 0.115;
const CHEST: f64 = 0.175;

impl Body {
    /// The mean body of a sex: 1.62 m or 1.76 m tall.
    pub const fn mean(sex: Sex) -> Self {
        match sex {
            Sex::Female => Self { height: 1.62, shoulders: 0.200, hips: 0.106, arms: 1.0, legs: 1.0 },
            Sex::Male => Self { height: 1.76, shoulders: 0.218, hips: 0.098, arms: 1.0, legs: 1.0 },
        }
    }

    pub(super) fn thigh(&self) -> f64 {
        THIGH * self.height * self.legs
    }
    pub(super) fn shank(&self) -> f64 {
        SHANK * self.height * self.legs
    }
    pub(super) fn leg(&self) -> f64 {
        self.thigh() + self.shank()
    }
    pub(super) fn ankle_height(&self) -> f64 {
        0.042 * self.height
    }
    /// Ball of the foot ahead of the ankle.
    pub(super) fn ball_ahead(&self) -> f64 {
        0.072 * self.height
    }
    /// Rearmost point of the heel on the ground behind the ankle.
    pub(super) fn heel_behind(&self) -> f64 {
        0.037 * self.height
    }
    /// Length of the toes beyond the ball of the foot.
    pub(super) fn toes(&self) -> f64 {
        0.040 * self.height
    }
    pub(super) fn root_above_hips(&self) -> f64 {
        0.022 * self.height
    }
    /// Length of the trunk against that of most people of the height.
    fn trunk(&self) -> f64 {
        1.0 - (self.legs - 1.0) * ((THIGH + SHANK) / (SPINE + CHEST))
    }
    pub(super) fn spine(&self) -> f64 {
        SPINE * self.height * self.trunk()
    }
    pub(super) fn chest(&self) -> f64 {
        CHEST * self.height * self.trunk()
    }
    pub(super) fn neck(&self) -> f64 {
        0.070 * self.height
    }
    pub(super) fn shoulders_below_neck(&self) -> f64 {
        0.022 * self.height
    }
    pub(super) fn upper_arm(&self) -> f64 {
        0.180 * self.height * self.arms
    }
    pub(super) fn forearm(&self) -> f64 {
        0.150 * self.height * self.arms
    }
    pub(super) fn shoulder_width(&self) -> f64 {
        self.shoulders * self.height
    }
    pub(super) fn hip_width(&self) -> f64 {
        self.hips * self.height
    }
}

/// One way of walking. Metres, seconds, radians; angles of the trunk are positive forwards.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WalkerStyle {
    /// The body that walks.
    pub body: Body,
    /// Walking speed, m/s.
    pub speed: f64,
    /// Duration of one stride (two steps), s.
    pub cycle_time: f64,
    /// Share of the stride during which a foot is on the ground; above 0.5 both are for a while.
    pub duty: f64,
    /// Distance between the lines on which the feet walk, m.
    pub step_width: f64,
    /// Height of the ankle at the top of the swing above its height when planted, m.
    pub foot_lift: f64,
    /// How far the foot is held up late in the swing before it comes down, m.
    pub stomp: f64,
    /// Pitch of the foot at toe-off; the knee decides how much of it, and up to a quarter more.
    pub heel_rise: f64,
    /// Knees point outwards: sideways share of the forward direction.
    pub toe_out: f64,
    /// Half the height through which the pelvis goes up and down twice in a usual stride, m: by the legs alone it would be
    /// 0.018. Longer strides bob more.
    pub bounce: f64,
    /// How much lower than straight legs allow the pelvis is carried, m.
    pub crouch: f64,
    /// How far the pelvis moves over the standing leg, m.
    pub sway: f64,
    /// How far the pelvis turns about the vertical to either side.
    pub pelvis_turn: f64,
    /// How far the pelvis drops on the side of the swinging leg.
    pub pelvis_drop: f64,
    /// Forward lean of the trunk as a whole.
    pub lean: f64,
    /// Further forward bend of the upper trunk; negative is chest out.
    pub slump: f64,
    /// Forward bend of the head against the upper trunk.
    pub neck_flexion: f64,
    /// How far trunk and head dip twice a stride.
    pub nod: f64,
    /// How far the shoulders turn against the pelvis to either side.
    pub shoulder_turn: f64,
    /// Shoulders raised, m.
    pub shoulder_lift: f64,
    /// Shoulders pulled forward, m; negative is pulled back.
    pub shoulder_forward: f64,
    /// How far the upper arm swings to either side of its middle.
    pub arm_swing: f64,
    /// Middle of the upper arm's swing, positive in front of the body.
    pub arm_forward: f64,
    /// Upper arms held away from the body.
    pub arm_abduction: f64,
    /// Least bend of the elbow.
    pub elbow_flexion: f64,
    /// Further bend of the elbow when the arm is in front; less where the forearm would rise nearly to the horizontal.
    pub elbow_swing: f64,
    /// The left arm swings by this share more, the right by this share less.
    pub asymmetry: f64,
    /// Both knees bend by so much more all the time.
    pub knee_flexion: f64,
    /// Lean of the trunk to the left.
    pub side_lean: f64,
    /// Turn of the shoulders to the left that stays.
    pub trunk_turn: f64,
    /// Share of the stride by which the arms are later than the legs.
    pub arm_lag: f64,
    /// How far the arms swing inwards when they are in front.
    pub arm_cross: f64,
    /// The left arm swings by so much more to either side, the right by so much less.
    pub swing_asymmetry: f64,
    /// The left arm hangs so much further forward than the right.
    pub forward_asymmetry: f64,
    /// The left arm is held so much further out than the right.
    pub abduction_asymmetry: f64,
    /// The left elbow is bent so much more than the right.
    pub elbow_asymmetry: f64,
}

/// One number of a [`WalkerStyle`]: its name in files, its range and how to reach it.
#[derive(Debug, Clone, Copy)]
#[allow(missing_docs, reason = "the struct's own line says it")]
pub struct StyleField {
    pub name: &'static str,
    pub range: [f64; 2],
    /// How far individuals stray from the preset: share of the value, then absolute, both as the largest deviation.
    stray: [f64; 2],
    pub get: fn(&WalkerStyle) -> f64,
    pub set: fn(&mut WalkerStyle, f64),
}

macro_rules! fields {
    ($($name:literal $($path:ident).+ : $range:expr, stray $stray:expr;)+) => {
        &[$(StyleField {
            name: $name,
            range: $range,
            stray: $stray,
            get: |style| style.$($path).+,
            set: |style, value| style.$($path).+ = value,
        }),+]
    };
}

/// Ranges of what hangs together with something else.
const ARM_FORWARD: [f64; 2] = [-0.5, 0.8];
const FORWARD_ASYMMETRY: [f64; 2] = [-0.6, 0.6];
const NECK_FLEXION: [f64; 2] = [-0.6, 1.0];

/// Every number of a [`WalkerStyle`] in the order in which they are drawn for individuals (new ones go last).
pub const STYLE_FIELDS: &[StyleField] = fields! {
    "body.height" body.height: [0.8, 2.4], stray [0.05, 0.0];
    "body.shoulders" body.shoulders: [0.12, 0.32], stray [0.14, 0.0];
    "body.hips" body.hips: [0.05, 0.2], stray [0.2, 0.0];
    "speed" speed: [0.1, 2.6], stray [0.2, 0.0];
    "cycle_time" cycle_time: [0.5, 3.0], stray [0.1, 0.0];
    "duty" duty: [0.52, 0.75], stray [0.0, 0.014];
    "step_width" step_width: [0.0, 0.5], stray [0.5, 0.0];
    "foot_lift" foot_lift: [0.06, 0.4], stray [0.2, 0.0];
    "stomp" stomp: [0.0, 0.15], stray [0.3, 0.0];
    "heel_rise" heel_rise: [0.0, 1.2], stray [0.05, 0.0];
    "toe_out" toe_out: [-0.5, 0.8], stray [0.0, 0.14];
    "bounce" bounce: [0.0, 0.08], stray [0.15, 0.0];
    "crouch" crouch: [0.0, 0.15], stray [0.3, 0.0];
    "sway" sway: [0.0, 0.1], stray [0.4, 0.0];
    "pelvis_turn" pelvis_turn: [0.0, 0.5], stray [0.5, 0.0];
    "pelvis_drop" pelvis_drop: [0.0, 0.4], stray [0.4, 0.0];
    "lean" lean: [-0.3, 0.6], stray [0.0, 0.15];
    "slump" slump: [-0.4, 0.8], stray [0.15, 0.15];
    "neck_flexion" neck_flexion: NECK_FLEXION, stray [0.0, 0.3];
    "nod" nod: [0.0, 0.2], stray [0.6, 0.0];
    "shoulder_turn" shoulder_turn: [0.0, 0.6], stray [0.7, 0.0];
    "shoulder_lift" shoulder_lift: [-0.06, 0.06], stray [0.0, 0.036];
    "shoulder_forward" shoulder_forward: [-0.08, 0.1], stray [0.0, 0.045];
    "arm_swing" arm_swing: [0.0, 1.2], stray [0.7, 0.08];
    "arm_forward" arm_forward: ARM_FORWARD, stray [0.0, 0.25];
    "arm_abduction" arm_abduction: [0.0, 0.8], stray [0.0, 0.25];
    "elbow_flexion" elbow_flexion: [0.0, 2.2], stray [0.4, 0.2];
    "elbow_swing" elbow_swing: [0.0, 1.5], stray [0.5, 0.22];
    "asymmetry" asymmetry: [-0.6, 0.6], stray [0.0, 0.25];
    "knee_flexion" knee_flexion: [-0.1, 0.3], stray [0.0, 0.06];
    "side_lean" side_lean: [-0.2, 0.2], stray [0.0, 0.18];
    "trunk_turn" trunk_turn: [-0.3, 0.3], stray [0.0, 0.11];
    "arm_lag" arm_lag: [-0.15, 0.2], stray [0.0, 0.18];
    "arm_cross" arm_cross: [-0.3, 0.6], stray [0.0, 0.36];
    "swing_asymmetry" swing_asymmetry: [-0.4, 0.4], stray [0.0, 0.16];
    "forward_asymmetry" forward_asymmetry: FORWARD_ASYMMETRY, stray [0.0, 0.24];
    "abduction_asymmetry" abduction_asymmetry: [-0.4, 0.4], stray [0.0, 0.22];
    "elbow_asymmetry" elbow_asymmetry: [-0.6, 0.6], stray [0.0, 0.2];
    "body.arms" body.arms: [0.85, 1.15], stray [0.14, 0.0];
    "body.legs" body.legs: [0.85, 1.15], stray [0.085, 0.0];
};

impl WalkerStyle {
    /// A blend of styles: every number is the weighted mean (weights need not sum to 1 but their sum must be
    /// positive, else the first style is returned; `None` for an empty list).
    pub fn mix(weighted: &[(Self, f64)]) -> Option<Self> {
        let mut mixed = weighted.first()?.0;
        let total: f64 = weighted.iter().map(|(_, weight)| weight).sum();
        if total > 0.0 && total.is_finite() {
            for field in STYLE_FIELDS {
                let sum: f64 = weighted.iter().map(|(style, weight)| (field.get)(style) * weight).sum();
                (field.set)(&mut mixed, sum / total);
            }
        }
        Some(mixed)
    }

    /// An individual of this style: body and every number vary a little, each independently but for what hangs together.
    /// The same seed and index give the same individual on every machine.
    #[must_use]
    pub fn vary(&self, seed: u64, index: u32) -> Self {
        let mut varied = *self;
        for (draw, field) in (0_u64..).zip(STYLE_FIELDS) {
            let value = (field.get)(self);
            let [share, absolute] = field.stray;
            let stray = (share * value.abs() + absolute) * bell(seed, index, draw);
            (field.set)(&mut varied, (value + stray).clamp(field.range[0], field.range[1]));
        }
        varied.hang_together(self);
        // Who walks faster takes longer and quicker steps alike (Grieve 1968).
        varied.cycle_time *= (self.speed / varied.speed).sqrt();
        // People of longer legs walk faster at the same cadence in proportion to them.
        varied.speed *= varied.body.leg() / self.body.leg();
        let longest = LONGEST_STRIDE * varied.body.leg();
        varied.cycle_time = varied.cycle_time.min(longest / varied.speed);
        varied
    }

    /// Of what an individual differs in from `usual`, some follows from the rest: a forearm held farther forward takes the upper
    /// arm back, and a trunk bent farther forward has arms farther back and a head that is bent back in part.
    fn hang_together(&mut self, usual: &Self) {
        let bent = self.lean + self.slump - usual.lean - usual.slump;
        let elbows = self.elbow_flexion - usual.elbow_flexion;
        let one_elbow = self.elbow_asymmetry - usual.elbow_asymmetry;
        let within = |value: f64, [low, high]: [f64; 2]| value.clamp(low, high);
        self.arm_forward = within(self.arm_forward - HANGING * elbows - BALANCED * bent, ARM_FORWARD);
        self.forward_asymmetry = within(self.forward_asymmetry - HANGING * one_elbow, FORWARD_ASYMMETRY);
        self.neck_flexion = within(self.neck_flexion - LEVELLED * bent, NECK_FLEXION);
    }

    /// Checks every number against its range.
    ///
    /// # Errors
    /// The first number that is outside.
    pub fn check(&self) -> Result<(), OutOfRange> {
        for field in STYLE_FIELDS {
            let value = (field.get)(self);
            let [low, high] = field.range;
            if !(low..=high).contains(&value) {
                return Err(OutOfRange { field: field.name, value, range: field.range });
            }
        }
        Ok(())
    }
}

/// A number of a style is outside of its range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{field} = {value}; it must be {} to {}", range[0], range[1])]
pub struct OutOfRange {
    /// The field, as in [`STYLE_FIELDS`].
    pub field: &'static str,
    /// The value found.
    pub value: f64,
    /// The least and the greatest value allowed.
    pub range: [f64; 2],
}

/// How far an upper arm goes back of what its elbow bends more. Of E-Gait's people of BML and CMU, within one emotion (6 groups of 8
/// to 30), the slopes are -0.8 to -0.2; a hanging arm's weights ask for -0.25 (Winter 2009, table 4.1).
const HANGING: f64 = 0.45;
/// Of a farther bend of the upper trunk, so much is taken back by the upper arms, and so much by the neck. In the same groups the
/// slopes of the arms are -0.5 to -0.3 in five, those of the head's pitch 0.4 to 0.5 in four.
const BALANCED: f64 = 0.4;
const LEVELLED: f64 = 0.55;

/// Longest stride of an individual, legs: heel and toes of longer ones leave the knees too little room.
const LONGEST_STRIDE: f64 = 1.95;

/// A bell-shaped number in [-1, 1] (mean of three uniform ones, doubled spread is cut), by integer hashing.
fn bell(seed: u64, index: u32, draw: u64) -> f64 {
    let key = mixed_bits(seed).wrapping_add(mixed_bits((u64::from(index) << 32) | draw).rotate_left(17));
    let sum: f64 = (0..3).map(|i| unit(mixed_bits(key.wrapping_add(i)))).sum();
    (sum - 1.5) / 1.5
}

/// The upper 53 bits as a number in [0, 1).
#[allow(clippy::cast_precision_loss, reason = "53 bits fit an f64 exactly")]
fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// Scrambles 64 bits (xor-shifts and odd multipliers; a bijection).
fn mixed_bits(value: u64) -> u64 {
    let mut x = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93);
    x = (x ^ (x >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93);
    x ^ (x >> 32)
}
