//! How frames get to the device: into images of our own or of the caller, waited for or not.

use super::attachments::{EyeTarget, eye_passes};
use super::camera::View;
use super::commands::Commands;
use super::crowd::CrowdBuffers;
use super::frame::Frame;
use super::meshes::DrawnCrowd;
use super::renderer::Renderer;
use super::settings::Settings;
use super::target::{DEPTH_FORMAT, EyeImages, GpuImage, ImageSpec, ImageUse, Readback};
use super::{Error, Image};
use ash::vk;
#[cfg(feature = "xr")]
use std::time::Duration;
use vk::PipelineStageFlags2 as Stage;

/// Images of the caller that a frame is drawn into.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Target {
    /// Where the colour goes.
    pub(crate) color: EyeImages,
    /// A view of all layers of the colour, for frames of one eye pass.
    pub(crate) view: vk::ImageView,
    /// Where the depth goes, if the caller wants it; in the layout of a depth attachment afterwards.
    pub(crate) depth: Option<EyeImages>,
    /// Whether the colour is copied to the host.
    pub(crate) is_copied: bool,
}

/// What a frame is drawn into.
#[derive(Debug, Clone, Copy)]
pub(super) struct Output {
    pub(super) color: EyeImages,
    pub(super) depth: Option<EyeImages>,
    /// What each eye pass draws into.
    pub(super) eyes: [EyeTarget; 2],
    /// Stage that used the colour last, or that waits for it.
    pub(super) before: Stage,
    /// How the colour is used next.
    pub(super) after: ImageUse,
}

impl Renderer {
    /// Draws a frame and copies it to the host; with two eyes, the left one stands left of the right one.
    ///
    /// # Errors
    /// When a crowd buffer is too short, memory is short or a call fails.
    pub fn draw(&mut self, view: &View, crowd: Option<&CrowdBuffers<'_>>) -> Result<Image, Error> {
        let image = self.draw_offscreen(view, crowd, true)?;
        image.ok_or(Error::NoBuffer { shader: "draw", binding: "offscreen" })
    }

