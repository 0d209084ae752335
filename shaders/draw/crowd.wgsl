// uses: view, light, fine, tint, body, agent
// The crowd, straight from the buffers that the kernels wrote. One indirect draw per bucket (avatar and level of
// detail); the instance is the agent's place among the visible agents of the bucket.

@group(0) @binding(3) var<storage, read> visible: array<u32>;                       // agent of each slot, sorted by bucket
@group(0) @binding(4) var<storage, read> bucket_start: array<u32>;                  // first slot of each bucket
@group(0) @binding(5) var<storage, read> mesh_vertices: array<array<vec4<u32>, 4>>; // bits, see kernels `skin`
@group(0) @binding(6) var<storage, read> mesh_table: array<MeshRange>;              // [bucket]
@group(0) @binding(7) var<storage, read> palettes: array<array<vec4<f32>, 3>>;      // [slot][joint], rows of world_from_mesh
@group(0) @binding(8) var<storage, read> skinned: array<array<vec4<f32>, 2>>;       // near agents: world position, world normal
@group(0) @binding(9) var<storage, read> appearance: array<Appearance>;             // [agent]

// which bucket is drawn
var<immediate> bucket: u32;

struct Placed {
    world: vec3<f32>,
    normal: vec3<f32>,
}

// First skinned vertex of the bucket's instance: near agents of earlier avatars come first.
fn near_vertex(instance: u32) -> u32 {
    var base = instance * mesh_table[bucket].vertex_count;
    for (var earlier = 0u; earlier < bucket; earlier += view.level_count) {
        base += (bucket_start[earlier + 1u] - bucket_start[earlier]) * mesh_table[earlier].vertex_count;
    }
    return base;
}

fn place(vertex: u32, instance: u32) -> Placed {
    if bucket % view.level_count == 0u {
        let at = near_vertex(instance) + vertex - mesh_table[bucket].first_vertex; // the vertex index counts from the first mesh
        return Placed(skinned[at][0].xyz, skinned[at][1].xyz);
    }
    return pose(vertex, instance);
}

fn pose(vertex: u32, instance: u32) -> Placed {
    let slot = bucket_start[bucket] + instance;
    let position = vec4<f32>(bitcast<vec3<f32>>(mesh_vertices[vertex][0].xyz), 1.0);
    let normal = bitcast<vec3<f32>>(mesh_vertices[vertex][1].xyz);
    let joints = mesh_vertices[vertex][1].w;
    let weights = bitcast<vec4<f32>>(mesh_vertices[vertex][2]);
    var x = vec4<f32>(0.0);
    var y = vec4<f32>(0.0);
    var z = vec4<f32>(0.0);
    for (var i = 0u; i < 4u; i += 1u) {
        let joint = slot * SKIN_JOINTS + min((joints >> (8u * i)) & 0xffu, SKIN_JOINTS - 1u);
        x += palettes[joint][0] * weights[i];
        y += palettes[joint][1] * weights[i];
        z += palettes[joint][2] * weights[i];
    }
    return Placed(
        vec3<f32>(dot(x, position), dot(y, position), dot(z, position)),
        vec3<f32>(dot(x.xyz, normal), dot(y.xyz, normal), dot(z.xyz, normal)),
    );
}

// The vertex colour, tinted with the agent's colour of its material, and its alpha.
fn agent_color(vertex: u32, instance: u32) -> vec4<f32> {
    let color = bitcast<vec4<f32>>(mesh_vertices[vertex][3]);
    let colors = colors_of(appearance[visible[bucket_start[bucket] + instance]]);
    return vec4<f32>(tinted(color.rgb, mesh_vertices[vertex][0].w, colors), color.a);
}

struct CrowdVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec4<f32>,
}

@vertex
fn crowd_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
    @builtin(view_index) eye: u32,
) -> CrowdVertex {
    let placed = place(vertex, instance);
    let clip = view.clip_from_world[eye] * vec4<f32>(placed.world, 1.0);
    return CrowdVertex(clip, placed.world, placed.normal, agent_color(vertex, instance));
}

@fragment
fn crowd_fragment(in: CrowdVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    return finish(shade(in.world, normalize(in.normal), in.color.rgb), in.world, eye);
}

// Bodies nearer to an eye than this begin to dissolve, and are gone, m. So no body shows its inside.
const FADE_BEGINS: f32 = 0.6;
const FADE_ENDS: f32 = 0.22;

// Whether this place of a near body is left out. A screen door: the share of its cells that is open grows with nearness.
// Nearness is that to the nearer eye, and the cells are seen from between the eyes, so that both eyes miss the same places.
fn is_faded(world: vec3<f32>) -> bool {
    let near = min(distance(world, view.fade[0].xyz), distance(world, view.fade[1].xyz));
    let whole = (near - FADE_ENDS) / (FADE_BEGINS - FADE_ENDS);
    if whole >= 1.0 {
        return false;
    }
    let away = world - 0.5 * (view.fade[0].xyz + view.fade[1].xyz);
    let ahead = max(dot(away, view.fade[4].xyz), 1.0e-3);
    let cell = floor(vec2<f32>(dot(away, view.fade[2].xyz), dot(away, view.fade[3].xyz)) / ahead);
    let x = u32(i32(cell.x)) & 3u;
    let y = u32(i32(cell.y)) & 3u;
    // Bayer's order of four by four cells: their bits turned round and interleaved
    let other = x ^ y;
    let order = ((other & 1u) << 3u) | ((y & 1u) << 2u) | (other & 2u) | (y >> 1u);
    return whole <= (f32(order) + 0.5) / 16.0;
}

