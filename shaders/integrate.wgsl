// uses: step, exact, absent, agent, cells, footing
// Moves each agent along its solved velocity, turns the body towards where it goes at a bounded rate, advances the
// phase of its walk by distance over travel per stride so that feet do not slide (A-25), and blends to standing
// below a threshold speed. A velocity that is not finite is not taken: the agent stays and is reported.
// Strides follow the speed, with a delay. Feet on the ground stay where they are, whatever the body does; who stops or turns on
// the spot takes steps until they are under it.
// The kernel runs last: it empties the cells for the next step, and counts the step.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> new_velocity: array<vec2<f32>>;    // [slot] m/s
@group(0) @binding(2) var<storage, read> agent_slot: array<u32>;            // [agent]
@group(0) @binding(3) var<storage, read> body: array<Body>;                 // [agent]
@group(0) @binding(4) var<storage, read_write> position: array<vec2<f32>>;  // [agent] m
@group(0) @binding(5) var<storage, read_write> velocity: array<vec2<f32>>;  // [agent] m/s
@group(0) @binding(6) var<storage, read_write> stance: array<Stance>;       // [agent]
@group(0) @binding(7) var<storage, read_write> phase: array<u32>;           // [agent] the whole range is one stride
@group(0) @binding(8) var<storage, read_write> failure: array<atomic<u32>>; // [kernel] first agent that failed
@group(0) @binding(9) var<storage, read_write> cells: array<u32>;           // [cell][2] see cells.wgsl
@group(0) @binding(10) var<storage, read_write> step_count: array<u32>;     // [1] steps done

const TURNING_SPEED: f32 = 0.05; // m/s: slower than this the body does not turn
// How fast a body turns to where it goes, share of the difference a second.
const FOLLOW: f32 = 6.0;
// Strides become longer or shorter by at most so much, m/s; but the first of a walk has this share of its length at once.
const STRIDE_RATE: f32 = 1.5;
const STOP_RATE: f32 = 5.0; // m/s, of who does not walk
const FIRST_STRIDE: f32 = 0.7;
const LEAST_STRIDE: f32 = 0.1; // m

@compute @workgroup_size(64)
fn integrate(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x; // and the number of a cell
    if agent == 0u {
        step_count[0] = step.step_index + 1u;
    }
    if agent < step.cell_count {
        cells[CELL_WORDS * agent] = 0u;
        cells[CELL_WORDS * agent + 1u] = 0u;
    }
    if agent >= step.agent_count {
        return;
    }
    if agent_slot[agent] == NOBODY {
        velocity[agent] = vec2<f32>(0.0, 0.0);
        return;
    }
    let v = new_velocity[agent_slot[agent]];
    if !is_finite2(v) {
        atomicMin(&failure[KERNEL_ID], agent);
        velocity[agent] = vec2<f32>(0.0, 0.0);
        return;
    }
    var p = position[agent] + v * step.time_step;
    if step.wrap > 0.0 {
        p = select(p, p - vec2<f32>(step.wrap), p >= vec2<f32>(step.wrap));
        p = select(p, p + vec2<f32>(step.wrap), p < vec2<f32>(0.0));
    }
    position[agent] = p;
    velocity[agent] = v;

    let traits = body[agent];
    let speed = sqrt(dot2(v, v));
    var heading = stance[agent].heading;
    if speed > TURNING_SPEED {
        let most = step.turn_rate * step.time_step;
        let turn = exact_wrap(exact_atan2(v.x, v.y) - heading);
        let follow = min(FOLLOW * step.time_step, 1.0);
        heading = exact_wrap(heading + clamp(turn * follow, -most, most));
    }
    let was = stance[agent];
    let walking = speed > step.walk_speed * traits.preferred_speed;
    let steps = !walking && takes_a_step(was, phase[agent]);
    let blend = select(-step.blend_rate, step.blend_rate, walking || steps) * step.time_step;
    let wanted = stride_at(speed, traits.walk_ratio);
    let longer = select(STOP_RATE, STRIDE_RATE, walking) * step.time_step;
    let stride = max(was.stride + clamp(wanted - was.stride, -longer, longer), FIRST_STRIDE * wanted);
    // 24 bits of a stride, shifted to the top of the word: wraps by itself
    let by_speed = min(speed * step.time_step / max(stride, LEAST_STRIDE), 0.5);
    let strides = select(select(0.0, STEP_RATE * step.time_step, steps), by_speed, walking);
    let before = phase[agent];
    let after = before + (u32(strides * 16777216.0) << 8u);
    phase[agent] = after;

    let stands = !(was.walk_weight > 0.0);
    let went = v * step.time_step;
    let turned = exact_wrap(heading - was.heading);
    let from_turn = exact_sin_cos(was.heading);
    let to_turn = exact_sin_cos(heading);
    let ahead = left_ahead(stance_of(agent)) * LEG;
    let usual = max(stride_at(traits.preferred_speed, traits.walk_ratio), LEAST_STRIDE);
    let lacked = max(1.0 - was.stride / usual, 0.0);
    let lacks = max(1.0 - stride / usual, 0.0);
    let left_way = went + ground_of(after, stride, lacks, 1.0, ahead, to_turn)
        - ground_of(before, was.stride, lacked, 1.0, ahead, from_turn);
    let right_way = went + ground_of(after + HALF, stride, lacks, -1.0, ahead, to_turn)
        - ground_of(before + HALF, was.stride, lacked, -1.0, ahead, from_turn);
    let left = left_over(before, after, stands);
    let right = left_over(before + HALF, after + HALF, stands);
    stance[agent] = Stance(
        heading,
        clamp(was.walk_weight + blend, 0.0, 1.0),
        stays(was.left, left_way, left),
        stays(was.right, right_way, right),
        vec2<f32>(stays_turned(was.turns.x, turned, left), stays_turned(was.turns.y, turned, right)),
        stride,
        0.0,
    );
}
