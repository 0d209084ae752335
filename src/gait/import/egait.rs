//! The traps of the E-Gait data, repaired.
use super::repair::{BODY_LENGTH, Unit, body_length, check_sides, finish};
use super::Options;
use crate::gait::{Error, Joint, Pose, Recording};
use glam::{Quat, Vec3};

/// x
pub fn level_a(poses: &[Pose]) -> Quat {
    let mean = |f: &dyn Fn(&Pose) -> Vec3| poses.iter().map(f).sum::<Vec3>() / poses.len().max(1) as f32;
    let up = mean(&|p| p[0] - (p[Joint::LeftFoot as usize] + p[Joint::RightFoot as usize]) / 2.0);
    let across = mean(&|p| p[Joint::LeftHip as usize] - p[Joint::RightHip as usize] + p[4] - p[7]);
    from_up_across(up, across)
}

fn from_up_across(up: Vec3, across: Vec3) -> Quat {
    let x = across.normalize_or(Vec3::X);
    let y = (up - x * up.dot(x)).normalize_or(Vec3::Y);
    let z = x.cross(y);
    // world axes -> body axes; keep the heading of +z.
    let turn = Quat::from_mat3(&glam::Mat3::from_cols(x, y, z)).inverse();
    // undo the yaw: the original +z should stay in the y-z plane
    let f = turn * Vec3::Z;
    Quat::from_rotation_y(-f.x.atan2(f.z)) * turn
}

/// x
pub fn level_b(poses: &[Pose]) -> Quat {
    let mut level = level_a(poses);
    for _ in 0..4 {
        let mut n = 0.0; let mut sz = 0.0; let mut sy = 0.0; let mut szz = 0.0; let mut szy = 0.0;
        for p in poses {
            let a = level * p[12]; let b = level * p[15];
            for f in [if a.y < b.y { a } else { b }] {
                n += 1.0; sz += f.z; sy += f.y; szz += f.z * f.z; szy += f.z * f.y;
            }
        }
        let slope: f32 = (n * szy - sz * sy) / (n * szz - sz * sz).max(1e-9);
        level = Quat::from_rotation_x(slope.atan()) * level;
    }
    level
}

/// x
pub(super) fn repair(mut take: Recording, options: &Options) -> Result<Recording, Error> {
    let _ = (BODY_LENGTH, body_length(&take.poses), check_sides as fn(&mut Recording));
    take.cyclic = true;
    finish(take, Unit::Unstated, options)
}
