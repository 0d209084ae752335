//! Recordings in, gaits out: foot strikes, one stride, phase, speed (S-10, S-19; paper section 3).
//!
//! A stride runs from one strike of the left foot to the next. It is turned so that the walker goes towards +z, its
//! travel is taken out, what is left between its end and its start is spread over the cycle, and the lowest
//! point of the foot joints is put at y = 0. `v_des` is the horizontal travel over the duration; walkers on the
//! spot (treadmill, data centred on the root) first get their travel back from the foot under weight; a turn is
//! followed along its arc, named in [`Gait::source`], and refused beyond [`MAX_TURN_DEG`].

mod course;
mod filter;
mod walk;

use super::{Error, Gait, JOINT_COUNT, Joint, Pose, Recording};
use crate::ground::{ground_from_world, heading_from_ground};
pub use course::Course;
pub(super) use filter::{frames, low_pass, pose_at};
use glam::{Quat, Vec3};
use std::f32::consts::{PI, TAU};

/// A stride that turns further than this is refused, degrees.
pub const MAX_TURN_DEG: f32 = 20.0;
/// A stride that turns further than this is called curved in [`Gait::source`], degrees.
pub const CURVED_DEG: f32 = 10.0;
/// Body and travel may point this far apart; beyond, it is walking sideways or backwards, degrees.
const MAX_CRAB_DEG: f32 = 35.0;
/// Duration of a stride, s.
const STRIDE_S: std::ops::RangeInclusive<f32> = 0.5..=3.5;
/// Speed of a stride, m/s.
const SPEED: std::ops::RangeInclusive<f32> = 0.15..=8.0;
/// The other foot strikes within this share of the stride.
const OTHER_FOOT: std::ops::RangeInclusive<f32> = 0.25..=0.75;
/// Gaits keep the recording's rate up to this, Hz.
const MAX_RATE: f32 = 60.0;
/// Times a cyclic recording is repeated to look for strikes; the strides of the second repetition are taken.
pub const REPEATS: usize = 4;

/// One stride of a recording, and how good it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Stride {
    /// The walk cycle.
    pub gait: Gait,
    /// Left foot strike that begins it, s from the recording's start.
    pub begin: f32,
    /// Duration, s.
    pub duration: f32,
    /// Turn to the walker's left over the stride, radians.
    pub turn: f32,
    /// Root mean square distance over the joints between end and start once travel and turn are out, m.
    pub mismatch: f32,
    /// Whether the walker stayed on the spot, so that speed and travel are those of the planted foot.
    pub on_the_spot: bool,
}

impl Stride {
    /// Whether it turns further than [`CURVED_DEG`].
    pub fn is_curved(&self) -> bool {
        self.turn.abs() > CURVED_DEG.to_radians()
    }
}

/// All strides of a recording as gaits, in the order of time; named `NAME` if there is one, else `NAME#1`, ...
///
/// # Errors
/// [`Error::Unusable`] when there is no usable stride, with what was found.
pub fn extract(recording: &Recording) -> Result<Vec<Gait>, Error> {
    Ok(strides(recording)?.into_iter().map(|stride| stride.gait).collect())
}

/// The most periodic straight stride of a recording, as a gait under the recording's own name.
///
/// # Errors
/// [`Error::Unusable`] when there is no usable stride, with what was found.
pub fn best(recording: &Recording) -> Result<Gait, Error> {
    let survey = survey(recording)?;
    let gait = survey.best().map(|stride| Gait { name: recording.name.clone(), ..stride.gait.clone() });
    gait.ok_or_else(|| survey.none_found(recording))
}

/// All strides of a recording with their quality, in the order of time.
///
/// # Errors
/// [`Error::Unusable`] when there is no usable stride, with what was found.
pub fn strides(recording: &Recording) -> Result<Vec<Stride>, Error> {
    let survey = survey(recording)?;
    if survey.strides.is_empty() { Err(survey.none_found(recording)) } else { Ok(survey.strides) }
}

