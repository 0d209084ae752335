//! placeholder
#[cfg(feature = "vulkan")]
mod font;
#[cfg(feature = "vulkan")]
pub mod image;
#[cfg(feature = "vulkan")]
pub mod video;
#[allow(missing_docs)]
#[derive(Debug, thiserror::Error)]
pub enum Error {}
