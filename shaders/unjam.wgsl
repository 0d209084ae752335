// uses: step, grid, orca, segments, contact, absent, agent
// Frees an agent that makes no progress for longer than step.patience, so that no jam persists as an artefact of the model.
//
// Right of way (phase turns): every TURN seconds a random direction is drawn. A blocked agent that faces an oncoming agent
// gains priority (RAISE) if its preferred velocity has a positive component along that direction. It then takes no share in
// avoiding agents without priority, and these make room. Agents that all want to go the same way gain nothing by it.
//
// Walls (phase walls, after it): an agent that waits because a wall is straight ahead follows the wall. It takes the side to
// which the wanted direction is slanted, else the nearer end, else a side drawn by agent. It stops following once it is
// nearer to its goal than when it began and its way ahead is clear. Lumelsky and Stepanov's "bug" algorithms (1987) leave an
// obstacle by this rule. The preferred velocity alone gives the gain in nearness: the sum of the steps along it.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> agent_slot: array<u32>;                     // [agent]
@group(0) @binding(2) var<storage, read> obstacles: array<Segment>;                  // [segment]
@group(0) @binding(3) var<storage, read> obstacle_cells: array<u32>;                 // [cell + 1] where the cell's list begins in this array, then the lists
@group(0) @binding(4) var<storage, read> cell_start: array<u32>;                     // [cell + 1]
@group(0) @binding(5) var<storage, read> slot_position: array<vec2<f32>>;            // [slot] m
@group(0) @binding(6) var<storage, read_write> slot_motion: array<SlotMotion>;       // [slot]
@group(0) @binding(7) var<storage, read_write> preferred_velocity: array<vec2<f32>>; // [agent] m/s
@group(0) @binding(8) var<storage, read_write> waiting: array<Waiting>;              // [agent]

// An agent whose wanted speed is below this stands by choice, m/s.
const STANDING: f32 = 0.1;
// Slower than this share of the wanted speed, in the wanted direction, is no progress.
const PROGRESS: f32 = 0.15;
// An agent this near (and within two cells), ahead, that wants to go the other way (within 73 degrees) is in the way, m.
const OPPOSED: f32 = 3.0;
// How long the right of way lasts, s.
const TURN: f32 = 3.0;
// A wall ahead is in the way from this distance on when one waits, and until one leaves it, m.
const TOUCHED: f32 = 0.3;
const CLEAR: f32 = 1.0;
// It is in the way of this share of the disc: a door post that a shoulder would touch is not.
const THIN: f32 = 0.3;
// The gap that is kept to a followed wall, and the distance at which a second one is ahead, m.
const BESIDE: f32 = 0.1;
const CORNERED: f32 = 0.25;
// Nearer to the goal by this much than at the beginning is nearer, m.
const GAINED: f32 = 0.1;
// Less slanted than this, the wall does not say to which side (cosine); nor do its ends if they are as near as this, m.
const SLANTED: f32 = 0.3;
const ONE_OF_TWO: f32 = 0.2;
const NEAREST_RATE: f32 = 1000.0; // 1/m

// The slot of an agent that wants to go somewhere by itself, else NOBODY.
fn walker_slot(agent: u32) -> u32 {
    if agent >= step.agent_count {
        return NOBODY;
    }
    let slot = agent_slot[agent];
    if slot == NOBODY {
        waiting[agent] = Waiting();
        return NOBODY;
    }
    if (slot_motion[slot].limits & LED_BIT) != 0u {
        return NOBODY;
    }
    let preferred = preferred_velocity[agent];
    if sqrt(dot2(preferred, preferred)) < STANDING {
        waiting[agent] = Waiting();
        return NOBODY;
    }
    return slot;
}

@compute @workgroup_size(64)
fn unjam_turns(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = walker_slot(id.x);
    if slot != NOBODY {
        let preferred = preferred_velocity[id.x];
        let speed = sqrt(dot2(preferred, preferred));
        take_turns(id.x, slot, preferred / speed, speed);
    }
}

