//! The fundamental diagram: speed over density in a corridor that closes upon itself.

use super::scene::{Experiment, Walker};
use crate::Error;
use crate::reference::exact::{hash_u32, unit_f32};
use glam::Vec2;
use std::f32::consts::TAU;

/// Radius of the ring's middle, m: it is 75 m long.
pub const RING_RADIUS: f32 = 12.0;
/// Corners of each wall.
const CORNERS: u32 = 72;
/// Points of each agent's way.
const POINTS: u32 = 24;

/// Weidmann's speed at a density of people/m², m/s (Weidmann 1993).
pub fn weidmann(density: f64) -> f64 {
    1.34 * (1.0 - (-1.913 * (1.0 / density - 1.0 / 5.4)).exp())
}

/// A ring in which all walk the same way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ring {
    /// Radius of its middle, m.
    pub middle: f32,
    /// From wall to wall, m.
    pub width: f32,
    /// People/m².
    pub density: f32,
    /// The stream of their places.
    pub lane: u32,
}

impl Ring {
    /// The ring with its people, at 1.34 m/s.
    ///
    /// # Errors
    /// When the scene is refused, which would be an error of the program.
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "small counts"
    )]
    pub fn scene(&self, seconds: f32) -> Result<Experiment, Error> {
        let Self { middle, width, density, lane: stream } = *self;
        let circle = |radius: f32, corners: u32| -> Vec<[f32; 2]> {
            (0..corners)
                .map(|i| (Vec2::from_angle(TAU * i as f32 / corners as f32) * radius).to_array())
                .collect()
        };
        let (inner, outer) = (middle - 0.5 * width, middle + 0.5 * width);
        let mut scene = Experiment::new("ring", &circle(outer, CORNERS), seconds)?;
        scene.solid(&circle(inner, CORNERS));
        let area = 0.5 * TAU * (outer * outer - inner * inner);
        let count = (density * area).round() as u32;
        // rows across, staggered, then shuffled a little
        let radius = super::rooms::RADIUS;
        let lanes = ((width - 2.0 * radius) * density.sqrt() * 1.05).round().max(1.0) as u32;
        let rows = count.div_ceil(lanes);
        for i in 0..count {
            let (row, lane) = (i / lanes, i % lanes);
            let u = |k: u32| unit_f32(hash_u32((3 * i + k).wrapping_add(stream << 16))) - 0.5;
            let stagger = 0.5 * (lane % 2) as f32;
            let angle = TAU * (row as f32 + stagger + 0.2 * u(0)) / rows as f32;
            let across =
                inner + radius + 0.05 + (width - 2.0 * radius - 0.1) * (lane as f32 + 0.5) / lanes as f32;
            let way: Vec<(Vec2, f32)> = (0..POINTS)
                .map(|k| (Vec2::from_angle(TAU * k as f32 / POINTS as f32) * across, 2.0))
                .collect();
            let next = ((angle / TAU * POINTS as f32).floor() as u32 + 2) % POINTS;
            scene.walkers.push(Walker {
                position: Vec2::from_angle(angle) * across,
                speed: 1.34,
                radius,
                way,
                next: next as usize,
                loops: true,
                companions: [u32::MAX; 4],
            });
        }
        Ok(scene)
    }
}

/// Mean speed round the ring over the frames after `from` s, m/s.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small counts"
)]
pub fn speed_round(tracks: &super::tracks::Tracks, from: f64) -> f64 {
    let first = (from * tracks.rate) as usize;
    let (mut sum, mut count) = (0.0, 0_u32);
    for frame in (first..tracks.frames.len()).step_by(10) {
        for &(who, at) in &tracks.frames[frame] {
            if let Some(v) = tracks.velocity(frame, who, 0.4) {
                sum += f64::from(at.perp().normalize().dot(v));
                count += 1;
            }
        }
    }
    sum / f64::from(count.max(1))
}
