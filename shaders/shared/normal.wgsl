// Normals in one word: a point of the octahedron |x| + |y| + |z| = 1, laid flat. Its corners below, where y < 0, are folded outwards.
// x and z in 16 bits each, of which 32767 make 1, and 32768 stand for 0. A normal is at most 0.004 degrees off.
const NORMAL_UNITS: f32 = 32767.0;
const NORMAL_ZERO: f32 = 32768.0;
// What is shorter is no direction: it becomes that upwards.
const LEAST_NORMAL: f32 = 1e-6;

// A direction of any length.
fn packed_normal(n: vec3<f32>) -> u32 {
    let sum = abs(n.x) + abs(n.y) + abs(n.z);
    let share = select(0.0, 1.0 / sum, sum > LEAST_NORMAL);
    let x = n.x * share;
    let z = n.z * share;
    let is_below = n.y < 0.0;
    let along_x = select(x, (1.0 - abs(z)) * select(-1.0, 1.0, x >= 0.0), is_below);
    let along_z = select(z, (1.0 - abs(x)) * select(-1.0, 1.0, z >= 0.0), is_below);
    return normal_units(along_x) | (normal_units(along_z) << 16u);
}

// The nearest number: what lies behind the point is cut off.
fn normal_units(share: f32) -> u32 {
    return u32(share * NORMAL_UNITS + (NORMAL_ZERO + 0.5));
}

// The direction, of any length.
fn unpacked_normal(word: u32) -> vec3<f32> {
    let flat = (vec2<f32>(f32(word & 0xffffu), f32(word >> 16u)) - NORMAL_ZERO) * (1.0 / NORMAL_UNITS);
    let y = 1.0 - abs(flat.x) - abs(flat.y);
    let folded = vec2<f32>(max(-y, 0.0));
    return vec3<f32>(flat.x, y, flat.y) - vec3<f32>(select(-folded, folded, flat >= vec2<f32>(0.0)), 0.0).xzy;
}
