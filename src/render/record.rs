//! The commands of one picture: shadow map, then everything that is seen.

use super::camera::View;
use super::draws::List;
use super::occlusion::Sifted;
use super::parts::view_mask;
use super::pipelines::Resource;
use super::renderer::Renderer;
use super::target::Transition;
use super::user::SOLID_VERTICES;
use super::{CrowdBuffers, Error, User};
use crate::gpu::Buffer;
use crate::kernels::layout::ViewUniforms;
use ash::vk;
use std::ffi::CStr;

type Stage = vk::PipelineStageFlags2;
type Access = vk::AccessFlags2;
type Layout = vk::ImageLayout;

pub(super) const DEPTH_TESTS: Stage =
    Stage::from_raw(Stage::EARLY_FRAGMENT_TESTS.as_raw() | Stage::LATE_FRAGMENT_TESTS.as_raw());
pub(super) const DEPTH_USE: Access = Access::from_raw(
    Access::DEPTH_STENCIL_ATTACHMENT_READ.as_raw() | Access::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw(),
);
const COLOR_USE: Access =
    Access::from_raw(Access::COLOR_ATTACHMENT_READ.as_raw() | Access::COLOR_ATTACHMENT_WRITE.as_raw());
pub(super) const SHADERS: Stage =
    Stage::from_raw(Stage::VERTEX_SHADER.as_raw() | Stage::FRAGMENT_SHADER.as_raw());

/// As a colour attachment is used.
const COLOR_ATTACHMENT: (Stage, Access, Layout) =
    (Stage::COLOR_ATTACHMENT_OUTPUT, COLOR_USE, Layout::COLOR_ATTACHMENT_OPTIMAL);

/// The image a picture is drawn into, of one layer per eye.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Output {
    pub(crate) image: vk::Image,
    /// What each pass draws into: all layers, or one after the other.
    pub(crate) views: [vk::ImageView; 2],
    /// Stage that used the image last (or waits for it to be there).
    pub(crate) before: Stage,
    /// Who uses it next, how, in which layout.
    pub(crate) after: (Stage, Access, Layout),
}

impl Renderer {
    /// Fills the descriptor sets. They must not be in use by the device.
    pub(crate) fn bind(&self, crowd: Option<&CrowdBuffers<'_>>) -> Result<(), Error> {
        for (pass, uniforms) in self.uniforms.iter().enumerate() {
            self.bind_pass(pass, uniforms, crowd)?;
        }
        Ok(())
    }

    fn bind_pass(
        &self,
        pass: usize,
        uniforms: &Buffer,
        crowd: Option<&CrowdBuffers<'_>>,
    ) -> Result<(), Error> {
        let buffer = |buffer: &Buffer| Some(Resource::Buffer(buffer.raw));
        let resource = |name: &str| match name {
            "view" => buffer(uniforms),
            "user" => buffer(&self.user_uniforms),
            "shadow_map" => Some(Resource::Texture(self.shadow_map.view, Layout::SHADER_READ_ONLY_OPTIMAL)),
            "shadow_sampler" => Some(Resource::Sampler(self.sampler)),
            "environment" => self.environment.as_ref().and_then(|e| buffer(&e.vertices)),
            "outsiders" => self.outsiders.as_ref().and_then(|o| buffer(&o.vertices)),
            "clip_postures" => self.meshes.as_ref().and_then(|meshes| buffer(&meshes.postures)),
            name => crowd.and_then(|crowd| crowd.buffer(name)).and_then(buffer),
        };
        if let (Some(occlusion), Some(engine)) = (&self.occlusion, crowd.and_then(|crowd| crowd.engine)) {
            occlusion.bind(engine)?;
        }
        self.programs.sky.bind(pass, resource)?;
        self.programs.user.bind(pass, resource)?;
        #[cfg(feature = "xr")]
        if let Some(mask) = &self.mask {
            self.programs
                .mask
                .bind(pass, |name| (name == "mask").then_some(Resource::Buffer(mask.corners.raw)))?;
        }
        if self.environment.is_some() {
            self.programs.environment.bind(pass, resource)?;
        }
        if let (Some(crowd), Some(meshes)) = (crowd, &self.meshes) {
            crowd.check(meshes.bucket_count + meshes.far_count)?;
            self.programs.crowd.bind(pass, resource)?;
            self.programs.far.bind(pass, resource)?;
            if self.outsiders.is_some() {
                self.programs.outsider.bind(pass, resource)?;
            }
            if self.settings.markers.is_some() {
                self.programs.marker.bind(pass, resource)?;
            }
        }
        Ok(())
    }

