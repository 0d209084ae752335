// uses: step, storey, contents, grid, orca, segments, contact, neighbours, unsolved, crowding, absent, agent
// A new velocity by reciprocal velocity obstacles, after van den Berg, Lin, Manocha, "Reciprocal Velocity Obstacles for
// Real-Time Multi-Agent Navigation" (2008): of some velocities v' that the agent can reach in this step
// (|v'| <= v_max, |v' - v| <= a_max dt) the one with the least
//     w max(0, 1 / t(v') - 1 / horizon) + |v_pref - v'|,
// where t is the time until the disc of the other, or the wall, is touched. Of two agents the one with the share s of the
// avoidance looks at v'/s - (1/s - 1) v - v_other (the paper's general reciprocity); a share of 0 (the right of way)
// looks RIGHT_OF_WAY ahead only, of 1
// expects nothing from it, as of the user and of walls. The paper has no horizon; with one the cost has no step where
// neighbours begin to count. Discs that overlap already cost what they lack of coming apart in this step.
//
// The reachable velocity nearest to the preferred one is taken if it costs nothing else: nothing can be better. The other
// agents are put on a list, and a second phase (again) tries a pattern of velocities for them. Four velocities are looked at
// together, so that a neighbour is read once for all four.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> slot_position: array<vec2<f32>>;      // [slot] m
@group(0) @binding(2) var<storage, read> slot_motion: array<SlotMotion>;       // [slot]
@group(0) @binding(3) var<storage, read> avoidance: array<Avoidance>;          // [agent]
@group(0) @binding(4) var<storage, read> cell_start: array<u32>;               // [cell + 1]
@group(0) @binding(5) var<storage, read> preferred_velocity: array<vec2<f32>>; // [agent] m/s
@group(0) @binding(6) var<storage, read> obstacles: array<Segment>;            // [segment]
@group(0) @binding(7) var<storage, read> obstacle_cells: array<u32>;           // [cell + 1] where the cell's list begins in this array, then the lists
@group(0) @binding(8) var<storage, read_write> new_velocity: array<vec2<f32>>; // [slot] m/s
@group(0) @binding(9) var<storage, read_write> unsolved: array<atomic<u32>>;   // see unsolved.wgsl

// Fours of velocities of the pattern: a spiral of the golden angle, which covers a disc evenly. More are not better: see
// reference::velocity_rvo.
const FOURS: u32 = 10u;
// Cosine and sine of the golden angle, and of four times it.
const GOLDEN: vec2<f32> = vec2<f32>(-0.7373689, 0.6754903);
const GOLDEN_4: vec2<f32> = vec2<f32>(-0.9847135, -0.17418195);
// Contacts sooner than a tenth of a second count as that, 1/s.
const SOONEST: f32 = 10.0;
// Each m/s that two overlapping discs lack of coming apart costs as much as a collision so many times a second, 1/m. It costs
// more than a contact. Otherwise an agent in an overlap would stay there for fear of touching the next.
const SEPARATE: f32 = 20.0;

// The user and the neighbours that can matter: where the disc is (if it overlaps: its direction), what the own relative
// velocity lacks.
var<private> other_motion: array<vec4<f32>, 11>;
// 1 / share, sum of the radii, speed at which an overlap is to end (0: there is none), 1 / horizon.
var<private> other_traits: array<vec4<f32>, 11>;

// What an agent looks at.
struct Walker {
    at: vec2<f32>,        // m
    motion: SlotMotion,
    preferred: vec2<f32>, // m/s
    most: f32,            // change of velocity in a step, m/s
    others: u32,
    walls: u32,
}

// The best velocity so far, and what it costs.
struct Best {
    velocity: vec2<f32>,
    cost: f32,
}

// Four velocities.
struct Four {
    x: vec4<f32>,
    y: vec4<f32>,
}

@compute @workgroup_size(64)
fn velocity_rvo(@builtin(global_invocation_id) id: vec3<u32>) {
    avoid(id.x, false);
}

@compute @workgroup_size(64)
fn velocity_rvo_again(@builtin(global_invocation_id) id: vec3<u32>) {
    let entry = left_to(id.x);
    if entry != NO_ENTRY {
        avoid(entry, true);
    }
}

