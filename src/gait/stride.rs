//! Recordings in, gaits out: foot strikes, one stride, phase, speed (S-10, S-19; paper section 3).
//!
//! A stride runs from one strike of a foot to its next; phase 0 of its gait is the strike of the left foot in it. Both
//! feet count alike, so that the mirror image of a take gives the mirror images of its gaits. The stride is turned so that
//! the walker goes towards +z, its travel is taken out, what is left between its end and its start is spread over the
//! cycle, and the lowest point of the foot joints is put at y = 0. What is no walking is refused ([`Refusal`]); running,
//! which has the same order of the feet, is not. `v_des` is the horizontal travel over the duration; walkers on the
//! spot (treadmill, data centred on the root) first get their travel back from the foot under weight; a turn is
//! followed along its arc, named in [`Gait::provenance`], and refused beyond [`MAX_TURN_DEG`].

mod course;
mod cut;
mod filter;
mod limits;
mod refusal;
mod support;
mod take;
mod walk;

use super::{Error, Gait, Joint, Recording};
pub use course::Course;
use cut::prepare;
pub(super) use filter::{frames, low_pass, pose_at};
pub use limits::{CURVED_DEG, MAX_TURN_DEG, REPEATS};
use limits::{MAX_CRAB_DEG, MAX_RATE, OTHER_FOOT, SPEED, STRIDE_S, wrap};
pub use refusal::Refusal;
use support::Feet;
pub use support::Support;
use take::{Cut, Take};

/// One stride of a recording, and how good it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Stride {
    /// The walk cycle.
    pub gait: Gait,
    /// Strike that begins it, s from the recording's start.
    pub begin: f32,
    /// The foot that begins and ends it.
    pub foot: Joint,
    /// Duration, s.
    pub duration: f32,
    /// Turn to the walker's left over the stride, radians.
    pub turn: f32,
    /// Root mean square distance over the joints between end and start once travel and turn are out, m.
    pub mismatch: f32,
    /// Whether the walker stayed on the spot, so that speed and travel are those of the planted foot.
    pub on_the_spot: bool,
    /// What makes it a walk; none where only strikes of one foot are known.
    pub support: Option<Support>,
}

impl Stride {
    /// Whether it turns further than [`CURVED_DEG`].
    pub fn is_curved(&self) -> bool {
        self.turn.abs() > CURVED_DEG.to_radians()
    }
}

/// All strides of a recording as gaits, as [`strides`]; named `NAME` if there is one, else `NAME#1`, ...
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
#[doc(hidden)]
pub fn best(recording: &Recording) -> Result<Gait, Error> {
    let survey = survey(recording)?;
    let gait = survey.best().map(|stride| Gait { name: recording.name.clone(), ..stride.gait.clone() });
    gait.ok_or_else(|| survey.none_found(recording))
}

/// The most strides of a recording of which no two overlap, with their quality, in the order of time.
///
/// # Errors
/// [`Error::Unusable`] when there is no usable stride, with what was found.
pub fn strides(recording: &Recording) -> Result<Vec<Stride>, Error> {
    let survey = survey(recording)?;
    if survey.strides.is_empty() { Err(survey.none_found(recording)) } else { Ok(survey.apart()) }
}

/// The stride between two strikes of the left foot that are known, in frames from the recording's start: for walks whose
/// phase is known. It is cut as all others are, and refused beyond a turn of `max_turn_deg` degrees instead of
/// [`MAX_TURN_DEG`].
///
/// # Errors
/// [`Error::Unusable`] when the recording is cyclic, not finite or does not hold both strikes, or the stride turns too far,
/// is too slow or fast, or goes sideways.
#[doc(hidden)]
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
    let cut = Cut::left(from, to);
    take.stride(recording, &cut, max_turn_deg, None).map_err(|why| unusable(recording, why.to_string()))
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
    /// The usable strides in the order of time, from strikes of either foot, so that neighbours overlap by half.
    pub strides: Vec<Stride>,
    /// The others, in the order of time.
    pub refused: Vec<Refused>,
}

