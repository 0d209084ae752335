// Colours of people: those of the mesh, tinted with the agent's own.
const MATERIAL_SKIN: u32 = 1u;
const MATERIAL_HAIR: u32 = 2u;
const MATERIAL_TOP: u32 = 3u;
const MATERIAL_BOTTOM: u32 = 4u;

// Linear colour of an RGB565 in sRGB; the curve as a polynomial that is 0.003 off at most: `pow` costs more than all the
// rest of a vertex.
fn linear_from_565(packed: u32) -> vec3<f32> {
    let srgb = vec3<f32>(f32((packed >> 11u) & 31u) / 31.0, f32((packed >> 5u) & 63u) / 63.0, f32(packed & 31u) / 31.0);
    return srgb * (srgb * (srgb * 0.305306 + 0.6821711) + 0.0125229);
}

// A vertex colour of a material (the lowest eight of its bits), tinted with the agent's colours: skin and hair in x, top and
// bottom in y.
fn tinted(color: vec3<f32>, bits: u32, colors: vec2<u32>) -> vec3<f32> {
    let material = bits & 255u;
    if material < MATERIAL_SKIN || material > MATERIAL_BOTTOM {
        return color;
    }
    let which = material - MATERIAL_SKIN;
    let pair = select(colors.x, colors.y, which >= 2u);
    return color * linear_from_565((pair >> (16u * (which & 1u))) & 0xffffu);
}
