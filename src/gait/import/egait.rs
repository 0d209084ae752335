//! The traps of the E-Gait data, repaired.
//!
//! Every E-Gait gait was scaled and turned so that its first pose fits the first pose of gait 0, which leans:
//! all of them are pitched forward by about 12 degrees, one unit is about 1.4 m, and the root is pinned, so
//! neither travel nor bounce is in the data (`stride` restores both from the planted foot). Measured against
//! the nine CMU trials of the same names: pitch 12.1 degrees, standard deviation 1.3; unit 1.41 m, 3 %.

use super::Options;
use super::repair::{Unit, body_length, finish};
use crate::gait::{Error, Joint, Pose, Recording};
use glam::{Quat, Vec3};

/// Metres per unit, mean of the CMU trials (ours; range 1.36 to 1.46).
const METRES_PER_UNIT: f32 = 1.41;
/// Forward pitch of all gaits, degrees, mean of the CMU trials (ours).
const PITCH_DEG: f32 = 12.1;
/// The root stands this far in front of the ankles' mean on level ground, degrees (ours, mean of the CMU trials).
const ROOT_LEAN_DEG: f32 = 2.2;
/// A forward pitch beyond this says that the gait still carries E-Gait's.
const PITCHED_DEG: f32 = 5.0;

/// Levels, scales and marks as cyclic a take in E-Gait's layout. What is pitched or sized otherwise (a file of the
/// same layout that was repaired before) is only measured, not turned.
///
/// # Errors
/// [`Error::Unusable`] if the body has no size or positions are not finite.
pub(super) fn repair(mut take: Recording, options: &Options) -> Result<Recording, Error> {
    let pitch = forward_pitch_deg(&take.poses) - ROOT_LEAN_DEG;
    if pitch < -PITCHED_DEG {
        let level = Quat::from_rotation_x(-PITCH_DEG.to_radians());
        for point in take.poses.iter_mut().flatten() {
            *point = level * *point;
        }
        take.report.push(format!(
            "E-Gait: pitched forward (measured {:.1} degrees), levelled by {PITCH_DEG}",
            -pitch
        ));
    }
    take.cyclic = root_is_pinned(&take.poses);
    if take.cyclic {
        take.report
            .push("E-Gait: root pinned; one cycle, travel and bounce come from the planted foot".to_owned());
    }
    // A body of about one unit is E-Gait's; anything else has a unit of its own.
    let size = body_length(&take.poses);
    let unit = if (0.8..=1.4).contains(&size) && take.cyclic {
        Unit::Stated(METRES_PER_UNIT)
    } else {
        Unit::Unstated
    };
    finish(take, unit, options)
}

/// Angle of the line from the ankles' mean to the root against +y, degrees, positive when it leans towards +z.
fn forward_pitch_deg(poses: &[Pose]) -> f32 {
    let rise = |pose: &Pose| {
        let ankles = (pose[Joint::LeftFoot as usize] + pose[Joint::RightFoot as usize]) / 2.0;
        pose[Joint::Root as usize] - ankles
    };
    let up: Vec3 = poses.iter().map(rise).sum();
    up.z.atan2(up.y).to_degrees()
}

fn root_is_pinned(poses: &[Pose]) -> bool {
    let Some(first) = poses.first() else { return false };
    poses.iter().all(|pose| pose[Joint::Root as usize].distance(first[Joint::Root as usize]) < 1e-4)
}
