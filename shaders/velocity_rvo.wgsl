// uses: step, storey, grid, orca, segments, contact, neighbours, crowding, absent
// A new velocity by reciprocal velocity obstacles, after van den Berg, Lin, Manocha, "Reciprocal Velocity Obstacles for
// Real-Time Multi-Agent Navigation" (2008): of a fixed pattern of velocities v' that the agent can reach in this step
// (|v'| <= v_max, |v' - v| <= a_max dt) the one with the least
//     w max(0, 1 / t(v') - 1 / horizon) + |v_pref - v'|,
// where t is the time until the disc of the other, or the wall, is touched. Of two agents the one with the share s of the
// avoidance looks at v'/s - (1/s - 1) v - v_other (the paper's general reciprocity); a share of 0 (the right of way)
// looks RIGHT_OF_WAY ahead only, of 1
// expects nothing from it, as of the user and of walls. The paper has no horizon; with one the cost has no step where
// neighbours begin to count. Discs that overlap already cost what they lack of coming apart in this step.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> slot_motion: array<vec4<f32>>;        // [slot][2] position, velocity; radius, maximum speed, priority, elevation
@group(0) @binding(2) var<storage, read> slot_manners: array<vec4<u32>>;       // [slot] agent, 1/horizon (bits), neighbour distance (bits), neighbour cap + LED_BIT
@group(0) @binding(3) var<storage, read> cell_start: array<u32>;               // [cell + 1]
@group(0) @binding(4) var<storage, read> preferred_velocity: array<vec2<f32>>; // [agent] m/s
@group(0) @binding(5) var<storage, read> obstacles: array<vec4<f32>>;          // [segment][3], see reference::orca::Segment
@group(0) @binding(6) var<storage, read> obstacle_cells: array<u32>;           // [cell + 1] where the cell's list begins in this array, then the lists
@group(0) @binding(7) var<storage, read_write> new_velocity: array<vec2<f32>>; // [slot] m/s
var<immediate> level: u32;                                                     // what there is in the crowd, see StepUniforms

// Velocities of the pattern: a spiral of the golden angle, which covers a disc evenly.
const PATTERN = 128u;
const GOLDEN = vec2<f32>(-0.7373689, 0.6754903);
// Contacts sooner than a tenth of a second count as that, 1/s.
const SOONEST = 10.0;
// Each m/s that two overlapping discs lack of coming apart costs as much as a collision so many times a second, 1/m: more
// than a contact, or who overlaps with one would stay there for fear of touching the next.
const SEPARATE = 20.0;

// The user and the neighbours: where the disc is (if it overlaps: its direction), what the own relative velocity lacks.
var<private> other_motion: array<vec4<f32>, 11>;
// 1 / share, sum of the radii, speed at which an overlap is to end (0: there is none), 1 / horizon.
var<private> other_traits: array<vec4<f32>, 11>;

@compute @workgroup_size(64)
fn velocity_rvo(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    if slot >= step.agent_count || slot_manners[slot].x == NOBODY {
        return;
    }
    let own = manners_of(slot);
    let motion = slot_motion[slot * 2u];
    if own.is_led {
        new_velocity[slot] = preferred_velocity[own.agent];
    } else {
        new_velocity[slot] = choose(slot, motion, own, neighbours(slot, motion.xy, own));
    }
}

