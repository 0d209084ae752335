//! The 29 expressive features of a gait: 13 of posture, 16 of movement.
//!
//! A gait in, 29 numbers out, in metres, seconds and degrees. [`FEATURES`] names them. Paper: section 3.4; S-11, S-12,
//! formulas: `variants.rs`. A [`Gait`] walks on the spot; velocities are those over the
//! ground, so its travel is added again: they carry arousal, and the paper does not subtract it.
//!
//! The same in f32 for many gaits at once is the kernel `gait_features`, which takes a [`Batch`].

mod variants;

use crate::gait::{Gait, JOINT_COUNT};
use crate::kernels::layout::GaitEntry;
use crate::spelling::{UnknownName, by_name};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Number of features.
pub const FEATURE_COUNT: usize = 29;

/// Frames per second before differencing, Hz: E-Gait's own, and the lowest rate in common use, so that no data
/// set has to be guessed at between its frames.
#[doc(hidden)]
pub const RATE: f64 = 30.0;

/// Resampling makes no more than this many frames of one: at RATE, recordings down to 7.5 Hz.
const MOST_UPSAMPLING: usize = 4;
/// Fewest frames that a third difference makes sense of.
const FEWEST_FRAMES: usize = 4;

/// What a feature is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Feature {
    /// Name, as written in files.
    pub name: &'static str,
    /// Unit of the variants [`Variant::Paper`] and [`Variant::Corrected`].
    pub unit: &'static str,
    /// Formula.
    pub formula: &'static str,
}

const fn feature(name: &'static str, unit: &'static str, formula: &'static str) -> Feature {
    Feature { name, unit, formula }
}

/// The features by index. Angles are those between two vectors; all but the stride length and the cycle time are means
/// over the frames of the cycle.
///
/// | # | name | unit | formula |
/// | --- | --- | --- | --- |
/// | 1 | `volume` | m3 | box around the 16 joints, walking direction along z |
/// | 2 | `neck_angle_shoulders` | deg | right shoulder - neck, left shoulder - neck |
/// | 3 | `right_shoulder_angle` | deg | neck - right shoulder, left shoulder - right shoulder |
/// | 4 | `left_shoulder_angle` | deg | neck - left shoulder, right shoulder - left shoulder |
/// | 5 | `back_angle_vertical` | deg | head - root, up (`paper`: neck - root, up) |
/// | 6 | `neck_angle_head_back` | deg | head - neck, spine - neck |
/// | 7 to 10 | `right_hand_root_distance`, left, `right_foot_...`, left | m | distance to the root |
/// | 11 | `hands_neck_area` | m2 | triangle of left hand, neck, right hand |
/// | 12 | `feet_root_area` | m2 | triangle of left foot, root, right foot |
/// | 13 | `stride_length` | m | largest distance between the feet (equation 2) |
/// | 14 to 18 | `right_hand_speed`, `left_hand_...`, `head_...`, `right_foot_...`, `left_foot_...` | m/s | length of the first difference over dt |
/// | 19 to 23 | the same `_acceleration` | m/s2 | length of the second difference over dt^2 |
/// | 24 to 28 | the same `_jerk` | m/s3 | length of the third difference over dt^3 |
/// | 29 | `cycle_time` | s | duration of the walk cycle |
pub const FEATURES: [Feature; FEATURE_COUNT] = [
    feature("volume", "m3", "box around the 16 joints"),
    feature("neck_angle_shoulders", "deg", "angle(right shoulder - neck, left shoulder - neck)"),
    feature("right_shoulder_angle", "deg", "angle(neck - right shoulder, left shoulder - right shoulder)"),
    feature("left_shoulder_angle", "deg", "angle(neck - left shoulder, right shoulder - left shoulder)"),
    feature("back_angle_vertical", "deg", "angle(head - root, up)"),
    feature("neck_angle_head_back", "deg", "angle(head - neck, spine - neck)"),
    feature("right_hand_root_distance", "m", "|right hand - root|"),
    feature("left_hand_root_distance", "m", "|left hand - root|"),
    feature("right_foot_root_distance", "m", "|right foot - root|"),
    feature("left_foot_root_distance", "m", "|left foot - root|"),
    feature("hands_neck_area", "m2", "area(left hand, neck, right hand)"),
    feature("feet_root_area", "m2", "area(left foot, root, right foot)"),
    feature("stride_length", "m", "largest |left foot - right foot|"),
    feature("right_hand_speed", "m/s", "mean |first difference| / dt"),
    feature("left_hand_speed", "m/s", "mean |first difference| / dt"),
    feature("head_speed", "m/s", "mean |first difference| / dt"),
    feature("right_foot_speed", "m/s", "mean |first difference| / dt"),
    feature("left_foot_speed", "m/s", "mean |first difference| / dt"),
    feature("right_hand_acceleration", "m/s2", "mean |second difference| / dt^2"),
    feature("left_hand_acceleration", "m/s2", "mean |second difference| / dt^2"),
    feature("head_acceleration", "m/s2", "mean |second difference| / dt^2"),
    feature("right_foot_acceleration", "m/s2", "mean |second difference| / dt^2"),
    feature("left_foot_acceleration", "m/s2", "mean |second difference| / dt^2"),
    feature("right_hand_jerk", "m/s3", "mean |third difference| / dt^3"),
    feature("left_hand_jerk", "m/s3", "mean |third difference| / dt^3"),
    feature("head_jerk", "m/s3", "mean |third difference| / dt^3"),
    feature("right_foot_jerk", "m/s3", "mean |third difference| / dt^3"),
    feature("left_foot_jerk", "m/s3", "mean |third difference| / dt^3"),
    feature("cycle_time", "s", "duration of the walk cycle"),
];

