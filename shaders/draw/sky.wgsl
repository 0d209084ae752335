// uses: view, light
// The sky behind everything: one triangle over the whole image, infinitely far.

struct SkyVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) ndc: vec2<f32>,
}

@vertex
fn sky_vertex(@builtin(vertex_index) vertex: u32) -> SkyVertex {
    // (-1, -1), (3, -1), (-1, 3)
    let ndc = vec2<f32>(f32((vertex << 1u) & 2u), f32(vertex & 2u)) * 2.0 - 1.0;
    return SkyVertex(vec4<f32>(ndc, 0.0, 1.0), ndc);
}

@fragment
fn sky_fragment(in: SkyVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let near = view.world_from_clip[eye] * vec4<f32>(in.ndc, 1.0, 1.0);
    let far = view.world_from_clip[eye] * vec4<f32>(in.ndc, 0.0, 1.0); // w is 0 when infinitely far
    let direction = normalize(far.xyz * near.w - near.xyz * far.w);
    var light = sky_color(direction);
    if dot(direction, view.sun_direction.xyz) > SUN_DISC {
        light += view.sun_color.rgb;
    }
    return vec4<f32>(tone(light * view.ground_bounce.w), 1.0);
}
