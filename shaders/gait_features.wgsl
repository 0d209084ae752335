// uses: exact, quaternion, body
// The 29 expressive features of many gaits at once, in metres, seconds and degrees (paper, section 3.4; names, order and
// formulas: perception::features). One invocation takes one gait: a whole walk cycle at equal steps of time, on the
// spot; frame 0 follows the last one, a stride further on. A gait with an impossible position or no frames gets zeros
// and is reported.
const POSTURE: u32 = 12u;           // features per frame
const MOVING: u32 = 5u;             // joints whose motion counts
const MOTION: u32 = 15u;            // three orders of each
const ROW: u32 = 8u;                // vectors of a row: 29 features and three zeros
const DEGREES: f32 = 57.29578;      // per radian
const POSITION_LIMIT: f32 = 1000.0; // m; beyond it a float has no millimetres left
const RATE_LIMIT: f32 = 10000.0;    // Hz
const SPEED_LIMIT: f32 = 100.0;     // m/s

@group(0) @binding(0) var<storage, read> gait_frames: array<vec4<f32>>;        // [frame][16] positions, m
@group(0) @binding(1) var<storage, read> gait_table: array<GaitEntry>;         // [gait]
@group(0) @binding(2) var<storage, read_write> feature_rows: array<vec4<f32>>; // [gait][8]
@group(0) @binding(3) var<storage, read_write> failure: array<atomic<u32>>;    // [kernel] smallest gait that failed

// Where the frames of a gait lie.
struct GaitEntry {
    first_frame: u32,
    frames: u32,
    rate: f32,  // frames per second, Hz
    speed: f32, // along +z, m/s
}

fn joint_at(frame: u32, joint: u32) -> vec3<f32> {
    return gait_frames[frame * JOINTS + joint].xyz;
}

fn length3(v: vec3<f32>) -> f32 {
    return sqrt(dot3(v, v));
}

// Angle between two vectors, degrees; 0 where one has no direction.
fn angle3(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return exact_atan2(length3(cross3(a, b)), dot3(a, b)) * DEGREES;
}

