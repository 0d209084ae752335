// uses: step, exact, absent
// The velocity an agent wants before avoidance: towards its next waypoint at the speed of its gait (v_des), slowing
// only to stop at the last one. Turns to the next waypoint when near. A tiny random part, different for every agent
// and step, breaks exact symmetry (two people head-on would stop for ever).
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> position: array<vec2<f32>>;                   // [agent] m
@group(0) @binding(2) var<storage, read> body: array<vec4<f32>>;                       // [agent] radius, maximum speed, preferred speed, travel per stride
@group(0) @binding(3) var<storage, read> waypoints: array<vec4<f32>>;                  // [waypoint] x, z, radius, 0
@group(0) @binding(4) var<storage, read_write> route: array<vec4<u32>>;                // [agent] first, length | loops << 31, next, arrivals
@group(0) @binding(5) var<storage, read_write> preferred_velocity: array<vec2<f32>>;   // [agent] m/s

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
    var way = route[agent];
    let length = way.y & 0x7fffffffu;
    let loops = (way.y >> 31u) == 1u;
    let at = position[agent];
    var target_point = waypoints[way.x + min(way.z, length - 1u)];
    var to = target_point.xy - at;
    if way.z < length && dot2(to, to) < target_point.z * target_point.z {
        way.z += 1u;
        if way.z == length {
            way.w += 1u;
            if loops {
                way.z = 0u;
            }
        }
        route[agent] = way;
        target_point = waypoints[way.x + min(way.z, length - 1u)];
        to = target_point.xy - at;
    }
    let distance = sqrt(dot2(to, to));
    var speed = body[agent].z;
    if !loops && way.z + 1u >= length {
        speed = min(speed, distance * step.inverse_time_step);
    }
    var wanted = vec2<f32>(0.0, 0.0);
    if distance > 1e-6 {
        wanted = to * (speed / distance);
    }
    let bits = hash_u32(agent ^ hash_u32(step.step_index ^ step.seed));
    let noise = vec2<f32>(unit_f32(bits) - 0.5, unit_f32(hash_u32(bits)) - 0.5);
    preferred_velocity[agent] = wanted + noise * step.perturbation;
}