    /// Records the whole picture into `output`. [`Renderer::bind`] stands before it, with the same crowd.
    pub(crate) fn record(
        &self,
        commands: vk::CommandBuffer,
        view: &View,
        crowd: Option<&CrowdBuffers<'_>>,
        output: &Output,
    ) -> Result<(), Error> {
        let crowd = crowd.filter(|_| self.meshes.is_some());
        let uniforms = self.view_uniforms(view);
        let (user, solids) = self.user.uniforms();
        // what kernels and copies wrote is there for the draws; the uniforms are free of the picture before
        self.barrier(
            commands,
            (
                Stage::COMPUTE_SHADER | Stage::ALL_TRANSFER | SHADERS,
                Access::SHADER_STORAGE_WRITE | Access::TRANSFER_WRITE,
            ),
            (
                SHADERS | Stage::DRAW_INDIRECT | Stage::INDEX_INPUT | Stage::ALL_TRANSFER,
                Access::SHADER_STORAGE_READ
                    | Access::INDIRECT_COMMAND_READ
                    | Access::INDEX_READ
                    | Access::TRANSFER_WRITE,
            ),
        );
        // SAFETY: recording has begun; the contents are a few hundred bytes, a multiple of four, and fit the buffer.
        unsafe {
            for (eye, buffer) in self.uniforms.iter().enumerate() {
                let uniforms = if self.uniforms.len() > 1 { one_eye(&uniforms, eye) } else { uniforms };
                let bytes = bytemuck::bytes_of(&uniforms);
                self.device.raw.cmd_update_buffer(commands, buffer.raw, 0, bytes);
            }
            if self.user != User::default() {
                let bytes = bytemuck::bytes_of(&user);
                self.device.raw.cmd_update_buffer(commands, self.user_uniforms.raw, 0, bytes);
            }
        }
        self.barrier(
            commands,
            (Stage::ALL_TRANSFER, Access::TRANSFER_WRITE),
            (SHADERS, Access::UNIFORM_READ),
        );
        self.label(commands, Some(c"gaitway.shadow"));
        self.record_shadow(commands, crowd);
        self.label(commands, None);
        self.begin_output(commands, output);
        for (pass, target) in output.views.into_iter().enumerate().take(self.uniforms.len()) {
            self.label(commands, Some(c"gaitway.picture"));
            self.record_picture(commands, view, crowd, (solids, pass, target))?;
            self.label(commands, None);
        }
        self.end_output(commands, output);
        // kernels of the next step may overwrite what was drawn from
        self.barrier(
            commands,
            (SHADERS | Stage::DRAW_INDIRECT, Access::NONE),
            (Stage::COMPUTE_SHADER | Stage::ALL_TRANSFER, Access::NONE),
        );
        Ok(())
    }

    fn record_shadow(&self, commands: vk::CommandBuffer, crowd: Option<&CrowdBuffers<'_>>) {
        let map = &self.shadow_map;
        let aspect = vk::ImageAspectFlags::DEPTH;
        let (image, attachment) = (map.raw, (DEPTH_TESTS, DEPTH_USE, Layout::DEPTH_ATTACHMENT_OPTIMAL));
        let sampled = (Stage::FRAGMENT_SHADER, Access::SHADER_SAMPLED_READ, Layout::SHADER_READ_ONLY_OPTIMAL);
        let unread = (Stage::FRAGMENT_SHADER | DEPTH_TESTS, Access::NONE, Layout::UNDEFINED);
        self.transition(commands, &[Transition { image, aspect, from: unread, to: attachment }]);
        let depth = depth_attachment(map.view, vk::AttachmentStoreOp::STORE);
        let area = area(self.shadow_size, self.shadow_size);
        let rendering =
            vk::RenderingInfo::default().render_area(area).layer_count(1).depth_attachment(&depth);
        // SAFETY: recording has begun and the map is in the layout of the attachment.
        unsafe { self.device.raw.cmd_begin_rendering(commands, &rendering) };
        if self.settings.shadow_size > 0 {
            self.set_area(commands, area);
            self.draw_environment(commands, self.pipelines.environment_shadow, 0);
            self.draw_crowd(commands, &[self.pipelines.crowd_shadow], crowd, 0);
            self.draw_outsiders(commands, self.pipelines.outsider_shadow, crowd, 0);
            self.draw_far(commands, self.pipelines.far_shadow, crowd, (self.far_buckets(), List::Shadow), 0);
        }
        // SAFETY: rendering has begun.
        unsafe { self.device.raw.cmd_end_rendering(commands) };
        self.transition(commands, &[Transition { image, aspect, from: attachment, to: sampled }]);
    }

