// uses: view, light, fine, tint, outfit, agent, far
// People far away: a body of some fifty triangles without a pose. It is placed and turned, its limbs swing with the phase, and
// trunk, head and arms are held as kernel `pose_far` says; the palettes are not needed. One indirect draw per avatar.

@group(0) @binding(3) var<storage, read> visible: array<u32>;                       // agent of each slot
@group(0) @binding(4) var<storage, read> bucket_start: array<u32>;                  // [posed bucket + 1][far bucket + 1]
@group(0) @binding(5) var<storage, read> mesh_vertices: array<array<vec4<u32>, 4>>; // bits: position, material; normal, limb;
                                                                      // hinge, swing; linear colour, height of the hips
@group(0) @binding(6) var<storage, read> appearance: array<Appearance>; // [agent]
@group(0) @binding(7) var<storage, read> position: array<vec2<f32>>;    // [agent] ground, m
@group(0) @binding(8) var<storage, read> far_poses: array<FarPose>;     // [agent] see kernel `pose_far`
@group(0) @binding(9) var<storage, read> shown: array<u32>;             // slots of visible agents, see kernel `occlusion_compact`
@group(0) @binding(10) var<storage, read> outfits: array<Outfit>;       // [agent]

// which bucket is drawn, and, in the highest bit, whether hidden people are left out
var<immediate> bucket: u32;

const SIFTED: u32 = 0x80000000u;

struct Placed {
    world: vec3<f32>,
    normal: vec3<f32>,
}

fn far_agent(instance: u32) -> u32 {
    let slot = bucket_start[(bucket & ~SIFTED) + 1u] + instance;
    if (bucket & SIFTED) != 0u {
        return visible[shown[slot]];
    }
    return visible[slot];
}

// Limbs, as avatar::Limb: legs and specks keep out of the posture.
const LIMB_FIXED: u32 = 0u;
const LIMB_HEAD: u32 = 2u;
const LIMB_LEFT_ARM: u32 = 3u;
const LIMB_RIGHT_ARM: u32 = 4u;
const ARM_SWING: f32 = 0.32; // rad to either side: what the swing of arms in the mesh is meant for

const KNEE: f32 = 0.45; // m

// Turned about +x: what is up goes forwards.
fn about_x(p: vec3<f32>, angle: f32) -> vec3<f32> {
    let s = sin(angle);
    let c = cos(angle);
    return vec3<f32>(p.x, p.y * c - p.z * s, p.y * s + p.z * c);
}

// Turned about +z: what hangs goes to the left.
fn about_z(p: vec3<f32>, angle: f32) -> vec3<f32> {
    let s = sin(angle);
    let c = cos(angle);
    return vec3<f32>(p.x * c - p.y * s, p.x * s + p.y * c, p.z);
}

fn place(vertex: u32, agent: u32) -> Placed {
    let own = far_poses[agent];
    let limb = mesh_vertices[vertex][1].w;
    let swing = bitcast<vec4<f32>>(mesh_vertices[vertex][2]);
    let angle = swing.w * own.stride;
    var local = bitcast<vec3<f32>>(mesh_vertices[vertex][0].xyz) - swing.xyz;
    var out = bitcast<vec3<f32>>(mesh_vertices[vertex][1].xyz);
    if limb == LIMB_FIXED {
        local = swing.xyz + about_x(local, angle);
    } else {
        if limb == LIMB_HEAD {
            local = about_x(local, own.nod);
        } else if limb == LIMB_LEFT_ARM || limb == LIMB_RIGHT_ARM {
            local = about_x(local, angle / ARM_SWING * own.arm_swing);
            local = about_z(local, select(-own.spread, own.spread, limb == LIMB_LEFT_ARM));
        }
        let hips = vec3<f32>(0.0, bitcast<f32>(mesh_vertices[vertex][3].w), 0.0);
        local = hips + about_x(local + swing.xyz - hips, own.lean);
        out = about_x(out, own.lean);
    }
    // about +y: 0 faces +z
    let ahead = vec2<f32>(own.heading_sine, own.heading_cosine);
    let body = appearance[agent];
    let broad = body.scale * breadth_of(body);
    let at = position[agent];
    return Placed(
        vec3<f32>(
            at.x + broad * (local.x * ahead.y + local.z * ahead.x),
            own.elevation + body.scale * stature_of(body) * local.y,
            at.y + broad * (local.z * ahead.y - local.x * ahead.x),
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
    let is_low = bitcast<f32>(mesh_vertices[vertex][0].y) < KNEE;
    let bits = mesh_vertices[vertex][0].w;
    let own_color = clothed_far(color, bits, is_low, outfit_of(agent), colors_of(appearance[agent]));
    return FarVertex(clip, placed.world, placed.normal, own_color);
}

@fragment
fn far_fragment(in: FarVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    return finish(shade(in.world, normalize(in.normal), in.color), in.world, eye);
}

// Of so few pixels no material is known.
@fragment
fn far_fine_fragment(in: FarVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let toward = toward_eye(in.world, eye);
    let normal = normalize(in.normal);
    let matter = Matter(in.color, normal, 0.9 - 0.25 * max(-normal.y, 0.0), 0.3, 0.35, 0.0, 1.0);
    return finish_fine(illuminate(in.world, toward.xyz, matter), toward, eye);
}

@vertex
fn far_shadow(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> @builtin(position) vec4<f32> {
    return view.shadow_from_world * vec4<f32>(place(vertex, far_agent(instance)).world, 1.0);
}