@compute @workgroup_size(64)
fn unjam_walls(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = walker_slot(id.x);
    if slot != NOBODY {
        let preferred = preferred_velocity[id.x];
        let speed = sqrt(dot2(preferred, preferred));
        follow_walls(id.x, slot, preferred / speed, speed);
    }
}

fn take_turns(agent: u32, slot: u32, ahead: vec2<f32>, speed: f32) {
    let own = slot_motion[slot];
    let progress = dot2(own.velocity, ahead);
    var state = waiting[agent];
    state.stuck = max(state.stuck + select(-2.0, 1.0, progress < PROGRESS * speed) * step.time_step, 0.0);
    if state.side != 0.0 {
        state.lost = state.lost - progress * step.time_step;
    }
    waiting[agent] = state;
    let turn = step.step_index / max(u32(TURN * step.inverse_time_step), 1u);
    let bits = hash_u32(turn ^ hash_u32(step.seed ^ 0x7475726eu));
    let side = vec2<f32>(unit_f32(bits) - 0.5, unit_f32(hash_u32(bits)) - 0.5);
    if state.stuck > step.patience && dot2(side, ahead) > 0.0 && is_opposed(slot, slot_position[slot], ahead, own.elevation) {
        slot_motion[slot].priority = own.priority + RAISE;
    }
}

fn follow_walls(agent: u32, slot: u32, ahead: vec2<f32>, speed: f32) {
    var state = waiting[agent];
    let is_following = state.side != 0.0;
    if state.stuck <= step.patience && !is_following {
        return;
    }
    let own = slot_motion[slot];
    let at = slot_position[slot];
    let walls = near_segments(at, CLEAR + own.radius, own.elevation);
    let blocked = way_ahead(walls, at, ahead, THIN * own.radius);
    if !is_following && blocked.rate > 1.0 / (TOUCHED + (1.0 - THIN) * own.radius)
        && !is_someone_ahead(slot, at, ahead, own.elevation) {
        let along = dot2(ahead, blocked.along);
        let is_slanted = abs(along) >= SLANTED;
        let slide = blocked.along * select(-1.0, 1.0, along > 0.0);
        let drawn = (hash_u32(agent ^ hash_u32(step.seed)) & 1u) == 1u;
        let by_end = select(blocked.nearer_end > 0.0, drawn, abs(blocked.nearer_end) < ONE_OF_TWO);
        // along a slanted wall every agent slides anyway, up to a corner
        if !is_slanted || is_cornered(walls, at, slide, own.radius) {
            state.side = select(-1.0, 1.0, select(by_end, along > 0.0, is_slanted));
            state.lost = 0.0;
        }
    } else if is_following && (walls == 0u || (state.lost < -GAINED && blocked.rate < 1.0 / CLEAR)) {
        state = Waiting();
    }
    if state.side != 0.0 {
        preferred_velocity[agent] = beside_wall(walls, at, state.side, own.radius) * speed;
    }
    waiting[agent] = state;
}

