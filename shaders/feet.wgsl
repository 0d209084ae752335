// uses: frame, exact, quaternion, body, rig, agent, standing
// Puts the feet of every visible agent that walks where its strides have them, and bends the legs to reach them. `pose` has
// drawn the strides of the gaits; people who go slower take shorter ones, and lift and roll their feet less.
// A foot's way is scaled about where it is when the agent stands, so that a foot on the ground still goes back as fast as the
// ground does, and strides of no length are a stand. It turns about the heel while the toes are up, about the ball while the
// heel is. Hips rise and fall less in shorter strides, and the pelvis swings less. In longer ones it swings more, and hips are lower.
//
// A foot that stays behind (see footing) is put there, as high and as steep as the floor is. The hips go with the mean of both
// feet. The pelvis turns half as far as the body does before the feet. The trunk leans; the head does not, but turns ahead.
@group(0) @binding(0) var<uniform> frame: FrameUniforms;
@group(0) @binding(1) var<storage, read> visible: array<u32>;                     // [visible] agents, then NONE
@group(0) @binding(2) var<storage, read> stance: array<Stance>;                   // [agent]
@group(0) @binding(3) var<storage, read> appearance: array<Appearance>;           // [agent]
@group(0) @binding(4) var<storage, read> gait_weights: array<vec4<f32>>;          // [agent]
@group(0) @binding(5) var<storage, read> rig: array<vec4<f32>>;                   // [avatar][68]
@group(0) @binding(6) var<storage, read_write> local_rotations: array<vec4<f32>>; // [visible][17]
@group(0) @binding(7) var<storage, read> heading: array<f32>;                     // [agent] rad

const LEAST_LIFT: f32 = 0.6;    // share of the lift of feet in a stride of no length
const FLATTER: f32 = 1.6;       // slower people land flat sooner than they cease to push off, by this factor
const UPRIGHT: f32 = 0.998;     // height of the hips above feet that stand side by side, share of that at rest
// The share of a leg's length by which it is straighter for a stride shorter by its own length; knees give less at low speeds.
const STRAIGHTER: f32 = 0.09;
const LOWER: f32 = 0.05;        // the same for hips that are lower in a stride longer by its own length
// How much steeper a foot behind stands in a stride longer than usual, share of its pitch for the excess of the square; heels
// rise sooner, but not higher than to the steepest pitch, rad.
const PUSHES_MORE: f32 = 0.9;
const STEEPEST: f32 = 1.17;
// How much farther the pelvis turns and tips in a stride longer than usual, share of what it does for the excess.
const TURNS_MORE: f32 = 2.0;
const REACHES: f32 = 0.9995;    // share of a leg's length: knees do not lock
// Hips sink for a foot that is farther, share of a leg's length: the last degrees of a knee go by fast.
const STRAIGHT: f32 = 0.998;
// How far hips sink for a foot that is out of reach on a level floor, share of a leg's length; a foot beyond that comes along.
const MOST_SUNK: f32 = 0.05;
const LEAST_BEND: f32 = 0.02;   // and do not fold up either, as a share of it
const LEAST_AHEAD: f32 = 0.1;   // cosine of the pitch of a foot beyond which it is left alone
const HEEL: f32 = 0.4;          // from ankle to heel, as a share of the way from ankle to ball
const KNEES_AHEAD: f32 = 0.05;  // sine of a bend that says where a knee points to

const NOT_SEEN: f32 = 0.001;    // m, rad or slope that is left out
const FROM_ANKLES: f32 = 0.4;   // share of a lean that the whole body has, not only the trunk
const PELVIS_STAYS: f32 = 0.5;  // share of the feet's turn that the pelvis takes
const NECK_TURNS: f32 = 0.5;    // share of the head's turn that the neck takes

const LEFT_LEG: u32 = 10u;
const RIGHT_LEG: u32 = 13u;

struct Leg {
    hip: vec3<f32>,   // m, model space
    knee: vec3<f32>,
    ankle: vec3<f32>,
    thigh: vec4<f32>, // model_from_joint
    shin: vec4<f32>,
    foot: vec4<f32>,
}

// A leg as `pose` left it.
fn leg_of(base: u32, avatar: u32, first: u32, root: vec3<f32>, pelvis: vec4<f32>) -> Leg {
    let hip = root + quat_rotate(pelvis, joint_translation(avatar, first));
    let thigh = quat_mul(pelvis, local_rotations[base + first]);
    let knee = hip + quat_rotate(thigh, joint_translation(avatar, first + 1u));
    let shin = quat_mul(thigh, local_rotations[base + first + 1u]);
    let ankle = knee + quat_rotate(shin, joint_translation(avatar, first + 2u));
    return Leg(hip, knee, ankle, thigh, shin, quat_mul(shin, local_rotations[base + first + 2u]));
}

