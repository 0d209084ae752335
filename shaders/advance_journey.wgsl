// uses: step, exact, absent, stages, climb
// Where each agent is on its journey: finds out whether its present stage is done with, goes on to the next, and says what to walk to.
// Who enters an exit is gone from this step on. First kernel of a step, so that the grid holds nobody who is gone.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> stages: array<vec4<f32>>;             // [stage][STAGE_STRIDE] see shared/stages.wgsl
@group(0) @binding(2) var<storage, read_write> position: array<vec2<f32>>;     // [agent] m
@group(0) @binding(3) var<storage, read_write> route: array<vec4<u32>>;        // [agent] first, length | loops << 31, next, arrivals
@group(0) @binding(4) var<storage, read_write> stage_progress: array<u32>;             // [agent] 0, or in a waiting area or the last goal: step of arrival + 1; in a queue: ticket + 1
@group(0) @binding(5) var<storage, read_write> aim: array<vec4<f32>>;          // [agent] x, z, how, flow field or -1
@group(0) @binding(6) var<storage, read_write> queues: array<atomic<u32>>;     // [queue][8] see queue.wgsl
@group(0) @binding(7) var<storage, read> elevation: array<f32>;                // [agent] m

// A place in a region counts as taken within this distance, m,
const STANDING: f32 = 0.3;
// which grows by this, m/s, for who has been in the region for this long, s: two people who stand in each other's way are content
// in the end.
const PATIENCE: f32 = 0.1;
const TRYING: f32 = 20.0;
// People in a line stand this near to their place, and are served from this near to the counter, m.
const IN_LINE: f32 = 0.1;
const AT_COUNTER: f32 = 0.25;

@compute @workgroup_size(64)
fn advance_journey(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= step.agent_count || is_absent(position[agent]) {
        return;
    }
    let at = position[agent];
    var way = route[agent];
    let length = way.y & 0x7fffffffu;
    let loops = (way.y >> 31u) == 1u;
    var stage = way.x + min(way.z, length - 1u);
    if way.z < length && is_done(agent, stage, at) {
        way.z += 1u;
        if way.z == length {
            way.w += 1u;
            if loops {
                way.z = 0u;
            }
        }
        route[agent] = way;
        let stays = way.z == length && stages[stage * STAGE_STRIDE].w == GOAL;
        stage_progress[agent] = select(0u, step.step_index + 1u, stays);
        if stages[stage * STAGE_STRIDE].w == EXIT {
            position[agent] = vec2<f32>(ABSENT, ABSENT);
            return;
        }
        stage = way.x + min(way.z, length - 1u);
    }
    aim[agent] = aim_at(agent, stage, at, !loops && way.z + 1u >= length);
}

// Whether the agent is on the floor of a stage.
fn is_level(agent: u32, stage: u32) -> bool {
    let floor = stages[stage * STAGE_STRIDE + 3u];
    return floor.y == 0.0 || abs(elevation[agent] - floor.x) < STEP;
}

// Whether the agent is done with a stage; begins its wait where it has one.
fn is_done(agent: u32, stage: u32, at: vec2<f32>) -> bool {
    let place = stages[stage * STAGE_STRIDE];
    let is_here = is_level(agent, stage);
    if place.w == WAYPOINT {
        let to = place.xy - at;
        return is_here && dot2(to, to) < place.z * place.z;
    }
    if place.w == QUEUE {
        let line = u32(stages[stage * STAGE_STRIDE + 1u].w) * 8u;
        return stage_progress[agent] > 0u && stage_progress[agent] <= atomicLoad(&queues[line + 1u]);
    }
    let inside = is_here && in_region(at, place.xy, stages[stage * STAGE_STRIDE + 1u]);
    if place.w != WAITING {
        return inside;
    }
    var arrived = stage_progress[agent];
    if arrived == 0u {
        if !inside {
            return false;
        }
        arrived = step.step_index + 1u;
        stage_progress[agent] = arrived;
    }
    let terms = stages[stage * STAGE_STRIDE + 2u];
    return step.step_index + 1u - arrived >= u32(terms.y) && step.step_index >= u32(terms.z);
}

// What an agent on its way to a stage, or in it, walks to.
fn aim_at(agent: u32, stage: u32, at: vec2<f32>, is_last: bool) -> vec4<f32> {
    let place = stages[stage * STAGE_STRIDE];
    let terms = stages[stage * STAGE_STRIDE + 2u];
    if place.w == WAYPOINT {
        return vec4<f32>(place.xy, select(PASS, STOP, is_last), terms.x);
    }
    let axes = stages[stage * STAGE_STRIDE + 1u];
    if place.w == QUEUE {
        return vec4<f32>(line_up(agent, place, axes, at, is_level(agent, stage)), terms.x);
    }
    if place.w == EXIT {
        return vec4<f32>(nearest_place(at, place.xy, axes), PASS, terms.x);
    }
    var how = PASS;
    if is_last || place.w == WAITING {
        how = STANDING;
        if stage_progress[agent] > 0u && in_region(at, place.xy, axes) {
            let inside = f32(step.step_index + 1u - stage_progress[agent]) * step.time_step;
            how += PATIENCE * max(inside - TRYING, 0.0);
        }
    }
    return vec4<f32>(own_place(agent, u32(terms.w), place.xy, axes), how, terms.x);
}

// The place in a line that an agent walks to, x, z, and how: its own, or if it has none the one behind the last, where it asks to be let in. Says
// so when the agent stands at the counter. Neither is said by who is on another floor.
fn line_up(agent: u32, first_place: vec4<f32>, line: vec4<f32>, at: vec2<f32>, is_here: bool) -> vec3<f32> {
    let base = u32(line.w) * 8u;
    let first = atomicLoad(&queues[base + 1u]);
    let ticket = stage_progress[agent];
    if ticket > 0u {
        let number = ticket - 1u - first;
        let place = first_place.xy + f32(number) * line.xy;
        let to = place - at;
        if is_here && number == 0u && dot2(to, to) < AT_COUNTER * AT_COUNTER {
            atomicMax(&queues[base + 3u], 1u);
        }
        return vec3<f32>(place, IN_LINE);
    }
    let last = min(atomicLoad(&queues[base + 2u]) - first, u32(line.z) - 1u);
    let end = first_place.xy + f32(last) * line.xy;
    let to = end - at;
    if is_here && dot2(to, to) < first_place.z * first_place.z {
        atomicMin(&queues[base], agent);
    }
    return vec3<f32>(end, 0.5 * first_place.z);
}