/// The stride between two strikes of the left foot that are known, in frames from the recording's start: for walks whose
/// phase is known. It is cut as all others are, and refused beyond a turn of `max_turn_deg` degrees instead of
/// [`MAX_TURN_DEG`].
///
/// # Errors
/// [`Error::Unusable`] when the recording is cyclic, not finite or does not hold both strikes, or the stride turns too far,
/// is too slow or fast, or goes sideways.
pub fn between(recording: &Recording, [from, to]: [f32; 2], max_turn_deg: f32) -> Result<Stride, Error> {
    let rate = recording.frame_rate;
    let last = recording.poses.len().saturating_sub(1) as f32;
    if !(rate > 0.0 && from >= 0.0 && from < to && to <= last) || recording.cyclic {
        let message = format!("frames {from} to {to} at {rate} Hz are no stride of frames 0 to {last}");
        return Err(unusable(recording, message));
    }
    if recording.poses.iter().flatten().any(|point| !point.is_finite()) {
        return Err(unusable(recording, "positions are not finite"));
    }
    let take =
        Take { poses: recording.poses.clone(), rate: recording.frame_rate, on_the_spot: false, cycle: None };
    take.stride(recording, from, to, max_turn_deg).map_err(|message| unusable(recording, message))
}

/// What there is in a recording: strikes, strides, what was refused and why.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Survey {
    /// Strikes of the left and of the right foot, s from the recording's start. Of a cyclic recording, those of
    /// [`REPEATS`] repetitions.
    pub strikes: [Vec<f32>; 2],
    /// Whether a foot's strikes had to be found by the authors' rule (local minima of its height).
    pub by_height: [bool; 2],
    /// Whether the walker stays on the spot: a treadmill, or travel that was taken out.
    pub on_the_spot: bool,
    /// The usable strides, in the order of time.
    pub strides: Vec<Stride>,
    /// The others: from one left strike to the next.
    pub refused: Vec<Refused>,
}

/// A stride that cannot be used.
#[derive(Debug, Clone, PartialEq)]
pub struct Refused {
    /// Left foot strike that begins it, s from the recording's start.
    pub begin: f32,
    /// Why, with values and allowed range.
    pub reason: String,
}

/// Finds strikes and strides; that there are none is no error here.
///
/// # Errors
/// [`Error::Unusable`] when the recording is too short, its rate is out of range or positions are not finite.
pub fn survey(recording: &Recording) -> Result<Survey, Error> {
    let rate = recording.frame_rate;
    if !(1.0..=2000.0).contains(&rate) {
        return Err(unusable(recording, format!("frame rate is {rate} Hz; it must be from 1 to 2000 Hz")));
    }
    if recording.poses.iter().flatten().any(|point| !point.is_finite()) {
        return Err(unusable(recording, "positions are not finite"));
    }
    let count = recording.poses.len();
    let least = if recording.cyclic { 8 } else { 12 };
    if count < least {
        return Err(unusable(recording, format!("{count} frames; at least {least} are needed")));
    }
    let take = prepare(recording);
    let strikes = walk::strikes(&take.poses, rate);
    let mut found = Survey {
        strikes: strikes.of_foot.each_ref().map(|times| times.iter().map(|frame| frame / rate).collect()),
        by_height: strikes.by_height,
        on_the_spot: take.on_the_spot,
        ..Survey::default()
    };
    for pair in strikes.of_foot[0].windows(2) {
        // Of a repeated cycle, the strides that begin in the second repetition.
        let begin_in = count as f32..2.0 * count as f32;
        if recording.cyclic && !begin_in.contains(&pair[0]) {
            continue;
        }
        let stride = check_placing(&strikes, [pair[0], pair[1]], rate)
            .and_then(|()| take.stride(recording, pair[0], pair[1], MAX_TURN_DEG));
        match stride {
            Ok(stride) => found.strides.push(stride),
            Err(reason) => found.refused.push(Refused { begin: pair[0] / rate, reason }),
        }
    }
    if found.strides.is_empty() && recording.cyclic {
        let whole = take.whole_cycle(recording, &strikes);
        found.strides.extend(
            whole.map_err(|reason| unusable(recording, format!("the cycle cannot be used: {reason}")))?,
        );
    }
    name_strides(recording, &mut found);
    Ok(found)
}

