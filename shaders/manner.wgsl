// uses: frame, exact, quaternion, body, rig, agent, standing
// How an agent that walks differs from the person whose gait it has: trunk, neck, head, upper arms and elbows turn a little in
// model space, by a mean and harmonics of the agent's phase. Each of the deviations is drawn from the agent's number. All are
// bounded, and none in the mean of a crowd, so that a crowd shows in the mean what its gaits do.
// What is held comes and goes with the walk, what swings with the length of the stride, too. Pelvis and legs stay as they are:
// planted feet do not slide.
@group(0) @binding(0) var<uniform> frame: FrameUniforms;
@group(0) @binding(1) var<storage, read> visible: array<u32>;                     // [visible] agents, then NONE
@group(0) @binding(2) var<storage, read> stance: array<Stance>;                   // [agent]
@group(0) @binding(3) var<storage, read> appearance: array<Appearance>;           // [agent]
@group(0) @binding(4) var<storage, read> gait_weights: array<vec4<f32>>;          // [agent]
@group(0) @binding(5) var<storage, read> rig: array<vec4<f32>>;                   // [avatar][68]
@group(0) @binding(6) var<storage, read_write> local_rotations: array<vec4<f32>>; // [visible][17]

const CIRCLE: f32 = 6.2831853;  // rad of a stride
const UNITS: f32 = 16777216.0;  // of a phase without its lowest eight bits

// The largest deviations to either side, rad. They add to those of the walker's individuals, most of which are larger.
const LEAN: f32 = 0.14;
const SIDE_LEAN: f32 = 0.075;
const TRUNK_TURN: f32 = 0.08;
const SHOULDER_TURN: f32 = 0.03; // once a stride
const NECK_FLEXION: f32 = 0.18;
const NOD: f32 = 0.012;          // twice a stride
const HEAD_TURN: f32 = 0.09;
const HEAD_TILT: f32 = 0.06;
const ARM_AHEAD: f32 = 0.23;     // of both arms
const ARMS_APART: f32 = 0.09;    // one ahead of the other
const ARM_SWING: vec4<f32> = vec4<f32>(0.15, 0.13, 0.1, 0.11); // by emotion: the sad swing their arms little
const ARM_LATE: f32 = 0.6;       // of the swing, a quarter of a stride later
// As shares of what the gait does, so that no arm is held into the trunk and no elbow bends backwards.
const ARM_OUT: f32 = 0.8;
const ELBOW: f32 = 0.42;
const ELBOW_SWING: f32 = 0.2;    // once a stride

// How much of the trunk's deviation the head takes part in, which is kept upright and ahead.
const HEAD_FOLLOWS: f32 = 0.4;
// How much of the trunk's turn hanging arms take part in, as the walker's.
const ARMS_FOLLOW: f32 = 0.5;
// How much of the trunk's lean they take back, to balance it, as the walker's.
const ARMS_BALANCE: f32 = 0.4;
const LEAST_SQUARE: f32 = 1e-12; // of a length that is divided by

// What agents draw for; the first draw of each arm.
const OWN_WALK: u32 = 0x3a220000u;
const DRAWS_OF_TRUNK: u32 = 9u;
const DRAWS_OF_ARM: u32 = 5u;

const LEFT_ARM: u32 = 4u; // its joints: shoulder, elbow, hand; then those of the right one
const ARM_JOINTS: u32 = 3u;

// In [-1, 1], most often near 0: three fields of ten bits.
const FIELD: u32 = 1023u;
const HALF_SUM: f32 = 1534.5;

fn own_share(agent: u32, number: u32) -> f32 {
    let draw = own_draw(agent, OWN_WALK, number);
    let sum = (draw & FIELD) + ((draw >> 10u) & FIELD) + ((draw >> 20u) & FIELD);
    return (f32(sum) - HALF_SUM) * (1.0 / HALF_SUM);
}

// A small turn by angles about x (chin down), y (to the left) and z (the left side rises); not normalised.
fn small_turn(angles: vec3<f32>) -> vec4<f32> {
    return vec4<f32>(angles * 0.5, 1.0);
}

