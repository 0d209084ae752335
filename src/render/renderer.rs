//! The renderer: what is drawn, into what, and pictures of it.

use super::atmosphere::Atmosphere;
use super::camera::View;
use super::pack::MeshBuffers;
use super::pipelines::{PipelineSpec, Program};
use super::record::Output;
use super::scene::{self, Surface};
use super::settings::{Markers, Settings};
#[cfg(any(feature = "xr", feature = "view"))]
use super::target::Transition;
use super::target::{COLOR_FORMAT, DEPTH_FORMAT, GpuImage, ImageSpec};
use super::{CrowdBuffers, Error, Image, shadow};
use crate::gpu::{Buffer, Device, Memory, call};
use crate::kernels::draw;
use crate::kernels::layout::ViewUniforms;
use ash::vk;
use glam::{Mat4, Vec3, Vec4};
use std::sync::Arc;

/// Vertices and indices on the device.
#[derive(Debug)]
pub(crate) struct Environment {
    pub(crate) vertices: Buffer,
    pub(crate) indices: Buffer,
    pub(crate) index_count: u32,
}

/// What the crowd's meshes look like to the renderer.
#[derive(Debug)]
pub(crate) struct CrowdMeshes {
    pub(crate) indices: Buffer,
    pub(crate) bucket_count: u32,
    pub(crate) level_count: u32,
}

pub(crate) struct Programs {
    pub(crate) sky: Program,
    pub(crate) environment: Program,
    pub(crate) crowd: Program,
    pub(crate) marker: Program,
}

/// Pipelines; each belongs to the program of its name.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pipelines {
    pub(crate) sky: vk::Pipeline,
    pub(crate) environment: vk::Pipeline,
    pub(crate) environment_shadow: vk::Pipeline,
    pub(crate) crowd: vk::Pipeline,
    pub(crate) crowd_shadow: vk::Pipeline,
    pub(crate) marker: vk::Pipeline,
}

/// Images of the picture's size.
pub(crate) struct Attachments {
    /// More than one sample a pixel; absent when there is one.
    pub(crate) multisampled: Option<GpuImage>,
    pub(crate) depth: GpuImage,
}

/// Draws a crowd and its environment.
pub struct Renderer {
    pub(crate) attachments: Attachments,
    /// The picture of [`Renderer::draw`] and where the host reads it; made when first needed.
    offscreen: Option<(GpuImage, Buffer)>,
    /// Where the host reads pictures that were drawn into somebody else's image; made when first needed.
    #[cfg(any(feature = "xr", feature = "view"))]
    shot: Option<Buffer>,
    pub(crate) shadow_map: GpuImage,
    pub(crate) shadow_size: u32,
    pub(crate) sampler: vk::Sampler,
    pub(crate) uniforms: Buffer,
    pub(crate) environment: Option<Environment>,
    pub(crate) meshes: Option<CrowdMeshes>,
    pub(crate) programs: Programs,
    pub(crate) pipelines: Pipelines,
    pub(crate) settings: Settings,
    samples: vk::SampleCountFlags,
    color_format: vk::Format,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    pub(crate) device: Arc<Device>,
}

impl std::fmt::Debug for Renderer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Renderer").field("settings", &self.settings).finish_non_exhaustive()
    }
}

/// The most samples up to `wanted` that the device has for colour and depth.
fn samples(device: &Device, wanted: u32) -> vk::SampleCountFlags {
    let both = device.limits.framebuffer_color_sample_counts & device.limits.framebuffer_depth_sample_counts;
    let four = vk::SampleCountFlags::TYPE_4;
    if wanted >= 4 && both.contains(four) { four } else { vk::SampleCountFlags::TYPE_1 }
}

impl Renderer {
    /// Makes pipelines and images for pictures as in `settings`.
    ///
    /// # Errors
    /// When the size is beyond the device, memory is short or a call fails.
    pub fn new(device: &Arc<Device>, settings: Settings) -> Result<Self, Error> {
        Self::with_format(device, settings, COLOR_FORMAT)
    }