// v turned downwards by an angle, of (sine, cosine), in the upright plane ahead.
fn turned_down(v: vec3<f32>, ahead: vec2<f32>, turn: vec2<f32>) -> vec3<f32> {
    let along = v.x * ahead.x + v.z * ahead.y;
    let aside = v.x * ahead.y - v.z * ahead.x;
    let forth = along * turn.y + v.y * turn.x;
    return vec3<f32>(ahead.x * forth + ahead.y * aside, v.y * turn.y - along * turn.x, ahead.y * forth - ahead.x * aside);
}

// q after which comes the same turn; (sine, cosine) of half its angle.
fn quat_turned_down(q: vec4<f32>, ahead: vec2<f32>, half_turn: vec2<f32>) -> vec4<f32> {
    let x = ahead.y * half_turn.x;
    let z = -(ahead.x * half_turn.x);
    let w = half_turn.y;
    return vec4<f32>(
        w * q.x + x * q.w - z * q.y,
        w * q.y - x * q.z + z * q.x,
        w * q.z + x * q.y + z * q.w,
        w * q.w - x * q.x - z * q.z,
    );
}

// The leg with its ankle and foot where a shorter or longer stride has them; hip and knee stay. `stands` is where the ankle is
// in a stand, to the left and ahead. It rolls in the direction of a foot that will be turned by `turn`.
fn stepped(leg: Leg, avatar: u32, first: u32, stands: vec2<f32>, stride: f32, turn: f32) -> Leg {
    let bind = avatar * RIG_STRIDE + (first + 2u) * 4u + 1u;
    let x = rig[bind];
    let y = rig[bind + 1u];
    let z = rig[bind + 2u];
    // in the mesh
    let ankle = -(x.xyz * x.w + y.xyz * y.w + z.xyz * z.w);
    let ball = rig[avatar * RIG_STRIDE + RIG_BALLS + select(0u, 1u, first == RIGHT_LEG)].xyz - ankle;
    let points = quat_rotate(leg.foot, vec3<f32>(x.z, y.z, z.z));
    let flat = sqrt(points.x * points.x + points.z * points.z);
    if !(flat > LEAST_AHEAD) {
        return leg;
    }
    let ahead = vec2<f32>(points.x / flat, points.z / flat);
    let pitch = exact_atan2(points.y, flat); // toes up
    let heel = vec3<f32>(-(ball.x * HEEL), ball.y, -(ball.z * HEEL));
    let contact = select(ball, heel, pitch > 0.0);
    let arm = quat_rotate(leg.foot, vec3<f32>(dot3(x.xyz, contact), dot3(y.xyz, contact), dot3(z.xyz, contact)));
    let level = turned_down(arm, ahead, exact_sin_cos(pitch));
    let short = max(1.0 - stride, 0.0);
    let slower = 1.0 - stride * stride;
    let slow = max(slower, 0.0); // slow walkers hardly push off
    let steep = min(pitch, 0.0) / STEEPEST;
    let sooner = PUSHES_MORE * min(slower, 0.0) * max(1.0 - steep * steep, 0.0);
    let down = min(pitch, 0.0) * (slow + sooner) + max(pitch, 0.0) * min(FLATTER * slow, 1.0);
    let rolled = turned_down(arm, ahead, exact_sin_cos(down));
    // where the ankle would be above a foot that lies flat
    let above = leg.ankle + arm - level;
    let lift = 1.0 - slow * (1.0 - LEAST_LIFT);
    let there = vec3<f32>(
        above.x + (stands.x - above.x) * short,
        ankle.y + max(above.y - ankle.y, 0.0) * lift,
        stands.y + (above.z - stands.y) * stride,
    );
    var out = leg;
    out.ankle = there + turn_left(exact_sin_cos(turn), level - rolled);
    out.foot = quat_turned_down(leg.foot, ahead, exact_sin_cos(0.5 * down));
    return out;
}

// Where a foot is beside where the gait has it.
struct Off {
    way: vec2<f32>, // m, in the frame of the body: to the left and ahead
    turn: f32,      // rad
    height: f32,    // m
    slope: f32,     // upwards where the foot points to
}

