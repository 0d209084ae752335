//! The renderer: what is drawn, into what, and pictures of it.

use super::atmosphere::Atmosphere;
use super::camera::View;
use super::occlusion::Occlusion;
use super::outsiders::Outsiders;
use super::pack::MeshBuffers;
use super::parts::{Attachments, Pipelines, Programs, attachments, pipelines, samples, stereo};
use super::record::Output;
use super::scene::{self, Surface};
use super::settings::{Markers, Settings, Stereo};
#[cfg(any(feature = "xr", feature = "view"))]
use super::target::Transition;
use super::target::{COLOR_FORMAT, DEPTH_FORMAT, GpuImage, ImageSpec, Readback, layer_view};
use super::{CrowdBuffers, Error, Image, User};
use crate::gpu::{Buffer, Device, Memory, call};
use crate::kernels::layout::{UserUniforms, ViewUniforms};
use ash::vk;
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
    /// `vec4<f32> [clip]`, see [`MeshBuffers::postures`].
    pub(crate) postures: Buffer,
    pub(crate) bucket_count: u32,
    pub(crate) level_count: u32,
    /// Buckets of far bodies, behind the others.
    pub(crate) far_count: u32,
    /// What bodies of each bucket stay within, see [`MeshBuffers::bounds`].
    pub(crate) bounds: Vec<[[f32; 4]; 2]>,
}