    /// The same for output images of another format (a window's or a headset's).
    pub(crate) fn with_format(
        device: &Arc<Device>,
        settings: Settings,
        color_format: vk::Format,
    ) -> Result<Self, Error> {
        let samples = samples(device, settings.samples);
        let largest = device.limits.max_image_dimension2_d.min(16_384);
        let settings = Settings {
            eyes: settings.eyes.clamp(1, 2),
            samples: samples.as_raw(),
            shadow_size: settings.shadow_size.min(largest),
            ..settings
        };
        let attachments = attachments(device, &settings, samples, color_format)?;
        let shadow_size = settings.shadow_size.max(1); // without shadows, one texel that is always lit
        let shadow_map = GpuImage::new(
            device,
            ImageSpec {
                name: "shadow_map",
                extent: vk::Extent2D { width: shadow_size, height: shadow_size },
                layers: 1,
                format: DEPTH_FORMAT,
                samples: vk::SampleCountFlags::TYPE_1,
                usage: vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | vk::ImageUsageFlags::SAMPLED,
            },
        )?;
        let mut programs = Programs {
            sky: Program::new(device, &draw::SKY)?,
            environment: Program::new(device, &draw::ENVIRONMENT)?,
            crowd: Program::new(device, &draw::CROWD)?,
            marker: Program::new(device, &draw::MARKER)?,
        };
        let pipelines = pipelines(&mut programs, &settings, samples, color_format)?;
        let size = size_of::<ViewUniforms>() as u64;
        let mut renderer = Self {
            attachments,
            offscreen: None,
            #[cfg(any(feature = "xr", feature = "view"))]
            shot: None,
            shadow_map,
            shadow_size,
            sampler: vk::Sampler::null(),
            uniforms: Buffer::new(device, "view", size, Memory::Device)?,
            environment: None,
            meshes: None,
            programs,
            pipelines,
            settings,
            samples,
            color_format,
            pool: vk::CommandPool::null(),
            commands: vk::CommandBuffer::null(),
            fence: vk::Fence::null(),
            device: device.clone(),
        };
        renderer.make_commands()?;
        Ok(renderer)
    }

