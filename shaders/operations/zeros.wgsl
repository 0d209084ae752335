// For tests: a device whose minimum, maximum and clamp return the other one of two zeros.

fn op_min(a: f32, b: f32) -> f32 {
    return select(b, a, a <= b);
}

fn op_max(a: f32, b: f32) -> f32 {
    return select(b, a, b <= a);
}

fn op_clamp(x: f32, low: f32, high: f32) -> f32 {
    let raised = select(x, low, x <= low);
    return select(raised, high, high <= raised);
}
