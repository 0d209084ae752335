// Elements of four words, three of them side by side, read and written.
@group(0) @binding(0) var<storage, read> places: array<u32>;
@group(0) @binding(1) var<storage, read> given: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read_write> made: array<array<vec4<u32>, 3>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let number = id.x;
    let at = places[number];
    let later = places[number + 2u]; // not side by side with that
    let first = given[at];
    let second = given[at + 1u];
    let third = given[at + 2u];
    made[id.x] = array<vec4<u32>, 3>(third, first.wzyx, (first ^ second) + later);
}
