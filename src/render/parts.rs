//! What a renderer is made of: programs and their pipelines, images of the picture's size.

use super::Error;
use super::pipelines::{PipelineSpec, Program};
use super::settings::{Settings, Stereo};
use super::target::{DEPTH_FORMAT, GpuImage, ImageSpec};
use crate::gpu::Device;
use crate::kernels::draw;
use ash::vk;
use std::sync::Arc;

/// Draw shaders, each with a descriptor set for every pass.
pub(crate) struct Programs {
    pub(crate) sky: Program,
    pub(crate) environment: Program,
    pub(crate) crowd: Program,
    pub(crate) far: Program,
    pub(crate) marker: Program,
    pub(crate) user: Program,
    pub(crate) outsider: Program,
    #[cfg(feature = "xr")]
    pub(crate) mask: Program,
}

impl Programs {
    pub(crate) fn new(device: &Arc<Device>, passes: usize) -> Result<Self, Error> {
        Ok(Self {
            sky: Program::new(device, &draw::SKY, passes)?,
            environment: Program::new(device, &draw::ENVIRONMENT, passes)?,
            crowd: Program::new(device, &draw::CROWD, passes)?,
            far: Program::new(device, &draw::FAR, passes)?,
            marker: Program::new(device, &draw::MARKER, passes)?,
            user: Program::new(device, &draw::USER, passes)?,
            outsider: Program::new(device, &draw::OUTSIDER, passes)?,
            #[cfg(feature = "xr")]
            mask: Program::new(device, &draw::MASK, passes)?,
        })
    }
}

/// Pipelines; each belongs to the program of its name.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pipelines {
    pub(crate) sky: vk::Pipeline,
    pub(crate) environment: vk::Pipeline,
    pub(crate) environment_shadow: vk::Pipeline,
    pub(crate) crowd: vk::Pipeline,
    /// For the finest level, which fades near the eyes.
    pub(crate) crowd_near: vk::Pipeline,
    pub(crate) crowd_shadow: vk::Pipeline,
    pub(crate) far: vk::Pipeline,
    pub(crate) far_shadow: vk::Pipeline,
    pub(crate) marker: vk::Pipeline,
    pub(crate) user: vk::Pipeline,
    pub(crate) outsider: vk::Pipeline,
    pub(crate) outsider_shadow: vk::Pipeline,
    pub(crate) target: vk::Pipeline,
    pub(crate) vignette: vk::Pipeline,
    #[cfg(feature = "xr")]
    pub(crate) mask: vk::Pipeline,
}

/// Images of the picture's size, used by one pass after the other.
pub(crate) struct Attachments {
    /// More than one sample a pixel; absent when there is one.
    pub(crate) multisampled: Option<GpuImage>,
    pub(crate) depth: GpuImage,
    /// Whether shaders can read its samples.
    pub(crate) is_depth_read: bool,
}

/// The most samples up to `wanted` that the device has for colour and depth.
pub(crate) fn samples(device: &Device, wanted: u32) -> vk::SampleCountFlags {
    let both = device.limits.framebuffer_color_sample_counts & device.limits.framebuffer_depth_sample_counts;
    let four = vk::SampleCountFlags::TYPE_4;
    if wanted >= 4 && both.contains(four) { four } else { vk::SampleCountFlags::TYPE_1 }
}

/// How a device draws what these settings ask for: never [`Stereo::Auto`].
pub(crate) fn stereo(device: &Device, settings: &Settings) -> Stereo {
    match settings.stereo {
        Stereo::OnePass | Stereo::Auto if device.multiview => Stereo::OnePass,
        _ => Stereo::TwoPasses,
    }
}

/// Layers that one pass draws at once.
pub(crate) fn layers(settings: &Settings) -> u32 {
    if settings.stereo == Stereo::TwoPasses { 1 } else { settings.eyes }
}

/// The views of one pass as Vulkan wants them: 0 without multiview.
pub(crate) fn view_mask(settings: &Settings) -> u32 {
    if layers(settings) > 1 { 0b11 } else { 0 }
}

