// uses: view, light, fine, detail
// The sky behind everything: one triangle over the whole image, infinitely far.

struct SkyVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) ndc: vec2<f32>,
}

@vertex
fn sky_vertex(@builtin(vertex_index) vertex: u32) -> SkyVertex {
    // (-1, -1), (3, -1), (-1, 3)
    let ndc = vec2<f32>(f32((vertex << 1u) & 2u), f32(vertex & 2u)) * 2.0 - 1.0;
    return SkyVertex(vec4<f32>(ndc, 0.0, 1.0), ndc);
}

fn direction_of(ndc: vec2<f32>, eye: u32) -> vec3<f32> {
    let near = view.world_from_clip[eye] * vec4<f32>(ndc, 1.0, 1.0);
    let far = view.world_from_clip[eye] * vec4<f32>(ndc, 0.0, 1.0); // w is 0 when infinitely far
    return normalize(far.xyz * near.w - near.xyz * far.w);
}

// Light of the sky in a direction, with the sun.
fn clear_sky(direction: vec3<f32>) -> vec3<f32> {
    var light = sky_color(direction);
    if dot(direction, view.sun_direction.xyz) > SUN_DISC {
        light += view.sun_color.rgb;
    }
    return light;
}

@fragment
fn sky_fragment(in: SkyVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    return vec4<f32>(tone(clear_sky(direction_of(in.ndc, eye)) * view.ground_bounce.w), 1.0);
}

const CLOUD_BEND: f32 = 0.13;   // how much the layer of clouds bends down at the horizon
const CLOUD_SCALE: f32 = 1.1;   // clouds overhead, per radian
const CLOUD_LOW: f32 = 0.02;    // noise at which clouds begin and are whole
const CLOUD_HIGH: f32 = 0.5;
const CLOUD_SHADE: f32 = 0.275; // how much darker their side away from the sun is, of their slope
const CLOUD_MIDDLE: f32 = 0.6;  // share of the middle octave's slope that counts

// Noise of three octaves, and the slope of the broader two, y and z. The middle one is steep over less than the way that light
// goes through a cloud, and counts for part of its slope.
fn cloud_noise(at: vec2<f32>) -> vec3<f32> {
    let broad = 0.6 * value_noise(at);
    let middle = 0.28 * value_noise(at * 2.3 + 7.1);
    let fine = 0.12 * value_noise(at * 5.1 - 3.7).x;
    return vec3<f32>(broad.x + middle.x + fine, broad.yz + middle.yz * (2.3 * CLOUD_MIDDLE));
}

// Fair-weather clouds on a layer that bends down to the horizon, where haze takes them.
fn with_clouds(light: vec3<f32>, direction: vec3<f32>) -> vec3<f32> {
    let up = max(direction.y, 0.0);
    let at = direction.xz * (CLOUD_SCALE / (up + CLOUD_BEND)) + 3.3;
    let noise = cloud_noise(at);
    let cover = smoothstep(CLOUD_LOW, CLOUD_HIGH, noise.x) * smoothstep(0.03, 0.3, up);
    let rise = dot(noise.yz, view.sun_direction.xz); // towards the sun: this side is the darker one
    let shade = clamp(0.5 - CLOUD_SHADE * rise, 0.0, 1.0);
    let color = mix(0.55 * view.sky_horizon.rgb + 0.25 * view.sky_light.rgb, 0.85 * view.sun_color.rgb + 0.1, shade);
    return mix(light, color, 0.8 * cover);
}

@fragment
fn sky_fine_fragment(in: SkyVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let direction = direction_of(in.ndc, eye);
    return vec4<f32>(film(with_clouds(clear_sky(direction), direction) * view.ground_bounce.w), 1.0);
}
