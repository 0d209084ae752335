//! What every importer does at the end: unit of length, up axis, left and right. Each leaves a line in the report.

use super::{Options, heading, text};
use crate::gait::{Error, Joint, Pose, Recording, norm};
use glam::Vec3;

/// Length of foot, knee, hip and root, spine, neck, head of an adult, m (mean of the CMU walkers).
pub(crate) const BODY_LENGTH: f32 = 1.36;

/// Units of length that motion files use: metres per unit and name.
const UNITS: [(f32, &str); 6] = [
    (1.0, "metres"),
    (0.01, "centimetres"),
    (0.001, "millimetres"),
    (0.0254, "inches"),
    (0.3048, "feet"),
    (0.0254 / 0.45, "CMU units of 1/0.45 inch"),
];

/// Standard deviation of the distance from hip to ankle beyond which the legs are moving, m.
const MOVING_LEGS: f32 = 0.01;

/// What the format says about the unit of length.
#[derive(Debug, Clone, Copy)]
pub(super) enum Unit {
    /// Metres per unit, as the file states it.
    Stated(f32),
    /// To be inferred from the size of the body.
    Unstated,
}

/// Turns file units into metres, the file's up axis into +y, and checks that left is left.
///
/// # Errors
/// [`Error::Unusable`] when there are no frames or the body has no size.
pub(super) fn finish(mut take: Recording, unit: Unit, options: &Options) -> Result<Recording, Error> {
    if take.poses.is_empty() {
        return Err(unusable(&take.name, "no frames; at least 1 is needed"));
    }
    norm::stand_in(&mut take.poses, take.missing);
    if !take.missing.is_empty() {
        take.report.push(format!(
            "warning: not captured: {}; the gait walks with the upper body of the norm there",
            take.missing
        ));
    }
    let size = body_length(&take.poses);
    if !(size > 1e-6 && size.is_finite()) {
        let message = format!("the body is {size} units from foot to head; the joints fall together");
        return Err(unusable(&take.name, message));
    }
    let (metres_per_unit, line) = match (options.metres_per_unit, unit) {
        (Some(given), _) if given > 0.0 && given.is_finite() => (given, format!("unit: {given} m, as given")),
        (Some(given), _) => {
            return Err(unusable(&take.name, format!("metres per unit is {given}; it must be positive")));
        }
        (None, Unit::Stated(stated)) => (stated, format!("unit: {stated:.6} m, as the file states")),
        (None, Unit::Unstated) => infer_unit(size),
    };
    take.report.push(line);
    if !(0.3..=4.0).contains(&(size * metres_per_unit)) {
        let metres = size * metres_per_unit;
        take.report.push(format!("warning: body length {metres:.2} m; an adult has about {BODY_LENGTH} m"));
    }
    for point in take.poses.iter_mut().flatten() {
        *point *= metres_per_unit;
    }
    turn_up(&mut take);
    check_sides(&mut take);
    if take.poses.iter().flatten().any(|point| !point.is_finite()) {
        return Err(unusable(&take.name, "positions are not finite"));
    }
    take.report.extend(heading::line(&take));
    Ok(take)
}

/// The nearest known unit if the body is within a factor 1.35 of an adult's in it; else a scale to an adult.
fn infer_unit(size: f32) -> (f32, String) {
    let misfit = |metres: f32| libm::logf(size * metres / BODY_LENGTH).abs();
    let best = UNITS.into_iter().min_by(|a, b| misfit(a.0).total_cmp(&misfit(b.0)));
    match best {
        Some((metres, name)) if misfit(metres) < 0.3 => {
            (metres, format!("unit: {name}, inferred from a body of {size:.3} units"))
        }
        _ => {
            let metres = BODY_LENGTH / size;
            (
                metres,
                format!("unit: unknown; scaled by {metres:.4} to an adult's body length of {BODY_LENGTH} m"),
            )
        }
    }
}

/// Foot, knee, hip, and root, spine, neck, head along the bones, median over up to 64 frames, file units.
pub(crate) fn body_length(poses: &[Pose]) -> f32 {
    let bones = [
        (Joint::LeftFoot, Joint::LeftKnee),
        (Joint::LeftKnee, Joint::LeftHip),
        (Joint::RightFoot, Joint::RightKnee),
        (Joint::RightKnee, Joint::RightHip),
    ];
    let trunk = [(Joint::Root, Joint::Spine), (Joint::Spine, Joint::Neck), (Joint::Neck, Joint::Head)];
    let length = |pose: &Pose, bones: &[(Joint, Joint)]| {
        bones.iter().map(|&(a, b)| pose[a as usize].distance(pose[b as usize])).sum::<f32>()
    };
    let step = poses.len().div_ceil(64).max(1);
    let mut lengths: Vec<f32> =
        poses.iter().step_by(step).map(|pose| length(pose, &bones) / 2.0 + length(pose, &trunk)).collect();
    lengths.sort_by(f32::total_cmp);
    lengths.get(lengths.len() / 2).copied().unwrap_or(0.0)
}