pub(crate) fn attachments(
    device: &Arc<Device>,
    settings: &Settings,
    samples: vk::SampleCountFlags,
    color_format: vk::Format,
) -> Result<Attachments, Error> {
    let Settings { width, height, .. } = *settings;
    let limits = &device.limits;
    let limit =
        limits.max_image_dimension2_d.min(limits.max_framebuffer_width).min(limits.max_framebuffer_height);
    if width == 0 || height == 0 || width > limit || height > limit {
        return Err(Error::Size { width, height, limit });
    }
    let layers = layers(settings);
    let image = |name, format, usage| {
        let extent = vk::Extent2D { width, height };
        GpuImage::new(device, ImageSpec { name, extent, layers, format, samples, usage })
    };
    let multisampled = (samples != vk::SampleCountFlags::TYPE_1)
        .then(|| image("multisampled colour", color_format, vk::ImageUsageFlags::COLOR_ATTACHMENT))
        .transpose()?;
    let is_depth_read = settings.occlusion && limits.sampled_image_depth_sample_counts.contains(samples);
    let read = if is_depth_read { vk::ImageUsageFlags::SAMPLED } else { vk::ImageUsageFlags::empty() };
    let depth = image("depth", DEPTH_FORMAT, vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | read)?;
    Ok(Attachments { multisampled, depth, is_depth_read })
}

pub(crate) fn pipelines(
    programs: &mut Programs,
    settings: &Settings,
    samples: vk::SampleCountFlags,
    color_format: vk::Format,
) -> Result<Pipelines, Error> {
    let view_mask = view_mask(settings);
    let solid = |vertex, fragment| PipelineSpec {
        vertex,
        fragment: Some(fragment),
        samples,
        color_format,
        view_mask,
        cull: vk::CullModeFlags::BACK,
        compare: vk::CompareOp::GREATER, // reversed depth: nearer is larger
        write_depth: true,
        has_depth: true,
        blend: false,
        covers: false,
    };
    // both sides cast shadows: no surface needs to be closed
    let shadow = |vertex| PipelineSpec {
        fragment: None,
        samples: vk::SampleCountFlags::TYPE_1,
        view_mask: 0,
        cull: vk::CullModeFlags::NONE,
        ..solid(vertex, "")
    };
    let flat = |vertex, fragment, compare, blend| PipelineSpec {
        cull: vk::CullModeFlags::NONE,
        write_depth: false,
        compare,
        blend,
        ..solid(vertex, fragment)
    };
    let behind_all = vk::CompareOp::GREATER_OR_EQUAL; // depth 0 against the cleared 0
    let near = vk::CompareOp::GREATER;
    let over_all = vk::CompareOp::ALWAYS;
    Ok(Pipelines {
        sky: programs.sky.pipeline(&flat("sky_vertex", "sky_fragment", behind_all, false))?,
        environment: programs.environment.pipeline(&solid("environment_vertex", "environment_fragment"))?,
        environment_shadow: programs.environment.pipeline(&shadow("environment_shadow"))?,
        crowd: programs.crowd.pipeline(&solid("crowd_vertex", "crowd_fragment"))?,
        crowd_near: programs
            .crowd
            .pipeline(&PipelineSpec { covers: true, ..solid("crowd_vertex", "crowd_near_fragment") })?,
        crowd_shadow: programs.crowd.pipeline(&shadow("crowd_shadow"))?,
        far: programs.far.pipeline(&solid("far_vertex", "far_fragment"))?,
        far_shadow: programs.far.pipeline(&shadow("far_shadow"))?,
        marker: programs.marker.pipeline(&flat("marker_vertex", "marker_fragment", near, true))?,
        user: programs.user.pipeline(&PipelineSpec {
            cull: vk::CullModeFlags::NONE,
            ..solid("user_vertex", "user_fragment")
        })?,
        outsider: programs.outsider.pipeline(&PipelineSpec {
            cull: vk::CullModeFlags::NONE,
            ..solid("outsider_vertex", "outsider_fragment")
        })?,
        outsider_shadow: programs.outsider.pipeline(&shadow("outsider_shadow"))?,
        target: programs.user.pipeline(&flat("target_vertex", "target_fragment", near, true))?,
        vignette: programs.user.pipeline(&flat("vignette_vertex", "vignette_fragment", over_all, true))?,
        #[cfg(feature = "xr")]
        mask: programs.mask.pipeline(&PipelineSpec {
            write_depth: true,
            ..flat("mask_vertex", "mask_fragment", over_all, false)
        })?,
    })
}
