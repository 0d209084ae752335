// uses: step, grid, orca
// The velocity nearest to the preferred one that avoids neighbours, obstacles and the user: ORCA (2011).
//
// A workgroup takes the agents of TILE cells of one row. Everyone reads the same candidates (the tile and the cells
// around it) in the same order, and keeps the nearest as packed keys: squared distance with its low bits replaced by
// the candidate's place in the list. Where that could differ from the order by (squared distance, id) (two keys
// agree in the bits left, fewer than wanted were found, a nearer one may stand farther out, the list is too long)
// the agent searches again, ring by ring and exactly. So the neighbours are always the exact ones.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> slot_motion: array<vec4<f32>>;        // [slot][2] position, velocity; radius, maximum speed
@group(0) @binding(2) var<storage, read> slot_agent: array<u32>;               // [slot]
@group(0) @binding(3) var<storage, read> cell_start: array<u32>;               // [cell + 1]
@group(0) @binding(4) var<storage, read> preferred_velocity: array<vec2<f32>>; // [agent] m/s
@group(0) @binding(5) var<storage, read> obstacles: array<vec4<f32>>;          // [segment][3], see reference::orca::Segment
@group(0) @binding(6) var<storage, read> obstacle_cells: array<u32>;           // [cell + 1] where the cell's list begins in this array, then the lists
@group(0) @binding(7) var<storage, read_write> new_velocity: array<vec2<f32>>; // [slot] m/s

const GROUP = 32u;
const TILE = 4u;
const KEY_MASK = 0xffffff00u; // what a key keeps of the squared distance
const PLACES = 255u;          // candidates that the low bits can number
const NO_KEY = 0xffffffffu;
// A cell's border is computed with rounding; a neighbour that near to it is looked for in the next ring as well.
const SAFE = 0.999;
// An agent slower than this share of its maximum speed is in a jam.
const JAM_SPEED = 0.45;

var<private> found: array<u32, 10>;       // slots of the neighbours, nearest first
var<private> found_distance2: array<f32, 10>;
var<private> segment_numbers: array<u32, 12>;
var<private> segment_distances: array<f32, 12>;


@compute @workgroup_size(32)
fn velocity_orca(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let row = i32(group.y);
    let column = i32(group.x * TILE);
    let columns = i32(step.grid_columns);
    let rows = i32(step.grid_rows);
    let last_column = min(column + i32(TILE), columns) - 1;
    let left = max(column - 1, 0);
    let right = min(last_column + 1, columns - 1);
    // The candidates: three runs of slots, one per row of cells.
    let base0 = cell_start[max(row - 1, 0) * columns + left];
    let base1 = cell_start[row * columns + left];
    let base2 = cell_start[min(row + 1, rows - 1) * columns + left];
    let count0 = select(0u, cell_start[max(row - 1, 0) * columns + right + 1] - base0, row > 0);
    let count1 = cell_start[row * columns + right + 1] - base1;
    let count2 = select(0u, cell_start[min(row + 1, rows - 1) * columns + right + 1] - base2, row < rows - 1);
    let fits = count0 + count1 + count2 <= PLACES && step.neighbour_cap == NEIGHBOURS;
    // Borders of the candidates' block; the grid's own border cells reach to infinity.
    let low = step.grid_origin + vec2<f32>(f32(left), f32(row - 1)) * step.cell_size;
    let high = step.grid_origin + vec2<f32>(f32(right + 1), f32(row + 2)) * step.cell_size;
    let first = cell_start[row * columns + column];
    let end = cell_start[row * columns + last_column + 1];
    let range2 = step.neighbour_distance * step.neighbour_distance;

    for (var base = first; base < end; base += GROUP) {
        let is_mine = base + lane < end;
        let slot = min(base + lane, end - 1u);
        let motion = slot_motion[slot * 2u];
        let at = motion.xy;
        keys_clear();
        if fits && is_mine {
            for (var place = 0u; place < count0; place++) {
                offer(base0 + place, place, slot, at, range2);
            }
            for (var place = 0u; place < count1; place++) {
                offer(base1 + place, count0 + place, slot, at, range2);
            }
            for (var place = 0u; place < count2; place++) {
                offer(base2 + place, count0 + count1 + place, slot, at, range2);
            }
        }
        let ambiguous = same(k0, k1) || same(k1, k2) || same(k2, k3) || same(k3, k4) || same(k4, k5) || same(k5, k6)
            || same(k6, k7) || same(k7, k8) || same(k8, k9) || same(k9, k10);
        var safe = FAR_AWAY;
        safe = select(safe, min(safe, at.x - low.x), left > 0);
        safe = select(safe, min(safe, high.x - at.x), right < columns - 1);
        safe = select(safe, min(safe, at.y - low.y), row > 1);
        safe = select(safe, min(safe, high.y - at.y), row < rows - 2);
        safe = max(safe, 0.0) * SAFE;
        let complete = safe >= step.neighbour_distance || (k9 & KEY_MASK) < (bitcast<u32>(safe * safe) & KEY_MASK);

        var count = 0u;
        if fits && complete && !ambiguous {
            let end0 = count0;
            let end1 = count0 + count1;
            found[0] = slot_of(k0, base0, base1, base2, end0, end1);
            found[1] = slot_of(k1, base0, base1, base2, end0, end1);
            found[2] = slot_of(k2, base0, base1, base2, end0, end1);
            found[3] = slot_of(k3, base0, base1, base2, end0, end1);
            found[4] = slot_of(k4, base0, base1, base2, end0, end1);
            found[5] = slot_of(k5, base0, base1, base2, end0, end1);
            found[6] = slot_of(k6, base0, base1, base2, end0, end1);
            found[7] = slot_of(k7, base0, base1, base2, end0, end1);
            found[8] = slot_of(k8, base0, base1, base2, end0, end1);
            found[9] = slot_of(k9, base0, base1, base2, end0, end1);
            count = u32(k0 != NO_KEY) + u32(k1 != NO_KEY) + u32(k2 != NO_KEY) + u32(k3 != NO_KEY) + u32(k4 != NO_KEY)
                + u32(k5 != NO_KEY) + u32(k6 != NO_KEY) + u32(k7 != NO_KEY) + u32(k8 != NO_KEY) + u32(k9 != NO_KEY);
        } else if is_mine {
            count = search(slot, at, range2);
        }
        if is_mine {
            new_velocity[slot] = avoid(slot, motion, count);
        }
    }
}

