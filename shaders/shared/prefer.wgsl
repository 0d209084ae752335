// uses: step, exact, stages, follow, floors, agent
// The velocity an agent wants before avoidance: towards its aim at the speed of its gait (v_des), slower only to stop there.
// A tiny random part, different for every agent and step, breaks exact symmetry: two agents head-on would stop for ever. An
// agent that has reached a place of its own stands still.
// Needs the bindings step, body, elevation, flow_grid, flow_way and floors. Twin: reference::prefer.

// How fast people come to a place where they will stand: this share of the distance a second.
const APPROACH: f32 = 2.0;

// What an agent walks to.
struct Aim {
    place: vec2<f32>, // m
    how: f32,         // PASS, STOP, or above 0 the distance within which it stands, m (stages.wgsl)
    field: f32,       // number of the flow field that leads there, or -1
}

fn wanted_velocity(agent: u32, at: vec2<f32>, goal: Aim) -> vec2<f32> {
    let to = goal.place - at;
    let distance = sqrt(dot2(to, to));
    var speed = body[agent].preferred_speed;
    if goal.how == STOP {
        speed = min(speed, distance * step.inverse_time_step);
    }
    if goal.how > 0.0 {
        if distance < goal.how {
            return vec2<f32>(0.0, 0.0);
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
    return wanted + noise * step.perturbation;
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
