//! Everything that is measured of a library of gaits, and of the bodies that walk so.

use super::angles::{Angle, Side, Walk, mean, range};
use super::cues::{Band, CUES, EMOTIONS, arm_asymmetry, step_width};
use super::norm::{NORM, Norm};
use super::{cues, drawn};
use crate::avatar::retarget::at_phases;
use crate::avatar::{Avatar, retarget};
use crate::emotion::Emotion;
use crate::gait::fit::{HARMONICS, fit};
use crate::gait::{Gait, Joint, Pose};
use glam::Vec3;
use serde::Serialize;
use std::collections::BTreeMap;

/// Root mean square against the norm by angle, degrees.
pub(crate) type Rms = BTreeMap<Angle, f32>;

/// Figures of the four emotions, by name.
type ByEmotion<T> = BTreeMap<&'static str, T>;

/// Leg length to which individuals are scaled where places of joints are compared, m.
const LEG: f32 = 0.87;
/// Frames of a fitted gait.
const FRAMES: usize = 100;

/// Farthest that an individual may be from the mean of the norm, half bands: two whole ones.
const MOST_HALF_BANDS: f32 = 4.0;

/// The walks of a library.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    /// The body: a file, or the generated bodies.
    pub(crate) avatar: String,
    /// Every gait, as drawn.
    pub(crate) gaits: Vec<Measured>,
    /// The people of each emotion together.
    pub(crate) crowd: ByEmotion<Crowd>,
    /// Neutral walks as drawn against figures of adults at 1.2 to 1.35 m/s.
    pub(crate) scalars: BTreeMap<&'static str, Scalar>,
    /// Of the neutral gaits, how many keep to the norm one by one.
    pub(crate) individuals: Individuals,
    /// What each emotion changes against neutral, in the gaits.
    pub(crate) cues: BTreeMap<&'static str, ByEmotion<Difference>>,
}

/// One gait on its body.
#[derive(Debug, Serialize)]
pub(crate) struct Measured {
    pub(crate) name: String,
    pub(crate) emotion: Option<Emotion>,
    /// m/s, as drawn.
    pub(crate) speed: f32,
    /// Against the norm, mean of both sides.
    pub(crate) rms: Rms,
    /// Farthest point of any angle of the norm from its mean, half bands.
    pub(crate) farthest: f32,
    /// Whether that is no more than [`MOST_HALF_BANDS`].
    pub(crate) within_two_bands: bool,
    /// How much the body changes the knee angles of the gait, RMS, degrees.
    pub(crate) knee_change_rms: f32,
    pub(crate) slide_mm_per_frame: f32,
    /// Angles of the norm over the left stride, degrees.
    pub(crate) curves: BTreeMap<Angle, Vec<f32>>,
}

/// How many neutral gaits lie within two bands of the norm at every point: [`MOST_HALF_BANDS`] from its mean.
#[derive(Debug, Serialize)]
pub(crate) struct Individuals {
    pub(crate) gaits: usize,
    /// In every angle.
    pub(crate) within_two_bands: usize,
    /// In each.
    pub(crate) by_angle: BTreeMap<Angle, usize>,
}

/// The people of one emotion.
#[derive(Debug, Serialize)]
pub(crate) struct Crowd {
    pub(crate) gaits: usize,
    /// Of their mean curve against the norm.
    pub(crate) rms: Rms,
    /// How far individuals are from their mean, RMS over joints and phases, cm at a leg of 0.87 m.
    pub(crate) spread_cm: f32,
    pub(crate) arm_asymmetry_deg: f32,
}

/// A figure of neutral walkers.
#[derive(Debug, Serialize)]
pub(crate) struct Scalar {
    pub(crate) value: f32,
    pub(crate) target: f32,
    pub(crate) tolerance: f32,
    pub(crate) within: bool,
}

impl Scalar {
    pub(super) fn new(value: f32, target: f32, tolerance: f32) -> Self {
        Self { value, target, tolerance, within: (value - target).abs() <= tolerance }
    }
}

