//! The plane of trajectories: seen from above, x to the right and y up the page.

use glam::{DVec2, Vec2};

/// Our ground (x, z) in the trajectory formats' plane (x, y): y = -z keeps left and right as seen from above.
pub fn plane_from_ground(ground: Vec2) -> DVec2 {
    // `0 - z`, not `-z`: no negative zeros in files.
    DVec2::new(f64::from(ground.x), 0.0 - f64::from(ground.y))
}
