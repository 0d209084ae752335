// uses: frame, exact, quaternion, body, attention, agent, standing
// Sets the faces of agents that are drawn by a finest mesh. Turns their eyes and moves their upper lids: their matrices in
// palettes, from the head's as `gaze` has turned it. Eyes are at their target at once and the head follows, so that eyes lead the head.
//
// Agents that look at the user from near by look now at one eye, now at the other, now at the mouth. Sad ones look at the
// ground ahead, all others ahead, with small glances about. These directions count from the heading, so that eyes hold
// still while the head nods. Glances and blinks follow from the agent's number and the time alone. In `paper` mode the
// neck angles are all there is: eyes stay straight in the head, and faces at rest.
//
// A face is six numbers, which follow the shares of the emotions that the body walks and stands in; a seventh clenches the hands of the
// angry. `skin` moves brows, mouth and fingers by them, and the lids turn here. What an emotion does to a face are the action units of FACS (Ekman and Friesen 1978).
//
// Yaw is positive to the left, pitch downwards, as of the face. Angles are kept as (sine, cosine) where they can.
const ASIDE_LIMIT: vec2<f32> = vec2<f32>(0.42261826, 0.9063078); // 25 degrees from the face's forward: for more, heads turn
const DOWN_LIMIT: vec2<f32> = vec2<f32>(0.42261826, 0.9063078);  // 25 degrees
const UP_LIMIT: vec2<f32> = vec2<f32>(0.34202015, 0.9396926);    // 20 degrees
const LEAST: f32 = 1e-6;                                         // m, nearer than this is no direction

const FACE_RANGE: f32 = 3.0;          // m: from here on a face is one point
const APART: f32 = 0.032;             // m, from between the user's eyes to either of them
const MOUTH: f32 = 0.07;              // m, from there down to the mouth

const FAR: f32 = 10.0;                // m, where eyes meet that look ahead
const DROP: f32 = 0.06981317;         // 4 degrees: people walk with their eyes a little down
const GROUND_AHEAD: f32 = 3.0;        // m, the spot that sad ones look at
const GLANCE_YAW: f32 = 0.31415927;   // 18 degrees, the farthest glance; half of them stay within an eighth of it
const GLANCE_PITCH: f32 = 0.08726646; // 5 degrees

// Irregular moments: one in each window, within its first span; so they follow each other after window +- span at most, ms.
const FACE_WINDOW: u32 = 900u;
const FACE_SPAN: u32 = 600u;
const GLANCE_WINDOW: u32 = 1750u;
const GLANCE_SPAN: u32 = 1250u;
const BLINK_WINDOW: u32 = 4000u;
const BLINK_SPAN: u32 = 2000u;
const FACE: u32 = 0x10000000u;        // kinds of moments, in seeds
const GLANCES: u32 = 0x20000000u;
const BLINKS: u32 = 0x30000000u;

const SACCADE: f32 = 50.0;            // ms
const BLINK: f32 = 150.0;             // ms
const CLOSING: f32 = 50.0;            // ms of it
const OPENING: f32 = 80.0;            // ms of it

const SHUT: f32 = 0.72;               // rad that an open lid turns down to shut the eye
const FOLLOW: f32 = 0.8;              // rad that lids follow the eyes down, times the sine of their pitch
const LID_REACH: f32 = 0.22;          // rad from a lid at rest to one as wide open, or as low, as actors have it

// Expressions of the happy, angry, sad and neutral. Happy: units 6 and 12, lips apart (25). Angry: 4, 5 and 7, lips tight (23).
// Sad: 1, 4 and 15, lids low.
const BY_INNER_BROW: vec4<f32> = vec4<f32>(0.15, -1.0, 1.0, 0.0);
const BY_OUTER_BROW: vec4<f32> = vec4<f32>(0.25, 0.1, -0.6, 0.0);
const BY_UPPER_LID: vec4<f32> = vec4<f32>(-0.1, 0.3, -0.6, 0.0);
const BY_MOUTH_CORNER: vec4<f32> = vec4<f32>(1.0, -0.35, -1.0, 0.0);
const BY_MOUTH_OPEN: vec4<f32> = vec4<f32>(0.4, -1.0, -0.05, 0.0);
const FARTHEST: f32 = 1.5;            // no face is made to go farther
const BY_FIST: vec4<f32> = vec4<f32>(0.0, 1.0, 0.0, 0.0);

