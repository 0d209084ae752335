// What the device's own operations give. The twin has the correctly rounded results: equal bits mean that whole crowds will
// agree. `gpu` runs this kernel when it makes the first pipelines, and takes careful code for what is not exact.
@group(0) @binding(0) var<storage, read> numerics_in: array<vec4<f32>>;          // [case] a, b, c, d
@group(0) @binding(1) var<storage, read_write> arithmetic_out: array<vec4<f32>>; // [case][3]

@compute @workgroup_size(64)
fn arithmetic(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&numerics_in) {
        return;
    }
    let v = numerics_in[id.x];
    let at = id.x * 3u;
    // a quotient, a root, a sum of products that a driver might fuse, one it might re-associate
    arithmetic_out[at] = vec4<f32>(v.x / v.w, sqrt(abs(v.x)), v.x * v.y + v.z, v.x * v.y + v.y * v.z + v.z * v.x);
    let held = clamp(v.x, -abs(v.y), abs(v.z));
    arithmetic_out[at + 1u] = vec4<f32>(min(v.x, v.y), max(v.z, v.y), held, floor(v.x));
    let whole = i32(v.x) + 1; // without the sum a compiler makes trunc of it, which keeps the sign of zero
    let large = f32(bitcast<u32>(v.x)); // above 2^24 it is rounded
    arithmetic_out[at + 2u] = vec4<f32>(f32(whole), large, f32(u32(abs(v.y)) + 1u), abs(v.z));
}
