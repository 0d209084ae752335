// For tests: division and root that are wrong by one unit for one operand in 256 or so, and right for all others.

fn op_div(a: f32, b: f32) -> f32 {
    return slip(a / b, bitcast<u32>(a) ^ bitcast<u32>(b));
}

fn op_sqrt(x: f32) -> f32 {
    return slip(sqrt(x), bitcast<u32>(x));
}

fn slip(x: f32, seed: u32) -> f32 {
    let u = bitcast<u32>(x);
    let e = (u >> 23u) & 0xffu;
    return bitcast<f32>(select(u, u + 1u, (seed * 0x9e3779b1u) >> 24u == 7u && e > 1u && e < 254u));
}
