//! Figures of neutral walks at other speeds than people's usual one, beside those of people.
//!
//! Knee, ankle and hip: Schwartz, Rozumalski and Trost 2008 (J Biomech 41:1639), slow, free and fast. Tolerances: 5 degrees for
//! the knee under load, as speed changes it by 4 and 7; for the others how far these free walks agree with the adults of
//! CGM2.3 (8 degrees the knee, 6 the hip, 5 the ankle). The cadence follows from the walk ratio. What else is measured of
//! walks at a usual speed has the same target at each.

use super::angles::{Angle, Side, Walk, mean, range};
use super::report::{SCALARS, Scalar, WALK_RATIO};
use serde::Serialize;
use std::collections::BTreeMap;
use std::ops::Range;

/// Speeds at which bodies are measured, m/s: slow, free and fast.
pub(crate) const SPEEDS: [f32; 3] = [0.8, 1.25, 1.7];

/// A figure of the angles, with its targets at [`SPEEDS`] and their tolerance, degrees.
struct Figure {
    name: &'static str,
    of: fn(&Walk) -> f32,
    people: [f32; SPEEDS.len()],
    tolerance: f32,
}

const FIGURES: [Figure; 4] = [
    Figure {
        name: "knee_under_load_deg",
        of: |walk| both(walk, Angle::Knee, |knee| most(knee, 5..25)),
        people: [12.0, 19.0, 23.0],
        tolerance: 5.0,
    },
    Figure {
        name: "knee_in_swing_deg",
        of: |walk| both(walk, Angle::Knee, |knee| most(knee, 55..90)),
        people: [54.0, 58.0, 60.0],
        tolerance: 8.0,
    },
    Figure {
        name: "ankle_at_push_off_deg",
        of: |walk| both(walk, Angle::Ankle, |ankle| ankle[ankle.len() * 6 / 10]),
        people: [-2.0, -14.0, -20.0],
        tolerance: 5.0,
    },
    Figure {
        // of the thigh against the vertical, since no joint tells how the pelvis tips
        name: "hip_range_deg",
        of: |walk| both(walk, Angle::Thigh, range),
        people: [36.0, 42.0, 48.0],
        tolerance: 6.0,
    },
];

/// The neutral crowd as drawn at one speed.
#[derive(Debug, Serialize)]
pub(crate) struct AtSpeed {
    /// m/s.
    pub(crate) speed: f32,
    pub(crate) scalars: BTreeMap<&'static str, Scalar>,
}

/// The figures of walks that are drawn at the speed of this number of [`SPEEDS`].
pub(crate) fn at_speed(number: usize, walks: &[Walk]) -> AtSpeed {
    let speed = SPEEDS[number];
    let crowd = |of: fn(&Walk) -> f32| mean(&walks.iter().map(of).collect::<Vec<_>>());
    let usual = SCALARS.into_iter().map(|(name, of, target, tolerance)| {
        let target = if name == "cadence_steps_per_min" { cadence(speed) } else { target };
        (name, Scalar::new(crowd(of), target, tolerance))
    });
    let by_speed = FIGURES
        .iter()
        .map(|figure| (figure.name, Scalar::new(crowd(figure.of), figure.people[number], figure.tolerance)));
    AtSpeed { speed, scalars: usual.chain(by_speed).collect() }
}

/// Of people whose steps are as long to their rate as usual, steps a minute.
fn cadence(speed: f32) -> f32 {
    (60.0 * speed / WALK_RATIO).sqrt()
}

/// Mean of both sides.
fn both(walk: &Walk, angle: Angle, of: impl Fn(&[f32]) -> f32) -> f32 {
    let curves = Side::BOTH.iter().filter_map(|side| walk.curve(angle, *side));
    mean(&curves.map(|curve| of(&curve)).collect::<Vec<_>>())
}

/// The most between two percentages of the stride.
fn most(curve: &[f32], percent: Range<usize>) -> f32 {
    let count = curve.len();
    curve[count * percent.start / 100..count * percent.end / 100].iter().copied().fold(f32::MIN, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cadence_is_that_of_people_at_a_usual_speed_and_goes_with_the_root_of_it() {
        assert!((cadence(1.25) - 107.0).abs() < 1.0, "{}", cadence(1.25));
        assert!((cadence(0.8) / cadence(1.25) - (0.8_f32 / 1.25).sqrt()).abs() < 1e-6);
    }

    #[test]
    fn the_most_is_looked_for_where_it_is_asked_for() {
        let curve: Vec<f32> = (0..50_u8).map(f32::from).collect();
        assert_eq!((most(&curve, 0..100), most(&curve, 10..20)), (49.0, 9.0));
        let falling: Vec<f32> = curve.into_iter().rev().collect();
        assert_eq!((most(&falling, 0..100), most(&falling, 10..20)), (49.0, 44.0));
    }
}
