//! The walker's classes against those of recorded gaits: does a happy, angry or sad walk differ from a neutral one as much
//! as gaits that people label so do?
//!
//! Each recorded gait is set against the neutral mean of its own source (data sets differ in people, capture and unit),
//! as a ratio, or as a difference for angles; the walker's presets against its neutral presets likewise.

use crate::emotion::Emotion;
use crate::gait::walker::{Sex, WalkerStyle, walk};
use crate::gait::{Error, Gait, Joint, Pose};
use serde::Serialize;

/// One thing that is measured on a gait.
#[derive(Debug, Clone, Copy)]
pub struct Measure {
    /// Name in tables.
    pub name: &'static str,
    /// Its value for a gait.
    pub of: fn(&Gait) -> f32,
    /// Classes are compared by their ratio; otherwise by their difference.
    pub is_ratio: bool,
}

/// The expression at which the walker is to differ as people do.
const MEASURED: f64 = 1.0;

/// What is compared. All are free of heading, side and body size (in ratio to the neutral mean of the source).
pub const MEASURES: [Measure; 8] = [
    Measure { name: "walking speed", of: |gait| gait.speed, is_ratio: true },
    Measure { name: "cycle time", of: Gait::cycle_time, is_ratio: true },
    Measure { name: "stride length", of: Gait::stride_length, is_ratio: true },
    Measure {
        name: "hand speed",
        of: |gait| speed(gait, [Joint::LeftHand, Joint::RightHand]),
        is_ratio: true,
    },
    Measure {
        name: "foot speed",
        of: |gait| speed(gait, [Joint::LeftFoot, Joint::RightFoot]),
        is_ratio: true,
    },
    Measure { name: "arm swing", of: arm_swing, is_ratio: true },
    Measure { name: "head angle, deg", of: head_angle, is_ratio: false },
    Measure { name: "forward lean, deg", of: forward_lean, is_ratio: false },
];

/// Mean speed of two joints on the spot, m/s.
fn speed(gait: &Gait, joints: [Joint; 2]) -> f32 {
    let next = gait.poses.iter().cycle().skip(1);
    let path: f32 = gait.poses.iter().zip(next).map(|(now, next)| travel(now, next, joints)).sum();
    0.5 * path / gait.cycle_time()
}

fn travel(now: &Pose, next: &Pose, joints: [Joint; 2]) -> f32 {
    joints.map(|joint| now[joint as usize].distance(next[joint as usize])).iter().sum()
}

/// Largest distance between two places of a hand relative to the root, m, mean of both hands.
fn arm_swing(gait: &Gait) -> f32 {
    let extent = |hand: Joint| {
        let place = |pose: &Pose| pose[hand as usize] - pose[Joint::Root as usize];
        let apart = |a: &Pose| gait.poses.iter().map(|b| place(a).distance(place(b))).fold(0.0, f32::max);
        gait.poses.iter().map(apart).fold(0.0, f32::max)
    };
    0.5 * (extent(Joint::LeftHand) + extent(Joint::RightHand))
}

fn mean(gait: &Gait, of: impl Fn(&Pose) -> f32) -> f32 {
    #[allow(clippy::cast_precision_loss, reason = "a number of frames")]
    let count = gait.poses.len().max(1) as f32;
    gait.poses.iter().map(of).sum::<f32>() / count
}

/// Feature 6 of the paper: the angle at the neck between head and spine, 180 when they are in line, degrees.
fn head_angle(gait: &Gait) -> f32 {
    let [head, neck, spine] = [Joint::Head, Joint::Neck, Joint::Spine].map(|joint| joint as usize);
    mean(gait, |pose| (pose[head] - pose[neck]).angle_between(pose[spine] - pose[neck]).to_degrees())
}

/// How far the head is in front of the root, as an angle from the vertical, degrees.
fn forward_lean(gait: &Gait) -> f32 {
    mean(gait, |pose| {
        let up = pose[Joint::Head as usize] - pose[Joint::Root as usize];
        libm::atan2f(up.z, up.y).to_degrees()
    })
}

/// How the walker's difference from neutral lies to the recorded one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Within two standard errors.
    Within,
    /// Less, beyond two standard errors.
    Weaker,
    /// More, beyond two standard errors.
    Stronger,
    /// In the other direction, beyond two standard errors; the recorded one is that far from none, too.
    Opposite,
}

impl Verdict {
    /// Of the differences from `none`; `error` is the standard error of the recorded one.
    fn of(walker: f64, recorded: f64, error: f64, none: f64) -> Self {
        let band = 2.0 * error;
        if (walker - recorded).abs() <= band {
            Self::Within
        } else if (recorded - none).abs() > band && (recorded > none) != (walker > none) {
            Self::Opposite
        } else if (walker - none).abs() < (recorded - none).abs() {
            Self::Weaker
        } else {
            Self::Stronger
        }
    }
}

/// One measure of one emotion against neutral.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Contrast {
    /// The measure's name.
    pub measure: &'static str,
    /// The emotion that is set against neutral.
    pub emotion: Emotion,
    /// Ratio (1 is no difference) or difference (0 is none).
    pub is_ratio: bool,
    /// Mean over the recorded gaits of the emotion.
    pub recorded: f64,
    /// Standard error of that, that of the neutral mean included.
    pub error: f64,
    /// Number of recorded gaits of the emotion.
    pub gaits: usize,
    /// The walker's.
    pub walker: f64,
    /// What that says.
    pub verdict: Verdict,
}