/// Draws a crowd and its environment.
pub struct Renderer {
    /// Leaves out who is hidden, where that is wanted and the device can; goes before the images it reads.
    pub(crate) occlusion: Option<Occlusion>,
    pub(crate) attachments: Attachments,
    /// The picture of [`Renderer::draw`] and where the host reads it; made when first needed.
    offscreen: Option<(GpuImage, Readback)>,
    /// Views of the layers of images that were drawn into one eye after the other.
    layer_views: Vec<(vk::Image, [vk::ImageView; 2])>,
    /// Where the host reads pictures that were drawn into somebody else's image; made when first needed.
    #[cfg(any(feature = "xr", feature = "view"))]
    shot: Option<Readback>,
    /// What the lenses of a headset hide.
    #[cfg(feature = "xr")]
    pub(super) mask: Option<super::lens::Mask>,
    /// Where the next picture's depth goes.
    #[cfg(feature = "xr")]
    pub(super) depth_output: Option<super::lens::DepthOutput>,
    /// Views of such images.
    #[cfg(feature = "xr")]
    pub(super) depth_views: Vec<super::lens::DepthOutput>,
    /// A small copy of the picture; made when first needed.
    #[cfg(feature = "xr")]
    pub(super) small: Option<super::shrink::Small>,
    pub(crate) shadow_map: GpuImage,
    pub(crate) shadow_size: u32,
    pub(crate) sampler: vk::Sampler,
    /// Parameters of the shaders, of every pass.
    pub(crate) uniforms: Vec<Buffer>,
    /// What pictures show of the user.
    pub(crate) user: User,
    pub(crate) user_uniforms: Buffer,
    pub(crate) environment: Option<Environment>,
    pub(super) outsiders: Option<Outsiders>,
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
            stereo: stereo(device, &settings),
            samples: samples.as_raw(),
            shadow_size: settings.shadow_size.min(largest),
            ..settings
        };
        let attachments = attachments(device, &settings, samples, color_format)?;
        let occlusion = Occlusion::new(device, &settings, &attachments)?;
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
        let passes = if settings.stereo == Stereo::TwoPasses { settings.eyes } else { 1 };
        let mut programs = Programs::new(device, passes as usize)?;
        let pipelines = pipelines(&mut programs, &settings, samples, color_format)?;
        let size = size_of::<ViewUniforms>() as u64;
        let uniforms = (0..passes).map(|_| Buffer::new(device, "view", size, Memory::Device));
        let uniforms = uniforms.collect::<Result<_, _>>()?;
        let mut renderer = Self {
            occlusion,
            attachments,
            offscreen: None,
            layer_views: Vec::new(),
            #[cfg(any(feature = "xr", feature = "view"))]
            shot: None,
            #[cfg(feature = "xr")]
            mask: None,
            #[cfg(feature = "xr")]
            depth_output: None,
            #[cfg(feature = "xr")]
            depth_views: Vec::new(),
            #[cfg(feature = "xr")]
            small: None,
            shadow_map,
            shadow_size,
            sampler: vk::Sampler::null(),
            uniforms,
            user: User::default(),
            user_uniforms: Buffer::new(device, "user", size_of::<UserUniforms>() as u64, Memory::Device)?,
            environment: None,
            outsiders: None,
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

    /// Shows these hands, this aim and this vignette from the next picture on.
    pub fn set_user(&mut self, user: User) {
        self.user = user;
    }

    /// Changes the size of the pictures.
    ///
    /// # Errors
    /// When the size is beyond the device or memory is short; the old size stays then.
    pub fn resize(&mut self, width: u32, height: u32) -> Result<(), Error> {
        let settings = Settings { width, height, ..self.settings };
        let attachments = attachments(&self.device, &settings, self.samples, self.color_format)?;
        self.occlusion = Occlusion::new(&self.device, &settings, &attachments)?;
        self.attachments = attachments;
        self.forget_layer_views();
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
        let upright = [[0.0; 4]];
        let postures = if meshes.postures.is_empty() { &upright } else { &meshes.postures[..] };
        let postures = self.upload("clip_postures", bytemuck::cast_slice(postures))?;
        let (bucket_count, level_count) = (meshes.bucket_count(), meshes.level_count.max(1));
        let far_count = meshes.far_count();
        self.outsiders = self.upload_outsiders(&meshes.outsiders)?;
        self.meshes = Some(CrowdMeshes {
            indices,
            postures,
            bucket_count,
            level_count,
            far_count,
            bounds: meshes.bounds.clone(),
        });
        Ok(())
    }

    /// A device buffer with these contents.
    pub(super) fn upload(&self, name: &'static str, bytes: &[u8]) -> Result<Buffer, Error> {
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
    pub(super) fn submit(
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
        let image = self.draw_offscreen(view, crowd, true)?;
        image.ok_or(Error::NoBuffer { shader: "draw", binding: "offscreen" })
    }

    /// The same, copied to the host if that is wanted.
    pub(crate) fn draw_offscreen(
        &mut self,
        view: &View,
        crowd: Option<&CrowdBuffers<'_>>,
        is_wanted: bool,
    ) -> Result<Option<Image>, Error> {
        if self.offscreen.is_none() {
            self.offscreen = Some(self.make_offscreen()?);
        }
        let missing = || Error::NoBuffer { shader: "draw", binding: "offscreen" };
        let (raw, view_of_all) =
            self.offscreen.as_ref().map(|(image, _)| (image.raw, image.view)).ok_or_else(missing)?;
        let views = self.output_views(raw, view_of_all)?;
        let (image, readback) = self.offscreen.as_ref().ok_or_else(missing)?;
        let output = Output {
            image: raw,
            views,
            before: vk::PipelineStageFlags2::COPY,
            after: (
                vk::PipelineStageFlags2::COPY,
                vk::AccessFlags2::TRANSFER_READ,
                vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
            ),
        };
        self.bind(crowd)?;
        self.submit(|raw, commands| {
            self.record(commands, view, crowd, &output)?;
            if is_wanted {
                readback.copy(raw, commands, image.raw, vk::ImageAspectFlags::COLOR);
            }
            Ok(())
        })?;
        Ok(is_wanted.then(|| self.assemble(readback.bytes())))
    }

    /// Draws into somebody else's image of one layer per eye, which is left in the layout of a colour attachment; copies
    /// it to the host if that is wanted. What `before` records comes first, in the same submission.
    #[cfg(any(feature = "xr", feature = "view"))]
    pub(crate) fn draw_into(
        &mut self,
        view: &View,
        crowd: Option<&CrowdBuffers<'_>>,
        (image, image_view): (vk::Image, vk::ImageView),
        is_wanted: bool,
        before: impl FnOnce(vk::CommandBuffer) -> Result<(), Error>,
    ) -> Result<Option<Image>, Error> {
        use vk::{AccessFlags2 as Access, ImageLayout as Layout, PipelineStageFlags2 as Stage};
        let Settings { width, height, eyes, .. } = self.settings;
        if is_wanted && self.shot.is_none() {
            self.shot = Some(Readback::new(&self.device, "picture readback", [width, height], eyes)?);
        }
        let drawn = (
            Stage::COLOR_ATTACHMENT_OUTPUT,
            Access::COLOR_ATTACHMENT_WRITE,
            Layout::COLOR_ATTACHMENT_OPTIMAL,
        );
        let copied = (Stage::COPY, Access::TRANSFER_READ, Layout::TRANSFER_SRC_OPTIMAL);
        let views = self.output_views(image, image_view)?;
        let shot = self.shot.as_ref().filter(|_| is_wanted);
        let after = if shot.is_some() { copied } else { drawn };
        let output = Output { image, views, before: Stage::COLOR_ATTACHMENT_OUTPUT, after };
        self.bind(crowd)?;
        self.submit(|raw, commands| {
            before(commands)?;
            self.record(commands, view, crowd, &output)?;
            if let Some(readback) = shot {
                let aspect = vk::ImageAspectFlags::COLOR;
                readback.copy(raw, commands, image, aspect);
                self.transition(commands, &[Transition { image, aspect, from: copied, to: drawn }]);
            }
            Ok(())
        })?;
        let shot = self.shot.as_ref().filter(|_| is_wanted);
        Ok(shot.map(|readback| self.assemble(readback.bytes())))
    }

    /// What each pass draws into, of an image and the view of all its layers.
    fn output_views(&mut self, image: vk::Image, all: vk::ImageView) -> Result<[vk::ImageView; 2], Error> {
        if self.uniforms.len() < 2 {
            return Ok([all; 2]);
        }
        if let Some((_, views)) = self.layer_views.iter().find(|(known, _)| *known == image) {
            return Ok(*views);
        }
        let mut views = [vk::ImageView::null(); 2];
        for (layer, view) in (0..).zip(&mut views) {
            match layer_view(&self.device, image, self.color_format, layer) {
                Ok(made) => *view = made,
                Err(error) => {
                    self.layer_views.push((image, views)); // what was made goes with the rest
                    self.forget_layer_views();
                    return Err(error);
                }
            }
        }
        self.layer_views.push((image, views));
        Ok(views)
    }

    /// Destroys the views of layers: their images go, or may be others under the same names.
    fn forget_layer_views(&mut self) {
        #[cfg(feature = "xr")]
        self.forget_depth_views();
        for view in self.layer_views.drain(..).flat_map(|(_, views)| views) {
            // SAFETY: every submission was waited for; null handles are ignored.
            unsafe { self.device.raw.destroy_image_view(view, None) };
        }
    }

    fn make_offscreen(&self) -> Result<(GpuImage, Readback), Error> {
        let Settings { width, height, eyes, .. } = self.settings;
        let (size, usage) = ([width, height], vk::ImageUsageFlags::COLOR_ATTACHMENT);
        let image = GpuImage::readable(&self.device, "picture", (size, eyes), self.color_format, usage)?;
        Ok((image, Readback::new(&self.device, "picture readback", size, eyes)?))
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
}

impl Drop for Renderer {
    fn drop(&mut self) {
        self.forget_layer_views();
        let raw = &self.device.raw;
        // SAFETY: every submission of the renderer was waited for; null handles are ignored.
        unsafe {
            raw.destroy_sampler(self.sampler, None);
            raw.destroy_fence(self.fence, None);
            raw.destroy_command_pool(self.pool, None);
        }
    }
}
