// uses: step, exact, absent, agent, floors, footing
// How high each agent stands, by the rule of floors.wgsl, and how high the floor is where its feet are or will come down.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> position: array<vec2<f32>>;    // [agent] m
@group(0) @binding(2) var<storage, read> floors: array<vec4<f32>>;      // [floor][9] see floors.wgsl
@group(0) @binding(3) var<storage, read> body: array<Body>;             // [agent]
@group(0) @binding(4) var<storage, read> heading: array<f32>;           // [agent] rad
@group(0) @binding(5) var<storage, read> velocity: array<vec2<f32>>;    // [agent] m/s
@group(0) @binding(6) var<storage, read_write> elevation: array<f32>;   // [agent] m
@group(0) @binding(7) var<storage, read_write> stance: array<Stance>;   // [agent]

const SETTLES: f32 = 14.0;      // of what a foot on the ground is off, a second
const HIGHEST_STEP: f32 = 0.45; // m: a foot is not put on what is farther above or below the floor under the body

struct Sole {
    height: f32, // m, above the floor under the body
    slope: f32,  // upwards where the foot points to
}

// The sole of a foot whose place is `at`, in m, and which points to (sine, cosine); `was` is that of the step before. In a swing
// it comes to the height of the next foothold, early where it goes up and late where it goes down: `left` is the share of the
// way ahead that is left after this step.
fn sole(at: vec2<f32>, under: f32, pointing: vec2<f32>, was: Sole, left: f32) -> Sole {
    let floor = standing(at, under);
    let is_near = abs(floor.height - under) <= HIGHEST_STEP;
    let height = select(0.0, floor.height - under, is_near);
    let slope = select(0.0, dot2(floor.gradient, pointing), is_near);
    let share = select(sqrt(left), left * left, height > was.height);
    return Sole(unless_faint(height + (was.height - height) * share), unless_faint(slope + (was.slope - slope) * left));
}

// The share of its way that a foot has left after a step of so many strides.
fn way_left(since: u32, strides: f32) -> f32 {
    if !is_lifted(since) {
        return max(1.0 - SETTLES * step.time_step, 0.0);
    }
    return left_over(since - (u32(min(strides, 0.5) * 16777216.0) << 8u), since);
}

@compute @workgroup_size(64)
fn elevate(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= step.agent_count || is_absent(position[agent]) {
        return;
    }
    let before = elevation[agent];
    let under = standing(position[agent], before).height;
    elevation[agent] = under;

    let own = stance[agent];
    let faces = heading[agent];
    let going = going_of(agent, own, faces, body[agent]);
    let v = velocity[agent];
    let strides = max(sqrt(dot2(v, v)) / max(own.stride, LEAST_STRIDE), STEP_RATE) * step.time_step;
    let sunk = under - before; // so much higher is the body now, and the feet are not
    let left = sole(
        position[agent] + foothold(going, 1.0) + own.left, under, exact_sin_cos(faces + own.turns.x),
        Sole(own.heights.x - sunk, own.slopes.x), way_left(own.phase, strides),
    );
    let right = sole(
        position[agent] + foothold(going, -1.0) + own.right, under, exact_sin_cos(faces + own.turns.y),
        Sole(own.heights.y - sunk, own.slopes.y), way_left(own.phase + HALF, strides),
    );
    stance[agent].heights = vec2<f32>(left.height, right.height);
    stance[agent].slopes = vec2<f32>(left.slope, right.slope);
}
