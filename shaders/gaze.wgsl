// uses: frame, exact, quaternion, body, rig, attention, agent
// Where agents that gaze turn their heads, by their emotion (paper, section 4.5): happy and angry ones at the user,
// sad ones down and ahead, neutral ones as their gait has it. Writes the neck (and head) of local_rotations.
// Flexion (chin down) and rotation to the agent's left are positive. Frame: the agent's model space, heading along +z.
//
// `paper` mode states the paper's equations as neck angles relative to the torso; the neck joint takes them at once.
// `natural` mode (default) turns neck and head so that the face points exactly where it should, upright whatever the
// torso does, within limits, only for a user in view, and smoothly. The trunk takes part in large turns.
//
// gaze_frame holds VALID, ENGAGED, ATTENDS and the low bits of frame_index of the last update, so a
// buffer of zeros is an empty memory.
// What a face does, and how fast.
struct GazeState {
    flexion: f32,       // rad
    rotation: f32,      // rad, counted from the agent's heading
    flexion_rate: f32,  // rad/s
    rotation_rate: f32, // rad/s
}

const THETA_HAPPY: f32 = -0.08726646;     // -5 degrees, extension: paper, 4.5 happy
const THETA_SAD: f32 = 0.17453293;        // +10 degrees: paper, 4.5 sad; positive is flexion (A-13)
const ROTATION_LIMIT: f32 = 1.2217305;    // 70 degrees from the torso (A-17)
const FLEXION_LIMIT: f32 = 0.7853982;     // 45 degrees (A-17)
const EXTENSION_LIMIT: f32 = 0.7853982;   // 45 degrees (A-17)
const TOO_CLOSE: f32 = 0.01;              // m: nearer on the ground than this, a direction means nothing (spec 1.8)
const INSIDE: f32 = 0.25;                 // m, ours: the same for natural mode, the user stands in the agent's head
const RATE_LIMIT: f32 = 3.1415927;        // 180 degrees/s, spec 1.8
const SPRING: f32 = 8.0;                  // 1/s: 2 / 0.25 s, so that a moving target is trailed by 0.25 s (spec 1.8)
const SPRING_LOG2: f32 = 11.541561;       // SPRING / ln 2: exp(-SPRING t) = exp2(-SPRING_LOG2 t)
const SETTLED: f32 = 0.017453292;         // 1 degree, ours: nearer to the gait's own angles than this, the gait takes over
const NECK_SHARE: f32 = 0.5;              // of the turn taken by the neck, the head takes the rest; ours
const TRUNK_FROM: f32 = 0.7853982;        // 45 degrees from the torso: for more, natural mode turns the trunk, too; ours
const TRUNK_SHARE: f32 = 0.4;             // of what is beyond; ours
const AIM_ROUNDS: u32 = 3u;               // the eyes move as the neck turns; each round cuts the error by 10 or more

const FRAME_BITS: u32 = 0x1fffffffu;

@group(0) @binding(0) var<uniform> frame: FrameUniforms;
@group(0) @binding(1) var<storage, read> visible: array<u32>;                     // [visible] agents, then NONE
@group(0) @binding(2) var<storage, read> position: array<vec2<f32>>;              // [agent] m
@group(0) @binding(3) var<storage, read> heading: array<f32>;                     // [agent] rad
@group(0) @binding(4) var<storage, read> appearance: array<Appearance>;           // [agent]
@group(0) @binding(5) var<storage, read> physique: array<Physique>;               // [agent]
@group(0) @binding(6) var<storage, read> rig: array<vec4<f32>>;                   // [avatar][100]
@group(0) @binding(7) var<storage, read_write> local_rotations: array<vec4<f32>>; // [visible][17]
@group(0) @binding(8) var<storage, read_write> gaze_state: array<GazeState>;      // [agent]
@group(0) @binding(9) var<storage, read_write> gaze_frame: array<u32>;            // [agent]

// The user's eyes in the agent's model space.
fn user_in_model(agent: u32, scale: f32) -> vec3<f32> {
    let turn = exact_sin_cos(heading[agent]);
    let x = frame.user_eyes.x - position[agent].x;
    let z = frame.user_eyes.z - position[agent].y;
    return vec3<f32>((turn.y * x - turn.x * z) / scale, frame.user_eyes.y / scale, (turn.x * x + turn.y * z) / scale);
}

// Kept within ROTATION_LIMIT of the torso's yaw.
fn within_reach(rotation: f32, torso: f32) -> f32 {
    return torso + limit(exact_wrap(rotation - torso), -ROTATION_LIMIT, ROTATION_LIMIT);
}

fn within_flexion(flexion: f32) -> f32 {
    return limit(flexion, -EXTENSION_LIMIT, FLEXION_LIMIT);
}