/// A stride that cannot be used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refused {
    /// Strike that begins it, s from the recording's start.
    pub begin: f32,
    /// The foot that begins it.
    pub foot: Joint,
    /// Why, with values and allowed range.
    pub why: Refusal,
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
    let facing = walk::facing(&take.poses, rate);
    let feet = Feet::of(&take, &facing);
    let strikes = walk::strikes(&take.poses, rate, &facing);
    let mut found = Survey {
        strikes: strikes.of_foot.each_ref().map(|times| times.iter().map(|frame| frame / rate).collect()),
        by_height: strikes.by_height,
        on_the_spot: take.on_the_spot,
        ..Survey::default()
    };
    for (side, foot) in walk::FEET.into_iter().enumerate() {
        // All strides of a repeated cycle are the same one: those of the left foot do, if there are any.
        if recording.cyclic && !found.strides.is_empty() {
            break;
        }
        for pair in strikes.of_foot[side].windows(2) {
            // Of a repeated cycle, the strides that begin in the second repetition.
            let begin_in = count as f32..2.0 * count as f32;
            if recording.cyclic && !begin_in.contains(&pair[0]) {
                continue;
            }
            let stride = cut(&strikes, side, [pair[0], pair[1]], rate)
                .and_then(|cut| take.stride(recording, &cut, MAX_TURN_DEG, Some(&feet)));
            match stride {
                Ok(stride) => found.strides.push(stride),
                Err(why) => found.refused.push(Refused { begin: pair[0] / rate, foot, why }),
            }
        }
    }
    // A treadmill's steady belt is not found in a few strides among many that are something else.
    let no_walk = found.refused.iter().filter(|refused| refused.why.is_no_walk()).count();
    if take.on_the_spot && no_walk > found.strides.len() {
        found.strides.clear();
    }
    if found.strides.is_empty() && recording.cyclic {
        let whole = take.whole_cycle(recording, &strikes);
        found.strides.extend(
            whole.map_err(|reason| unusable(recording, format!("the cycle cannot be used: {reason}")))?,
        );
    }
    found.strides.sort_by(|a, b| a.begin.total_cmp(&b.begin));
    found.refused.sort_by(|a, b| a.begin.total_cmp(&b.begin));
    for stride in &mut found.strides {
        let provenance = &mut stride.gait.provenance;
        if provenance.take.is_empty() {
            provenance.take.clone_from(&recording.name);
        }
        let notes = notes(stride, &found.by_height);
        stride.gait.provenance.notes.extend(notes);
    }
    Ok(found)
}

/// The stride between two strikes of one foot (frames), with one of the other foot between; else why it is none.
fn cut(strikes: &walk::Strikes, side: usize, [from, to]: [f32; 2], rate: f32) -> Result<Cut, Refusal> {
    let others: Vec<f32> =
        strikes.of_foot[1 - side].iter().copied().filter(|t| (from..to).contains(t)).collect();
    let &[between] = others.as_slice() else { return Err(Refusal::Turns { strikes: others.len() }) };
    let share = (between - from) / (to - from);
    if !OTHER_FOOT.contains(&share) {
        return Err(Refusal::Halves { share });
    }
    let seconds = (to - from) / rate;
    if !STRIDE_S.contains(&seconds) {
        return Err(Refusal::Duration { seconds });
    }
    Ok(Cut { foot: walk::FEET[side], from, to, between: Some(between) })
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

    /// The most strides of which no two overlap, in the order of time; numbered if there are several.
    pub fn apart(&self) -> Vec<Stride> {
        let mut in_order: Vec<&Stride> = self.strides.iter().collect();
        let end = |stride: &Stride| stride.begin + stride.duration;
        in_order.sort_by(|a, b| end(a).total_cmp(&end(b)));
        let (mut apart, mut free_from) = (Vec::<Stride>::new(), f32::MIN);
        for stride in in_order {
            // Neighbours share a strike, up to rounding.
            if stride.begin > free_from - 0.1 * stride.duration {
                free_from = end(stride);
                apart.push(stride.clone());
            }
        }
        if apart.len() > 1 {
            for (index, stride) in apart.iter_mut().enumerate() {
                stride.gait.name += &format!("#{}", index + 1);
            }
        }
        apart
    }

    /// Reasons for refusing strides, the most frequent first: how often, and the first of the kind.
    pub fn reasons(&self) -> Vec<(usize, Refusal)> {
        let mut reasons: Vec<(usize, Refusal)> = Vec::new();
        for Refused { why, .. } in &self.refused {
            let kind = std::mem::discriminant(why);
            match reasons.iter_mut().find(|(_, other)| std::mem::discriminant(other) == kind) {
                Some((count, _)) => *count += 1,
                None => reasons.push((1, *why)),
            }
        }
        reasons.sort_by_key(|(count, _)| std::cmp::Reverse(*count));
        reasons
    }

    /// The error of a recording without usable strides: what was found, and why it was refused.
    pub fn none_found(&self, recording: &Recording) -> Error {
        let [left, right] = self.strikes.each_ref().map(Vec::len);
        let mut message =
            format!("no straight stride of a walk: {left} strikes of the left foot, {right} of the right");
        if self.refused.is_empty() {
            message += "; one stride needs 2 of one foot with 1 of the other between";
        }
        for (count, why) in self.reasons() {
            message += &format!("; {count} refused, because: {why}");
        }
        unusable(recording, message)
    }
}

/// What is worth knowing of a stride beside its numbers.
fn notes(stride: &Stride, by_height: &[bool; 2]) -> Vec<String> {
    let mut notes = vec![format!("{:.2} s to {:.2} s", stride.begin, stride.begin + stride.duration)];
    if stride.is_curved() {
        notes.push(format!("curved by {:.0} degrees", stride.turn.to_degrees()));
    }
    if stride.support.is_some_and(|support| support.is_running()) {
        notes.push("running".to_owned());
    }
    if stride.on_the_spot {
        notes.push("on the spot: speed of the planted foot".to_owned());
    }
    if by_height.contains(&true) {
        notes.push("strikes by lowest foot".to_owned());
    }
    notes
}

fn unusable(recording: &Recording, message: impl Into<String>) -> Error {
    Error::Unusable { name: recording.name.clone(), message: message.into() }
}
