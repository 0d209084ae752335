// uses: view, light, fine
// What images show of the user. Hands, their joints, controllers and a teleport's arc are rounded solids. The place it leads
// to is a ring on the floor. A vignette narrows the view while the user is moved. A
// fade covers everything with grey.

// A solid of half lengths 1, as its twin kernels::layout::Solid.
struct Solid {
    x: vec4<f32>,     // rows of world_from_solid, m
    y: vec4<f32>,
    z: vec4<f32>,
    color: vec4<f32>, // linear; w: 0 an ellipsoid, to 1 a box with rounded edges
}

// The Rust twin is kernels::layout::UserUniforms.
struct UserUniforms {
    solids: array<Solid, 64>,
    target_place: vec4<f32>,  // xyz: middle of the ring, m; w: its radius, m
    target_color: vec4<f32>,  // rgb linear; w: 1 with a ring
    vignette: vec4<f32>,      // x: strength; y, z: angles from the middle of the view where it begins and is full, rad; w: fade to grey
}

@group(0) @binding(3) var<uniform> user: UserUniforms;

const SLICES: u32 = 12u;
const STACKS: u32 = 8u;
const PI: f32 = 3.14159265;
const FLOOR: f32 = 0.02; // the ring is so high above the floor, m
const GREY: f32 = 0.16;  // what a fade leads to, linear

struct SolidVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) @interpolate(flat) color: vec3<f32>,
}

@vertex
fn user_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
    @builtin(view_index) eye: u32,
) -> SolidVertex {
    let solid = user.solids[instance];
    // two triangles a face of a globe: corners 0 1 2 and 2 1 3
    let face = vertex / 6u;
    let within = vertex % 6u;
    let corner = select(within, 6u - within, within >= 3u);
    let around = f32(face % SLICES + (corner & 1u)) * (2.0 * PI / f32(SLICES));
    let down = f32(face / SLICES + (corner >> 1u)) * (PI / f32(STACKS));
    let out = vec3<f32>(sin(down) * cos(around), cos(down), sin(down) * sin(around));
    // |x|^p + |y|^p + |z|^p = 1, whose normal is the gradient
    let power = mix(2.0, 6.0, solid.color.w);
    let size = abs(out) + vec3<f32>(1.0e-6);
    let length_p = pow(dot(pow(size, vec3<f32>(power)), vec3<f32>(1.0)), 1.0 / power);
    let local = vec4<f32>(out / length_p, 1.0);
    let slope = sign(out) * pow(size / length_p, vec3<f32>(power - 1.0));
    let world = vec3<f32>(dot(solid.x, local), dot(solid.y, local), dot(solid.z, local));
    // normals go with the inverse transpose: for axes at right angles, divided by their squared lengths
    let lengths = solid.x.xyz * solid.x.xyz + solid.y.xyz * solid.y.xyz + solid.z.xyz * solid.z.xyz;
    let turned = slope / max(lengths, vec3<f32>(1.0e-12));
    let normal = vec3<f32>(dot(solid.x.xyz, turned), dot(solid.y.xyz, turned), dot(solid.z.xyz, turned));
    return SolidVertex(view.clip_from_world[eye] * vec4<f32>(world, 1.0), world, normal, solid.color.rgb);
}

@fragment
fn user_fragment(in: SolidVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    return finish(shade(in.world, normalize(in.normal), in.color), in.world, eye);
}

@fragment
fn user_fine_fragment(in: SolidVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let toward = toward_eye(in.world, eye);
    let matter = Matter(in.color, normalize(in.normal), 1.0, 0.3, 0.3, 0.0, 1.0);
    return finish_fine(illuminate(in.world, toward.xyz, matter), toward, eye);
}

struct TargetVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) offset: vec2<f32>, // from the middle of the ring, m
}

@vertex
fn target_vertex(@builtin(vertex_index) vertex: u32, @builtin(view_index) eye: u32) -> TargetVertex {
    let corner = select(vertex, 6u - vertex, vertex >= 3u);
    let side = vec2<f32>(f32(corner & 1u), f32((corner >> 1u) & 1u)) * 2.0 - 1.0;
    let offset = side * user.target_place.w * 1.1;
    let world = user.target_place.xyz + vec3<f32>(offset.x, FLOOR, offset.y);
    return TargetVertex(view.clip_from_world[eye] * vec4<f32>(world, 1.0), offset);
}

@fragment
fn target_fragment(in: TargetVertex) -> @location(0) vec4<f32> {
    let radius = user.target_place.w;
    let far = length(in.offset);
    let pixel = max(fwidth(far), 1.0e-5);
    let ring = clamp(0.5 - (abs(far - 0.9 * radius) - 0.08 * radius) / pixel, 0.0, 1.0);
    let disc = 0.35 * clamp(0.5 - (far - 0.9 * radius) / pixel, 0.0, 1.0);
    return vec4<f32>(user.target_color.rgb, max(0.95 * ring, disc));
}

struct VignetteVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) ndc: vec2<f32>,
}

@vertex
fn vignette_vertex(@builtin(vertex_index) vertex: u32) -> VignetteVertex {
    let ndc = vec2<f32>(f32((vertex << 1u) & 2u), f32(vertex & 2u)) * 2.0 - 1.0;
    return VignetteVertex(vec4<f32>(ndc, 1.0, 1.0), ndc);
}

@fragment
fn vignette_fragment(in: VignetteVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let near = view.world_from_clip[eye] * vec4<f32>(in.ndc, 1.0, 1.0);
    let ray = normalize(near.xyz / near.w - view.eyes[eye].xyz);
    // the last row of the matrix is the way the eye looks
    let matrix = view.clip_from_world[eye];
    let ahead = normalize(vec3<f32>(matrix[0].w, matrix[1].w, matrix[2].w));
    let angle = acos(clamp(dot(ray, ahead), -1.0, 1.0));
    let dark = smoothstep(user.vignette.y, user.vignette.z, angle) * user.vignette.x;
    // the grey lies over the black
    let fade = user.vignette.w;
    let alpha = fade + dark * (1.0 - fade);
    return vec4<f32>(vec3<f32>(GREY * fade / max(alpha, 1.0e-6)), alpha);
}
