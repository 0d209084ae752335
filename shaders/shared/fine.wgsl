// uses: view, light
// Light at medium and high quality: what low quality has, and soft skin and cloth, a mirrored sky, occlusion, a filmic curve.

const HIGH: u32 = 2u;                // as view.quality says it
const SOFT_EDGE: f32 = 0.55;         // how much of the light at the edge of shadow a body lets round, of a wrap of 1
const SHEEN: f32 = 0.5;              // light of the sky on fibres that are seen edge on, of a sheen of 1
const GLINT: f32 = 3.0;              // the sun in a mirror, of its light on what faces it
const NEAR_EDGE: f32 = 8.0;          // the finer shadows near the eye pass into the others over the outermost 1/8 of their map
const OUTER_SQUARE = vec2<f32>(1.9, 2.6); // the wider square of samples at high quality, texels
const OUTER_LIFT: f32 = 1.9;         // places are moved off their surface so many times as far for it: as its reach

// A place of a surface.
struct Matter {
    albedo: vec3<f32>,    // linear; what is above 1 glows
    normal: vec3<f32>,
    occlusion: f32,       // share of the sky that reaches it
    wrap: f32,            // how soft the edge between light and shade is, 0 to 1
    sheen: f32,           // of fibres and down, 0 to 1
    gloss: f32,           // share of the light that it mirrors face on; 0: none at any angle
    lift: f32,            // 1 of what casts shadows, 0 of what casts none
}

// A matt surface.
fn matt(albedo: vec3<f32>, normal: vec3<f32>) -> Matter {
    return Matter(albedo, normal, 1.0, 0.0, 0.0, 0.0, 1.0);
}

// Share of the sun's light in a place of a map; at high quality with a wider edge.
fn soft_samples(map: f32, place: vec2<f32>, depth: f32) -> f32 {
    let inner = sun_samples(map, place, depth, SQUARE);
    if view.quality < HIGH {
        return inner;
    }
    return 0.5 * (inner + sun_samples(map, place, depth, OUTER_SQUARE));
}

// 1 in the sun, 0 in the shadow: by the finer map near the eye, as far as that reaches.
fn soft_sunlight(world: vec3<f32>, normal: vec3<f32>, lift: f32) -> f32 {
    let off = lift_off(normal) * (lift * select(1.0, OUTER_LIFT, view.quality >= HIGH));
    let finer = view.near_shadow.z;
    var near = 0.0;
    var close = 0.0;
    if finer > 0.0 {
        let clip = to_shadow(world + off / finer);
        let place = (clip.xy - view.near_shadow.xy) * finer;
        near = clamp(within(place, NEAR_EDGE), 0.0, 1.0);
        if near > 0.0 {
            close = soft_samples(NEAR_MAP, place, clip.z);
        }
    }
    if near >= 1.0 {
        return close;
    }
    let clip = to_shadow(world + off);
    let left = clamp(within(clip.xy, SHADOW_EDGE), 0.0, 1.0);
    var far = 1.0;
    if left > 0.0 {
        far = mix(1.0, soft_samples(WHOLE_MAP, clip.xy, clip.z), left);
    }
    return mix(far, close, near);
}

// Share of the light that a surface mirrors, by the cosine of the angle to its normal (Schlick 1994). What mirrors little face
// on is rough, and is no mirror at a flat angle either.
fn fresnel(gloss: f32, cosine: f32) -> f32 {
    let away = 1.0 - cosine;
    let away2 = away * away;
    return gloss + (min(10.0 * gloss, 1.0) - gloss) * away2 * away2 * away;
}