// Whether an agent ahead wants to go the other way.
fn is_opposed(slot: u32, at: vec2<f32>, ahead: vec2<f32>, elevation: f32) -> bool {
    let centre = grid_cell(at, step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    let columns = i32(step.grid_columns);
    var is_there = false;
    for (var y = max(centre.y - 2, 0); y <= min(centre.y + 2, i32(step.grid_rows) - 1); y++) {
        let end = cell_start[y * columns + min(centre.x + 2, columns - 1) + 1];
        for (var other = cell_start[y * columns + max(centre.x - 2, 0)]; other < end; other++) {
            let to = slot_position[other] - at;
            let apart = abs(slot_motion[other].elevation - elevation);
            let wanted = preferred_velocity[slot_motion[other].agent];
            let speed2 = dot2(wanted, wanted);
            let against = -dot2(wanted, ahead);
            is_there = is_there || (dot2(to, to) < OPPOSED * OPPOSED && dot2(to, ahead) > 0.0
                && speed2 > STANDING * STANDING && against > 0.0 && 12.0 * against * against > speed2
                && (step.storey_height <= 0.0 || apart < step.storey_height));
        }
    }
    return is_there;
}

// Whether an agent is ahead within a metre and 60 degrees: then not the wall blocks the way.
fn is_someone_ahead(slot: u32, at: vec2<f32>, ahead: vec2<f32>, elevation: f32) -> bool {
    let centre = grid_cell(at, step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    let columns = i32(step.grid_columns);
    var is_there = false;
    for (var y = max(centre.y - 2, 0); y <= min(centre.y + 2, i32(step.grid_rows) - 1); y++) {
        let end = cell_start[y * columns + min(centre.x + 2, columns - 1) + 1];
        for (var other = cell_start[y * columns + max(centre.x - 2, 0)]; other < end; other++) {
            let to = slot_position[other] - at;
            let apart = abs(slot_motion[other].elevation - elevation);
            let distance2 = dot2(to, to);
            let along = dot2(to, ahead);
            is_there = is_there || (other != slot && distance2 < 1.0 && along > 0.0 && 4.0 * along * along > distance2
                && (step.storey_height <= 0.0 || apart < step.storey_height));
        }
    }
    return is_there;
}

struct Ahead {
    rate: f32,        // 1 / distance at which the disc touches a wall when it goes straight on, 1/m; 0: none
    along: vec2<f32>, // direction of that wall
    nearer_end: f32,  // how much nearer its second end is than its first, m
}

fn way_ahead(walls: u32, at: vec2<f32>, ahead: vec2<f32>, radius: f32) -> Ahead {
    var found_ahead = Ahead(0.0, vec2<f32>(0.0, 0.0), 0.0);
    for (var i = 0u; i < walls; i++) {
        let wall = obstacles[segment_numbers[i]];
        let along = wall.along;
        let rate = segment_rate(wall.a - at, wall.b - at, along, ahead, radius, NEAREST_RATE);
        if rate > found_ahead.rate {
            found_ahead = Ahead(rate, along, dot2(along, at - wall.a) - dot2(along, wall.b - at));
        }
    }
    return found_ahead;
}

// Whether a wall is so near that one cannot go on in a direction.
fn is_cornered(walls: u32, at: vec2<f32>, direction: vec2<f32>, radius: f32) -> bool {
    var is_there = false;
    for (var i = 0u; i < walls; i++) {
        let to = to_wall(segment_numbers[i], at);
        let along = dot2(to, direction);
        let distance2 = dot2(to, to);
        let near = radius + CORNERED;
        is_there = is_there || (distance2 < near * near && along > 0.0 && 25.0 * along * along > distance2);
    }
    return is_there;
}

// The way to the nearest point of a segment.
fn to_wall(number: u32, at: vec2<f32>) -> vec2<f32> {
    let a = obstacles[number].a;
    let ab = obstacles[number].b - a;
    let t = clamp(dot2(at - a, ab) / dot2(ab, ab), 0.0, 1.0);
    return a + ab * t - at;
}

// The direction along the nearest wall (along its segments for side 1, against for -1), or along the next one if that leads
// into a corner; a little towards or away from it, to keep a gap.
fn beside_wall(walls: u32, at: vec2<f32>, side: f32, radius: f32) -> vec2<f32> {
    var direction = vec2<f32>(0.0, 0.0);
    var is_first = true;
    for (var i = 0u; i < walls; i++) {
        let to = to_wall(segment_numbers[i], at);
        let distance = sqrt(dot2(to, to));
        let inward = unit_or(to, vec2<f32>(1.0, 0.0));
        if is_first || (distance < radius + CORNERED && dot2(inward, direction) > 0.2) {
            let gap = clamp(distance - radius - BESIDE, -0.5, 0.5);
            direction = unit_or(vec2<f32>(inward.y, -inward.x) * side + inward * gap, inward);
        }
        is_first = false;
    }
    return direction;
}
