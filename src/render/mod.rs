//! Drawing: cameras, the crowd straight from the simulation's buffers, images in memory.
//!
//! [`Camera`] → [`View`] (matrices per eye) → [`Renderer::draw`] → [`Image`]. The crowd is drawn from the buffers that
//! the kernels wrote ([`CrowdBuffers`]); only the image is read back. One sun with a shadow map, a sky, haze.
//!
//! Depth is reversed (1 near, 0 infinitely far), clip space is Vulkan's (y down), matrices are `clip_from_world`.
//!
//! ```no_run
//! use gaitway::gpu::{Device, Validation};
//! use gaitway::render::{Camera, Renderer, Settings, Surface, View};
//! use glam::Vec3;
//!
//! # fn main() -> Result<(), gaitway::Error> {
//! let device = Device::open(None, Validation::Off)?;
//! let mut renderer = Renderer::new(&device, Settings::sized(640, 480))?;
//! let floor = [Vec3::ZERO, Vec3::Z, Vec3::X];
//! renderer.set_environment(&[Surface {
//!     positions: &floor,
//!     normals: &[Vec3::Y; 3],
//!     colors: &[Vec3::ONE; 3],
//!     layers: &[],
//!     materials: &[],
//!     indices: &[0, 1, 2],
//! }])?;
//! let camera = Camera::look_at(Vec3::new(2.0, 1.7, 2.0), Vec3::ZERO, Vec3::Y);
//! let image = renderer.draw(&View::mono(&camera, 640, 480), None)?;
//! assert_eq!((image.width, image.height), (640, 480));
//! # Ok(())
//! # }
//! ```

mod atmosphere;
mod attachments;
pub mod camera;
mod commands;
mod crowd;
mod direct;
mod error;
#[cfg(feature = "xr")]
mod faces;
mod flight;
mod frame;
mod ground_map;
#[cfg(feature = "xr")]
mod live;
mod materials;
mod meshes;
mod parts;
mod passes;
mod pipelines;
mod renderer;
mod scenery;
mod settings;
pub mod show;
mod submit;
mod sun;
mod surface;
mod target;
mod textures;
mod uniforms;
mod user;

pub use crate::gpu::Draws;
pub use crate::picture::Image;
pub use crate::sim::bodies as pack;
pub use atmosphere::Atmosphere;
pub use camera::{Camera, View};
#[cfg(feature = "xr")]
pub(crate) use commands::Commands;
pub use crowd::CrowdBuffers;
pub use error::Error;
#[cfg(feature = "xr")]
pub use faces::Face;
#[cfg(feature = "xr")]
pub(crate) use live::DrawTimes;
pub use renderer::Renderer;
pub use settings::{Markers, Occlusion, Quality, Settings, Stereo, UnknownQuality};
pub use show::Show;
#[cfg(any(feature = "xr", feature = "view"))]
pub(crate) use submit::Target;
pub use surface::Surface;
#[cfg(feature = "xr")]
pub(crate) use target::DEPTH_FORMAT;
#[cfg(any(feature = "xr", feature = "view"))]
pub(crate) use target::{
    COLOR_FORMAT, EyeImages, GpuImage, ImageSpec, ImageUse, Readback, Transition, corners, first_layer,
};
pub use user::{Hand, HandKind, JOINTS, Joints, Teleport, User};
