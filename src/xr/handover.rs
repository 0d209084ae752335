//! The end of a frame: its layers are handed over to the runtime, the eyes' one and that of a panel.

use super::error::{Error, check};
use super::panel::layer::PanelImages;
use super::panel::place::Quad;
use super::session::{Eyes, Frame, Session};
use super::views::NEAR;
use crate::picture::Image;
use crate::render::Commands;
use ash::vk;
use openxr as xr;

impl Session {
    /// Takes what the present frame, of a slot, is to write into the panel's images.
    pub(super) fn write_panel(&mut self, slot: usize, picture: &Image) -> Result<(), Error> {
        if self.panel.is_none() {
            self.panel = Some(PanelImages::new(&self.session, &self.device, self.format)?);
        }
        let swaps_red = self.format == vk::Format::B8G8R8A8_SRGB;
        self.panel.as_mut().map_or(Ok(()), |panel| panel.write(slot, picture, swaps_red))
    }

    /// Records what [`Session::write_panel`] took.
    pub(super) fn record_panel(&self, commands: &Commands<'_>, slot: usize) {
        if let Some(panel) = &self.panel {
            panel.record(commands, slot);
        }
    }

    /// Rectangles of the room with parts of the panel's picture, as layers that lie before the eyes' one.
    fn quad_layers(&self, quads: &[Quad]) -> Vec<xr::sys::CompositionLayerQuad> {
        let Some(panel) = self.panel.as_ref().filter(|panel| panel.is_written()) else { return Vec::new() };
        let layer = |quad: &Quad| xr::sys::CompositionLayerQuad {
            ty: xr::sys::CompositionLayerQuad::TYPE,
            next: std::ptr::null(),
            layer_flags: xr::CompositionLayerFlags::BLEND_TEXTURE_SOURCE_ALPHA
                | xr::CompositionLayerFlags::UNPREMULTIPLIED_ALPHA,
            space: self.room.as_raw(),
            eye_visibility: xr::EyeVisibility::BOTH,
            sub_image: panel.part(quad.part),
            pose: quad.pose.to_xr(),
            size: xr::Extent2Df { width: quad.size.x, height: quad.size.y },
        };
        quads.iter().map(layer).collect()
    }

    /// Ends the frame: with the image that is drawn for these eyes, in its first rows and columns, or without one; and with
    /// rectangles of the room that show parts of the panel's picture.
    pub(super) fn end(
        &mut self,
        frame: Frame,
        drawn: Option<(&Eyes, [u32; 2])>,
        quads: &[Quad],
    ) -> Result<(), Error> {
        let _queue = self.device.hold_queue();
        // depth is reversed and has no end: 0 is infinitely far, 1 as near as is drawn
        let depths = self.depth.as_ref().zip(drawn).map(|(depth, (_, size))| {
            [0, 1].map(|eye| xr::sys::CompositionLayerDepthInfoKHR {
                ty: xr::sys::CompositionLayerDepthInfoKHR::TYPE,
                next: std::ptr::null(),
                sub_image: depth.of_eye(eye, size),
                min_depth: 0.0,
                max_depth: 1.0,
                near_z: f32::INFINITY,
                far_z: NEAR,
            })
        });
        let depth_of =
            |eye: usize| depths.as_ref().map_or(std::ptr::null(), |depths| (&raw const depths[eye]).cast());
        let views = |(eyes, size): (&Eyes, [u32; 2])| {
            [0, 1].map(|eye: usize| xr::sys::CompositionLayerProjectionView {
                ty: xr::sys::CompositionLayerProjectionView::TYPE,
                next: depth_of(eye),
                pose: eyes.views[eye].pose,
                fov: eyes.views[eye].fov,
                sub_image: self.color.of_eye(eye, size),
            })
        };
        let views = drawn.map(views);
        let layer = views.as_ref().map(|views| xr::sys::CompositionLayerProjection {
            ty: xr::sys::CompositionLayerProjection::TYPE,
            next: std::ptr::null(),
            layer_flags: xr::CompositionLayerFlags::EMPTY,
            space: self.room.as_raw(),
            view_count: 2,
            views: views.as_ptr(),
        });
        let quads = self.quad_layers(quads);
        let eyes = layer.as_ref().map(|layer| (&raw const *layer).cast());
        let layers: Vec<*const xr::sys::CompositionLayerBaseHeader> =
            eyes.into_iter().chain(quads.iter().map(|quad| (&raw const *quad).cast())).collect();
        let info = xr::sys::FrameEndInfo {
            ty: xr::sys::FrameEndInfo::TYPE,
            next: std::ptr::null(),
            display_time: frame.display,
            environment_blend_mode: self.blend,
            layer_count: u32::try_from(layers.len()).unwrap_or(0),
            layers: layers.as_ptr(),
        };
        // SAFETY: the frame was begun; everything `info` points to lives until the call returns.
        check("xrEndFrame", unsafe { (self.instance.fp().end_frame)(self.session.as_raw(), &raw const info) })
    }
}
