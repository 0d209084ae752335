// Lanes that read parts of a buffer of their own, five elements each, at the same place in each, and beyond.
@group(0) @binding(0) var<storage, read> places: array<u32>;       // [y]
@group(0) @binding(1) var<storage, read> own: array<vec4<u32>>;    // [part][5]
@group(0) @binding(2) var<storage, read_write> out: array<vec4<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let at = places[id.y] * 5u + id.x % 5u;
    let first = own[at];
    let second = own[at + 1u];
    out[id.y * 5u + id.x] = first * 3u + second;
}
