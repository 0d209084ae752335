//! The traps of the E-Gait data, repaired.
//!
//! Every E-Gait gait was scaled and turned so that its first pose fits the first pose of gait 0, joint by joint.
//! Gait 0 leans: true up is about (0, 0.98, -0.21) in all of them, a pitch of 12 degrees. One unit is about 1.3 m.
//! The root is pinned, so that neither travel nor bounce is in the data (`stride` restores both from the planted
//! foot). And the order of the sides is not the same throughout: in the CMU and ICT gaits the right arm
//! and leg come first and the walker faces +z, in all BML and most `EWalk` gaits the left ones do and the walker
//! faces -z. The bend of the knees tells which, gait by gait: in 149 of the 232 gaits left and right are exchanged.
//!
//! What is repaired: the pitch is levelled, the size brought to metres, and left made left. What is not: each gait's own
//! small turn and scale, which cannot be inferred from the data, and travel, which `stride` infers. Every repair is a line of
//! [`Recording::report`], which `gaitway gait import --report` prints. [`Options::as_published`] repairs nothing.
//!
//! Measured against the CMU trials that nine of the gaits are cut from (`tests/gait/import/data.rs`): pitch 12.1 degrees,
//! standard deviation 1.3; the legs match to the last digit at 1.27 m a unit (1.19 to 1.31).

use super::Options;
use super::repair::{Unit, body_length, finish};
use crate::gait::{Error, Joint, Pose, Recording, norm};
use glam::{Quat, Vec3};

/// Metres per unit (ours): between the 1.27 of the CMU gaits, whose trunk lacks a link of 11 cm and which are too large
/// in units for it, and the 1.35 that gives the other sources' heads an adult's height.
const METRES_PER_UNIT: f32 = 1.32;
/// Pitch of all gaits about x, degrees, mean of the CMU trials (ours).
const PITCH_DEG: f32 = 12.1;
/// A pitch within these says that the gait still carries E-Gait's; beyond, up is not y.
const PITCHED_DEG: std::ops::Range<f32> = 5.0..30.0;

/// Levels, scales and marks as cyclic a take in E-Gait's layout. What is pitched or sized otherwise (a file of the
/// same layout that was repaired before) is only measured, not turned.
///
/// # Errors
/// [`Error::Unusable`] if the body has no size or positions are not finite.
pub(super) fn repair(mut take: Recording, options: &Options) -> Result<Recording, Error> {
    norm::stand_in(&mut take.poses, take.missing);
    if options.as_published {
        take.cyclic = root_is_pinned(&take.poses);
        take.report.push("E-Gait: as published; pitch, size and sides are those of the file".to_owned());
        return Ok(take);
    }
    let pitch = pitch_deg(&take.poses);
    if PITCHED_DEG.contains(&-pitch) {
        let level = Quat::from_rotation_x(PITCH_DEG.to_radians());
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
fn pitch_deg(poses: &[Pose]) -> f32 {
    let rise = |pose: &Pose| {
        let ankles = (pose[Joint::LeftFoot as usize] + pose[Joint::RightFoot as usize]) / 2.0;
        pose[Joint::Root as usize] - ankles
    };
    let up: Vec3 = poses.iter().map(rise).sum();
    libm::atan2f(up.z, up.y).to_degrees()
}

fn root_is_pinned(poses: &[Pose]) -> bool {
    let Some(first) = poses.first() else { return false };
    poses.iter().all(|pose| pose[Joint::Root as usize].distance(first[Joint::Root as usize]) < 1e-4)
}
