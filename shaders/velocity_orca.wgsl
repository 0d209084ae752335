// uses: step, grid, orca
// The velocity nearest to the preferred one that avoids neighbours, obstacles and the user: ORCA (2011).
//
// Neighbours: the agent reads the five by five cells around it, whose rows are runs of slots, and keeps the nearest as
// packed keys: squared distance with its low bits replaced by the candidate's place in the five runs. Where that could
// differ from the order by (squared distance, id) (two keys agree in the bits left, fewer than wanted were found, a
// nearer one may stand farther out, the runs are too long) it searches again, ring by ring and exactly. So the
// neighbours are always the exact ones. Keys and lines stay in registers: arrays with computed indices are slow
// memory on every device.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> slot_motion: array<vec4<f32>>;        // [slot][2] position, velocity; radius, maximum speed
@group(0) @binding(2) var<storage, read> slot_agent: array<u32>;               // [slot]
@group(0) @binding(3) var<storage, read> cell_start: array<u32>;               // [cell + 1]
@group(0) @binding(4) var<storage, read> preferred_velocity: array<vec2<f32>>; // [agent] m/s
@group(0) @binding(5) var<storage, read> obstacles: array<vec4<f32>>;          // [segment][3], see reference::orca::Segment
@group(0) @binding(6) var<storage, read> obstacle_cells: array<u32>;           // [cell + 1] where the cell's list begins in this array, then the lists
@group(0) @binding(7) var<storage, read_write> new_velocity: array<vec2<f32>>; // [slot] m/s

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


@compute @workgroup_size(64)
fn velocity_orca(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    if slot < step.agent_count {
        let motion = slot_motion[slot * 2u];
        new_velocity[slot] = avoid(slot, motion, neighbours(slot, motion.xy));
    }
}

