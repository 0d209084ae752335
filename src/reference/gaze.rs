//! Where agents that gaze turn their heads, by their emotion (paper, section 4.5).

use super::body::{joint_forward, joint_translation, visible_agents};
use super::exact::{asin, atan2, exp2, sin_cos, wrap};
use super::quaternion::{
    add3, limit, quat_after_yaw, quat_before_yaw, quat_conjugate, quat_from_rows, quat_mul, quat_normalize,
    quat_rotate, quat_yaw_pitch, scale3, sub3, xyz,
};
use crate::kernels::gaze::{
    AIM_ROUNDS, EXTENSION_LIMIT, FLEXION_LIMIT, FRAME_BITS, INSIDE, NECK_SHARE, RATE_LIMIT, ROTATION_LIMIT,
    SETTLED, SPRING, SPRING_LOG2, Slices, THETA_HAPPY, THETA_SAD, TOO_CLOSE, TRUNK_FROM, TRUNK_SHARE,
};
use crate::kernels::layout::{GazeState, Physique};
use crate::kernels::shared::attention::{
    ANGRY, ATTENDS, ENGAGED, FIELD_HYSTERESIS, HALF_FIELD, HAPPY, NATURAL, RANGE, RANGE_HYSTERESIS, SAD,
    VALID,
};
use crate::kernels::shared::body::index::{HEAD, JOINTS, NECK, POSE_STRIDE, RIG_EYES, RIG_STRIDE, SPINE};

/// Twin of `shaders/gaze.wgsl`.
pub fn gaze(mut b: Slices<'_>) {
    let visible = b.visible;
    for (slot, agent) in visible_agents(visible).iter().enumerate() {
        gaze_of(&mut b, slot, *agent as usize);
    }
}

/// The user's eyes (world, m) in the model space of an agent that stands at `position` on the ground and faces `heading`.
pub fn user_in_model(eyes: [f32; 3], position: [f32; 2], heading: f32, scale: f32) -> [f32; 3] {
    let [sine, cosine] = sin_cos(heading);
    let x = eyes[0] - position[0];
    let z = eyes[2] - position[1];
    [(cosine * x - sine * z) / scale, eyes[1] / scale, (sine * x + cosine * z) / scale]
}

fn within_reach(rotation: f32, torso: f32) -> f32 {
    torso + limit(wrap(rotation - torso), -ROTATION_LIMIT, ROTATION_LIMIT)
}

fn within_flexion(flexion: f32) -> f32 {
    limit(flexion, -EXTENSION_LIMIT, FLEXION_LIMIT)
}

fn face_turn(yaw: f32, turn: f32, pitch: f32) -> [f32; 4] {
    quat_after_yaw(quat_yaw_pitch(yaw + turn, pitch), -yaw)
}

/// Critically damped spring over `time`, exact for a resting target: (value, rate), rate and step limited.
fn follow(value: f32, rate: f32, goal: f32, time: f32) -> [f32; 2] {
    let decay = exp2(-(SPRING_LOG2 * time));
    let away = value - goal;
    let push = (rate + SPRING * away) * time;
    let step = limit(goal + (away + push) * decay - value, -(RATE_LIMIT * time), RATE_LIMIT * time);
    [value + step, limit((rate - SPRING * push) * decay, -RATE_LIMIT, RATE_LIMIT)]
}

fn keep_state(b: &mut Slices<'_>, agent: usize, state: GazeState, engaged: bool) {
    b.gaze_state[agent] = state;
    let turn = b.gaze_frame[agent] & ATTENDS;
    b.gaze_frame[agent] =
        (b.frame.frame_index & FRAME_BITS) | VALID | if engaged { ENGAGED } else { 0 } | turn;
}

/// A face that does not move.
const fn at_rest(flexion: f32, rotation: f32) -> GazeState {
    GazeState { flexion, rotation, flexion_rate: 0.0, rotation_rate: 0.0 }
}

fn may_look(b: &Slices<'_>, agent: usize) -> bool {
    let limit = b.frame.gaze_limit;
    limit == 0 || limit > b.frame.agent_count || (limit > 1 && b.gaze_frame[agent] & ATTENDS != 0)
}

/// An agent's upper body in its model space, and what it remembers.
struct Body {
    avatar: usize,
    /// First element of the agent's pose.
    base: usize,
    root: [f32; 4],
    spine: [f32; 4],
    neck: [f32; 4],
    head: [f32; 4],
    neck_at: [f32; 3],
    /// Neck to head joint.
    head_arm: [f32; 3],
    /// Head joint to eyes.
    eyes_arm: [f32; 3],
    /// Yaw of the torso from the heading, rad.
    torso: f32,
    user: [f32; 3],
    /// Neck to user on the ground.
    ground: f32,
    is_fresh: bool,
    was_engaged: bool,
    is_too_close: bool,
    old: GazeState,
}