    fn begin_output(&self, commands: vk::CommandBuffer, output: &Output) {
        let before = output.before | Stage::COLOR_ATTACHMENT_OUTPUT;
        let output = Transition {
            image: output.image,
            aspect: vk::ImageAspectFlags::COLOR,
            from: (before, Access::COLOR_ATTACHMENT_WRITE, Layout::UNDEFINED),
            to: COLOR_ATTACHMENT,
        };
        self.transition(commands, &[output]);
        #[cfg(feature = "xr")]
        self.begin_depth_output(commands);
    }

    fn end_output(&self, commands: vk::CommandBuffer, output: &Output) {
        let from = (
            Stage::COLOR_ATTACHMENT_OUTPUT,
            Access::COLOR_ATTACHMENT_WRITE,
            Layout::COLOR_ATTACHMENT_OPTIMAL,
        );
        let color = vk::ImageAspectFlags::COLOR;
        let finished = Transition { image: output.image, aspect: color, from, to: output.after };
        self.transition(commands, &[finished]);
    }

    /// One pass: both eyes, or one of them.
    fn record_picture(
        &self,
        commands: vk::CommandBuffer,
        view: &View,
        crowd: Option<&CrowdBuffers<'_>>,
        (solids, pass, target): (u32, usize, vk::ImageView),
    ) -> Result<(), Error> {
        self.begin_attachments(commands);
        let sieve = self.sieve(view, crowd);
        let part = |is_first, is_last| self.begin_part(commands, (pass, target), is_first, is_last);
        part(true, sieve.is_none());
        #[cfg(feature = "xr")]
        self.draw_mask(commands, pass);
        // near to far by likelihood: hands are nearest, people and buildings hide who is far away, everything hides the sky
        self.draw_user(commands, self.pipelines.user, (SOLID_VERTICES, solids), pass);
        self.draw_crowd(commands, &[self.pipelines.crowd_near, self.pipelines.crowd], crowd, pass);
        self.draw_outsiders(commands, self.pipelines.outsider, crowd, pass);
        self.draw_environment(commands, self.pipelines.environment, pass);
        let far = self.pipelines.far;
        if let Some(sieve) = sieve {
            for sifted in [Sifted::FarBodies, Sifted::Specks] {
                self.end_part(commands);
                self.sift(commands, sieve, view, sifted, pass)?;
                part(false, sifted == Sifted::Specks);
                self.draw_far(commands, far, crowd, (self.sifted_buckets(sifted), List::Sifted), pass);
            }
        } else {
            self.draw_far(commands, far, crowd, (self.far_buckets(), List::Picture), pass);
        }
        self.draw_sky(commands, pass);
        self.draw_markers(commands, crowd, pass);
        let has_target = u32::from(self.user.teleport.is_some());
        self.draw_user(commands, self.pipelines.target, (6, has_target), pass);
        let has_vignette = u32::from(self.user.vignette > 0.0);
        self.draw_user(commands, self.pipelines.vignette, (3, has_vignette), pass);
        self.end_part(commands);
        Ok(())
    }

    /// Makes depth and samples ready to be drawn: the pass before has finished with them.
    fn begin_attachments(&self, commands: vk::CommandBuffer) {
        let mut before = vec![Transition {
            image: self.attachments.depth.raw,
            aspect: vk::ImageAspectFlags::DEPTH,
            from: (DEPTH_TESTS, Access::DEPTH_STENCIL_ATTACHMENT_WRITE, Layout::UNDEFINED),
            to: (DEPTH_TESTS, DEPTH_USE, Layout::DEPTH_ATTACHMENT_OPTIMAL),
        }];
        before.extend(self.attachments.multisampled.as_ref().map(|multisampled| Transition {
            image: multisampled.raw,
            aspect: vk::ImageAspectFlags::COLOR,
            from: (Stage::COLOR_ATTACHMENT_OUTPUT, Access::COLOR_ATTACHMENT_WRITE, Layout::UNDEFINED),
            to: COLOR_ATTACHMENT,
        }));
        self.transition(commands, &before);
    }

