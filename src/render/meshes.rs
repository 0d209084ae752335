//! The crowd's meshes on the device, in buckets: one for each avatar and level of detail.

use super::Error;
use super::commands::{Commands, Submitter};
use super::crowd::CrowdBuffers;
use super::direct::KnownDraws;
use super::pack::MeshBuffers;
use super::pipelines::Program;
use crate::gpu::Buffer;
use crate::kernels::draw::far::SIFTED;
use ash::vk;
use std::ops::Range;

/// Bytes of a `VkDrawIndexedIndirectCommand`.
pub(super) const DRAW_ARGS_STRIDE: u32 = 20;

/// The crowd's meshes.
#[derive(Debug)]
pub(super) struct CrowdMeshes {
    indices: Buffer,
    /// What agents wear, and what that does to vertices.
    outfits: Buffer,
    tailoring: Buffer,
    /// Buckets of agents with a pose.
    pub(super) bucket_count: u32,
    pub(super) level_count: u32,
    /// Buckets of lod3 and lod4 bodies, behind the others.
    pub(super) far_count: u32,
    /// Buckets with textures, which a pass of their own draws.
    pub(super) painted: Vec<u32>,
    /// What bodies of each bucket stay within, see [`MeshBuffers::bounds`].
    pub(super) bounds: Vec<[[f32; 4]; 2]>,
}

/// Words as a buffer holds them: it is longer than they are by up to 15 bytes, and shaders see all of it.
fn padded<T: bytemuck::NoUninit>(list: &[T]) -> Vec<u32> {
    let mut words: Vec<u32> = bytemuck::cast_slice(list).to_vec();
    words.resize(words.len().max(1).next_multiple_of(4), 0);
    words
}

/// Bodies without a pose, for agents of few pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FarLod {
    /// 52 triangles.
    Lod3,
    /// 13 triangles.
    Lod4,
}

/// Which instances of a bucket are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DrawList {
    /// Those in the frusta.
    Seen,
    /// Those in the frusta that the occlusion pass has kept.
    Unoccluded,
    /// Those that cast shadows, by the meshes of shadows.
    Shadow,
}

impl CrowdMeshes {
    pub(super) fn new(submitter: &Submitter, meshes: &MeshBuffers) -> Result<Self, Error> {
        Ok(Self {
            indices: submitter.upload("mesh indices", bytemuck::cast_slice(&meshes.indices))?,
            outfits: submitter.upload("outfits", bytemuck::cast_slice(&padded(&meshes.outfits)))?,
            tailoring: submitter.upload("tailoring", bytemuck::cast_slice(&padded(&meshes.tailoring)))?,
            bucket_count: meshes.bucket_count(),
            level_count: meshes.level_count.max(1),
            far_count: meshes.far_count(),
            painted: meshes.painted.clone(),
            bounds: meshes.bounds.clone(),
        })
    }

    /// A buffer of the meshes that draw shaders bind.
    pub(super) fn buffer(&self, name: &str) -> Option<&Buffer> {
        match name {
            "outfits" => Some(&self.outfits),
            "tailoring" => Some(&self.tailoring),
            _ => None,
        }
    }

    /// Buckets of one level of bodies without a pose.
    pub(super) fn far_buckets(&self, lod: FarLod) -> Range<u32> {
        let (first, avatars) = (self.bucket_count, self.far_count / 2);
        match lod {
            FarLod::Lod3 => first..first + avatars,
            FarLod::Lod4 => first + avatars..first + 2 * avatars,
        }
    }

    /// Buckets of all bodies without a pose.
    pub(super) fn all_far_buckets(&self) -> Range<u32> {
        self.far_buckets(FarLod::Lod3).start..self.far_buckets(FarLod::Lod4).end
    }

    /// Binds the indices of all meshes.
    pub(super) fn bind_indices(&self, commands: &Commands<'_>) {
        // SAFETY: recording has begun, and the buffer holds 32-bit indices.
        unsafe {
            commands.raw().cmd_bind_index_buffer(commands.buffer, self.indices.raw, 0, vk::IndexType::UINT32);
        }
    }
}

/// A crowd that can be drawn: its buffers are long enough for its meshes.
#[derive(Clone, Copy)]
pub(super) struct DrawnCrowd<'a> {
    pub(super) buffers: &'a CrowdBuffers<'a>,
    pub(super) meshes: &'a CrowdMeshes,
    /// The arguments of its draws, where the host knows them.
    pub(super) known: Option<&'a KnownDraws>,
}

impl<'a> DrawnCrowd<'a> {
    /// # Errors
    /// When a buffer is too short for the meshes.
    pub(super) fn new(buffers: &'a CrowdBuffers<'a>, meshes: &'a CrowdMeshes) -> Result<Self, Error> {
        buffers.check(meshes.bucket_count + meshes.far_count)?;
        Ok(Self { buffers, meshes, known: None })
    }

    /// Draws as many instances of a bucket as the kernels say.
    ///
    /// # Safety
    /// Rendering has begun, a pipeline of the program and the indices are bound, and the meshes have that bucket.
    pub(super) unsafe fn draw_bucket(
        &self,
        commands: &Commands<'_>,
        program: &Program,
        bucket: u32,
        list: DrawList,
    ) {
        let Self { buffers, meshes, known } = self;
        let (arguments, place, number) = match list {
            DrawList::Seen => (buffers.draw_args, bucket, bucket),
            DrawList::Unoccluded => (buffers.shown_args(), bucket, bucket | SIFTED),
            DrawList::Shadow => (buffers.draw_args, meshes.bucket_count + meshes.far_count + bucket, bucket),
        };
        let offset = u64::from(place) * u64::from(DRAW_ARGS_STRIDE);
        commands.push(program, &number.to_ne_bytes());
        if let Some(known) = known.filter(|_| list != DrawList::Unoccluded) {
            // SAFETY: the caller's promise.
            return unsafe { known.draw(commands, place) };
        }
        // SAFETY: the caller's promise; `DrawnCrowd::new` has compared the buffers with the number of buckets, and the
        // kernel copied what the arguments ask for from the table of the meshes.
        unsafe {
            let raw = commands.raw();
            raw.cmd_draw_indexed_indirect(commands.buffer, arguments.raw, offset, 1, DRAW_ARGS_STRIDE);
        }
    }
}