fn avoid(entry: u32, again: bool) {
    let reach = entry >> REACH_SHIFT;
    let slot = entry - (reach << REACH_SHIFT);
    if slot >= step.agent_count || slot_motion[slot].agent == NOBODY {
        return;
    }
    let own = seeker_of(slot);
    var preferred = preferred_velocity[own.agent];
    if own.is_led {
        new_velocity[slot] = preferred;
        return;
    }
    let at = slot_position[slot];
    let motion = slot_motion[slot];
    var count = UNSURE;
    if again && reach > 0u {
        count = far_neighbours(slot, at, own, i32(reach));
    } else {
        count = quick_neighbours(slot, at, own);
        if count == UNSURE {
            leave(slot, max(next_reach, 1u));
            return;
        }
    }
    // shortened where it is crowded ahead
    if (contents & CROWDED) != 0u && !has_right_of_way(slot) {
        preferred = crowded(slot, preferred, own.range, own.cap, count);
    }
    var me = Walker(at, motion, preferred, step.max_acceleration * step.time_step, 0u, 0u);
    me.others = look_at_others(slot, me, own, count);
    if (contents & WALLS) != 0u {
        me.walls = near_segments(at, step.time_horizon_obstacles * motion.max_speed + motion.radius, motion.elevation);
    }
    let wanted = slowed(reachable(four(preferred), me), me);
    if danger(wanted, me).x <= 0.0 {
        new_velocity[slot] = vec2<f32>(wanted.x.x, wanted.y.x);
    } else if again {
        new_velocity[slot] = choose(me);
    } else {
        leave(slot, 0u);
    }
}

fn choose(me: Walker) -> vec2<f32> {
    let present = me.motion.velocity;
    var aim = me.preferred;
    if me.walls > 0u {
        // along the nearest wall
        let along = obstacles[segment_numbers[0]].along;
        aim = along * dot2(along, me.preferred);
    }
    var best = Best(present, FAR_AWAY);
    // as wanted, along the wall, stopping, going on
    let first = Four(vec4<f32>(me.preferred.x, aim.x, 0.0, present.x), vec4<f32>(me.preferred.y, aim.y, 0.0, present.y));
    best = better(best, reachable(first, me), me);
    let start = unit_or(me.preferred, unit_or(present, vec2<f32>(1.0, 0.0)));
    let second = turned(start, GOLDEN);
    let third = turned(second, GOLDEN);
    let fourth = turned(third, GOLDEN);
    var turn = Four(vec4<f32>(start.x, second.x, third.x, fourth.x), vec4<f32>(start.y, second.y, third.y, fourth.y));
    let halves = vec4<f32>(0.5, 1.5, 2.5, 3.5);
    for (var i = 0u; i < FOURS; i++) {
        let length = me.most * sqrt((f32(4u * i) + halves) / f32(4u * FOURS));
        best = better(best, Four(present.x + turn.x * length, present.y + turn.y * length), me);
        turn = turned_four(turn);
    }
    return best.velocity;
}

fn turned(v: vec2<f32>, by: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(v.x * by.x - v.y * by.y, v.x * by.y + v.y * by.x);
}

fn turned_four(v: Four) -> Four {
    return Four(v.x * GOLDEN_4.x - v.y * GOLDEN_4.y, v.x * GOLDEN_4.y + v.y * GOLDEN_4.x);
}

fn four(v: vec2<f32>) -> Four {
    return Four(vec4<f32>(v.x), vec4<f32>(v.y));
}

// The best so far and four velocities: whichever costs least, the first of those that cost the same.
fn better(before: Best, wanted: Four, me: Walker) -> Best {
    let candidates = slowed(wanted, me);
    let off_x = me.preferred.x - candidates.x;
    let off_y = me.preferred.y - candidates.y;
    let cost = sqrt(off_x * off_x + off_y * off_y) + danger(candidates, me);
    var best = before;
    if cost.x < best.cost {
        best = Best(vec2<f32>(candidates.x.x, candidates.y.x), cost.x);
    }
    if cost.y < best.cost {
        best = Best(vec2<f32>(candidates.x.y, candidates.y.y), cost.y);
    }
    if cost.z < best.cost {
        best = Best(vec2<f32>(candidates.x.z, candidates.y.z), cost.z);
    }
    if cost.w < best.cost {
        best = Best(vec2<f32>(candidates.x.w, candidates.y.w), cost.w);
    }
    return best;
}

// The velocities nearest to these within `most` m/s of the present one.
fn reachable(wanted: Four, me: Walker) -> Four {
    let change_x = wanted.x - me.motion.velocity.x;
    let change_y = wanted.y - me.motion.velocity.y;
    let length = sqrt(change_x * change_x + change_y * change_y);
    let is_far = length > vec4<f32>(me.most);
    let scale = me.most / select(vec4<f32>(1.0), length, is_far);
    return Four(
        select(wanted.x, me.motion.velocity.x + change_x * scale, is_far),
        select(wanted.y, me.motion.velocity.y + change_y * scale, is_far),
    );
}

