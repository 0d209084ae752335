//! Drawing: cameras, the crowd straight from the simulation's buffers, pictures in memory.

pub mod camera;
mod image;

pub use camera::{Camera, View};
pub use image::Image;

#[allow(missing_docs)]
#[derive(Debug, thiserror::Error)]
pub enum Error {}
