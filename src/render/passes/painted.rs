//! The finest level of characters with textures. Their other levels, and their shadows, are the crowd's.

use super::super::Error;
use super::super::commands::{Commands, Submitter};
use super::super::frame::{Frame, Shared};
use super::super::materials::Materials;
use super::super::meshes::DrawList;
use super::super::pipelines::{PipelineSpec, Program, Resource, SetIndex, Setup};
use crate::avatar::{Paint, PaintCorner};
use crate::gpu::Buffer;
use crate::kernels::draw;
use crate::kernels::layout::PaintedCorner;
use ash::vk;

/// Draws them. A renderer has this pass once a character has textures.
pub(in super::super) struct PaintedPass {
    program: Program,
    pipeline: vk::Pipeline,
    corners: Buffer,
    materials: Materials,
}

impl PaintedPass {
    pub(in super::super) fn new(
        setup: &Setup<'_>,
        submitter: &Submitter,
        paint: &Paint,
    ) -> Result<Self, Error> {
        let mut program = setup.program(&draw::PAINTED)?;
        let vertex = "painted_vertex";
        let [vertex, fragment] =
            setup.stages([vertex, "painted_fragment"], [vertex, "painted_fine_fragment"]);
        let spec = PipelineSpec { covers: true, ..setup.two_sided(vertex, fragment) };
        let pipeline = program.pipeline(&spec)?;
        let corners: Vec<PaintedCorner> = paint.corners.iter().map(corner).collect();
        Ok(Self {
            program,
            pipeline,
            corners: submitter.upload("painted corners", bytemuck::cast_slice(&corners))?,
            materials: Materials::new(submitter, &paint.textured)?,
        })
    }

    pub(in super::super) fn bind(&self, index: SetIndex, shared: &Shared<'_>) -> Result<(), Error> {
        if shared.crowd.is_none() {
            return Ok(());
        }
        self.program.bind(index, |name| match name {
            "painted_corners" => Some(Resource::Buffer(self.corners.raw)),
            name => self.materials.find(name).or_else(|| shared.find(name)),
        })
    }

    pub(in super::super) fn record(&self, frame: &Frame<'_>, commands: &Commands<'_>) {
        let Some(crowd) = frame.crowd else { return };
        commands.labelled(c"gaitway.painted", || {
            commands.use_program(&self.program, self.pipeline, frame.eye_pass);
            crowd.meshes.bind_indices(commands);
            for bucket in &crowd.meshes.painted {
                // SAFETY: rendering has begun, pipeline and indices are bound, and the meshes have the bucket.
                unsafe { crowd.draw_bucket(commands, &self.program, *bucket, DrawList::Seen) };
            }
        });
    }
}

fn corner(corner: &PaintCorner) -> PaintedCorner {
    PaintedCorner {
        color: corner.color.to_array(),
        uv: corner.uv.to_array(),
        matter: corner.material,
        ..PaintedCorner::default()
    }
}
