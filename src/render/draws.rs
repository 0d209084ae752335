//! What a pass draws: scenery, people, the user, the sky.

use super::CrowdBuffers;
use super::pipelines::Program;
use super::renderer::{CrowdMeshes, Renderer};
use crate::kernels::draw::far::SIFTED;
use ash::vk;
use std::ops::Range;

/// Bytes of a `VkDrawIndexedIndirectCommand`.
const DRAW_ARGS_STRIDE: u32 = 20;

/// Which list of people is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum List {
    /// All that the frusta kept.
    Picture,
    /// Those of them who are not hidden.
    Sifted,
    /// All, by the meshes of shadows.
    Shadow,
}

impl Renderer {
    /// Binds a pipeline of a program and the program's set for a pass.
    pub(super) fn use_program(
        &self,
        commands: vk::CommandBuffer,
        program: &Program,
        pipeline: vk::Pipeline,
        pass: usize,
    ) {
        let point = vk::PipelineBindPoint::GRAPHICS;
        let sets = [program.set(pass)];
        // SAFETY: the pipeline and the set were made with the program's layout; recording has begun.
        unsafe {
            self.device.raw.cmd_bind_pipeline(commands, point, pipeline);
            self.device.raw.cmd_bind_descriptor_sets(commands, point, program.layout, 0, &sets, &[]);
        }
    }

    pub(super) fn draw_environment(&self, commands: vk::CommandBuffer, pipeline: vk::Pipeline, pass: usize) {
        let Some(environment) = &self.environment else { return };
        self.label(commands, Some(c"gaitway.environment"));
        self.use_program(commands, &self.programs.environment, pipeline, pass);
        // SAFETY: rendering has begun; every index was checked against the vertices.
        unsafe {
            let raw = &self.device.raw;
            raw.cmd_bind_index_buffer(commands, environment.indices.raw, 0, vk::IndexType::UINT32);
            raw.cmd_draw_indexed(commands, environment.index_count, 1, 0, 0, 0);
        }
        self.label(commands, None);
    }

