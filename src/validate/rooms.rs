//! Corridors, corners, rooms with doors, and people in them.

use super::measure::Area;
use super::scene::{Experiment, Walker};
use crate::Error;
use crate::reference::exact::{hash_u32, unit_f32};
use glam::Vec2;

/// Disc radius of people in tests, m: the body that users get.
pub const RADIUS: f32 = crate::scenario::BODY_RADIUS;

/// A number in [0, 1) for each (index, lane).
pub fn unit(index: usize, lane: u32) -> f32 {
    #[allow(clippy::cast_possible_truncation, reason = "thousands of people")]
    let index = index as u32;
    unit_f32(hash_u32(hash_u32(index.wrapping_mul(0x9e37_79b9)).wrapping_add(lane)))
}

/// `count` places spread over a rectangle, each moved a little from a lattice, no two closer than two radii.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "thousands of people"
)]
pub fn places(area: Area, count: usize, lane: u32) -> Vec<Vec2> {
    let extent = area.high - area.low;
    let spacing = (extent.x * extent.y / count.max(1) as f32).sqrt();
    let columns = ((extent.x / spacing).ceil() as usize).max(1);
    let rows = count.div_ceil(columns).max(1);
    let cell = extent / Vec2::new(columns as f32, rows as f32);
    let jitter = (cell - 2.0 * RADIUS - 0.02).max(Vec2::ZERO) * 0.8;
    (0..count)
        .map(|i| {
            let middle = Vec2::new((i % columns) as f32 + 0.5, (i / columns) as f32 + 0.5) * cell;
            area.low + middle + jitter * (Vec2::new(unit(i, lane), unit(i, lane + 1)) - 0.5)
        })
        .collect()
}

/// A walker that follows its way once.
pub fn walker(position: Vec2, speed: f32, way: Vec<(Vec2, f32)>) -> Walker {
    Walker { position, speed, radius: RADIUS, way, next: 0, loops: false, companions: [u32::MAX; 4] }
}

/// A straight corridor from x = 0 to `length`, `width` wide, closed at its ends.
///
/// # Errors
/// When the scene is refused, which would be an error of the program.
pub fn corridor(name: &str, length: f32, width: f32, seconds: f32) -> Result<Experiment, Error> {
    Experiment::new(name, &[[0.0, 0.0], [length, 0.0], [length, width], [0.0, width]], seconds)
}

/// A room with a door onto a wide yard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Room {
    /// Along the wall with the door, m; the room lies at x 0 to `width`.
    pub width: f32,
    /// From that wall into the room, m; the wall is at z = 0.
    pub depth: f32,
    /// Width of the door in the middle of the wall, m.
    pub door: f32,
    /// How thick the wall is, m.
    pub wall: f32,
}

/// How far the yard reaches to both sides of the door, and from it, m.
const YARD: [f32; 2] = [15.0, 20.0];

impl Room {
    /// Middle of the door, x.
    pub fn middle(&self) -> f32 {
        0.5 * self.width
    }

    /// Both ends of the line across the outside of the door, so that leaving agents cross it from its left side.
    pub fn line(&self) -> [Vec2; 2] {
        let half = 0.5 * self.door + 0.3;
        let at = -self.wall;
        [Vec2::new(self.middle() - half, at), Vec2::new(self.middle() + half, at)]
    }

    /// The empty room.
    ///
    /// # Errors
    /// When the scene is refused, which would be an error of the program.
    pub fn scene(&self, name: &str, seconds: f32) -> Result<Experiment, Error> {
        let (c, half, out) = (self.middle(), 0.5 * self.door, -self.wall);
        let mut scene = Experiment::new(
            name,
            &[
                [0.0, 0.0],
                [c - half, 0.0],
                [c - half, out],
                [c - YARD[0], out],
                [c - YARD[0], out - YARD[1]],
                [c + YARD[0], out - YARD[1]],
                [c + YARD[0], out],
                [c + half, out],
                [c + half, 0.0],
                [self.width, 0.0],
                [self.width, self.depth],
                [0.0, self.depth],
            ],
            seconds,
        )?;
        scene.until = Some(2);
        Ok(scene)
    }

    /// The way of person number `index` from `start` out of the room: to the door, through it, and to a place of their own in
    /// the yard. Across the door they keep their relative place across the room.
    pub fn way_out(&self, index: usize, start: Vec2) -> Vec<(Vec2, f32)> {
        let c = self.middle();
        let goal = Vec2::new(
            c + (unit(index, 90) - 0.5) * 1.8 * YARD[0],
            -self.wall - YARD[1] * (0.7 + 0.25 * unit(index, 91)),
        );
        let share = ((start.x - c) / c).clamp(-1.0, 1.0);
        let x = c + share * (0.5 * self.door - RADIUS - 0.05).max(0.0);
        let (near, past) = (0.5 * self.door + 0.3, 0.4 + 0.25 * (self.door - 0.5).max(0.0));
        vec![(Vec2::new(x, 0.1), near), (Vec2::new(x, -self.wall - 0.5), past), (goal, 0.5)]
    }
}
