//! Agents that are hidden behind others or behind buildings are not drawn.
//!
//! A frame is drawn from near to far: agents with a pose and the environment, lod3 bodies, lod4 bodies. Before each of the
//! latter two, the depth drawn so far says which of them are hidden:
//!
//! 1. `shaders/draw/depth_reduce.wgsl` finds the farthest depth of every tile of the image that one of them touches.
//! 2. Kernel `occlude` marks the bodies that lie behind it in all their tiles.
//! 3. Kernel `occlusion_compact` leaves the marked bodies out and keeps the order of the others.
//!
//! Nothing is carried from frame to frame, and the image stays the same, bit for bit. Bodies of the same depth at a sample
//! are no exception: a hidden body is farther than everything in its tiles, never equal.

use super::super::Error;
use super::super::attachments::{Attachments, area, layers};
use super::super::commands::Commands;
use super::super::frame::{Frame, SHADERS};
use super::super::meshes::FarLod;
use super::super::pipelines::{PipelineSpec, Program, Resource, SetIndex};
use super::super::settings::{Occlusion, Settings};
use super::super::target::{DEPTH_FORMAT, GpuImage, ImageSpec, ImageUse, Transition, layer_view};
use crate::gpu::plan::Op;
use crate::gpu::{Device, Engine};
use crate::kernels::layout::SightUniforms;
use crate::kernels::shared::block::BLOCK;
use crate::kernels::{BufferId, KernelId, draw};
use crate::sim::bodies::MOST_TILES;
use crate::sim::order;
use ash::vk;
use std::sync::Arc;
use vk::{AccessFlags2 as Access, ImageLayout as Layout, PipelineStageFlags2 as Stage};

/// One depth for each tile.
const TILE_FORMAT: vk::Format = vk::Format::R32_SFLOAT;
/// Smallest tile, pixels. It is flat: rows of pixels at the horizon decide what is hidden at eye level.
const LEAST_TILE: [u32; 2] = [2, 1];
/// Fewer bodies of a level than this are drawn without a test.
const FEWEST: u32 = 64;
/// Crowds of fewer agents than this are drawn without a test: there is little to leave out.
const SMALL_CROWD: u32 = 1000;

/// Finds the farthest depths of the tiles of a frame, and has the kernels leave out what is hidden.
pub(in super::super) struct OcclusionPass {
    device: Arc<Device>,
    program: Program,
    pipeline: vk::Pipeline,
    /// A layer for each eye of a pass.
    tiles: GpuImage,
    tile_views: Vec<vk::ImageView>,
    depth_views: Vec<vk::ImageView>,
    /// Of whole images.
    tiling: Tiling,
}

/// Tiles of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Tiling {
    /// Width and height of one, pixels.
    sides: [u32; 2],
    columns: u32,
    rows: u32,
}

fn tiling(width: u32, height: u32) -> Tiling {
    let [mut across, mut down] = LEAST_TILE;
    while (width.div_ceil(across) as usize) * (height.div_ceil(down) as usize) > MOST_TILES {
        if across < 4 * down {
            across *= 2;
        } else {
            down *= 2;
        }
    }
    Tiling { sides: [across, down], columns: width.div_ceil(across), rows: height.div_ceil(down) }
}

impl Tiling {
    /// The same tiles of an image that is no larger.
    fn of(self, settings: &Settings) -> Self {
        let [across, down] = self.sides;
        let (columns, rows) = (settings.width.div_ceil(across), settings.height.div_ceil(down));
        Self { columns: columns.min(self.columns), rows: rows.min(self.rows), ..self }
    }
}

