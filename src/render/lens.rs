//! What a headset wants of a picture beside its colours: depth for the compositor, and nothing where its lenses hide it.

use super::parts::layers;
use super::target::{DEPTH_FORMAT, Transition, whole};
use super::{Error, Renderer};
use crate::gpu::{Buffer, call};
use ash::vk;
use vk::{AccessFlags2 as Access, ImageLayout as Layout, PipelineStageFlags2 as Stage};

/// Somebody else's image for the depth of a picture, of one layer per eye, and what each pass writes of it.
pub(crate) type DepthOutput = (vk::Image, [vk::ImageView; 2]);

/// The layout of such an image, before and after.
pub(super) const DEPTH_OUTPUT: Layout = Layout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;

/// Corners of the triangles that a headset's lenses hide.
pub(crate) struct Mask {
    pub(super) corners: Buffer,
    /// Corners of one eye.
    pub(super) count: u32,
}

impl Renderer {
    /// Leaves these triangles of the eyes' pictures black, nearest of all: corners in clip space, the left eye's, then as
    /// many of the right one's. None, nothing is hidden.
    ///
    /// # Errors
    /// When memory is short.
    pub(crate) fn set_mask(&mut self, corners: &[[f32; 4]]) -> Result<(), Error> {
        let count = u32::try_from(corners.len() / 6 * 3).unwrap_or(0);
        self.mask = None;
        if count > 0 {
            let used = &corners[..2 * count as usize];
            self.mask = Some(Mask { corners: self.upload("mask", bytemuck::cast_slice(used))?, count });
        }
        Ok(())
    }

    /// The image that the next picture's depth goes to, in the layout of a depth attachment afterwards; none, nowhere.
    ///
    /// # Errors
    /// When a call fails.
    pub(crate) fn set_depth_output(&mut self, image: Option<vk::Image>) -> Result<(), Error> {
        self.depth_output = match image {
            Some(image) => Some((image, self.depth_views(image)?)),
            None => None,
        };
        Ok(())
    }

    /// What each pass writes of an image for depth.
    fn depth_views(&mut self, image: vk::Image) -> Result<[vk::ImageView; 2], Error> {
        if let Some((_, views)) = self.depth_views.iter().find(|(known, _)| *known == image) {
            return Ok(*views);
        }
        let (one_pass, aspect) = (layers(&self.settings) > 1, vk::ImageAspectFlags::DEPTH);
        let mut views = [vk::ImageView::null(); 2];
        for (layer, view) in (0..).zip(&mut views).take(if one_pass { 1 } else { 2 }) {
            let one = vk::ImageSubresourceRange { base_array_layer: layer, layer_count: 1, ..whole(aspect) };
            let (kind, range) = if one_pass {
                (vk::ImageViewType::TYPE_2D_ARRAY, whole(aspect))
            } else {
                (vk::ImageViewType::TYPE_2D, one)
            };
            let create = vk::ImageViewCreateInfo::default()
                .image(image)
                .format(DEPTH_FORMAT)
                .view_type(kind)
                .subresource_range(range);
            // SAFETY: the image is alive for as long as pictures go to it, which is as long as the view is used.
            let made = unsafe { self.device.raw.create_image_view(&create, None) };
            match made {
                Ok(made) => *view = made,
                Err(result) => {
                    self.depth_views.push((image, views)); // what was made goes with the rest
                    return Err(call("vkCreateImageView")(result).into());
                }
            }
        }
        self.depth_views.push((image, views));
        Ok(views)
    }

    /// Destroys the views: their images go, or may be others under the same names.
    pub(super) fn forget_depth_views(&mut self) {
        self.depth_output = None;
        for view in self.depth_views.drain(..).flat_map(|(_, views)| views) {
            // SAFETY: every submission was waited for; null handles are ignored.
            unsafe { self.device.raw.destroy_image_view(view, None) };
        }
    }

    /// Makes the image for depth ready to be written.
    pub(super) fn begin_depth_output(&self, commands: vk::CommandBuffer) {
        let Some((image, _)) = self.depth_output else { return };
        // resolving depth counts as writing colour
        let stages =
            Stage::EARLY_FRAGMENT_TESTS | Stage::LATE_FRAGMENT_TESTS | Stage::COLOR_ATTACHMENT_OUTPUT;
        let uses = Access::DEPTH_STENCIL_ATTACHMENT_READ
            | Access::DEPTH_STENCIL_ATTACHMENT_WRITE
            | Access::COLOR_ATTACHMENT_WRITE;
        let ready = Transition {
            image,
            aspect: vk::ImageAspectFlags::DEPTH,
            from: (stages, Access::NONE, Layout::UNDEFINED),
            to: (stages, uses, DEPTH_OUTPUT),
        };
        self.transition(commands, &[ready]);
    }