fn triangle(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> f32 {
    return 0.5 * length3(cross3(b - a, c - a));
}

// Volume of the box around all joints, the heading (x, z) along one of its sides.
fn box_volume(frame: u32, heading: vec2<f32>) -> f32 {
    var low = vec3<f32>(POSITION_LIMIT * 2.0);
    var high = vec3<f32>(POSITION_LIMIT * -2.0);
    for (var joint = 0u; joint < JOINTS; joint++) {
        let p = joint_at(frame, joint);
        let turned = vec3<f32>(p.x * heading.y - p.z * heading.x, p.y, p.x * heading.x + p.z * heading.y);
        low = select(low, turned, turned < low);
        high = select(high, turned, turned > high);
    }
    let size = high - low;
    return size.x * size.y * size.z;
}

// Whether every position of a frame is a number within the limit.
fn is_usable(frame: u32) -> bool {
    var usable = true;
    for (var joint = 0u; joint < JOINTS; joint++) {
        let p = joint_at(frame, joint);
        usable = usable && abs(p.x) < POSITION_LIMIT && abs(p.y) < POSITION_LIMIT && abs(p.z) < POSITION_LIMIT;
    }
    return usable;
}

@compute @workgroup_size(64)
fn gait_features(@builtin(global_invocation_id) id: vec3<u32>) {
    let gait = id.x;
    if gait >= arrayLength(&gait_table) {
        return;
    }
    let info = gait_table[gait];
    let first = info.first_frame;
    let count = info.frames;
    let rate = info.rate;
    let speed = info.speed;
    let frame_total = arrayLength(&gait_frames) / JOINTS;

    for (var i = 0u; i < ROW; i++) {
        feature_rows[gait * ROW + i] = vec4<f32>();
    }
    var usable = count > 0u && first < frame_total && count <= frame_total - first
        && rate > 0.0 && rate < RATE_LIMIT && abs(speed) < SPEED_LIMIT;
    // where the body faces: across hips and shoulders to the left, turned by a right angle
    var facing = vec2<f32>();
    let checked = select(0u, count, usable);
    for (var i = 0u; i < checked; i++) {
        let frame = first + i;
        usable = usable && is_usable(frame);
        let hips = joint_at(frame, LEFT_HIP) - joint_at(frame, RIGHT_HIP);
        let shoulders = joint_at(frame, LEFT_SHOULDER) - joint_at(frame, RIGHT_SHOULDER);
        facing = vec2<f32>(facing.x - hips.z - shoulders.z, facing.y + hips.x + shoulders.x);
    }
    if !usable {
        atomicMin(&failure[KERNEL_ID], gait);
        return;
    }
    let size = sqrt(dot2(facing, facing));
    var heading = vec2<f32>(0.0, 1.0);
    if size > 1e-6 {
        heading = facing / size;
    }

    var moving = array<u32, 5>(RIGHT_HAND, LEFT_HAND, HEAD, RIGHT_FOOT, LEFT_FOOT);
    var posture = array<f32, 12>();
    var motion = array<f32, 15>();
    var stride = 0.0;
    let travel = speed / rate;
    for (var i = 0u; i < count; i++) {
        let frame = first + i;
        let root = joint_at(frame, ROOT);
        let neck = joint_at(frame, NECK);
        let head = joint_at(frame, HEAD);
        let right = joint_at(frame, RIGHT_SHOULDER);
        let left = joint_at(frame, LEFT_SHOULDER);
        let right_hand = joint_at(frame, RIGHT_HAND);
        let left_hand = joint_at(frame, LEFT_HAND);
        let right_foot = joint_at(frame, RIGHT_FOOT);
        let left_foot = joint_at(frame, LEFT_FOOT);
        posture[0] += box_volume(frame, heading);
        posture[1] += angle3(right - neck, left - neck);
        posture[2] += angle3(neck - right, left - right);
        posture[3] += angle3(neck - left, right - left);
        posture[4] += angle3(head - root, vec3<f32>(0.0, 1.0, 0.0));
        posture[5] += angle3(head - neck, joint_at(frame, SPINE) - neck);
        posture[6] += length3(right_hand - root);
        posture[7] += length3(left_hand - root);
        posture[8] += length3(right_foot - root);
        posture[9] += length3(left_foot - root);
        posture[10] += triangle(left_hand, neck, right_hand);
        posture[11] += triangle(left_foot, root, right_foot);
        let apart = length3(left_foot - right_foot);
        stride = select(stride, apart, apart > stride);

        let frame_b = first + (i + 1u) % count;
        let frame_c = first + (i + 2u) % count;
        let frame_d = first + (i + 3u) % count;
        for (var number = 0u; number < MOVING; number++) {
            let joint = moving[number];
            let b = joint_at(frame_b, joint);
            let c = joint_at(frame_c, joint);
            let first_a = b - joint_at(frame, joint);
            let first_b = c - b;
            let first_c = joint_at(frame_d, joint) - c;
            let second_a = first_b - first_a;
            let second_b = first_c - first_b;
            // over the ground a joint goes along with the walker; the higher differences do not see that
            motion[number] += length3(vec3<f32>(first_a.x, first_a.y, first_a.z + travel));
            motion[MOVING + number] += length3(second_a);
            motion[2u * MOVING + number] += length3(second_b - second_a);
        }
    }

    var row = array<f32, 32>();
    let frames = f32(count);
    for (var i = 0u; i < POSTURE; i++) {
        row[i] = posture[i] / frames;
    }
    row[POSTURE] = stride;
    var per_time = 1.0;
    for (var i = 0u; i < MOTION; i++) {
        if i % MOVING == 0u {
            per_time = per_time * rate;
        }
        row[POSTURE + 1u + i] = motion[i] / frames * per_time;
    }
    row[POSTURE + MOTION + 1u] = frames / rate;
    for (var i = 0u; i < ROW; i++) {
        let at = i * 4u;
        feature_rows[gait * ROW + i] = vec4<f32>(row[at], row[at + 1u], row[at + 2u], row[at + 3u]);
    }
}