// The keys found so far, nearest first.
var<private> k0: u32;
var<private> k1: u32;
var<private> k2: u32;
var<private> k3: u32;
var<private> k4: u32;
var<private> k5: u32;
var<private> k6: u32;
var<private> k7: u32;
var<private> k8: u32;
var<private> k9: u32;
var<private> k10: u32;

fn keys_clear() {
    k0 = NO_KEY;
    k1 = NO_KEY;
    k2 = NO_KEY;
    k3 = NO_KEY;
    k4 = NO_KEY;
    k5 = NO_KEY;
    k6 = NO_KEY;
    k7 = NO_KEY;
    k8 = NO_KEY;
    k9 = NO_KEY;
    k10 = NO_KEY;
}

// Inserts a candidate into the sorted keys, without a branch.
fn offer(candidate: u32, place: u32, slot: u32, at: vec2<f32>, range2: f32) {
    let to = slot_motion[candidate * 2u].xy - at;
    let distance2 = dot2(to, to);
    let wanted = distance2 < range2 && candidate != slot;
    let key = select(NO_KEY, (bitcast<u32>(distance2) & KEY_MASK) | place, wanted);
    k10 = max(min(k10, key), k9);
    k9 = max(min(k9, key), k8);
    k8 = max(min(k8, key), k7);
    k7 = max(min(k7, key), k6);
    k6 = max(min(k6, key), k5);
    k5 = max(min(k5, key), k4);
    k4 = max(min(k4, key), k3);
    k3 = max(min(k3, key), k2);
    k2 = max(min(k2, key), k1);
    k1 = max(min(k1, key), k0);
    k0 = min(k0, key);
}

// Two keys whose order the low bits decided.
fn same(nearer: u32, farther: u32) -> bool {
    return farther != NO_KEY && (nearer & KEY_MASK) == (farther & KEY_MASK);
}

fn slot_of(key: u32, base0: u32, base1: u32, base2: u32, end0: u32, end1: u32) -> u32 {
    let place = key & PLACES;
    return select(select(base2 + (place - end1), base1 + (place - end0), place < end1), base0 + place, place < end0);
}

