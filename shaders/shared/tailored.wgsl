// What outfits do to the vertices and the surface of a generated body.
// Needs the binding tailoring, and what `outfit` needs.

const PLAIN: u32 = 32u; // of a vertex whose part the body's own outfit has
const BEARD_SHADE: f32 = 0.75;
const UPPER: f32 = 0.02;        // what of a shoe is brighter than this is no sole
const RUBBER: vec3<f32> = vec3<f32>(0.62, 0.62, 0.58);

// What outfits do to a vertex: part (5 bits), plain (1), growth in mm (8, signed, from bit 8), height of the collar in mm (16).
fn tailoring_of(vertex: u32) -> u32 {
    if vertex < arrayLength(&tailoring) {
        return tailoring[vertex];
    }
    return 0u;
}

fn part_of(tailored: u32) -> u32 {
    return tailored & 31u;
}

// Whether the part of a vertex is worn.
fn wears(own: Outfit, tailored: u32) -> bool {
    if own.worn == 0u {
        return (tailored & PLAIN) != 0u;
    }
    return has(own, part_of(tailored));
}

fn is_left_out(own: Outfit, tailored: u32) -> bool {
    let part = part_of(tailored);
    return part > 0u && part < FIRST_COVER && !wears(own, tailored);
}

// How far a vertex moves along its normal, m.
fn growth_of(own: Outfit, tailored: u32) -> f32 {
    if part_of(tailored) < FIRST_COVER || wears(own, tailored) == ((tailored & PLAIN) != 0u) {
        return 0.0;
    }
    return 0.001 * f32(i32(tailored << 16u) >> 24u);
}

// A vertex colour and the bits of its material, as the outfit has them, tinted with the agent's colours.
fn clothed(color: vec3<f32>, bits: u32, own: Outfit, tailored: u32, colors: vec2<u32>) -> vec3<f32> {
    let part = part_of(tailored);
    if part == 0u {
        return tinted(color, bits, colors);
    }
    var shade = color;
    var material = bits & 255u;
    let is_worn = wears(own, tailored);
    if part == BEARD {
        if is_worn {
            return tinted(vec3<f32>(BEARD_SHADE), MATERIAL_HAIR, colors);
        }
    } else if part == SNEAKERS {
        if is_worn {
            return select(RUBBER, extra_color(own), color.x > UPPER);
        }
    } else if part >= FIRST_COVER && part != TORSO {
        if !is_worn {
            return tinted(vec3<f32>(1.0), MATERIAL_SKIN, colors);
        }
        material = select(MATERIAL_TOP, MATERIAL_BOTTOM, part == LOWER_LEG);
        // no hem half way down a long sleeve, and no skin's shade on cloth
        let is_long = part == UPPER_SLEEVE && has(own, LOWER_SLEEVE);
        if is_long || (tailored & PLAIN) == 0u {
            shade = vec3<f32>(1.0);
        }
    }
    if part == CAP || part == PEAK || part == BRIM || part == BACKPACK {
        return shade * extra_color(own);
    }
    let is_skirt = (part == SKIRT || part == BARE_LEGS) && material == MATERIAL_BOTTOM;
    if is_skirt && has(own, COAT) {
        return shade * jacket_color(own); // a lifted thigh that comes through the coat is not seen
    } else if is_skirt && has(own, DRESS) {
        material = MATERIAL_TOP;
    } else if material == MATERIAL_TOP && has(own, JACKET) {
        return shade * jacket_color(own);
    }
    return tinted(shade, material, colors);
}

// What a top looks like.
const OPENING: vec3<f32> = vec3<f32>(0.022, 0.058, 0.9); // half width of an open front at the hem and at the collar; shade of lapels
const LAPEL: f32 = 0.012;        // m
const COAT_EDGE: vec2<f32> = vec2<f32>(0.006, 0.35); // half width, m, and shade
const CUT: vec2<f32> = vec2<f32>(0.095, 0.55); // a neck is cut so deep, m, and so broad for its depth
const STRIPE: vec2<f32> = vec2<f32>(0.046, 0.4); // from one to the next, m, and its share
const BUTTON: vec3<f32> = vec3<f32>(0.085, 0.0058, 0.014); // from one to the next, radius, half width of the placket, m
const STRAP: vec2<f32> = vec2<f32>(0.098, 0.017); // middle and half width, m
const STRAP_DOWN: f32 = 0.16; // so far below the collar it begins to go to the side, m
const STRAP_OUT: f32 = 0.55;  // by so much for each metre
const STRAP_END: f32 = 0.4;   // m below the collar

fn inside(distance: f32, blur: f32) -> f32 {
    return clamp(0.5 - 0.5 * distance / max(blur, 1.0e-5), 0.0, 1.0);
}

// Of a place of the top, at rest, which stripes, buttons, straps and openings have their own colour. `blur` is half of what a
// pixel covers there, m.
fn patterned(albedo: vec3<f32>, rest: vec3<f32>, own: Outfit, tailored: u32, colors: vec2<u32>, blur: f32) -> vec3<f32> {
    let part = part_of(tailored);
    let is_sleeve = part == UPPER_SLEEVE || part == LOWER_SLEEVE;
    let is_front = part == TORSO || part == JACKET;
    if part == COAT && rest.z > 0.0 {
        return albedo * mix(1.0, COAT_EDGE.y, inside(abs(rest.x) - COAT_EDGE.x, blur)); // where its halves meet
    }
    if !(is_sleeve || is_front) || !wears(own, tailored) {
        return albedo;
    }
    var color = albedo;
    if has(own, STRIPES) {
        let along = abs(fract(rest.y / STRIPE.x) - 0.5) * STRIPE.x;
        color = mix(color, extra_color(own), inside(along - 0.5 * STRIPE.x * STRIPE.y, blur));
    }
    if !is_front {
        return color;
    }
    let below = f32(tailored >> 16u) * 0.001 - rest.y; // the collar
    let aside = abs(rest.x);
    if rest.z > 0.0 {
        if has(own, OPEN) {
            let half = mix(OPENING.y, OPENING.x, clamp(below * 1.8, 0.0, 1.0));
            color *= mix(1.0, OPENING.z, inside(aside - half - LAPEL, blur));
            color = mix(color, tinted(vec3<f32>(1.0), MATERIAL_TOP, colors), inside(aside - half, blur));
        } else if has(own, JACKET) {
            color *= mix(1.0, 0.6, inside(aside - 0.0035, blur)); // a zip
        }
        if has(own, V_NECK) {
            color = mix(color, tinted(vec3<f32>(1.0), MATERIAL_SKIN, colors), inside(aside - (CUT.x - below) * CUT.y, blur));
        }
        if has(own, BUTTONS) {
            color *= mix(1.0, 0.86, inside(abs(aside - BUTTON.z) - 0.0012, blur));
            let up = (fract(below / BUTTON.x) - 0.5) * BUTTON.x;
            color = mix(color, vec3<f32>(0.75), inside(length(vec2<f32>(aside, up)) - BUTTON.y, blur));
        }
    }
    if has(own, BACKPACK) && rest.z > -0.06 && below < STRAP_END {
        let middle = STRAP.x + STRAP_OUT * max(below - STRAP_DOWN, 0.0);
        color = mix(color, 0.8 * extra_color(own), inside(abs(aside - middle) - STRAP.y, blur));
    }
    return color;
}
