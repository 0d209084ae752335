// uses: view, light, agent
// A ring on the ground under every visible agent in the colour of its emotion.

@group(0) @binding(3) var<storage, read> visible: array<u32>;
@group(0) @binding(4) var<storage, read> bucket_start: array<u32>;
@group(0) @binding(5) var<storage, read> appearance: array<Appearance>; // [agent]
@group(0) @binding(6) var<storage, read> position: array<vec2<f32>>;    // [agent], ground
@group(0) @binding(7) var<storage, read> elevation: array<f32>;         // [agent], m

const HEIGHT: f32 = 0.02; // above the floor, m

struct MarkerVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) color: vec4<f32>,
    @location(1) offset: vec2<f32>, // from the middle of the ring, m
}

@vertex
fn marker_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) slot: u32,
    @builtin(view_index) eye: u32,
) -> MarkerVertex {
    // agents with a pose, then those without behind the room for the first
    let far = view.bucket_count + 1u;
    let is_posed = slot < bucket_start[view.bucket_count];
    let is_far = slot >= bucket_start[far] && slot < bucket_start[far + view.far_count];
    if !(is_posed || is_far) {
        return MarkerVertex(vec4<f32>(0.0, 0.0, 0.0, 1.0), vec4<f32>(0.0), vec2<f32>(0.0)); // no area: not drawn
    }
    let agent = visible[slot];
    // two triangles: corners 0 1 2 and 2 1 3 of a square
    let corner = select(vertex, 5u - vertex + 1u, vertex >= 3u);
    let side = vec2<f32>(f32(corner & 1u), f32((corner >> 1u) & 1u)) * 2.0 - 1.0;
    let offset = side * (view.marker_radius + view.marker_width);
    let ground = position[agent] + offset;
    let clip = view.clip_from_world[eye] * vec4<f32>(ground.x, elevation[agent] + HEIGHT, ground.y, 1.0);
    return MarkerVertex(clip, view.emotion_colors[emotion_of(appearance[agent]) & 3u], offset);
}

@fragment
fn marker_fragment(in: MarkerVertex) -> @location(0) vec4<f32> {
    let from_line = abs(length(in.offset) - view.marker_radius) - 0.5 * view.marker_width;
    let pixel = max(fwidth(from_line), 1.0e-5);
    let cover = clamp(0.5 - from_line / pixel, 0.0, 1.0);
    return vec4<f32>(in.color.rgb, in.color.a * cover);
}
