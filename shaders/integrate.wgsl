// uses: step, exact, contents, absent, agent, cells, footing
// Moves each agent along its solved velocity, turns the body towards where it goes at a bounded rate, advances the
// phase of its walk by distance over travel per stride so that feet do not slide (A-25), and blends to standing
// below a threshold speed. A velocity that is not finite is not taken: the agent stays and is reported.
// Strides follow the speed, with a delay. Feet on the ground stay where they are, whatever the body does; who stops or turns on
// the spot takes steps until they are under it. Bodies lean where they are pushed to, and heads turn first. Agents without bodies
// move, and that is all.
// The kernel runs last: it empties the cells for the next step, and counts the step.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> new_velocity: array<vec2<f32>>;    // [slot] m/s
@group(0) @binding(2) var<storage, read> agent_slot: array<u32>;            // [agent]
@group(0) @binding(3) var<storage, read> body: array<Body>;                 // [agent]
@group(0) @binding(4) var<storage, read_write> position: array<vec2<f32>>;  // [agent] m
@group(0) @binding(5) var<storage, read_write> velocity: array<vec2<f32>>;  // [agent] m/s
@group(0) @binding(6) var<storage, read_write> stance: array<StanceQuads>;  // [agent]
@group(0) @binding(7) var<storage, read_write> heading: array<f32>;         // [agent] about +y, rad; 0 faces +z
@group(0) @binding(8) var<storage, read_write> failure: array<atomic<u32>>; // [kernel] first agent that failed
@group(0) @binding(9) var<storage, read_write> cells: array<u32>;           // [cell][2] see cells.wgsl
@group(0) @binding(10) var<storage, read_write> step_count: array<u32>;     // [1] steps done

const TURNING_SPEED: f32 = 0.05; // m/s: slower than this the body does not turn
// How fast a body turns to where it goes, share of the difference a second.
const FOLLOW: f32 = 4.5;
// Strides become longer or shorter by at most so much, m/s; but the first of a walk has this share of its length at once.
const STRIDE_RATE: f32 = 1.5;
const STOP_RATE: f32 = 5.0; // m/s, of who does not walk
const FIRST_STRIDE: f32 = 0.7;

const GRAVITY: f32 = 9.81;        // m/s^2: by the lean of an acceleration over it the feet do not have to run ahead
const LEANS: f32 = 0.8;           // share of that lean
const MOST_PUSH: f32 = 1.0;       // m/s^2 along either axis
const LEANS_FOLLOW: f32 = 3.0;    // of the difference a second
const MOST_FORESIGHT: f32 = 0.6;  // rad
const HEADS_FOLLOW: f32 = 12.0;   // of the difference a second

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
    // all reads come before the first write: a GPU then waits for them at once
    let slot = agent_slot[agent];
    let at = position[agent];
    let had = velocity[agent];
    let traits = body[agent];
    var was: Stance;
    var faced = 0.0;
    if (contents & BARE) == 0u {
        was = stance_in(stance[agent]);
        faced = heading[agent];
    }
    if slot == NOBODY {
        velocity[agent] = vec2<f32>(0.0, 0.0);
        return;
    }
    let v = new_velocity[slot];
    if !is_finite2(v) {
        atomicMin(&failure[KERNEL_ID], agent);
        velocity[agent] = vec2<f32>(0.0, 0.0);
        return;
    }
    var p = at + v * step.time_step;
    if step.wrap > 0.0 {
        p = select(p, p - vec2<f32>(step.wrap), p >= vec2<f32>(step.wrap));
        p = select(p, p + vec2<f32>(step.wrap), p < vec2<f32>(0.0));
    }
    position[agent] = p;
    let push = (v - had) * step.inverse_time_step;
    velocity[agent] = v;
    if (contents & BARE) != 0u {
        return;
    }

    let stands = !(was.walk_weight > 0.0);
    let speed = sqrt(dot2(v, v));
    let walking = speed > step.walk_speed * traits.preferred_speed;
    let steps = !walking && takes_a_step(was);
    var now = was;

    var turn = 0.0; // what is left to turn
    if speed > TURNING_SPEED {
        turn = exact_wrap(exact_atan2(v.x, v.y) - faced);
    }
    let most = step.turn_rate * step.time_step;
    let turned = clamp(turn * min(FOLLOW * step.time_step, 1.0), -most, most);
    let faces = exact_wrap(faced + turned);
    heading[agent] = faces;
    let foreseen = clamp(turn, -MOST_FORESIGHT, MOST_FORESIGHT);
    now.foresight = unless_faint(was.foresight + (foreseen - was.foresight) * min(HEADS_FOLLOW * step.time_step, 1.0));
    let leans = clamp(push, vec2<f32>(-MOST_PUSH), vec2<f32>(MOST_PUSH)) * (LEANS / GRAVITY);
    now.lean = unless_faint2(was.lean + (leans - was.lean) * min(LEANS_FOLLOW * step.time_step, 1.0));

    let blend = select(-step.blend_rate, step.blend_rate, walking || steps) * step.time_step;
    now.walk_weight = clamp(was.walk_weight + blend, 0.0, 1.0);
    let wanted = stride_at(speed, traits.walk_ratio);
    let longer = select(STOP_RATE, STRIDE_RATE, walking) * step.time_step;
    now.stride = max(was.stride + clamp(wanted - was.stride, -longer, longer), FIRST_STRIDE * wanted);

    // 24 bits of a stride, shifted to the top of the word: wraps by itself
    let by_speed = min(speed * step.time_step / max(now.stride, LEAST_STRIDE), 0.5);
    let strides = select(select(0.0, STEP_RATE * step.time_step, steps), by_speed, walking);
    let gone = was.phase + (u32(strides * 16777216.0) << 8u);
    now.phase = select(gone, ready_phase(agent, was), stands && !walking && !steps);

    let here = going_of(agent, was, faced, traits);
    let there = going_of(agent, now, faces, traits);
    let went = v * step.time_step;
    let left = left_over(was.phase, now.phase);
    let right = left_over(was.phase + HALF, now.phase + HALF);
    now.left = stays(was.left, went + foothold(there, 1.0) - foothold(here, 1.0), left);
    now.right = stays(was.right, went + foothold(there, -1.0) - foothold(here, -1.0), right);
    now.turns = vec2<f32>(stays_turned(was.turns.x, turned, left), stays_turned(was.turns.y, turned, right));
    stance[agent] = stance_quads(now);
}
