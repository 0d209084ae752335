//! Rust twins of the structs that buffers hold, written from the WGSL when the crate is built: the same fields in the same
//! order, without a gap.

use bytemuck::{Pod, Zeroable};

include!(concat!(env!("OUT_DIR"), "/layout.rs"));