/// Which reading of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Variant {
    /// The formulas as the text has them: frames as they are, differences within the cycle from its first frame to its
    /// last, box along the axes, feature 5 from the back (neck - root) as the text says.
    Paper,
    /// The text with its gaps closed: the cycle resampled to the whole number of frames nearest to [`RATE`],
    /// differences all around the cycle, the body's mean heading turned to +z before the box is taken, head - root in
    /// feature 5, triangles by cross product.
    #[default]
    Corrected,
    /// The authors' released code: millimetres scaled to centimetres, dm3-like volumes (mm3 / 1000) from a box that
    /// misses maxima, Heron's formula, 1/30 s between frames whatever the rate, and as stride length the mean number
    /// of frames between foot strikes, of which the cycle time is a thirtieth.
    StepCode,
}

impl Variant {
    /// All variants.
    pub const ALL: [Self; 3] = [Self::Paper, Self::Corrected, Self::StepCode];

    /// Name in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Corrected => "corrected",
            Self::StepCode => "step-code",
        }
    }
}

impl std::str::FromStr for Variant {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        by_name("variant", &Self::ALL, Self::name, text)
    }
}

/// A position, m.
type Point = [f64; 3];

/// Poses at equal steps of time.
struct Cycle {
    poses: Vec<[Point; JOINT_COUNT]>,
    /// Seconds between poses.
    step: f64,
    /// Travel along +z that is not in the poses, m/s.
    speed: f64,
}

/// The features of a gait, by the index of [`FEATURES`]. Of a gait without frames or with numbers that are not finite,
/// some or all are not finite.
pub fn features(gait: &Gait, variant: Variant) -> [f64; FEATURE_COUNT] {
    if gait.poses.is_empty() {
        return [f64::NAN; FEATURE_COUNT];
    }
    match variant {
        Variant::Paper => variants::paper(&as_recorded(gait)),
        Variant::Corrected => variants::corrected(&resampled(gait)),
        Variant::StepCode => variants::step_code(&as_recorded(gait)),
    }
}

