//! A place of the user's own, and its shadow: what of it the eyes or the sun can see.

use super::super::Error;
use super::super::commands::{Commands, Submitter};
use super::super::frame::{Frame, Shared};
use super::super::materials::Materials;
use super::super::parts::{self, Part};
use super::super::pipelines::{Program, Resource, SetIndex, Setup};
use super::shadow::SunMap;
use crate::avatar::{PlaceModel, PlaceVertex};
use crate::gpu::Buffer;
use crate::kernels::draw;
use crate::kernels::layout::PlaceCorner;
use ash::vk;
use glam::Mat4;

/// Draws a place. A renderer has this pass once it has a place.
pub(in super::super) struct PlacePass {
    program: Program,
    solid: Way,
    open: Way,
    place: Place,
}

/// How triangles of a kind are drawn, and how they cast shadows.
struct Way {
    seen: vk::Pipeline,
    shadow: vk::Pipeline,
}

/// A place on the device.
struct Place {
    vertices: Buffer,
    materials: Materials,
    solid: Option<Group>,
    open: Option<Group>,
}

/// Triangles of one kind.
struct Group {
    indices: Buffer,
    parts: Vec<Part>,
}

impl PlacePass {
    pub(in super::super) fn new(
        setup: &Setup<'_>,
        submitter: &Submitter,
        model: &PlaceModel,
    ) -> Result<Self, Error> {
        let mut program = setup.program(&draw::PLACE)?;
        let vertex = "place_vertex";
        let [_, solid] = setup.stages([vertex, "place_fragment"], [vertex, "place_fine_fragment"]);
        let [_, open] = setup.stages([vertex, "place_open_fragment"], [vertex, "place_open_fine_fragment"]);
        let solid = Way {
            seen: program.pipeline(&setup.solid(vertex, solid))?,
            shadow: program.pipeline(&setup.shadow("place_shadow"))?,
        };
        let open = Way {
            seen: program.pipeline(&setup.two_sided(vertex, open))?,
            shadow: program.pipeline(&setup.shadow_with_holes("place_open_shadow", "place_hole"))?,
        };
        Ok(Self { program, solid, open, place: Place::new(submitter, model)? })
    }

    pub(in super::super) fn bind(&self, index: SetIndex, shared: &Shared<'_>) -> Result<(), Error> {
        let place = &self.place;
        self.program.bind(index, |name| match name {
            "place_corners" => Some(Resource::Buffer(place.vertices.raw)),
            name => place.materials.find(name).or_else(|| shared.find(name)),
        })
    }

    pub(in super::super) fn record(&self, frame: &Frame<'_>, commands: &Commands<'_>) {
        self.draw(commands, frame.eye_pass, frame.eyes(), |way| way.seen);
    }

    pub(in super::super) fn record_shadow(&self, commands: &Commands<'_>, map: &SunMap) {
        self.draw(commands, map.pass, std::slice::from_ref(&map.shadow_from_world), |way| way.shadow);
    }

    fn draw(
        &self,
        commands: &Commands<'_>,
        pass: usize,
        clip_from_world: &[Mat4],
        pipeline: impl Fn(&Way) -> vk::Pipeline,
    ) {
        commands.labelled(c"gaitway.place", || {
            for (way, group) in [(&self.solid, &self.place.solid), (&self.open, &self.place.open)] {
                let Some(group) = group else { continue };
                let ranges = parts::seen(&group.parts, clip_from_world);
                if ranges.is_empty() {
                    continue;
                }
                commands.use_program(&self.program, pipeline(way), pass);
                // SAFETY: rendering has begun; every index was checked against the vertices.
                unsafe {
                    let (raw, buffer) = (commands.raw(), commands.buffer);
                    raw.cmd_bind_index_buffer(buffer, group.indices.raw, 0, vk::IndexType::UINT32);
                    for (first, count) in ranges {
                        raw.cmd_draw_indexed(buffer, count, 1, first, 0, 0);
                    }
                }
            }
        });
    }
}

impl Place {
    fn new(submitter: &Submitter, model: &PlaceModel) -> Result<Self, Error> {
        let vertices: Vec<PlaceCorner> = model.vertices.iter().map(corner).collect();
        let group = |indices: &[u32]| -> Result<Option<Group>, Error> {
            if indices.is_empty() {
                return Ok(None);
            }
            let wrong = |index: &&u32| **index as usize >= model.vertices.len();
            if let Some(index) = indices.iter().find(wrong) {
                let count = model.vertices.len();
                return Err(Error::Mesh(format!("index {index}, but there are {count} vertices")));
            }
            let corner = |index: u32| model.vertices[index as usize].position;
            let (indices, parts) = parts::split(corner, indices);
            let indices = submitter.upload("place indices", bytemuck::cast_slice(&indices))?;
            Ok(Some(Group { indices, parts }))
        };
        Ok(Self {
            vertices: submitter.upload("place", bytemuck::cast_slice(&vertices))?,
            materials: Materials::new(submitter, &model.textured)?,
            solid: group(&model.solid)?,
            open: group(&model.open)?,
        })
    }
}

fn corner(vertex: &PlaceVertex) -> PlaceCorner {
    #[allow(clippy::cast_precision_loss, reason = "far fewer materials than 2^24")]
    let matter = vertex.material as f32;
    PlaceCorner {
        place_and_u: vertex.position.extend(vertex.uv.x).to_array(),
        normal_and_v: vertex.normal.extend(vertex.uv.y).to_array(),
        color_and_matter: vertex.color.extend(matter).to_array(),
    }
}
