//! The parts of the eyes' images that a headset's lenses hide: nothing is drawn there.

use super::super::Error;
use super::super::commands::{Commands, Submitter};
use super::super::pipelines::{PipelineSpec, Program, Resource, SetIndex, Setup};
use crate::gpu::Buffer;
use crate::kernels::draw;
use ash::vk;

/// Covers what is hidden, before anything else is drawn.
pub(in super::super) struct MaskPass {
    program: Program,
    pipeline: vk::Pipeline,
    /// None without a triangle.
    triangles: Option<Triangles>,
}

struct Triangles {
    corners: Buffer,
    /// Corners of one eye.
    count: u32,
}

impl MaskPass {
    pub(in super::super) fn new(setup: &Setup<'_>) -> Result<Self, Error> {
        let mut program = setup.program(&draw::MASK)?;
        let over_all = setup.flat("mask_vertex", "mask_fragment", vk::CompareOp::ALWAYS);
        let pipeline = program.pipeline(&PipelineSpec { write_depth: true, ..over_all })?;
        Ok(Self { program, pipeline, triangles: None })
    }

    /// Covers these triangles, black and nearest of all: corners in clip space, the left eye's, then as many of the right
    /// one's.
    pub(in super::super) fn set(&mut self, submitter: &Submitter, corners: &[[f32; 4]]) -> Result<(), Error> {
        self.triangles = None;
        let count = u32::try_from(corners.len() / 6 * 3).unwrap_or(0);
        if count > 0 {
            let used = &corners[..2 * count as usize];
            let corners = submitter.upload("mask", bytemuck::cast_slice(used))?;
            self.triangles = Some(Triangles { corners, count });
        }
        Ok(())
    }

    pub(in super::super) fn bind(&self, index: SetIndex) -> Result<(), Error> {
        let Some(triangles) = &self.triangles else { return Ok(()) };
        let corners = Resource::Buffer(triangles.corners.raw);
        self.program.bind(index, |name| (name == "mask").then_some(corners))
    }

    pub(in super::super) fn record(&self, commands: &Commands<'_>, eye_pass: usize) {
        let Some(Triangles { count, .. }) = self.triangles else { return };
        let first = u32::try_from(eye_pass).unwrap_or(0) * count;
        commands.labelled(c"gaitway.mask", || {
            commands.use_program(&self.program, self.pipeline, eye_pass);
            // SAFETY: rendering has begun; the buffer has the corners of both eyes.
            unsafe { commands.raw().cmd_draw(commands.buffer, count, 1, first, 0) };
        });
    }
}

#[cfg(test)]
#[allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::float_cmp,
    reason = "a test; 0 and 1 are exact"
)]
mod tests {
    use super::super::super::attachments::DEPTH_TARGET;
    use super::super::super::target::{
        COLOR_FORMAT, DEPTH_FORMAT, EyeImages, GpuImage, ImageSpec, ImageUse, Readback,
    };
    use super::super::super::{Camera, Renderer, Settings, Stereo, Surface, Target, View};
    use super::*;
    use crate::gpu::{Device, for_tests};
    use glam::Vec3;
    use std::sync::Arc;

    const SIDE: u32 = 64;

    /// One image of two layers, or two of one.
    fn images(device: &Arc<Device>, format: vk::Format, layers: u32) -> Vec<GpuImage> {
        let usage = match format {
            DEPTH_FORMAT => vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT,
            _ => vk::ImageUsageFlags::COLOR_ATTACHMENT,
        };
        let spec = ImageSpec { layers, usage, ..ImageSpec::flat("test", [SIDE; 2], format) };
        (0..2 / layers).map(|_| GpuImage::readable(device, spec).unwrap()).collect()
    }

    fn of_eyes(images: &[GpuImage]) -> EyeImages {
        match images {
            [left, right] => EyeImages::single([left.raw, right.raw]),
            images => EyeImages::layered(images[0].raw),
        }
    }

