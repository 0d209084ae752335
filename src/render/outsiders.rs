//! Robots and vehicles: models that follow agents.

use super::CrowdBuffers;
use super::Error;
use super::renderer::Renderer;
use super::scene::{self, Surface};
use crate::gpu::Buffer;
use crate::sim::bodies::OutsiderMesh;
use ash::vk;

/// Their meshes on the device, and what is drawn where.
#[derive(Debug)]
pub(crate) struct Outsiders {
    pub(super) vertices: Buffer,
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

impl Renderer {
    /// Takes the meshes of robots and vehicles; none if there are none.
    pub(super) fn upload_outsiders(&self, outsiders: &[OutsiderMesh]) -> Result<Option<Outsiders>, Error> {
        let surfaces: Vec<Surface<'_>> = outsiders
            .iter()
            .map(|OutsiderMesh { mesh, .. }| Surface {
                positions: &mesh.positions,
                normals: &mesh.normals,
                colors: &mesh.colors,
                layers: &[],
                indices: &mesh.indices,
            })
            .collect();
        let (vertices, indices) = scene::pack(&surfaces)?;
        let mut draws = Vec::new();
        let mut first_index = 0;
        for outsider in outsiders {
            let index_count = u32::try_from(outsider.mesh.indices.len())
                .map_err(|error| Error::Mesh(format!("{} indices: {error}", outsider.mesh.indices.len())))?;
            draws.extend(outsider.agents.iter().map(|&agent| Draw { agent, first_index, index_count }));
            first_index += index_count;
        }
        if draws.is_empty() {
            return Ok(None);
        }
        let vertices = self.upload("outsiders", bytemuck::cast_slice(&vertices))?;
        let indices = self.upload("outsider indices", bytemuck::cast_slice(&indices))?;
        Ok(Some(Outsiders { vertices, indices, draws }))
    }

    /// Draws them, or their shadows.
    pub(super) fn draw_outsiders(
        &self,
        commands: vk::CommandBuffer,
        pipeline: vk::Pipeline,
        crowd: Option<&CrowdBuffers<'_>>,
        pass: usize,
    ) {
        let (Some(crowd), Some(outsiders)) = (crowd, &self.outsiders) else { return };
        self.label(commands, Some(c"gaitway.outsiders"));
        let program = &self.programs.outsider;
        self.use_program(commands, program, pipeline, pass);
        let raw = &self.device.raw;
        // SAFETY: rendering has begun; every index was checked against the vertices, and no agent is drawn that the crowd's
        // buffers do not have.
        unsafe {
            raw.cmd_bind_index_buffer(commands, outsiders.indices.raw, 0, vk::IndexType::UINT32);
            for draw in outsiders.draws.iter().filter(|draw| draw.agent < crowd.most_agents()) {
                let agent = draw.agent.to_ne_bytes();
                raw.cmd_push_constants(commands, program.layout, vk::ShaderStageFlags::VERTEX, 0, &agent);
                raw.cmd_draw_indexed(commands, draw.index_count, 1, draw.first_index, 0, 0);
            }
        }
        self.label(commands, None);
    }
}
