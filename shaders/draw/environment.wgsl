// uses: view, light
// Ground, buildings, props: vertices in world space with a colour each.
// What lies flat (layer 1 and up) lies at one height: deeper layers are drawn a little farther away than they are, so that
// none flickers through another. It casts no shadow, hence needs no room between itself and what stands on it: shadows
// begin at the feet.

@group(0) @binding(3) var<storage, read> environment: array<array<vec4<f32>, 3>>; // position, layer; normal; linear colour

const LAYER: f32 = 1.0e-3; // how much farther a layer is drawn than the one above it, of its distance

struct EnvironmentVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec3<f32>,
    @location(3) lift: f32,
}

@vertex
fn environment_vertex(@builtin(vertex_index) vertex: u32, @builtin(view_index) eye: u32) -> EnvironmentVertex {
    let place = environment[vertex][0];
    var clip = view.clip_from_world[eye] * vec4<f32>(place.xyz, 1.0);
    clip.z *= 1.0 - LAYER * max(place.w - 1.0, 0.0); // reversed depth: less is farther
    let lift = select(1.0, 0.0, place.w > 0.0);
    return EnvironmentVertex(clip, place.xyz, environment[vertex][1].xyz, environment[vertex][2].rgb, lift);
}

@fragment
fn environment_fragment(in: EnvironmentVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    return finish(shade_lifted(in.world, normalize(in.normal), in.color, in.lift), in.world, eye);
}

@vertex
fn environment_shadow(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    let place = environment[vertex][0];
    if place.w > 0.0 {
        return vec4<f32>(0.0, 0.0, 0.0, 1.0); // no area: not drawn
    }
    return view.shadow_from_world * vec4<f32>(place.xyz, 1.0);
}
