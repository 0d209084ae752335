// uses: contents
// The nearest agents of one: the agent reads the five by five cells around it, whose rows are runs of slots, and keeps the
// nearest as packed keys: squared distance with its low bits replaced by the candidate's place in the five runs. Where that
// could differ from the order by (squared distance, id) (two keys agree in the bits left, fewer than wanted were found, a
// nearer one may stand farther out, the runs are too long) it looks in more cells or in fewer, up to nine by nine, again
// by keys. Where keys agree at the end, it compares their candidates exactly. Where there are too many candidates, or too few
// in nine by nine cells, it searches ring by ring. So the neighbours are always the exact ones. The keys stay in registers: an
// array with computed indices is slow memory on every device.
//
// Conditions are joined by & and |, which compute both: a branch costs more than a comparison where lanes go side by side.
//
// Needs the bindings step, slot_position, slot_motion, avoidance, and cell_start. With STOREYS agents on another storey do not count.
const PLACES: u32 = 255u;       // low bits of a key that number the candidates; the others are of the squared distance
const MORE_PLACES: u32 = 4095u; // the same where there are more candidates
const FEW: u32 = 44u;           // candidates on two storeys, of whom too few are on one
const FARTHEST: i32 = 4;        // most cells to every side that are looked in by keys
const NO_KEY: u32 = 0xffffffffu;
const UNSURE: u32 = 0xffffffffu;
// A cell's border is computed with rounding; a neighbour that near to it is looked for in the next ring as well.
const SAFE: f32 = 0.999;

// An agent that looks for neighbours.
struct Seeker {
    agent: u32,
    rate: f32,  // 1 / horizon, 1/s
    range: f32, // neighbour distance, m
    cap: u32,   // most neighbours
    is_led: bool,
}

fn seeker_of(slot: u32) -> Seeker {
    let me = slot_motion[slot];
    var own = avoidance[0];
    if (contents & UNLIKE) != 0u {
        own = avoidance[me.agent];
    }
    return Seeker(
        me.agent, own.inverse_time_horizon, own.neighbour_distance, me.limits & (LED_BIT - 1u), (me.limits & LED_BIT) != 0u,
    );
}

// Whether two walk together.
fn is_with(slot: u32, other: u32) -> bool {
    let group = slot_motion[slot].limits >> GROUP_SHIFT;
    return group != 0u && group == slot_motion[other].limits >> GROUP_SHIFT;
}

var<private> found: array<u32, 10>;       // slots of the neighbours, nearest first
var<private> found_distance2: array<f32, 10>;

var<private> next_reach: u32; // where quick_neighbours is UNSURE: how many cells to every side to look in next

