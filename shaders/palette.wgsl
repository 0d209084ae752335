// uses: frame, exact, quaternion, body, rig, agent
// Forward kinematics of every visible agent, in the world, and from it the matrices that move a vertex from the rest
// pose into the world: world_from_joint * shape * joint_from_mesh, three rows each. The agent's scale and physique enter here:
// a part of the body is made broader, deeper or longer in the mesh before it is turned, so skinning costs what it did.
// The toes follow from the feet: they go straight on, or from the ball of the foot half the way down to the ground, whichever
// is flatter. So they lie on it as long as the ball does, however high the heel is, and are not dragged when it has left.
@group(0) @binding(0) var<storage, read> visible: array<u32>;               // [visible] agents, then NONE
@group(0) @binding(1) var<storage, read> position: array<vec2<f32>>;        // [agent] m
@group(0) @binding(2) var<storage, read> heading: array<f32>;               // [agent] rad
@group(0) @binding(3) var<storage, read> appearance: array<Appearance>;     // [agent]
@group(0) @binding(4) var<storage, read> physique: array<Physique>;         // [agent]
@group(0) @binding(5) var<storage, read> rig: array<vec4<f32>>;             // [avatar][100]
@group(0) @binding(6) var<storage, read> local_rotations: array<vec4<f32>>; // [visible][17]
@group(0) @binding(7) var<storage, read_write> palettes: array<vec4<f32>>;  // [visible][22][3] rows

// The steepest foot by which toes are bent, as a sine.
const STEEPEST: f32 = 0.95;
// Share of the way down to the ground that toes reach.
const WAY_DOWN: f32 = 0.5;
// Shorter toes do not bend, m.
const LEAST_TOES: f32 = 0.001;
// The back lies so far behind the joint of the waist, m: bellies grow to the front.
const BACK: f32 = 0.06;

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
    let faces = heading[agent];

    let own = physique[agent];
    let lengths = ratios_in(own.trunk_and_arms);
    let ends = ratios_in(own.head_and_shoulders);
    let tips = ratios_in(own.neck_and_hands);
    let arms = ratios_in(own.arms);
    let legs = ratios_in(own.legs);
    let hips = across(ratios_in(own.hips), lengths.x);
    let chest = across(ratios_in(own.chest), lengths.x);
    let waist = across(ratios_in(own.waist), lengths.x);
    let neck = vec3<f32>(tips.x, lengths.x, tips.x);
    let head = vec3<f32>(ends.x, ends.x, ends.x);
    let upper_arm = vec3<f32>(arms.x, lengths.y, arms.x);
    let forearm = vec3<f32>(arms.y, lengths.y, arms.y);
    let hand = vec3<f32>(tips.y, tips.y, tips.y);
    let thigh = vec3<f32>(legs.x, 1.0, legs.x);
    let calf = vec3<f32>(legs.y, 1.0, legs.y);
    let foot = vec3<f32>(1.0, 1.0, 1.0);
    // what each part of the body is multiplied by: of the trunk breadth, length and depth; of limbs girth, length, girth
    var shape = array<vec3<f32>, 16>(
        hips, chest, neck, head, upper_arm, forearm, hand, upper_arm, forearm, hand, thigh, calf, foot, thigh, calf, foot,
    );

    var rotations = array<vec4<f32>, 16>(); // world_from_joint
    var origins = array<vec3<f32>, 16>();   // of the joints, world, m
    var pelvis: Turned;                     // of the root
    var spine_left = vec3<f32>(0.0, 0.0, 0.0); // where the mesh's +x points at the spine, world, as long as the scale
    for (var joint = 0u; joint < JOINTS; joint++) {
        let local = local_rotations[slot * POSE_STRIDE + joint];
        let in_mesh = rig[avatar * RIG_STRIDE + RIG_PLACES + joint].xyz;
        if joint == ROOT {
            let root = local_rotations[slot * POSE_STRIDE + JOINTS].xyz;
            rotations[0] = quat_before_yaw(faces, local);
            let turned = turn_left(exact_sin_cos(faces), root) * scale;
            origins[0] = vec3<f32>(at.x + turned.x, turned.y, at.y + turned.z);
        } else {
            let parent = parents[joint];
            // legs begin where the gait has them
            let longer = select(shape[parent].y, 1.0, joint == LEFT_HIP || joint == RIGHT_HIP);
            let arm = quat_rotate(rotations[parent], joint_translation(avatar, joint)) * longer;
            rotations[joint] = quat_mul(rotations[parent], local);
            origins[joint] = origins[parent] + arm * scale;
            if joint == LEFT_SHOULDER || joint == RIGHT_SHOULDER {
                let aside = in_mesh.x - rig[avatar * RIG_STRIDE + RIG_PLACES + SPINE].x;
                origins[joint] = origins[joint] + spine_left * ((ends.y - lengths.x) * aside);
            }
        }
        let q = rotations[joint];
        let row_x = vec3<f32>(1.0 - 2.0 * (q.y * q.y + q.z * q.z), 2.0 * (q.x * q.y - q.z * q.w), 2.0 * (q.x * q.z + q.y * q.w)) * scale;
        let row_y = vec3<f32>(2.0 * (q.x * q.y + q.z * q.w), 1.0 - 2.0 * (q.x * q.x + q.z * q.z), 2.0 * (q.y * q.z - q.x * q.w)) * scale;
        let row_z = vec3<f32>(2.0 * (q.x * q.z - q.y * q.w), 2.0 * (q.y * q.z + q.x * q.w), 1.0 - 2.0 * (q.x * q.x + q.y * q.y)) * scale;
        let bind = avatar * RIG_STRIDE + joint * 4u + 1u;
        let bind_x = rig[bind].xyz;
        let bind_y = rig[bind + 1u].xyz;
        let bind_z = rig[bind + 2u].xyz;
        let turned = Turned(
            bind_x * row_x.x + bind_y * row_x.y + bind_z * row_x.z,
            bind_x * row_y.x + bind_y * row_y.y + bind_z * row_y.z,
            bind_x * row_z.x + bind_y * row_z.y + bind_z * row_z.z,
        );
        let part = shape[joint];
        var rows: Rows;
        if joint <= HEAD {
            rows = of_trunk(turned, part, in_mesh, 0.0, origins[joint]);
        } else {
            let bone = rig[avatar * RIG_STRIDE + RIG_BONES + joint].xyz;
            rows = Rows(
                of_limb(turned.x, part, bone, in_mesh, origins[joint].x),
                of_limb(turned.y, part, bone, in_mesh, origins[joint].y),
                of_limb(turned.z, part, bone, in_mesh, origins[joint].z),
            );
        }
        write_rows(slot * PALETTE_STRIDE + joint * 3u, rows);
        if joint == ROOT {
            pelvis = turned;
        }
        if joint == SPINE {
            spine_left = vec3<f32>(turned.x.x, turned.y.x, turned.z.x);
            let half = Turned((pelvis.x + turned.x) * 0.5, (pelvis.y + turned.y) * 0.5, (pelvis.z + turned.z) * 0.5);
            write_rows(slot * PALETTE_STRIDE + WAIST * 3u, of_trunk(half, waist, in_mesh, BACK, origins[joint]));
        }
        if joint == LEFT_FOOT || joint == RIGHT_FOOT {
            let side = select(0u, 1u, joint == RIGHT_FOOT);
            let toes = bent_toes(rows, rig[avatar * RIG_STRIDE + RIG_BALLS + side], scale);
            write_rows(slot * PALETTE_STRIDE + (LEFT_TOES + side) * 3u, toes);
        }
    }
}