    /// People with a pose: shadows with one pipeline, pictures with one for the finest level and one for the others.
    pub(super) fn draw_crowd(
        &self,
        commands: vk::CommandBuffer,
        pipelines: &[vk::Pipeline],
        crowd: Option<&CrowdBuffers<'_>>,
        pass: usize,
    ) {
        let (Some(crowd), Some(meshes)) = (crowd, &self.meshes) else { return };
        self.label(commands, Some(c"gaitway.crowd"));
        let program = &self.programs.crowd;
        let list = if pipelines.len() == 1 { List::Shadow } else { List::Picture };
        self.use_program(commands, program, pipelines.first().copied().unwrap_or_default(), pass);
        let raw = &self.device.raw;
        // SAFETY: rendering has begun; `check` has compared the sizes of the buffers with the number of buckets, and
        // what the arguments ask for lies within the meshes, whose table the kernel copied them from.
        unsafe {
            raw.cmd_bind_index_buffer(commands, meshes.indices.raw, 0, vk::IndexType::UINT32);
            // the finest level of every avatar, then the others: one change of pipelines
            let is_near = |bucket: &u32| bucket.is_multiple_of(meshes.level_count);
            let finest = (0..meshes.bucket_count).filter(is_near);
            let others = (0..meshes.bucket_count).filter(|bucket| !is_near(bucket));
            for bucket in finest.chain(others) {
                if let (1, Some(coarse)) = (bucket, pipelines.get(1)) {
                    raw.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, *coarse);
                }
                self.draw_bucket(commands, program, (crowd, meshes), (bucket, list));
            }
        }
        self.label(commands, None);
    }

    /// People far away in these buckets, an avatar after the other.
    pub(super) fn draw_far(
        &self,
        commands: vk::CommandBuffer,
        pipeline: vk::Pipeline,
        crowd: Option<&CrowdBuffers<'_>>,
        (buckets, list): (Range<u32>, List),
        pass: usize,
    ) {
        let (Some(crowd), Some(meshes)) = (crowd, &self.meshes) else { return };
        self.label(commands, Some(c"gaitway.far"));
        let program = &self.programs.far;
        self.use_program(commands, program, pipeline, pass);
        // SAFETY: as in `draw_crowd`.
        unsafe {
            let raw = &self.device.raw;
            raw.cmd_bind_index_buffer(commands, meshes.indices.raw, 0, vk::IndexType::UINT32);
            for bucket in buckets {
                self.draw_bucket(commands, program, (crowd, meshes), (bucket, list));
            }
        }
        self.label(commands, None);
    }

    /// Draws as many of a bucket as the kernels say, or their shadows.
    ///
    /// # Safety
    /// Rendering has begun, a pipeline of the program and the indices are bound, and the bucket is one that
    /// [`CrowdBuffers::check`] knows.
    unsafe fn draw_bucket(
        &self,
        commands: vk::CommandBuffer,
        program: &Program,
        (crowd, meshes): (&CrowdBuffers<'_>, &CrowdMeshes),
        (bucket, list): (u32, List),
    ) {
        let (arguments, place, number) = match list {
            List::Picture => (crowd.draw_args, bucket, bucket),
            List::Sifted => (crowd.shown_args(), bucket, bucket | SIFTED),
            List::Shadow => (crowd.draw_args, meshes.bucket_count + meshes.far_count + bucket, bucket),
        };
        let bytes = number.to_ne_bytes();
        let offset = u64::from(place) * u64::from(DRAW_ARGS_STRIDE);
        let raw = &self.device.raw;
        // SAFETY: the caller's promise.
        unsafe {
            raw.cmd_push_constants(commands, program.layout, vk::ShaderStageFlags::VERTEX, 0, &bytes);
            raw.cmd_draw_indexed_indirect(commands, arguments.raw, offset, 1, DRAW_ARGS_STRIDE);
        }
    }

    /// Hands, teleport target or vignette: `count` instances of so many vertices.
    pub(super) fn draw_user(
        &self,
        commands: vk::CommandBuffer,
        pipeline: vk::Pipeline,
        (vertices, count): (u32, u32),
        pass: usize,
    ) {
        if count == 0 {
            return;
        }
        self.label(commands, Some(c"gaitway.user"));
        self.use_program(commands, &self.programs.user, pipeline, pass);
        // SAFETY: rendering has begun; the shader makes its own vertices.
        unsafe { self.device.raw.cmd_draw(commands, vertices, count, 0, 0) };
        self.label(commands, None);
    }

    pub(super) fn draw_sky(&self, commands: vk::CommandBuffer, pass: usize) {
        self.label(commands, Some(c"gaitway.sky"));
        self.use_program(commands, &self.programs.sky, self.pipelines.sky, pass);
        // SAFETY: rendering has begun; the shader makes its own three vertices.
        unsafe { self.device.raw.cmd_draw(commands, 3, 1, 0, 0) };
        self.label(commands, None);
    }

    pub(super) fn draw_markers(
        &self,
        commands: vk::CommandBuffer,
        crowd: Option<&CrowdBuffers<'_>>,
        pass: usize,
    ) {
        let (Some(crowd), Some(_)) = (crowd, self.settings.markers) else { return };
        self.label(commands, Some(c"gaitway.marker"));
        self.use_program(commands, &self.programs.marker, self.pipelines.marker, pass);
        // as many as there could be; the shader drops those past the end of the list
        let slots = u32::try_from(crowd.visible.size() / 4).unwrap_or(u32::MAX);
        // SAFETY: rendering has begun; the shader makes its own six vertices.
        unsafe { self.device.raw.cmd_draw(commands, 6, slots, 0, 0) };
        self.label(commands, None);
    }
}
