// Sun, sky, shadow, haze and tone: what every surface in the image has in common.

@group(0) @binding(0) var<uniform> view: ViewUniforms;
@group(0) @binding(1) var shadow_map: texture_depth_2d;
@group(0) @binding(2) var shadow_sampler: sampler_comparison;

const SUN_DISC: f32 = 0.9995;        // cosine of the radius at which the sun's disc is drawn, larger than the real one
const SUN_GLOW: f32 = 0.18;
const SHOULDER: f32 = 0.5;           // brightness from which on highlights are compressed
const SCATTER: f32 = 0.14;           // share of the sun's light that the air sends from the sun's side of the sky
const LIFT: f32 = 0.4;               // how far receivers are moved towards the sun, texels of the shadow map
const LIFT_SLANTED: f32 = 2.3;       // and along their normal where light grazes them: the reach of the samples below
const WHOLE_MAP: f32 = 0.0;          // the maps in the image of shadows, from left to right
const NEAR_MAP: f32 = 1.0;
const SHADOW_EDGE: f32 = 20.0;       // shadows fade out over the outermost 1/20 of the map
const SQUARE = vec2<f32>(0.4, 1.2);  // a corner of the turned square that is sampled, texels

// The sky in a unit direction.
fn sky_color(direction: vec3<f32>) -> vec3<f32> {
    let up = max(direction.y, 0.0);
    var color = mix(view.sky_horizon.rgb, view.sky_zenith.rgb, sqrt(up));
    // the glow gathers about the sun with the 24th power
    let sun = max(dot(direction, view.sun_direction.xyz), 0.0);
    let sun2 = sun * sun;
    let sun8 = sun2 * sun2 * (sun2 * sun2);
    color += view.sun_color.rgb * (SUN_GLOW * (sun8 * sun8 * sun8));
    // below the horizon: what lies beyond the end of the ground
    let below = clamp(-direction.y * 8.0, 0.0, 1.0);
    return mix(color, mix(view.sky_horizon.rgb, view.ground_bounce.rgb, 0.5), below * 0.6);
}

// How far a place is moved off its surface before it is looked up in a shadow map, so that it does not shade itself. In the world, m.
fn lift_off(normal: vec3<f32>) -> vec3<f32> {
    let facing = dot(normal, view.sun_direction.xyz);
    let slant = sqrt(max(1.0 - facing * facing, 0.0));
    return (normal * (LIFT_SLANTED * slant) + view.sun_direction.xyz * LIFT) * view.sun_direction.w;
}

// Where a place of the world lies in the clip space of the whole shadow map.
fn to_shadow(world: vec3<f32>) -> vec3<f32> {
    return (view.shadow_from_world * vec4<f32>(world, 1.0)).xyz;
}

// Share of the sun's light in a place of a map, in its clip space. `corner` is the first of four bilinear samples on a turned
// square, in texels: together as soft as nine on the grid.
fn sun_samples(map: f32, place: vec2<f32>, depth: f32, corner: vec2<f32>) -> f32 {
    let share = vec2<f32>(view.near_shadow.w, 1.0);
    let middle = (place * 0.5 + 0.5 + vec2<f32>(map, 0.0)) * share;
    let one = corner * view.sun_color.w * share;
    let other = vec2<f32>(-corner.y, corner.x) * view.sun_color.w * share;
    var lit = textureSampleCompareLevel(shadow_map, shadow_sampler, middle + one, depth);
    lit += textureSampleCompareLevel(shadow_map, shadow_sampler, middle + other, depth);
    lit += textureSampleCompareLevel(shadow_map, shadow_sampler, middle - one, depth);
    lit += textureSampleCompareLevel(shadow_map, shadow_sampler, middle - other, depth);
    return lit * 0.25;
}

// How far inside of a map a place is, as a share of the map's edge, which is its outermost 1 / `edge`. Negative outside.
fn within(place: vec2<f32>, edge: f32) -> f32 {
    return (1.0 - max(abs(place.x), abs(place.y))) * edge;
}

// 1 in the sun, 0 in the shadow. `lift`: 1 of what casts shadows, 0 of what casts none.
fn sunlight(world: vec3<f32>, normal: vec3<f32>, lift: f32) -> f32 {
    let clip = to_shadow(world + lift_off(normal) * lift);
    let left = within(clip.xy, SHADOW_EDGE);
    if left <= 0.0 {
        return 1.0;
    }
    return mix(1.0, sun_samples(WHOLE_MAP, clip.xy, clip.z, SQUARE), clamp(left, 0.0, 1.0));
}

// Light that a matt surface sends to the eye, before haze and tone. What of its colour is above 1 glows.
fn shade(world: vec3<f32>, normal: vec3<f32>, color: vec3<f32>) -> vec3<f32> {
    return shade_lifted(world, normal, color, 1.0);
}

// The same of a surface that may not be in the shadow map.
fn shade_lifted(world: vec3<f32>, normal: vec3<f32>, color: vec3<f32>, lift: f32) -> vec3<f32> {
    let facing = dot(normal, view.sun_direction.xyz);
    var sun = 0.0;
    if facing > 0.0 {
        sun = facing * sunlight(world, normal, lift);
    }
    let up = 0.5 + 0.5 * normal.y;
    let scattered = view.sun_color.rgb * (SCATTER * (0.5 + 0.5 * facing));
    let ambient = scattered + mix(view.ground_bounce.rgb, view.sky_light.rgb, up);
    let albedo = min(color, vec3<f32>(1.0));
    return albedo * (view.sun_color.rgb * sun + ambient) + max(color - 1.0, vec3<f32>(0.0));
}

// The image's colour: haze over the distance from the eye, exposure, highlights rolled off. Linear; the sRGB curve is
// the image format's.
fn finish(light: vec3<f32>, world: vec3<f32>, eye: u32) -> vec4<f32> {
    let away = world - view.eyes[eye].xyz;
    let far = length(away);
    let clear = exp(-far * view.sky_horizon.w * view.eyes[eye].w);
    let behind = sky_color(vec3<f32>(away.x, max(away.y, 0.0), away.z) / max(far, 1.0e-3));
    return vec4<f32>(tone(mix(behind, light, clear) * view.ground_bounce.w), 1.0);
}

// Straight up to the shoulder, then bent so that 1 is reached at infinity: middle tones keep their colours.
fn tone(light: vec3<f32>) -> vec3<f32> {
    if all(light <= vec3<f32>(SHOULDER)) {
        return light;
    }
    let over = max(light - SHOULDER, vec3<f32>(0.0));
    return min(light, vec3<f32>(SHOULDER)) + (1.0 - SHOULDER) * (1.0 - exp(-over / (1.0 - SHOULDER)));
}
