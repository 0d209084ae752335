//! What can go wrong with drawing.

/// Drawing failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Vulkan failed.
    #[error(transparent)]
    Gpu(#[from] crate::gpu::Error),
    /// Images of this size cannot be drawn.
    #[error("a picture of {width}x{height} pixels; this device draws 1 to {limit} pixels a side")]
    Size {
        /// Pixels a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The device's largest image.
        limit: u32,
    },
    /// A mesh cannot be drawn.
    #[error("environment mesh: {0}")]
    Mesh(String),
    /// A place has more textures than the device takes.
    #[error("the place has {count} textures; this device draws at most {most} of a kind")]
    Textures {
        /// How many there are.
        count: usize,
        /// How many may be.
        most: u32,
    },
    /// A crowd buffer is shorter than its meshes ask for.
    #[error("crowd buffer {name:?} has {bytes} bytes, but {wanted} are needed for {buckets} buckets")]
    Short {
        /// Buffer.
        name: &'static str,
        /// Its size.
        bytes: u64,
        /// What it should have.
        wanted: u64,
        /// Avatars times levels of detail.
        buckets: u32,
    },
    /// A shader asks for something that is not there; a fault of this program.
    #[error("shader {shader:?} needs {binding:?}, which is not there")]
    NoBuffer {
        /// Draw shader.
        shader: &'static str,
        /// Binding or entry point.
        binding: &'static str,
    },
}
