// Arithmetic of floats, with every special value against every other.
@group(0) @binding(0) var<storage, read> given: array<vec2<f32>>;
@group(0) @binding(1) var<storage, read_write> made: array<array<f32, 16>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&given) {
        return;
    }
    let a = given[id.x].x;
    let b = given[id.x].y;
    made[id.x][0] = a + b;
    made[id.x][1] = a - b;
    made[id.x][2] = a * b;
    made[id.x][3] = a / b;
    made[id.x][4] = sqrt(a);
    made[id.x][5] = min(a, b);
    made[id.x][6] = max(a, b);
    made[id.x][7] = clamp(a, -1.5, b);
    made[id.x][8] = floor(a) + ceil(b);
    made[id.x][9] = trunc(a) * 2.0 + round(b);
    made[id.x][10] = abs(a) - -b;
    made[id.x][11] = f32(u32(a));
    made[id.x][12] = f32(i32(b));
    made[id.x][13] = bitcast<f32>(u32(a < b) | u32(a <= b) << 1u | u32(a == b) << 2u | u32(a != b) << 3u | u32(a > b) << 4u | u32(a >= b) << 5u);
    made[id.x][14] = bitcast<f32>(u32(a) ^ bitcast<u32>(i32(b)));
    made[id.x][15] = dot(vec2<f32>(a, b), vec2<f32>(b, 3.0)) + mix(a, b, 0.25) + fract(a);
}