/// The features of many gaits, on all threads.
pub fn features_of(gaits: &[&Gait], variant: Variant) -> Vec<[f64; FEATURE_COUNT]> {
    gaits.par_iter().map(|gait| features(gait, variant)).collect()
}

/// The frames as they are.
fn as_recorded(gait: &Gait) -> Cycle {
    let poses = gait.poses.iter().map(|pose| pose.map(|point| point.to_array().map(f64::from)));
    Cycle { poses: poses.collect(), step: 1.0 / f64::from(gait.frame_rate), speed: f64::from(gait.speed) }
}

/// The cycle at the whole number of frames nearest to [`RATE`], which keeps it closed: dt is within 1 / (2 n) of
/// 1 / [`RATE`]. Catmull-Rom splines around the cycle; frames that are there are kept bit for bit.
fn resampled(gait: &Gait) -> Cycle {
    let cycle = as_recorded(gait);
    let count = cycle.poses.len();
    let duration = count_f64(count) * cycle.step;
    let wanted = resampled_count(count, duration);
    if wanted == count {
        return cycle;
    }
    let poses = (0..wanted).map(|i| {
        // frame i * count / wanted, in whole numbers as far as possible
        let (from, rest) = (i * count / wanted, i * count % wanted);
        let t = count_f64(rest) / count_f64(wanted);
        let [a, b, c, d] = [count - 1, 0, 1, 2].map(|offset| &cycle.poses[(from + offset) % count]);
        if rest == 0 {
            return *b;
        }
        std::array::from_fn(|j| std::array::from_fn(|k| catmull_rom([a[j][k], b[j][k], c[j][k], d[j][k]], t)))
    });
    Cycle { poses: poses.collect(), step: duration / count_f64(wanted), speed: cycle.speed }
}

/// Frames of a resampled cycle.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to counts of frames before"
)]
fn resampled_count(count: usize, duration: f64) -> usize {
    let most = count_f64(count.saturating_mul(MOST_UPSAMPLING).max(FEWEST_FRAMES));
    (duration * RATE).round().clamp(count_f64(FEWEST_FRAMES), most) as usize
}

fn catmull_rom([a, b, c, d]: [f64; 4], t: f64) -> f64 {
    b + (c - a + (a * 2.0 - b * 5.0 + c * 4.0 - d + (b * 3.0 - c * 3.0 + d - a) * t) * t) * (t * 0.5)
}

#[allow(clippy::cast_precision_loss, reason = "counts of frames are far below 2^53")]
fn count_f64(count: usize) -> f64 {
    count as f64
}

/// Many gaits in flat buffers, as the kernel `gait_features` takes them: resampled as [`Variant::Corrected`] does.
#[derive(Debug, Clone, PartialEq, Default)]
#[doc(hidden)]
pub struct Batch {
    /// Joint positions and 0, m: `[frame][joint]`, the gaits one after another.
    pub frames: Vec<[f32; 4]>,
    /// Where the frames of each gait lie: `[gait]`.
    pub table: Vec<GaitEntry>,
}

impl Batch {
    /// The batch of these gaits; None if they have more than 2^32 frames.
    #[allow(clippy::cast_possible_truncation, reason = "the kernel works in f32")]
    pub fn new(gaits: &[&Gait]) -> Option<Self> {
        let cycles: Vec<Cycle> = gaits.par_iter().map(|gait| resampled(gait)).collect();
        let mut batch = Self::default();
        for cycle in &cycles {
            let first = u32::try_from(batch.frames.len() / JOINT_COUNT).ok()?;
            let count = u32::try_from(cycle.poses.len()).ok()?;
            let (rate, speed) = ((1.0 / cycle.step) as f32, cycle.speed as f32);
            batch.table.push(GaitEntry { first_frame: first, frames: count, rate, speed });
            let points = cycle.poses.iter().flatten();
            batch.frames.extend(points.map(|point| [point[0] as f32, point[1] as f32, point[2] as f32, 0.0]));
        }
        Some(batch)
    }
}
