// uses: step, exact, absent, agent
// Agents led from outside (priority LED): a recording, a robot, a tracked person. The host gives each the place it reaches
// at the end of the step, or marks it as absent. The phases:
//   appear, before the grid: an absent agent appears one step short of its target; one without a target becomes absent
//   steer, after prefer:     the velocity that ends the step at the target, v = (target - p) / dt
// The target is a place, not a displacement, so that rounding does not add up.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> avoidance: array<Avoidance>;                // [agent]
@group(0) @binding(2) var<storage, read> lead: array<Lead>;                          // [agent]
@group(0) @binding(3) var<storage, read_write> position: array<vec2<f32>>;           // [agent] m
@group(0) @binding(4) var<storage, read_write> velocity: array<vec2<f32>>;           // [agent] m/s
@group(0) @binding(5) var<storage, read_write> stance: array<Stance>;                // [agent]
@group(0) @binding(6) var<storage, read_write> preferred_velocity: array<vec2<f32>>; // [agent] m/s
@group(0) @binding(7) var<storage, read> body: array<Body>;                          // [agent]
@group(0) @binding(8) var<storage, read_write> heading: array<f32>;                  // [agent] rad

const WALKING_SPEED: f32 = 0.05; // m/s: an agent that appears faster than this appears in mid-stride

@compute @workgroup_size(64)
fn lead_agents_appear(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= step.agent_count || avoidance[agent].priority < LED {
        return;
    }
    let target_point = lead[agent].place;
    if is_absent(target_point) {
        position[agent] = vec2<f32>(ABSENT, ABSENT);
        velocity[agent] = vec2<f32>(0.0, 0.0);
        return;
    }
    if is_absent(position[agent]) {
        let v = lead[agent].velocity;
        position[agent] = target_point - v * step.time_step;
        velocity[agent] = v;
        let speed = sqrt(dot2(v, v));
        if speed > WALKING_SPEED {
            let phase = stance[agent].phase;
            stance[agent] = Stance();
            stance[agent].phase = phase;
            heading[agent] = exact_atan2(v.x, v.y);
            stance[agent].walk_weight = 1.0;
            stance[agent].stride = stride_at(speed, body[agent].walk_ratio);
        } else {
            stance[agent].walk_weight = 0.0;
        }
    }
}

@compute @workgroup_size(64)
fn lead_agents_steer(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= step.agent_count || avoidance[agent].priority < LED {
        return;
    }
    let here = position[agent];
    if !is_absent(here) {
        preferred_velocity[agent] = (lead[agent].place - here) * step.inverse_time_step;
    }
}
