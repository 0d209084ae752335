// uses: exact
// The functions of exact.wgsl, over many arguments.
@group(0) @binding(0) var<storage, read> numerics_in: array<vec4<f32>>;        // [case] a, b, c, d
@group(0) @binding(1) var<storage, read_write> numerics_out: array<vec4<f32>>; // [case][2]

@compute @workgroup_size(64)
fn numerics(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&numerics_in) {
        return;
    }
    let v = numerics_in[id.x];
    let at = id.x * 2u;
    numerics_out[at] = vec4<f32>(exact_sin_cos(v.x), exact_atan2(v.x, v.y), exact_acos(v.w));
    let unit = unit_f32(hash_u32(bitcast<u32>(v.x)));
    numerics_out[at + 1u] = vec4<f32>(exact_exp2(v.w * 8.0), exact_wrap(v.x), unit, exact_asin(v.w));
}
