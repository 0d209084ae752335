// uses: step, grid, orca, segments, neighbours, crowding, absent
// The velocity nearest to the preferred one that avoids neighbours, obstacles and the user: ORCA (2011).
// The preferred one is shortened first where it is crowded ahead.
// An agent that is led from outside (priority LED) takes the velocity it is given.
//
// The lines would be faster in registers, too, but unrolling the linear program makes a kernel so long that one driver,
// SwiftShader, needs more than 20 GiB to compile it.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> slot_motion: array<vec4<f32>>;        // [slot][2] position, velocity; radius, maximum speed, priority, elevation
@group(0) @binding(2) var<storage, read> slot_agent: array<u32>;               // [slot]
@group(0) @binding(3) var<storage, read> cell_start: array<u32>;               // [cell + 1]
@group(0) @binding(4) var<storage, read> preferred_velocity: array<vec2<f32>>; // [agent] m/s
@group(0) @binding(5) var<storage, read> obstacles: array<vec4<f32>>;          // [segment][3], see reference::orca::Segment
@group(0) @binding(6) var<storage, read> obstacle_cells: array<u32>;           // [cell + 1] where the cell's list begins in this array, then the lists
@group(0) @binding(7) var<storage, read> manners: array<vec4<f32>>;            // [agent] 1/horizon, neighbour distance, neighbour cap, priority
@group(0) @binding(8) var<storage, read_write> new_velocity: array<vec2<f32>>; // [slot] m/s
var<immediate> level: u32;                                                     // 1: people walk above one another

// An agent slower than this share of its maximum speed is in a jam.
const JAM_SPEED = 0.45;

@compute @workgroup_size(64)
fn velocity_orca(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    if slot >= step.agent_count || slot_agent[slot] == NOBODY {
        return;
    }
    let agent = slot_agent[slot];
    let motion = slot_motion[slot * 2u];
    let own = manners[agent];
    if own.w >= LED {
        new_velocity[slot] = preferred_velocity[agent];
    } else {
        let count = neighbours(slot, motion.xy, own.y, u32(own.z));
        var wanted = preferred_velocity[agent];
        if !has_right_of_way(slot, own.w) {
            wanted = crowded(wanted, motion.xy, own.y, u32(own.z), count);
        }
        new_velocity[slot] = avoid(slot, motion, own, wanted, count);
    }
}

fn avoid(slot: u32, motion: vec4<f32>, own: vec4<f32>, preferred: vec2<f32>, count: u32) -> vec2<f32> {
    let traits = slot_motion[slot * 2u + 1u];
    let hard = obstacle_lines(motion.xy, motion.zw, traits);
    let to_user = step.user_position - motion.xy;
    let is_near = dot2(to_user, to_user) < own.y * own.y;
    let users = select(0u, 1u, step.user_radius > 0.0 && is_near);
    let made = hard + users + count;
    let is_slow = dot2(motion.zw, motion.zw) < JAM_SPEED * JAM_SPEED * traits.y * traits.y;
    var rate = own.x;
    var solved = Solved(motion.zw, 0u);
    var again = true;
    for (var attempt = 0u; attempt < 3u && again; attempt++) {
        other_lines(hard, users, users + count, slot, motion, traits, rate);
        solved = within(0u, made, traits.y, preferred, false);
        // Too crowded to plan that far: plan less far. What is near then counts for more than what is far.
        var next = 0.0;
        if attempt == 0u {
            next = step.inverse_time_horizon_dense;
        } else if attempt == 1u && is_slow {
            next = step.inverse_time_horizon_jam;
        }
        again = solved.satisfied < made && next > 0.0;
        rate = next;
    }
    return least_bad(made, hard, solved.satisfied, traits.y, solved.velocity);
}

// Lines of the user (if `users` is 1), who takes none of the avoidance, so the agent takes all, and of the neighbours,
// nearest first, from line `first` on. Of two agents the one of lower priority takes more.
fn other_lines(first: u32, users: u32, count: u32, slot: u32, motion: vec4<f32>, traits: vec4<f32>, rate: f32) {
    for (var k = 0u; k < count; k++) {
        let is_user = k < users;
        let other = found[max(k, users) - users];
        let theirs = select(slot_motion[other * 2u], vec4<f32>(step.user_position, step.user_velocity), is_user);
        let their_traits = slot_motion[other * 2u + 1u];
        let their_radius = select(their_traits.x, step.user_radius, is_user);
        let share = share_of(step.responsibility, traits.z, their_traits.z);
        let has_way = share <= 0.0 && !is_user;
        lines[first + k] = agent_line(
            motion.zw,
            theirs.xy - motion.xy,
            motion.zw - theirs.zw,
            traits.x + their_radius + step.safety_margin,
            select(rate, max(rate, RIGHT_OF_WAY), has_way),
            step.inverse_time_step,
            select(share, 1.0, is_user || has_way),
            select(-1.0, 1.0, slot < other || is_user),
        );
    }
}

// Lines of the nearest obstacle segments, by (squared distance, number). Returns how many.
fn obstacle_lines(at: vec2<f32>, velocity: vec2<f32>, traits: vec4<f32>) -> u32 {
    let radius = traits.x;
    let count = near_segments(at, step.time_horizon_obstacles * traits.y + radius, traits.w);
    var made = 0u;
    for (var i = 0u; i < count; i++) {
        let number = segment_numbers[i] * 3u;
        let ends = obstacles[number];
        let directions = obstacles[number + 1u];
        let corners = obstacles[number + 2u];
        let segment = Segment(ends.xy, ends.zw, directions.xy, directions.zw, corners.xy, corners.z > 0.0, corners.w > 0.0);
        let line = obstacle_line(made, segment, at, velocity, radius, step.inverse_time_horizon_obstacles);
        if line.is_there {
            lines[made] = line.line;
            made++;
        }
    }
    return made;
}
