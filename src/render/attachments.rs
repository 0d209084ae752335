//! What an eye pass draws into: depth and samples of our own, and the caller's images.

use super::Error;
use super::commands::Commands;
use super::settings::{Occlusion, Quality, Settings, Stereo};
use super::target::{
    DEPTH_FORMAT, EyeImages, Format, GpuImage, ImageSpec, ImageUse, Transition, aspect_of, layer_view, whole,
};
use crate::gpu::{Device, Draws, call};
use ash::vk;
use std::sync::Arc;
use vk::{AccessFlags2 as Access, ImageLayout as Layout, PipelineStageFlags2 as Stage};

/// Images of the frame's size, used by one eye pass after the other.
pub(super) struct Attachments {
    /// More than one sample a pixel; absent when there is one.
    multisampled: Option<GpuImage>,
    pub(super) depth: GpuImage,
    /// Whether shaders can read the samples of the depth.
    pub(super) is_depth_read: bool,
    /// Columns and rows.
    #[cfg(feature = "xr")]
    pub(super) size: [u32; 2],
    view_mask: u32,
}

/// The views that one eye pass draws into.
#[derive(Debug, Clone, Copy)]
pub(super) struct EyeTarget {
    pub(super) color: vk::ImageView,
    /// Where its depth goes, if the caller wants it.
    pub(super) depth: Option<vk::ImageView>,
}

/// A part of an eye pass between two changes of its layout; the first one clears, the last one resolves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Part {
    pub(super) is_first: bool,
    pub(super) is_last: bool,
}

/// The most samples up to `wanted` that the device has for colour and depth.
pub(super) fn samples(device: &Device, wanted: u32) -> vk::SampleCountFlags {
    let both = device.limits.framebuffer_color_sample_counts & device.limits.framebuffer_depth_sample_counts;
    let four = vk::SampleCountFlags::TYPE_4;
    if wanted >= 4 && both.contains(four) { four } else { vk::SampleCountFlags::TYPE_1 }
}

/// How a device draws what these settings ask for: never [`Stereo::Auto`].
pub(super) fn stereo(device: &Device, settings: &Settings) -> Stereo {
    match settings.stereo {
        Stereo::OnePass | Stereo::Auto if device.multiview => Stereo::OnePass,
        _ => Stereo::TwoPasses,
    }
}

/// Where the arguments of draws come from on a device: never [`Draws::Auto`].
pub(super) fn draws(device: &Device, settings: &Settings) -> Draws {
    settings.draws.or(device.draws)
}

/// Whether a device leaves hidden agents out: never [`Occlusion::Auto`].
pub(super) fn occlusion(device: &Device, settings: &Settings) -> Occlusion {
    settings.occlusion.settled(device.info().is_tiler, draws(device, settings))
}

/// Eye passes of a frame.
pub(super) fn eye_passes(settings: &Settings) -> u32 {
    if settings.stereo == Stereo::TwoPasses { settings.eyes } else { 1 }
}

/// Shadow maps of a frame, side by side in one image: that of all that is seen and, at medium and high quality, a finer one of what
/// is near.
pub(super) fn shadow_maps(settings: &Settings) -> u32 {
    if settings.quality > Quality::Low && settings.shadow_size > 0 { 2 } else { 1 }
}

/// Passes with a view of their own: those of the eyes, then those of the shadow maps after the first.
pub(super) fn passes(settings: &Settings) -> u32 {
    eye_passes(settings) + shadow_maps(settings) - 1
}

/// Layers that one eye pass draws at once.
pub(super) fn layers(settings: &Settings) -> u32 {
    if settings.stereo == Stereo::TwoPasses { 1 } else { settings.eyes }
}

/// The views of one eye pass as Vulkan wants them: 0 without multiview.
pub(super) fn view_mask(settings: &Settings) -> u32 {
    if layers(settings) > 1 { 0b11 } else { 0 }
}