/// What an emotion changes.
#[derive(Debug, Serialize)]
pub(crate) struct Difference {
    pub(crate) value: f32,
    pub(crate) target: f32,
    pub(crate) standard_error: f32,
    pub(crate) within: bool,
}

/// One gait, its body's walk, and its own.
struct Pair<'a> {
    gait: &'a Gait,
    drawn: Walk,
    /// Fitted, as E-Gait's are for [`cues`].
    fitted: Walk,
}

impl Report {
    /// How many differences of the cues are within people's, and of how many.
    pub(crate) fn agreement(&self) -> (usize, usize) {
        let all = || self.cues.values().flat_map(BTreeMap::values);
        (all().filter(|difference| difference.within).count(), all().count())
    }

    /// The mean of an emotion's gaits over the left stride: % of the stride, degrees. Closed; empty where there is none.
    pub(crate) fn mean_curve(&self, emotion: Emotion, angle: Angle) -> Vec<[f64; 2]> {
        let own = self.gaits.iter().filter(|gait| gait.emotion == Some(emotion));
        let curves: Vec<Vec<f32>> = own.filter_map(|gait| gait.curves.get(&angle).cloned()).collect();
        let mean = mean_curve(&curves);
        #[allow(clippy::cast_precision_loss, reason = "a number of frames")]
        let percent = |k: usize| k as f64 * 100.0 / mean.len() as f64;
        let points = mean.iter().chain(mean.first()).enumerate();
        points.map(|(k, value)| [percent(k), f64::from(*value)]).collect()
    }
}

/// Measures gaits on the bodies that `body` gives them.
///
/// # Errors
/// A gait that cannot be put on its body.
pub(crate) fn measure<'a>(
    avatar: String,
    gaits: &[Gait],
    body: impl Fn(&Gait) -> &'a Avatar,
) -> Result<Report, crate::Error> {
    let (mut pairs, mut measured) = (Vec::new(), Vec::new());
    for gait in gaits {
        let avatar = body(gait);
        let clip = retarget(gait, avatar)?;
        let (drawn, slide_mm_per_frame) = drawn::walk(gait, &clip, avatar);
        measured.push(Measured {
            name: gait.name.clone(),
            emotion: gait.label,
            speed: clip.speed,
            rms: rms(&drawn),
            farthest: farthest(&drawn),
            within_two_bands: farthest(&drawn) <= MOST_HALF_BANDS,
            knee_change_rms: knee_change(&at_phases(gait)?, &drawn.poses),
            slide_mm_per_frame,
            curves: curves(&drawn),
        });
        let fitted = own_walk(&fit(gait, HARMONICS)?.to_gait(FRAMES));
        pairs.push(Pair { gait, drawn, fitted });
    }
    let crowd = |emotion: Emotion| Some((emotion.name(), crowd(&people(&pairs, emotion))?));
    Ok(Report {
        avatar,
        gaits: measured,
        crowd: Emotion::ALL.into_iter().filter_map(crowd).collect(),
        scalars: scalars(&people(&pairs, Emotion::Neutral)),
        individuals: individuals(&people(&pairs, Emotion::Neutral)),
        cues: CUES.iter().map(|cue| (cue.name, differences(cue, &pairs))).collect(),
    })
}

fn own_walk(gait: &Gait) -> Walk {
    Walk {
        poses: gait.poses.clone(),
        foot_pitch: Vec::new(),
        cycle_time: gait.cycle_time(),
        travel: gait.stride_travel(),
    }
}

fn rms(walk: &Walk) -> Rms {
    let of = |norm: &Norm| {
        let sides = Side::BOTH.into_iter().filter_map(|side| walk.curve(norm.angle, side));
        let values: Vec<f32> = sides.map(|curve| norm.rms(&curve)).collect();
        (!values.is_empty()).then(|| (norm.angle, mean(&values)))
    };
    NORM.iter().filter_map(of).collect()
}