impl OcclusionPass {
    /// The pass for frames drawn into `attachments`; none where the settings or the device rule it out.
    pub(in super::super) fn new(
        device: &Arc<Device>,
        settings: &Settings,
        attachments: &Attachments,
    ) -> Result<Option<Self>, Error> {
        if settings.occlusion != Occlusion::On || !attachments.is_depth_read {
            return Ok(None);
        }
        let tiling = tiling(settings.width, settings.height);
        let count = layers(settings);
        let (shader, vertex, fragment) = if attachments.is_multisampled() {
            (&draw::DEPTH_REDUCE, "depth_reduce_vertex", "depth_reduce_fragment")
        } else {
            (&draw::DEPTH_REDUCE_ONE, "depth_reduce_one_vertex", "depth_reduce_one_fragment")
        };
        let mut program = Program::new(device, shader, count)?;
        let pipeline = program.pipeline(&PipelineSpec {
            vertex,
            fragment: Some(fragment),
            samples: vk::SampleCountFlags::TYPE_1,
            color_format: TILE_FORMAT,
            view_mask: 0,
            cull: vk::CullModeFlags::NONE,
            compare: vk::CompareOp::ALWAYS,
            write_depth: false,
            has_depth: false,
            blend: false,
            covers: false,
        })?;
        let tiles = GpuImage::new(
            device,
            ImageSpec {
                layers: count,
                usage: vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_SRC,
                ..ImageSpec::flat("tiles", [tiling.columns, tiling.rows], TILE_FORMAT)
            },
        )?;
        let mut made = Self {
            device: device.clone(),
            program,
            pipeline,
            tiles,
            tile_views: Vec::new(),
            depth_views: Vec::new(),
            tiling,
        };
        for layer in 0..count {
            made.tile_views.push(layer_view(device, made.tiles.raw, TILE_FORMAT, layer)?);
            made.depth_views.push(layer_view(device, attachments.depth.raw, DEPTH_FORMAT, layer)?);
        }
        Ok(Some(made))
    }

    /// Fills the descriptor sets of a frame in flight, one for each layer of the depth.
    pub(in super::super) fn bind(&self, slot: usize, frame: &Frame<'_>) -> Result<(), Error> {
        let Some(engine) = frame.crowd.and_then(|crowd| crowd.buffers.engine) else { return Ok(()) };
        if engine.buffer(BufferId::Wanted).is_none() {
            return Ok(()); // an engine of other kernels: nothing is left out
        }
        for (eye_pass, view) in self.depth_views.iter().enumerate() {
            self.program.bind(SetIndex { slot, pass: eye_pass }, |name| match name {
                "picture_depth" => Some(Resource::Texture(*view, Layout::SHADER_READ_ONLY_OPTIMAL)),
                _ => engine.buffer(BufferId::Wanted).map(|buffer| Resource::Buffer(buffer.raw)),
            })?;
        }
        Ok(())
    }
}

impl Drop for OcclusionPass {
    fn drop(&mut self) {
        for view in self.tile_views.drain(..).chain(self.depth_views.drain(..)) {
            // SAFETY: the renderer that owns this waits for its submissions.
            unsafe { self.device.raw.destroy_image_view(view, None) };
        }
    }
}

/// The occlusion test of one eye pass.
#[derive(Clone, Copy)]
pub(in super::super) struct OcclusionTest<'a> {
    pass: &'a OcclusionPass,
    attachments: &'a Attachments,
    engine: &'a Engine,
    /// Bound on the number of agents.
    agents: u32,
}