fn choose(slot: u32, motion: vec4<f32>, own: Manners, count: u32) -> vec2<f32> {
    let traits = slot_motion[slot * 2u + 1u];
    let others = look_at_others(slot, motion, own, traits, count);
    let walls = near_segments(motion.xy, step.time_horizon_obstacles * traits.y + traits.x, traits.w);
    // shortened where it is crowded ahead
    var preferred = preferred_velocity[own.agent];
    if (level & CROWDED) != 0u && !has_right_of_way(slot) {
        preferred = crowded(preferred, motion.xy, own.range, own.cap, count);
    }
    let most = step.max_acceleration * step.time_step;
    let axis = unit_or(preferred, unit_or(motion.zw, vec2<f32>(1.0, 0.0)));
    var aim = preferred;
    if walls > 0u {
        // along the nearest wall
        let along = obstacles[segment_numbers[0] * 3u + 1u].xy;
        aim = along * dot2(along, preferred);
    }
    var turn = axis;
    var best = FAR_AWAY;
    var result = motion.zw;
    for (var i = 0u; i < PATTERN + 4u; i++) {
        var candidate = motion.zw; // the present velocity
        if i == 0u {
            candidate = reachable(preferred, motion.zw, most);
        } else if i == 1u {
            candidate = reachable(aim, motion.zw, most);
        } else if i == 2u {
            candidate = reachable(vec2<f32>(0.0, 0.0), motion.zw, most);
        } else if i > 3u {
            candidate = motion.zw + turn * (most * sqrt((f32(i - 4u) + 0.5) / f32(PATTERN)));
            turn = vec2<f32>(turn.x * GOLDEN.x - turn.y * GOLDEN.y, turn.x * GOLDEN.y + turn.y * GOLDEN.x);
        }
        let speed2 = dot2(candidate, candidate);
        if speed2 > traits.y * traits.y {
            candidate = candidate * (traits.y / sqrt(speed2));
        }
        let off = preferred - candidate;
        let distance = sqrt(dot2(off, off));
        if distance < best {
            let cost = distance + danger(candidate, motion, traits.x, others, walls);
            if cost < best {
                best = cost;
                result = candidate;
            }
        }
    }
    return result;
}

// The velocity nearest to `wanted` within `most` m/s of the present one.
fn reachable(wanted: vec2<f32>, present: vec2<f32>, most: f32) -> vec2<f32> {
    let change = wanted - present;
    let length = sqrt(dot2(change, change));
    if length > most {
        return present + change * (most / length);
    }
    return wanted;
}

// What a velocity costs beside its distance from the preferred one.
fn danger(velocity: vec2<f32>, motion: vec4<f32>, radius: f32, others: u32, walls: u32) -> f32 {
    var worst = 0.0;
    var lack = 0.0;
    for (var k = 0u; k < others; k++) {
        let other = other_motion[k];
        let traits = other_traits[k];
        let relative = velocity * traits.x - other.zw;
        if traits.z > 0.0 {
            lack = lack + max(traits.z + dot2(relative, other.xy), 0.0);
        } else {
            worst = max(worst, disc_rate(other.xy, relative, traits.y, SOONEST) - traits.w);
        }
    }
    for (var i = 0u; i < walls; i++) {
        let number = segment_numbers[i] * 3u;
        let ends = obstacles[number];
        let along = obstacles[number + 1u].xy;
        let there = segment_rate(ends.xy - motion.xy, ends.zw - motion.xy, along, velocity, radius, SOONEST);
        worst = max(worst, there - step.inverse_time_horizon_obstacles);
    }
    return step.collision_weight * (worst + SEPARATE * lack);
}

// Notes the user and the neighbours, nearest first; returns how many count.
fn look_at_others(slot: u32, motion: vec4<f32>, own: Manners, traits: vec4<f32>, count: u32) -> u32 {
    let to_user = step.user_position - motion.xy;
    let is_near = dot2(to_user, to_user) < own.range * own.range && on_storey(traits.w, step.user_elevation);
    let users = select(0u, 1u, step.user_radius > 0.0 && is_near);
    var made = 0u;
    for (var k = 0u; k < users + count; k++) {
        let is_user = k < users;
        let other = found[max(k, users) - users];
        let theirs = select(slot_motion[other * 2u], vec4<f32>(step.user_position, step.user_velocity), is_user);
        let their_traits = slot_motion[other * 2u + 1u];
        let share = select(share_of(step.responsibility, traits.z, their_traits.z), 1.0, is_user);
        let has_way = share <= 0.0;
            let factor = 1.0 / select(share, 1.0, has_way);
            let to = theirs.xy - motion.xy;
            let radius = traits.x + select(their_traits.x, step.user_radius, is_user) + step.safety_margin;
            let distance = sqrt(dot2(to, to));
            let offset = motion.zw * (factor - 1.0) + theirs.zw;
            var place = to;
            var apart = 0.0;
            if distance < radius {
                place = unit_or(to, vec2<f32>(select(1.0, -1.0, slot < other || is_user), 0.0));
                apart = min((radius - distance) * step.inverse_time_step, traits.y);
            }
            other_motion[made] = vec4<f32>(place, offset);
            other_traits[made] = vec4<f32>(factor, radius, apart, select(own.rate, max(own.rate, RIGHT_OF_WAY), has_way));
            made++;
    }
    return made;
}
