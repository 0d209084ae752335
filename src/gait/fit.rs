//! A gait as a mean pose and a few harmonics: fitted by least squares, stored in a few hundred bytes, read back.
//!
//! Every joint coordinate of a cycle is `mean + sum_k (cos_k cos(k phase) + sin_k sin(k phase))` (the form of Troje 2002,
//! "Decomposing biological motion", Journal of Vision 2, without its components over walkers), beside the cycle time and
//! the speed. Over a whole cycle at equal steps the least-squares fit is the discrete Fourier transform, exactly.
//! Coefficients are 16-bit integers of one unit per gait, which is some 0.05 mm; [`HarmonicGait::error`] measures what
//! is stored, rounding included.

#[doc(hidden)]
pub mod contrast;
mod file;

use super::{Error, Gait, JOINT_COUNT, Joint, JointSet, Pose, Provenance};
use crate::emotion::Emotion;
#[doc(hidden)]
pub use file::{FORMAT, MAGIC, from_bytes, is_fitted, to_bytes};
pub use file::{from_json, load, to_json};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// Default number of harmonics: feet need more than the trunk does, and with 4 the root mean square error
/// is some 3 mm (`tests/gait/fit.rs`).
#[doc(hidden)]
pub const HARMONICS: usize = 4;

/// Most harmonics of a fitted gait.
#[doc(hidden)]
pub const MOST_HARMONICS: usize = 32;

/// Frames of a gait that is made from harmonics.
#[doc(hidden)]
pub const FRAMES: usize = 64;

/// Largest stored number.
const LARGEST: f64 = 32_767.0;

/// One row of coefficients: x, y, z of every joint.
#[doc(hidden)]
pub type Row = [[i16; 3]; JOINT_COUNT];

/// A gait as a mean pose and harmonics.
#[derive(Debug, Clone, PartialEq)]
pub struct HarmonicGait {
    /// As [`Gait::name`].
    pub name: String,
    /// Duration of the cycle, s.
    pub cycle_time: f32,
    /// As [`Gait::speed`], m/s.
    pub speed: f32,
    /// As [`Gait::provenance`].
    pub provenance: Provenance,
    /// As [`Gait::acted`].
    pub acted: Option<String>,
    /// As [`Gait::ratings`].
    pub ratings: Option<[f32; 4]>,
    /// As [`Gait::label`].
    pub label: Option<Emotion>,
    /// Metres of one unit of `rows`.
    pub unit: f32,
    /// The mean pose, then the cosines and the sines of each harmonic in turn: `1 + 2 harmonics` rows.
    pub rows: Vec<Row>,
}

/// How far a fitted gait is from the one it was fitted to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitError {
    /// Root mean square distance over joints and frames, m.
    pub rms: f32,
    /// Largest distance of any joint in any frame, m.
    pub largest: f32,
    /// The joint that is farthest off.
    pub joint: Joint,
    /// Where in the cycle, in [0, 1).
    pub phase: f32,
}

/// Most harmonics that `frames` frames determine.
#[doc(hidden)]
pub const fn most_harmonics(frames: usize) -> usize {
    let determined = frames.saturating_sub(1) / 2;
    if determined < MOST_HARMONICS { determined } else { MOST_HARMONICS }
}

