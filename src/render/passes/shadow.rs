//! The shadow map.

use super::super::Error;
use super::super::attachments::{area, depth_attachment};
use super::super::commands::Commands;
use super::super::pipelines::Resource;
use super::super::target::{DEPTH_FORMAT, GpuImage, ImageSpec, ImageUse, Transition};
use crate::gpu::{Device, call};
use ash::vk;
use std::sync::Arc;
use vk::PipelineStageFlags2 as Stage;

/// The depth of the scene as the sun sees it.
pub(in super::super) struct ShadowPass {
    map: GpuImage,
    /// Texels a side.
    size: u32,
    /// Whether anything casts a shadow.
    is_on: bool,
    sampler: vk::Sampler,
    device: Arc<Device>,
}

impl ShadowPass {
    /// A map of so many texels a side; 0 makes one texel that is always lit.
    pub(in super::super) fn new(device: &Arc<Device>, texels: u32) -> Result<Self, Error> {
        let size = texels.max(1);
        let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
        let spec = ImageSpec { usage, ..ImageSpec::flat("shadow_map", [size; 2], DEPTH_FORMAT) };
        let map = GpuImage::new(device, spec)?;
        let sampler = make_sampler(device)?;
        Ok(Self { map, size, is_on: texels > 0, sampler, device: device.clone() })
    }

    /// Texels a side.
    pub(in super::super) fn size(&self) -> u32 {
        self.size
    }

    pub(in super::super) fn texture(&self) -> Resource {
        Resource::Texture(self.map.view, ImageUse::SAMPLED.layout)
    }

    pub(in super::super) fn sampler(&self) -> Resource {
        Resource::Sampler(self.sampler)
    }

    /// Clears the map and draws the casters into it.
    pub(in super::super) fn record(&self, commands: &Commands<'_>, casters: impl FnOnce()) {
        let unread = ImageUse::discarded(Stage::FRAGMENT_SHADER | ImageUse::DEPTH_ATTACHMENT.stages);
        let (image, aspect) = (self.map.raw, vk::ImageAspectFlags::DEPTH);
        let transition = |from, to| commands.transition(&[Transition { image, aspect, from, to }]);
        commands.labelled(c"gaitway.shadow", || {
            transition(unread, ImageUse::DEPTH_ATTACHMENT);
            let depth = depth_attachment(self.map.view, vk::AttachmentStoreOp::STORE);
            let rendering = vk::RenderingInfo::default()
                .render_area(area(self.size, self.size))
                .layer_count(1)
                .depth_attachment(&depth);
            commands.rendering(&rendering, || {
                if self.is_on {
                    casters();
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
