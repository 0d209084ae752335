//! People who are hidden behind others or behind buildings are not drawn.
//!
//! A picture is drawn from what is near to what is far: people with a pose and the scenery, far bodies, specks. Before
//! the far bodies, and before the specks, the depth drawn so far tells who of them nobody can see: for every tile of the
//! picture that one of them touches, its farthest depth is found (`shaders/draw/depth_reduce.wgsl`); whoever lies behind it in
//! all tiles is left out (kernels `occlude` and `occlusion_compact`). Nothing is remembered from picture to picture, and the order of
//! the others stays: the picture is the same, bit for bit. Bodies of the same depth at a sample are no exception: who is
//! hidden is farther than everything in its tiles, never equal.

use super::camera::View;
use super::crowd::CrowdBuffers;
use super::parts::{Attachments, layers};
use super::pipelines::{PipelineSpec, Program, Resource};
use super::record::{DEPTH_TESTS, DEPTH_USE, SHADERS, area};
use super::renderer::Renderer;
use super::settings::Settings;
use super::target::{GpuImage, ImageSpec, Transition, layer_view, whole};
use super::{Error, target};
use crate::gpu::plan::Op;
use crate::gpu::{Device, Engine, call};
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
/// Smallest tile, pixels: people at eye level are hidden, or not, by the rows of pixels at the horizon.
const LEAST_TILE: [u32; 2] = [2, 1];
/// Fewer far bodies, or specks, than this are drawn without asking.
const FEWEST: u32 = 64;
/// In a crowd of fewer than this nobody is asked for: there is little to leave out.
const SMALL_CROWD: u32 = 1000;

/// Finds the farthest depths of the tiles of a picture.
pub(crate) struct Occlusion {
    device: Arc<Device>,
    program: Program,
    pipeline: vk::Pipeline,
    /// A layer for each eye of a pass.
    tiles: GpuImage,
    tile_views: Vec<vk::ImageView>,
    depth_views: Vec<vk::ImageView>,
    tiling: Tiling,
}

/// Tiles of a picture.
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

impl Occlusion {
    /// What is needed for pictures drawn into `attachments`; none where the device cannot read their depth.
    pub(crate) fn new(
        device: &Arc<Device>,
        settings: &Settings,
        attachments: &Attachments,
    ) -> Result<Option<Self>, Error> {
        if !settings.occlusion || !attachments.is_depth_read {
            return Ok(None);
        }
        let tiling = tiling(settings.width, settings.height);
        let count = layers(settings);
        let (shader, vertex, fragment) = if attachments.multisampled.is_some() {
            (&draw::DEPTH_REDUCE, "depth_reduce_vertex", "depth_reduce_fragment")
        } else {
            (&draw::DEPTH_REDUCE_ONE, "depth_reduce_one_vertex", "depth_reduce_one_fragment")
        };
        let mut program = Program::new(device, shader, count as usize)?;
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
                name: "tiles",
                extent: vk::Extent2D { width: tiling.columns, height: tiling.rows },
                layers: count,
                format: TILE_FORMAT,
                samples: vk::SampleCountFlags::TYPE_1,
                usage: vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_SRC,
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
            made.depth_views.push(depth_view(device, attachments.depth.raw, layer)?);
        }
        Ok(Some(made))
    }

    /// Fills the descriptor sets. They must not be in use by the device.
    pub(crate) fn bind(&self, engine: &Engine) -> Result<(), Error> {
        if engine.buffer(BufferId::Wanted).is_none() {
            return Ok(()); // an engine of other kernels: nobody is left out
        }
        for (layer, view) in self.depth_views.iter().enumerate() {
            self.program.bind(layer, |name| match name {
                "picture_depth" => Some(Resource::Texture(*view, Layout::SHADER_READ_ONLY_OPTIMAL)),
                _ => engine.buffer(BufferId::Wanted).map(|buffer| Resource::Buffer(buffer.raw)),
            })?;
        }
        Ok(())
    }
}

impl Drop for Occlusion {
    fn drop(&mut self) {
        for view in self.tile_views.drain(..).chain(self.depth_views.drain(..)) {
            // SAFETY: the renderer that owns this waits for its submissions.
            unsafe { self.device.raw.destroy_image_view(view, None) };
        }
    }
}

/// A view of one layer of the depth of a picture.
fn depth_view(device: &Device, image: vk::Image, layer: u32) -> Result<vk::ImageView, Error> {
    let create = vk::ImageViewCreateInfo::default()
        .image(image)
        .format(target::DEPTH_FORMAT)
        .view_type(vk::ImageViewType::TYPE_2D)
        .subresource_range(vk::ImageSubresourceRange {
            base_array_layer: layer,
            layer_count: 1,
            ..whole(vk::ImageAspectFlags::DEPTH)
        });
    // SAFETY: the image is alive, bound to memory and has that layer.
    Ok(unsafe { device.raw.create_image_view(&create, None) }.map_err(call("vkCreateImageView"))?)
}