/// Compares the walker with labelled gaits, `[source][gait]`; gaits without a label and sources without a neutral gait do
/// not count.
///
/// # Errors
/// [`Error::Unusable`] if an emotion has fewer than 2 gaits to compare.
pub fn compare(sources: &[Vec<Gait>]) -> Result<Vec<Contrast>, Error> {
    let mut contrasts = Vec::new();
    for measure in MEASURES {
        let walker = presets(measure)?;
        let neutral: Vec<f64> = recorded(sources, measure, Emotion::Neutral);
        let [_, neutral_error] = moments(&neutral);
        for emotion in [Emotion::Happy, Emotion::Angry, Emotion::Sad] {
            let values = recorded(sources, measure, emotion);
            if values.len() < 2 || neutral.len() < 2 {
                let (name, count) = (format!("{emotion} gaits"), values.len());
                let message =
                    format!("{count}, and {} neutral ones; at least 2 of each are needed", neutral.len());
                return Err(Error::Unusable { name, message });
            }
            let [recorded, own_error] = moments(&values);
            let error = libm::hypot(own_error, neutral_error);
            let none = f64::from(u8::from(measure.is_ratio));
            let walker = against(measure, walker[emotion.index()], walker[Emotion::Neutral.index()]);
            let verdict = Verdict::of(walker, recorded, error, none);
            contrasts.push(Contrast {
                measure: measure.name,
                emotion,
                is_ratio: measure.is_ratio,
                recorded,
                error,
                gaits: values.len(),
                walker,
                verdict,
            });
        }
    }
    Ok(contrasts)
}

fn against(measure: Measure, value: f64, neutral: f64) -> f64 {
    if measure.is_ratio { value / neutral } else { value - neutral }
}

/// The measure of every preset, mean of both sexes.
fn presets(measure: Measure) -> Result<[f64; 4], Error> {
    let mut values = [0.0; 4];
    for emotion in Emotion::ALL {
        for sex in Sex::ALL {
            let gait = walk(&WalkerStyle::expressed(emotion, sex, MEASURED), "preset")?;
            values[emotion.index()] += 0.5 * f64::from((measure.of)(&gait));
        }
    }
    Ok(values)
}

/// Every recorded gait of an emotion against the neutral mean of its source.
fn recorded(sources: &[Vec<Gait>], measure: Measure, emotion: Emotion) -> Vec<f64> {
    let mut found = Vec::new();
    for gaits in sources {
        let of = |label: Emotion| {
            let labelled = gaits.iter().filter(move |gait| gait.label == Some(label));
            labelled.map(|gait| f64::from((measure.of)(gait))).filter(|value| value.is_finite())
        };
        let neutral: Vec<f64> = of(Emotion::Neutral).collect();
        if !neutral.is_empty() {
            let [neutral, _] = moments(&neutral);
            found.extend(of(emotion).map(|value| against(measure, value, neutral)));
        }
    }
    found
}

/// Mean and its standard error.
fn moments(values: &[f64]) -> [f64; 2] {
    #[allow(clippy::cast_precision_loss, reason = "a number of gaits")]
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    [mean, (squares / (count - 1.0).max(1.0) / count).sqrt()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::walker::{EXPRESSION, person_expressing};

    fn class(emotion: Emotion, label: Emotion, expression: f64) -> impl Iterator<Item = Gait> {
        (0..24).map(move |index| {
            let mut gait = person_expressing(emotion, Sex::Female, expression, 3, index).unwrap();
            gait.label = Some(label);
            gait
        })
    }

    #[test]
    fn a_difference_is_judged_by_its_band_not_by_its_sign() {
        for (walker, verdict) in [
            (1.3, Verdict::Within),
            (1.1, Verdict::Weaker),
            (0.9, Verdict::Opposite),
            (1.7, Verdict::Stronger),
        ] {
            assert_eq!(Verdict::of(walker, 1.4, 0.1, 1.0), verdict, "{walker}");
        }
        // a recorded difference within its error of none has no direction
        assert_eq!(Verdict::of(-5.0, 0.5, 1.0, 0.0), Verdict::Stronger);
        assert_eq!(Verdict::of(-1.0, 0.5, 1.0, 0.0), Verdict::Within);
    }

    #[test]
    fn walkers_agree_with_themselves_and_not_with_swapped_labels() {
        let gaits: Vec<Gait> =
            Emotion::ALL.into_iter().flat_map(|emotion| class(emotion, emotion, MEASURED)).collect();
        let found = compare(&[gaits]).unwrap();
        assert_eq!(found.len(), 24);
        assert!(found.iter().all(|contrast| contrast.verdict != Verdict::Opposite), "{found:#?}");
        let within = |found: &[Contrast]| found.iter().filter(|one| one.verdict == Verdict::Within).count();
        assert!(within(&found) >= 16, "{found:#?}");
        let swapped = [(Emotion::Sad, Emotion::Happy), (Emotion::Happy, Emotion::Sad)];
        let kept = [Emotion::Angry, Emotion::Neutral].map(|emotion| (emotion, emotion));
        let pairs = swapped.into_iter().chain(kept);
        let gaits: Vec<Gait> = pairs.flat_map(|(emotion, label)| class(emotion, label, EXPRESSION)).collect();
        let found = compare(&[gaits]).unwrap();
        let wrong = found.iter().filter(|contrast| contrast.verdict == Verdict::Opposite);
        assert!(wrong.count() >= 12);
        assert!(within(&found) <= 12, "{found:#?}");
        assert!(compare(&[]).unwrap_err().to_string().contains("at least 2"));
    }
}