    /// Depths of both eyes' frames, row after row.
    fn depths(renderer: &Renderer, depth: EyeImages) -> Vec<f32> {
        let submitter = renderer.submitter();
        let readback = Readback::new(submitter.device(), "test", [SIDE, SIDE], 2).unwrap();
        submitter
            .submit(|commands| {
                let written = ImageUse {
                    stages: vk::PipelineStageFlags2::ALL_COMMANDS,
                    access: vk::AccessFlags2::MEMORY_WRITE,
                    layout: DEPTH_TARGET,
                };
                let aspect = vk::ImageAspectFlags::DEPTH;
                commands.transition(&depth.transitions(aspect, written, ImageUse::COPY_SOURCE));
                readback.copy(commands.raw(), commands.buffer, depth.each(), aspect);
                Ok(())
            })
            .unwrap();
        bytemuck::cast_slice(readback.bytes()).to_vec()
    }

    #[test]
    fn depth_is_that_of_what_is_seen_and_the_hidden_part_is_nearest() {
        let Some(device) = for_tests::device() else { return };
        // a wall four metres away that fills the lower half; above it the sky
        let wall = [[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [9.0, 0.0, 0.0], [-9.0, 0.0, 0.0]].map(Vec3::from);
        let camera = Camera::look_at(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y);
        let view = View { eye_count: 2, ..View::mono(&camera, SIDE, SIDE) };
        let near = view.clip_from_world[0].project_point3(Vec3::ZERO).z;
        let two = Stereo::TwoPasses;
        let mut pictures = Vec::new();
        // (not of four samples in two passes: lavapipe 25.0 resolves depth into the first layer, whatever the view's)
        for (samples, stereo, layers) in
            [(4, Stereo::Auto, 2), (1, Stereo::Auto, 2), (1, two, 2), (4, two, 1), (1, two, 1)]
        {
            let [color, depth] = [COLOR_FORMAT, DEPTH_FORMAT].map(|format| images(&device, format, layers));
            let settings =
                Settings { samples, stereo, eyes: 2, shadow_size: 0, ..Settings::sized(SIDE, SIDE) };
            let mut renderer = Renderer::new(&device, settings).unwrap();
            let surface = Surface {
                positions: &wall,
                normals: &[Vec3::Z; 4],
                colors: &[Vec3::ONE; 4],
                layers: &[],
                materials: &[],
                indices: &[0, 1, 2, 0, 2, 3],
            };
            renderer.set_environment(&[surface]).unwrap();
            // the left half of the left eye, the lower half of the right one
            let triangle = |corners: [[f32; 2]; 3]| corners.map(|[x, y]| [x, y, 1.0, 1.0]);
            let left = triangle([[0.0, -9.0], [0.0, 9.0], [-20.0, 0.0]]);
            let right = triangle([[-9.0, 0.0], [9.0, 0.0], [0.0, 20.0]]);
            renderer.set_mask(&[left, right].concat()).unwrap();
            let depths_of = of_eyes(&depth);
            let (eyes, view_of_all) = (of_eyes(&color), color[0].view);
            let target = Target { color: eyes, view: view_of_all, depth: Some(depths_of), is_copied: true };
            let picture = renderer.draw_into(&view, None, &target).unwrap();
            pictures.push((samples, picture.unwrap()));
            let depths = depths(&renderer, depths_of);
            let at = |eye: u32, x: u32, y: u32| depths[((eye * SIDE + y) * SIDE + x) as usize];
            let case = format!("{samples} samples, {stereo:?}, {layers} layers");
            for x in [2, 20] {
                assert_eq!([at(0, x, 3), at(0, x, 60)], [1.0; 2], "{case}: hidden from the left eye");
            }
            assert_eq!([at(0, 44, 3), at(1, 44, 3), at(1, 10, 3)], [0.0; 3], "{case}: the sky has no end");
            assert!((at(0, 44, 50) - near).abs() < 1e-4 * near, "{case}: {} for {near}", at(0, 44, 50));
            assert_eq!([at(1, 44, 50), at(1, 10, 50)], [1.0; 2], "{case}: hidden from the right eye");
        }
        for (samples, picture) in &pictures {
            let same = pictures.iter().filter(|(other, _)| other == samples);
            assert!(same.clone().count() > 1 && same.clone().all(|(_, other)| other == picture), "{samples}");
        }
        drop(device);
        for_tests::assert_silent();
    }
}
