//! The shadow map.

use super::super::Error;
use super::super::attachments::{area, depth_attachment};
use super::super::commands::Commands;
use super::super::pipelines::Resource;
use super::super::target::{DEPTH_FORMAT, GpuImage, ImageSpec, ImageUse, Transition};
use crate::gpu::{Device, call};
use ash::vk;
use glam::Mat4;
use std::sync::Arc;
use vk::PipelineStageFlags2 as Stage;

/// A shadow map of a frame.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct SunMap {
    /// World to its clip space.
    pub(in super::super) shadow_from_world: Mat4,
    /// The pass whose uniforms have that.
    pub(in super::super) pass: usize,
    /// Of the finer one of what is near the eyes: how far from them its casters stand, m.
    pub(in super::super) near: Option<f32>,
}

/// The depth of the scene as the sun sees it: maps side by side in one image.
pub(in super::super) struct ShadowPass {
    image: GpuImage,
    /// Texels a side of a map.
    size: u32,
    /// How many the image has room for.
    maps: u32,
    /// Whether anything casts a shadow.
    is_on: bool,
    sampler: vk::Sampler,
    device: Arc<Device>,
}

impl ShadowPass {
    /// Maps of so many texels a side; 0 makes texels that are always lit.
    pub(in super::super) fn new(device: &Arc<Device>, texels: u32, maps: u32) -> Result<Self, Error> {
        let size = texels.max(1);
        let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
        let spec = ImageSpec { usage, ..ImageSpec::flat("shadow_map", [maps * size, size], DEPTH_FORMAT) };
        let image = GpuImage::new(device, spec)?;
        let sampler = make_sampler(device)?;
        Ok(Self { image, size, maps, is_on: texels > 0, sampler, device: device.clone() })
    }

    /// Texels a side of a map.
    pub(in super::super) fn size(&self) -> u32 {
        self.size
    }

    pub(in super::super) fn texture(&self) -> Resource {
        Resource::Texture(self.image.view, ImageUse::SAMPLED.layout)
    }

    pub(in super::super) fn sampler(&self) -> Resource {
        Resource::Sampler(self.sampler)
    }

    /// Clears the image and draws the casters of each map into it.
    pub(in super::super) fn record(
        &self,
        commands: &Commands<'_>,
        maps: &[SunMap],
        casters: impl Fn(&SunMap),
    ) {
        let unread = ImageUse::discarded(Stage::FRAGMENT_SHADER | ImageUse::DEPTH_ATTACHMENT.stages);
        let (image, aspect) = (self.image.raw, vk::ImageAspectFlags::DEPTH);
        let transition = |from, to| commands.transition(&[Transition { image, aspect, from, to }]);
        commands.labelled(c"gaitway.shadow", || {
            transition(unread, ImageUse::DEPTH_ATTACHMENT);
            let depth = depth_attachment(self.image.view, vk::AttachmentStoreOp::STORE);
            let rendering = vk::RenderingInfo::default()
                .render_area(area(self.maps * self.size, self.size))
                .layer_count(1)
                .depth_attachment(&depth);
            commands.rendering(&rendering, || {
                for (number, map) in (0..).zip(maps).filter(|_| self.is_on) {
                    let left = vk::Offset2D { x: number * self.size.cast_signed(), y: 0 };
                    commands.draw_within(vk::Rect2D { offset: left, ..area(self.size, self.size) });
                    casters(map);
                }
            });
            transition(ImageUse::DEPTH_ATTACHMENT, ImageUse::SAMPLED);
        });
    }
}

fn make_sampler(device: &Device) -> Result<vk::Sampler, Error> {
    let linear = device
        .format_properties(DEPTH_FORMAT)
        .optimal_tiling_features
        .contains(vk::FormatFeatureFlags::SAMPLED_IMAGE_FILTER_LINEAR);
    let filter = if linear { vk::Filter::LINEAR } else { vk::Filter::NEAREST };
    let create = vk::SamplerCreateInfo::default()
        .mag_filter(filter)
        .min_filter(filter)
        .address_mode_u(vk::SamplerAddressMode::CLAMP_TO_EDGE)
        .address_mode_v(vk::SamplerAddressMode::CLAMP_TO_EDGE)
        .address_mode_w(vk::SamplerAddressMode::CLAMP_TO_EDGE)
        .compare_enable(true)
        .compare_op(vk::CompareOp::GREATER_OR_EQUAL); // lit where no farther from the sun than what is stored
    // SAFETY: the create-info is complete; `ShadowPass` destroys the sampler.
    Ok(unsafe { device.raw.create_sampler(&create, None) }.map_err(call("vkCreateSampler"))?)
}

impl Drop for ShadowPass {
    fn drop(&mut self) {
        // SAFETY: the renderer that owns the pass waits for its submissions.
        unsafe { self.device.raw.destroy_sampler(self.sampler, None) };
    }
}