// Turns a face that looks along (yaw, 0) to look along (yaw + turn, pitch), about up and its own left.
fn face_turn(yaw: f32, turn: f32, pitch: f32) -> vec4<f32> {
    return quat_after_yaw(quat_yaw_pitch(yaw + turn, pitch), -yaw);
}

// Critically damped spring over `time`, exact for a resting target: (value, rate), rate and step limited.
fn follow(value: f32, rate: f32, goal: f32, time: f32) -> vec2<f32> {
    let decay = exact_exp2(-(SPRING_LOG2 * time));
    let away = value - goal;
    let push = (rate + SPRING * away) * time;
    let step = limit(goal + (away + push) * decay - value, -(RATE_LIMIT * time), RATE_LIMIT * time);
    return vec2<f32>(value + step, limit((rate - SPRING * push) * decay, -RATE_LIMIT, RATE_LIMIT));
}

fn keep_state(agent: u32, state: GazeState, engaged: bool) {
    gaze_state[agent] = state;
    gaze_frame[agent] = (frame.frame_index & FRAME_BITS) | VALID | select(0u, ENGAGED, engaged) | (gaze_frame[agent] & ATTENDS);
}

// Whether the agent may look at the user: there are turns for all, or it is its turn.
fn may_look(agent: u32) -> bool {
    return frame.gaze_limit == 0u || frame.gaze_limit > frame.agent_count
        || (frame.gaze_limit > 1u && (gaze_frame[agent] & ATTENDS) != 0u);
}

