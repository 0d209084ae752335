// uses: view, light, tint
// People far away: a body of some fifty triangles without a pose. It is placed and turned, and its limbs swing with the
// phase; the palettes are not needed. One indirect draw per avatar.

@group(0) @binding(3) var<storage, read> visible: array<u32>;         // agent of each slot
@group(0) @binding(4) var<storage, read> bucket_start: array<u32>;    // [posed bucket + 1][far bucket + 1]
@group(0) @binding(5) var<storage, read> mesh_vertices: array<array<vec4<u32>, 4>>; // bits: position, material; normal, -;
                                                                      // hinge, swing; linear colour, -
@group(0) @binding(6) var<storage, read> look: array<vec4<u32>>;      // [agent]
@group(0) @binding(7) var<storage, read> position: array<vec2<f32>>;  // [agent] ground, m
@group(0) @binding(8) var<storage, read> stance: array<vec2<f32>>;    // [agent] heading rad, walk weight
@group(0) @binding(9) var<storage, read> phase: array<u32>;           // [agent] the whole range is one stride
@group(0) @binding(10) var<storage, read> elevation: array<f32>;      // [agent] m

// which bucket is drawn
var<immediate> bucket: u32;

struct Placed {
    world: vec3<f32>,
    normal: vec3<f32>,
}

fn far_agent(instance: u32) -> u32 {
    return visible[bucket_start[bucket + 1u] + instance];
}

fn place(vertex: u32, agent: u32) -> Placed {
    let body = stance[agent];
    let swing = bitcast<vec4<f32>>(mesh_vertices[vertex][2]);
    let stride = f32(phase[agent] >> 8u) * (6.2831853 / 16777216.0);
    let angle = swing.w * clamp(body.y, 0.0, 1.0) * cos(stride);
    let s = sin(angle);
    let c = cos(angle);
    let arm = bitcast<vec3<f32>>(mesh_vertices[vertex][0].xyz) - swing.xyz;
    let local = swing.xyz + vec3<f32>(arm.x, arm.y * c - arm.z * s, arm.y * s + arm.z * c);
    let out = bitcast<vec3<f32>>(mesh_vertices[vertex][1].xyz);
    // about +y: 0 faces +z
    let ahead = vec2<f32>(sin(body.x), cos(body.x));
    let scale = bitcast<f32>(look[agent].y);
    let at = position[agent];
    return Placed(
        vec3<f32>(
            at.x + scale * (local.x * ahead.y + local.z * ahead.x),
            elevation[agent] + scale * local.y,
            at.y + scale * (local.z * ahead.y - local.x * ahead.x),
        ),
        vec3<f32>(out.x * ahead.y + out.z * ahead.x, out.y, out.z * ahead.y - out.x * ahead.x),
    );
}

struct FarVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec3<f32>,
}

@vertex
fn far_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
    @builtin(view_index) eye: u32,
) -> FarVertex {
    let agent = far_agent(instance);
    let placed = place(vertex, agent);
    let clip = view.clip_from_world[eye] * vec4<f32>(placed.world, 1.0);
    let color = bitcast<vec3<f32>>(mesh_vertices[vertex][3].xyz);
    return FarVertex(clip, placed.world, placed.normal, tinted(color, mesh_vertices[vertex][0].w, look[agent].zw));
}

@fragment
fn far_fragment(in: FarVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    return finish(shade(in.world, normalize(in.normal), in.color), in.world, eye);
}

@vertex
fn far_shadow(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> @builtin(position) vec4<f32> {
    return view.shadow_from_world * vec4<f32>(place(vertex, far_agent(instance)).world, 1.0);
}
