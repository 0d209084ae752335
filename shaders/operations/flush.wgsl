// For tests: a device that takes subnormal numbers for zero, and returns zero in their place.

fn op_add(a: f32, b: f32) -> f32 {
    return flush(flush(a) + flush(b));
}

fn op_sub(a: f32, b: f32) -> f32 {
    return flush(flush(a) - flush(b));
}

fn op_mul(a: f32, b: f32) -> f32 {
    return flush(flush(a) * flush(b));
}

fn op_div(a: f32, b: f32) -> f32 {
    return flush(flush(a) / flush(b));
}

fn op_sqrt(x: f32) -> f32 {
    return flush(sqrt(flush(x)));
}

fn flush(x: f32) -> f32 {
    let u = bitcast<u32>(x);
    return bitcast<f32>(select(u, u & 0x80000000u, (u & 0x7f800000u) == 0u));
}
