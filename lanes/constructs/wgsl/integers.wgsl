// Arithmetic of integers.
@group(0) @binding(0) var<storage, read> given: array<vec2<u32>>;
@group(0) @binding(1) var<storage, read_write> made: array<array<u32, 24>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let a = given[id.x].x;
    let b = given[id.x].y;
    let s = bitcast<i32>(a);
    let t = bitcast<i32>(b);
    var row: array<u32, 24>;
    row[0] = a + b;
    row[1] = a - b;
    row[2] = a * b;
    row[3] = a / max(b, 1u);
    row[4] = a % max(b, 1u);
    row[5] = bitcast<u32>(s / max(t, 1));
    row[6] = bitcast<u32>(s % max(t, 1));
    row[7] = (a & b) | (a ^ b);
    row[8] = ~a;
    row[9] = a << (b % 32u);
    row[10] = a >> (b % 32u);
    row[11] = bitcast<u32>(s >> (b % 32u));
    row[12] = min(a, b);
    row[13] = max(a, b);
    row[14] = bitcast<u32>(min(s, t));
    row[15] = bitcast<u32>(clamp(s, -100, max(t, -100)));
    row[16] = countOneBits(a) + countLeadingZeros(b) * 64u + countTrailingZeros(a) * 4096u;
    row[17] = bitcast<u32>(-s) + bitcast<u32>(abs(t));
    row[18] = u32(a < b) | u32(a <= b) << 1u | u32(a == b) << 2u | u32(a > b) << 3u | u32(a >= b) << 4u;
    row[19] = u32(s < t) | u32(s <= t) << 1u | u32(s != t) << 2u | u32(s > t) << 3u | u32(s >= t) << 4u;
    row[20] = bitcast<u32>(f32(a));
    row[21] = bitcast<u32>(f32(s));
    row[22] = select(a, b, all(vec2<bool>(a > 7u, b > 7u))) + select(1u, 2u, any(vec2<bool>(a > 9u, b > 9u)));
    row[23] = u32(bool(a) != bool(b & 1u)) + u32((a > 3u) == (b > 3u)) * 2u + u32(!(a > b)) * 4u;
    made[id.x] = row;
}