impl OcclusionPass {
    /// The occlusion test of this frame, if it has one. Maps and small crowds have none. The attachments must keep the depth from
    /// the first draw on.
    pub(in super::super) fn test<'a>(
        &'a self,
        frame: &Frame<'a>,
        attachments: &'a Attachments,
        keeps_depth: bool,
    ) -> Option<OcclusionTest<'a>> {
        let buffers = frame.crowd.filter(|_| !frame.view.parallel && keeps_depth)?.buffers;
        let agents = buffers.most_agents();
        if agents < SMALL_CROWD {
            return None;
        }
        let engine =
            buffers.engine.filter(|engine| engine.has(&[KernelId::Occlude, KernelId::OcclusionCompact]))?;
        let room = engine.buffer(BufferId::TileDepth)?.size();
        (room >= 8 * MOST_TILES as u64).then_some(OcclusionTest { pass: self, attachments, engine, agents })
    }

    fn sight(&self, frame: &Frame<'_>, lod: FarLod) -> SightUniforms {
        let (view, eyes) = (frame.view, layers(frame.settings));
        let matrix = |eye: usize| {
            let eye = if eyes > 1 { eye } else { frame.eye_pass };
            view.clip_from_world[if view.eye_count == 2 { eye } else { 0 }].to_cols_array_2d()
        };
        let tiling = self.tiling.of(frame.settings);
        let meshes = frame.crowd.map(|crowd| crowd.meshes);
        let buckets = meshes.map_or(0..0, |meshes| meshes.far_buckets(lod));
        let mut bounds = [[[0.0; 4]; 2]; 32];
        let known = meshes.into_iter().flat_map(|meshes| &meshes.bounds);
        bounds.iter_mut().zip(known).for_each(|(to, from)| *to = *from);
        #[allow(clippy::cast_precision_loss, reason = "at most 16 384")]
        let [width, height] = [frame.settings.width as f32, frame.settings.height as f32];
        SightUniforms {
            clip_from_world: [matrix(0), matrix(1)],
            bounds,
            width,
            height,
            eye_count: eyes,
            tile_width: tiling.sides[0],
            tile_height: tiling.sides[1],
            tile_columns: tiling.columns,
            tile_rows: tiling.rows,
            first_bucket: buckets.start,
            bucket_end: buckets.end,
            start_shift: 1, // lod3 and lod4 bodies stand behind the end of those with a pose
            fewest: FEWEST,
            eye_height: view.eyes[0].y.max(view.eyes[1].y),
        }
    }

    /// Draws the farthest depths of the tiles of one layer.
    fn draw_tiles(&self, commands: &Commands<'_>, tiling: Tiling, layer: u32, view: vk::ImageView) {
        let targets = [vk::RenderingAttachmentInfo::default()
            .image_view(view)
            .image_layout(Layout::COLOR_ATTACHMENT_OPTIMAL)
            .load_op(vk::AttachmentLoadOp::DONT_CARE)
            .store_op(vk::AttachmentStoreOp::STORE)];
        let Tiling { sides, columns, rows } = tiling;
        let rendering = vk::RenderingInfo::default()
            .render_area(area(columns, rows))
            .layer_count(1)
            .color_attachments(&targets);
        let immediates = [sides[0] | sides[1] << 16, columns, rows, layer];
        let blocks = columns.div_ceil(BLOCK) * rows.div_ceil(BLOCK);
        commands.rendering(&rendering, || {
            commands.use_program(&self.program, self.pipeline, layer as usize);
            commands.push(&self.program, bytemuck::cast_slice(&immediates));
            // SAFETY: rendering has begun; the shader makes its own six vertices.
            unsafe { commands.raw().cmd_draw(commands.buffer, 6, blocks, 0, 0) };
        });
    }
}