fn gaze_of(b: &mut Slices<'_>, slot: usize, agent: usize) {
    let info = b.appearance[agent];
    if !info.gazes() {
        return;
    }
    let (avatar, emotion, scale) = (info.avatar() as usize, info.emotion(), info.scale);
    let base = slot * POSE_STRIDE;

    let root = b.local_rotations[base];
    let spine = quat_mul(root, b.local_rotations[base + SPINE]);
    let neck = quat_mul(spine, b.local_rotations[base + NECK]);
    let head = quat_mul(neck, b.local_rotations[base + HEAD]);
    let root_at = xyz(b.local_rotations[base + JOINTS]);
    let physique = b.physique[agent];
    let [trunk, _] = Physique::ratios_in(physique.trunk_and_arms);
    let [head_size, _] = Physique::ratios_in(physique.head_and_shoulders);
    let arm = |from, joint| scale3(quat_rotate(from, joint_translation(b.rig, avatar, joint)), trunk);
    let spine_at = add3(root_at, arm(root, SPINE));
    let neck_at = add3(spine_at, arm(spine, NECK));
    let head_arm = arm(neck, HEAD);
    let eyes_arm = scale3(quat_rotate(head, xyz(b.rig[avatar * RIG_STRIDE + RIG_EYES])), head_size);

    let forward = quat_rotate(spine, joint_forward(b.rig, avatar, SPINE));
    let torso = atan2(forward[0], forward[2]);
    let eyes = std::array::from_fn(|axis| b.frame.user_eyes[axis]);
    let user = user_in_model(eyes, b.position[agent], b.heading[agent], scale);
    let to_user = sub3(user, neck_at);
    let ground = (to_user[0] * to_user[0] + to_user[2] * to_user[2]).sqrt();
    let yaw = wrap(atan2(to_user[0], to_user[2]) - torso);

    let memory = b.gaze_frame[agent];
    let age = b.frame.frame_index.wrapping_sub(memory) & FRAME_BITS;
    let is_fresh = memory & VALID != 0 && age <= 1;
    let was_engaged = is_fresh && memory & ENGAGED != 0;
    let old = b.gaze_state[agent];
    let is_too_close = ground * scale < if b.frame.gaze_mode == NATURAL { INSIDE } else { TOO_CLOSE };

    let body = Body {
        avatar,
        base,
        root,
        spine,
        neck,
        head,
        neck_at,
        head_arm,
        eyes_arm,
        torso,
        user,
        ground,
        is_fresh,
        was_engaged,
        is_too_close,
        old,
    };
    if b.frame.gaze_mode == NATURAL {
        natural(b, agent, &body, emotion, scale, yaw);
    } else {
        paper(b, agent, &body, emotion, yaw);
    }
}

fn paper(b: &mut Slices<'_>, agent: usize, body: &Body, emotion: u32, yaw: f32) {
    if emotion > SAD || (emotion != SAD && !may_look(b, agent)) {
        return; // neutral, or not its turn: the gait's own angles
    }
    let torso = body.torso;
    let mut rotation = 0.0;
    let mut flexion = THETA_SAD;
    if emotion != SAD {
        rotation = match (body.is_too_close, body.is_fresh) {
            (false, _) => yaw,
            (true, true) => wrap(body.old.rotation - torso),
            (true, false) => 0.0,
        };
        flexion = THETA_HAPPY; // constant, whatever the relative height
    }
    if emotion == ANGRY {
        let rise = body.neck_at[1] + body.head_arm[1] + body.eyes_arm[1] - body.user[1];
        // arcsin of a ratio that may pass 1, clamped
        flexion = if body.is_fresh { body.old.flexion } else { 0.0 };
        if !body.is_too_close {
            flexion = asin(rise / body.ground);
        }
    }
    rotation = limit(rotation, -ROTATION_LIMIT, ROTATION_LIMIT);
    flexion = within_flexion(flexion);
    let rest = |joint: usize| {
        let bind = body.avatar * RIG_STRIDE + joint * 4 + 1;
        quat_from_rows(xyz(b.rig[bind]), xyz(b.rig[bind + 1]), xyz(b.rig[bind + 2]))
    };
    let (spine_rest, neck_rest) = (rest(SPINE), rest(NECK));
    let turned = quat_mul(spine_rest, quat_mul(quat_yaw_pitch(rotation, flexion), quat_conjugate(neck_rest)));
    b.local_rotations[body.base + NECK] = quat_normalize(turned);
    keep_state(b, agent, at_rest(flexion, torso + rotation), emotion != SAD);
}

