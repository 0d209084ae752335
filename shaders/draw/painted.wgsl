// uses: view, light, fine, person, textured, tint, body, normal, agent
// The finest level of loaded characters that have textures, looked up at every pixel. Coarser levels have the colours of their
// vertices, as the shader `crowd` draws them.

@group(0) @binding(3) var<storage, read> visible: array<u32>;                       // agent of each slot, sorted by bucket
@group(0) @binding(4) var<storage, read> bucket_start: array<u32>;                  // first slot of each bucket
@group(0) @binding(5) var<storage, read> mesh_vertices: array<array<vec4<u32>, 4>>; // bits, see kernels `skin`
@group(0) @binding(6) var<storage, read> mesh_table: array<MeshRange>;              // [bucket]
@group(0) @binding(7) var<storage, read> skinned: array<vec4<u32>>;                 // near agents, see kernel `skin`
@group(0) @binding(8) var<storage, read> appearance: array<Appearance>;             // [agent]
@group(0) @binding(9) var<storage, read> painted_corners: array<PaintedCorner>;     // [vertex], as mesh_vertices
@group(0) @binding(10) var<storage, read> matters: array<TexturedMatter>;           // [material]
@group(0) @binding(11) var color_layers: texture_2d_array<f32>;                     // colours; alpha
@group(0) @binding(12) var map_layers: texture_2d_array<f32>;                       // normals; occlusion, roughness, metal
@group(0) @binding(13) var layer_sampler: sampler;

// which bucket is drawn
var<immediate> bucket: u32;

struct PaintedCorner {
    color: vec4<f32>, // linear base colour and alpha, before textures
    uv: vec2<f32>,    // place on the textures
    matter: u32,      // number of the material
    unused: u32,
}

struct PaintedVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec4<f32>,
    @location(3) uv: vec2<f32>,
    @location(4) occlusion: f32,
    @location(5) @interpolate(flat) material: u32,
    @location(6) @interpolate(flat) matter: u32,
}

@vertex
fn painted_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
    @builtin(view_index) eye: u32,
) -> PaintedVertex {
    let at = near_vertex(instance) + vertex - mesh_table[bucket].first_vertex; // the vertex index counts from the first mesh
    let world = bitcast<vec3<f32>>(skinned[at].xyz);
    let corner = painted_corners[vertex];
    let material = mesh_vertices[vertex][0].w;
    let colors = colors_of(appearance[visible[bucket_start[bucket] + instance]]);
    let color = vec4<f32>(tinted(corner.color.rgb, material, colors), corner.color.a);
    let clip = view.clip_from_world[eye] * vec4<f32>(world, 1.0);
    let normal = normalize(unpacked_normal(skinned[at].w));
    return PaintedVertex(clip, world, normal, color, corner.uv, body_occlusion(vertex), material, corner.matter);
}

// Base colour with its texture, and the share of the pixel that is covered: 0 of holes, backs of what has one side, and what
// is too near.
fn covering(in: PaintedVertex, front: bool, slopes: Slopes) -> vec4<f32> {
    let matter = matters[in.matter];
    let base = base_of(matter, in.color, in.uv, slopes);
    let is_hole = base.a < matter.cutoff;
    let is_back = !front && matter.is_two_sided == 0u;
    if is_hole || is_back || is_faded(in.world) {
        return vec4<f32>(base.rgb, 0.0);
    }
    return vec4<f32>(base.rgb, select(1.0, coverage(base.a, in.clip), matter.is_blended == 1u && base.a < 1.0));
}

@fragment
fn painted_fragment(in: PaintedVertex, @builtin(front_facing) front: bool, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let slopes = slopes_of(in.uv, in.world);
    let base = covering(in, front, slopes);
    if base.a <= 0.0 {
        discard;
    }
    let normal = normalize(select(-in.normal, in.normal, front));
    let light = shade(in.world, normal, base.rgb) + matters[in.matter].glow.rgb;
    return vec4<f32>(finish(light, in.world, eye).rgb, base.a);
}

@fragment
fn painted_fine_fragment(
    in: PaintedVertex, @builtin(front_facing) front: bool, @builtin(view_index) eye: u32,
) -> @location(0) vec4<f32> {
    let slopes = slopes_of(in.uv, in.world);
    let base = covering(in, front, slopes);
    if base.a <= 0.0 {
        discard;
    }
    let normal = normalize(select(-in.normal, in.normal, front));
    var matter = textured(matters[in.matter], normal, in.uv, slopes, base.rgb);
    let soft = softness(in.material);
    matter.occlusion *= in.occlusion;
    matter.wrap = soft.x;
    matter.sheen = soft.y;
    let toward = toward_eye(in.world, eye);
    let light = illuminate(in.world, toward.xyz, matter) + matters[in.matter].glow.rgb;
    return vec4<f32>(finish_fine(light, toward, eye).rgb, base.a);
}
