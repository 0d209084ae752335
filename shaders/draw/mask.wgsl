// Covers what the lenses of a headset hide, before anything else is drawn: nearest of all, so that nothing behind it is
// shaded.
@group(0) @binding(0) var<storage, read> mask: array<vec4<f32>>; // corners of triangles in clip space: the left eye's, then as many of the right one's

@vertex
fn mask_vertex(@builtin(vertex_index) vertex: u32, @builtin(view_index) eye: u32) -> @builtin(position) vec4<f32> {
    // an eye drawn by itself counts from its own first vertex
    return mask[vertex + eye * (arrayLength(&mask) / 2u)];
}

@fragment
fn mask_fragment() -> @location(0) vec4<f32> {
    return vec4<f32>(0.0, 0.0, 0.0, 1.0);
}
