// uses: frame, exact, quaternion, body, agent, standing
// What people who stand do of themselves, by the time and by their own number: they breathe, sway, look about, and hold
// themselves a little differently from one another. Turns the joints above the legs in model space, and the whole body about
// the ground under it, but for the feet. Agents that walk stay as `pose` left them; between the two, all angles are shared out.
@group(0) @binding(0) var<uniform> frame: FrameUniforms;
@group(0) @binding(1) var<storage, read> visible: array<u32>;                     // [visible] agents, then NONE
@group(0) @binding(2) var<storage, read> stance: array<Stance>;                   // [agent]
@group(0) @binding(3) var<storage, read> appearance: array<Appearance>;           // [agent]
@group(0) @binding(4) var<storage, read> gait_weights: array<vec4<f32>>;          // [agent]
@group(0) @binding(5) var<storage, read_write> local_rotations: array<vec4<f32>>; // [visible][17]

const TURN: f32 = 6.2831853;
const STEPS: f32 = 16777216.0; // of a phase without its lowest eight bits
const UPPER: u32 = 10u;        // joints above the legs come before it

// Breath, as a phase whose whole range is one breath.
const BREATH_UNIT: u32 = 4474u;  // of it in 1 ms, at a sixteenth of a breath a minute
const BREATH_LEAST: u32 = 200u;  // sixteenths a minute: 12.5 breaths
const BREATH_SPAN: u32 = 81u;    // sixteenths a minute: up to 17.5 breaths
const BREATH_MORE: vec4<u32> = vec4<u32>(20u, 36u, 0u, 8u); // by emotion, sixteenths a minute
const CHEST_RISES: f32 = 0.013;  // rad to either side
const ARMS_SPREAD: f32 = 0.008;  // rad to either side

// Sway: two waves about each axis. 4 mm and 2.5 mm at the height of the hips, to either side.
const SLOW_LEAST: u32 = 310000u;  // 2^-32 of a wave in 1 ms: 14 s
const SLOW_SPAN: u32 = 150000u;   // 9 s
const QUICK_LEAST: u32 = 860000u; // 5 s
const QUICK_SPAN: u32 = 500000u;  // 3 s
const QUICK_SHARE: f32 = 0.35;
const SWAY_AHEAD: f32 = 0.0042;   // rad
const SWAY_ASIDE: f32 = 0.0027;   // rad

// Looks: one in each stretch of time, which is longer where the emotion looks about less.
const LOOK_EVERY: vec4<u32> = vec4<u32>(5000u, 8000u, 14000u, 9000u); // by emotion, ms
const LOOK_LEAST: u32 = 1000u;    // ms
const LOOK_SPAN: u32 = 3000u;     // ms
const LOOK_RAMP: f32 = 480.0;     // ms that a head takes to turn
const LOOK_NEAR: f32 = 0.12;      // rad, 7 degrees
const LOOK_FAR: f32 = 0.436;      // rad, 25 degrees
const LOOK_DOWN: f32 = 0.05;      // rad up or down
const CHEST_FOLLOWS: f32 = 0.08;

// What is an individual's own, rad to either side; of the arms outwards and forwards only.
const OWN_LEAN: f32 = 0.02;
const OWN_BEND: f32 = 0.025;
const OWN_TURN: f32 = 0.09;
const OWN_NOD: f32 = 0.035;
const OWN_TILT: f32 = 0.045;
const OWN_SWING: f32 = 0.06;
const OWN_SPREAD: f32 = 0.05;
const OWN_ELBOW: f32 = 0.15;

// What agents draw for.
const CARRIAGE: u32 = 0xca440000u;
const BREATH: u32 = 0xb4ea0000u;
const SWAY: u32 = 0x53a10000u;
const LOOK: u32 = 0x10010000u;

// In [-1, 1): the agent's own for good.
fn own_angle(agent: u32, number: u32) -> f32 {
    return 2.0 * unit_f32(own_draw(agent, CARRIAGE, number)) - 1.0;
}

fn wave(phase: u32) -> f32 {
    return exact_sin_cos(f32(phase >> 8u) * (TURN / STEPS)).x;
}

// 1 with the chest full, -1 with it empty.
fn breath_of(agent: u32, emotion: u32) -> f32 {
    let own = own_draw(agent, BREATH, 0u);
    let rate = BREATH_LEAST + own % BREATH_SPAN + BREATH_MORE[emotion];
    return wave(frame.gaze_time * (BREATH_UNIT * rate) + hash_u32(own));
}

// A slow wave and a quicker, lower one, in [-1, 1].
fn sway_of(agent: u32, axis: u32) -> f32 {
    let slow = own_draw(agent, SWAY, 2u * axis);
    let quick = own_draw(agent, SWAY, 2u * axis + 1u);
    let slowly = wave(frame.gaze_time * (SLOW_LEAST + slow % SLOW_SPAN) + hash_u32(slow));
    let quickly = wave(frame.gaze_time * (QUICK_LEAST + quick % QUICK_SPAN) + hash_u32(quick));
    return slowly * (1.0 - QUICK_SHARE) + quickly * QUICK_SHARE;
}