// Finds the neighbours; returns how many.
fn neighbours(slot: u32, at: vec2<f32>) -> u32 {
    let range2 = step.neighbour_distance * step.neighbour_distance;
    let centre = grid_cell(at, step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    let run0 = run(centre, -2, 0u);
    let run1 = run(centre, -1, run0.end);
    let run2 = run(centre, 0, run1.end);
    let run3 = run(centre, 1, run2.end);
    let run4 = run(centre, 2, run3.end);
    let fits = run4.end <= PLACES && step.neighbour_cap == NEIGHBOURS;
    keys_clear();
    if fits {
        offer_run(run0, slot, at, range2);
        offer_run(run1, slot, at, range2);
        offer_run(run2, slot, at, range2);
        offer_run(run3, slot, at, range2);
        offer_run(run4, slot, at, range2);
    }
    let safe = safe_distance(at, centre, 2);
    let complete = safe >= step.neighbour_distance || (k9 & KEY_MASK) < (bitcast<u32>(safe * safe) & KEY_MASK);
    let ambiguous = same(k0, k1) || same(k1, k2) || same(k2, k3) || same(k3, k4) || same(k4, k5) || same(k5, k6)
        || same(k6, k7) || same(k7, k8) || same(k8, k9) || same(k9, k10);
    if !fits || !complete || ambiguous {
        return search(slot, at, centre, range2);
    }
    let ends = vec4<u32>(run0.end, run1.end, run2.end, run3.end);
    let shift = vec4<u32>(run0.shift, run1.shift, run2.shift, run3.shift);
    found[0] = slot_of(k0, ends, shift, run4.shift);
    found[1] = slot_of(k1, ends, shift, run4.shift);
    found[2] = slot_of(k2, ends, shift, run4.shift);
    found[3] = slot_of(k3, ends, shift, run4.shift);
    found[4] = slot_of(k4, ends, shift, run4.shift);
    found[5] = slot_of(k5, ends, shift, run4.shift);
    found[6] = slot_of(k6, ends, shift, run4.shift);
    found[7] = slot_of(k7, ends, shift, run4.shift);
    found[8] = slot_of(k8, ends, shift, run4.shift);
    found[9] = slot_of(k9, ends, shift, run4.shift);
    return u32(k0 != NO_KEY) + u32(k1 != NO_KEY) + u32(k2 != NO_KEY) + u32(k3 != NO_KEY) + u32(k4 != NO_KEY)
        + u32(k5 != NO_KEY) + u32(k6 != NO_KEY) + u32(k7 != NO_KEY) + u32(k8 != NO_KEY) + u32(k9 != NO_KEY);
}

// A run of candidates: places begin..end, whose slots are shift higher.
struct Run {
    begin: u32,
    end: u32,
    shift: u32,
}

// The cells of one of the five rows.
fn run(centre: vec2<i32>, dy: i32, begin: u32) -> Run {
    let columns = i32(step.grid_columns);
    let y = centre.y + dy;
    let row = clamp(y, 0, i32(step.grid_rows) - 1) * columns;
    let first = cell_start[row + max(centre.x - 2, 0)];
    let end = cell_start[row + min(centre.x + 2, columns - 1) + 1];
    return Run(begin, begin + select(0u, end - first, y >= 0 && y < i32(step.grid_rows)), first - begin);
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

fn key(place: u32, run: Run, slot: u32, at: vec2<f32>, range2: f32) -> u32 {
    let candidate = run.shift + place;
    let to = slot_motion[candidate * 2u].xy - at;
    let distance2 = dot2(to, to);
    let wanted = place < run.end && distance2 < range2 && candidate != slot;
    return select(NO_KEY, (bitcast<u32>(distance2) & KEY_MASK) | place, wanted);
}

// Puts two keys in order.
fn order(low: ptr<private, u32>, high: ptr<private, u32>) {
    let smaller = min(*low, *high);
    *high = max(*low, *high);
    *low = smaller;
}

// Four candidates at a time: sorted among themselves (a network of five comparisons), the better ends of the two
// lists kept, which makes a bitonic list, and that list sorted (17 comparisons).
fn offer_run(run: Run, slot: u32, at: vec2<f32>, range2: f32) {
    for (var place = run.begin; place < run.end; place += 4u) {
        c0 = key(place, run, slot, at, range2);
        c1 = key(place + 1u, run, slot, at, range2);
        c2 = key(place + 2u, run, slot, at, range2);
        c3 = key(place + 3u, run, slot, at, range2);
        order(&c0, &c1); order(&c2, &c3);
        order(&c0, &c2); order(&c1, &c3);
        order(&c1, &c2);
        k7 = min(k7, c3); k8 = min(k8, c2); k9 = min(k9, c1); k10 = min(k10, c0);
        order(&k0, &k8); order(&k1, &k9); order(&k2, &k10);
        order(&k3, &k7); order(&k4, &k8); order(&k5, &k9); order(&k6, &k10);
        order(&k0, &k2); order(&k3, &k5); order(&k4, &k6); order(&k7, &k9); order(&k8, &k10);
        order(&k1, &k2); order(&k3, &k4); order(&k5, &k6); order(&k7, &k8); order(&k9, &k10);
    }
}

var<private> c0: u32;
var<private> c1: u32;
var<private> c2: u32;
var<private> c3: u32;

// Two keys whose order the low bits decided.
fn same(nearer: u32, farther: u32) -> bool {
    return farther != NO_KEY && (nearer & KEY_MASK) == (farther & KEY_MASK);
}

fn slot_of(key: u32, ends: vec4<u32>, shift: vec4<u32>, last_shift: u32) -> u32 {
    let place = key & PLACES;
    let upper = select(select(last_shift, shift.w, place < ends.w), shift.z, place < ends.z);
    return place + select(select(upper, shift.y, place < ends.y), shift.x, place < ends.x);
}

// The exact search: ring by ring of cells, stopping when no farther ring can hold a nearer one. Returns how many.
fn search(slot: u32, at: vec2<f32>, centre: vec2<i32>, range2: f32) -> u32 {
    let cap = step.neighbour_cap;
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
    let has_user = step.user_radius > 0.0 && dot2(to_user, to_user) < step.neighbour_distance * step.neighbour_distance;
    let first = hard + u32(has_user);
    let preferred = preferred_velocity[slot_agent[slot]];
    let is_slow = dot2(motion.zw, motion.zw) < JAM_SPEED * JAM_SPEED * traits.y * traits.y;
    let m0 = neighbour(0u, count, slot, traits.x);
    let m1 = neighbour(1u, count, slot, traits.x);
    let m2 = neighbour(2u, count, slot, traits.x);
    let m3 = neighbour(3u, count, slot, traits.x);
    let m4 = neighbour(4u, count, slot, traits.x);
    let m5 = neighbour(5u, count, slot, traits.x);
    let m6 = neighbour(6u, count, slot, traits.x);
    let m7 = neighbour(7u, count, slot, traits.x);
    let m8 = neighbour(8u, count, slot, traits.x);
    let m9 = neighbour(9u, count, slot, traits.x);
    let user = Neighbour(vec4<f32>(step.user_position, step.user_velocity), traits.x + step.user_radius + step.safety_margin, 1.0);
    var rate = step.inverse_time_horizon;
    var solved = Solved(motion.zw, ALL);
    var again = true;
    for (var attempt = 0u; attempt < 3u && again; attempt++) {
        if has_user {
            lines[hard] = line_of(user, 1.0, motion, rate);
        }
        n0 = line_of(m0, step.responsibility, motion, rate);
        n1 = line_of(m1, step.responsibility, motion, rate);
        n2 = line_of(m2, step.responsibility, motion, rate);
        n3 = line_of(m3, step.responsibility, motion, rate);
        n4 = line_of(m4, step.responsibility, motion, rate);
        n5 = line_of(m5, step.responsibility, motion, rate);
        n6 = line_of(m6, step.responsibility, motion, rate);
        n7 = line_of(m7, step.responsibility, motion, rate);
        n8 = line_of(m8, step.responsibility, motion, rate);
        n9 = line_of(m9, step.responsibility, motion, rate);
        solved = within_all(first, traits.y, preferred);
        // Too crowded to plan that far: plan less far. What is near then counts for more than what is far.
        var next = 0.0;
        if attempt == 0u {
            next = step.inverse_time_horizon_dense;
        } else if attempt == 1u && is_slow {
            next = step.inverse_time_horizon_jam;
        }
        again = solved.satisfied != ALL && next > 0.0;
        rate = next;
    }
    lines[OTHERS + 0u] = n0;
    lines[OTHERS + 1u] = n1;
    lines[OTHERS + 2u] = n2;
    lines[OTHERS + 3u] = n3;
    lines[OTHERS + 4u] = n4;
    lines[OTHERS + 5u] = n5;
    lines[OTHERS + 6u] = n6;
    lines[OTHERS + 7u] = n7;
    lines[OTHERS + 8u] = n8;
    lines[OTHERS + 9u] = n9;
    let made = select(first + count, 0u, solved.satisfied == ALL);
    return least_bad(made, first, hard, solved.satisfied, traits.y, solved.velocity);
}

// Where a neighbour is, m, how it moves, m/s, and the sum of the radii, m; less than 0: there is none.
struct Neighbour {
    motion: vec4<f32>,
    radius: f32,
    side: f32,
}

fn neighbour(k: u32, count: u32, slot: u32, own_radius: f32) -> Neighbour {
    let other = select(slot, found[k], k < count);
    let radius = own_radius + slot_motion[other * 2u + 1u].x + step.safety_margin;
    return Neighbour(slot_motion[other * 2u], select(-1.0, radius, k < count), select(-1.0, 1.0, slot < other));
}

fn line_of(other: Neighbour, share: f32, motion: vec4<f32>, rate: f32) -> vec4<f32> {
    let line = agent_line(
        motion.zw,
        other.motion.xy - motion.xy,
        motion.zw - other.motion.zw,
        other.radius,
        rate,
        step.inverse_time_step,
        share,
        other.side,
    );
    return select(line, FREE, other.radius < 0.0);
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