/// What tells who is hidden, its kernels, and a number of agents that is not exceeded.
pub(crate) type Sieve<'a> = (&'a Occlusion, &'a Engine, u32);

/// People who are sifted together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sifted {
    FarBodies,
    Specks,
}

impl Renderer {
    /// What leaves out hidden people of this crowd in this view, if anything does.
    pub(crate) fn sieve<'a>(&'a self, view: &View, crowd: Option<&CrowdBuffers<'a>>) -> Option<Sieve<'a>> {
        // nobody hides anybody on a map
        let occlusion = self.occlusion.as_ref().filter(|_| !view.parallel && self.keeps_depth())?;
        let agents = crowd?.most_agents();
        if agents < SMALL_CROWD {
            return None;
        }
        let engine =
            crowd?.engine.filter(|engine| engine.has(&[KernelId::Occlude, KernelId::OcclusionCompact]))?;
        let room = engine.buffer(BufferId::TileDepth)?.size();
        (room >= 8 * MOST_TILES as u64 && self.meshes.is_some()).then_some((occlusion, engine, agents))
    }

    /// Whether a pass's depth is in an image of our own, from the first draw on.
    fn keeps_depth(&self) -> bool {
        #[cfg(feature = "xr")]
        if self.depth_output.is_some() {
            return self.attachments.multisampled.is_some();
        }
        true
    }

    /// Buckets of the people that are sifted together.
    pub(super) fn sifted_buckets(&self, sifted: Sifted) -> std::ops::Range<u32> {
        let (posed, avatars) =
            self.meshes.as_ref().map_or((0, 0), |meshes| (meshes.bucket_count, meshes.far_count / 2));
        match sifted {
            Sifted::FarBodies => posed..posed + avatars,
            Sifted::Specks => posed + avatars..posed + 2 * avatars,
        }
    }

    /// Finds out, between two parts of a pass, who is hidden behind what the parts before have drawn.
    pub(super) fn sift(
        &self,
        commands: vk::CommandBuffer,
        (occlusion, engine, agents): Sieve<'_>,
        view: &View,
        sifted: Sifted,
        pass: usize,
    ) -> Result<(), Error> {
        self.label(commands, Some(c"gaitway.occlusion"));
        let sight = self.sight(occlusion, view, sifted, pass);
        let contents = |_, _| bytemuck::bytes_of(&sight).to_vec();
        // what the draws before have read may be overwritten
        let draws = SHADERS | Stage::DRAW_INDIRECT;
        let next = (Stage::COMPUTE_SHADER | Stage::ALL_TRANSFER, Access::NONE);
        self.barrier(commands, (draws, Access::NONE), next);
        if let Some(wanted) = engine.buffer(BufferId::Wanted) {
            // SAFETY: recording has begun, outside of rendering; the size is a multiple of four.
            unsafe { self.device.raw.cmd_fill_buffer(commands, wanted.raw, 0, vk::WHOLE_SIZE, 0) };
        }
        let mut ops = vec![Op::Set(BufferId::Sight)];
        ops.extend(order::marking_dispatches(agents).into_iter().map(Op::Dispatch));
        engine.record_into(commands, &ops, contents)?;
        self.barrier(
            commands,
            (Stage::COMPUTE_SHADER, Access::SHADER_STORAGE_WRITE),
            (SHADERS, Access::SHADER_STORAGE_READ),
        );
        self.find_farthest(commands, occlusion, engine);
        // `occlude` may write what the tiles were told to read
        self.barrier(commands, (SHADERS, Access::NONE), next);
        let ops: Vec<Op> = order::occlusion_dispatches(agents).into_iter().map(Op::Dispatch).collect();
        engine.record_into(commands, &ops, contents)?;
        // the next part goes on in the same picture
        let color = Stage::COLOR_ATTACHMENT_OUTPUT;
        let uses = Access::COLOR_ATTACHMENT_READ | Access::COLOR_ATTACHMENT_WRITE;
        self.barrier(commands, (color, Access::COLOR_ATTACHMENT_WRITE), (color, uses));
        self.label(commands, None);
        Ok(())
    }

