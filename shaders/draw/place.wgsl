// uses: view, light, fine, textured
// A place of the user's own: triangles in world space with the materials of glTF 2.0 (section 3.9) and its textures.
// What is solid is seen from its front. What is open has two sides or holes: alpha below the material's cutoff is a hole.
// Derivatives are taken first: fragments beside a hole still know how fast their textures pass.

@group(0) @binding(3) var<storage, read> place_corners: array<PlaceCorner>; // [vertex]
@group(0) @binding(4) var<storage, read> matters: array<TexturedMatter>;    // [material]
@group(0) @binding(5) var color_layers: texture_2d_array<f32>;              // colours; alpha
@group(0) @binding(6) var map_layers: texture_2d_array<f32>;                // normals; occlusion, roughness, metal
@group(0) @binding(7) var layer_sampler: sampler;

struct PlaceCorner {
    place_and_u: vec4<f32>,      // m; place on the textures
    normal_and_v: vec4<f32>,     // unit
    color_and_matter: vec4<f32>, // linear base colour, before textures; number of the material
}

struct PlaceVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec3<f32>,
    @location(3) uv: vec2<f32>,
    @location(4) @interpolate(flat) matter: u32,
}

fn uv_of(corner: PlaceCorner) -> vec2<f32> {
    return vec2<f32>(corner.place_and_u.w, corner.normal_and_v.w);
}

@vertex
fn place_vertex(@builtin(vertex_index) vertex: u32, @builtin(view_index) eye: u32) -> PlaceVertex {
    let corner = place_corners[vertex];
    let place = corner.place_and_u.xyz;
    return PlaceVertex(
        view.clip_from_world[eye] * vec4<f32>(place, 1.0),
        place,
        corner.normal_and_v.xyz,
        corner.color_and_matter.rgb,
        uv_of(corner),
        u32(corner.color_and_matter.w),
    );
}

fn place_matter(in: PlaceVertex, front: bool, slopes: Slopes, base: vec4<f32>) -> Matter {
    return textured(matters[in.matter], normalize(select(-in.normal, in.normal, front)), in.uv, slopes, base.rgb);
}

fn low_color(in: PlaceVertex, front: bool, base: vec4<f32>, eye: u32) -> vec4<f32> {
    let normal = normalize(select(-in.normal, in.normal, front));
    let light = shade(in.world, normal, base.rgb) + matters[in.matter].glow.rgb;
    return finish(light, in.world, eye);
}

fn fine_color(in: PlaceVertex, front: bool, slopes: Slopes, base: vec4<f32>, eye: u32) -> vec4<f32> {
    let toward = toward_eye(in.world, eye);
    let light = illuminate(in.world, toward.xyz, place_matter(in, front, slopes, base)) + matters[in.matter].glow.rgb;
    return finish_fine(light, toward, eye);
}

@fragment
fn place_fragment(in: PlaceVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let slopes = slopes_of(in.uv, in.world);
    let base = base_of(matters[in.matter], vec4<f32>(in.color, 1.0), in.uv, slopes);
    return low_color(in, true, base, eye);
}

@fragment
fn place_open_fragment(in: PlaceVertex, @builtin(front_facing) front: bool, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let slopes = slopes_of(in.uv, in.world);
    let base = base_of(matters[in.matter], vec4<f32>(in.color, 1.0), in.uv, slopes);
    if base.a < matters[in.matter].cutoff {
        discard;
    }
    return low_color(in, front, base, eye);
}

@fragment
fn place_fine_fragment(in: PlaceVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let slopes = slopes_of(in.uv, in.world);
    let base = base_of(matters[in.matter], vec4<f32>(in.color, 1.0), in.uv, slopes);
    return fine_color(in, true, slopes, base, eye);
}

@fragment
fn place_open_fine_fragment(
    in: PlaceVertex, @builtin(front_facing) front: bool, @builtin(view_index) eye: u32,
) -> @location(0) vec4<f32> {
    let slopes = slopes_of(in.uv, in.world);
    let base = base_of(matters[in.matter], vec4<f32>(in.color, 1.0), in.uv, slopes);
    if base.a < matters[in.matter].cutoff {
        discard;
    }
    return fine_color(in, front, slopes, base, eye);
}

@vertex
fn place_shadow(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    return view.shadow_from_world * vec4<f32>(place_corners[vertex].place_and_u.xyz, 1.0);
}

struct OpenShadow {
    @builtin(position) clip: vec4<f32>,
    @location(0) uv: vec2<f32>,
    @location(1) @interpolate(flat) matter: u32,
}

@vertex
fn place_open_shadow(@builtin(vertex_index) vertex: u32) -> OpenShadow {
    let corner = place_corners[vertex];
    let clip = view.shadow_from_world * vec4<f32>(corner.place_and_u.xyz, 1.0);
    return OpenShadow(clip, uv_of(corner), u32(corner.color_and_matter.w));
}

// Writes depth where there is no hole.
@fragment
fn place_hole(in: OpenShadow) {
    let slopes = slopes_of(in.uv, vec3<f32>(in.uv, 0.0));
    let matter = matters[in.matter];
    if base_of(matter, vec4<f32>(1.0), in.uv, slopes).a < matter.cutoff {
        discard;
    }
}
