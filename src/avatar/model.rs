//! What is read of files with characters and models.

use super::Avatar;
use glam::Vec3;

/// A loaded character and what was inferred about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The character.
    pub avatar: Avatar,
    /// One line per inference or repair: joint map, unit, facing, rest pose, what was left out.
    pub report: Vec<String>,
}

/// A model as it stands in its scene: metres, y up, front faces counter-clockwise.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Model {
    /// Positions, m.
    pub positions: Vec<Vec3>,
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// Linear colours, 0 to 1.
    pub colors: Vec<Vec3>,
    /// Three indices per triangle.
    pub indices: Vec<u32>,
}