@compute @workgroup_size(64)
fn gaze(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = visible[id.x];
    if agent == NONE {
        return;
    }
    let info = appearance[agent];
    let emotion = emotion_of(info);
    if !gazes(info) {
        return;
    }
    let avatar = avatar_of(info);
    let scale = info.scale;
    let base = id.x * POSE_STRIDE;

    // forward kinematics from the root to the eyes, in model space
    let root = local_rotations[base];
    let spine = quat_mul(root, local_rotations[base + SPINE]);
    let neck = quat_mul(spine, local_rotations[base + NECK]);
    let head = quat_mul(neck, local_rotations[base + HEAD]);
    let trunk = ratios_in(physique[agent].trunk_and_arms).x;
    let head_size = ratios_in(physique[agent].head_and_shoulders).x;
    let spine_at = local_rotations[base + JOINTS].xyz + quat_rotate(root, joint_translation(avatar, SPINE)) * trunk;
    let neck_at = spine_at + quat_rotate(spine, joint_translation(avatar, NECK)) * trunk;
    let head_arm = quat_rotate(neck, joint_translation(avatar, HEAD)) * trunk; // neck to head joint
    let eyes_arm = quat_rotate(head, rig[avatar * RIG_STRIDE + RIG_EYES].xyz) * head_size; // head joint to eyes

    let forward = quat_rotate(spine, joint_forward(avatar, SPINE)); // the paper's f: the torso without the neck
    let torso = exact_atan2(forward.x, forward.z);
    let user = user_in_model(agent, scale);
    let to_user = user - neck_at; // A-15: rotation about the neck
    let ground = sqrt(to_user.x * to_user.x + to_user.z * to_user.z);
    let yaw = exact_wrap(exact_atan2(to_user.x, to_user.z) - torso); // A-14: signed, about up

    let age = (frame.frame_index - gaze_frame[agent]) & FRAME_BITS;
    let is_fresh = (gaze_frame[agent] & VALID) != 0u && age <= 1u;
    let was_engaged = is_fresh && (gaze_frame[agent] & ENGAGED) != 0u;
    let old = gaze_state[agent];
    let is_too_close = ground * scale < select(TOO_CLOSE, INSIDE, frame.gaze_mode == NATURAL);

    if frame.gaze_mode != NATURAL {
        if emotion > SAD || (emotion != SAD && !may_look(agent)) {
            return; // neutral, or not its turn: the gait's own angles
        }
        // sad: rotation 0
        var rotation = 0.0;
        var flexion = THETA_SAD;
        if emotion != SAD {
            rotation = select(yaw, select(0.0, exact_wrap(old.rotation - torso), is_fresh), is_too_close);
            flexion = THETA_HAPPY; // A-16: constant, whatever the relative height
        }
        if emotion == ANGRY {
            let rise = neck_at.y + head_arm.y + eyes_arm.y - user.y; // A-15: y_i is the height of the eyes
            // A-12: arcsin of a ratio that may pass 1; exact_asin clamps it
            flexion = select(0.0, old.flexion, is_fresh);
            if !is_too_close {
                flexion = exact_asin(rise / ground);
            }
        }
        rotation = limit(rotation, -ROTATION_LIMIT, ROTATION_LIMIT); // A-17
        flexion = within_flexion(flexion);
        // the neck at rest under the torso at rest, turned in the torso's frame
        let spine_bind = avatar * RIG_STRIDE + SPINE * 4u + 1u;
        let neck_bind = avatar * RIG_STRIDE + NECK * 4u + 1u;
        let spine_rest = quat_from_rows(rig[spine_bind].xyz, rig[spine_bind + 1u].xyz, rig[spine_bind + 2u].xyz);
        let neck_rest = quat_from_rows(rig[neck_bind].xyz, rig[neck_bind + 1u].xyz, rig[neck_bind + 2u].xyz);
        let turned = quat_mul(spine_rest, quat_mul(quat_yaw_pitch(rotation, flexion), quat_conjugate(neck_rest)));
        local_rotations[base + NECK] = quat_normalize(turned);
        keep_state(agent, GazeState(flexion, torso + rotation, 0.0, 0.0), emotion != SAD);
        return;
    }

    // natural mode: how the gait itself holds the face
    let face = quat_rotate(head, joint_forward(avatar, HEAD));
    let own_yaw = exact_atan2(face.x, face.z);
    let own_flexion = exact_atan2(-face.y, sqrt(face.x * face.x + face.z * face.z));

    // A-17: only for a user within range and field of regard, with hysteresis; on top of the user, as before
    let range = RANGE + select(0.0, RANGE_HYSTERESIS, was_engaged);
    let field = HALF_FIELD + select(0.0, FIELD_HYSTERESIS, was_engaged);
    let in_view = select(ground * scale < range && abs(yaw) < field, was_engaged, is_too_close);
    let engaged = emotion <= ANGRY && in_view && may_look(agent);

    var rotation = own_yaw;
    var flexion = own_flexion;
    if engaged {
        // Turned about the head joint by (rotation, flexion), the eyes at `eyes` in the face's frame look along that
        // frame's z at the user: closed form. The head joint itself moves with the neck's share, hence the rounds.
        let eyes = quat_rotate(quat_conjugate(quat_yaw_pitch(own_yaw, own_flexion)), eyes_arm);
        for (var i = 0u; i < AIM_ROUNDS; i++) {
            let neck_turn = NECK_SHARE * exact_wrap(rotation - own_yaw);
            let d = user - (neck_at + quat_rotate(face_turn(own_yaw, neck_turn, NECK_SHARE * (flexion - own_flexion)), head_arm));
            let flat = d.x * d.x + d.z * d.z - eyes.x * eyes.x;
            let deep = flat + d.y * d.y - eyes.y * eyes.y;
            if flat > 1e-4 && deep > 1e-4 {
                rotation = exact_atan2(d.x, d.z) - exact_atan2(eyes.x, sqrt(flat));
                flexion = exact_atan2(eyes.y, sqrt(deep)) - exact_atan2(d.y, sqrt(flat)); // A-12: atan2, not arcsin
            }
            rotation = within_reach(rotation, torso);
            flexion = within_flexion(flexion);
        }
        if emotion == HAPPY {
            flexion = within_flexion(flexion + THETA_HAPPY); // A-16: at the user, tilted up
        }
        if is_too_close && is_fresh {
            rotation = old.rotation;
            flexion = old.flexion;
        }
    }
    let sad = emotion == SAD;
    if sad {
        rotation = torso;
        flexion = select(THETA_SAD, own_flexion, own_flexion > THETA_SAD); // never lifts a head that hangs lower
    }

    var state = GazeState(flexion, rotation, 0.0, 0.0);
    if is_fresh {
        let nod = follow(old.flexion, old.flexion_rate, flexion, frame.frame_time);
        let turn = follow(old.rotation, old.rotation_rate, old.rotation + exact_wrap(rotation - old.rotation), frame.frame_time);
        state = GazeState(within_flexion(nod.x), within_reach(turn.x, torso), nod.y, turn.y);
    }
    if !engaged && !sad
        && abs(state.flexion - own_flexion) < SETTLED && abs(exact_wrap(state.rotation - own_yaw)) < SETTLED {
        keep_state(agent, GazeState(own_flexion, own_yaw, 0.0, 0.0), false);
        return;
    }
    let turn = exact_wrap(state.rotation - own_yaw);
    let nod = state.flexion - own_flexion;
    let new_neck = quat_normalize(quat_mul(face_turn(own_yaw, NECK_SHARE * turn, NECK_SHARE * nod), neck));
    let new_head = quat_mul(face_turn(own_yaw, turn, nod), head);
    var new_spine = spine;
    let reach = exact_wrap(state.rotation - torso);
    let beyond = reach - limit(reach, -TRUNK_FROM, TRUNK_FROM);
    if beyond != 0.0 {
        new_spine = quat_before_yaw(TRUNK_SHARE * beyond, spine);
        local_rotations[base + SPINE] = quat_normalize(quat_mul(quat_conjugate(root), new_spine));
    }
    local_rotations[base + NECK] = quat_normalize(quat_mul(quat_conjugate(new_spine), new_neck));
    local_rotations[base + HEAD] = quat_normalize(quat_mul(quat_conjugate(new_neck), new_head));
    keep_state(agent, state, engaged);
}