impl Attachments {
    pub(super) fn new(device: &Arc<Device>, settings: &Settings, format: Format) -> Result<Self, Error> {
        let Settings { width, height, .. } = *settings;
        let limits = &device.limits;
        let limit = limits
            .max_image_dimension2_d
            .min(limits.max_framebuffer_width)
            .min(limits.max_framebuffer_height);
        if width == 0 || height == 0 || width > limit || height > limit {
            return Err(Error::Size { width, height, limit });
        }
        let (layers, samples) = (layers(settings), format.samples);
        let is_depth_read =
            settings.occlusion == Occlusion::On && limits.sampled_image_depth_sample_counts.contains(samples);
        // what is drawn in one part needs to exist in a tiler's tiles only
        let own = if is_depth_read {
            vk::ImageUsageFlags::empty()
        } else {
            vk::ImageUsageFlags::TRANSIENT_ATTACHMENT
        };
        let image = |name, format, usage| {
            let usage = usage | own;
            let spec = ImageSpec::flat(name, [width, height], format);
            GpuImage::new(device, ImageSpec { layers, samples, usage, ..spec })
        };
        let multisampled = format
            .is_multisampled()
            .then(|| image("multisampled colour", format.color, vk::ImageUsageFlags::COLOR_ATTACHMENT))
            .transpose()?;
        let read = if is_depth_read { vk::ImageUsageFlags::SAMPLED } else { vk::ImageUsageFlags::empty() };
        let depth = image("depth", DEPTH_FORMAT, vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | read)?;
        let view_mask = view_mask(settings);
        Ok(Self {
            multisampled,
            depth,
            is_depth_read,
            #[cfg(feature = "xr")]
            size: [width, height],
            view_mask,
        })
    }

    pub(super) fn is_multisampled(&self) -> bool {
        self.multisampled.is_some()
    }

    /// Makes depth and samples ready to be drawn: the eye pass before has finished with them.
    pub(super) fn begin(&self, commands: &Commands<'_>) {
        let mut before = vec![Transition {
            image: self.depth.raw,
            aspect: vk::ImageAspectFlags::DEPTH,
            from: ImageUse {
                access: Access::DEPTH_STENCIL_ATTACHMENT_WRITE,
                layout: Layout::UNDEFINED,
                ..ImageUse::DEPTH_ATTACHMENT
            },
            to: ImageUse::DEPTH_ATTACHMENT,
        }];
        before.extend(self.multisampled.as_ref().map(|multisampled| Transition {
            image: multisampled.raw,
            aspect: vk::ImageAspectFlags::COLOR,
            from: ImageUse { layout: Layout::UNDEFINED, ..ImageUse::COLOR_WRITTEN },
            to: ImageUse::COLOR_ATTACHMENT,
        }));
        commands.transition(&before);
    }

    /// Records the draws of a part of an eye pass, into this area of the images.
    pub(super) fn part(
        &self,
        commands: &Commands<'_>,
        target: EyeTarget,
        area: vk::Rect2D,
        part: Part,
        draw: impl FnOnce(),
    ) {
        let load = if part.is_first { vk::AttachmentLoadOp::CLEAR } else { vk::AttachmentLoadOp::LOAD };
        let clear = vk::ClearValue { color: vk::ClearColorValue { float32: [0.0, 0.0, 0.0, 1.0] } };
        let mut color = vk::RenderingAttachmentInfo::default()
            .image_layout(Layout::COLOR_ATTACHMENT_OPTIMAL)
            .load_op(load)
            .store_op(vk::AttachmentStoreOp::STORE)
            .clear_value(clear);
        match &self.multisampled {
            Some(multisampled) if part.is_last => {
                color = color
                    .image_view(multisampled.view)
                    .store_op(vk::AttachmentStoreOp::DONT_CARE)
                    .resolve_mode(vk::ResolveModeFlags::AVERAGE)
                    .resolve_image_view(target.color)
                    .resolve_image_layout(Layout::COLOR_ATTACHMENT_OPTIMAL);
            }
            Some(multisampled) => color = color.image_view(multisampled.view),
            None => color = color.image_view(target.color),
        }
        let colors = [color];
        let kept = if part.is_last { vk::AttachmentStoreOp::DONT_CARE } else { vk::AttachmentStoreOp::STORE };
        let mut depth = depth_attachment(self.depth.view, kept).load_op(load);
        if let (true, Some(view)) = (part.is_last, target.depth) {
            depth = self.keep_depth(depth, view);
        }
        let rendering = vk::RenderingInfo::default()
            .render_area(area)
            .layer_count(1)
            .view_mask(self.view_mask)
            .color_attachments(&colors)
            .depth_attachment(&depth);
        commands.rendering(&rendering, draw);
    }

    /// The depth attachment that also writes the caller's image: its depth, or that of the first sample.
    fn keep_depth(
        &self,
        attachment: vk::RenderingAttachmentInfo<'static>,
        view: vk::ImageView,
    ) -> vk::RenderingAttachmentInfo<'static> {
        if self.is_multisampled() {
            return attachment
                .resolve_mode(vk::ResolveModeFlags::SAMPLE_ZERO)
                .resolve_image_view(view)
                .resolve_image_layout(DEPTH_TARGET);
        }
        attachment.image_view(view).image_layout(DEPTH_TARGET).store_op(vk::AttachmentStoreOp::STORE)
    }
}

