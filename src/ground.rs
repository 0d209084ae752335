//! The only crossings between the world (x, y, z; y up) and the ground plane (x, z).
//!
//! Seen from above the pair (x, z) is left-handed, so a positive angle on the ground plane turns to the
//! walker's *right* in the 2-D picture, but a heading about +y (from +z towards +x) is positive to the *left*.

use glam::{Vec2, Vec3};

/// Both coordinates of an agent that is not there (not yet, or no more), m.
pub use crate::kernels::shared::absent::ABSENT;

/// Whether that is the position of an absent agent.
pub fn is_absent(position: [f32; 2]) -> bool {
    position[0] >= 0.5 * ABSENT
}

/// Drops the height: (x, y, z) to (x, z), metres.
pub fn ground_from_world(world: Vec3) -> Vec2 {
    Vec2::new(world.x, world.z)
}

/// Puts a ground point at a height: (x, z) and y to (x, y, z), metres.
pub fn world_from_ground(ground: Vec2, height: f32) -> Vec3 {
    Vec3::new(ground.x, height, ground.y)
}

/// Heading in radians about +y of a ground direction: 0 faces +z, +pi/2 faces +x (the walker's left turn).
pub fn heading_from_ground(direction: Vec2) -> f32 {
    libm::atan2f(direction.x, direction.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_PI_2;

    #[test]
    fn ground_and_world_are_inverse() {
        let p = Vec3::new(1.0, 2.0, 3.0);
        assert_eq!(world_from_ground(ground_from_world(p), 2.0), p);
    }

    #[test]
    fn heading_is_a_right_handed_turn_about_y_from_plus_z() {
        assert!(heading_from_ground(Vec2::new(0.0, 1.0)).abs() < 1e-7);
        let turned = glam::Quat::from_rotation_y(FRAC_PI_2) * Vec3::Z;
        assert!((heading_from_ground(ground_from_world(turned)) - FRAC_PI_2).abs() < 1e-6);
    }
}