// Finds the nearest `own.cap` (at most NEIGHBOURS) agents nearer than `own.range`, in five by five cells; returns how many there
// are in `found`, or UNSURE.
fn quick_neighbours(slot: u32, at: vec2<f32>, own: Seeker) -> u32 {
    let cap = min(own.cap, NEIGHBOURS);
    let range = own.range;
    let range2 = range * range;
    let elevation = slot_motion[slot].elevation;
    let centre = grid_cell(at, step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    let run0 = in_twos(run(centre, -2, 2, 0u));
    let run1 = in_twos(run(centre, -1, 2, run0.end));
    let run2 = in_twos(run(centre, 0, 2, run1.end));
    let run3 = in_twos(run(centre, 1, 2, run2.end));
    let run4 = in_twos(run(centre, 2, 2, run3.end));
    if (contents & STOREYS) != 0u && run4.end < FEW {
        // people above one another share the cells, so that too few of them are on the own storey
        let before = run1.shift + run0.end;
        let behind = run3.shift + run2.end;
        if is_mixed(before, run1.shift + run1.end, elevation) || is_mixed(behind, run3.shift + run3.end, elevation) {
            return keys_within(slot, at, own, 3);
        }
    }
    let fits = run4.end <= PLACES;
    let ends = vec4<u32>(run0.end, run1.end, run2.end, run3.end);
    let shift = vec4<u32>(run0.shift, run1.shift, run2.shift, run3.shift);
    keys_clear();
    let last = select(0u, run4.end, fits);
    let all = cell_start[step.cell_count];
    for (var place = 0u; place < last; place += 4u) {
        let low = slot_of(place, ends, shift, run4.shift);
        let high = slot_of(place + 2u, ends, shift, run4.shift);
        let keys = four_keys(place, last, low, high, slot, at, range2, elevation, all);
        c0 = keys.x;
        c1 = keys.y;
        c2 = keys.z;
        c3 = keys.w;
        offer();
    }
    let complete = is_complete(safe_distance(at, centre, 2), range, PLACES);
    if !fits | !complete | has_equals(PLACES) | same(k9, k10, PLACES) {
        next_reach = select(select(3u, 2u, complete), 1u, !fits);
        return UNSURE;
    }
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
    return min(cap, keys_found());
}

// Whether one of the first four slots from `first` on, before `end`, is on another storey.
fn is_mixed(first: u32, end: u32, elevation: f32) -> bool {
    var mixed = false;
    for (var i = 0u; i < 4u; i++) {
        let other = first + i;
        mixed = mixed || (other < end && !same_storey(min(other, max(end, 1u) - 1u), elevation));
    }
    return mixed;
}

// The same in so many cells to every side, then in more, and exactly where that is not enough.
fn far_neighbours(slot: u32, at: vec2<f32>, own: Seeker, first_reach: i32) -> u32 {
    var count = UNSURE;
    next_reach = u32(first_reach);
    while count == UNSURE && next_reach > 0u {
        count = keys_within(slot, at, own, i32(next_reach));
    }
    if count == UNSURE {
        count = search(slot, at, own);
    }
    return count;
}

// The same by keys in so many cells to every side. Where it is UNSURE, more cells can help, or none (next_reach is 0).
fn keys_within(slot: u32, at: vec2<f32>, own: Seeker, reach: i32) -> u32 {
    let range = own.range;
    let range2 = range * range;
    let elevation = slot_motion[slot].elevation;
    let centre = grid_cell(at, step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    let runs = nine_runs(centre, reach);
    let places = select(MORE_PLACES, PLACES, runs.end <= PLACES);
    let last = select(0u, runs.end, runs.end <= places);
    keys_clear();
    for (var place = 0u; place < last; place += 4u) {
        c0 = key(place, last, slot_in(place, runs), slot, at, range2, elevation, places);
        c1 = key(place + 1u, last, slot_in(place + 1u, runs), slot, at, range2, elevation, places);
        c2 = key(place + 2u, last, slot_in(place + 2u, runs), slot, at, range2, elevation, places);
        c3 = key(place + 3u, last, slot_in(place + 3u, runs), slot, at, range2, elevation, places);
        offer();
    }
    let complete = is_complete(safe_distance(at, centre, reach), range, places);
    if runs.end > places || !complete {
        next_reach = select(0u, u32(reach + 1), runs.end <= places && reach < FARTHEST);
        return UNSURE;
    }
    if same(k9, k10, places) {
        return as_near_as(k9 | places, last, runs, slot, at, own, places);
    }
    found[0] = slot_in(k0 & places, runs);
    found[1] = slot_in(k1 & places, runs);
    found[2] = slot_in(k2 & places, runs);
    found[3] = slot_in(k3 & places, runs);
    found[4] = slot_in(k4 & places, runs);
    found[5] = slot_in(k5 & places, runs);
    found[6] = slot_in(k6 & places, runs);
    found[7] = slot_in(k7 & places, runs);
    found[8] = slot_in(k8 & places, runs);
    found[9] = slot_in(k9 & places, runs);
    let count = keys_found();
    if has_equals(places) {
        // these are the nearest, but not in order
        var sorted = 0u;
        for (var i = 0u; i < count; i++) {
            let to = slot_position[found[i]] - at;
            sorted = insert(sorted, NEIGHBOURS, found[i], dot2(to, to));
        }
    }
    return min(min(own.cap, NEIGHBOURS), count);
}

// The nearest among the candidates whose keys are at most `most`, exactly: for where the last key that counts has an equal.
fn as_near_as(most: u32, last: u32, runs: Runs, slot: u32, at: vec2<f32>, own: Seeker, places: u32) -> u32 {
    let cap = min(own.cap, NEIGHBOURS);
    let range2 = own.range * own.range;
    let elevation = slot_motion[slot].elevation;
    var count = 0u;
    for (var place = 0u; place < last && cap > 0u; place++) {
        let other = slot_in(place, runs);
        if key(place, last, other, slot, at, range2, elevation, places) <= most {
            let to = slot_position[other] - at;
            count = insert(count, cap, other, dot2(to, to));
        }
    }
    return count;
}

// How many of the ten nearest keys there are.
fn keys_found() -> u32 {
    return u32(k0 != NO_KEY) + u32(k1 != NO_KEY) + u32(k2 != NO_KEY) + u32(k3 != NO_KEY) + u32(k4 != NO_KEY)
        + u32(k5 != NO_KEY) + u32(k6 != NO_KEY) + u32(k7 != NO_KEY) + u32(k8 != NO_KEY) + u32(k9 != NO_KEY);
}

// Whether no agent farther away than `safe`, where the cells end, can be nearer than one of the ten.
fn is_complete(safe: f32, range: f32, places: u32) -> bool {
    return (safe >= range) | ((k9 & ~places) < (bitcast<u32>(safe * safe) & ~places));
}

// A run of candidates: places up to `end`, whose slots are `shift` higher.
struct Run {
    end: u32,
    shift: u32,
}

// The cells of one row of a square with so many to every side of its centre.
fn run(centre: vec2<i32>, dy: i32, reach: i32, begin: u32) -> Run {
    let columns = i32(step.grid_columns);
    let y = centre.y + dy;
    let row = clamp(y, 0, i32(step.grid_rows) - 1) * columns;
    let first = cell_start[row + max(centre.x - reach, 0)];
    let end = cell_start[row + min(centre.x + reach, columns - 1) + 1];
    let is_there = (abs(dy) <= reach) & (y >= 0) & (y < i32(step.grid_rows));
    return Run(begin + select(0u, end - first, is_there), first - begin);
}

// The same with an even number of places, so that two candidates at an even place lie one behind the other. Where one is too many,
// it is the agent behind the run. It stands outside of the square, and so does no harm, or in a run as well: where a row of the
// grid ends. Then its two keys agree, and it is looked for again.
fn in_twos(run: Run) -> Run {
    return Run(run.end + (run.end & 1u), run.shift);
}

// The rows of a square of up to nine by nine cells.
struct Runs {
    low_ends: vec4<u32>,
    high_ends: vec4<u32>,
    end: u32, // of the last row
    low_shifts: vec4<u32>,
    high_shifts: vec4<u32>,
    shift: u32,
}

fn nine_runs(centre: vec2<i32>, reach: i32) -> Runs {
    let run0 = run(centre, -4, reach, 0u);
    let run1 = run(centre, -3, reach, run0.end);
    let run2 = run(centre, -2, reach, run1.end);
    let run3 = run(centre, -1, reach, run2.end);
    let run4 = run(centre, 0, reach, run3.end);
    let run5 = run(centre, 1, reach, run4.end);
    let run6 = run(centre, 2, reach, run5.end);
    let run7 = run(centre, 3, reach, run6.end);
    let run8 = run(centre, 4, reach, run7.end);
    return Runs(
        vec4<u32>(run0.end, run1.end, run2.end, run3.end),
        vec4<u32>(run4.end, run5.end, run6.end, run7.end),
        run8.end,
        vec4<u32>(run0.shift, run1.shift, run2.shift, run3.shift),
        vec4<u32>(run4.shift, run5.shift, run6.shift, run7.shift),
        run8.shift,
    );
}

fn slot_in(place: u32, runs: Runs) -> u32 {
    let is_low = place < runs.low_ends.w;
    let ends = select(runs.high_ends, runs.low_ends, is_low);
    let shifts = select(runs.high_shifts, runs.low_shifts, is_low);
    let upper = select(select(runs.shift, shifts.w, place < ends.w), shifts.z, place < ends.z);
    return place + select(select(upper, shifts.y, place < ends.y), shifts.x, place < ends.x);
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

// The key of a candidate; places from `last` on are none.
fn key(place: u32, last: u32, candidate: u32, slot: u32, at: vec2<f32>, range2: f32, elevation: f32, places: u32) -> u32 {
    let to = slot_position[candidate] - at;
    let distance2 = dot2(to, to);
    var wanted = (place < last) & (candidate != slot) & (distance2 < range2);
    if (contents & STOREYS) != 0u {
        wanted = wanted & same_storey(candidate, elevation);
    }
    return select(NO_KEY, (bitcast<u32>(distance2) & ~places) | place, wanted);
}

// The keys of two candidates from an even place on, of which the first is `low`, and of the next two, which begin with `high`. `all`
// slots are taken.
fn four_keys(place: u32, last: u32, low: u32, high: u32, slot: u32, at: vec2<f32>, range2: f32, elevation: f32, all: u32) -> vec4<u32> {
    let p0 = slot_position[low];
    let p1 = slot_position[low + 1u];
    let p2 = slot_position[high];
    let p3 = slot_position[high + 1u];
    let x = vec4<f32>(p0.x, p1.x, p2.x, p3.x) - at.x;
    let y = vec4<f32>(p0.y, p1.y, p2.y, p3.y) - at.y;
    let distance2 = x * x + y * y;
    let candidates = vec4<u32>(low, low + 1u, high, high + 1u);
    var wanted = (candidates != vec4<u32>(slot)) & (candidates < vec4<u32>(all)) & (distance2 < vec4<f32>(range2));
    wanted &= place + vec4<u32>(0u, 0u, 2u, 2u) < vec4<u32>(last);
    if (contents & STOREYS) != 0u {
        let others = min(candidates, vec4<u32>(all - 1u));
        wanted &= vec4<bool>(
            same_storey(others.x, elevation),
            same_storey(others.y, elevation),
            same_storey(others.z, elevation),
            same_storey(others.w, elevation),
        );
    }
    let places = place + vec4<u32>(0u, 1u, 2u, 3u);
    return select(vec4<u32>(NO_KEY), (bitcast<vec4<u32>>(distance2) & vec4<u32>(~PLACES)) | places, wanted);
}

// Puts two keys in order.
fn order(low: ptr<private, u32>, high: ptr<private, u32>) {
    let smaller = min(*low, *high);
    *high = max(*low, *high);
    *low = smaller;
}

// Four candidates at a time: sorted among themselves (a network of five comparisons), the better ends of the two
// lists kept, which makes a bitonic list, and that list sorted (17 comparisons).
fn offer() {
    order(&c0, &c1); order(&c2, &c3);
    order(&c0, &c2); order(&c1, &c3);
    order(&c1, &c2);
    k7 = min(k7, c3); k8 = min(k8, c2); k9 = min(k9, c1); k10 = min(k10, c0);
    order(&k0, &k8); order(&k1, &k9); order(&k2, &k10);
    order(&k3, &k7); order(&k4, &k8); order(&k5, &k9); order(&k6, &k10);
    order(&k0, &k2); order(&k3, &k5); order(&k4, &k6); order(&k7, &k9); order(&k8, &k10);
    order(&k1, &k2); order(&k3, &k4); order(&k5, &k6); order(&k7, &k8); order(&k9, &k10);
}

var<private> c0: u32;
var<private> c1: u32;
var<private> c2: u32;
var<private> c3: u32;

fn same_storey(slot: u32, elevation: f32) -> bool {
    return abs(slot_motion[slot].elevation - elevation) < step.storey_height;
}

// Two keys whose order the low bits decided.
fn same(nearer: u32, farther: u32, places: u32) -> bool {
    return (farther != NO_KEY) & ((nearer & ~places) == (farther & ~places));
}

// Whether that holds for two of the ten nearest.
fn has_equals(places: u32) -> bool {
    return same(k0, k1, places) | same(k1, k2, places) | same(k2, k3, places) | same(k3, k4, places) | same(k4, k5, places)
        | same(k5, k6, places) | same(k6, k7, places) | same(k7, k8, places) | same(k8, k9, places);
}

fn slot_of(key: u32, ends: vec4<u32>, shift: vec4<u32>, last_shift: u32) -> u32 {
    let place = key & PLACES;
    let upper = select(select(last_shift, shift.w, place < ends.w), shift.z, place < ends.z);
    return place + select(select(upper, shift.y, place < ends.y), shift.x, place < ends.x);
}

// The exact search: ring by ring of cells, stopping when no farther ring can hold a nearer one. Returns how many.
fn search(slot: u32, at: vec2<f32>, own: Seeker) -> u32 {
    let cap = min(own.cap, NEIGHBOURS);
    let range = own.range;
    let elevation = slot_motion[slot].elevation;
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
                        let to = slot_position[other] - at;
                        let distance2 = dot2(to, to);
                        if other != slot && distance2 < range * range
                            && ((contents & STOREYS) == 0u || same_storey(other, elevation)) {
                            count = insert(count, cap, other, distance2);
                        }
                    }
                }
            }
        }
        let safe = safe_distance(at, centre, ring);
        done = safe >= range;
        if count == cap {
            done = done || found_distance2[cap - 1u] < safe * safe;
        }
    }
    return count;
}

// Lower bound of the distance of agents outside the square of 2 ring + 1 cells, m.
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
    return distance2 < there || (distance2 == there && id < slot_motion[found[i]].agent);
}

fn insert(count: u32, cap: u32, slot: u32, distance2: f32) -> u32 {
    let id = slot_motion[slot].agent;
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