    fn sight(&self, occlusion: &Occlusion, view: &View, sifted: Sifted, pass: usize) -> SightUniforms {
        let eyes = layers(&self.settings);
        let matrix = |eye: usize| {
            let eye = if eyes > 1 { eye } else { pass };
            view.clip_from_world[if view.eye_count == 2 { eye } else { 0 }].to_cols_array_2d()
        };
        let tiling = occlusion.tiling;
        let buckets = self.sifted_buckets(sifted);
        let mut bounds = [[[0.0; 4]; 2]; 32];
        let known = self.meshes.iter().flat_map(|meshes| &meshes.bounds);
        bounds.iter_mut().zip(known).for_each(|(to, from)| *to = *from);
        #[allow(clippy::cast_precision_loss, reason = "at most 16 384")]
        let [width, height] = [self.settings.width as f32, self.settings.height as f32];
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
            start_shift: 1, // far bodies stand behind the end of those with a pose
            fewest: FEWEST,
            eye_height: view.eyes[0].y.max(view.eyes[1].y),
        }
    }

    /// Fills the buffer `tile_depth` from the depth of the picture, which is a depth attachment before and afterwards.
    fn find_farthest(&self, commands: vk::CommandBuffer, occlusion: &Occlusion, engine: &Engine) {
        let Some(farthest) = engine.buffer(BufferId::TileDepth) else { return };
        let aspect = vk::ImageAspectFlags::DEPTH;
        let image = self.attachments.depth.raw;
        let attachment = (DEPTH_TESTS, DEPTH_USE, Layout::DEPTH_ATTACHMENT_OPTIMAL);
        let read = (Stage::FRAGMENT_SHADER, Access::SHADER_SAMPLED_READ, Layout::SHADER_READ_ONLY_OPTIMAL);
        let tiles = |from, to| Transition {
            image: occlusion.tiles.raw,
            aspect: vk::ImageAspectFlags::COLOR,
            from,
            to,
        };
        let drawn = (
            Stage::COLOR_ATTACHMENT_OUTPUT,
            Access::COLOR_ATTACHMENT_WRITE,
            Layout::COLOR_ATTACHMENT_OPTIMAL,
        );
        let copied = (Stage::COPY, Access::TRANSFER_READ, Layout::TRANSFER_SRC_OPTIMAL);
        let unused = (Stage::COPY | Stage::COLOR_ATTACHMENT_OUTPUT, Access::NONE, Layout::UNDEFINED);
        let depth = |from, to| Transition { image, aspect, from, to };
        self.transition(commands, &[depth(attachment, read), tiles(unused, drawn)]);
        for (layer, view) in (0..).zip(&occlusion.tile_views) {
            self.draw_tiles(commands, occlusion, layer, *view);
        }
        self.transition(commands, &[depth(read, attachment), tiles(drawn, copied)]);
        let region = [vk::BufferImageCopy::default()
            .image_extent(vk::Extent3D {
                width: occlusion.tiling.columns,
                height: occlusion.tiling.rows,
                depth: 1,
            })
            .image_subresource(vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                layer_count: u32::try_from(occlusion.tile_views.len()).unwrap_or(1),
                ..Default::default()
            })];
        // SAFETY: the image is in that layout; `sieve` has seen that the buffer has room for both layers.
        unsafe {
            let raw = &self.device.raw;
            raw.cmd_copy_image_to_buffer(commands, occlusion.tiles.raw, copied.2, farthest.raw, &region);
        }
    }

    /// The farthest depths of the tiles of one layer.
    fn draw_tiles(
        &self,
        commands: vk::CommandBuffer,
        occlusion: &Occlusion,
        layer: u32,
        view: vk::ImageView,
    ) {
        let targets = [vk::RenderingAttachmentInfo::default()
            .image_view(view)
            .image_layout(Layout::COLOR_ATTACHMENT_OPTIMAL)
            .load_op(vk::AttachmentLoadOp::DONT_CARE)
            .store_op(vk::AttachmentStoreOp::STORE)];
        let Tiling { sides, columns, rows } = occlusion.tiling;
        let area = area(columns, rows);
        let rendering =
            vk::RenderingInfo::default().render_area(area).layer_count(1).color_attachments(&targets);
        let immediates = [sides[0] | sides[1] << 16, columns, rows, layer];
        let blocks = columns.div_ceil(BLOCK) * rows.div_ceil(BLOCK);
        let raw = &self.device.raw;
        // SAFETY: recording has begun and the image is in the layout of the attachment; the shader makes its own six
        // vertices and takes sixteen bytes of immediates.
        unsafe {
            raw.cmd_begin_rendering(commands, &rendering);
            self.set_area(commands, area);
            self.use_program(commands, &occlusion.program, occlusion.pipeline, layer as usize);
            let bytes = bytemuck::cast_slice(&immediates);
            raw.cmd_push_constants(
                commands,
                occlusion.program.layout,
                vk::ShaderStageFlags::VERTEX,
                0,
                bytes,
            );
            raw.cmd_draw(commands, 6, blocks, 0, 0);
            raw.cmd_end_rendering(commands);
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