/// Fits `harmonics` harmonics to a gait, or as many as its frames determine ([`most_harmonics`]).
///
/// # Errors
/// [`Error::Unusable`] if the gait has no frames, positions that are not finite, an impossible frame rate, or joints that
/// were not captured (a fit cannot mark them).
pub fn fit(gait: &Gait, harmonics: usize) -> Result<HarmonicGait, Error> {
    let unusable = |message: &str| Error::Unusable { name: gait.name.clone(), message: message.to_owned() };
    gait.check_whole()?;
    if gait.poses.is_empty() {
        return Err(unusable("it has no frames, and there is nothing to fit"));
    }
    if gait.poses.iter().flatten().any(|point| !point.is_finite()) {
        return Err(unusable("positions are not finite"));
    }
    let cycle_time = gait.cycle_time();
    if !(cycle_time > 0.0 && cycle_time.is_finite()) {
        return Err(unusable("its frame rate must be above 0"));
    }
    let count = gait.poses.len();
    let mut rows = vec![project(gait, |_| 1.0 / real(count))];
    for harmonic in 1..=harmonics.min(most_harmonics(count)) {
        for turn in [libm::cos, libm::sin] {
            let scale = 2.0 / real(count);
            rows.push(project(gait, |frame| {
                scale * turn(TAU * real(harmonic * frame % count) / real(count))
            }));
        }
    }
    let largest = rows.iter().flatten().map(|point| point.abs().max_element()).fold(0.0, f64::max);
    let unit = single((largest / LARGEST).max(1e-6));
    let rows = rows
        .iter()
        .map(|row| row.map(|point| point.to_array().map(|value| rounded(value / f64::from(unit)))));
    Ok(HarmonicGait {
        name: gait.name.clone(),
        cycle_time,
        speed: gait.speed,
        provenance: gait.provenance.clone(),
        acted: gait.acted.clone(),
        ratings: gait.ratings,
        label: gait.label,
        unit,
        rows: rows.collect(),
    })
}

/// Sum of the poses, each times the weight of its frame.
fn project(gait: &Gait, weight: impl Fn(usize) -> f64) -> [DVec3; JOINT_COUNT] {
    let mut sum = [DVec3::ZERO; JOINT_COUNT];
    for (frame, pose) in gait.poses.iter().enumerate() {
        let weight = weight(frame);
        for (sum, point) in sum.iter_mut().zip(pose) {
            *sum += point.as_dvec3() * weight;
        }
    }
    sum
}

impl HarmonicGait {
    /// Number of harmonics.
    pub const fn harmonics(&self) -> usize {
        self.rows.len().saturating_sub(1) / 2
    }

    /// Joint positions at `phase` in [0, 1), metres, as [`Gait::poses`].
    pub fn pose(&self, phase: f64) -> Pose {
        let mut pose = [DVec3::ZERO; JOINT_COUNT];
        for (index, row) in self.rows.iter().enumerate() {
            let angle = TAU * (real(index.div_ceil(2)) * phase).fract();
            let weight = match index {
                0 => 1.0,
                odd if odd % 2 == 1 => libm::cos(angle),
                _ => libm::sin(angle),
            };
            for (point, stored) in pose.iter_mut().zip(row) {
                *point += DVec3::from_array(stored.map(f64::from)) * (weight * f64::from(self.unit));
            }
        }
        pose.map(|point| Vec3::new(single(point.x), single(point.y), single(point.z)))
    }

    /// The gait of `frames` frames (at least 2); its lowest foot is put on the ground again.
    pub fn to_gait(&self, frames: usize) -> Gait {
        let frames = frames.max(2);
        let mut poses: Vec<Pose> = (0..frames).map(|frame| self.pose(real(frame) / real(frames))).collect();
        let foot = |pose: &Pose| pose[Joint::LeftFoot as usize].y.min(pose[Joint::RightFoot as usize].y);
        let ground = poses.iter().map(foot).fold(f32::MAX, f32::min);
        for point in poses.iter_mut().flatten() {
            point.y -= ground;
        }
        let mut provenance = self.provenance.clone();
        provenance.notes.push(format!("{} harmonics", self.harmonics()));
        Gait {
            name: self.name.clone(),
            frame_rate: single(real(frames) / f64::from(self.cycle_time)),
            poses,
            speed: self.speed,
            provenance,
            acted: self.acted.clone(),
            ratings: self.ratings,
            label: self.label,
            missing: JointSet::default(),
        }
    }

    /// How far this is from `gait`, at the gait's own frames.
    pub fn error(&self, gait: &Gait) -> FitError {
        let mut error = FitError { rms: 0.0, largest: -1.0, joint: Joint::Root, phase: 0.0 };
        let mut squares = 0.0;
        for (frame, pose) in gait.poses.iter().enumerate() {
            let phase = real(frame) / real(gait.poses.len());
            for (joint, (found, wanted)) in Joint::ALL.into_iter().zip(self.pose(phase).iter().zip(pose)) {
                let distance = found.distance(*wanted);
                squares += f64::from(distance).powi(2);
                if distance > error.largest {
                    error = FitError { largest: distance, joint, phase: single(phase), ..error };
                }
            }
        }
        error.rms = single((squares / real((gait.poses.len() * JOINT_COUNT).max(1))).sqrt());
        error.largest = error.largest.max(0.0);
        error
    }

