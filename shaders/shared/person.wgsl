// How people are drawn near by: which of their vertices are whose, what fades and what is glass, how much of the sky reaches them.
// Needs the bindings view, bucket_start, mesh_table and mesh_vertices, and the immediate `bucket`.

// First skinned vertex of the bucket's instance: near agents of earlier avatars come first.
fn near_vertex(instance: u32) -> u32 {
    var base = instance * mesh_table[bucket].vertex_count;
    for (var earlier = 0u; earlier < bucket; earlier += view.level_count) {
        base += (bucket_start[earlier + 1u] - bucket_start[earlier]) * mesh_table[earlier].vertex_count;
    }
    return base;
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

// Of a material (the lowest eight of its bits), how soft the edge between light and shade is, and its sheen. Skin lets light
// round, cloth and hair catch it with their fibres; shoes and eyes do neither.
fn softness(bits: u32) -> vec2<f32> {
    let material = bits & 255u;
    if material == MATERIAL_SKIN {
        return vec2<f32>(0.5, 0.3);
    }
    if material > MATERIAL_SKIN && material <= MATERIAL_BOTTOM {
        return vec2<f32>(0.3, 0.7);
    }
    return vec2<f32>(0.15, 0.15);
}