    fn make_commands(&mut self) -> Result<(), Error> {
        let linear = self
            .device
            .format_properties(DEPTH_FORMAT)
            .optimal_tiling_features
            .contains(vk::FormatFeatureFlags::SAMPLED_IMAGE_FILTER_LINEAR);
        let filter = if linear { vk::Filter::LINEAR } else { vk::Filter::NEAREST };
        let sampler = vk::SamplerCreateInfo::default()
            .mag_filter(filter)
            .min_filter(filter)
            .address_mode_u(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .address_mode_v(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .address_mode_w(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .compare_enable(true)
            .compare_op(vk::CompareOp::GREATER_OR_EQUAL); // lit where no farther from the sun than what is stored
        let pool = vk::CommandPoolCreateInfo::default()
            .queue_family_index(self.device.family)
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
        let raw = &self.device.raw;
        // SAFETY: the create-infos are complete; `Drop` destroys what was made.
        unsafe {
            self.sampler = raw.create_sampler(&sampler, None).map_err(call("vkCreateSampler"))?;
            self.pool = raw.create_command_pool(&pool, None).map_err(call("vkCreateCommandPool"))?;
            let allocate =
                vk::CommandBufferAllocateInfo::default().command_pool(self.pool).command_buffer_count(1);
            let made = raw.allocate_command_buffers(&allocate).map_err(call("vkAllocateCommandBuffers"))?;
            self.commands = made.first().copied().unwrap_or_default();
            let fence = vk::FenceCreateInfo::default();
            self.fence = raw.create_fence(&fence, None).map_err(call("vkCreateFence"))?;
        }
        Ok(())
    }

    /// The settings, with what the device could not do changed to what it can.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Changes sun, sky and haze.
    pub fn set_atmosphere(&mut self, atmosphere: Atmosphere) {
        self.settings.atmosphere = atmosphere;
    }

    /// Changes the rings under the agents.
    pub fn set_markers(&mut self, markers: Option<Markers>) {
        self.settings.markers = markers;
    }

    /// Changes the size of the pictures.
    ///
    /// # Errors
    /// When the size is beyond the device or memory is short; the old size stays then.
    pub fn resize(&mut self, width: u32, height: u32) -> Result<(), Error> {
        let settings = Settings { width, height, ..self.settings };
        self.attachments = attachments(&self.device, &settings, self.samples, self.color_format)?;
        self.offscreen = None;
        #[cfg(any(feature = "xr", feature = "view"))]
        {
            self.shot = None;
        }
        self.settings = settings;
        Ok(())
    }

    /// Replaces the environment; no surfaces, no environment.
    ///
    /// # Errors
    /// When a surface's lists do not fit together, it is larger than the device can bind, or memory is short.
    pub fn set_environment(&mut self, surfaces: &[Surface<'_>]) -> Result<(), Error> {
        let (vertices, indices) = scene::pack(surfaces)?;
        self.environment = None;
        if indices.is_empty() {
            return Ok(());
        }
        let index_count = u32::try_from(indices.len())
            .map_err(|error| Error::Mesh(format!("{} indices: {error}", indices.len())))?;
        let vertices = self.upload("environment", bytemuck::cast_slice(&vertices))?;
        let indices = self.upload("environment indices", bytemuck::cast_slice(&indices))?;
        self.environment = Some(Environment { vertices, indices, index_count });
        Ok(())
    }

    /// Takes the indices of the crowd's meshes and their numbers of buckets and levels; the vertices stand in the
    /// engine's buffer `mesh_vertices`.
    ///
    /// # Errors
    /// When memory is short.
    pub fn set_meshes(&mut self, meshes: &MeshBuffers) -> Result<(), Error> {
        let indices = self.upload("mesh indices", bytemuck::cast_slice(&meshes.indices))?;
        let (bucket_count, level_count) = (meshes.bucket_count(), meshes.level_count.max(1));
        self.meshes = Some(CrowdMeshes { indices, bucket_count, level_count });
        Ok(())
    }

    /// A device buffer with these contents.
    fn upload(&self, name: &'static str, bytes: &[u8]) -> Result<Buffer, Error> {
        let limit = u64::from(self.device.limits.max_storage_buffer_range);
        if bytes.len() as u64 > limit {
            return Err(crate::gpu::Error::TooLarge { name, bytes: bytes.len() as u64, limit }.into());
        }
        let mut staging = Buffer::new(&self.device, "staging", bytes.len() as u64, Memory::Upload)?;
        if let Some(to) = staging.bytes_mut().get_mut(..bytes.len()) {
            to.copy_from_slice(bytes);
        }
        let buffer = Buffer::new(&self.device, name, bytes.len() as u64, Memory::Device)?;
        self.submit(|raw, commands| {
            if !bytes.is_empty() {
                let region = [vk::BufferCopy::default().size(bytes.len() as u64)];
                // SAFETY: both buffers are at least that long and live until the submission is done.
                unsafe { raw.cmd_copy_buffer(commands, staging.raw, buffer.raw, &region) };
            }
            Ok(())
        })?;
        Ok(buffer)
    }

    /// Records commands, submits them and waits.
    fn submit(
        &self,
        body: impl FnOnce(&ash::Device, vk::CommandBuffer) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let raw = &self.device.raw;
        let begin = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: every submission is waited for, so the command buffer is not in use.
        unsafe { raw.begin_command_buffer(self.commands, &begin) }.map_err(call("vkBeginCommandBuffer"))?;
        body(raw, self.commands)?;
        // SAFETY: recording has begun.
        unsafe { raw.end_command_buffer(self.commands) }.map_err(call("vkEndCommandBuffer"))?;
        Ok(self.device.submit_and_wait(self.commands, self.fence)?)
    }

    /// Draws a picture and copies it to the host; with two eyes, the left one stands left of the right one.
    ///
    /// # Errors
    /// When a crowd buffer is too short, memory is short or a call fails.
    pub fn draw(&mut self, view: &View, crowd: Option<&CrowdBuffers<'_>>) -> Result<Image, Error> {
        if self.offscreen.is_none() {
            self.offscreen = Some(self.make_offscreen()?);
        }
        let Some((image, readback)) = &self.offscreen else {
            return Err(Error::NoBuffer { shader: "draw", binding: "offscreen" });
        };
        let output = Output {
            image: image.raw,
            view: image.view,
            before: vk::PipelineStageFlags2::COPY,
            after: (
                vk::PipelineStageFlags2::COPY,
                vk::AccessFlags2::TRANSFER_READ,
                vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
            ),
        };
        self.bind(crowd)?;
        self.submit(|_, commands| {
            self.record(commands, view, crowd, &output);
            self.copy_out(commands, image.raw, image.layers, readback);
            Ok(())
        })?;
        Ok(self.assemble(readback.bytes()))
    }

    /// Draws into somebody else's image of one layer per eye, which is left in the layout of a colour attachment; copies
    /// it to the host if that is wanted.
    #[cfg(any(feature = "xr", feature = "view"))]
    pub(crate) fn draw_into(
        &mut self,
        view: &View,
        crowd: Option<&CrowdBuffers<'_>>,
        (image, image_view): (vk::Image, vk::ImageView),
        is_wanted: bool,
    ) -> Result<Option<Image>, Error> {
        use vk::{AccessFlags2 as Access, ImageLayout as Layout, PipelineStageFlags2 as Stage};
        let Settings { width, height, eyes, .. } = self.settings;
        if is_wanted && self.shot.is_none() {
            let bytes = u64::from(width) * u64::from(height) * 4 * u64::from(eyes);
            self.shot = Some(Buffer::new(&self.device, "picture readback", bytes, Memory::Readback)?);
        }
        let drawn = (
            Stage::COLOR_ATTACHMENT_OUTPUT,
            Access::COLOR_ATTACHMENT_WRITE,
            Layout::COLOR_ATTACHMENT_OPTIMAL,
        );
        let copied = (Stage::COPY, Access::TRANSFER_READ, Layout::TRANSFER_SRC_OPTIMAL);
        let shot = self.shot.as_ref().filter(|_| is_wanted);
        let after = if shot.is_some() { copied } else { drawn };
        let output = Output { image, view: image_view, before: Stage::COLOR_ATTACHMENT_OUTPUT, after };
        self.bind(crowd)?;
        self.submit(|_, commands| {
            self.record(commands, view, crowd, &output);
            if let Some(readback) = shot {
                self.copy_out(commands, image, eyes, readback);
                let aspect = vk::ImageAspectFlags::COLOR;
                self.transition(commands, &[Transition { image, aspect, from: copied, to: drawn }]);
            }
            Ok(())
        })?;
        let shot = self.shot.as_ref().filter(|_| is_wanted);
        Ok(shot.map(|readback| self.assemble(readback.bytes())))
    }

    fn make_offscreen(&self) -> Result<(GpuImage, Buffer), Error> {
        let Settings { width, height, eyes, .. } = self.settings;
        let image = GpuImage::new(
            &self.device,
            ImageSpec {
                name: "picture",
                extent: vk::Extent2D { width, height },
                layers: eyes,
                format: self.color_format,
                samples: vk::SampleCountFlags::TYPE_1,
                usage: vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_SRC,
            },
        )?;
        let bytes = u64::from(width) * u64::from(height) * 4 * u64::from(eyes);
        Ok((image, Buffer::new(&self.device, "picture readback", bytes, Memory::Readback)?))
    }

    fn copy_out(&self, commands: vk::CommandBuffer, image: vk::Image, layers: u32, readback: &Buffer) {
        let region = [vk::BufferImageCopy::default()
            .image_extent(vk::Extent3D { width: self.settings.width, height: self.settings.height, depth: 1 })
            .image_subresource(vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                mip_level: 0,
                base_array_layer: 0,
                layer_count: layers,
            })];
        let barrier = [vk::MemoryBarrier2::default()
            .src_stage_mask(vk::PipelineStageFlags2::COPY)
            .src_access_mask(vk::AccessFlags2::TRANSFER_WRITE)
            .dst_stage_mask(vk::PipelineStageFlags2::HOST)
            .dst_access_mask(vk::AccessFlags2::HOST_READ)];
        let layout = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
        // SAFETY: the image is in that layout; the buffer has room for all layers; recording has begun.
        unsafe {
            let raw = &self.device.raw;
            raw.cmd_copy_image_to_buffer(commands, image, layout, readback.raw, &region);
            raw.cmd_pipeline_barrier2(commands, &vk::DependencyInfo::default().memory_barriers(&barrier));
        }
    }

    /// Puts the eyes' pictures side by side.
    fn assemble(&self, bytes: &[u8]) -> Image {
        let Settings { width, height, eyes, .. } = self.settings;
        let one = width as usize * height as usize * 4;
        let mut eye_images = bytes.chunks_exact(one).take(eyes as usize).map(|pixels| Image {
            width,
            height,
            pixels: pixels.to_vec(),
        });
        if eyes == 1 {
            return eye_images.next().unwrap_or_else(|| Image::filled(width, height, [0; 4]));
        }
        let mut both = Image::filled(width * eyes, height, [0; 4]);
        for (eye, image) in (0_u32..).zip(eye_images) {
            both.blit(&image, eye * width, 0);
        }
        both
    }

    /// What the shaders need to know about this picture.
    pub(crate) fn view_uniforms(&self, view: &View) -> ViewUniforms {
        let air = &self.settings.atmosphere;
        let sun = air.sun_direction.try_normalize().unwrap_or(Vec3::Y);
        let fit = shadow::sun_view(view, sun, self.shadow_size);
        let with = |xyz: Vec3, w: f32| xyz.extend(w).to_array();
        let matrices = |f: &dyn Fn(&Mat4) -> Mat4| view.clip_from_world.map(|m| f(&m).to_cols_array_2d());
        let haze = if view.parallel { 0.0 } else { 1.0 };
        let markers = self.settings.markers.unwrap_or_default();
        #[allow(clippy::cast_precision_loss, reason = "at most 16 384")]
        let texels = self.shadow_size as f32;
        ViewUniforms {
            clip_from_world: matrices(&|m| *m),
            world_from_clip: matrices(&Mat4::inverse),
            eyes: view.eyes.map(|eye| with(eye, haze)),
            shadow_from_world: fit.shadow_from_world.to_cols_array_2d(),
            sun_direction: with(sun, fit.texel),
            sun_color: with(air.sun, 1.0 / texels),
            sky_zenith: with(air.zenith, 0.0),
            sky_light: with(air.sky_light, 0.0),
            sky_horizon: with(air.horizon, air.haze.max(0.0)),
            ground_bounce: with(air.ground_bounce, air.exposure),
            emotion_colors: markers.colors.map(|color| Vec4::from((color, markers.opacity)).to_array()),
            level_count: self.meshes.as_ref().map_or(1, |meshes| meshes.level_count),
            bucket_count: self.meshes.as_ref().map_or(0, |meshes| meshes.bucket_count),
            marker_radius: markers.radius,
            marker_width: markers.width,
        }
    }
}

fn attachments(
    device: &Arc<Device>,
    settings: &Settings,
    samples: vk::SampleCountFlags,
    color_format: vk::Format,
) -> Result<Attachments, Error> {
    let Settings { width, height, eyes, .. } = *settings;
    let limits = &device.limits;
    let limit =
        limits.max_image_dimension2_d.min(limits.max_framebuffer_width).min(limits.max_framebuffer_height);
    if width == 0 || height == 0 || width > limit || height > limit {
        return Err(Error::Size { width, height, limit });
    }
    let image = |name, format, usage| {
        let extent = vk::Extent2D { width, height };
        GpuImage::new(device, ImageSpec { name, extent, layers: eyes, format, samples, usage })
    };
    let multisampled = (samples != vk::SampleCountFlags::TYPE_1)
        .then(|| image("multisampled colour", color_format, vk::ImageUsageFlags::COLOR_ATTACHMENT))
        .transpose()?;
    let depth = image("depth", DEPTH_FORMAT, vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT)?;
    Ok(Attachments { multisampled, depth })
}

fn pipelines(
    programs: &mut Programs,
    settings: &Settings,
    samples: vk::SampleCountFlags,
    color_format: vk::Format,
) -> Result<Pipelines, Error> {
    let view_mask = if settings.eyes > 1 { 0b11 } else { 0 };
    let solid = |vertex, fragment| PipelineSpec {
        vertex,
        fragment: Some(fragment),
        samples,
        color_format,
        view_mask,
        cull: vk::CullModeFlags::BACK,
        compare: vk::CompareOp::GREATER, // reversed depth: nearer is larger
        write_depth: true,
        blend: false,
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
    Ok(Pipelines {
        sky: programs.sky.pipeline(&flat("sky_vertex", "sky_fragment", behind_all, false))?,
        environment: programs.environment.pipeline(&solid("environment_vertex", "environment_fragment"))?,
        environment_shadow: programs.environment.pipeline(&shadow("environment_shadow"))?,
        crowd: programs.crowd.pipeline(&solid("crowd_vertex", "crowd_fragment"))?,
        crowd_shadow: programs.crowd.pipeline(&shadow("crowd_shadow"))?,
        marker: programs.marker.pipeline(&flat("marker_vertex", "marker_fragment", near, true))?,
    })
}

impl Drop for Renderer {
    fn drop(&mut self) {
        let raw = &self.device.raw;
        // SAFETY: every submission of the renderer was waited for; null handles are ignored.
        unsafe {
            raw.destroy_sampler(self.sampler, None);
            raw.destroy_fence(self.fence, None);
            raw.destroy_command_pool(self.pool, None);
        }
    }
}
