//! The sky, behind everything.

use super::super::Error;
use super::super::commands::Commands;
use super::super::frame::Shared;
use super::super::pipelines::{Program, SetIndex, Setup};
use crate::kernels::draw;
use ash::vk;

/// Fills the pixels that nothing else has covered.
pub(in super::super) struct SkyPass {
    program: Program,
    pipeline: vk::Pipeline,
}

impl SkyPass {
    pub(in super::super) fn new(setup: &Setup<'_>) -> Result<Self, Error> {
        let mut program = setup.program(&draw::SKY)?;
        let behind_all = vk::CompareOp::GREATER_OR_EQUAL; // depth 0 against the cleared 0
        let [vertex, fragment] =
            setup.stages(["sky_vertex", "sky_fragment"], ["sky_vertex", "sky_fine_fragment"]);
        let pipeline = program.pipeline(&setup.flat(vertex, fragment, behind_all))?;
        Ok(Self { program, pipeline })
    }

    pub(in super::super) fn bind(&self, index: SetIndex, shared: &Shared<'_>) -> Result<(), Error> {
        self.program.bind(index, |name| shared.find(name))
    }

    pub(in super::super) fn record(&self, commands: &Commands<'_>, eye_pass: usize) {
        commands.labelled(c"gaitway.sky", || {
            commands.use_program(&self.program, self.pipeline, eye_pass);
            // SAFETY: rendering has begun; the shader makes its own three vertices.
            unsafe { commands.raw().cmd_draw(commands.buffer, 3, 1, 0, 0) };
        });
    }
}
