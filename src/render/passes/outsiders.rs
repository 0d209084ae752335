//! Robots and vehicles: models that follow agents.

use super::super::Error;
use super::super::commands::{Commands, Submitter};
use super::super::frame::{Frame, Shared};
use super::super::pack::OutsiderMesh;
use super::super::pipelines::{Program, Resource, SetIndex, Setup};
use super::super::surface::{self, Surface};
use super::shadow::SunMap;
use crate::gpu::Buffer;
use crate::kernels::draw;
use ash::vk;

/// Draws the models of agents that are not people.
pub(in super::super) struct OutsiderPass {
    program: Program,
    solid: vk::Pipeline,
    shadow: vk::Pipeline,
    models: Option<Models>,
}

/// Meshes on the device, and what is drawn where.
struct Models {
    vertices: Buffer,
    indices: Buffer,
    draws: Vec<Draw>,
}

/// A mesh as an agent.
#[derive(Debug, Clone, Copy)]
struct Draw {
    agent: u32,
    first_index: u32,
    index_count: u32,
}

impl Models {
    /// None if no agent is drawn as one of these meshes.
    fn new(submitter: &Submitter, meshes: &[OutsiderMesh]) -> Result<Option<Self>, Error> {
        let surfaces: Vec<Surface<'_>> = meshes
            .iter()
            .map(|OutsiderMesh { mesh, .. }| Surface {
                positions: &mesh.positions,
                normals: &mesh.normals,
                colors: &mesh.colors,
                layers: &[],
                materials: &[],
                indices: &mesh.indices,
            })
            .collect();
        let (vertices, indices) = surface::pack(&surfaces, 0.0)?;
        let mut draws = Vec::new();
        let mut first_index = 0;
        for OutsiderMesh { mesh, agents, .. } in meshes {
            let count = mesh.indices.len();
            let index_count =
                u32::try_from(count).map_err(|error| Error::Mesh(format!("{count} indices: {error}")))?;
            draws.extend(agents.iter().map(|&agent| Draw { agent, first_index, index_count }));
            first_index += index_count;
        }
        if draws.is_empty() {
            return Ok(None);
        }
        let vertices = submitter.upload("outsiders", bytemuck::cast_slice(&vertices))?;
        let indices = submitter.upload("outsider indices", bytemuck::cast_slice(&indices))?;
        Ok(Some(Self { vertices, indices, draws }))
    }
}

impl OutsiderPass {
    pub(in super::super) fn new(setup: &Setup<'_>) -> Result<Self, Error> {
        let mut program = setup.program(&draw::OUTSIDER)?;
        let low = ["outsider_vertex", "outsider_fragment"];
        let [vertex, fragment] = setup.stages(low, ["outsider_vertex", "outsider_fine_fragment"]);
        let solid = program.pipeline(&setup.two_sided(vertex, fragment))?;
        let shadow = program.pipeline(&setup.shadow("outsider_shadow"))?;
        Ok(Self { program, solid, shadow, models: None })
    }

    /// Replaces the models.
    pub(in super::super) fn set(
        &mut self,
        submitter: &Submitter,
        meshes: &[OutsiderMesh],
    ) -> Result<(), Error> {
        self.models = Models::new(submitter, meshes)?;
        Ok(())
    }

    pub(in super::super) fn bind(&self, index: SetIndex, shared: &Shared<'_>) -> Result<(), Error> {
        let (Some(models), Some(_)) = (&self.models, shared.crowd) else { return Ok(()) };
        self.program.bind(index, |name| match name {
            "outsiders" => Some(Resource::Buffer(models.vertices.raw)),
            name => shared.find(name),
        })
    }

    pub(in super::super) fn record(&self, frame: &Frame<'_>, commands: &Commands<'_>) {
        self.draw(frame, commands, self.solid, frame.eye_pass);
    }

    pub(in super::super) fn record_shadow(&self, frame: &Frame<'_>, commands: &Commands<'_>, map: &SunMap) {
        self.draw(frame, commands, self.shadow, map.pass);
    }

    fn draw(&self, frame: &Frame<'_>, commands: &Commands<'_>, pipeline: vk::Pipeline, pass: usize) {
        let (Some(crowd), Some(models)) = (frame.crowd, &self.models) else { return };
        commands.labelled(c"gaitway.outsiders", || {
            commands.use_program(&self.program, pipeline, pass);
            let (raw, buffer) = (commands.raw(), commands.buffer);
            // SAFETY: rendering has begun; every index was checked against the vertices, and no agent is drawn that the
            // crowd's buffers do not have.
            unsafe {
                raw.cmd_bind_index_buffer(buffer, models.indices.raw, 0, vk::IndexType::UINT32);
                for draw in models.draws.iter().filter(|draw| draw.agent < crowd.buffers.most_agents()) {
                    commands.push(&self.program, &draw.agent.to_ne_bytes());
                    raw.cmd_draw_indexed(buffer, draw.index_count, 1, draw.first_index, 0, 0);
                }
            }
        });
    }
}
