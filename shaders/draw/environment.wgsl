// uses: view, light
// Ground, buildings, props: vertices in world space with a colour each.

@group(0) @binding(3) var<storage, read> environment: array<array<vec4<f32>, 3>>; // position, normal, linear colour

struct EnvironmentVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec3<f32>,
}

@vertex
fn environment_vertex(@builtin(vertex_index) vertex: u32, @builtin(view_index) eye: u32) -> EnvironmentVertex {
    let world = environment[vertex][0].xyz;
    let clip = view.clip_from_world[eye] * vec4<f32>(world, 1.0);
    return EnvironmentVertex(clip, world, environment[vertex][1].xyz, environment[vertex][2].rgb);
}

@fragment
fn environment_fragment(in: EnvironmentVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    return finish(shade(in.world, normalize(in.normal), in.color), in.world, eye);
}

@vertex
fn environment_shadow(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    return view.shadow_from_world * vec4<f32>(environment[vertex][0].xyz, 1.0);
}
