//! AMASS pose parameters: an axis-angle rotation for each joint of SMPL, and where the root goes.
//!
//! The body model that turns AMASS's shape numbers into bones is not free. Rotations alone pose any skeleton whose rest
//! pose is a T-pose, so they pose ours: an adult of 1.70 m, lengths after Drillis and Contini (1966). Positions
//! are therefore those of that body, not of the walker's own; angles, timing and travel are the walker's.

use super::super::text::MAX_MAGNITUDE;
use super::super::{of_file, stem};
use super::npy::Array;
use super::{SMPL, single};
use crate::gait::Recording;
use crate::gait::import::joint_map;
use glam::{Quat, Vec3};

/// Parent of each joint of [`SMPL`].
const PARENT: [usize; 22] = [0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19];

/// From the parent to the joint in the rest pose, m; y up, facing +z, left at +x.
const OFFSET: [[f32; 3]; 22] = [
    [0.0, 0.0, 0.0],
    [0.09, -0.04, 0.0],
    [-0.09, -0.04, 0.0],
    [0.0, 0.11, 0.0],
    [0.0, -0.416, 0.0],
    [0.0, -0.416, 0.0],
    [0.0, 0.13, 0.0],
    [0.0, -0.418, 0.0],
    [0.0, -0.418, 0.0],
    [0.0, 0.06, 0.0],
    [0.0, -0.06, 0.13],
    [0.0, -0.06, 0.13],
    [0.0, 0.2, 0.0],
    [0.06, 0.13, 0.0],
    [-0.06, 0.13, 0.0],
    [0.0, 0.12, 0.03],
    [0.12, 0.02, 0.0],
    [-0.12, 0.02, 0.0],
    [0.306, 0.0, 0.0],
    [-0.306, 0.0, 0.0],
    [0.255, 0.0, 0.0],
    [-0.255, 0.0, 0.0],
];

/// The take that `poses` `[T][66 or more]` and `travel` `[T][3]` describe, in the frame of the file (z up in AMASS).
pub(super) fn recording(
    path: &str,
    poses: &Array<'_>,
    travel: &Array<'_>,
    rate: f32,
) -> Result<Recording, String> {
    let (&[frames, width], &[rows, 3]) = (poses.shape.as_slice(), travel.shape.as_slice()) else {
        return Err(format!(
            "poses {:?} and trans {:?}; AMASS has [frames][66 or more] and [frames][3]",
            poses.shape, travel.shape
        ));
    };
    if width < 3 * SMPL.len() || rows != frames {
        return Err(format!(
            "poses {:?} and trans {:?}; AMASS has [frames][66 or more] and [frames][3]",
            poses.shape, travel.shape
        ));
    }
    let (rig, sources) = joint_map::find(&SMPL)?;
    let vector = |array: &Array<'_>, frame: usize, first: usize| -> Result<Vec3, String> {
        let mut v = Vec3::ZERO;
        for axis in 0..3 {
            let value = array.number(&[frame, first + axis]).unwrap_or(f64::NAN);
            if value.is_nan() || value.abs() > f64::from(MAX_MAGNITUDE) {
                return Err(format!("frame {frame}: a value is {value}; it must be a finite number"));
            }
            v[axis] = single(value);
        }
        Ok(v)
    };
    let mut world = [(Quat::IDENTITY, Vec3::ZERO); SMPL.len()];
    let mut found = Vec::with_capacity(frames);
    for frame in 0..frames {
        for joint in 0..SMPL.len() {
            let local = Quat::from_scaled_axis(vector(poses, frame, 3 * joint)?);
            world[joint] = if joint == 0 {
                (local, vector(travel, frame, 0)?)
            } else {
                let (parent, at) = world[PARENT[joint]];
                ((parent * local).normalize(), at + parent * Vec3::from_array(OFFSET[joint]))
            };
        }
        found.push(sources.pose(|joint| world[joint].1));
    }
    let report = vec![
        format!("AMASS: rotations of {} joints, {frames} frames, posed on a skeleton of our own", SMPL.len()),
        format!("joint map: {rig}"),
    ];
    let provenance = of_file(path, "AMASS");
    Ok(Recording { provenance, report, ..Recording::new(stem(path), rate, found) })
}