// The leg with its foot so far off.
fn put(leg: Leg, off: Off) -> Leg {
    var out = leg;
    out.ankle = leg.ankle + vec3<f32>(off.way.x, off.height, off.way.y);
    out.foot = quat_before_yaw(off.turn, leg.foot);
    if abs(off.slope) > NOT_SEEN {
        // about the axis across the way that the foot points to: toes up
        let ahead = exact_sin_cos(off.turn);
        out.foot = quat_turned_down(out.foot, ahead, exact_sin_cos(-0.5 * exact_atan2(off.slope, 1.0)));
    }
    return out;
}

// A vector of the world, to the left and ahead of a body with that heading (sine, cosine).
fn to_body(v: vec2<f32>, heading: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(heading.y * v.x - heading.x * v.y, heading.y * v.y + heading.x * v.x);
}

fn is_seen(v: vec2<f32>) -> bool {
    return max(abs(v.x), abs(v.y)) > NOT_SEEN;
}

// Whether anything differs from a straight walk on a level floor.
fn is_off(own: Stance) -> bool {
    return is_seen(own.left) || is_seen(own.right) || is_seen(own.turns) || is_seen(own.lean)
        || is_seen(own.heights) || is_seen(own.slopes) || abs(own.foresight) > NOT_SEEN;
}

// Turns the upper body over its pelvis: what was `before` in model space is `turned` now. The trunk keeps its place in space
// but for the lean. Neck and head do not lean; without the formulas of the paper they turn ahead, to the left.
fn hold_up(base: u32, before: vec4<f32>, turned: vec4<f32>, leans: vec4<f32>, foresight: f32) {
    let trunk = quat_mul(before, local_rotations[base + SPINE]);
    let leaning = quat_mul(leans, trunk);
    local_rotations[base + SPINE] = quat_normalize(quat_mul(quat_conjugate(turned), leaning));
    let is_paper = frame.gaze_mode != 0u;
    if is_paper {
        return;
    }
    let neck = quat_mul(trunk, local_rotations[base + NECK]);
    let ahead = quat_before_yaw(NECK_TURNS * foresight, neck);
    let head = quat_before_yaw(foresight, quat_mul(neck, local_rotations[base + HEAD]));
    local_rotations[base + NECK] = quat_normalize(quat_mul(quat_conjugate(leaning), ahead));
    local_rotations[base + HEAD] = quat_normalize(quat_mul(quat_conjugate(ahead), head));
}

// How much too high a hip is for the leg to reach its ankle, m.
fn overreach(hip: vec3<f32>, ankle: vec3<f32>, longest: f32) -> f32 {
    let x = hip.x - ankle.x;
    let z = hip.z - ankle.z;
    return hip.y - ankle.y - sqrt(max(longest * longest - x * x - z * z, 0.25 * longest * longest));
}

// The rotation that takes the direction of a to that of b.
fn quat_between(a: vec3<f32>, b: vec3<f32>) -> vec4<f32> {
    return quat_normalize(vec4<f32>(cross3(a, b), sqrt(dot3(a, a) * dot3(b, b)) + dot3(a, b)));
}

// Writes the rotations of a leg that goes from a hip to where `after` has ankle and foot; `from` is the same leg before.
fn bend(base: u32, first: u32, before: Leg, after: Leg, hip: vec3<f32>, pelvis: vec4<f32>, left: vec3<f32>) {
    let upper = before.knee - before.hip;
    let lower = before.ankle - before.knee;
    let thigh = sqrt(dot3(upper, upper));
    let shin = sqrt(dot3(lower, lower));
    let way = after.ankle - hip;
    let far = max(sqrt(dot3(way, way)), LEAST_BEND * thigh);
    let straight = way / far;
    let least = abs(thigh - shin) + LEAST_BEND * (thigh + shin);
    let distance = limit(far, least, REACHES * (thigh + shin));
    let along = limit((thigh * thigh - shin * shin + distance * distance) / (2.0 * distance), -thigh, thigh);
    // the plane of the knee is the one that it had
    let hinge = cross3(upper, lower) / (thigh * shin) + left * KNEES_AHEAD;
    let across = hinge - straight * dot3(hinge, straight);
    let axis = across / max(sqrt(dot3(across, across)), 1e-6);
    let knee = straight * along + cross3(straight, axis) * sqrt(max(thigh * thigh - along * along, 0.0));
    let thigh_turn = quat_mul(quat_between(upper, knee), before.thigh);
    let shin_turn = quat_mul(quat_between(lower, straight * distance - knee), before.shin);
    local_rotations[base + first] = quat_normalize(quat_mul(quat_conjugate(pelvis), thigh_turn));
    local_rotations[base + first + 1u] = quat_normalize(quat_mul(quat_conjugate(thigh_turn), shin_turn));
    local_rotations[base + first + 2u] = quat_normalize(quat_mul(quat_conjugate(shin_turn), after.foot));
}

