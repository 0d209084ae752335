//! The ground under people who are near, darkened by their feet and bodies.

use super::super::Error;
use super::super::commands::Commands;
use super::super::frame::{Frame, Shared};
use super::super::pipelines::{Program, SetIndex, Setup};
use crate::kernels::draw;
use crate::kernels::shared::body::PALETTE_STRIDE;
use ash::vk;

/// Darkens the ground under the agents that have a pose.
pub(in super::super) struct ContactPass {
    program: Program,
    pipeline: vk::Pipeline,
}

impl ContactPass {
    pub(in super::super) fn new(setup: &Setup<'_>) -> Result<Self, Error> {
        let mut program = setup.program(&draw::CONTACT_SHADOW)?;
        let [vertex, fragment] = ["contact_shadow_vertex", "contact_shadow_fragment"];
        let spec = setup.blended(vertex, fragment, vk::CompareOp::GREATER);
        let pipeline = program.pipeline(&spec)?;
        Ok(Self { program, pipeline })
    }

    pub(in super::super) fn bind(&self, index: SetIndex, shared: &Shared<'_>) -> Result<(), Error> {
        if shared.crowd.is_none() {
            return Ok(());
        }
        self.program.bind(index, |name| shared.find(name))
    }

    pub(in super::super) fn record(&self, frame: &Frame<'_>, commands: &Commands<'_>) {
        let Some(crowd) = frame.crowd else { return };
        // as many as have room for a pose; the shader drops those past the end of the list
        let slots = crowd.buffers.palettes.size() / (16 * u64::from(PALETTE_STRIDE));
        let slots = u32::try_from(slots).unwrap_or(u32::MAX);
        commands.labelled(c"gaitway.contact_shadow", || {
            commands.use_program(&self.program, self.pipeline, frame.eye_pass);
            // SAFETY: rendering has begun; the shader makes its own six vertices.
            unsafe { commands.raw().cmd_draw(commands.buffer, 6, slots, 0, 0) };
        });
    }
}