@compute @workgroup_size(64)
fn manner(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    let agent = visible[slot];
    if agent == NONE {
        return;
    }
    let weights = gait_weights[agent];
    let held = frame.individuals * walk_share(weights, stance[agent].walk_weight);
    if !(held > 0.0) {
        return;
    }
    let own = appearance[agent];
    let avatar = avatar_of(own);
    let base = slot * POSE_STRIDE;
    let swung = held * limit(local_rotations[base + JOINTS].w, 0.0, 1.0);
    let beat = exact_sin_cos(f32(stance[agent].phase >> 8u) * (CIRCLE / UNITS));
    let early = swung * beat.y; // largest at the left foot's strike
    let late = swung * beat.x;  // a quarter of a stride after it

    let lean = held * LEAN * own_share(agent, 0u);
    let side = held * SIDE_LEAN * own_share(agent, 1u);
    let turn = held * TRUNK_TURN * own_share(agent, 2u) + early * SHOULDER_TURN * own_share(agent, 3u);
    let nod = held * NECK_FLEXION * own_share(agent, 4u) + 2.0 * early * beat.x * NOD * own_share(agent, 5u);
    let trunk = vec3<f32>(lean, turn, side);
    let face = trunk * HEAD_FOLLOWS + vec3<f32>(nod, held * HEAD_TURN * own_share(agent, 6u), held * HEAD_TILT * own_share(agent, 7u));

    let pelvis = local_rotations[base];
    let spine = quat_mul(pelvis, local_rotations[base + SPINE]);
    let neck = quat_mul(spine, local_rotations[base + NECK]);
    let head = quat_mul(neck, local_rotations[base + HEAD]);
    let new_spine = quat_mul(small_turn(trunk), spine);
    let new_neck = quat_mul(small_turn((trunk + face) * 0.5), neck);
    let new_head = quat_mul(small_turn(face), head);
    local_rotations[base + SPINE] = quat_normalize(quat_mul(quat_conjugate(pelvis), new_spine));
    local_rotations[base + NECK] = quat_normalize(quat_mul(quat_conjugate(new_spine), new_neck));
    local_rotations[base + HEAD] = quat_normalize(quat_mul(quat_conjugate(new_neck), new_head));

    let swing = dot4(moods_of(weights, emotion_of(own)), ARM_SWING);
    let lag = ARM_LATE * late * own_share(agent, 8u);
    let middle = held * ARM_AHEAD * own_share(agent, DRAWS_OF_TRUNK) - ARMS_BALANCE * lean;
    let apart = held * ARMS_APART * own_share(agent, DRAWS_OF_TRUNK + DRAWS_OF_ARM);
    for (var arm = 0u; arm < 2u; arm++) {
        let draws = DRAWS_OF_TRUNK + DRAWS_OF_ARM * arm;
        let left = select(-1.0, 1.0, arm == 0u);
        let shoulder = base + LEFT_ARM + ARM_JOINTS * arm;
        let joint = LEFT_ARM + ARM_JOINTS * arm;
        let upper = quat_mul(spine, local_rotations[shoulder]);
        let lower = quat_mul(upper, local_rotations[shoulder + 1u]);
        let upper_arm = quat_rotate(upper, joint_translation(avatar, joint + 1u));
        let forearm = quat_rotate(lower, joint_translation(avatar, joint + 2u));
        let square = dot3(upper_arm, upper_arm) * dot3(forearm, forearm);
        let hinge = cross3(upper_arm, forearm) / sqrt(max(square, LEAST_SQUARE));
        let reach = upper_arm + forearm;
        let outwards = limit(left * reach.x / sqrt(max(dot3(reach, reach), LEAST_SQUARE)), 0.0, 1.0);
        // the left arm is back when the left foot strikes
        let ahead = middle + left * apart - left * swing * (early * own_share(agent, draws + 1u) + lag);
        let out = held * ARM_OUT * own_share(agent, draws + 2u) * outwards;
        let bend = held * ELBOW * own_share(agent, draws + 3u) - left * early * ELBOW_SWING * own_share(agent, draws + 4u);
        // what hangs goes forwards by a turn that leans backwards
        let new_upper = quat_mul(small_turn(vec3<f32>(-ahead, ARMS_FOLLOW * turn, left * out)), upper);
        let new_lower = quat_mul(small_turn(hinge * bend), lower);
        local_rotations[shoulder] = quat_normalize(quat_mul(quat_conjugate(new_spine), new_upper));
        // the whole arm has turned about the shoulder, and so only what is the elbow's own is left
        local_rotations[shoulder + 1u] = quat_normalize(quat_mul(quat_conjugate(upper), new_lower));
    }
}
