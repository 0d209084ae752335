//! The environment, and its shadow: what of it the eyes or the sun can see.

use super::super::Error;
use super::super::commands::{Commands, Submitter};
use super::super::frame::{Frame, Shared};
use super::super::ground_map;
use super::super::pipelines::{Program, Resource, SetIndex, Setup};
use super::super::scenery::{Scenery, Sight};
use super::super::settings::Quality;
use super::super::surface::{self, Surface};
use super::shadow::SunMap;
use crate::gpu::Buffer;
use crate::kernels::draw;
use crate::scenario::Distant;
use ash::vk;
use glam::Vec4;

/// Draws triangles that do not move.
pub(in super::super) struct EnvironmentPass {
    program: Program,
    solid: vk::Pipeline,
    shadow: vk::Pipeline,
    quality: Quality,
    mesh: Option<Mesh>,
}

struct Mesh {
    vertices: Buffer,
    indices: Buffer,
    scenery: Scenery,
    /// How dark the ground is at the feet of walls; not at low quality, whose shaders do not read it.
    ground_map: Option<Buffer>,
}

impl EnvironmentPass {
    pub(in super::super) fn new(setup: &Setup<'_>) -> Result<Self, Error> {
        let mut program = setup.program(&draw::ENVIRONMENT)?;
        let low = ["environment_vertex", "environment_fragment"];
        let [vertex, fragment] = setup.stages(low, ["environment_fine_vertex", "environment_fine_fragment"]);
        let solid = program.pipeline(&setup.solid(vertex, fragment))?;
        let shadow = program.pipeline(&setup.shadow("environment_shadow"))?;
        Ok(Self { program, solid, shadow, quality: setup.quality, mesh: None })
    }

    /// Replaces the environment; no triangles, no environment. `far_indices` are of vertices of the first surface, and `distant`
    /// says for which of its triangles they stand.
    pub(in super::super) fn set(
        &mut self,
        submitter: &Submitter,
        surfaces: &[Surface<'_>],
        lamps: f32,
        (far_indices, distant): (&[u32], &[Distant]),
    ) -> Result<(), Error> {
        let (vertices, indices) = surface::pack(surfaces, lamps)?;
        self.mesh = None;
        if indices.is_empty() {
            return Ok(());
        }
        let corner = |index: u32| Vec4::from(vertices[index as usize][0]);
        let has_map = self.quality > Quality::Low;
        let ground_map = has_map.then(|| ground_map::bake(&vertices, &indices));
        if let Some(index) = far_indices.iter().find(|index| **index as usize >= vertices.len()) {
            let count = vertices.len();
            return Err(Error::Mesh(format!("index {index} of what is far, but there are {count} vertices")));
        }
        let (indices, scenery) = Scenery::new(corner, &indices, far_indices, distant).ok_or_else(|| {
            Error::Mesh(
                "what is drawn otherwise from afar lies beyond the indices, or is out of order".to_owned(),
            )
        })?;
        let ground_map =
            ground_map.map(|map| submitter.upload("ground map", bytemuck::cast_slice(&map))).transpose()?;
        let vertices = submitter.upload("environment", bytemuck::cast_slice(&vertices))?;
        let indices = submitter.upload("environment indices", bytemuck::cast_slice(&indices))?;
        self.mesh = Some(Mesh { vertices, indices, scenery, ground_map });
        Ok(())
    }

    pub(in super::super) fn bind(&self, index: SetIndex, shared: &Shared<'_>) -> Result<(), Error> {
        let Some(mesh) = &self.mesh else { return Ok(()) };
        self.program.bind(index, |name| match name {
            "environment" => Some(Resource::Buffer(mesh.vertices.raw)),
            "ground_map" => Some(Resource::Buffer(mesh.ground_map.as_ref().unwrap_or(&mesh.vertices).raw)),
            name => shared.find(name),
        })
    }

    pub(in super::super) fn record(&self, frame: &Frame<'_>, commands: &Commands<'_>) {
        self.draw(frame, commands, self.solid, frame.eye_pass, |scenery, sight| {
            scenery.seen(frame.eyes(), sight)
        });
    }

    /// Things cast shadows as they are drawn: they would shade themselves otherwise.
    pub(in super::super) fn record_shadow(&self, frame: &Frame<'_>, commands: &Commands<'_>, map: &SunMap) {
        self.draw(frame, commands, self.shadow, map.pass, |scenery, sight| {
            scenery.casting(&map.shadow_from_world, sight)
        });
    }

    fn draw(
        &self,
        frame: &Frame<'_>,
        commands: &Commands<'_>,
        pipeline: vk::Pipeline,
        pass: usize,
        ranges: impl Fn(&Scenery, &Sight<'_>) -> Vec<(u32, u32)>,
    ) {
        let Some(mesh) = &self.mesh else { return };
        let sight = Sight::of(frame.view, frame.settings.height);
        commands.labelled(c"gaitway.environment", || {
            commands.use_program(&self.program, pipeline, pass);
            // SAFETY: rendering has begun; every index was checked against the vertices.
            unsafe {
                let (raw, buffer) = (commands.raw(), commands.buffer);
                raw.cmd_bind_index_buffer(buffer, mesh.indices.raw, 0, vk::IndexType::UINT32);
                for (first, count) in ranges(&mesh.scenery, &sight) {
                    raw.cmd_draw_indexed(buffer, count, 1, first, 0, 0);
                }
            }
        });
    }
}
