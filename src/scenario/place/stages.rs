//! The regions that stages of journeys cover.

use crate::scenario::file::{SPACING, Stage};
use crate::scenario::polygon;
use glam::Vec2;

impl Stage {
    /// Half axes of the region along its width and its depth, m; 0 for a waypoint.
    pub fn half_axes(&self) -> [Vec2; 2] {
        let Some(size) = self.size else { return [Vec2::ZERO; 2] };
        let corners = polygon::rectangle(Vec2::ZERO, Vec2::from(size), self.heading_deg.to_radians());
        [(corners[1] - corners[0]) * 0.5, (corners[2] - corners[1]) * 0.5]
    }

    /// From one place of a queue to the next, m.
    pub(crate) fn to_next_place(&self) -> Vec2 {
        let (sin, cos) = libm::sincosf(self.heading_deg.to_radians());
        Vec2::new(sin, cos) * self.spacing.unwrap_or(SPACING)
    }
}