    /// Bytes of the numbers: coefficients, unit, cycle time and speed; without names.
    pub const fn bytes(&self) -> usize {
        self.rows.len() * size_of::<Row>() + 3 * size_of::<f32>()
    }
}

#[allow(clippy::cast_precision_loss, reason = "numbers of frames and harmonics")]
const fn real(count: usize) -> f64 {
    count as f64
}

#[allow(clippy::cast_possible_truncation, reason = "rounding to f32 is the purpose")]
const fn single(value: f64) -> f32 {
    value as f32
}

#[allow(clippy::cast_possible_truncation, reason = "clamped to the range of i16")]
fn rounded(value: f64) -> i16 {
    value.round().clamp(-LARGEST, LARGEST) as i16
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cycle of `frames` frames made of 2 harmonics with known coefficients.
    fn known(frames: usize) -> Gait {
        let pose = |frame: usize| -> Pose {
            let angle = TAU * real(frame) / real(frames);
            std::array::from_fn(|joint| {
                let j = real(joint);
                DVec3::new(
                    0.1 * j + 0.05 * angle.cos(),
                    1.0 - 0.02 * j + 0.03 * (2.0 * angle).sin(),
                    0.2 * angle.sin() - 0.01 * (2.0 * angle).cos(),
                )
                .as_vec3()
            })
        };
        Gait {
            name: "known".into(),
            poses: (0..frames).map(pose).collect(),
            frame_rate: 30.0,
            speed: 1.2,
            ..Gait::default()
        }
    }

    #[test]
    fn known_coefficients_come_back_to_the_rounding() {
        for frames in [5, 18, 31, 64] {
            let fitted = fit(&known(frames), 2).unwrap();
            let coefficient = |row: usize, joint: usize, axis: usize| {
                f32::from(fitted.rows[row][joint][axis]) * fitted.unit
            };
            let near =
                |found: f32, wanted: f32| assert!((found - wanted).abs() < fitted.unit, "{found} {wanted}");
            near(coefficient(0, 3, 0), 0.3);
            near(coefficient(1, 3, 0), 0.05);
            near(coefficient(2, 3, 2), 0.2);
            near(coefficient(3, 7, 2), -0.01);
            near(coefficient(4, 7, 1), 0.03);
            near(coefficient(2, 3, 0), 0.0);
            assert!(fitted.error(&known(frames)).largest < 3.0 * fitted.unit);
        }
    }

    #[test]
    fn frames_bound_the_harmonics_and_unusable_gaits_are_refused() {
        assert_eq!(fit(&known(5), 9).unwrap().harmonics(), 2);
        assert_eq!(fit(&known(2), 9).unwrap().harmonics(), 0);
        assert_eq!(fit(&known(200), 99).unwrap().harmonics(), MOST_HARMONICS);
        assert!(fit(&Gait { poses: vec![], ..known(2) }, 1).is_err());
        assert!(fit(&Gait { frame_rate: 0.0, ..known(9) }, 1).is_err());
        let mut broken = known(9);
        broken.poses[3][2].x = f32::NAN;
        assert!(fit(&broken, 1).unwrap_err().to_string().contains("not finite"));
    }

    #[test]
    fn the_error_names_the_joint_and_the_phase_that_are_farthest_off() {
        let fitted = fit(&known(64), 2).unwrap();
        let mut moved = known(64);
        moved.poses[16][Joint::LeftHand as usize].y += 0.1;
        let error = fitted.error(&moved);
        assert_eq!((error.joint, error.phase), (Joint::LeftHand, 0.25));
        assert!((error.largest - 0.1).abs() < 1e-3);
        assert!((error.rms - 0.1 / (64.0 * 16.0_f32).sqrt()).abs() < 1e-4);
    }
}