impl OcclusionTest<'_> {
    /// Finds out, between two parts of an eye pass, which bodies of a level are hidden behind what the parts before have
    /// drawn.
    pub(in super::super) fn record(
        &self,
        frame: &Frame<'_>,
        commands: &Commands<'_>,
        lod: FarLod,
    ) -> Result<(), Error> {
        commands.labelled(c"gaitway.occlusion", || self.record_kernels(frame, commands, lod))
    }

    fn record_kernels(&self, frame: &Frame<'_>, commands: &Commands<'_>, lod: FarLod) -> Result<(), Error> {
        let sight = self.pass.sight(frame, lod);
        let contents = |_, _| bytemuck::bytes_of(&sight).to_vec();
        // what the draws before have read may be overwritten
        let draws = SHADERS | Stage::DRAW_INDIRECT;
        let next = (Stage::COMPUTE_SHADER | Stage::ALL_TRANSFER, Access::NONE);
        commands.barrier((draws, Access::NONE), next);
        if let Some(wanted) = self.engine.buffer(BufferId::Wanted) {
            // SAFETY: recording has begun, outside of rendering; the size is a multiple of four.
            unsafe {
                commands.raw().cmd_fill_buffer(commands.buffer, wanted.raw, 0, vk::WHOLE_SIZE, 0);
            }
        }
        let mut ops = vec![Op::Set(BufferId::Sight)];
        ops.extend(order::marking_dispatches(self.agents).into_iter().map(Op::Dispatch));
        self.engine.record_into(commands.buffer, &ops, contents)?;
        commands.barrier(
            (Stage::COMPUTE_SHADER, Access::SHADER_STORAGE_WRITE),
            (SHADERS, Access::SHADER_STORAGE_READ),
        );
        self.find_farthest(commands, self.pass.tiling.of(frame.settings));
        // `occlude` may overwrite what the tiles' shader has read
        commands.barrier((SHADERS, Access::NONE), next);
        let ops: Vec<Op> = order::occlusion_dispatches(self.agents).into_iter().map(Op::Dispatch).collect();
        self.engine.record_into(commands.buffer, &ops, contents)?;
        // the next part continues the same eye pass
        let (drawn, attachment) = (ImageUse::COLOR_WRITTEN, ImageUse::COLOR_ATTACHMENT);
        commands.barrier((drawn.stages, drawn.access), (attachment.stages, attachment.access));
        Ok(())
    }

    /// Fills the buffer `tile_depth` from the depth drawn so far. The depth is an attachment before and afterwards.
    fn find_farthest(&self, commands: &Commands<'_>, tiling: Tiling) {
        let Some(farthest) = self.engine.buffer(BufferId::TileDepth) else { return };
        let depth = |from, to| Transition {
            image: self.attachments.depth.raw,
            aspect: vk::ImageAspectFlags::DEPTH,
            from,
            to,
        };
        let OcclusionPass { tiles: image, tile_views, .. } = self.pass;
        let tiles = |from, to| Transition { image: image.raw, aspect: vk::ImageAspectFlags::COLOR, from, to };
        let unused = ImageUse::discarded(Stage::COPY | Stage::COLOR_ATTACHMENT_OUTPUT);
        let (attachment, drawn, copied) =
            (ImageUse::DEPTH_ATTACHMENT, ImageUse::COLOR_WRITTEN, ImageUse::COPY_SOURCE);
        commands.transition(&[depth(attachment, ImageUse::SAMPLED), tiles(unused, drawn)]);
        for (layer, view) in (0..).zip(tile_views) {
            self.pass.draw_tiles(commands, tiling, layer, *view);
        }
        commands.transition(&[depth(ImageUse::SAMPLED, attachment), tiles(drawn, copied)]);
        let region = [vk::BufferImageCopy::default()
            .image_extent(vk::Extent3D { width: tiling.columns, height: tiling.rows, depth: 1 })
            .image_subresource(vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                layer_count: u32::try_from(tile_views.len()).unwrap_or(1),
                ..Default::default()
            })];
        // SAFETY: the image is in that layout; `test` has seen that the buffer has room for both layers.
        unsafe {
            let (raw, buffer) = (commands.raw(), commands.buffer);
            raw.cmd_copy_image_to_buffer(buffer, image.raw, copied.layout, farthest.raw, &region);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_a_picture_and_there_are_never_too_many() {
        assert_eq!(tiling(640, 720), Tiling { sides: [2, 1], columns: 320, rows: 720 });
        assert_eq!(tiling(1832, 1920).sides, [8, 2]);
        for (width, height) in [(1, 1), (1921, 1080), (4096, 4096), (16_384, 16_384), (16_384, 3)] {
            let Tiling { sides: [across, down], columns, rows } = tiling(width, height);
            assert!((columns * rows) as usize <= MOST_TILES);
            assert!(across * columns >= width && down * rows >= height);
        }
    }
}