// The exact search: ring by ring of cells, stopping when no farther ring can hold a nearer one. Returns how many.
fn search(slot: u32, at: vec2<f32>, range2: f32) -> u32 {
    let cap = step.neighbour_cap;
    let centre = grid_cell(at, step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    let columns = i32(step.grid_columns);
    let rows = i32(step.grid_rows);
    let rings = max(columns, rows);
    var count = 0u;
    var done = cap == 0u;
    for (var ring = 0; ring <= rings && !done; ring++) {
        for (var y = max(centre.y - ring, 0); y <= min(centre.y + ring, rows - 1); y++) {
            let whole = y == centre.y - ring || y == centre.y + ring;
            let stride = select(2 * ring, 1, whole || ring == 0);
            for (var x = centre.x - ring; x <= centre.x + ring; x += stride) {
                if x >= 0 && x < columns {
                    let cell = u32(y * columns + x);
                    let end = cell_start[cell + 1u];
                    for (var other = cell_start[cell]; other < end; other++) {
                        let to = slot_motion[other * 2u].xy - at;
                        let distance2 = dot2(to, to);
                        if other != slot && distance2 < range2 {
                            count = insert(count, cap, other, distance2);
                        }
                    }
                }
            }
        }
        let safe = safe_distance(at, centre, ring);
        done = safe >= step.neighbour_distance;
        if count == cap {
            done = done || found_distance2[cap - 1u] < safe * safe;
        }
    }
    return count;
}

// Everyone outside the square of 2 ring + 1 cells is at least this far away.
fn safe_distance(at: vec2<f32>, centre: vec2<i32>, ring: i32) -> f32 {
    let from_origin = at - step.grid_origin;
    var safe = FAR_AWAY;
    safe = select(safe, min(safe, from_origin.x - f32(centre.x - ring) * step.cell_size), centre.x - ring > 0);
    safe = select(safe, min(safe, f32(centre.x + ring + 1) * step.cell_size - from_origin.x), centre.x + ring < i32(step.grid_columns) - 1);
    safe = select(safe, min(safe, from_origin.y - f32(centre.y - ring) * step.cell_size), centre.y - ring > 0);
    safe = select(safe, min(safe, f32(centre.y + ring + 1) * step.cell_size - from_origin.y), centre.y + ring < i32(step.grid_rows) - 1);
    return max(safe, 0.0) * SAFE;
}

// Whether (distance2, id) of a candidate comes before place `i` of the list.
fn comes_before(i: u32, distance2: f32, id: u32) -> bool {
    let there = found_distance2[i];
    return distance2 < there || (distance2 == there && id < slot_agent[found[i]]);
}

fn insert(count: u32, cap: u32, slot: u32, distance2: f32) -> u32 {
    let id = slot_agent[slot];
    if count == cap && !comes_before(cap - 1u, distance2, id) {
        return count;
    }
    var hole = min(count, cap - 1u);
    while hole > 0u && comes_before(max(hole, 1u) - 1u, distance2, id) {
        found[hole] = found[hole - 1u];
        found_distance2[hole] = found_distance2[hole - 1u];
        hole--;
    }
    found[hole] = slot;
    found_distance2[hole] = distance2;
    return min(count + 1u, cap);
}

fn avoid(slot: u32, motion: vec4<f32>, count: u32) -> vec2<f32> {
    let traits = slot_motion[slot * 2u + 1u];
    let hard = obstacle_lines(motion.xy, motion.zw, traits.x, traits.y);
    let to_user = step.user_position - motion.xy;
    let is_near = dot2(to_user, to_user) < step.neighbour_distance * step.neighbour_distance;
    let users = select(0u, 1u, step.user_radius > 0.0 && is_near);
    let made = hard + users + count;
    let preferred = preferred_velocity[slot_agent[slot]];
    let is_slow = dot2(motion.zw, motion.zw) < JAM_SPEED * JAM_SPEED * traits.y * traits.y;
    var rate = step.inverse_time_horizon;
    var solved = Solved(motion.zw, 0u);
    var again = true;
    for (var attempt = 0u; attempt < 3u && again; attempt++) {
        other_lines(hard, users, users + count, slot, motion, traits.x, rate);
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
// nearest first, from line `first` on.
fn other_lines(first: u32, users: u32, count: u32, slot: u32, motion: vec4<f32>, own_radius: f32, rate: f32) {
    for (var k = 0u; k < count; k++) {
        let is_user = k < users;
        let other = found[max(k, users) - users];
        let theirs = select(slot_motion[other * 2u], vec4<f32>(step.user_position, step.user_velocity), is_user);
        let their_radius = select(slot_motion[other * 2u + 1u].x, step.user_radius, is_user);
        lines[first + k] = agent_line(
            motion.zw,
            theirs.xy - motion.xy,
            motion.zw - theirs.zw,
            own_radius + their_radius + step.safety_margin,
            rate,
            step.inverse_time_step,
            select(step.responsibility, 1.0, is_user),
            select(-1.0, 1.0, slot < other || is_user),
        );
    }
}

// Lines of the nearest obstacle segments, by (squared distance, number). Returns how many.
fn obstacle_lines(at: vec2<f32>, velocity: vec2<f32>, radius: f32, max_speed: f32) -> u32 {
    if step.obstacle_count == 0u {
        return 0u;
    }
    let reach = step.time_horizon_obstacles * max_speed + radius;
    let centre = grid_cell(at, step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    let cell = u32(centre.y) * step.grid_columns + u32(centre.x);
    var count = 0u;
    let end = obstacle_cells[cell + 1u];
    for (var entry = obstacle_cells[cell]; entry < end; entry++) {
        let number = obstacle_cells[entry];
        let distance2 = segment_distance2(obstacles[number * 3u], at);
        if distance2 < reach * reach {
            // numbers rise within a cell's list, so equal distances stay in order of number
            var hole = count;
            while hole > 0u && distance2 < segment_distances[max(hole, 1u) - 1u] {
                if hole < SEGMENTS {
                    segment_numbers[hole] = segment_numbers[hole - 1u];
                    segment_distances[hole] = segment_distances[hole - 1u];
                }
                hole--;
            }
            if hole < SEGMENTS {
                segment_numbers[hole] = number;
                segment_distances[hole] = distance2;
                count = min(count + 1u, SEGMENTS);
            }
        }
    }
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
