//! The course of a whole take: on the spot, straight or curved, and whether body and travel agree.

use super::{walk, wrap};
use crate::gait::{Joint, Recording};
use crate::ground::{ground_from_world, heading_from_ground};
use glam::Vec3;

/// Fewest frames that have a course.
const LEAST_FRAMES: usize = 12;

/// Where a take goes. Headings in degrees from +z, positive towards +x (to the left of a walker towards +z).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Course {
    /// Whether the walker stays on the spot: a treadmill, or travel that was taken out.
    pub on_the_spot: bool,
    /// From the first to the last position of the root, on the ground, m.
    pub travel: f32,
    /// Heading from the first to the last position of the root.
    pub heading_deg: f32,
    /// Mean direction in which the body faces.
    pub facing_deg: f32,
    /// Turn of the body from the first to the last frame, positive to the left; whole turns count.
    pub turn_deg: f32,
    /// From the mean direction of travel, frame by frame, to where the body faces.
    pub crab_deg: f32,
}

impl Course {
    /// The course of a recording; `None` if it is too short or not finite.
    pub fn of(recording: &Recording) -> Option<Self> {
        let poses = &recording.poses;
        let usable = poses.len() >= LEAST_FRAMES && poses.iter().flatten().all(|point| point.is_finite());
        let (first, last) = (poses.first()?, poses.last()?);
        if !usable {
            return None;
        }
        let heading = |direction: Vec3| heading_from_ground(ground_from_world(direction));
        let facing = walk::facing(poses, recording.frame_rate);
        let turn: f32 = facing.windows(2).map(|pair| wrap(heading(pair[1]) - heading(pair[0]))).sum();
        // Travel in the body's own frame: forwards and to its left.
        let own = poses.windows(2).zip(&facing).fold(Vec3::ZERO, |sum, (pair, forward)| {
            let step = pair[1][Joint::Root as usize] - pair[0][Joint::Root as usize];
            sum + Vec3::new(step.dot(Vec3::Y.cross(*forward)), 0.0, step.dot(*forward))
        });
        let travel = (last[Joint::Root as usize] - first[Joint::Root as usize]).with_y(0.0);
        Some(Self {
            on_the_spot: recording.cyclic || walk::is_on_the_spot(poses, recording.frame_rate),
            travel: travel.length(),
            heading_deg: heading(travel).to_degrees(),
            facing_deg: heading(facing.iter().sum()).to_degrees(),
            turn_deg: turn.to_degrees(),
            crab_deg: heading(own).to_degrees(),
        })
    }
}
