//! Images on the device.

use super::Error;
use crate::gpu::{self, Buffer, Device, Memory, call};
use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};
use std::sync::{Arc, PoisonError};

/// Colour of images: eight bits with the sRGB curve. Shaders write linear light; blending and resolving stay linear. Dark
/// tones do not band, and the bytes are those of a PNG.
pub(crate) const COLOR_FORMAT: vk::Format = vk::Format::R8G8B8A8_SRGB;
/// Depth, reversed: 32-bit floats are finest near 0, which is where the distance lies.
pub(crate) const DEPTH_FORMAT: vk::Format = vk::Format::D32_SFLOAT;

/// Samples and colour format of the attachments.
#[derive(Debug, Clone, Copy)]
pub(super) struct Format {
    pub(super) samples: vk::SampleCountFlags,
    pub(super) color: vk::Format,
}

impl Format {
    pub(super) fn is_multisampled(self) -> bool {
        self.samples != vk::SampleCountFlags::TYPE_1
    }
}

/// What an image is to be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ImageSpec<'a> {
    pub(crate) name: &'a str,
    pub(crate) extent: vk::Extent2D,
    pub(crate) layers: u32,
    /// Levels, each half as large as the one before.
    pub(crate) levels: u32,
    /// Whether shaders see layers, even if there is one only.
    pub(crate) is_array: bool,
    pub(crate) format: vk::Format,
    pub(crate) samples: vk::SampleCountFlags,
    pub(crate) usage: vk::ImageUsageFlags,
}

/// An image, its memory and a view of all of it.
pub(crate) struct GpuImage {
    device: Arc<Device>,
    pub(crate) raw: vk::Image,
    pub(crate) view: vk::ImageView,
    allocation: Option<Allocation>,
    /// Memory of its own that the device takes only when its tiles do not suffice; null for all but a tiler's attachments.
    lazy: vk::DeviceMemory,
}

/// The aspect of a format among those used here.
pub(crate) fn aspect_of(format: vk::Format) -> vk::ImageAspectFlags {
    if format == DEPTH_FORMAT { vk::ImageAspectFlags::DEPTH } else { vk::ImageAspectFlags::COLOR }
}

/// All layers and levels of an image.
pub(crate) fn whole(aspect: vk::ImageAspectFlags) -> vk::ImageSubresourceRange {
    vk::ImageSubresourceRange {
        aspect_mask: aspect,
        base_mip_level: 0,
        level_count: vk::REMAINING_MIP_LEVELS,
        base_array_layer: 0,
        layer_count: vk::REMAINING_ARRAY_LAYERS,
    }
}

impl ImageSpec<'_> {
    /// An image of one layer and one sample a pixel for no use yet.
    pub(crate) fn flat(name: &str, [width, height]: [u32; 2], format: vk::Format) -> ImageSpec<'_> {
        let extent = vk::Extent2D { width, height };
        let samples = vk::SampleCountFlags::TYPE_1;
        let usage = vk::ImageUsageFlags::empty();
        ImageSpec { name, extent, layers: 1, levels: 1, is_array: false, format, samples, usage }
    }
}

impl GpuImage {
    /// An image of one sample a pixel that can be copied from, to the host ([`Readback`]) or into another image.
    pub(crate) fn readable(device: &Arc<Device>, spec: ImageSpec<'_>) -> Result<Self, Error> {
        let usage = spec.usage | vk::ImageUsageFlags::TRANSFER_SRC;
        Self::new(device, ImageSpec { samples: vk::SampleCountFlags::TYPE_1, usage, ..spec })
    }

