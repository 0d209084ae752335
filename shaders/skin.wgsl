// uses: frame, quaternion, body, normal
// Linear blend skinning of the visible agents at level of detail 0, one `avatar` a dispatch, into
// world space. x is the vertex of the mesh, y the agent within its bucket (dispatch_args says how many of each).
// Where an agent's vertices begin: those of avatar a stand behind all those of the avatars before it, so agent n of
// avatar a begins at vertex sum over b < a of (near agents of b * vertices of b) + n * vertices of a. `skinned` must
// hold near_capacity times the largest level-0 vertex count.
// Vertices of face and hands first go where an expression moves them. Normals of a face stay: it moves by millimetres.
@group(0) @binding(0) var<uniform> frame: FrameUniforms;
@group(0) @binding(1) var<storage, read> bucket_start: array<u32>;        // [bucket + 1]
@group(0) @binding(2) var<storage, read> mesh_table: array<MeshRange>;    // [bucket]
@group(0) @binding(3) var<storage, read> mesh_vertices: array<vec4<f32>>; // [vertex][4]
@group(0) @binding(4) var<storage, read> palettes: array<vec4<f32>>;      // [visible][22][3] rows
@group(0) @binding(5) var<storage, read> face_moves: array<vec4<f32>>;    // [face vertex][9] m
@group(0) @binding(6) var<storage, read> expressions: array<Expression>;  // [visible]
@group(0) @binding(7) var<storage, read_write> skinned: array<vec4<u32>>; // [near vertex] world: bits of the position, m; packed normal
var<immediate> avatar: u32;

fn row_at(row: vec4<f32>, p: vec3<f32>) -> f32 {
    return row.x * p.x + row.y * p.y + row.z * p.z + row.w;
}

// One of the four joints of a vertex.
fn skin_joint(joints: u32, which: u32) -> u32 {
    return min((joints >> (8u * which)) & 0xffu, SKIN_JOINTS - 1u);
}

// world_from_mesh
struct Rows {
    x: vec4<f32>,
    y: vec4<f32>,
    z: vec4<f32>,
}

fn rows_of(at: u32) -> Rows {
    let x = palettes[at];
    let y = palettes[at + 1u];
    let z = palettes[at + 2u];
    return Rows(x, y, z);
}

// How far a vertex of face or hands is from its place at rest, m; `first` is where it stands in face_moves.
fn moved(first: u32, face: Expression) -> vec3<f32> {
    let corner = select(CORNERS_DOWN, CORNERS_UP, face.mouth_corner > 0.0);
    let mouth = select(PRESSED, OPENED, face.mouth_open > 0.0);
    let brow = face_moves[first + INNER_BROW].xyz * face.inner_brow + face_moves[first + OUTER_BROW].xyz * face.outer_brow;
    let lips = face_moves[first + corner].xyz * abs(face.mouth_corner) + face_moves[first + mouth].xyz * abs(face.mouth_open);
    let others = face_moves[first + FIST].xyz * face.fist + face_moves[first + EYES_SHUT].xyz * face.blink;
    return brow + lips + others;
}

@compute @workgroup_size(64)
fn skin(@builtin(global_invocation_id) id: vec3<u32>) {
    let bucket = avatar * frame.level_count;
    let mesh = mesh_table[bucket];
    let agents = bucket_start[bucket + 1u] - bucket_start[bucket];
    if id.x >= mesh.vertex_count || id.y >= agents {
        return;
    }
    var first = 0u;
    for (var before = 0u; before < bucket; before += frame.level_count) {
        first += (bucket_start[before + 1u] - bucket_start[before]) * mesh_table[before].vertex_count;
    }
    let source = (mesh.first_vertex + id.x) * VERTEX_STRIDE;
    let position_material = mesh_vertices[source];
    let normal_joints = mesh_vertices[source + 1u];
    let weights = mesh_vertices[source + 2u];
    let slot = bucket_start[bucket] + id.y;
    var vertex_position = position_material.xyz;
    var n = normal_joints.xyz;
    let of_face = bitcast<u32>(position_material.w) >> MATERIAL_BITS;
    if of_face > 0u {
        let face = expressions[slot];
        let moves = (of_face - 1u) * FACE_STRIDE;
        vertex_position = vertex_position + moved(moves, face);
        n = n + face_moves[moves + FIST_NORMAL].xyz * face.fist;
    }
    let joints = bitcast<u32>(normal_joints.w);
    let matrices = slot * PALETTE_STRIDE;
    let nearest = rows_of(matrices + skin_joint(joints, 0u) * 3u);
    var row_x = nearest.x * weights.x;
    var row_y = nearest.y * weights.x;
    var row_z = nearest.z * weights.x;
    for (var i = 1u; i < 4u; i++) {
        let weight = weights[i];
        if weight > 0.0 { // most vertices follow one joint or two
            let rows = rows_of(matrices + skin_joint(joints, i) * 3u);
            row_x = row_x + rows.x * weight;
            row_y = row_y + rows.y * weight;
            row_z = row_z + rows.z * weight;
        }
    }
    let normal = vec3<f32>(dot3(row_x.xyz, n), dot3(row_y.xyz, n), dot3(row_z.xyz, n));
    let position = vec3<f32>(row_at(row_x, vertex_position), row_at(row_y, vertex_position), row_at(row_z, vertex_position));
    skinned[first + id.y * mesh.vertex_count + id.x] = vec4<u32>(bitcast<vec3<u32>>(position), packed_normal(normal));
}
