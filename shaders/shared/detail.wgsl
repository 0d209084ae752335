// uses: view
// What surfaces are made of, drawn by place in the world: grain, joints, courses, panes. Nothing is drawn that is finer than
// two pixels, so that it neither flickers nor crawls.

// Materials, as scenario::SurfaceMaterial.
const PLAIN: u32 = 0u;
const ASPHALT: u32 = 1u;
const CONCRETE: u32 = 2u;
const GRAVEL: u32 = 3u;
const GRASS: u32 = 4u;
const DECK: u32 = 5u;
const PAVING: u32 = 6u;
const PAINT: u32 = 7u;
const PLASTER: u32 = 8u;
const PANEL: u32 = 9u;
const BRICK: u32 = 10u;
const GLASS: u32 = 11u;
const FOLIAGE: u32 = 12u;
const WOOD: u32 = 13u;
const WATER: u32 = 14u;
const LACQUER: u32 = 15u;
const PANE: u32 = 16u;
const LIT_PANE: u32 = 17u;

const NO_JOINTS: f32 = 0.0;
const FAINTEST: f32 = 0.004; // noise that changes a colour by less, as a share of it, is left out: a step of eight bits

// How a material looks. The vertex shader chooses it, so that all pixels take one path.
struct Pattern {
    noise: vec4<f32>,  // sizes of two octaves, m, and their strengths
    joints: vec4<f32>, // distances between joints, along and up, m; half the width of a joint, m; its shade
    look: vec4<f32>,   // how much a slab differs from the next; its offset in every other row; gloss; how much hues differ
}

fn pattern_of(material: u32) -> Pattern {
    let none = vec4<f32>(NO_JOINTS, NO_JOINTS, 0.0, 0.0);
    switch material {
        case ASPHALT: {
            return Pattern(vec4<f32>(2.7, 0.03, 0.1, 0.24), none, vec4<f32>(0.0, 0.0, 0.0, 0.0));
        }
        case CONCRETE: {
            return Pattern(vec4<f32>(2.1, 0.07, 0.09, 0.1), vec4<f32>(3.0, 3.0, 0.012, 0.6), vec4<f32>(0.05, 0.0, 0.0, 0.0));
        }
        case GRAVEL: {
            return Pattern(vec4<f32>(1.9, 0.05, 0.1, 0.3), none, vec4<f32>(0.0, 0.0, 0.0, 0.1));
        }
        case GRASS: {
            return Pattern(vec4<f32>(1.7, 0.075, 0.22, 0.45), none, vec4<f32>(0.0, 0.0, 0.0, 0.5));
        }
        case DECK: {
            return Pattern(vec4<f32>(2.4, 0.2, 0.05, 0.04), vec4<f32>(2.0, 2.0, 0.015, 0.45), vec4<f32>(0.08, 0.5, 0.05, 0.0));
        }
        case PAVING: {
            return Pattern(vec4<f32>(1.9, 0.04, 0.09, 0.13), vec4<f32>(0.6, 0.6, 0.007, 0.5), vec4<f32>(0.1, 0.5, 0.0, 0.15));
        }
        case PAINT: {
            return Pattern(vec4<f32>(0.9, 0.04, 0.07, 0.14), none, vec4<f32>(0.0, 0.0, 0.0, 0.0));
        }
        case PLASTER: {
            return Pattern(vec4<f32>(1.6, 0.1, 0.09, 0.06), none, vec4<f32>(0.0, 0.0, 0.0, 0.0));
        }
        case PANEL: {
            return Pattern(vec4<f32>(2.3, 0.3, 0.04, 0.02), vec4<f32>(1.5, 1.2, 0.012, 0.5), vec4<f32>(0.06, 0.0, 0.03, 0.0));
        }
        case BRICK: {
            return Pattern(vec4<f32>(1.7, 0.05, 0.08, 0.08), vec4<f32>(0.25, 0.083, 0.006, 1.35), vec4<f32>(0.3, 0.5, 0.0, 0.3));
        }
        case GLASS: {
            return Pattern(vec4<f32>(3.0, 0.5, 0.0, 0.0), vec4<f32>(1.3, 1.6, 0.03, 0.3), vec4<f32>(0.25, 0.0, 0.1, 0.0));
        }
        case FOLIAGE: {
            return Pattern(vec4<f32>(0.6, 0.12, 0.4, 0.6), none, vec4<f32>(0.0, 0.0, 0.0, 0.3));
        }
        case WOOD: {
            return Pattern(vec4<f32>(0.5, 0.03, 0.08, 0.1), none, vec4<f32>(0.0, 0.0, 0.0, 0.0));
        }
        case WATER: {
            return Pattern(vec4<f32>(0.5, 0.13, 0.06, 0.04), none, vec4<f32>(0.0, 0.0, 0.05, 0.0));
        }
        case LACQUER: {
            return Pattern(vec4<f32>(1.0, 1.0, 0.0, 0.0), none, vec4<f32>(0.0, 0.0, 0.06, 0.0));
        }
        case PANE, LIT_PANE: {
            return Pattern(vec4<f32>(3.0, 0.5, 0.0, 0.0), none, vec4<f32>(0.0, 0.0, 0.1, 0.0));
        }
        default: {
            return Pattern(vec4<f32>(1.3, 0.09, 0.03, 0.03), none, vec4<f32>(0.0, 0.0, 0.0, 0.0));
        }
    }
}