/// Whether two strikes of the left foot (frames) make a stride, with one of the right foot between; else why not.
fn check_placing(strikes: &walk::Strikes, [from, to]: [f32; 2], rate: f32) -> Result<(), String> {
    let seconds = (to - from) / rate;
    if !STRIDE_S.contains(&seconds) {
        return Err(format!("{seconds:.2} s long; {} to {} are used", STRIDE_S.start(), STRIDE_S.end()));
    }
    let others: Vec<f32> = strikes.of_foot[1]
        .iter()
        .filter(|t| (from..to).contains(*t))
        .map(|t| (t - from) / (to - from))
        .collect();
    match others.as_slice() {
        [share] if OTHER_FOOT.contains(share) => Ok(()),
        [share] => Err(format!(
            "the right foot strikes after {share:.2} of it; {} to {} are used",
            OTHER_FOOT.start(),
            OTHER_FOOT.end()
        )),
        _ => Err(format!("{} strikes of the right foot between", others.len())),
    }
}

impl Survey {
    /// The most periodic straight stride.
    pub fn best(&self) -> Option<&Stride> {
        let median = |value: fn(&Stride) -> f32| {
            let mut values: Vec<f32> = self.strides.iter().map(value).collect();
            values.sort_by(f32::total_cmp);
            values.get(values.len() / 2).copied().unwrap_or(1.0)
        };
        let (duration, speed) = (median(|s| s.duration), median(|s| s.gait.speed));
        // Each term is 1 where a stride becomes doubtful: 10 cm apart, a curve, a fifth off the take's usual.
        let fault = |s: &Stride| {
            s.mismatch / 0.1
                + s.turn.abs() / CURVED_DEG.to_radians()
                + (s.duration / duration - 1.0).abs() / 0.2
                + (s.gait.speed / speed - 1.0).abs() / 0.2
        };
        self.strides.iter().min_by(|a, b| fault(a).total_cmp(&fault(b)))
    }

    /// The error of a recording without usable strides: what was found, and why it was refused.
    pub fn none_found(&self, recording: &Recording) -> Error {
        let [left, right] = self.strikes.each_ref().map(Vec::len);
        let mut message = format!(
            "no straight stride: {left} strikes of the left foot, {right} of the right; one stride needs 2 of the left \
             with 1 of the right between"
        );
        if let Some(first) = self.refused.first() {
            message += &format!("; {} strides refused, the first: {}", self.refused.len(), first.reason);
        }
        unusable(recording, message)
    }
}

fn name_strides(recording: &Recording, survey: &mut Survey) {
    let many = survey.strides.len() > 1;
    for (index, stride) in survey.strides.iter_mut().enumerate() {
        let is_curved = stride.is_curved();
        let source = &mut stride.gait.source;
        *source = if recording.source.is_empty() { recording.name.clone() } else { recording.source.clone() };
        *source += &format!(", {:.2} s to {:.2} s", stride.begin, stride.begin + stride.duration);
        if is_curved {
            *source += &format!(", curved by {:.0} degrees", stride.turn.to_degrees());
        }
        if survey.on_the_spot {
            *source += ", on the spot: speed of the planted foot";
        }
        if survey.by_height.contains(&true) {
            *source += ", strikes by lowest foot";
        }
        if many {
            stride.gait.name = format!("{}#{}", recording.name, index + 1);
        }
    }
}

/// A recording made ready: repeated if cyclic, with travel.
struct Take {
    poses: Vec<Pose>,
    rate: f32,
    on_the_spot: bool,
    /// Frames of one cycle, and the mismatch that closing it took away; only if the recording is cyclic.
    cycle: Option<(usize, f32)>,
}