    pub(crate) fn new(device: &Arc<Device>, spec: ImageSpec<'_>) -> Result<Self, Error> {
        let create = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(spec.format)
            .extent(vk::Extent3D { width: spec.extent.width, height: spec.extent.height, depth: 1 })
            .mip_levels(spec.levels)
            .array_layers(spec.layers)
            .samples(spec.samples)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(spec.usage);
        // SAFETY: the create-info is complete; size and samples were checked against the device's limits.
        let raw = unsafe { device.raw.create_image(&create, None) }.map_err(call("vkCreateImage"))?;
        let (view, lazy) = (vk::ImageView::null(), vk::DeviceMemory::null());
        let mut image = Self { device: device.clone(), raw, view, allocation: None, lazy };
        device.name(raw, spec.name);
        // SAFETY: the image was made by this device.
        let requirements = unsafe { device.raw.get_image_memory_requirements(raw) };
        let (memory, offset) = image.allocate(spec, requirements)?;
        // SAFETY: the memory was allocated for this image and is bound once.
        unsafe { device.raw.bind_image_memory(raw, memory, offset) }.map_err(call("vkBindImageMemory"))?;
        let is_array = spec.is_array || spec.layers > 1;
        let view_type = if is_array { vk::ImageViewType::TYPE_2D_ARRAY } else { vk::ImageViewType::TYPE_2D };
        let create = vk::ImageViewCreateInfo::default()
            .image(raw)
            .format(spec.format)
            .view_type(view_type)
            .subresource_range(whole(aspect_of(spec.format)));
        // SAFETY: the image is alive and bound to memory.
        image.view =
            unsafe { device.raw.create_image_view(&create, None) }.map_err(call("vkCreateImageView"))?;
        device.name(image.view, spec.name);
        Ok(image)
    }

    /// Memory for the image, and the place in it. The allocator never takes memory that a device takes lazily.
    fn allocate(
        &mut self,
        spec: ImageSpec<'_>,
        requirements: vk::MemoryRequirements,
    ) -> Result<(vk::DeviceMemory, u64), Error> {
        let device = &self.device;
        let failed = |reason: String| gpu::Error::Memory {
            name: spec.name.to_owned(),
            bytes: requirements.size,
            reason,
        };
        let is_transient = spec.usage.contains(vk::ImageUsageFlags::TRANSIENT_ATTACHMENT);
        let lazy = is_transient.then(|| device.lazy_memory(requirements.memory_type_bits)).flatten();
        if let Some(memory_type) = lazy {
            let mut own = vk::MemoryDedicatedAllocateInfo::default().image(self.raw);
            let create = vk::MemoryAllocateInfo::default()
                .allocation_size(requirements.size)
                .memory_type_index(memory_type)
                .push_next(&mut own);
            // SAFETY: the create-info is complete; `Drop` frees the memory.
            let made = unsafe { device.raw.allocate_memory(&create, None) };
            self.lazy = made.map_err(|result| failed(result.to_string()))?;
            return Ok((self.lazy, 0));
        }
        let mut allocator = device.allocator.lock().unwrap_or_else(PoisonError::into_inner);
        let allocation = allocator
            .allocate(&AllocationCreateDesc {
                name: spec.name,
                requirements,
                location: MemoryLocation::GpuOnly,
                linear: false,
                allocation_scheme: AllocationScheme::DedicatedImage(self.raw),
            })
            .map_err(|error| failed(error.to_string()))?;
        drop(allocator);
        // SAFETY: the allocation is alive; its memory is used for this image alone.
        let place = unsafe { (allocation.memory(), allocation.offset()) };
        self.allocation = Some(allocation);
        Ok(place)
    }
}

/// Images of both eyes: layers of one image, or an image of one layer for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct EyeImages([vk::Image; 2]);

impl EyeImages {
    /// The layers of one image, as many as there are eyes.
    pub(crate) const fn layered(image: vk::Image) -> Self {
        Self([image; 2])
    }

    /// The left eye's image and the right one's, of one layer each. Frames draw one eye after the other into them.
    #[cfg(feature = "xr")]
    pub(crate) const fn single(images: [vk::Image; 2]) -> Self {
        Self(images)
    }

    /// The image in whose first layer the left eye sees.
    #[cfg(feature = "xr")]
    pub(crate) const fn left(self) -> vk::Image {
        self.0[0]
    }

    /// The images, each once.
    pub(crate) fn each(&self) -> &[vk::Image] {
        let [left, right] = self.0;
        if left == right { &self.0[..1] } else { &self.0 }
    }

    /// An eye's image, and its layer in it.
    pub(super) fn of_eye(self, eye: u32) -> (vk::Image, u32) {
        let [left, right] = self.0;
        match eye {
            0 => (left, 0),
            _ if left == right => (right, eye),
            _ => (right, 0),
        }
    }

    /// A change of the layout of all of them.
    pub(super) fn transitions(
        &self,
        aspect: vk::ImageAspectFlags,
        from: ImageUse,
        to: ImageUse,
    ) -> Vec<Transition> {
        self.each().iter().map(|&image| Transition { image, aspect, from, to }).collect()
    }
}

