// uses: exact
// Shows what the device's arithmetic does with the operations that kernels use: the CPU twin gives the correctly
// rounded results, so equal bits mean that whole crowds will agree.
@group(0) @binding(0) var<storage, read> numerics_in: array<vec4<f32>>;        // [case] a, b, c, d
@group(0) @binding(1) var<storage, read_write> numerics_out: array<vec4<f32>>; // [case][4]

@compute @workgroup_size(64)
fn numerics(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&numerics_in) {
        return;
    }
    let v = numerics_in[id.x];
    let at = id.x * 4u;
    // a quotient, a root, a sum of products that a driver might fuse, one it might re-associate
    numerics_out[at] = vec4<f32>(v.x / v.y, sqrt(abs(v.x)), v.x * v.y + v.z, v.x * v.y + v.y * v.z + v.z * v.x);
    let whole = i32(v.x) + 1; // without the sum a compiler makes trunc of it, which keeps the sign of zero
    numerics_out[at + 1u] = vec4<f32>(f32(whole), floor(v.x), min(v.x, v.y), max(v.z, v.w));
    numerics_out[at + 2u] = vec4<f32>(exact_sin_cos(v.x), exact_atan2(v.x, v.y), exact_acos(v.w));
    numerics_out[at + 3u] = vec4<f32>(exact_exp2(v.w * 8.0), exact_wrap(v.x), unit_f32(hash_u32(bitcast<u32>(v.x))), abs(v.z));
}