// What is an agent's own: how strong its expressions are, and how brows, mouth and fingers are at rest, to either side.
const OWN_STRENGTH: f32 = 0.15;
const OWN_BROW: f32 = 0.12;
const OWN_MOUTH: f32 = 0.06;
const OWN_FIST: f32 = 0.15;
const OWN_FACE: u32 = 0xface0000u;    // what it draws for

@group(0) @binding(0) var<uniform> frame: FrameUniforms;
@group(0) @binding(1) var<storage, read> visible: array<u32>;              // [visible] agents, then NONE
@group(0) @binding(2) var<storage, read> heading: array<f32>;              // [agent] rad
@group(0) @binding(3) var<storage, read> appearance: array<Appearance>;    // [agent]
@group(0) @binding(4) var<storage, read> rig: array<vec4<f32>>;            // [avatar][100]
@group(0) @binding(5) var<storage, read> gaze_frame: array<u32>;           // [agent]
@group(0) @binding(6) var<storage, read> agent_bucket: array<u32>;         // [agent]
@group(0) @binding(7) var<storage, read> mesh_table: array<MeshRange>;     // [bucket]
@group(0) @binding(8) var<storage, read> gait_weights: array<vec4<f32>>;   // [agent]
@group(0) @binding(9) var<storage, read_write> palettes: array<vec4<f32>>; // [visible][22][3] rows
@group(0) @binding(10) var<storage, read_write> expressions: array<Expression>; // [visible]

struct Moment {
    draw: u32,   // random bits of it
    before: u32, // of the one before
    since: f32,  // ms
}

// The last of an agent's irregular moments of a kind.
fn last_moment(seed: u32, window: u32, span: u32) -> Moment {
    let time = frame.gaze_time + seed % window; // agents do not begin together
    let number = time / window;
    let within = time % window;
    let draw = hash_u32(seed + number);
    let before = hash_u32(seed + number - 1u);
    if within >= draw % span {
        return Moment(draw, before, f32(within - draw % span));
    }
    return Moment(before, hash_u32(seed + number - 2u), f32(within + window - before % span));
}

// What an agent looks at in the user's face: how far to the user's right of the middle, and how far below the eyes, m.
fn part_of_face(draw: u32) -> vec2<f32> {
    let part = hash_u32(draw) % 5u;
    return vec2<f32>(select(select(-APART, APART, part < 2u), 0.0, part == 4u), select(0.0, MOUTH, part == 4u));
}

// A glance: yaw and pitch from the middle, mostly small.
fn glance(draw: u32) -> vec2<f32> {
    let bits = hash_u32(draw);
    let x = unit_f32(bits) * 2.0 - 1.0;
    let y = unit_f32(bits << 16u) * 2.0 - 1.0;
    return vec2<f32>(GLANCE_YAW * (x * x * x), GLANCE_PITCH * (y * y * y));
}

// From between an agent's eyes to the point in the user's face that it looks at; `to_eyes` leads between the user's eyes.
fn into_face(agent: u32, to_eyes: vec3<f32>) -> vec3<f32> {
    let ground = sqrt(to_eyes.x * to_eyes.x + to_eyes.z * to_eyes.z);
    if ground < APART || dot3(to_eyes, to_eyes) > FACE_RANGE * FACE_RANGE {
        return to_eyes;
    }
    let last = last_moment(hash_u32(agent ^ FACE), FACE_WINDOW, FACE_SPAN);
    let before = part_of_face(last.before);
    let part = before + (part_of_face(last.draw) - before) * limit(last.since / SACCADE, 0.0, 1.0);
    let aside = part.x / ground;
    return vec3<f32>(to_eyes.x + to_eyes.z * aside, to_eyes.y - part.y, to_eyes.z - to_eyes.x * aside);
}