// What a pattern does to a place.
struct Detail {
    shade: vec3<f32>, // factor of the colour
    tilt: vec2<f32>,  // slope of the surface along its two directions
    cell: f32,        // -1 to 1, another one for each slab
    joint: f32,       // share of the pixel that is joint
}

// 0 to 1 for a point of a grid.
fn lattice(x: u32, y: u32) -> f32 {
    var mixed = (x * 0x9e3779b1u) ^ (y * 0x85ebca77u);
    mixed = (mixed ^ (mixed >> 15u)) * 0x2c1b3c6du;
    return f32((mixed ^ (mixed >> 13u)) >> 8u) * (1.0 / 16777216.0);
}

// Value noise, -1 to 1 over a grid of side 1, with its slope in y and z.
fn value_noise(at: vec2<f32>) -> vec3<f32> {
    let corner = floor(at);
    let x = bitcast<u32>(i32(corner.x));
    let y = bitcast<u32>(i32(corner.y));
    let part = at - corner;
    let ease = part * part * (3.0 - 2.0 * part);
    let a = lattice(x, y);
    let b = lattice(x + 1u, y);
    let c = lattice(x, y + 1u);
    let d = lattice(x + 1u, y + 1u);
    let both = a - b - c + d;
    let value = a + (b - a) * ease.x + (c - a) * ease.y + both * ease.x * ease.y;
    let steep = 6.0 * part * (1.0 - part);
    let slope = steep * vec2<f32>(b - a + both * ease.y, c - a + both * ease.x);
    return vec3<f32>(2.0 * value - 1.0, 2.0 * slope);
}

// How much of what has this size is seen where a pixel covers `footprint`, both in m: all of four pixels, nothing of two.
fn is_seen(size: f32, footprint: f32) -> f32 {
    return clamp(2.0 - 4.0 * footprint / size, 0.0, 1.0);
}

// Grain of a size, or of the least multiple of it by a power of two that is seen: what is farther away shows coarser grain,
// and less of it.
fn grain_of(at: vec2<f32>, size: f32, footprint: f32) -> vec3<f32> {
    // a float is a power of two times 1 to 2: both are its bits
    let bits = bitcast<u32>(max(4.0 * footprint / size, 1.0));
    let whole = (bits >> 23u) - 127u;
    let finer = 2.0 - bitcast<f32>((bits & 0x7fffffu) | 0x3f800000u);
    let scale = bitcast<f32>((127u - whole) << 23u) / size;
    let weight = exp2(-0.6 * f32(whole));
    return weight * (value_noise(at * scale) * finer + value_noise(at * scale * 0.5) * (0.66 * (1.0 - finer)));
}

// Share of a pixel that lies on joints, `apart` from one another, m.
fn joint(at: f32, apart: f32, half_width: f32, footprint: f32) -> f32 {
    let off = abs(at - apart * round(at / apart));
    return clamp((half_width + 0.5 * footprint - off) / footprint, 0.0, min(2.0 * half_width / footprint, 1.0));
}

// Side of the ground or wall that a pixel covers at most, m: `far` m away, seen under an angle of this cosine.
fn footprint_of(far: f32, cosine: f32, is_map: bool) -> f32 {
    return view.pixel * select(far, 1.0, is_map) / max(cosine, 0.02);
}

fn detail_of(pattern: Pattern, world: vec3<f32>, normal: vec3<f32>, footprint: f32) -> Detail {
    // joints lie along the wall and up, or along the ground; what has none is seen from aslant, so that round things look alike
    // from all sides
    let side = normal.xz / max(length(normal.xz), 1.0e-4);
    let on_wall = vec2<f32>(world.x * side.y - world.z * side.x, world.y);
    let has_joints = pattern.joints.x > NO_JOINTS;
    let aslant = world.xz + world.y * vec2<f32>(0.71, 0.53);
    let at = select(aslant, select(world.xz, on_wall, abs(normal.y) < 0.7), has_joints);
    let seen = is_seen(pattern.noise.x, footprint);
    var uneven = 0.0;
    var tilt = vec2<f32>(0.0);
    if seen * (pattern.noise.z + pattern.noise.w) > FAINTEST {
        let patches = value_noise(at / pattern.noise.x) * (pattern.noise.z * seen);
        let grain = grain_of(at, pattern.noise.y, footprint) * (pattern.noise.w * seen);
        uneven = patches.x + grain.x;
        tilt = grain.yz * -0.7;
    }
    var shade = vec3<f32>(1.0 + uneven) + pattern.look.w * uneven * vec3<f32>(0.7, 0.1, -0.5);
    if !has_joints {
        return Detail(shade, tilt, 0.0, 0.0);
    }
    let row = floor(at.y / pattern.joints.y);
    let shift = pattern.look.y * pattern.joints.x * (row - 2.0 * floor(0.5 * row));
    let along = at.x + shift;
    let column = floor(along / pattern.joints.x);
    let finest = min(pattern.joints.x, pattern.joints.y);
    let cell = (2.0 * lattice(bitcast<u32>(i32(column)), bitcast<u32>(i32(row))) - 1.0) * is_seen(finest, footprint);
    let lines = max(
        joint(along, pattern.joints.x, pattern.joints.z, footprint) * is_seen(pattern.joints.x, footprint),
        joint(at.y, pattern.joints.y, pattern.joints.z, footprint) * is_seen(pattern.joints.y, footprint),
    );
    shade = mix(shade * (1.0 + pattern.look.x * cell), vec3<f32>(pattern.joints.w), lines);
    return Detail(shade, tilt, cell, lines);
}
