// uses: frame, exact, quaternion, body, rig, agent
// Forward kinematics of every visible agent, in the world, and from it the matrices that move a vertex from the rest
// pose into the world: world_from_joint * joint_from_mesh, three rows each. The agent's scale enters here.
// The toes follow from the feet: they go straight on, or from the ball of the foot half the way down to the ground, whichever
// is flatter. So they lie on it as long as the ball does, however high the heel is, and are not dragged when it has left.
@group(0) @binding(0) var<storage, read> visible: array<u32>;               // [visible] agents, then NONE
@group(0) @binding(1) var<storage, read> position: array<vec2<f32>>;        // [agent] m
@group(0) @binding(2) var<storage, read> stance: array<Stance>;             // [agent]
@group(0) @binding(3) var<storage, read> appearance: array<Appearance>;     // [agent]
@group(0) @binding(4) var<storage, read> rig: array<vec4<f32>>;             // [avatar][68]
@group(0) @binding(5) var<storage, read> local_rotations: array<vec4<f32>>; // [visible][17]
@group(0) @binding(6) var<storage, read_write> palettes: array<vec4<f32>>;  // [visible][21][3] rows

// The steepest foot by which toes are bent, as a sine.
const STEEPEST: f32 = 0.95;
// Share of the way down to the ground that toes reach.
const WAY_DOWN: f32 = 0.5;
// Shorter toes do not bend, m.
const LEAST_TOES: f32 = 0.001;

@compute @workgroup_size(64)
fn palette(@builtin(global_invocation_id) id: vec3<u32>) {
    // parents stand before their children; the root's entry is not used
    var parents = array<u32, 16>(0u, 0u, 1u, 2u, 1u, 4u, 5u, 1u, 7u, 8u, 0u, 10u, 11u, 0u, 13u, 14u);
    let slot = id.x;
    let agent = visible[slot];
    if agent == NONE {
        return;
    }
    let avatar = avatar_of(appearance[agent]);
    let scale = appearance[agent].scale;
    let at = position[agent];
    let heading = stance[agent].heading;

    var rotations = array<vec4<f32>, 16>(); // world_from_joint
    var origins = array<vec3<f32>, 16>();   // of the joints, world, m
    for (var joint = 0u; joint < JOINTS; joint++) {
        let local = local_rotations[slot * POSE_STRIDE + joint];
        if joint == 0u {
            let root = local_rotations[slot * POSE_STRIDE + JOINTS].xyz;
            rotations[0] = quat_before_yaw(heading, local);
            let turned = turn_left(exact_sin_cos(heading), root) * scale;
            origins[0] = vec3<f32>(at.x + turned.x, turned.y, at.y + turned.z);
        } else {
            let parent = parents[joint];
            let arm = quat_rotate(rotations[parent], joint_translation(avatar, joint));
            rotations[joint] = quat_mul(rotations[parent], local);
            origins[joint] = origins[parent] + arm * scale;
        }
        let q = rotations[joint];
        let o = origins[joint];
        let row_x = vec3<f32>(1.0 - 2.0 * (q.y * q.y + q.z * q.z), 2.0 * (q.x * q.y - q.z * q.w), 2.0 * (q.x * q.z + q.y * q.w)) * scale;
        let row_y = vec3<f32>(2.0 * (q.x * q.y + q.z * q.w), 1.0 - 2.0 * (q.x * q.x + q.z * q.z), 2.0 * (q.y * q.z - q.x * q.w)) * scale;
        let row_z = vec3<f32>(2.0 * (q.x * q.z - q.y * q.w), 2.0 * (q.y * q.z + q.x * q.w), 1.0 - 2.0 * (q.x * q.x + q.y * q.y)) * scale;
        let bind = avatar * RIG_STRIDE + joint * 4u + 1u;
        let bind_x = rig[bind];
        let bind_y = rig[bind + 1u];
        let bind_z = rig[bind + 2u];
        let out = slot * PALETTE_STRIDE + joint * 3u;
        let turned_x = bind_x * row_x.x + bind_y * row_x.y + bind_z * row_x.z;
        let turned_y = bind_x * row_y.x + bind_y * row_y.y + bind_z * row_y.z;
        let turned_z = bind_x * row_z.x + bind_y * row_z.y + bind_z * row_z.z;
        let rows = Rows(
            vec4<f32>(turned_x.xyz, turned_x.w + o.x),
            vec4<f32>(turned_y.xyz, turned_y.w + o.y),
            vec4<f32>(turned_z.xyz, turned_z.w + o.z),
        );
        write_rows(slot * PALETTE_STRIDE + joint * 3u, rows);
        if joint == LEFT_FOOT || joint == RIGHT_FOOT {
            let side = select(0u, 1u, joint == RIGHT_FOOT);
            let toes = bent_toes(rows, rig[avatar * RIG_STRIDE + RIG_BALLS + side], scale);
            write_rows(slot * PALETTE_STRIDE + (LEFT_TOES + side) * 3u, toes);
        }
    }
}

// world_from_mesh
struct Rows {
    x: vec4<f32>,
    y: vec4<f32>,
    z: vec4<f32>,
}

fn write_rows(at: u32, rows: Rows) {
    palettes[at] = rows.x;
    palettes[at + 1u] = rows.y;
    palettes[at + 2u] = rows.z;
}

// The toes' matrix: the foot's, after a turn of the toes upwards about the ball of the foot.
fn bent_toes(foot: Rows, ball: vec4<f32>, scale: f32) -> Rows {
    let height = dot3(foot.y.xyz, ball.xyz) + foot.y.w;
    // sines and cosines of how far foot and toes point down
    let foot_down = limit(-foot.y.z / scale, 0.0, STEEPEST);
    let toes_down = limit(WAY_DOWN * height / (max(ball.w, LEAST_TOES) * scale), 0.0, foot_down);
    let foot_ahead = sqrt(1.0 - foot_down * foot_down);
    let toes_ahead = sqrt(1.0 - toes_down * toes_down);
    let up = foot_down * toes_ahead - foot_ahead * toes_down;
    let along = foot_ahead * toes_ahead + foot_down * toes_down;
    return Rows(bent(foot.x, ball.xyz, up, along), bent(foot.y, ball.xyz, up, along), bent(foot.z, ball.xyz, up, along));
}

fn bent(row: vec4<f32>, ball: vec3<f32>, up: f32, along: f32) -> vec4<f32> {
    let y = row.y * along - row.z * up;
    let z = row.y * up + row.z * along;
    return vec4<f32>(row.x, y, z, row.w + ((row.y - y) * ball.y + (row.z - z) * ball.z));
}