// Ahead of an agent, so far down.
fn ahead(agent: u32, drop: f32) -> vec3<f32> {
    let last = last_moment(hash_u32(agent ^ GLANCES), GLANCE_WINDOW, GLANCE_SPAN);
    let before = glance(last.before);
    let look = before + (glance(last.draw) - before) * limit(last.since / SACCADE, 0.0, 1.0);
    let yaw = exact_sin_cos(heading[agent] + look.x);
    let pitch = exact_sin_cos(drop + look.y);
    return vec3<f32>(yaw.x * pitch.y, -pitch.x, yaw.y * pitch.y) * FAR;
}

// How far a blink has shut the eyes, 0 to 1.
fn blink(agent: u32) -> f32 {
    let last = last_moment(hash_u32(agent ^ BLINKS), BLINK_WINDOW, BLINK_SPAN);
    return limit(min(last.since / CLOSING, (BLINK - last.since) / OPENING), 0.0, 1.0);
}

// The angle from ahead to a point that lies so far aside and ahead, as (sine, cosine), no farther than a limit.
fn toward(aside: f32, ahead: f32, most: vec2<f32>) -> vec2<f32> {
    if ahead > LEAST && abs(aside) * most.y <= ahead * most.x {
        let length = sqrt(aside * aside + ahead * ahead);
        return vec2<f32>(aside / length, ahead / length);
    }
    return vec2<f32>(select(most.x, -most.x, aside < 0.0), most.y);
}

// A row of the head's matrix after a turn of the mesh about a point: first by pitch, then by yaw, each as (sine, cosine).
fn turned(row: vec4<f32>, about: vec3<f32>, yaw: vec2<f32>, pitch: vec2<f32>) -> vec4<f32> {
    let forward = row.x * yaw.x + row.z * yaw.y;
    let x = row.x * yaw.y - row.z * yaw.x;
    let y = row.y * pitch.y + forward * pitch.x;
    let z = forward * pitch.y - row.y * pitch.x;
    return vec4<f32>(x, y, z, row.w + ((row.x - x) * about.x + (row.y - y) * about.y + (row.z - z) * about.z));
}

// The same by pitch alone.
fn tipped(row: vec4<f32>, about: vec3<f32>, pitch: vec2<f32>) -> vec4<f32> {
    let y = row.y * pitch.y + row.z * pitch.x;
    let z = row.z * pitch.y - row.y * pitch.x;
    return vec4<f32>(row.x, y, z, row.w + ((row.y - y) * about.y + (row.z - z) * about.z));
}

// From -1 to 1.
fn own_part(agent: u32, number: u32) -> f32 {
    return unit_f32(own_draw(agent, OWN_FACE, number)) * 2.0 - 1.0;
}

fn bounded(number: f32) -> f32 {
    return limit(number, -FARTHEST, FARTHEST);
}

// The face of an agent; without emotions as it is at rest.
fn face_of(agent: u32, shown: u32, is_natural: bool) -> Expression {
    if !is_natural {
        return Expression(0.0, 0.0, 0.0, 0.0, 0.0, blink(agent), 0.0, 0.0);
    }
    let moods = moods_of(gait_weights[agent], shown);
    let own = frame.individuals;
    let strength = frame.expression * (1.0 + own * OWN_STRENGTH * own_part(agent, 0u));
    return Expression(
        bounded(dot4(moods, BY_INNER_BROW) * strength + own * OWN_BROW * own_part(agent, 1u)),
        bounded(dot4(moods, BY_OUTER_BROW) * strength + own * OWN_BROW * own_part(agent, 2u)),
        bounded(dot4(moods, BY_UPPER_LID) * strength),
        bounded(dot4(moods, BY_MOUTH_CORNER) * strength + own * OWN_MOUTH * own_part(agent, 3u)),
        bounded(dot4(moods, BY_MOUTH_OPEN) * strength),
        blink(agent),
        limit(dot4(moods, BY_FIST) * strength + own * OWN_FIST * own_part(agent, 4u), 0.0, 1.0),
        0.0,
    );
}