fn natural(b: &mut Slices<'_>, agent: usize, body: &Body, emotion: u32, scale: f32, yaw: f32) {
    let (torso, old) = (body.torso, body.old);
    let face = quat_rotate(body.head, joint_forward(b.rig, body.avatar, HEAD));
    let own_yaw = atan2(face[0], face[2]);
    let own_flexion = atan2(-face[1], (face[0] * face[0] + face[2] * face[2]).sqrt());

    let range = RANGE + if body.was_engaged { RANGE_HYSTERESIS } else { 0.0 };
    let field = HALF_FIELD + if body.was_engaged { FIELD_HYSTERESIS } else { 0.0 };
    let in_view =
        if body.is_too_close { body.was_engaged } else { body.ground * scale < range && yaw.abs() < field };
    let engaged = emotion <= ANGRY && in_view && may_look(b, agent);

    let mut rotation = own_yaw;
    let mut flexion = own_flexion;
    if engaged {
        [flexion, rotation] = aim(body, own_yaw, own_flexion);
        if emotion == HAPPY {
            flexion = within_flexion(flexion + THETA_HAPPY); // at the user, tilted up
        }
        if body.is_too_close && body.is_fresh {
            rotation = old.rotation;
            flexion = old.flexion;
        }
    }
    let sad = emotion == SAD;
    if sad {
        rotation = torso;
        flexion = if own_flexion > THETA_SAD { own_flexion } else { THETA_SAD };
    }

    let mut state = at_rest(flexion, rotation);
    if body.is_fresh {
        let [flexion, flexion_rate] = follow(old.flexion, old.flexion_rate, flexion, b.frame.frame_time);
        let [rotation, rotation_rate] = follow(
            old.rotation,
            old.rotation_rate,
            old.rotation + wrap(rotation - old.rotation),
            b.frame.frame_time,
        );
        let (flexion, rotation) = (within_flexion(flexion), within_reach(rotation, torso));
        state = GazeState { flexion, rotation, flexion_rate, rotation_rate };
    }
    if !engaged
        && !sad
        && (state.flexion - own_flexion).abs() < SETTLED
        && wrap(state.rotation - own_yaw).abs() < SETTLED
    {
        keep_state(b, agent, at_rest(own_flexion, own_yaw), false);
        return;
    }
    let turn = wrap(state.rotation - own_yaw);
    let nod = state.flexion - own_flexion;
    let new_neck =
        quat_normalize(quat_mul(face_turn(own_yaw, NECK_SHARE * turn, NECK_SHARE * nod), body.neck));
    let new_head = quat_mul(face_turn(own_yaw, turn, nod), body.head);
    let mut new_spine = body.spine;
    let reach = wrap(state.rotation - torso);
    let beyond = reach - limit(reach, -TRUNK_FROM, TRUNK_FROM);
    if beyond != 0.0 {
        new_spine = quat_before_yaw(TRUNK_SHARE * beyond, body.spine);
        b.local_rotations[body.base + SPINE] = quat_normalize(quat_mul(quat_conjugate(body.root), new_spine));
    }
    b.local_rotations[body.base + NECK] = quat_normalize(quat_mul(quat_conjugate(new_spine), new_neck));
    b.local_rotations[body.base + HEAD] = quat_normalize(quat_mul(quat_conjugate(new_neck), new_head));
    keep_state(b, agent, state, engaged);
}

/// (flexion, rotation) of the face that sees the user straight ahead, within the limits.
fn aim(body: &Body, own_yaw: f32, own_flexion: f32) -> [f32; 2] {
    let eyes = quat_rotate(quat_conjugate(quat_yaw_pitch(own_yaw, own_flexion)), body.eyes_arm);
    let (mut rotation, mut flexion) = (own_yaw, own_flexion);
    for _ in 0..AIM_ROUNDS {
        let neck_turn = NECK_SHARE * wrap(rotation - own_yaw);
        let neck = face_turn(own_yaw, neck_turn, NECK_SHARE * (flexion - own_flexion));
        let d = sub3(body.user, add3(body.neck_at, quat_rotate(neck, body.head_arm)));
        let flat = d[0] * d[0] + d[2] * d[2] - eyes[0] * eyes[0];
        let deep = flat + d[1] * d[1] - eyes[1] * eyes[1];
        if flat > 1e-4 && deep > 1e-4 {
            rotation = atan2(d[0], d[2]) - atan2(eyes[0], flat.sqrt());
            flexion = atan2(eyes[1], deep.sqrt()) - atan2(d[1], flat.sqrt());
        }
        rotation = within_reach(rotation, body.torso);
        flexion = within_flexion(flexion);
    }
    [flexion, rotation]
}
