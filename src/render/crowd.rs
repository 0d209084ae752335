//! The crowd's buffers, as the kernels leave them on the device.

use super::Error;
use crate::gpu::{Buffer, Engine};
use crate::kernels::BufferId;

/// What the crowd is drawn from. The layouts are those of `shaders/draw/crowd.wgsl`.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct CrowdBuffers<'a> {
    /// The engine of the occlusion test, if there is one: it has the kernels `occlude` and `occlusion_compact`.
    pub engine: Option<&'a Engine>,
    /// Agent of each slot, sorted by bucket, lod3 and lod4 bodies behind the room for the others: `u32 [slot]`.
    pub visible: &'a Buffer,
    /// First slot of each bucket and the end of the last: `u32 [bucket + 1]`, then the same for lod3 and lod4 bodies.
    pub bucket_start: &'a Buffer,
    /// `VkDrawIndexedIndirectCommand [2][bucket]`, lod3 and lod4 bodies last, of frames and of shadows; instances count from 0.
    pub draw_args: &'a Buffer,
    /// `vec4<f32> [vertex][4]`.
    pub mesh_vertices: &'a Buffer,
    /// `vec4<u32> [bucket]`.
    pub mesh_table: &'a Buffer,
    /// Rows of `world_from_mesh`: `vec4<f32> [slot][joint][3]`.
    pub palettes: &'a Buffer,
    /// Skinned vertices of the near agents: `vec4<f32> [near vertex][2]`.
    pub skinned: &'a Buffer,
    /// `vec4<u32> [agent]`.
    pub appearance: &'a Buffer,
    /// Ground position: `vec2<f32> [agent]`.
    pub position: &'a Buffer,
    /// Height of the floor stood on, m: `f32 [agent]`.
    pub elevation: &'a Buffer,
    /// Heading, rad: `f32 [agent]`.
    pub heading: &'a Buffer,
    /// How lod3 and lod4 bodies hold themselves: `FarPose [agent]`.
    pub far_poses: &'a Buffer,
}

impl<'a> CrowdBuffers<'a> {
    /// The crowd's buffers of an engine that runs the animation kernels.
    ///
    /// # Errors
    /// When the engine lacks one of them.
    pub fn of(engine: &'a Engine) -> Result<Self, Error> {
        let find = |name: &'static str| {
            let id = BufferId::ALL.into_iter().find(|id| id.name() == name);
            id.and_then(|id| engine.buffer(id)).ok_or(Error::NoBuffer { shader: "crowd", binding: name })
        };
        Ok(Self {
            engine: Some(engine),
            visible: find("visible")?,
            bucket_start: find("bucket_start")?,
            draw_args: find("draw_args")?,
            mesh_vertices: find("mesh_vertices")?,
            mesh_table: find("mesh_table")?,
            palettes: find("palettes")?,
            skinned: find("skinned")?,
            appearance: find("appearance")?,
            position: find("position")?,
            elevation: find("elevation")?,
            heading: find("heading")?,
            far_poses: find("far_poses")?,
        })
    }

    /// A buffer that only an engine has.
    fn made(&self, name: &str) -> Option<&'a Buffer> {
        let id = BufferId::ALL.into_iter().find(|id| id.name() == name);
        id.and_then(|id| self.engine.and_then(|engine| engine.buffer(id)))
    }

    /// Arguments of the draws of unoccluded bodies.
    pub(crate) fn shown_args(&self) -> &'a Buffer {
        self.made("shown_args").unwrap_or(self.draw_args)
    }

    /// At least as many as there are agents.
    pub(crate) fn most_agents(&self) -> u32 {
        u32::try_from(self.appearance.size() / 16).unwrap_or(u32::MAX)
    }

    pub(crate) fn buffer(&self, name: &str) -> Option<&'a Buffer> {
        Some(match name {
            "visible" => self.visible,
            // bound but not read without an engine
            "shown" => self.made("shown").unwrap_or(self.visible),
            "bucket_start" => self.bucket_start,
            "mesh_vertices" => self.mesh_vertices,
            "mesh_table" => self.mesh_table,
            "palettes" => self.palettes,
            "skinned" => self.skinned,
            "appearance" => self.appearance,
            "position" => self.position,
            "elevation" => self.elevation,
            "heading" => self.heading,
            "far_poses" => self.far_poses,
            _ => return None,
        })
    }

    /// Checks that the buffers are long enough for that many buckets of all levels.
    pub(crate) fn check(&self, buckets: u32) -> Result<(), Error> {
        let wanted = [
            ("bucket_start", self.bucket_start, 4 * (u64::from(buckets) + 2)),
            ("draw_args", self.draw_args, 2 * 20 * u64::from(buckets)),
            ("mesh_table", self.mesh_table, 16 * u64::from(buckets)),
        ];
        for (name, buffer, wanted) in wanted {
            if buffer.size() < wanted {
                return Err(Error::Short { name, bytes: buffer.size(), wanted, buckets });
            }
        }
        Ok(())
    }
}