/// The layout of the caller's image for depth, during a frame and afterwards.
pub(super) const DEPTH_TARGET: Layout = Layout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;

/// The caller's images for depth, while they are written. Resolving depth counts as writing colour.
const DEPTH_TARGET_WRITTEN: ImageUse = ImageUse {
    stages: Stage::from_raw(
        ImageUse::DEPTH_ATTACHMENT.stages.as_raw() | Stage::COLOR_ATTACHMENT_OUTPUT.as_raw(),
    ),
    access: Access::from_raw(
        ImageUse::DEPTH_ATTACHMENT.access.as_raw() | Access::COLOR_ATTACHMENT_WRITE.as_raw(),
    ),
    layout: DEPTH_TARGET,
};

/// Makes the caller's images for depth ready to be written.
pub(super) fn begin_depth_target(commands: &Commands<'_>, images: EyeImages) {
    let unused = ImageUse::discarded(DEPTH_TARGET_WRITTEN.stages);
    commands.transition(&images.transitions(vk::ImageAspectFlags::DEPTH, unused, DEPTH_TARGET_WRITTEN));
}

/// Hands the caller's images for depth over as depth attachments that were written: a runtime that takes them next knows
/// nothing of resolving.
pub(super) fn end_depth_target(commands: &Commands<'_>, images: EyeImages) {
    let written = ImageUse { layout: DEPTH_TARGET, ..ImageUse::DEPTH_ATTACHMENT };
    commands.transition(&images.transitions(vk::ImageAspectFlags::DEPTH, DEPTH_TARGET_WRITTEN, written));
}

/// A depth attachment cleared to the farthest depth.
pub(super) fn depth_attachment(
    view: vk::ImageView,
    store: vk::AttachmentStoreOp,
) -> vk::RenderingAttachmentInfo<'static> {
    let far = vk::ClearDepthStencilValue { depth: 0.0, stencil: 0 };
    vk::RenderingAttachmentInfo::default()
        .image_view(view)
        .image_layout(Layout::DEPTH_ATTACHMENT_OPTIMAL)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .store_op(store)
        .clear_value(vk::ClearValue { depth_stencil: far })
}

pub(super) fn area(width: u32, height: u32) -> vk::Rect2D {
    vk::Rect2D { offset: vk::Offset2D::default(), extent: vk::Extent2D { width, height } }
}

/// Views of the caller's images, one for each eye pass; made when an image is first drawn into.
pub(super) struct EyeViews {
    device: Arc<Device>,
    known: Vec<(EyeImages, [vk::ImageView; 2])>,
}

impl EyeViews {
    pub(super) fn new(device: &Arc<Device>) -> Self {
        Self { device: device.clone(), known: Vec::new() }
    }

    /// The views of the images of both eyes.
    pub(super) fn of(
        &mut self,
        images: EyeImages,
        format: vk::Format,
        settings: &Settings,
    ) -> Result<[vk::ImageView; 2], Error> {
        if let Some((_, views)) = self.known.iter().find(|(known, _)| *known == images) {
            return Ok(*views);
        }
        let mut views = [vk::ImageView::null(); 2];
        for (eye_pass, view) in (0..eye_passes(settings)).zip(&mut views) {
            let (image, layer) = images.of_eye(eye_pass);
            match self.make(image, format, (layers(settings) == 1).then_some(layer)) {
                Ok(made) => *view = made,
                Err(error) => {
                    self.known.push((images, views)); // what was made goes with the rest
                    self.clear();
                    return Err(error);
                }
            }
        }
        self.known.push((images, views));
        Ok(views)
    }

    /// A view of one layer, or of all.
    fn make(&self, image: vk::Image, format: vk::Format, layer: Option<u32>) -> Result<vk::ImageView, Error> {
        if let Some(layer) = layer {
            return layer_view(&self.device, image, format, layer);
        }
        let create = vk::ImageViewCreateInfo::default()
            .image(image)
            .format(format)
            .view_type(vk::ImageViewType::TYPE_2D_ARRAY)
            .subresource_range(whole(aspect_of(format)));
        // SAFETY: the image is alive for as long as frames go to it, which is as long as the view is used.
        Ok(unsafe { self.device.raw.create_image_view(&create, None) }.map_err(call("vkCreateImageView"))?)
    }

    /// Destroys the views. Their images are going, or other images may get the same handles.
    pub(super) fn clear(&mut self) {
        for view in self.known.drain(..).flat_map(|(_, views)| views) {
            // SAFETY: every submission was waited for; null handles are ignored.
            unsafe { self.device.raw.destroy_image_view(view, None) };
        }
    }
}

impl Drop for EyeViews {
    fn drop(&mut self) {
        self.clear();
    }
}
