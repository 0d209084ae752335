// For tests: a device that divides and takes roots wrongly by up to UNITS units in the last place, as Vulkan allows.

fn op_div(a: f32, b: f32) -> f32 {
    return wrong(a / b, bitcast<u32>(b));
}

fn op_sqrt(x: f32) -> f32 {
    return wrong(sqrt(x), bitcast<u32>(x));
}

fn op_rsqrt(x: f32) -> f32 {
    return wrong(inverseSqrt(x), bitcast<u32>(x));
}

fn wrong(x: f32, seed: u32) -> f32 {
    let u = bitcast<u32>(x);
    let e = (u >> 23u) & 0xffu;
    let h = (u ^ seed) * 0x9e3779b1u;
    let off = (h >> 28u) % (2u * UNITS + 1u) - UNITS; // modulo 2^32
    return bitcast<f32>(select(u, u + off, e > 1u && e < 254u));
}