// Light that a place sends to the eye, before haze and tone. `to_eye` is a unit vector.
fn illuminate(world: vec3<f32>, to_eye: vec3<f32>, matter: Matter) -> vec3<f32> {
    let normal = matter.normal;
    let facing = dot(normal, view.sun_direction.xyz);
    var sun = 0.0;
    var shadow = 0.0;
    if facing > 0.0 {
        shadow = soft_sunlight(world, normal, matter.lift);
        sun = facing * shadow;
    }
    // what the edge of shade has more of than a hard body; no shadow map knows of it
    if matter.wrap > 0.0 {
        let wrapped = max(facing + matter.wrap, 0.0) / (1.0 + matter.wrap);
        sun += SOFT_EDGE * max(wrapped - max(facing, 0.0), 0.0) * matter.wrap;
    }
    let up = 0.5 + 0.5 * normal.y;
    let scattered = view.sun_color.rgb * (SCATTER * (0.5 + 0.5 * facing));
    let ambient = scattered + mix(view.ground_bounce.rgb, view.sky_light.rgb, up);
    let albedo = min(matter.albedo, vec3<f32>(1.0));
    // bright surfaces light their own corners (Jimenez et al. 2016, here with one term)
    let open = vec3<f32>(matter.occlusion) / (vec3<f32>(1.0) - albedo * (1.0 - matter.occlusion));
    var light = albedo * (view.sun_color.rgb * sun + ambient * open);
    let cosine = clamp(dot(normal, to_eye), 0.0, 1.0);
    if matter.sheen > 0.0 {
        let edge = 1.0 - cosine;
        let fibres = matter.sheen * SHEEN * edge * edge * edge * matter.occlusion;
        light += fibres * (0.3 + 0.7 * albedo) * (view.sky_light.rgb + view.sun_color.rgb * (0.4 * sun));
    }
    if matter.gloss > 0.0 {
        let ray = reflect(-to_eye, normal);
        let toward = max(dot(ray, view.sun_direction.xyz), 0.0);
        let near = toward * toward;
        let near4 = near * near;
        let near32 = near4 * near4 * near4 * near4;
        let mirrored = sky_color(ray) + view.sun_color.rgb * (GLINT * shadow * near32 * near32 * near32);
        light = mix(light, mirrored * matter.occlusion, fresnel(matter.gloss, cosine));
    }
    return light + max(matter.albedo - 1.0, vec3<f32>(0.0));
}

fn is_parallel(eye: u32) -> bool {
    return view.eyes[eye].w == 0.0;
}

// From a place to the eye: a unit vector, and the distance, m.
fn toward_eye(world: vec3<f32>, eye: u32) -> vec4<f32> {
    let way = view.eyes[eye].xyz - world;
    let far = max(length(way), 1.0e-3);
    if is_parallel(eye) {
        // depth grows towards the eye
        let matrix = view.clip_from_world[eye];
        return vec4<f32>(normalize(vec3<f32>(matrix[0].z, matrix[1].z, matrix[2].z)), far);
    }
    return vec4<f32>(way / far, far);
}

// The image's colour, as `finish` of low quality, by another curve.
fn finish_fine(light: vec3<f32>, toward: vec4<f32>, eye: u32) -> vec4<f32> {
    let clear = exp(-toward.w * view.sky_horizon.w * view.eyes[eye].w);
    let behind = sky_color(vec3<f32>(-toward.x, max(-toward.y, 0.0), -toward.z));
    return vec4<f32>(film(mix(behind, light, clear) * view.ground_bounce.w), 1.0);
}

// A curve of the film's kind, x^a / (b x^a + c), through a middle grey of 0.18 and to white at 2 (Lottes 2016). It bends the
// brightest channel alone, so that hues stay; what comes near white loses its colour last.
// a is 1.25: two roots take a fraction of the time of a power.
const WHITE_SLOPE: f32 = 0.76379;
const GREY_SLOPE: f32 = 0.56181;

fn film(light: vec3<f32>) -> vec3<f32> {
    let peak = max(max(light.r, max(light.g, light.b)), 1.0e-4);
    let raised = peak * sqrt(sqrt(peak));
    let bent = min(raised / (WHITE_SLOPE * raised + GREY_SLOPE), 1.0);
    let pale = smoothstep(0.65, 1.0, bent);
    return mix(light / peak, vec3<f32>(1.0), 0.3 * pale) * bent;
}
