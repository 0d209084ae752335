// uses: view, light, fine, person, tint, outfit, tailored, body, normal, agent
// The crowd, straight from the buffers that the kernels wrote. One indirect draw per bucket (avatar and level of
// detail); the instance is the agent's place among the visible agents of the bucket.

@group(0) @binding(3) var<storage, read> visible: array<u32>;                       // agent of each slot, sorted by bucket
@group(0) @binding(4) var<storage, read> bucket_start: array<u32>;                  // first slot of each bucket
@group(0) @binding(5) var<storage, read> mesh_vertices: array<array<vec4<u32>, 4>>; // bits, see kernels `skin`
@group(0) @binding(6) var<storage, read> mesh_table: array<MeshRange>;              // [bucket]
@group(0) @binding(7) var<storage, read> palettes: array<array<vec4<f32>, 3>>;      // [slot][joint], rows of world_from_mesh
@group(0) @binding(8) var<storage, read> skinned: array<vec4<u32>>;                 // near agents, see kernel `skin`
@group(0) @binding(9) var<storage, read> appearance: array<Appearance>;             // [agent]
@group(0) @binding(10) var<storage, read> outfits: array<Outfit>;                   // [agent]
@group(0) @binding(11) var<storage, read> tailoring: array<u32>;                    // [vertex], as mesh_vertices

// which bucket is drawn
var<immediate> bucket: u32;

struct Placed {
    world: vec3<f32>,
    normal: vec3<f32>,
}

fn place(vertex: u32, instance: u32) -> Placed {
    if bucket % view.level_count == 0u {
        let at = near_vertex(instance) + vertex - mesh_table[bucket].first_vertex; // the vertex index counts from the first mesh
        return Placed(bitcast<vec3<f32>>(skinned[at].xyz), normalize(unpacked_normal(skinned[at].w)));
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

fn agent_of(instance: u32) -> u32 {
    return visible[bucket_start[bucket] + instance];
}

// The vertex colour as the agent's outfit and colours have it, and its alpha.
fn agent_color(vertex: u32, agent: u32, own: Outfit) -> vec4<f32> {
    let color = bitcast<vec4<f32>>(mesh_vertices[vertex][3]);
    let colors = colors_of(appearance[agent]);
    return vec4<f32>(clothed(color.rgb, mesh_vertices[vertex][0].w, own, tailoring_of(vertex), colors), color.a);
}

// Where the outfit has a vertex, world, m.
fn grown(placed: Placed, own: Outfit, tailored: u32) -> vec3<f32> {
    return placed.world + placed.normal * growth_of(own, tailored);
}

// All corners of what is not worn are in one point, in clip space, and have no area. Such a vertex needs nothing else: of a body's
// vertices about half are not worn.
const NOWHERE = vec4<f32>(0.0, 0.0, 0.0, 1.0);

// At the middle of a pixel that a thin triangle covers beside it, its colours and normals would lie far outside of it.
struct CrowdVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) @interpolate(perspective, centroid) normal: vec3<f32>,
    @location(2) @interpolate(perspective, centroid) color: vec4<f32>,
}

@vertex
fn crowd_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
    @builtin(view_index) eye: u32,
) -> CrowdVertex {
    let agent = agent_of(instance);
    let own = outfit_of(agent);
    let tailored = tailoring_of(vertex);
    if is_left_out(own, tailored) {
        var none = CrowdVertex();
        none.clip = NOWHERE;
        return none;
    }
    let placed = place(vertex, instance);
    let world = grown(placed, own, tailored);
    let clip = view.clip_from_world[eye] * vec4<f32>(world, 1.0);
    return CrowdVertex(clip, world, placed.normal, agent_color(vertex, agent, own));
}

@fragment
fn crowd_fragment(in: CrowdVertex, @builtin(view_index) eye: u32) -> @location(0) vec4<f32> {
    return finish(shade(in.world, normalize(in.normal), in.color.rgb), in.world, eye);
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
    @location(1) @interpolate(perspective, centroid) normal: vec3<f32>,
    @location(2) @interpolate(perspective, centroid) color: vec4<f32>,
    @location(3) @interpolate(perspective, centroid) occlusion: f32,
    @location(4) @interpolate(perspective, centroid) rest: vec3<f32>, // place on the body at rest, m
    @location(5) @interpolate(flat) material: u32,
    @location(6) @interpolate(flat) tailored: u32,
    @location(7) @interpolate(flat) agent: u32,
}

@vertex
fn crowd_fine_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
    @builtin(view_index) eye: u32,
) -> FineVertex {
    let agent = agent_of(instance);
    let own = outfit_of(agent);
    let tailored = tailoring_of(vertex);
    if is_left_out(own, tailored) {
        var none = FineVertex();
        none.clip = NOWHERE;
        return none;
    }
    let placed = place(vertex, instance);
    let world = grown(placed, own, tailored);
    return FineVertex(
        view.clip_from_world[eye] * vec4<f32>(world, 1.0),
        world,
        placed.normal,
        agent_color(vertex, agent, own),
        body_occlusion(vertex),
        bitcast<vec3<f32>>(mesh_vertices[vertex][0].xyz),
        mesh_vertices[vertex][0].w,
        tailored,
        agent,
    );
}

fn body_matter(in: FineVertex) -> Matter {
    let soft = softness(in.material);
    let blur = 0.5 * length(fwidth(in.rest));
    let colors = colors_of(appearance[in.agent]);
    let albedo = patterned(in.color.rgb, in.rest, outfit_of(in.agent), in.tailored, colors, blur);
    return Matter(albedo, normalize(in.normal), in.occlusion, soft.x, soft.y, 0.0, 1.0);
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
    if is_left_out(outfit_of(agent_of(instance)), tailoring_of(vertex)) {
        return NOWHERE;
    }
    return view.shadow_from_world * vec4<f32>(pose(vertex, instance).world, 1.0);
}

// Near the eye, of the image's own mesh: a coarser one would shade it where they differ.
@vertex
fn crowd_near_shadow(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> @builtin(position) vec4<f32> {
    let own = outfit_of(agent_of(instance));
    let tailored = tailoring_of(vertex);
    if is_left_out(own, tailored) {
        return NOWHERE;
    }
    return view.shadow_from_world * vec4<f32>(grown(place(vertex, instance), own, tailored), 1.0);
}
