// uses: view, light, body
// The ground under people who are near: feet and body keep the light of the sky from it. It is laid over the image, as a
// marker is. A foot shades the ground as much as it is near it, so that one that is lifted does not.

@group(0) @binding(3) var<storage, read> visible: array<u32>;
@group(0) @binding(4) var<storage, read> bucket_start: array<u32>;
@group(0) @binding(5) var<storage, read> palettes: array<array<vec4<f32>, 3>>; // [slot][joint], rows of world_from_mesh
@group(0) @binding(6) var<storage, read> position: array<vec2<f32>>;           // [agent], ground
@group(0) @binding(7) var<storage, read> elevation: array<f32>;                // [agent], m

const ABOVE: f32 = 0.012;      // the floor, m
const SIDE: f32 = 0.8;         // half the side of the square that is drawn, m
const SOLE_ASIDE: f32 = 0.09;  // middle of a sole in the mesh at rest, m
const SOLE_AHEAD: f32 = 0.06;
const SOLE_LENGTH: f32 = 0.17; // half axes of the shade of a sole, m
const SOLE_WIDTH: f32 = 0.085;
const SOLE_SHADE: f32 = 0.8;
const LIFTED: f32 = 0.14;      // a foot this high shades the ground no more, m
const BODY_RADIUS: f32 = 0.42; // m
const BODY_SHADE: f32 = 0.45;
const FADE_FROM: f32 = 25.0;   // m from the eye
const FADE_TO: f32 = 40.0;

struct ContactVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) offset: vec2<f32>,                    // from the agent's place, m
    @location(1) @interpolate(flat) left: vec4<f32>,   // middle of the sole from there, m; where it points to
    @location(2) @interpolate(flat) right: vec4<f32>,
    @location(3) @interpolate(flat) shades: vec3<f32>, // of the left and the right sole, of the body
}

// A sole's middle in x and z, its height in y.
fn sole(slot: u32, joint: u32, aside: f32) -> vec3<f32> {
    let rows = palettes[slot * SKIN_JOINTS + joint];
    let place = vec4<f32>(aside, 0.0, SOLE_AHEAD, 1.0);
    return vec3<f32>(dot(rows[0], place), dot(rows[1], place), dot(rows[2], place));
}

fn pointing(slot: u32, joint: u32) -> vec2<f32> {
    let rows = palettes[slot * SKIN_JOINTS + joint];
    let ahead = vec2<f32>(rows[0].z, rows[2].z);
    return ahead / max(length(ahead), 1.0e-4);
}

@vertex
fn contact_shadow_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) slot: u32,
    @builtin(view_index) eye: u32,
) -> ContactVertex {
    if slot >= bucket_start[view.bucket_count] {
        return ContactVertex(vec4<f32>(0.0, 0.0, 0.0, 1.0), vec2<f32>(0.0), vec4<f32>(0.0), vec4<f32>(0.0), vec3<f32>(0.0));
    }
    let agent = visible[slot];
    let place = position[agent];
    let floor_height = elevation[agent];
    // both eyes fade alike
    let middle = 0.5 * (view.fade[0].xyz + view.fade[1].xyz);
    let away = distance(middle, vec3<f32>(place.x, floor_height, place.y));
    let near = 1.0 - clamp((away - FADE_FROM) / (FADE_TO - FADE_FROM), 0.0, 1.0);
    if near <= 0.0 {
        return ContactVertex(vec4<f32>(0.0, 0.0, 0.0, 1.0), vec2<f32>(0.0), vec4<f32>(0.0), vec4<f32>(0.0), vec3<f32>(0.0));
    }
    let left = sole(slot, LEFT_FOOT, SOLE_ASIDE);
    let right = sole(slot, RIGHT_FOOT, -SOLE_ASIDE);
    let lifts = max(vec2<f32>(left.y, right.y) - floor_height, vec2<f32>(0.0));
    let touch = SOLE_SHADE * (1.0 - clamp(lifts / LIFTED, vec2<f32>(0.0), vec2<f32>(1.0)));
    // two triangles: corners 0 1 2 and 2 1 3 of a square
    let corner = select(vertex, 6u - vertex, vertex >= 3u);
    let side = vec2<f32>(f32(corner & 1u), f32((corner >> 1u) & 1u)) * 2.0 - 1.0;
    let offset = side * SIDE;
    let ground = place + offset;
    let clip = view.clip_from_world[eye] * vec4<f32>(ground.x, floor_height + ABOVE, ground.y, 1.0);
    return ContactVertex(
        clip,
        offset,
        vec4<f32>(left.xz - place, pointing(slot, LEFT_FOOT)),
        vec4<f32>(right.xz - place, pointing(slot, RIGHT_FOOT)),
        vec3<f32>(touch, BODY_SHADE) * near,
    );
}

fn sole_shade(offset: vec2<f32>, foot: vec4<f32>) -> f32 {
    let away = offset - foot.xy;
    let along = dot(away, foot.zw) / SOLE_LENGTH;
    let across = (away.x * foot.w - away.y * foot.z) / SOLE_WIDTH;
    return exp(-1.1 * (along * along + across * across));
}

@fragment
fn contact_shadow_fragment(in: ContactVertex) -> @location(0) vec4<f32> {
    let left = in.shades.x * sole_shade(in.offset, in.left);
    let right = in.shades.y * sole_shade(in.offset, in.right);
    let radius = length(in.offset);
    let edge = clamp(4.0 * (1.0 - radius / SIDE), 0.0, 1.0);
    let whole = radius / BODY_RADIUS;
    let body = in.shades.z * exp(-whole * whole);
    let dark = 1.0 - (1.0 - left) * (1.0 - right) * (1.0 - body);
    return vec4<f32>(0.0, 0.0, 0.0, dark * edge);
}