// Samples of a pixel that glass covers, as a share: what its alpha says, dithered over two by two pixels. The pipeline
// turns whole samples into coverage. Blending proper would need the surfaces of the whole crowd from back to front. This
// needs no order, so images do not depend on one, and depth stays true for later draws.
fn coverage(alpha: f32, place: vec4<f32>) -> f32 {
    let x = u32(place.x) & 1u;
    let y = u32(place.y) & 1u;
    let order = ((x ^ y) << 1u) | y; // Bayer's
    let samples = f32(view.samples);
    return min(floor(alpha * samples + (f32(order) + 0.5) * 0.25) / samples, 1.0);
}

// For the finest level only: a shader that may leave something out tests depth late.
@fragment
fn crowd_near_fragment(in: CrowdVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let cover = select(coverage(in.color.a, in.clip), 1.0, in.color.a >= 1.0);
    if cover <= 0.0 || is_faded(in.world) {
        discard;
    }
    return vec4<f32>(finish(shade(in.world, normalize(in.normal), in.color.rgb), in.world, eye).rgb, cover);
}

// Like CrowdVertex, and what the light of better quality asks for.
struct FineVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec4<f32>,
    @location(3) occlusion: f32,
    @location(4) @interpolate(flat) material: u32,
}

// Between these heights of the mesh, m, the legs part, and the light of the sky grows on the way up from the ground.
const LEGS_PART: f32 = 0.68;
const LEGS_JOIN: f32 = 0.86;
const ARMS_END: f32 = 1.4;
const OPEN_HEIGHT: f32 = 1.2;

// Share of the sky that reaches a place of a body at rest, which stands along +y and faces +z. Legs and arms shade one
// another where they face the middle of the body; what faces down sees the ground; people and ground stand around the legs.
fn body_occlusion(vertex: u32) -> f32 {
    let place = bitcast<vec3<f32>>(mesh_vertices[vertex][0].xyz);
    let normal = bitcast<vec3<f32>>(mesh_vertices[vertex][1].xyz);
    let inward = max(-normal.x * sign(place.x), 0.0) * (1.0 - step(ARMS_END, place.y));
    let between = inward * mix(0.6, 0.35, smoothstep(LEGS_PART, LEGS_JOIN, place.y));
    let below = 0.4 * max(-normal.y, 0.0);
    let low = 0.4 * (1.0 - smoothstep(0.0, OPEN_HEIGHT, place.y));
    return (1.0 - between) * (1.0 - below) * (1.0 - low);
}

@vertex
fn crowd_fine_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
    @builtin(view_index) eye: u32,
) -> FineVertex {
    let placed = place(vertex, instance);
    let clip = view.clip_from_world[eye] * vec4<f32>(placed.world, 1.0);
    let color = agent_color(vertex, instance);
    return FineVertex(clip, placed.world, placed.normal, color, body_occlusion(vertex), mesh_vertices[vertex][0].w);
}

// Skin lets light round, cloth and hair catch it with their fibres; shoes and eyes do neither.
fn body_matter(in: FineVertex) -> Matter {
    var soft = vec2<f32>(0.15, 0.15);
    if in.material == MATERIAL_SKIN {
        soft = vec2<f32>(0.5, 0.3);
    } else if in.material > MATERIAL_SKIN && in.material <= MATERIAL_BOTTOM {
        soft = vec2<f32>(0.3, 0.7);
    }
    return Matter(in.color.rgb, normalize(in.normal), in.occlusion, soft.x, soft.y, 0.0, 1.0);
}

@fragment
fn crowd_fine_fragment(in: FineVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let toward = toward_eye(in.world, eye);
    return finish_fine(illuminate(in.world, toward.xyz, body_matter(in)), toward, eye);
}

// For the finest level only.
@fragment
fn crowd_near_fine_fragment(in: FineVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    let cover = select(coverage(in.color.a, in.clip), 1.0, in.color.a >= 1.0);
    if cover <= 0.0 || is_faded(in.world) {
        discard;
    }
    let toward = toward_eye(in.world, eye);
    let image = finish_fine(illuminate(in.world, toward.xyz, body_matter(in)), toward, eye);
    return vec4<f32>(image.rgb, cover);
}

// Of a mesh one level coarser than the image's.
@vertex
fn crowd_shadow(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> @builtin(position) vec4<f32> {
    return view.shadow_from_world * vec4<f32>(pose(vertex, instance).world, 1.0);
}
