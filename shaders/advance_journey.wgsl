// uses: step, exact, absent, stages, climb, agent, prefer, cells
// Advances the journey of each agent: tests whether its present stage is done, goes on to the next, and aims at it. The aim gives
// the velocity that the agent wants before avoidance. The agent joins the list of its cell.
// An agent that enters an exit is absent from this step on, and on no list. cells must be zero before (integrate leaves it so).
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> stages: array<Stage>;             // [stage]
@group(0) @binding(2) var<storage, read_write> position: array<vec2<f32>>; // [agent] m
@group(0) @binding(3) var<storage, read_write> route: array<Route>;        // [agent]
@group(0) @binding(4) var<storage, read_write> stage_progress: array<u32>; // [agent] 0, or in a waiting area or the last goal: step of arrival + 1; in a queue: ticket + 1
@group(0) @binding(5) var<storage, read_write> queues: array<atomic<u32>>; // [queue][8] see queue.wgsl
@group(0) @binding(6) var<storage, read> elevation: array<f32>;            // [agent] m
@group(0) @binding(7) var<storage, read> body: array<Body>;                // [agent]
@group(0) @binding(8) var<uniform> flow_grid: FlowUniforms;
@group(0) @binding(9) var<storage, read> flow_way: array<u32>;             // [field][cell] see way.wgsl
@group(0) @binding(10) var<storage, read> floors: array<vec4<f32>>;        // [floor][9] see floors.wgsl
@group(0) @binding(11) var<storage, read_write> preferred_velocity: array<vec2<f32>>; // [agent] m/s
@group(0) @binding(12) var<storage, read_write> cells: array<atomic<u32>>; // [cell][2] see cells.wgsl
@group(0) @binding(13) var<storage, read_write> next_in_cell: array<u32>;  // [agent]

// A place in a region counts as taken within this distance, m,
const STANDING: f32 = 0.3;
// which grows at this rate, m/s, once an agent has been in the region for longer than this, s. So two agents that block
// each other both arrive in the end.
const PATIENCE: f32 = 0.1;
const TRYING: f32 = 20.0;
// People in a line stand this near to their place, and are served from this near to the counter, m.
const IN_LINE: f32 = 0.1;
const AT_COUNTER: f32 = 0.25;

@compute @workgroup_size(64)
fn advance_journey(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= step.agent_count {
        return;
    }
    let at = position[agent];
    if is_absent(at) || leaves(agent, at) {
        preferred_velocity[agent] = vec2<f32>(0.0, 0.0);
        return;
    }
    let way = route[agent];
    let length = route_length(way);
    let is_last = !route_loops(way) && way.next + 1u >= length;
    let goal = aim_at(agent, way.first + min(way.next, length - 1u), at, is_last);
    preferred_velocity[agent] = wanted_velocity(agent, at, goal);
    let words = cell_words(at);
    atomicAdd(&cells[words], 1u);
    next_in_cell[agent] = atomicExchange(&cells[words + 1u], agent + 1u);
}

// Goes on to the next stage if the present one is done. Whether that was an exit.
fn leaves(agent: u32, at: vec2<f32>) -> bool {
    var way = route[agent];
    let length = route_length(way);
    let stage = way.first + min(way.next, length - 1u);
    if way.next >= length || !is_done(agent, stage, at) {
        return false;
    }
    way.next += 1u;
    if way.next == length {
        way.arrivals += 1u;
        if route_loops(way) {
            way.next = 0u;
        }
    }
    route[agent] = way;
    let stays = way.next == length && stages[stage].kind == GOAL;
    stage_progress[agent] = select(0u, step.step_index + 1u, stays);
    let is_out = stages[stage].kind == EXIT;
    if is_out {
        position[agent] = vec2<f32>(ABSENT, ABSENT);
    }
    return is_out;
}

// Whether the agent is on the floor of a stage.
fn is_level(agent: u32, stage: u32) -> bool {
    return stages[stage].has_elevation == 0.0 || abs(elevation[agent] - stages[stage].elevation) < STEP;
}

// Whether the agent is done with a stage; begins its wait where it has one.
fn is_done(agent: u32, stage: u32, at: vec2<f32>) -> bool {
    let own = stages[stage];
    let is_here = is_level(agent, stage);
    if own.kind == WAYPOINT {
        let to = own.place - at;
        return is_here && dot2(to, to) < own.radius * own.radius;
    }
    if own.kind == QUEUE {
        let line = u32(own.across.y) * 8u;
        return stage_progress[agent] > 0u && stage_progress[agent] <= atomicLoad(&queues[line + 1u]);
    }
    let inside = is_here && in_region(at, own);
    if own.kind != WAITING {
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
    return step.step_index + 1u - arrived >= u32(own.least_wait) && step.step_index >= u32(own.first_leave);
}

// What an agent on its way to a stage, or in it, walks to.
fn aim_at(agent: u32, stage: u32, at: vec2<f32>, is_last: bool) -> Aim {
    let own = stages[stage];
    if own.kind == WAYPOINT {
        return Aim(own.place, select(PASS, STOP, is_last), own.field);
    }
    if own.kind == QUEUE {
        return line_up(agent, own, at, is_level(agent, stage));
    }
    if own.kind == EXIT {
        return Aim(nearest_place(at, own), PASS, own.field);
    }
    var how = PASS;
    if is_last || own.kind == WAITING {
        how = STANDING;
        if stage_progress[agent] > 0u && in_region(at, own) {
            let inside = f32(step.step_index + 1u - stage_progress[agent]) * step.time_step;
            how += PATIENCE * max(inside - TRYING, 0.0);
        }
    }
    return Aim(own_place(agent, own), how, own.field);
}

// Returns the place in a line that an agent walks to. An agent without a ticket walks to the place behind the last and asks
// to join there. The function also marks an agent at the counter. An agent on another floor neither asks nor marks.
fn line_up(agent: u32, line: Stage, at: vec2<f32>, is_here: bool) -> Aim {
    let base = u32(line.across.y) * 8u;
    let first = atomicLoad(&queues[base + 1u]);
    let ticket = stage_progress[agent];
    if ticket > 0u {
        let number = ticket - 1u - first;
        let place = line.place + f32(number) * line.along;
        let to = place - at;
        if is_here && number == 0u && dot2(to, to) < AT_COUNTER * AT_COUNTER {
            atomicMax(&queues[base + 3u], 1u);
        }
        return Aim(place, IN_LINE, line.field);
    }
    let last = min(atomicLoad(&queues[base + 2u]) - first, u32(line.across.x) - 1u);
    let end = line.place + f32(last) * line.along;
    let to = end - at;
    if is_here && dot2(to, to) < line.radius * line.radius {
        atomicMin(&queues[base], agent);
    }
    return Aim(end, 0.5 * line.radius, line.field);
}
