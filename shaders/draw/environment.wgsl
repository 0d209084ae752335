// uses: view, light, fine, detail
// Ground, buildings, props: vertices in world space with a colour each.
// What lies flat (layer 1 and up) lies at one height: deeper layers are drawn a little farther away than they are, so that
// none flickers through another. It casts no shadow, hence needs no room between itself and what stands on it: shadows
// begin at the feet.

@group(0) @binding(3) var<storage, read> environment: array<array<vec4<f32>, 3>>; // position, layer; normal; linear colour, material

@group(0) @binding(4) var<storage, read> ground_map: array<u32>; // see render::ground_map

const LAYER: f32 = 1.0e-3; // how much farther a layer is drawn than the one above it, of its distance

struct EnvironmentVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec3<f32>,
    @location(3) lift: f32,
}

// Of a place with its layer.
fn clip_of(place: vec4<f32>, eye: u32) -> vec4<f32> {
    var clip = view.clip_from_world[eye] * vec4<f32>(place.xyz, 1.0);
    clip.z *= 1.0 - LAYER * max(place.w - 1.0, 0.0); // reversed depth: less is farther
    return clip;
}

@vertex
fn environment_vertex(@builtin(vertex_index) vertex: u32, @builtin(view_index) eye: u32) -> EnvironmentVertex {
    let place = environment[vertex][0];
    let clip = clip_of(place, eye);
    let lift = select(1.0, 0.0, place.w > 0.0);
    return EnvironmentVertex(clip, place.xyz, environment[vertex][1].xyz, environment[vertex][2].rgb, lift);
}

@fragment
fn environment_fragment(in: EnvironmentVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    return finish(shade_lifted(in.world, normalize(in.normal), in.color, in.lift), in.world, eye);
}

// Like EnvironmentVertex, and the pattern of the material.
struct FineVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec3<f32>,
    @location(3) lift: f32,
    @location(4) @interpolate(flat) noise: vec4<f32>,
    @location(5) @interpolate(flat) joints: vec4<f32>,
    @location(6) @interpolate(flat) look: vec4<f32>,
}

@vertex
fn environment_fine_vertex(@builtin(vertex_index) vertex: u32, @builtin(view_index) eye: u32) -> FineVertex {
    let place = environment[vertex][0];
    let color = environment[vertex][2];
    let lift = select(1.0, 0.0, place.w > 0.0);
    let pattern = pattern_of(u32(color.w));
    return FineVertex(
        clip_of(place, eye),
        place.xyz,
        environment[vertex][1].xyz,
        color.rgb,
        lift,
        pattern.noise,
        pattern.joints,
        pattern.look,
    );
}

const DIM_FOOT: f32 = 0.4;    // share of the sky that the ground takes from the foot of a wall
const DIM_HEIGHT: f32 = 0.5;  // height at which that is down to a third, m
const DIM_BELOW: f32 = 0.5;   // and what a surface that faces down is without
const UNEVEN_PANE: f32 = 0.02; // slope of one pane against the next

// Words of the ground map before its cells.
const HEADER: u32 = 5u;
const FLOOR_HEIGHT: f32 = 0.3; // what lies higher is no ground, m

// Share of the sky that walls and props take from the ground.
fn ground_shade(place: vec2<f32>) -> f32 {
    let columns = ground_map[3];
    let rows = ground_map[4];
    let low = bitcast<vec2<f32>>(vec2<u32>(ground_map[0], ground_map[1]));
    // values stand in the middles of cells
    let at = (place - low) * bitcast<f32>(ground_map[2]) - 0.5;
    if columns < 2u || at.x < 0.0 || at.y < 0.0 || at.x >= f32(columns - 1u) || at.y >= f32(rows - 1u) {
        return 0.0;
    }
    let cell = floor(at);
    let part = at - cell;
    let corners = unpack4x8unorm(ground_map[HEADER + u32(cell.y) * columns + u32(cell.x)]);
    let sides = mix(corners.xz, corners.yw, part.x);
    return mix(sides.x, sides.y, part.y);
}

// Share of the sky that reaches a place.
fn occlusion_of(world: vec3<f32>, normal: vec3<f32>, lift: f32) -> f32 {
    if lift < 0.5 {
        return select(1.0, 1.0 - ground_shade(world.xz), world.y < FLOOR_HEIGHT);
    }
    let foot = DIM_FOOT * exp(-max(world.y, 0.0) / DIM_HEIGHT) * (1.0 - abs(normal.y));
    return 1.0 - foot - DIM_BELOW * max(-normal.y, 0.0);
}

@fragment
fn environment_fine_fragment(in: FineVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let toward = toward_eye(in.world, eye);
    let flat_normal = normalize(in.normal);
    let cosine = abs(dot(flat_normal, toward.xyz));
    let footprint = footprint_of(toward.w, cosine, is_parallel(eye));
    let pattern = Pattern(in.noise, in.joints, in.look);
    let detail = detail_of(pattern, in.world, flat_normal, footprint);
    let gloss = pattern.look.z * (1.0 - detail.joint);
    // relief at high quality; panes hang unevenly at any
    let slope = select(vec2<f32>(0.0), detail.tilt, view.quality >= HIGH) + detail.cell * UNEVEN_PANE * step(0.09, gloss);
    let normal = normalize(flat_normal + vec3<f32>(slope.x, 0.0, slope.y));
    // what glows is no surface that dirt lies on
    let shade = select(detail.shade, vec3<f32>(1.0), max(in.color.r, max(in.color.g, in.color.b)) > 1.0);
    let occlusion = occlusion_of(in.world, flat_normal, in.lift);
    let matter = Matter(in.color * shade, normal, occlusion, 0.0, 0.0, gloss, in.lift);
    return finish_fine(illuminate(in.world, toward.xyz, matter), toward, eye);
}

@vertex
fn environment_shadow(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    let place = environment[vertex][0];
    if place.w > 0.0 {
        return vec4<f32>(0.0, 0.0, 0.0, 1.0); // no area: not drawn
    }
    return view.shadow_from_world * vec4<f32>(place.xyz, 1.0);
}