fn farthest(walk: &Walk) -> f32 {
    NORM.iter().map(|norm| farthest_of(walk, norm)).fold(0.0, f32::max)
}

/// Of one angle, either side.
fn farthest_of(walk: &Walk, norm: &Norm) -> f32 {
    let curves = Side::BOTH.into_iter().filter_map(|side| walk.curve(norm.angle, side));
    curves.map(|curve| norm.farthest(&curve)).fold(0.0, f32::max)
}

fn individuals(neutral: &[&Pair<'_>]) -> Individuals {
    let within = |far: &dyn Fn(&Walk) -> f32| {
        neutral.iter().filter(|pair| far(&pair.drawn) <= MOST_HALF_BANDS).count()
    };
    Individuals {
        gaits: neutral.len(),
        within_two_bands: within(&farthest),
        by_angle: NORM
            .iter()
            .map(|norm| (norm.angle, within(&|walk: &Walk| farthest_of(walk, norm))))
            .collect(),
    }
}

fn curves(walk: &Walk) -> BTreeMap<Angle, Vec<f32>> {
    NORM.iter().filter_map(|norm| Some((norm.angle, walk.curve(norm.angle, Side::Left)?))).collect()
}

/// RMS of the difference of the knees' angles at equal phases, both sides.
fn knee_change(gait: &[Pose], drawn: &[Pose]) -> f32 {
    let bend = |pose: &Pose, side: Side| {
        let [hip, knee, foot] =
            [Joint::LeftHip, Joint::LeftKnee, Joint::LeftFoot].map(|joint| pose[side.of(joint) as usize]);
        (knee - hip).angle_between(foot - knee).to_degrees()
    };
    let pairs = || gait.iter().zip(drawn);
    let change = |side: Side| pairs().map(move |(before, after)| bend(after, side) - bend(before, side));
    let squares: Vec<f32> = Side::BOTH.into_iter().flat_map(change).map(|change| change * change).collect();
    mean(&squares).sqrt()
}

/// The mean of several curves.
fn mean_curve(curves: &[Vec<f32>]) -> Vec<f32> {
    let count = curves.iter().map(Vec::len).min().unwrap_or(0);
    (0..count).map(|k| mean(&curves.iter().map(|curve| curve[k]).collect::<Vec<_>>())).collect()
}

/// None of no people.
fn crowd(people: &[&Pair<'_>]) -> Option<Crowd> {
    let all: Vec<f32> = people.iter().map(|pair| arm_asymmetry(&pair.fitted)).collect();
    (!people.is_empty()).then(|| Crowd {
        gaits: people.len(),
        rms: NORM
            .iter()
            .map(|norm| {
                let sides = |side| people.iter().filter_map(move |pair| pair.drawn.curve(norm.angle, side));
                let curves: Vec<Vec<f32>> = Side::BOTH.into_iter().flat_map(sides).collect();
                (norm.angle, norm.rms(&mean_curve(&curves)))
            })
            .collect(),
        spread_cm: spread(people),
        arm_asymmetry_deg: mean(&all),
    })
}

/// How far individuals are from their mean: RMS over joints and phases, cm at a leg of [`LEG`]. What a sample tells of all
/// people, by one less than its number, since its mean is its own.
fn spread(people: &[&Pair<'_>]) -> f32 {
    let joints: Vec<Joint> = Joint::ALL.into_iter().filter(|joint| *joint != Joint::Root).collect();
    let mut squares = Vec::new();
    for joint in joints {
        let paths: Vec<Vec<Vec3>> = people
            .iter()
            .map(|pair| {
                let scale = LEG / pair.fitted.leg().max(1e-3);
                pair.fitted.places(joint, Side::Left).into_iter().map(|place| place * scale).collect()
            })
            .collect();
        #[allow(clippy::cast_precision_loss, reason = "a number of people")]
        let share = 1.0 / paths.len() as f32;
        for frame in 0..FRAMES {
            let middle: Vec3 = paths.iter().map(|path| path[frame]).sum::<Vec3>() * share;
            squares.extend(paths.iter().map(|path| path[frame].distance_squared(middle)));
        }
    }
    #[allow(clippy::cast_precision_loss, reason = "a number of people")]
    let (count, others) = (people.len() as f32, people.len().saturating_sub(1).max(1) as f32);
    100.0 * (mean(&squares) * count / others).sqrt()
}

/// A figure of a walk as drawn.
type Figure = fn(&Walk) -> f32;

/// Length of people's steps by their rate, m min: 80 strides of CMU's captures.
pub(super) const WALK_RATIO: f32 = 0.0065;

/// Figures of a neutral walk at 1.2 to 1.35 m/s, with targets and tolerances. The first seven: 80 strides of CMU's captures. The last: E-Gait.
pub(super) const SCALARS: [(&str, Figure, f32, f32); 8] = [
    ("step_width_m", step_width, 0.09, 0.02),
    ("bob_m", |walk| range(&root(walk, |p| p.y)), 0.037, 0.013),
    ("sway_m", |walk| range(&root(walk, |p| p.x)), 0.044, 0.009),
    ("swing_clearance_m", clearance, 0.015, 0.01),
    ("cadence_steps_per_min", cadence, 107.0, 8.0),
    ("walk_ratio_m_min", |walk| walk.travel / 2.0 / cadence(walk), WALK_RATIO, 0.0007),
    (
        "shoulder_turn_deg",
        |walk| walk.curve(Angle::ShoulderTurn, Side::Left).map_or(0.0, |c| range(&c) / 2.0),
        4.4,
        1.3,
    ),
    ("arm_asymmetry_deg", arm_asymmetry, 9.0, 9.0),
];

fn scalars(neutral: &[&Pair<'_>]) -> BTreeMap<&'static str, Scalar> {
    if neutral.is_empty() {
        return BTreeMap::new();
    }
    let drawn = SCALARS.into_iter().map(|(name, of, target, tolerance)| {
        let value = mean(&neutral.iter().map(|pair| of(&pair.drawn)).collect::<Vec<_>>());
        (name, Scalar::new(value, target, tolerance))
    });
    drawn.collect()
}

fn root(walk: &Walk, axis: fn(&Vec3) -> f32) -> Vec<f32> {
    walk.poses.iter().map(|pose| axis(&pose[Joint::Root as usize])).collect()
}

fn cadence(walk: &Walk) -> f32 {
    120.0 / walk.cycle_time
}

/// Least height of the ankle in mid swing above mid stance, mean of both sides, m.
fn clearance(walk: &Walk) -> f32 {
    let sides = Side::BOTH.map(|side| {
        let up = walk.heights(Joint::LeftFoot, side);
        let count = up.len();
        let swing = up[count * 66 / 100..count * 90 / 100].iter().copied().fold(f32::MAX, f32::min);
        swing - mean(&up[count / 5..count * 3 / 10])
    });
    mean(&sides)
}

/// What each emotion changes of a cue, where there are such gaits.
fn differences(cue: &cues::Cue, pairs: &[Pair<'_>]) -> ByEmotion<Difference> {
    let figure = |emotion: Emotion| {
        let values: Vec<f32> = people(pairs, emotion).iter().map(|pair| (cue.of)(&pair.fitted)).collect();
        (!values.is_empty()).then(|| mean(&values))
    };
    let Some(neutral) = figure(Emotion::Neutral) else { return BTreeMap::new() };
    let against = |(emotion, people): (Emotion, Band)| {
        let value = figure(emotion)? - neutral;
        let (target, standard_error) = (people.mean, people.standard_error);
        Some((emotion.name(), Difference { value, target, standard_error, within: people.holds(value) }))
    };
    EMOTIONS.into_iter().zip(cue.people).filter_map(against).collect()
}

fn people<'p, 'g>(pairs: &'p [Pair<'g>], emotion: Emotion) -> Vec<&'p Pair<'g>> {
    pairs.iter().filter(|pair| pair.gait.label == Some(emotion)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::avatar::{self, Sex};
    use crate::gait::walker::{self, WalkerStyle};
    use crate::library::GaitLibrary;

    fn preset(emotion: Emotion) -> Gait {
        let style = WalkerStyle::preset(emotion, walker::Sex::Male);
        Gait { label: Some(emotion), ..walker::walk(&style, emotion.name()).unwrap() }
    }

    /// Bounds: half a band of the norm and more (thigh to foot 5 degrees RMS, arms 7); 2 degrees of change at the knees.
    #[test]
    fn the_neutral_crowd_as_drawn_walks_as_healthy_adults_do() {
        let library = GaitLibrary::built_in().unwrap();
        let body = avatar::generated(Sex::Male);
        let report = measure("generated".to_owned(), library.gaits(), |_| &body).unwrap();
        let rms = &report.crowd["neutral"].rms;
        for (angles, most) in [
            (&[Angle::Thigh, Angle::Knee, Angle::Ankle, Angle::Foot][..], 5.0),
            (&[Angle::Shoulder, Angle::Elbow][..], 7.0),
        ] {
            assert!(angles.iter().all(|angle| rms[angle] < most), "{rms:?}, {most} at most");
        }
        for (name, scalar) in &report.scalars {
            assert!(scalar.within, "{name}: {scalar:?}");
        }
        for gait in &report.gaits {
            assert!(gait.knee_change_rms < 2.0, "{}: knees change by {}", gait.name, gait.knee_change_rms);
            assert!(gait.slide_mm_per_frame < 0.1, "{}: {}", gait.name, gait.slide_mm_per_frame);
            let ankle = &gait.curves[&Angle::Ankle];
            let at_push_off = ankle[ankle.len() * 6 / 10];
            assert!(
                gait.emotion != Some(Emotion::Neutral) || at_push_off < -8.0,
                "{}: {at_push_off}",
                gait.name
            );
        }
        assert!(report.crowd.values().all(|crowd| crowd.spread_cm > 1.5), "people differ");
    }

    #[test]
    fn one_is_no_crowd_and_is_compared_with_nobody() {
        let body = avatar::generated(Sex::Male);
        let report = measure("generated".to_owned(), &[preset(Emotion::Neutral)], |_| &body).unwrap();
        assert!(report.crowd["neutral"].spread_cm < 1e-4);
        assert!(report.cues.values().flat_map(BTreeMap::values).next().is_none());
    }

    #[test]
    fn emotions_differ_as_they_do_in_people_and_no_farther_than_actors_go() {
        let library = GaitLibrary::built_in().unwrap();
        let body = avatar::generated(Sex::Male);
        let report = measure("generated".to_owned(), library.gaits(), |_| &body).unwrap();
        let cue = |cue: &str, emotion: &str| report.cues[cue][emotion].value;
        // the acted range: Bandai-Namco, EWalk
        assert!((4.0..17.0).contains(&cue("head_forward_deg", "sad")));
        assert!((2.0..20.0).contains(&cue("elbow_mean_deg", "angry")));
        assert!((2.0..8.0).contains(&cue("trunk_forward_deg", "sad")));
        assert!((0.0..8.0).contains(&cue("trunk_forward_deg", "angry")));
        assert!(cue("shoulder_range_deg", "happy") > 10.0 && cue("shoulder_range_deg", "sad") < -5.0);
        assert!(cue("cycle_time_s", "sad") > 0.18 && cue("cycle_time_s", "angry") < -0.1);
        let (within, all) = report.agreement();
        assert_eq!(all, CUES.len() * EMOTIONS.len());
        assert!(within < all, "the bands can fail");
    }
}
