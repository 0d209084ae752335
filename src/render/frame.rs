//! What the passes of a frame share: the view, the crowd, and the resources that several shaders bind.

use super::attachments::area;
use super::camera::View;
use super::meshes::DrawnCrowd;
use super::passes::ShadowPass;
use super::pipelines::Resource;
use super::settings::Settings;
use crate::gpu::Buffer;
use ash::vk;
use glam::Mat4;
use vk::{AccessFlags2 as Access, PipelineStageFlags2 as Stage};

pub(super) const SHADERS: Stage =
    Stage::from_raw(Stage::VERTEX_SHADER.as_raw() | Stage::FRAGMENT_SHADER.as_raw());

/// One eye pass of one frame. A frame has one eye pass (one eye, or both by multiview) or two (one eye after the other).
#[derive(Clone, Copy)]
pub(super) struct Frame<'a> {
    pub(super) view: &'a View,
    pub(super) settings: &'a Settings,
    pub(super) crowd: Option<DrawnCrowd<'a>>,
    /// Distance from the eyes at which the third level of bodies with a pose begins, m.
    pub(super) third_begins: f32,
    /// Number of the eye pass.
    pub(super) eye_pass: usize,
}

impl Frame<'_> {
    /// The part of the images that is drawn.
    pub(super) fn area(&self) -> vk::Rect2D {
        area(self.settings.width, self.settings.height)
    }

    /// From the world to what each eye sees.
    pub(super) fn eyes(&self) -> &[Mat4] {
        &self.view.clip_from_world[..self.view.eye_count.clamp(1, 2) as usize]
    }
}

/// Resources that the shaders of several passes bind.
#[derive(Clone, Copy)]
pub(super) struct Shared<'a> {
    /// `ViewUniforms` of the eye pass.
    pub(super) view: &'a Buffer,
    pub(super) shadow: &'a ShadowPass,
    pub(super) crowd: Option<DrawnCrowd<'a>>,
}

impl Shared<'_> {
    /// What the binding of that name is filled with; none for the resources that only one pass has.
    pub(super) fn find(&self, name: &str) -> Option<Resource> {
        match name {
            "view" => Some(Resource::Buffer(self.view.raw)),
            "shadow_map" => Some(self.shadow.texture()),
            "shadow_sampler" => Some(self.shadow.sampler()),
            name => {
                let crowd = self.crowd?;
                let buffer = crowd.buffers.buffer(name).or_else(|| crowd.meshes.buffer(name));
                buffer.map(|buffer| Resource::Buffer(buffer.raw))
            }
        }
    }
}

/// Barrier before a frame: the draws see what kernels and copies wrote, and the frame before has read its uniforms.
pub(super) const BEFORE: [(Stage, Access); 2] = [
    (
        Stage::from_raw(Stage::COMPUTE_SHADER.as_raw() | Stage::ALL_TRANSFER.as_raw() | SHADERS.as_raw()),
        Access::from_raw(Access::SHADER_STORAGE_WRITE.as_raw() | Access::TRANSFER_WRITE.as_raw()),
    ),
    (
        Stage::from_raw(
            SHADERS.as_raw()
                | Stage::DRAW_INDIRECT.as_raw()
                | Stage::INDEX_INPUT.as_raw()
                | Stage::ALL_TRANSFER.as_raw(),
        ),
        Access::from_raw(
            Access::SHADER_STORAGE_READ.as_raw()
                | Access::INDIRECT_COMMAND_READ.as_raw()
                | Access::INDEX_READ.as_raw()
                | Access::TRANSFER_WRITE.as_raw(),
        ),
    ),
];
/// Barrier after the uniforms of a frame were written.
pub(super) const UNIFORMS: [(Stage, Access); 2] =
    [(Stage::ALL_TRANSFER, Access::TRANSFER_WRITE), (SHADERS, Access::UNIFORM_READ)];
/// Barrier after a frame: kernels of the next step may overwrite what was drawn from.
pub(super) const AFTER: [(Stage, Access); 2] = [
    (Stage::from_raw(SHADERS.as_raw() | Stage::DRAW_INDIRECT.as_raw()), Access::NONE),
    (Stage::from_raw(Stage::COMPUTE_SHADER.as_raw() | Stage::ALL_TRANSFER.as_raw()), Access::NONE),
];
