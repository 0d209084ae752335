//! What a frame is drawn by: every pass has its pipelines, its data on the device and what it records.

mod contact;
mod crowd;
mod environment;
mod far;
mod markers;
#[cfg(feature = "xr")]
mod mask;
mod occlusion;
mod outsiders;
mod painted;
mod place;
mod shadow;
mod sky;
mod user;

pub(super) use contact::ContactPass;
pub(super) use crowd::CrowdPass;
pub(super) use environment::EnvironmentPass;
pub(super) use far::FarPass;
pub(super) use markers::MarkerPass;
#[cfg(feature = "xr")]
pub(super) use mask::MaskPass;
pub(super) use occlusion::{OcclusionPass, OcclusionTest};
pub(super) use outsiders::OutsiderPass;
pub(super) use painted::PaintedPass;
pub(super) use place::PlacePass;
pub(super) use shadow::{ShadowPass, SunMap};
pub(super) use sky::SkyPass;
pub(super) use user::UserPass;