@compute @workgroup_size(64)
fn eyes(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    let agent = visible[slot];
    if agent == NONE {
        return;
    }
    let own = appearance[agent];
    let avatar = avatar_of(own);
    let eyeball = rig[avatar * RIG_STRIDE + RIG_EYEBALL];
    // only the finest mesh has a face
    let finest = mesh_table[avatar * frame.level_count].first_vertex;
    if mesh_table[agent_bucket[agent]].first_vertex != finest {
        return;
    }
    let is_natural = frame.gaze_mode == NATURAL;
    let emotion = emotion_of(own);
    let face = face_of(agent, emotion, is_natural);
    expressions[slot] = face;
    if eyeball.w == 0.0 {
        return;
    }
    let left = eyeball.xyz;
    let right = vec3<f32>(-left.x, left.y, left.z);
    let base = slot * PALETTE_STRIDE;
    let row_x = palettes[base + HEAD * 3u];
    let row_y = palettes[base + HEAD * 3u + 1u];
    let row_z = palettes[base + HEAD * 3u + 2u];
    let feels = is_natural && gazes(own);
    let is_engaged = feels && (gaze_frame[agent] & ENGAGED) != 0u; // `gaze` wrote it in this frame

    var aim: vec3<f32>; // from between the eyes, m
    if is_engaged {
        let x = row_x.y * left.y + row_x.z * left.z + row_x.w;
        let y = row_y.y * left.y + row_y.z * left.z + row_y.w;
        let z = row_z.y * left.y + row_z.z * left.z + row_z.w;
        aim = into_face(agent, vec3<f32>(frame.user_eyes.x - x, frame.user_eyes.y - y, frame.user_eyes.z - z));
    } else {
        var drop = DROP;
        if feels && emotion == SAD {
            drop = exact_atan2(left.y * own.scale * stature_of(own), GROUND_AHEAD); // from the height of eyes that stand upright
        }
        aim = ahead(agent, drop);
    }
    // as the mesh's axes see it: heads are of a size of their own
    let square = row_x.x * row_x.x + row_y.x * row_y.x + row_z.x * row_z.x;
    let to = vec3<f32>(
        (row_x.x * aim.x + row_y.x * aim.y + row_z.x * aim.z) / square,
        (row_x.y * aim.x + row_y.y * aim.y + row_z.y * aim.z) / square,
        (row_x.z * aim.x + row_y.z * aim.y + row_z.z * aim.z) / square,
    );
    var to_pitch = vec2<f32>(0.0, 1.0);
    var to_left = to_pitch;
    var to_right = to_pitch;
    if is_natural {
        to_pitch = toward(-to.y, sqrt(to.x * to.x + to.z * to.z), select(DOWN_LIMIT, UP_LIMIT, to.y > 0.0));
        to_left = toward(to.x - left.x, to.z, ASIDE_LIMIT);
        to_right = toward(to.x - right.x, to.z, ASIDE_LIMIT);
    }
    let open = FOLLOW * to_pitch.x - LID_REACH * face.upper_lid;
    let lid = open + (SHUT - open) * face.blink;

    let tip = exact_sin_cos(lid);
    for (var i = 0u; i < 3u; i++) {
        let row = palettes[base + HEAD * 3u + i];
        palettes[base + LEFT_EYE * 3u + i] = turned(row, left, to_left, to_pitch);
        palettes[base + RIGHT_EYE * 3u + i] = turned(row, right, to_right, to_pitch);
        palettes[base + LIDS * 3u + i] = tipped(row, left, tip);
    }
}
