// uses: view, light, fine
// A place of the user's own: triangles in world space with the materials of glTF 2.0 (section 3.9) and its textures.
// What is solid is seen from its front. What is open has two sides or holes: alpha below the material's cutoff is a hole.
// Derivatives are taken first: fragments beside a hole still know how fast their textures pass.

@group(0) @binding(3) var<storage, read> place_corners: array<PlaceCorner>; // [vertex]
@group(0) @binding(4) var<storage, read> place_matters: array<PlaceMatter>; // [material]
@group(0) @binding(5) var place_colors: texture_2d_array<f32>;              // colours; alpha
@group(0) @binding(6) var place_maps: texture_2d_array<f32>;                // normals; occlusion, roughness, metal
@group(0) @binding(7) var place_sampler: sampler;

struct PlaceCorner {
    place_and_u: vec4<f32>,      // m; place on the textures
    normal_and_v: vec4<f32>,     // unit
    color_and_matter: vec4<f32>, // linear base colour, before textures; number of the material
}

struct PlaceMatter {
    glow: vec4<f32>,    // rgb: light that it sends out itself
    cutoff: f32,        // least alpha that is there; 0: all is
    roughness: f32,     // 0 to 1
    metal: f32,         // 0 to 1
    slope: f32,         // how much the slopes of its normals count
    shade: f32,         // how much its occlusion counts
    color: u32,         // layer of its colours; NO_LAYER: it has none
    rough: u32,         // layer of roughness (green) and metal (blue)
    normal: u32,        // layer of its normals
    occlusion: u32,     // layer of occlusion (red)
    unused_a: u32,
    unused_b: u32,
    unused_c: u32,
}

const NO_LAYER: u32 = 0xffffffffu;
const DIELECTRIC: f32 = 0.04; // share of light that smooth glass, paint and stone mirror face on
const MIRROR: f32 = 0.7;      // and smooth metal

struct PlaceVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec3<f32>,
    @location(3) uv: vec2<f32>,
    @location(4) @interpolate(flat) matter: u32,
}

fn uv_of(corner: PlaceCorner) -> vec2<f32> {
    return vec2<f32>(corner.place_and_u.w, corner.normal_and_v.w);
}

@vertex
fn place_vertex(@builtin(vertex_index) vertex: u32, @builtin(view_index) eye: u32) -> PlaceVertex {
    let corner = place_corners[vertex];
    let place = corner.place_and_u.xyz;
    return PlaceVertex(
        view.clip_from_world[eye] * vec4<f32>(place, 1.0),
        place,
        corner.normal_and_v.xyz,
        corner.color_and_matter.rgb,
        uv_of(corner),
        u32(corner.color_and_matter.w),
    );
}

// How the place changes from a pixel to the next, to the right and down.
struct Slopes {
    uv_right: vec2<f32>,
    uv_down: vec2<f32>,
    world_right: vec3<f32>,
    world_down: vec3<f32>,
}

fn slopes_of(uv: vec2<f32>, world: vec3<f32>) -> Slopes {
    return Slopes(dpdx(uv), dpdy(uv), dpdx(world), dpdy(world));
}

// Base colour and alpha.
fn base_of(matter: PlaceMatter, color: vec3<f32>, uv: vec2<f32>, slopes: Slopes) -> vec4<f32> {
    if matter.color == NO_LAYER {
        return vec4<f32>(color, 1.0);
    }
    return vec4<f32>(color, 1.0) * textureSampleGrad(place_colors, place_sampler, uv, matter.color, slopes.uv_right, slopes.uv_down);
}

fn map_of(layer: u32, uv: vec2<f32>, slopes: Slopes) -> vec3<f32> {
    return textureSampleGrad(place_maps, place_sampler, uv, layer, slopes.uv_right, slopes.uv_down).rgb;
}

// The normal with the relief of its map. The axes of the texture follow from how it passes over the pixels (Schueler 2013).
fn relief(matter: PlaceMatter, normal: vec3<f32>, uv: vec2<f32>, slopes: Slopes) -> vec3<f32> {
    if matter.normal == NO_LAYER {
        return normal;
    }
    let across = cross(slopes.world_down, normal);
    let along = cross(normal, slopes.world_right);
    let tangent = across * slopes.uv_right.x + along * slopes.uv_down.x;
    let bitangent = across * slopes.uv_right.y + along * slopes.uv_down.y;
    let size = max(dot(tangent, tangent), dot(bitangent, bitangent));
    if size <= 0.0 {
        return normal;
    }
    let bump = map_of(matter.normal, uv, slopes) * 2.0 - 1.0;
    // pixels go down the picture and back faces the other way round: which way the axes turn is part of the answer
    let turn = select(-1.0, 1.0, dot(slopes.world_right, across) > 0.0);
    let scale = matter.slope * turn * inverseSqrt(size);
    // a map's second axis points up its picture, texture coordinates down
    return normalize(normal * max(bump.z, 1.0e-3) + tangent * (bump.x * scale) - bitangent * (bump.y * scale));
}

