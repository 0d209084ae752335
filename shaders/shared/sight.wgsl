// uses: block
// What `occlude` and `occlusion_compact` know about a render pass and the agents it sifts; the Rust twin is
// kernels::layout::SightUniforms. World frame, y up, metres.
struct SightUniforms {
    clip_from_world: array<mat4x4<f32>, 2>, // per eye; depth 1 near, 0 far
    bounds: array<array<vec4<f32>, 2>, 32>, // [bucket] two boxes around a body of scale 1, trunk and head: x: half a side; y, z: bottom and top above its foot
    width: f32,                             // pixels of an eye's image
    height: f32,
    eye_count: u32,                         // eyes of the pass: an agent is hidden if no eye sees it
    tile_width: u32,                        // pixels
    tile_height: u32,
    tile_columns: u32,
    tile_rows: u32,
    first_bucket: u32,                      // buckets that are sifted, and where the last one ends
    bucket_end: u32,
    start_shift: u32,                       // added to a bucket's number gives its place in bucket_start
    fewest: u32,                            // of fewer than this all are drawn: looking for them costs more
    eye_height: f32,                        // of the higher eye, y
}

// First slot of a bucket, or end of the one before.
fn start_of(bucket: u32) -> u32 {
    return bucket_start[bucket + sight.start_shift];
}

// The bucket of a slot, not before `from`.
fn bucket_of(slot: u32, from_bucket: u32) -> u32 {
    var bucket = from_bucket;
    while bucket + 1u < sight.bucket_end && slot >= start_of(bucket + 1u) {
        bucket++;
    }
    return bucket;
}