    /// Begins a part of a pass: the first one clears, the last one leaves the picture.
    fn begin_part(
        &self,
        commands: vk::CommandBuffer,
        (pass, view): (usize, vk::ImageView),
        is_first: bool,
        is_last: bool,
    ) {
        let load = if is_first { vk::AttachmentLoadOp::CLEAR } else { vk::AttachmentLoadOp::LOAD };
        let clear = vk::ClearValue { color: vk::ClearColorValue { float32: [0.0, 0.0, 0.0, 1.0] } };
        let mut target = vk::RenderingAttachmentInfo::default()
            .image_layout(Layout::COLOR_ATTACHMENT_OPTIMAL)
            .load_op(load)
            .store_op(vk::AttachmentStoreOp::STORE)
            .clear_value(clear);
        match &self.attachments.multisampled {
            Some(multisampled) if is_last => {
                target = target
                    .image_view(multisampled.view)
                    .store_op(vk::AttachmentStoreOp::DONT_CARE)
                    .resolve_mode(vk::ResolveModeFlags::AVERAGE)
                    .resolve_image_view(view)
                    .resolve_image_layout(Layout::COLOR_ATTACHMENT_OPTIMAL);
            }
            Some(multisampled) => target = target.image_view(multisampled.view),
            None => target = target.image_view(view),
        }
        let targets = [target];
        let kept = if is_last { vk::AttachmentStoreOp::DONT_CARE } else { vk::AttachmentStoreOp::STORE };
        let mut depth = depth_attachment(self.attachments.depth.view, kept).load_op(load);
        if is_last {
            depth = self.depth_of_pass(depth, pass);
        }
        let area = area(self.settings.width, self.settings.height);
        let rendering = vk::RenderingInfo::default()
            .render_area(area)
            .layer_count(1)
            .view_mask(view_mask(&self.settings))
            .color_attachments(&targets)
            .depth_attachment(&depth);
        // SAFETY: recording has begun and the images are in the layouts of the attachments.
        unsafe { self.device.raw.cmd_begin_rendering(commands, &rendering) };
        self.set_area(commands, area);
    }

    fn end_part(&self, commands: vk::CommandBuffer) {
        // SAFETY: rendering has begun.
        unsafe { self.device.raw.cmd_end_rendering(commands) };
    }

    /// Buckets of all far bodies and specks.
    fn far_buckets(&self) -> std::ops::Range<u32> {
        self.sifted_buckets(Sifted::FarBodies).start..self.sifted_buckets(Sifted::Specks).end
    }

    #[cfg(not(feature = "xr"))]
    #[allow(clippy::unused_self, reason = "headsets want depth")]
    fn depth_of_pass(
        &self,
        attachment: vk::RenderingAttachmentInfo<'static>,
        _pass: usize,
    ) -> vk::RenderingAttachmentInfo<'static> {
        attachment
    }

    pub(super) fn set_area(&self, commands: vk::CommandBuffer, area: vk::Rect2D) {
        #[allow(clippy::cast_precision_loss, reason = "sides of images are far below 2^24")]
        let viewport = vk::Viewport {
            width: area.extent.width as f32,
            height: area.extent.height as f32,
            max_depth: 1.0,
            ..Default::default()
        };
        // SAFETY: recording has begun.
        unsafe {
            self.device.raw.cmd_set_viewport(commands, 0, &[viewport]);
            self.device.raw.cmd_set_scissor(commands, 0, &[area]);
        }
    }

    pub(super) fn barrier(&self, commands: vk::CommandBuffer, from: (Stage, Access), to: (Stage, Access)) {
        let barrier = [vk::MemoryBarrier2::default()
            .src_stage_mask(from.0)
            .src_access_mask(from.1)
            .dst_stage_mask(to.0)
            .dst_access_mask(to.1)];
        // SAFETY: recording has begun, outside of rendering.
        unsafe {
            let dependency = vk::DependencyInfo::default().memory_barriers(&barrier);
            self.device.raw.cmd_pipeline_barrier2(commands, &dependency);
        }
    }

    pub(crate) fn transition(&self, commands: vk::CommandBuffer, transitions: &[Transition]) {
        let barriers: Vec<_> = transitions.iter().map(|transition| transition.barrier()).collect();
        // SAFETY: recording has begun, outside of rendering; the images are alive.
        unsafe {
            let dependency = vk::DependencyInfo::default().image_memory_barriers(&barriers);
            self.device.raw.cmd_pipeline_barrier2(commands, &dependency);
        }
    }

    /// Opens (with a name) or closes a label for captures and validation messages.
    pub(super) fn label(&self, commands: vk::CommandBuffer, name: Option<&CStr>) {
        let Some(loader) = self.device.names.as_ref() else { return };
        // SAFETY: recording has begun; labels are closed in the order they were opened.
        unsafe {
            match name {
                Some(name) => {
                    let label = vk::DebugUtilsLabelEXT::default().label_name(name);
                    loader.cmd_begin_debug_utils_label(commands, &label);
                }
                None => loader.cmd_end_debug_utils_label(commands),
            }
        }
    }
}

/// The same parameters with one of the eyes as the only one.
fn one_eye(both: &ViewUniforms, eye: usize) -> ViewUniforms {
    ViewUniforms {
        clip_from_world: [both.clip_from_world[eye]; 2],
        world_from_clip: [both.world_from_clip[eye]; 2],
        eyes: [both.eyes[eye]; 2],
        ..*both
    }
}

/// A depth attachment cleared to the farthest depth.
fn depth_attachment(
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
