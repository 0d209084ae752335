//! Twin of `shaders/shared/sight.wgsl`: the slots that the occlusion test sifts for hidden agents.

use crate::kernels::layout::SightUniforms;

/// First slot of a bucket, or end of the one before.
pub fn start_of(sight: &SightUniforms, bucket_start: &[u32], bucket: u32) -> u32 {
    bucket_start[(bucket + sight.start_shift) as usize]
}

/// The bucket of a slot, not before `from`.
pub fn bucket_of(sight: &SightUniforms, bucket_start: &[u32], slot: u32, from: u32) -> u32 {
    let mut bucket = from;
    while bucket + 1 < sight.bucket_end && slot >= start_of(sight, bucket_start, bucket + 1) {
        bucket += 1;
    }
    bucket
}
