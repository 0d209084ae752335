// uses: step, storey, contents, grid, orca, segments, neighbours, unsolved, crowding, precedence, absent, agent
// The velocity nearest to the preferred one that avoids neighbours, obstacles and the user: ORCA (2011).
// The preferred one is shortened first where it is crowded ahead.
// An agent that is led from outside (priority LED) takes the velocity it is given.
//
// Most agents can keep all their lines. The others, one in ten in a crossing, have to try again, which takes longer than
// all before, and some have to look farther for neighbours. They are put on two lists, and a second phase (again) does them
// side by side, since an invocation waits for the slowest beside it.
//
// The lines would be faster in registers, too, but unrolling the linear program makes a kernel so long that one driver,
// SwiftShader, needs more than 20 GiB to compile it.
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

// An agent slower than this share of its maximum speed is in a jam.
const JAM_SPEED: f32 = 0.45;

@compute @workgroup_size(64)
fn velocity_orca(@builtin(global_invocation_id) id: vec3<u32>) {
    avoid(id.x, false);
}

@compute @workgroup_size(64)
fn velocity_orca_again(@builtin(global_invocation_id) id: vec3<u32>) {
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
    var wanted = preferred_velocity[own.agent];
    if own.is_led {
        new_velocity[slot] = wanted;
        return;
    }
    let at = slot_position[slot];
    let me = slot_motion[slot];
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
    if (contents & CROWDED) != 0u && !has_right_of_way(slot) {
        wanted = crowded(slot, wanted, own.range, own.cap, count);
    }
    var hard = 0u;
    if (contents & WALLS) != 0u {
        hard = obstacle_lines(at, me);
    }
    var users = 0u;
    if (contents & USER) != 0u {
        let to_user = step.user_position - at;
        users = u32(dot2(to_user, to_user) < own.range * own.range && on_storey(me.elevation, step.user_elevation));
    }
    let others = Others(slot, at, me, hard, users, users + count);
    if again {
        // without a shorter horizon the first attempt is all there is
        let first = select(1u, 0u, reach > 0u || step.inverse_time_horizon_dense <= 0.0);
        new_velocity[slot] = try_on(others, own.rate, wanted, first);
    } else {
        other_lines(others, own.rate, wanted, false);
        let solved = within(0u, hard + others.count, me.max_speed, wanted, false);
        new_velocity[slot] = solved.velocity;
        let is_stuck = (contents & CROWDED) != 0u && step.inverse_time_horizon_dense > 0.0 && gets_nowhere(solved.velocity, wanted);
        if solved.satisfied < hard + others.count || is_stuck {
            leave(slot, 0u);
        }
    }
}

// The attempts from number `first` on. In a crowd too dense to plan that far, or without progress, an agent plans less far.
// It then applies precedence: near neighbours count for more than far ones.
fn try_on(others: Others, own_rate: f32, preferred: vec2<f32>, first: u32) -> vec2<f32> {
    let max_speed = others.me.max_speed;
    let made = others.hard + others.count;
    let velocity = others.me.velocity;
    let is_slow = dot2(velocity, velocity) < JAM_SPEED * JAM_SPEED * max_speed * max_speed;
    var rate = select(step.inverse_time_horizon_dense, own_rate, first == 0u);
    var solved = Solved(velocity, 0u);
    var again = true;
    let is_crowded = (contents & CROWDED) != 0u;
    for (var attempt = first; attempt < 3u && again; attempt++) {
        other_lines(others, rate, preferred, is_crowded && attempt > 0u);
        solved = within(0u, made, max_speed, preferred, false);
        let is_stuck = is_crowded && attempt == 0u && gets_nowhere(solved.velocity, preferred);
        let is_done = solved.satisfied == made && !is_stuck;
        var next = 0.0;
        if attempt == 0u {
            next = step.inverse_time_horizon_dense;
        } else if attempt == 1u && is_slow {
            next = step.inverse_time_horizon_jam;
        }
        again = !is_done && next > 0.0;
        rate = next;
    }
    return least_bad(made, others.hard, solved.satisfied, max_speed, solved.velocity);
}

// The others that an agent avoids: first the user, if `users` is 1, then those in `found`; `count` with the user.
struct Others {
    slot: u32,
    at: vec2<f32>,  // of that slot, m
    me: SlotMotion, // of that slot
    hard: u32,      // lines of obstacles before theirs
    users: u32,
    count: u32,
}

// Lines of the user and of the neighbours, nearest first. The user takes no share of the avoidance, so the agent takes all.
// Of two agents the one of lower priority takes more. Of two with equal priority in a dense crowd the one behind takes more.
fn other_lines(o: Others, rate: f32, wanted: vec2<f32>, is_dense: bool) {
    let heading = unit_or(wanted, vec2<f32>(0.0, 0.0));
    for (var k = 0u; k < o.count; k++) {
        let is_user = k < o.users;
        let other = select(found[max(k, o.users) - o.users], o.slot, is_user); // any slot stands for the user
        let them = slot_motion[other];
        let their_position = select(slot_position[other], step.user_position, is_user);
        let their_velocity = select(them.velocity, step.user_velocity, is_user);
        let their_radius = select(them.radius, step.user_radius, is_user);
        let is_mate = (contents & GROUPS) != 0u && !is_user && is_with(o.slot, other);
        // priorities do not count within a group
        let higher = select(them.priority - o.me.priority, 0.0, is_mate);
        var pair = Precedence(step.responsibility, o.me.radius + their_radius, false);
        if is_dense && !is_user && abs(higher) < PEERS {
            let their_wish = unit_or(preferred_velocity[slot_motion[other].agent], vec2<f32>(0.0, 0.0));
            let to = their_position - o.at;
            pair = precedence(to, heading, their_wish, pair.radius, step.responsibility, PLACE * higher);
        }
        if (contents & UNLIKE) != 0u {
            pair.share = share_of(pair.share, higher);
        }
        let has_way = pair.share <= 0.0 && !is_user;
        // members of a group walk near one another on purpose
        var clear = select(rate, max(rate, RIGHT_OF_WAY), has_way);
        if is_mate {
            clear = max(clear, TOGETHER);
        }
        let line = agent_line(
            o.me.velocity,
            their_position - o.at,
            o.me.velocity - their_velocity,
            (pair.radius + step.safety_margin) * select(1.0, SQUEEZE, has_way && is_dense),
            clear,
            step.inverse_time_step,
            select(pair.share, 1.0, is_user || has_way),
            select(-1.0, 1.0, o.slot < other || is_user),
        );
        if pair.follows {
            lines[o.hard + k] = standing(line);
        } else {
            lines[o.hard + k] = line;
        }
    }
}

// Lines of the nearest obstacle segments, by (squared distance, number). Returns how many.
fn obstacle_lines(at: vec2<f32>, me: SlotMotion) -> u32 {
    let count = near_segments(at, step.time_horizon_obstacles * me.max_speed + me.radius, me.elevation);
    var made = 0u;
    for (var i = 0u; i < count; i++) {
        let wall = obstacles[segment_numbers[i]];
        let line = obstacle_line(made, wall, at, me.velocity, me.radius, step.inverse_time_horizon_obstacles);
        if line.is_there {
            lines[made] = line.line;
            made++;
        }
    }
    return made;
}