fn prepare(recording: &Recording) -> Take {
    let mut poses = recording.poses.clone();
    let mut cycle = None;
    if recording.cyclic {
        // The step from the last frame to the first is not known; the mean of its neighbours is the best guess.
        let last = poses.len() - 1;
        let mut end = poses[0];
        for (joint, point) in end.iter_mut().enumerate() {
            let step =
                (poses[1][joint] - poses[0][joint] + poses[last][joint] - poses[last - 1][joint]) / 2.0;
            *point = poses[last][joint] + step;
        }
        let gap = closing_gap(&poses[0], &end);
        spread(&mut poses, &gap);
        cycle = Some((poses.len(), rms(&gap)));
        poses = std::iter::repeat_n(&poses, REPEATS).flatten().copied().collect();
    }
    let on_the_spot = walk::is_on_the_spot(&poses, recording.frame_rate);
    if on_the_spot {
        walk::restore_travel(&mut poses, recording.frame_rate);
    }
    Take { poses, rate: recording.frame_rate, on_the_spot, cycle }
}

/// From the start of a cycle to its end, per joint.
fn closing_gap(start: &Pose, end: &Pose) -> Pose {
    std::array::from_fn(|joint| end[joint] - start[joint])
}

/// Spreads the gap evenly over the cycle, leaving its middle where it is.
fn spread(poses: &mut [Pose], gap: &Pose) {
    let count = poses.len() as f32;
    for (index, pose) in poses.iter_mut().enumerate() {
        let share = index as f32 / count - 0.5;
        for (point, gap) in pose.iter_mut().zip(gap) {
            *point -= *gap * share;
        }
    }
}

fn rms(gap: &Pose) -> f32 {
    (gap.iter().map(|d| d.length_squared()).sum::<f32>() / JOINT_COUNT as f32).sqrt()
}

impl Take {
    /// The pose at a fractional frame.
    fn at(&self, frame: f32) -> Pose {
        pose_at(&self.poses, frame)
    }

    /// Mean direction of the body over some frames, as a heading.
    fn heading(&self, from: f32, to: f32) -> f32 {
        let (from, to) = (frames(from), frames(to).max(frames(from)) + 1);
        let end = to.min(self.poses.len());
        let sum: Vec3 = self.poses[from.min(end)..end].iter().map(walk::facing_now).sum();
        heading_from_ground(ground_from_world(sum))
    }

    /// Turn of the body from one frame to a later one of the same phase, radians to the left.
    fn turn(&self, from: f32, to: f32) -> f32 {
        // Averaged over a few frames at either end, as far as there are any.
        let span = (0.05 * self.rate).min(from).min((self.poses.len() - 1) as f32 - to).max(0.0);
        wrap(self.heading(to - span, to + span) - self.heading(from - span, from + span))
    }