// Where it looks beside where it faces: (to the left, down), rad.
fn look_of(agent: u32, emotion: u32) -> vec2<f32> {
    let every = LOOK_EVERY[emotion];
    let time = frame.gaze_time + own_draw(agent, LOOK, 0u) % every;
    let draw = own_draw(agent, LOOK, 1u + time / every);
    let lasts = LOOK_LEAST + draw % LOOK_SPAN;
    let since = i32(time % every) - i32((draw >> 12u) % (every - lasts));
    let within = f32(min(since, i32(lasts) - since));
    let share = eased(limit(within / LOOK_RAMP, 0.0, 1.0));
    let aside = hash_u32(draw);
    let yaw = LOOK_NEAR + (LOOK_FAR - LOOK_NEAR) * unit_f32(aside << 1u);
    let down = 2.0 * unit_f32(hash_u32(aside)) - 1.0;
    return vec2<f32>(select(-yaw, yaw, (aside >> 31u) == 1u) * share, LOOK_DOWN * down * share);
}

@compute @workgroup_size(64)
fn idle(@builtin(global_invocation_id) id: vec3<u32>) {
    var parents = array<u32, 16>(0u, 0u, 1u, 2u, 1u, 4u, 5u, 1u, 7u, 8u, 0u, 10u, 11u, 0u, 13u, 14u);
    let slot = id.x;
    let agent = visible[slot];
    if agent == NONE {
        return;
    }
    let weights = gait_weights[agent];
    let stands = 1.0 - walk_share(weights, stance[agent].walk_weight);
    if !(stands > 0.0) {
        return;
    }
    let moods = moods_of(weights, emotion_of(appearance[agent]));
    let breath = stands * dot4(moods, vec4<f32>(breath_of(agent, 0u), breath_of(agent, 1u), breath_of(agent, 2u), breath_of(agent, 3u)));
    let look = (look_of(agent, 0u) * moods.x + look_of(agent, 1u) * moods.y + look_of(agent, 2u) * moods.z + look_of(agent, 3u) * moods.w) * stands;
    // `paper` mode leaves heads to the paper's formulas
    let looks = select(0.0, 1.0, frame.gaze_mode == 0u);
    let aside = look.x * looks;
    let down = look.y * looks;

    // turns of the joints in model space
    let yaw = stands * OWN_TURN * own_angle(agent, 0u) + CHEST_FOLLOWS * aside;
    let lean = stands * OWN_LEAN * own_angle(agent, 1u) - CHEST_RISES * breath;
    let chest = quat_before_yaw(yaw, quat_pitch_roll(lean, stands * OWN_BEND * own_angle(agent, 2u)));
    let nod = stands * OWN_NOD * own_angle(agent, 3u) + down;
    let head = quat_before_yaw(yaw + aside, quat_pitch_roll(nod, stands * OWN_TILT * own_angle(agent, 4u)));
    let neck = quat_normalize(quat_lerp(chest, head, 0.5));
    var turns = array<vec4<f32>, 10>(chest, chest, neck, head, chest, chest, chest, chest, chest, chest);
    for (var side = 0u; side < 2u; side++) {
        let own = 5u + 3u * side;
        let outwards = stands * OWN_SPREAD * (0.5 + 0.5 * own_angle(agent, own)) + ARMS_SPREAD * breath;
        let roll = select(-outwards, outwards, side == 0u);
        // what hangs goes forwards by a turn that leans backwards
        let ahead = stands * OWN_SWING * own_angle(agent, own + 1u);
        let bend = stands * OWN_ELBOW * (0.5 + 0.5 * own_angle(agent, own + 2u));
        let fore = quat_before_yaw(yaw, quat_pitch_roll(-(ahead + bend), roll));
        turns[4u + 3u * side] = quat_before_yaw(yaw, quat_pitch_roll(-ahead, roll));
        turns[5u + 3u * side] = fore;
        turns[6u + 3u * side] = fore;
    }

    let sway = quat_pitch_roll(stands * SWAY_AHEAD * sway_of(agent, 0u), stands * SWAY_ASIDE * sway_of(agent, 1u));
    let base = slot * POSE_STRIDE;
    var before = array<vec4<f32>, 16>(); // model_from_joint as `pose` left it
    var after = array<vec4<f32>, 16>();
    before[0] = local_rotations[base];
    after[0] = quat_mul(sway, before[0]);
    local_rotations[base] = quat_normalize(after[0]);
    for (var joint = 1u; joint < JOINTS; joint++) {
        let parent = parents[joint];
        before[joint] = quat_mul(before[parent], local_rotations[base + joint]);
        after[joint] = before[joint];
        if joint < UPPER {
            after[joint] = quat_mul(turns[joint], before[joint]);
        }
        if joint != LEFT_FOOT && joint != RIGHT_FOOT {
            after[joint] = quat_mul(sway, after[joint]);
        }
        local_rotations[base + joint] = quat_normalize(quat_mul(quat_conjugate(after[parent]), after[joint]));
    }
    let root = local_rotations[base + JOINTS];
    local_rotations[base + JOINTS] = vec4<f32>(quat_rotate(sway, root.xyz), root.w);
}
