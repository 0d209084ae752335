//! Rings on the ground under the agents.

use super::super::Error;
use super::super::commands::Commands;
use super::super::frame::{Frame, Shared};
use super::super::pipelines::{Program, SetIndex, Setup};
use crate::kernels::draw;
use ash::vk;

/// Draws a ring in the colour of each agent's emotion.
pub(in super::super) struct MarkerPass {
    program: Program,
    pipeline: vk::Pipeline,
}

impl MarkerPass {
    pub(in super::super) fn new(setup: &Setup<'_>) -> Result<Self, Error> {
        let mut program = setup.program(&draw::MARKER)?;
        let spec = setup.blended("marker_vertex", "marker_fragment", vk::CompareOp::GREATER);
        let pipeline = program.pipeline(&spec)?;
        Ok(Self { program, pipeline })
    }

    pub(in super::super) fn bind(
        &self,
        index: SetIndex,
        frame: &Frame<'_>,
        shared: &Shared<'_>,
    ) -> Result<(), Error> {
        if frame.crowd.is_none() || frame.settings.markers.is_none() {
            return Ok(());
        }
        self.program.bind(index, |name| shared.find(name))
    }

    pub(in super::super) fn record(&self, frame: &Frame<'_>, commands: &Commands<'_>) {
        let (Some(crowd), Some(_)) = (frame.crowd, frame.settings.markers) else { return };
        // as many as there could be; the shader drops those past the end of the list
        let slots = u32::try_from(crowd.buffers.visible.size() / 4).unwrap_or(u32::MAX);
        commands.labelled(c"gaitway.marker", || {
            commands.use_program(&self.program, self.pipeline, frame.eye_pass);
            // SAFETY: rendering has begun; the shader makes its own six vertices.
            unsafe { commands.raw().cmd_draw(commands.buffer, 6, slots, 0, 0) };
        });
    }
}