    /// One stride as a gait; the reason if it cannot be used.
    fn stride(&self, recording: &Recording, from: f32, to: f32, max_turn_deg: f32) -> Result<Stride, String> {
        let duration = (to - from) / self.rate;
        let (start, end) = (self.at(from), self.at(to));
        let chord = (end[Joint::Root as usize] - start[Joint::Root as usize]).with_y(0.0);
        let chord_heading = heading_from_ground(ground_from_world(chord));
        let turn = if self.cycle.is_some() { 0.0 } else { self.turn(from, to) };
        if turn.abs() > max_turn_deg.to_radians() {
            return Err(format!("turns by {:.0} degrees; up to {max_turn_deg} are used", turn.to_degrees()));
        }
        // The arc over a chord of the same turn; a straight line where there is no turn.
        let half = turn / 2.0;
        let travel = chord.length() * if half.abs() > 1e-4 { half / libm::sinf(half) } else { 1.0 };
        let speed = travel / duration;
        if !SPEED.contains(&speed) {
            return Err(format!("{speed:.2} m/s; {} to {} are used", SPEED.start(), SPEED.end()));
        }
        let crab = wrap(self.heading(from, to) - chord_heading);
        if crab.abs() > MAX_CRAB_DEG.to_radians() {
            return Err(format!("walks {:.0} degrees off the way it faces", crab.to_degrees()));
        }

        let count = frames((duration * self.rate.min(MAX_RATE)).round()).max(8);
        let on_the_spot = |pose: Pose, phase: f32| {
            let heading = chord_heading + turn * (phase - 0.5);
            let centre =
                start[Joint::Root as usize].with_y(0.0) + along_arc(chord_heading, turn, travel, phase);
            pose.map(|point| Quat::from_rotation_y(-heading) * (point - centre))
        };
        let mut poses: Vec<Pose> = (0..count)
            .map(|i| {
                let phase = i as f32 / count as f32;
                on_the_spot(self.at(from + phase * (to - from)), phase)
            })
            .collect();
        let gap = closing_gap(&on_the_spot(start, 0.0), &on_the_spot(end, 1.0));
        spread(&mut poses, &gap);
        stand_at_origin(&mut poses);
        let begin = match self.cycle {
            Some((frames, _)) => (from % frames as f32) / self.rate,
            None => from / self.rate,
        };
        let gait = Gait {
            name: recording.name.clone(),
            frame_rate: count as f32 / duration,
            poses,
            speed,
            source: String::new(),
            subject: recording.subject.clone(),
            acted: recording.acted.clone(),
            ratings: None,
            label: recording.label,
        };
        let mismatch = self.cycle.map_or_else(|| rms(&gap), |(_, mismatch)| mismatch);
        Ok(Stride { gait, begin, duration, turn, mismatch, on_the_spot: self.on_the_spot })
    }

    /// The whole cycle of a cyclic recording, from the left foot's strike (or, without any, from where the left
    /// foot is lowest in front).
    fn whole_cycle(&self, recording: &Recording, strikes: &walk::Strikes) -> Result<Option<Stride>, String> {
        let Some((count, _)) = self.cycle else { return Ok(None) };
        let second = count as f32..2.0 * count as f32;
        let begin = strikes.of_foot[0].iter().copied().find(|t| second.contains(t)).unwrap_or_else(|| {
            let heading = walk::facing(&self.poses, self.rate);
            let reach = |i: usize| {
                let pose = &self.poses[i];
                (pose[Joint::LeftFoot as usize] - pose[Joint::Root as usize]).dot(heading[i])
            };
            let furthest = (count..2 * count).max_by(|&a, &b| reach(a).total_cmp(&reach(b)));
            furthest.unwrap_or(count) as f32
        });
        self.stride(recording, begin, begin + count as f32, MAX_TURN_DEG).map(Some)
    }
}

/// Where the walker is at a phase of a stride of `travel` metres whose heading turns evenly by `turn` about the
/// heading of its chord; from its start, m, on the ground.
fn along_arc(chord_heading: f32, turn: f32, travel: f32, phase: f32) -> Vec3 {
    if turn.abs() < 1e-4 {
        return Vec3::new(libm::sinf(chord_heading), 0.0, libm::cosf(chord_heading)) * (travel * phase);
    }
    let (from, to) = (chord_heading - turn / 2.0, chord_heading + turn * (phase - 0.5));
    Vec3::new(libm::cosf(from) - libm::cosf(to), 0.0, libm::sinf(to) - libm::sinf(from)) * (travel / turn)
}

/// Puts the root's mean above the origin and the lowest point of the foot joints at y = 0.
fn stand_at_origin(poses: &mut [Pose]) {
    let root: Vec3 = poses.iter().map(|pose| pose[Joint::Root as usize]).sum::<Vec3>() / poses.len() as f32;
    let feet = poses.iter().flat_map(|pose| walk::FEET.map(|foot| pose[foot as usize].y));
    let ground = feet.fold(f32::MAX, f32::min);
    for point in poses.iter_mut().flatten() {
        *point -= Vec3::new(root.x, ground, root.z);
    }
}

/// An angle in (-pi, pi].
fn wrap(angle: f32) -> f32 {
    let turned = angle.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}

fn unusable(recording: &Recording, message: impl Into<String>) -> Error {
    Error::Unusable { name: recording.name.clone(), message: message.into() }
}
