// uses: view, light, fine, absent, agent
// Robots and vehicles: a model each, placed and turned as the agent of that number. One draw per agent.

@group(0) @binding(3) var<storage, read> outsiders: array<array<vec4<f32>, 3>>; // position, normal, linear colour; model space
@group(0) @binding(4) var<storage, read> position: array<vec2<f32>>;            // [agent] ground, m
@group(0) @binding(5) var<storage, read> heading: array<f32>;                   // [agent] rad
@group(0) @binding(6) var<storage, read> elevation: array<f32>;                 // [agent] m

// which agent is drawn
var<immediate> agent: u32;

// About +y: a heading of 0 faces +z.
fn turned(p: vec3<f32>) -> vec3<f32> {
    let faces = heading[agent];
    let s = sin(faces);
    let c = cos(faces);
    return vec3<f32>(p.x * c + p.z * s, p.y, p.z * c - p.x * s);
}

fn placed(vertex: u32) -> vec3<f32> {
    return turned(outsiders[vertex][0].xyz) + vec3<f32>(position[agent].x, elevation[agent], position[agent].y);
}

struct OutsiderVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec3<f32>,
}

@vertex
fn outsider_vertex(@builtin(vertex_index) vertex: u32, @builtin(view_index) eye: u32) -> OutsiderVertex {
    let world = placed(vertex);
    var clip = view.clip_from_world[eye] * vec4<f32>(world, 1.0);
    if is_absent(position[agent]) {
        clip = vec4<f32>(0.0, 0.0, 0.0, 1.0); // no area: not drawn
    }
    return OutsiderVertex(clip, world, turned(outsiders[vertex][1].xyz), outsiders[vertex][2].rgb);
}

// Models of others need not be closed: both sides are drawn.
@fragment
fn outsider_fragment(
    in: OutsiderVertex,
    @builtin(front_facing) is_front: bool,
    @builtin(view_index) eye: u32,
) -> @location(0) vec4<f32> {
    let normal = normalize(in.normal) * select(-1.0, 1.0, is_front);
    return finish(shade(in.world, normal, in.color), in.world, eye);
}

// Painted and polished.
@fragment
fn outsider_fine_fragment(
    in: OutsiderVertex,
    @builtin(front_facing) is_front: bool,
    @builtin(view_index) eye: u32,
) -> @location(0) vec4<f32> {
    let toward = toward_eye(in.world, eye);
    var matter = matt(in.color, normalize(in.normal) * select(-1.0, 1.0, is_front));
    matter.gloss = 0.05;
    matter.occlusion = 1.0 - 0.5 * max(-matter.normal.y, 0.0);
    return finish_fine(illuminate(in.world, toward.xyz, matter), toward, eye);
}

@vertex
fn outsider_shadow(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    if is_absent(position[agent]) {
        return vec4<f32>(0.0, 0.0, 0.0, 1.0);
    }
    return view.shadow_from_world * vec4<f32>(placed(vertex), 1.0);
}
