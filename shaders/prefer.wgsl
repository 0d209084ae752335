// uses: step, exact, absent, stages, follow, floors, agent
// The velocity an agent wants before avoidance: towards its aim at the speed of its gait (v_des), slower only to stop there.
// A tiny random part, different for every agent and step, breaks exact symmetry: two agents head-on would stop for ever. An
// agent that has reached a place of its own stands still.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> position: array<vec2<f32>>;                 // [agent] m
@group(0) @binding(2) var<storage, read> body: array<Body>;                          // [agent]
@group(0) @binding(3) var<storage, read> aim: array<Aim>;                            // [agent]
@group(0) @binding(4) var<storage, read_write> preferred_velocity: array<vec2<f32>>; // [agent] m/s
@group(0) @binding(5) var<uniform> flow_grid: FlowUniforms;
@group(0) @binding(6) var<storage, read> flow_way: array<u32>;                       // [field][cell] see way.wgsl
@group(0) @binding(7) var<storage, read> elevation: array<f32>;                      // [agent] m
@group(0) @binding(8) var<storage, read> floors: array<vec4<f32>>;                   // [floor][9] see floors.wgsl

// How fast people come to a place where they will stand: this share of the distance a second.
const APPROACH: f32 = 2.0;

@compute @workgroup_size(64)
fn prefer(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= step.agent_count {
        return;
    }
    if is_absent(position[agent]) {
        preferred_velocity[agent] = vec2<f32>(0.0, 0.0);
        return;
    }
    let at = position[agent];
    let goal = aim[agent];
    let to = goal.place - at;
    let distance = sqrt(dot2(to, to));
    var speed = body[agent].preferred_speed;
    if goal.how == STOP {
        speed = min(speed, distance * step.inverse_time_step);
    }
    if goal.how > 0.0 {
        if distance < goal.how {
            preferred_velocity[agent] = vec2<f32>(0.0, 0.0);
            return;
        }
        speed = min(speed, distance * APPROACH);
    }
    let direction = direction_to(agent, at, goal);
    let length = sqrt(dot2(direction, direction));
    var wanted = vec2<f32>(0.0, 0.0);
    if length > 1e-6 {
        wanted = direction * (speed / length);
    }
    let bits = hash_u32(agent ^ hash_u32(step.step_index ^ step.seed));
    let noise = vec2<f32>(unit_f32(bits) - 0.5, unit_f32(hash_u32(bits)) - 0.5);
    preferred_velocity[agent] = wanted + noise * step.perturbation;
}

// The direction from a point towards an aim, of any length: along its flow field if it has one, else straight.
fn direction_to(agent: u32, at: vec2<f32>, goal: Aim) -> vec2<f32> {
    if goal.field < 0.0 {
        return goal.place - at;
    }
    var sheet = 0u;
    if flow_grid.sheet_rows < flow_grid.rows {
        sheet = u32(standing(at, elevation[agent]).sheet);
    }
    return flow_direction(u32(goal.field), sheet, at, goal.place - at);
}