/// Turns the axis along which the head is above the feet into +y.
fn turn_up(take: &mut Recording) {
    let mean_feet = |pose: &Pose| (pose[Joint::LeftFoot as usize] + pose[Joint::RightFoot as usize]) / 2.0;
    let upright: Vec3 = take.poses.iter().map(|pose| pose[Joint::Head as usize] - mean_feet(pose)).sum();
    let axis = upright.normalize_or_zero();
    type Turn = fn(Vec3) -> Vec3;
    let turn: Option<(Turn, &str)> = match axis.abs().max_position() {
        1 if axis.y >= 0.0 => None,
        1 => Some((|p| Vec3::new(p.x, -p.y, -p.z), "-y")),
        2 if axis.z >= 0.0 => Some((|p| Vec3::new(p.x, p.z, -p.y), "+z")),
        2 => Some((|p| Vec3::new(p.x, -p.z, p.y), "-z")),
        _ if axis.x >= 0.0 => Some((|p| Vec3::new(-p.y, p.x, p.z), "+x")),
        _ => Some((|p| Vec3::new(p.y, -p.x, p.z), "-x")),
    };
    match turn {
        None => take.report.push("up axis: +y".to_owned()),
        Some((turn, name)) => {
            for point in take.poses.iter_mut().flatten() {
                *point = turn(*point);
            }
            take.report.push(format!("up axis: {name}, turned to +y"));
        }
    }
    if axis.abs().max_element() < 0.8 {
        take.report.push("warning: the body is not upright on average; the up axis is a guess".to_owned());
    }
}

/// Which way the knees bend, seen from the front that the hips' names give.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Knees {
    Forwards,
    Backwards,
    Straight,
}

/// Compares how far each knee stands in front of the line from hip to ankle when the leg is short with when it is
/// long: a constant offset (markers on the skin, hips placed too far in front) does not count. Legs that never
/// change length are judged by the offset itself.
fn knees(poses: &[Pose]) -> Knees {
    let (mut offset_sum, mut covariance, mut variance) = (0.0, 0.0, 0.0);
    for [hip, knee, foot] in [
        [Joint::LeftHip, Joint::LeftKnee, Joint::LeftFoot],
        [Joint::RightHip, Joint::RightKnee, Joint::RightFoot],
    ] {
        let offset_and_length = |pose: &Pose| {
            let across = pose[Joint::LeftHip as usize] - pose[Joint::RightHip as usize];
            let front = across.with_y(0.0).normalize_or_zero().cross(Vec3::Y);
            let (leg, thigh) =
                (pose[foot as usize] - pose[hip as usize], pose[knee as usize] - pose[hip as usize]);
            let on_line = leg * (thigh.dot(leg) / leg.length_squared().max(1e-12));
            ((thigh - on_line).dot(front), leg.length())
        };
        let pairs: Vec<(f32, f32)> = poses.iter().map(offset_and_length).collect();
        let count = pairs.len() as f32;
        let offset_mean = pairs.iter().map(|p| p.0).sum::<f32>() / count;
        let length_mean = pairs.iter().map(|p| p.1).sum::<f32>() / count;
        offset_sum += offset_mean;
        covariance += pairs.iter().map(|p| (p.0 - offset_mean) * (length_mean - p.1)).sum::<f32>() / count;
        variance += pairs.iter().map(|p| (p.1 - length_mean).powi(2)).sum::<f32>() / count;
    }
    // Metres of offset per metre of shortening (walking: about 1), or metres of offset.
    let (bend, least) =
        if variance > MOVING_LEGS.powi(2) { (covariance / variance, 0.2) } else { (offset_sum, 0.01) };
    match bend {
        bend if bend > least => Knees::Forwards,
        bend if bend < -least => Knees::Backwards,
        _ => Knees::Straight,
    }
}

/// Swaps left and right when the knees bend backwards otherwise: a person facing +z has the left hand at +x.
fn check_sides(take: &mut Recording) {
    let line = match knees(&take.poses) {
        Knees::Forwards => "sides: left is left (checked by the bend of the knees)",
        Knees::Straight => "sides: the knees are too straight to check left and right; taken as named",
        Knees::Backwards => {
            take.poses.iter_mut().for_each(swap_sides);
            "sides: the knees bend backwards; left and right are exchanged in the file (or its axes are \
             left-handed), joints swapped"
        }
    };
    take.report.push(line.to_owned());
}

/// Exchanges the joints of the two sides.
fn swap_sides(pose: &mut Pose) {
    let original = *pose;
    for joint in Joint::ALL {
        pose[joint as usize] = original[joint.mirrored() as usize];
    }
}

fn unusable(name: &str, message: impl Into<String>) -> Error {
    Error::Unusable { name: name.to_owned(), message: message.into() }
}

/// Frame rate from the options or from the file, which states it at a line; with a line for the report.
pub(super) fn rate_stated(
    options: &Options,
    path: &str,
    line: usize,
    stated: f32,
) -> Result<(f32, String), Error> {
    match options.frame_rate {
        Some(given) => {
            let report = format!("frame rate: {given} Hz, as given (the file states {stated:.2} Hz)");
            Ok((text::frame_rate(path, 0, given)?, report))
        }
        None => {
            let rate = text::frame_rate(path, line, stated)?;
            Ok((rate, format!("frame rate: {rate:.2} Hz, as the file states")))
        }
    }
}

/// Frame rate from the options or a default, with a line for the report.
pub(super) fn rate_or(options: &Options, path: &str, default: f32) -> Result<(f32, String), Error> {
    match options.frame_rate {
        Some(given) => Ok((text::frame_rate(path, 0, given)?, format!("frame rate: {given} Hz, as given"))),
        None => Ok((default, format!("frame rate: {default} Hz, assumed (the file does not say)"))),
    }
}