@compute @workgroup_size(64)
fn feet(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    let agent = visible[slot];
    if agent == NONE {
        return;
    }
    let base = slot * POSE_STRIDE;
    let root = local_rotations[base + JOINTS];
    let stride = root.w;
    let own = stance[agent];
    let walk = walk_share(gait_weights[agent], own.walk_weight);
    if !(walk > 0.0 && stride != 1.0) && !is_off(own) {
        return;
    }
    let avatar = avatar_of(appearance[agent]);
    let pelvis = local_rotations[base];
    let left = leg_of(base, avatar, LEFT_LEG, root.xyz, pelvis);
    let right = leg_of(base, avatar, RIGHT_LEG, root.xyz, pelvis);
    let short = walk * max(1.0 - stride, 0.0); // what is missing of a stride
    let rows = avatar * RIG_STRIDE;
    let upright = quat_conjugate(quat_from_rows(rig[rows + 1u].xyz, rig[rows + 2u].xyz, rig[rows + 3u].xyz));
    let upper = left.knee - left.hip;
    let lower = left.ankle - left.knee;
    let leg = sqrt(dot3(upper, upper)) + sqrt(dot3(lower, lower));
    let longest = STRAIGHT * leg;

    let left_hip = rig[rows].xyz + quat_rotate(upright, joint_translation(avatar, LEFT_LEG));
    let right_hip = rig[rows].xyz + quat_rotate(upright, joint_translation(avatar, RIGHT_LEG));
    let middle = (left_hip + right_hip) * 0.5;
    let aside = STANCE_WIDTH * (left_hip.x - middle.x);
    let ahead = left_ahead(stance_of(agent)) * leg;
    let left_stands = vec2<f32>(middle.x + aside, middle.z + ahead);
    let right_stands = vec2<f32>(middle.x - aside, middle.z - ahead);
    let faces = exact_sin_cos(heading[agent]);
    let heights = own.heights / appearance[agent].scale;
    let left_off = Off(to_body(own.left / appearance[agent].scale, faces), own.turns.x, heights.x, own.slopes.x);
    let right_off = Off(to_body(own.right / appearance[agent].scale, faces), own.turns.y, heights.y, own.slopes.y);
    let left_foot = put(stepped(left, avatar, LEFT_LEG, left_stands, stride, own.turns.x), left_off);
    let right_foot = put(stepped(right, avatar, RIGHT_LEG, right_stands, stride, own.turns.y), right_off);

    let turn = PELVIS_STAYS * (0.5 * (own.turns.x + own.turns.y));
    let calms = short + TURNS_MORE * walk * min(1.0 - stride, 0.0);
    let turned = quat_before_yaw(turn, quat_normalize(quat_lerp(pelvis, upright, calms)));
    let lean = to_body(own.lean, faces);
    let height = rig[rows].y * UPRIGHT;
    let swing = 1.0 - short;
    let left_arm = quat_rotate(turned, joint_translation(avatar, LEFT_LEG));
    let right_arm = quat_rotate(turned, joint_translation(avatar, RIGHT_LEG));
    let square = stride * stride;
    let bobs = square * (2.0 - stride);
    let rise = (height - root.y) * (walk * (1.0 - bobs)) + longest * (STRAIGHTER * short * square + LOWER * min(1.0 - stride, 0.0));
    let sways = FROM_ANKLES * height;
    var hips = vec3<f32>(
        root.x + lean.x * sways, root.y + rise + 0.5 * (heights.x + heights.y), root.z * swing + lean.y * sways,
    );
    let sinks = max(overreach(hips + left_arm, left_foot.ankle, longest), overreach(hips + right_arm, right_foot.ankle, longest));
    hips.y = hips.y - limit(sinks, 0.0, MOST_SUNK * leg + abs(heights.x - heights.y));

    let to_the_left = quat_rotate(turned, vec3<f32>(rig[rows + 1u].x, rig[rows + 2u].x, rig[rows + 3u].x));
    bend(base, LEFT_LEG, left, left_foot, hips + left_arm, turned, to_the_left);
    bend(base, RIGHT_LEG, right, right_foot, hips + right_arm, turned, to_the_left);
    hold_up(base, pelvis, turned, quat_pitch_roll(lean.y, -lean.x), own.foresight);
    local_rotations[base] = turned;
    local_rotations[base + JOINTS] = vec4<f32>(hips, stride);
}