/// A view of one layer of an image. The caller destroys it.
pub(crate) fn layer_view(
    device: &Device,
    image: vk::Image,
    format: vk::Format,
    layer: u32,
) -> Result<vk::ImageView, Error> {
    let create = vk::ImageViewCreateInfo::default()
        .image(image)
        .format(format)
        .view_type(vk::ImageViewType::TYPE_2D)
        .subresource_range(vk::ImageSubresourceRange {
            base_array_layer: layer,
            layer_count: 1,
            ..whole(aspect_of(format))
        });
    // SAFETY: the image is alive, bound to memory and has that layer.
    Ok(unsafe { device.raw.create_image_view(&create, None) }.map_err(call("vkCreateImageView"))?)
}

/// The colours of an image's first layer.
pub(crate) fn first_layer() -> vk::ImageSubresourceLayers {
    vk::ImageSubresourceLayers {
        aspect_mask: vk::ImageAspectFlags::COLOR,
        mip_level: 0,
        base_array_layer: 0,
        layer_count: 1,
    }
}

/// Two opposite corners of an image, for a blit of all of it.
#[cfg(any(feature = "xr", feature = "view"))]
pub(crate) fn corners(size: [u32; 2]) -> [vk::Offset3D; 2] {
    let side = |pixels: u32| i32::try_from(pixels).unwrap_or(i32::MAX);
    [vk::Offset3D::default(), vk::Offset3D { x: side(size[0]), y: side(size[1]), z: 1 }]
}

/// Where the host reads an image of four bytes a pixel, layer after layer, row after row.
#[derive(Debug)]
pub(crate) struct Readback {
    buffer: Buffer,
    size: [u32; 2],
    layers: u32,
}

impl Readback {
    pub(crate) fn new(
        device: &Arc<Device>,
        name: &'static str,
        size: [u32; 2],
        layers: u32,
    ) -> Result<Self, gpu::Error> {
        let bytes = u64::from(size[0]) * u64::from(size[1]) * 4 * u64::from(layers);
        Ok(Self { buffer: Buffer::new(device, name, bytes, Memory::Readback)?, size, layers })
    }

    #[cfg(any(feature = "xr", feature = "view"))]
    pub(crate) const fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Records the copy of images of this size, which have this number of layers together. They are in the layout of a
    /// transfer's source at the stage of copies. Once the submission was waited for, [`Readback::bytes`] has them.
    pub(crate) fn copy(
        &self,
        raw: &ash::Device,
        commands: vk::CommandBuffer,
        images: &[vk::Image],
        aspect: vk::ImageAspectFlags,
    ) {
        let [width, height] = self.size;
        let layer_count = self.layers / u32::try_from(images.len()).unwrap_or(1).max(1);
        let layers = vk::ImageSubresourceLayers { aspect_mask: aspect, layer_count, ..first_layer() };
        let bytes = u64::from(width) * u64::from(height) * 4 * u64::from(layer_count);
        let barrier = [vk::MemoryBarrier2::default()
            .src_stage_mask(vk::PipelineStageFlags2::COPY)
            .src_access_mask(vk::AccessFlags2::TRANSFER_WRITE)
            .dst_stage_mask(vk::PipelineStageFlags2::HOST)
            .dst_access_mask(vk::AccessFlags2::HOST_READ)];
        let layout = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
        for (place, &image) in (0..).zip(images) {
            let region = [vk::BufferImageCopy::default()
                .buffer_offset(place * bytes)
                .image_extent(vk::Extent3D { width, height, depth: 1 })
                .image_subresource(layers)];
            // SAFETY: the image is in that layout; the buffer has room for all layers; recording has begun.
            unsafe { raw.cmd_copy_image_to_buffer(commands, image, layout, self.buffer.raw, &region) };
        }
        // SAFETY: recording has begun.
        unsafe {
            raw.cmd_pipeline_barrier2(commands, &vk::DependencyInfo::default().memory_barriers(&barrier));
        }
    }

    /// What was copied last.
    pub(crate) fn bytes(&self) -> &[u8] {
        let [width, height] = self.size.map(|side| side as usize);
        let bytes = self.buffer.bytes();
        bytes.get(..width * height * 4 * self.layers as usize).unwrap_or(bytes)
    }