fn place_matter_of(in: PlaceVertex, front: bool, slopes: Slopes, base: vec4<f32>) -> Matter {
    let matter = place_matters[in.matter];
    let side = normalize(select(-in.normal, in.normal, front));
    var occlusion = 1.0;
    if matter.occlusion != NO_LAYER {
        occlusion = 1.0 - matter.shade * (1.0 - map_of(matter.occlusion, in.uv, slopes).r);
    }
    var roughness = matter.roughness;
    var metal = matter.metal;
    if matter.rough != NO_LAYER {
        let map = map_of(matter.rough, in.uv, slopes);
        roughness *= map.g;
        metal *= map.b;
    }
    let smoothness = 1.0 - roughness;
    let gloss = mix(DIELECTRIC, MIRROR, metal) * smoothness * smoothness;
    return Matter(base.rgb, relief(matter, side, in.uv, slopes), occlusion, 0.0, 0.0, gloss, 1.0);
}

fn low_color(in: PlaceVertex, front: bool, base: vec4<f32>, eye: u32) -> vec4<f32> {
    let normal = normalize(select(-in.normal, in.normal, front));
    let light = shade(in.world, normal, base.rgb) + place_matters[in.matter].glow.rgb;
    return finish(light, in.world, eye);
}

fn fine_color(in: PlaceVertex, front: bool, slopes: Slopes, base: vec4<f32>, eye: u32) -> vec4<f32> {
    let toward = toward_eye(in.world, eye);
    let light = illuminate(in.world, toward.xyz, place_matter_of(in, front, slopes, base)) + place_matters[in.matter].glow.rgb;
    return finish_fine(light, toward, eye);
}

@fragment
fn place_fragment(in: PlaceVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let slopes = slopes_of(in.uv, in.world);
    let base = base_of(place_matters[in.matter], in.color, in.uv, slopes);
    return low_color(in, true, base, eye);
}

@fragment
fn place_open_fragment(in: PlaceVertex, @builtin(front_facing) front: bool, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let slopes = slopes_of(in.uv, in.world);
    let base = base_of(place_matters[in.matter], in.color, in.uv, slopes);
    if base.a < place_matters[in.matter].cutoff {
        discard;
    }
    return low_color(in, front, base, eye);
}

@fragment
fn place_fine_fragment(in: PlaceVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let slopes = slopes_of(in.uv, in.world);
    let base = base_of(place_matters[in.matter], in.color, in.uv, slopes);
    return fine_color(in, true, slopes, base, eye);
}

@fragment
fn place_open_fine_fragment(
    in: PlaceVertex, @builtin(front_facing) front: bool, @builtin(view_index) eye: u32,
) -> @location(0) vec4<f32> {
    let slopes = slopes_of(in.uv, in.world);
    let base = base_of(place_matters[in.matter], in.color, in.uv, slopes);
    if base.a < place_matters[in.matter].cutoff {
        discard;
    }
    return fine_color(in, front, slopes, base, eye);
}

@vertex
fn place_shadow(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    return view.shadow_from_world * vec4<f32>(place_corners[vertex].place_and_u.xyz, 1.0);
}

struct OpenShadow {
    @builtin(position) clip: vec4<f32>,
    @location(0) uv: vec2<f32>,
    @location(1) @interpolate(flat) matter: u32,
}

@vertex
fn place_open_shadow(@builtin(vertex_index) vertex: u32) -> OpenShadow {
    let corner = place_corners[vertex];
    let clip = view.shadow_from_world * vec4<f32>(corner.place_and_u.xyz, 1.0);
    return OpenShadow(clip, uv_of(corner), u32(corner.color_and_matter.w));
}

// Writes depth where there is no hole.
@fragment
fn place_hole(in: OpenShadow) {
    let slopes = slopes_of(in.uv, vec3<f32>(in.uv, 0.0));
    let matter = place_matters[in.matter];
    if base_of(matter, vec3<f32>(1.0), in.uv, slopes).a < matter.cutoff {
        discard;
    }
}
