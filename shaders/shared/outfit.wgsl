// What people wear: which parts of a generated body are drawn, what covers arms and legs, and in which colours.
// Needs the binding outfits.

// Numbers of parts; an outfit has a bit for each. Up to FIRST_COVER they are shells that are drawn where they are worn.
const SKIRT: u32 = 1u;
const BARE_LEGS: u32 = 2u;
const TROUSERS: u32 = 3u;
const HAIR_DOWN: u32 = 4u;
const HAIR_UP: u32 = 5u;
const PONYTAIL: u32 = 6u;
const BUN: u32 = 7u;
const JACKET: u32 = 8u; // its hem and collar; its colour is that of all that a top covers
const CAP: u32 = 9u;
const PEAK: u32 = 10u;
const GLASSES: u32 = 11u;
const BACKPACK: u32 = 12u;
// Covers are always drawn: cloth where they are worn, otherwise skin.
const FIRST_COVER: u32 = 16u;
const UPPER_SLEEVE: u32 = 16u;
const LOWER_SLEEVE: u32 = 17u;
const LOWER_LEG: u32 = 18u;
const TORSO: u32 = 19u;
const BEARD: u32 = 20u; // skin, or hair
// Styles: no part of the mesh has these.
const OPEN: u32 = 21u;    // a jacket whose front shows the top
const STRIPES: u32 = 22u; // across the top
const BUTTONS: u32 = 23u; // down the top
const V_NECK: u32 = 24u;
const DRESS: u32 = 25u;   // the skirt has the colour of the top
const DRESSED: u32 = 0x80000000u; // of an outfit that is not the body's own

// What an agent wears; its Rust twin is avatar::wardrobe::Outfit.
struct Outfit {
    worn: u32,   // a bit for each part and style
    colors: u32, // jacket; cap, bag and stripes: five, six and five bits each
}

fn outfit_of(agent: u32) -> Outfit {
    if agent < arrayLength(&outfits) {
        return outfits[agent];
    }
    return Outfit(0u, 0u);
}

fn has(own: Outfit, part: u32) -> bool {
    return ((own.worn >> part) & 1u) == 1u;
}

fn jacket_color(own: Outfit) -> vec3<f32> {
    return linear_from_565(own.colors & 0xffffu);
}

fn extra_color(own: Outfit) -> vec3<f32> {
    return linear_from_565(own.colors >> 16u);
}

// The colour of a body without a pose, whose mesh knows no parts: `is_low` below the knee.
fn clothed_far(color: vec3<f32>, bits: u32, is_low: bool, own: Outfit, colors: vec2<u32>) -> vec3<f32> {
    let material = bits & 255u;
    if material == MATERIAL_TOP && has(own, JACKET) {
        return color * jacket_color(own);
    }
    if material == MATERIAL_BOTTOM && has(own, DRESS) {
        return tinted(color, MATERIAL_TOP, colors);
    }
    if material == MATERIAL_SKIN && is_low && has(own, TROUSERS) {
        return tinted(vec3<f32>(1.0), MATERIAL_BOTTOM, colors);
    }
    let is_shorts = (own.worn & DRESSED) != 0u && !has(own, LOWER_LEG) && !has(own, TROUSERS) && !has(own, SKIRT);
    if material == MATERIAL_BOTTOM && is_low && is_shorts {
        return tinted(vec3<f32>(1.0), MATERIAL_SKIN, colors);
    }
    return tinted(color, bits, colors);
}
