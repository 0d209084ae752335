// Surfaces with the materials of glTF 2.0 (section 3.9) and their textures, looked up at every pixel.
// Derivatives are taken first: fragments beside a hole still know how fast their textures pass.
// Needs the bindings matters, color_layers, map_layers and layer_sampler, and the shared file fine.

struct TexturedMatter {
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
    is_blended: u32,    // 1: alpha is how much of what is behind is hidden
    is_two_sided: u32,  // 1: it is seen from its back, too
    unused: u32,
}

const NO_LAYER: u32 = 0xffffffffu;
const DIELECTRIC: f32 = 0.04; // share of light that smooth glass, paint and stone mirror face on
const MIRROR: f32 = 0.7;      // and smooth metal

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

// Base colour and alpha with their texture.
fn base_of(matter: TexturedMatter, color: vec4<f32>, uv: vec2<f32>, slopes: Slopes) -> vec4<f32> {
    if matter.color == NO_LAYER {
        return color;
    }
    return color * textureSampleGrad(color_layers, layer_sampler, uv, matter.color, slopes.uv_right, slopes.uv_down);
}

fn map_of(layer: u32, uv: vec2<f32>, slopes: Slopes) -> vec3<f32> {
    return textureSampleGrad(map_layers, layer_sampler, uv, layer, slopes.uv_right, slopes.uv_down).rgb;
}

// The normal with the relief of its map. The axes of the texture follow from how it passes over the pixels (Schueler 2013).
fn relief(matter: TexturedMatter, normal: vec3<f32>, uv: vec2<f32>, slopes: Slopes) -> vec3<f32> {
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

// What light falls on, with a unit normal to the side that is seen and a base colour.
fn textured(matter: TexturedMatter, normal: vec3<f32>, uv: vec2<f32>, slopes: Slopes, base: vec3<f32>) -> Matter {
    var occlusion = 1.0;
    if matter.occlusion != NO_LAYER {
        occlusion = 1.0 - matter.shade * (1.0 - map_of(matter.occlusion, uv, slopes).r);
    }
    var roughness = matter.roughness;
    var metal = matter.metal;
    if matter.rough != NO_LAYER {
        let map = map_of(matter.rough, uv, slopes);
        roughness *= map.g;
        metal *= map.b;
    }
    let smoothness = 1.0 - roughness;
    let gloss = mix(DIELECTRIC, MIRROR, metal) * smoothness * smoothness;
    return Matter(base, relief(matter, normal, uv, slopes), occlusion, 0.0, 0.0, gloss, 1.0);
}