    /// The first layer.
    #[cfg(any(feature = "xr", feature = "view"))]
    pub(crate) fn image(&self) -> super::Image {
        let [width, height] = self.size;
        let one = width as usize * height as usize * 4;
        let bytes = self.bytes();
        super::Image { width, height, pixels: bytes.get(..one).unwrap_or(bytes).to_vec() }
    }
}

impl Drop for GpuImage {
    fn drop(&mut self) {
        // SAFETY: the renderer that owns the image waits for its submissions; null handles are ignored.
        unsafe {
            self.device.raw.destroy_image_view(self.view, None);
            self.device.raw.destroy_image(self.raw, None);
            self.device.raw.free_memory(self.lazy, None);
        }
        if let Some(allocation) = self.allocation.take() {
            let mut allocator = self.device.allocator.lock().unwrap_or_else(PoisonError::into_inner);
            let _ = allocator.free(allocation); // fails only for memory that is not the allocator's
        }
    }
}

/// How an image is used: by which stages, with which accesses, in which layout.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ImageUse {
    pub(crate) stages: vk::PipelineStageFlags2,
    pub(crate) access: vk::AccessFlags2,
    pub(crate) layout: vk::ImageLayout,
}

impl ImageUse {
    /// Drawn into, as colour.
    pub(crate) const COLOR_ATTACHMENT: Self = Self {
        access: vk::AccessFlags2::from_raw(
            vk::AccessFlags2::COLOR_ATTACHMENT_READ.as_raw()
                | vk::AccessFlags2::COLOR_ATTACHMENT_WRITE.as_raw(),
        ),
        ..Self::COLOR_WRITTEN
    };
    /// Written as colour, and not blended with.
    pub(crate) const COLOR_WRITTEN: Self = Self {
        stages: vk::PipelineStageFlags2::COLOR_ATTACHMENT_OUTPUT,
        access: vk::AccessFlags2::COLOR_ATTACHMENT_WRITE,
        layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
    };
    /// Drawn into, as depth.
    pub(crate) const DEPTH_ATTACHMENT: Self = Self {
        stages: vk::PipelineStageFlags2::from_raw(
            vk::PipelineStageFlags2::EARLY_FRAGMENT_TESTS.as_raw()
                | vk::PipelineStageFlags2::LATE_FRAGMENT_TESTS.as_raw(),
        ),
        access: vk::AccessFlags2::from_raw(
            vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_READ.as_raw()
                | vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw(),
        ),
        layout: vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL,
    };
    /// Sampled by fragment shaders.
    pub(crate) const SAMPLED: Self = Self {
        stages: vk::PipelineStageFlags2::FRAGMENT_SHADER,
        access: vk::AccessFlags2::SHADER_SAMPLED_READ,
        layout: vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
    };
    /// Copied from.
    pub(crate) const COPY_SOURCE: Self = Self {
        stages: vk::PipelineStageFlags2::COPY,
        access: vk::AccessFlags2::TRANSFER_READ,
        layout: vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
    };

    /// Copied into.
    pub(crate) const COPY_TARGET: Self = Self {
        stages: vk::PipelineStageFlags2::COPY,
        access: vk::AccessFlags2::TRANSFER_WRITE,
        layout: vk::ImageLayout::TRANSFER_DST_OPTIMAL,
    };

    /// Used last by these stages, with contents that nothing needs any more.
    pub(crate) const fn discarded(stages: vk::PipelineStageFlags2) -> Self {
        Self { stages, access: vk::AccessFlags2::NONE, layout: vk::ImageLayout::UNDEFINED }
    }
}

/// One change of an image's layout and the work on both sides of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Transition {
    pub(crate) image: vk::Image,
    pub(crate) aspect: vk::ImageAspectFlags,
    pub(crate) from: ImageUse,
    pub(crate) to: ImageUse,
}

impl Transition {
    pub(crate) fn barrier(self) -> vk::ImageMemoryBarrier2<'static> {
        vk::ImageMemoryBarrier2::default()
            .image(self.image)
            .subresource_range(whole(self.aspect))
            .src_stage_mask(self.from.stages)
            .src_access_mask(self.from.access)
            .old_layout(self.from.layout)
            .dst_stage_mask(self.to.stages)
            .dst_access_mask(self.to.access)
            .new_layout(self.to.layout)
    }
}