// Not faster than the agent can walk.
fn slowed(v: Four, me: Walker) -> Four {
    let speed2 = v.x * v.x + v.y * v.y;
    let is_fast = speed2 > vec4<f32>(me.motion.max_speed * me.motion.max_speed);
    let scale = me.motion.max_speed / sqrt(select(vec4<f32>(1.0), speed2, is_fast));
    return Four(select(v.x, v.x * scale, is_fast), select(v.y, v.y * scale, is_fast));
}

// What velocities cost beside their distance from the preferred one.
fn danger(v: Four, me: Walker) -> vec4<f32> {
    var worst = vec4<f32>(0.0);
    var lack = vec4<f32>(0.0);
    for (var k = 0u; k < me.others; k++) {
        let other = other_motion[k];
        let traits = other_traits[k];
        let x = v.x * traits.x - other.z;
        let y = v.y * traits.x - other.w;
        if traits.z > 0.0 {
            lack = lack + max(traits.z + (x * other.x + y * other.y), vec4<f32>(0.0));
        } else {
            worst = max(worst, disc_rates(other.xy, x, y, traits.y, SOONEST) - traits.w);
        }
    }
    for (var i = 0u; i < me.walls; i++) {
        let wall = obstacles[segment_numbers[i]];
        let there = segment_rates(wall.a - me.at, wall.b - me.at, wall.along, v.x, v.y, me.motion.radius, SOONEST);
        worst = max(worst, there - step.inverse_time_horizon_obstacles);
    }
    return step.collision_weight * (worst + SEPARATE * lack);
}

// Notes the user and the neighbours that can matter, nearest first; returns how many. The list leaves out a neighbour that
// cannot come nearer than its horizon allows, whichever velocity the agent chooses.
fn look_at_others(slot: u32, me: Walker, own: Seeker, count: u32) -> u32 {
    let at = me.at;
    let to_user = step.user_position - at;
    var users = 0u;
    if (contents & USER) != 0u {
        users = u32(dot2(to_user, to_user) < own.range * own.range && on_storey(me.motion.elevation, step.user_elevation));
    }
    // an agent above its maximum speed slows down by more than `most`
    let excess = max(sqrt(dot2(me.motion.velocity, me.motion.velocity)) - me.motion.max_speed, 0.0);
    let change = me.most + excess;
    var made = 0u;
    for (var k = 0u; k < users + count; k++) {
        let is_user = k < users;
        let other = select(found[max(k, users) - users], slot, is_user); // any slot stands for the user
        let them = slot_motion[other];
        let their_position = select(slot_position[other], step.user_position, is_user);
        let their_velocity = select(them.velocity, step.user_velocity, is_user);
        let is_mate = (contents & GROUPS) != 0u && !is_user && is_with(slot, other);
        var share = step.responsibility;
        // priorities do not count within a group
        if (contents & UNLIKE) != 0u && !is_mate {
            share = share_of(step.responsibility, them.priority - me.motion.priority);
        }
        share = select(share, 1.0, is_user);
        let has_way = share <= 0.0;
        let factor = 1.0 / select(share, 1.0, has_way);
        var rate = select(own.rate, max(own.rate, RIGHT_OF_WAY), has_way);
        if is_mate {
            rate = max(rate, TOGETHER); // members of a group walk near one another on purpose
        }
        let to = their_position - at;
        let radius = me.motion.radius + select(them.radius, step.user_radius, is_user) + step.safety_margin;
        let distance = sqrt(dot2(to, to));
        let offset = me.motion.velocity * (factor - 1.0) + their_velocity;
        var place = to;
        var apart = 0.0;
        var matters = true;
        if distance < radius {
            place = unit_or(to, vec2<f32>(select(1.0, -1.0, slot < other || is_user), 0.0));
            apart = min((radius - distance) * step.inverse_time_step, me.motion.max_speed);
        } else {
            let closing = dot2(to, me.motion.velocity - their_velocity) + change * factor * distance;
            matters = closing > SAFE * rate * (distance - radius) * distance;
        }
        if matters {
            other_motion[made] = vec4<f32>(place, offset);
            other_traits[made] = vec4<f32>(factor, radius, apart, rate);
            made++;
        }
    }
    return made;
}