    /// Like [`Renderer::draw`]; the image is copied to the host only if that is wanted.
    pub(crate) fn draw_offscreen(
        &mut self,
        view: &View,
        crowd: Option<&CrowdBuffers<'_>>,
        is_copied: bool,
    ) -> Result<Option<Image>, Error> {
        if self.offscreen.is_none() {
            self.offscreen = Some(self.make_offscreen()?);
        }
        let missing = || Error::NoBuffer { shader: "draw", binding: "offscreen" };
        let target = self.offscreen.as_ref().map(|(image, _)| (image.raw, image.view)).ok_or_else(missing)?;
        let color = EyeImages::layered(target.0);
        let target = Target { color, view: target.1, depth: None, is_copied };
        let output = self.output(&target, Stage::COPY, ImageUse::COPY_SOURCE)?;
        let readback = self.offscreen.as_ref().map(|(_, readback)| readback).filter(|_| target.is_copied);
        let frame = self.frame(view, crowd)?;
        let copy = |commands: &Commands<'_>| {
            if let Some(readback) = readback {
                let (images, aspect) = (target.color.each(), vk::ImageAspectFlags::COLOR);
                readback.copy(commands.raw(), commands.buffer, images, aspect);
            }
            Ok(())
        };
        self.submit(&frame, &output, |_| Ok(()), copy)?;
        self.flights.wait_all()?;
        Ok(readback.map(|readback| self.assemble(readback.bytes())))
    }

    /// Draws into images of the caller, which are left as [`Renderer::submit_into`] leaves them. Returns the copy that the
    /// target asks for.
    #[cfg(any(feature = "view", all(test, feature = "xr")))]
    pub(crate) fn draw_into(
        &mut self,
        view: &View,
        crowd: Option<&CrowdBuffers<'_>>,
        target: &Target,
    ) -> Result<Option<Image>, Error> {
        self.submit_into(view, crowd, target, |_| Ok(()), |_| Ok(()))?;
        self.finish(target.is_copied)
    }

    /// Has the device draw into images of the caller, and does not wait for it. The colour is left in the layout of a colour
    /// attachment, and copied to where [`Renderer::finish`] finds it if that is wanted. What `before` records comes first in
    /// the same submission, what `after` records last. With direct draws, what `before` records is a submission that is waited
    /// for.
    #[cfg(any(feature = "xr", feature = "view"))]
    pub(crate) fn submit_into(
        &mut self,
        view: &View,
        crowd: Option<&CrowdBuffers<'_>>,
        target: &Target,
        before: impl FnOnce(vk::CommandBuffer) -> Result<(), Error>,
        after: impl FnOnce(&Commands<'_>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let Settings { width, height, eyes, .. } = self.settings;
        if target.is_copied && self.copy.as_ref().is_none_or(|copy| copy.size() != [width, height]) {
            self.flights.wait_all()?;
            self.copy = Some(Readback::new(self.device(), "frame readback", [width, height], eyes)?);
        }
        let (drawn, copied) = (ImageUse::COLOR_WRITTEN, ImageUse::COPY_SOURCE);
        let ends = if target.is_copied { copied } else { drawn };
        let output = self.output(target, Stage::COLOR_ATTACHMENT_OUTPUT, ends)?;
        let readback = self.copy.as_ref().filter(|_| target.is_copied);
        let frame = self.frame(view, crowd)?;
        self.submit(&frame, &output, before, |commands| {
            if let Some(readback) = readback {
                let aspect = vk::ImageAspectFlags::COLOR;
                readback.copy(commands.raw(), commands.buffer, target.color.each(), aspect);
                commands.transition(&target.color.transitions(aspect, copied, drawn));
            }
            after(commands)
        })
    }

    /// Waits for all frames. Returns the copy of the newest if that is wanted, and it was copied.
    #[cfg(any(feature = "xr", feature = "view"))]
    pub(crate) fn finish(&self, is_wanted: bool) -> Result<Option<Image>, Error> {
        self.flights.wait_all()?;
        let copy = self.copy.as_ref().filter(|_| is_wanted);
        Ok(copy.map(|copy| self.assemble(copy.bytes())))
    }

    /// Waits until there is room for another frame: until the device has drawn the frame before last. Returns how long that
    /// took it; none where there was no such frame, or it cannot be known.
    #[cfg(feature = "xr")]
    pub(crate) fn make_room(&self) -> Result<Option<Duration>, Error> {
        self.flights.wait(self.flights.next())
    }

    /// The slot that the next frame takes: memory that the host shares with the device is of one slot.
    #[cfg(feature = "xr")]
    pub(crate) fn slot(&self) -> usize {
        self.flights.next()
    }

    /// Submits a frame, and what comes before and after it. With direct draws, what comes before is waited for.
    fn submit(
        &self,
        frame: &Frame<'_>,
        output: &Output,
        before: impl FnOnce(vk::CommandBuffer) -> Result<(), Error>,
        after: impl FnOnce(&Commands<'_>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let slot = self.flights.next();
        self.flights.wait(slot)?;
        self.bind(slot, frame)?;
        let Some((direct, crowd)) = self.direct.as_ref().zip(frame.crowd) else {
            return self.flights.submit(|commands| {
                before(commands.buffer)?;
                self.record(commands, frame, output)?;
                after(commands)
            });
        };
        let known = direct.read(self.submitter(), &crowd, before)?;
        let frame = Frame { crowd: Some(DrawnCrowd { known: Some(&known), ..crowd }), ..*frame };
        self.flights.submit(|commands| {
            self.record(commands, &frame, output)?;
            after(commands)
        })
    }

    fn make_offscreen(&self) -> Result<(GpuImage, Readback), Error> {
        let Settings { width, height, eyes, .. } = self.settings;
        let (size, usage) = ([width, height], vk::ImageUsageFlags::COLOR_ATTACHMENT);
        let spec = ImageSpec { layers: eyes, usage, ..ImageSpec::flat("offscreen", size, self.format.color) };
        let image = GpuImage::readable(self.device(), spec)?;
        Ok((image, Readback::new(self.device(), "offscreen readback", size, eyes)?))
    }

    /// What each eye pass draws into, of the images of a target.
    fn output(&mut self, target: &Target, before: Stage, after: ImageUse) -> Result<Output, Error> {
        let Target { color, view, depth, .. } = *target;
        let colors = match eye_passes(&self.settings) {
            1 => [view; 2],
            _ => self.eye_views.of(color, self.format.color, &self.settings)?,
        };
        let depths = match depth {
            Some(depth) => self.eye_views.of(depth, DEPTH_FORMAT, &self.settings)?.map(Some),
            None => [None; 2],
        };
        let eyes = [0, 1].map(|eye| EyeTarget { color: colors[eye], depth: depths[eye] });
        Ok(Output { color, depth, eyes, before, after })
    }

    /// Puts the eyes' images side by side.
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
