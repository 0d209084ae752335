// What people wear: which parts of a generated body are drawn, what covers arms and legs, and in which colours.
// Needs the binding outfits.

// Numbers of parts; an outfit has a bit for each. Up to FIRST_COVER they are shells that are drawn where they are worn.
const SKIRT: u32 = 1u;
const BARE_LEGS: u32 = 2u;
const TROUSERS: u32 = 3u;
const JACKET: u32 = 4u; // its hem and collar; its colour is that of all that a top covers
const COAT: u32 = 5u;   // what of it is below a jacket's hem
const CAP: u32 = 6u;
const PEAK: u32 = 7u;   // of a cap
const BRIM: u32 = 8u;   // all round a cap: a hat
const GLASSES: u32 = 9u;
const BACKPACK: u32 = 10u;
const OWN_HAIR: u32 = 11u; // a woman's to the jaw, a man's short
const CROPPED: u32 = 12u;
const SWEPT: u32 = 13u;
const ROUND: u32 = 14u;
const HAIR_LONG: u32 = 15u;
const BALD: u32 = 16u;
const HAIR_UP: u32 = 17u;
const PONYTAIL: u32 = 18u; // these are worn with hair that is up
const BUN: u32 = 19u;
const PLAITS: u32 = 20u;
const KNOT: u32 = 21u;
// Covers are always drawn: cloth where they are worn, otherwise skin.
const FIRST_COVER: u32 = 22u;
const UPPER_SLEEVE: u32 = 22u;
const LOWER_SLEEVE: u32 = 23u;
const LOWER_LEG: u32 = 24u;
const TORSO: u32 = 25u;
const BEARD: u32 = 26u;    // skin, or hair
const SNEAKERS: u32 = 27u; // leather, or cloth with white soles
// Styles: no part of the mesh has these.
const DRESS: u32 = 0u;     // the skirt has the colour of the top
const OPEN: u32 = 28u;     // a jacket whose front shows the top
const STRIPES: u32 = 29u;  // across the top
const BUTTONS: u32 = 30u;  // down the top
const V_NECK: u32 = 31u;

// What an agent wears; its Rust twin is avatar::wardrobe::Outfit.
struct Outfit {
    worn: u32,   // a bit for each part and style; 0: the body's own outfit
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
    if material == MATERIAL_BOTTOM && has(own, COAT) && !is_low {
        return jacket_color(own);
    }
    if material == MATERIAL_BOTTOM && has(own, DRESS) {
        return tinted(color, MATERIAL_TOP, colors);
    }
    if material == MATERIAL_SKIN && is_low && has(own, TROUSERS) {
        return tinted(vec3<f32>(1.0), MATERIAL_BOTTOM, colors);
    }
    let is_shorts = own.worn != 0u && !has(own, LOWER_LEG) && !has(own, TROUSERS) && !has(own, SKIRT);
    if material == MATERIAL_BOTTOM && is_low && is_shorts {
        return tinted(vec3<f32>(1.0), MATERIAL_SKIN, colors);
    }
    return tinted(color, bits, colors);
}