    /// The depth attachment of a pass: its depth is kept, or resolved to the first sample, where somebody wants it.
    pub(super) fn depth_of_pass(
        &self,
        attachment: vk::RenderingAttachmentInfo<'static>,
        pass: usize,
    ) -> vk::RenderingAttachmentInfo<'static> {
        let view = self.depth_output.and_then(|(_, views)| views.get(pass).copied());
        match view {
            None => attachment,
            Some(view) if self.attachments.multisampled.is_some() => attachment
                .resolve_mode(vk::ResolveModeFlags::SAMPLE_ZERO)
                .resolve_image_view(view)
                .resolve_image_layout(DEPTH_OUTPUT),
            Some(view) => {
                attachment.image_view(view).image_layout(DEPTH_OUTPUT).store_op(vk::AttachmentStoreOp::STORE)
            }
        }
    }

    /// Covers what is hidden; the first thing that a pass draws.
    pub(super) fn draw_mask(&self, commands: vk::CommandBuffer, pass: usize) {
        let Some(mask) = &self.mask else { return };
        self.label(commands, Some(c"gaitway.mask"));
        self.use_program(commands, &self.programs.mask, self.pipelines.mask, pass);
        let first = u32::try_from(pass).unwrap_or(0) * mask.count;
        // SAFETY: rendering has begun; the buffer has the corners of both eyes.
        unsafe { self.device.raw.cmd_draw(commands, mask.count, 1, first, 0) };
        self.label(commands, None);
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
    use super::super::target::{COLOR_FORMAT, GpuImage, Readback};
    use super::super::{Camera, Settings, Stereo, Surface, View};
    use super::*;
    use crate::gpu::{Device, for_tests};
    use glam::Vec3;
    use std::sync::Arc;

    const SIDE: u32 = 64;

    fn image(device: &Arc<Device>, format: vk::Format, usage: vk::ImageUsageFlags) -> GpuImage {
        GpuImage::readable(device, "test", ([SIDE; 2], 2), format, usage).unwrap()
    }

    /// Depths of both eyes' pictures, row after row.
    fn depths(renderer: &Renderer, depth: &GpuImage) -> Vec<f32> {
        let readback = Readback::new(&renderer.device, "test", [SIDE, SIDE], 2).unwrap();
        renderer
            .submit(|raw, commands| {
                let source = (Stage::COPY, Access::TRANSFER_READ, Layout::TRANSFER_SRC_OPTIMAL);
                let written = (Stage::ALL_COMMANDS, Access::MEMORY_WRITE, DEPTH_OUTPUT);
                let aspect = vk::ImageAspectFlags::DEPTH;
                let ready = Transition { image: depth.raw, aspect, from: written, to: source };
                renderer.transition(commands, &[ready]);
                readback.copy(raw, commands, depth.raw, aspect);
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
        let color = image(&device, COLOR_FORMAT, vk::ImageUsageFlags::COLOR_ATTACHMENT);
        let depth = image(&device, DEPTH_FORMAT, vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT);
        // (not of four samples in two passes: lavapipe 25.0 resolves depth into the first layer, whatever the view's)
        for (samples, stereo) in [(4, Stereo::Auto), (1, Stereo::Auto), (1, Stereo::TwoPasses)] {
            let settings =
                Settings { samples, stereo, eyes: 2, shadow_size: 0, ..Settings::sized(SIDE, SIDE) };
            let mut renderer = Renderer::new(&device, settings).unwrap();
            let surface = Surface {
                positions: &wall,
                normals: &[Vec3::Z; 4],
                colors: &[Vec3::ONE; 4],
                layers: &[],
                indices: &[0, 1, 2, 0, 2, 3],
            };
            renderer.set_environment(&[surface]).unwrap();
            // the left half of the left eye, the lower half of the right one
            let triangle = |corners: [[f32; 2]; 3]| corners.map(|[x, y]| [x, y, 1.0, 1.0]);
            let left = triangle([[0.0, -9.0], [0.0, 9.0], [-20.0, 0.0]]);
            let right = triangle([[-9.0, 0.0], [9.0, 0.0], [0.0, 20.0]]);
            renderer.set_mask(&[left, right].concat()).unwrap();
            renderer.set_depth_output(Some(depth.raw)).unwrap();
            renderer.draw_into(&view, None, (color.raw, color.view), false, |_| Ok(())).unwrap();
            let depths = depths(&renderer, &depth);
            let at = |eye: u32, x: u32, y: u32| depths[((eye * SIDE + y) * SIDE + x) as usize];
            let case = format!("{samples} samples, {stereo:?}");
            for x in [2, 20] {
                assert_eq!([at(0, x, 3), at(0, x, 60)], [1.0; 2], "{case}: hidden from the left eye");
            }
            assert_eq!([at(0, 44, 3), at(1, 44, 3), at(1, 10, 3)], [0.0; 3], "{case}: the sky has no end");
            assert!((at(0, 44, 50) - near).abs() < 1e-4 * near, "{case}: {} for {near}", at(0, 44, 50));
            assert_eq!([at(1, 44, 50), at(1, 10, 50)], [1.0; 2], "{case}: hidden from the right eye");
        }
        drop((color, depth, device));
        for_tests::assert_silent();
    }
}
