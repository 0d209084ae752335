// Parameters of one frame for the draw shaders; the Rust twin is kernels::layout::ViewUniforms. World frame, y up,
// metres, linear colours.
struct ViewUniforms {
    clip_from_world: array<mat4x4<f32>, 2>, // per eye; depth 1 near, 0 far
    world_from_clip: array<mat4x4<f32>, 2>,
    eyes: array<vec4<f32>, 2>,              // xyz: position of each eye; w: 1 with haze, 0 in a parallel projection
    shadow_from_world: mat4x4<f32>,         // clip space of the shadow map; depth 1 towards the sun
    near_shadow: vec4<f32>,                 // finer map: xy: its middle in that space; z: times as fine, 0: none; w: share of the image a map has
    sun_direction: vec4<f32>,               // xyz: unit, towards the sun; w: side of a shadow texel, m
    sun_color: vec4<f32>,                   // rgb: light on a surface that faces the sun; w: size of a shadow texel, 0 to 1
    sky_zenith: vec4<f32>,                  // rgb
    sky_light: vec4<f32>,                   // rgb: light of the sky on a surface that faces up
    sky_horizon: vec4<f32>,                 // rgb; w: haze, 1/m
    ground_bounce: vec4<f32>,               // rgb: light from below; w: exposure
    emotion_colors: array<vec4<f32>, 4>,    // rgb per emotion; w: opacity
    fade: array<vec4<f32>, 5>,              // near bodies: both eyes; right, down, ahead between them, the first two in cells
    level_count: u32,
    bucket_count: u32,
    marker_radius: f32,                     // of the ring under an agent, m
    marker_width: f32,                      // of the ring's line, m
    far_count: u32,                         // buckets of far bodies
    samples: u32,                           // a pixel
    quality: u32,                           // 0 low, 1 medium, 2 high
    pixel: f32,                             // side of a pixel 1 m away; of a parallel projection at any distance, m
}