// Breadth, length and depth of a part of the trunk.
fn across(breadth_and_depth: vec2<f32>, length: f32) -> vec3<f32> {
    return vec3<f32>(breadth_and_depth.x, length, breadth_and_depth.y);
}

// The directions of world_from_mesh: a joint's turn and the agent's scale.
struct Turned {
    x: vec3<f32>,
    y: vec3<f32>,
    z: vec3<f32>,
}

// Of a part of the trunk, or the head: its shape is along the axes of the mesh. `back` behind the joint nothing moves.
fn of_trunk(turned: Turned, part: vec3<f32>, joint: vec3<f32>, back: f32, origin: vec3<f32>) -> Rows {
    let x = turned.x * part;
    let y = turned.y * part;
    let z = turned.z * part;
    let ahead = (part.z - 1.0) * back;
    return Rows(
        vec4<f32>(x, origin.x - dot3(x, joint) + turned.x.z * ahead),
        vec4<f32>(y, origin.y - dot3(y, joint) + turned.y.z * ahead),
        vec4<f32>(z, origin.z - dot3(z, joint) + turned.z.z * ahead),
    );
}

// A row of a part of a limb: its shape is along the bone and around it.
fn of_limb(turned: vec3<f32>, part: vec3<f32>, bone: vec3<f32>, joint: vec3<f32>, origin: f32) -> vec4<f32> {
    let row = turned * part.x + bone * ((part.y - part.x) * dot3(turned, bone));
    return vec4<f32>(row, origin - dot3(row, joint));
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
