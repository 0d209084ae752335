// Arrays that no invocation finds cleared: one that is filled first, and one that shows what was there.
@group(0) @binding(0) var<storage, read> given: array<u32>;
@group(0) @binding(1) var<storage, read_write> made: array<vec2<u32>>;

var<private> filled: array<u32, 4>;
var<private> left: array<u32, 2>;
var<private> counted: u32;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let count = given[id.x] % 5u;
    for (var i = 0u; i < count; i++) {
        filled[i] = given[id.x] * (i + 1u);
        counted++;
    }
    var sum = counted;
    for (var i = 0u; i < count; i++) {
        sum = sum * 7u + filled[i];
    }
    made[id.x] = vec2<u32>(sum, left[1]);
    left[1] = 1u;
}
