// Minimum, maximum and clamp as compare and select, which leave nothing open: of two zeros the second comes back, as of a
// number and NaN. Vulkan's own may return either. Twins: `lesser` and `greater` of reference::exact.

fn op_min(a: f32, b: f32) -> f32 {
    return select(b, a, a < b);
}

fn op_max(a: f32, b: f32) -> f32 {
    return select(b, a, b < a);
}

fn op_clamp(x: f32, low: f32, high: f32) -> f32 {
    let raised = select(x, low, x < low);
    return select(raised, high, high < raised);
}
