// uses: exact
// ORCA lines and the linear programs over them; twin: reference::orca.
// Based on: van den Berg, Guy, Lin, Manocha, "Reciprocal n-Body Collision Avoidance" (2011); the treatment of
// obstacle segments is RVO2's. A line is (point, direction): m/s, unit; velocities to its left are permitted.
const NEIGHBOURS: u32 = 10u;
const SEGMENTS: u32 = 12u;
const LINES: u32 = 23u;
const EPSILON: f32 = 0.00001;
// An agent with the right of way avoids collisions with others within this time only, 1/s (of 0.15 s).
const RIGHT_OF_WAY: f32 = 6.6666665;
// Members of a group avoid collisions with one another within this time only, 1/s (of 0.25 s).
const TOGETHER: f32 = 4.0;
const FAR_AWAY: f32 = 3.4028235e38;

// Lines in 0..LINES, their bisectors in LINES..2 LINES: one array, because the programs run over either.
var<private> lines: array<vec4<f32>, 46>;

fn unit_or(v: vec2<f32>, fallback: vec2<f32>) -> vec2<f32> {
    let length = sqrt(dot2(v, v));
    if length > 0.0 {
        return v / length;
    }
    return fallback;
}

// The part of the avoidance that an agent takes towards another: `equal` if they have the same priority; `higher`
// is how much higher that of the other is. 0: it has the right of way and leaves the avoidance to the other, but is not to run it over.
fn share_of(equal: f32, higher: f32) -> f32 {
    return clamp(equal + 0.5 * higher, 0.0, 1.0);
}

// The line that another disc imposes. relative_position (m) and relative_velocity (m/s) are other minus own and own
// minus other; radius the sum of the radii, m; share the part of the avoidance taken; side breaks the tie of two
// discs at one point.
fn agent_line(velocity: vec2<f32>, relative_position: vec2<f32>, relative_velocity: vec2<f32>, radius: f32,
              inverse_time_horizon: f32, inverse_time_step: f32, share: f32, side: f32) -> vec4<f32> {
    let rp = relative_position;
    let rv = relative_velocity;
    let distance2 = dot2(rp, rp);
    let radius2 = radius * radius;
    let colliding = distance2 <= radius2;
    // Colliding: be apart after one step. Else: no contact within the horizon.
    let rate = select(inverse_time_horizon, inverse_time_step, colliding);
    let w = rv - rp * rate;
    let w2 = dot2(w, w);
    let d = dot2(w, rp);
    // Project on the cut-off circle.
    let length = sqrt(w2);
    let unit = select(vec2<f32>(side, 0.0), w / length, length > 0.0);
    let on_circle = unit * (radius * rate - length);
    // Project on the nearer leg: left if w points left of the line to the other.
    let leg = sqrt(max(distance2 - radius2, 0.0));
    let sign = select(-1.0, 1.0, det2(rp, w) > 0.0);
    let scale = sign / distance2;
    let tangent = vec2<f32>(rp.x * leg - sign * rp.y * radius, sign * rp.x * radius + rp.y * leg) * scale;
    let on_leg = tangent * dot2(rv, tangent) - rv;
    let circle = colliding | ((d < 0.0) & (d * d > radius2 * w2));
    let u = select(on_leg, on_circle, circle);
    return vec4<f32>(velocity + u * share, select(tangent, vec2<f32>(unit.y, -unit.x), circle));
}

// On line `number` of the `base` array, the velocity nearest to `wanted` (or farthest along it) in the disc of
// permitted speeds and left of the lines before: (velocity, 1, 0), or (0, 0, 0, 0) if there is none.
fn on_line(base: u32, number: u32, radius: f32, wanted: vec2<f32>, far: bool) -> vec4<f32> {
    let line = lines[base + number];
    let d = dot2(line.xy, line.zw);
    let discriminant = d * d + radius * radius - dot2(line.xy, line.xy);
    var possible = discriminant >= 0.0;
    let root = sqrt(max(discriminant, 0.0));
    var left = -d - root;
    var right = -d + root;
    // All lines, also where one of the first leaves nothing: then turns do not wait for one another.
    for (var i = 0u; i < number; i++) {
        let other = lines[base + i];
        let denominator = det2(line.zw, other.zw);
        let numerator = det2(other.zw, line.xy - other.xy);
        let is_parallel = abs(denominator) <= EPSILON;
        possible = possible & (!is_parallel | (numerator >= 0.0));
        let t = numerator / denominator;
        right = select(right, min(right, t), !is_parallel & (denominator >= 0.0));
        left = select(left, max(left, t), !is_parallel & (denominator < 0.0));
    }
    possible = possible & (left <= right);
    let direct = clamp(dot2(line.zw, wanted - line.xy), left, max(left, right));
    let t = select(direct, select(left, right, dot2(wanted, line.zw) > 0.0), far);
    return select(vec4<f32>(0.0), vec4<f32>(line.xy + line.zw * t, 1.0, 0.0), possible);
}

struct Solved {
    velocity: vec2<f32>,
    satisfied: u32, // all lines, or the number of the first that could not be satisfied
}

// The permitted velocity nearest to `wanted` (or farthest along it).
fn within(base: u32, count: u32, radius: f32, wanted: vec2<f32>, far: bool) -> Solved {
    let length2 = dot2(wanted, wanted);
    var result = wanted;
    if far {
        result = wanted * radius;
    } else if length2 > radius * radius {
        result = wanted / sqrt(length2) * radius;
    }
    var number = 0u;
    for (; number < count; number++) {
        let line = lines[base + number];
        if det2(line.zw, line.xy - result) > 0.0 {
            let better = on_line(base, number, radius, wanted, far);
            if better.z == 0.0 {
                break;
            }
            result = better.xy;
        }
    }
    return Solved(result, number);
}

// When not all lines can be satisfied: the velocity that violates them least, never one of the `hard` first.
fn least_bad(count: u32, hard: u32, begin: u32, radius: f32, start: vec2<f32>) -> vec2<f32> {
    var result = start;
    var violation = 0.0;
    for (var number = begin; number < count; number++) {
        let line = lines[number];
        if det2(line.zw, line.xy - result) > violation {
            var made = 0u;
            for (var i = 0u; i < number; i++) {
                let other = lines[i];
                let determinant = det2(line.zw, other.zw);
                let parallel = abs(determinant) <= EPSILON;
                var at = line.xy + line.zw * (det2(other.zw, line.xy - other.xy) / determinant);
                if parallel {
                    at = (line.xy + other.xy) * 0.5;
                }
                let bisector = vec4<f32>(at, unit_or(other.zw - line.zw, vec2<f32>(1.0, 0.0)));
                let is_hard = i < hard;
                // same direction: the nearer one is the stricter, no bisector
                if is_hard || !(parallel && dot2(line.zw, other.zw) > 0.0) {
                    lines[LINES + made] = select(bisector, other, is_hard);
                    made++;
                }
            }
            let better = within(LINES, made, radius, vec2<f32>(-line.w, line.z), true);
            if better.satisfied == made { // else: by rounding only; the last result is kept
                result = better.velocity;
            }
            violation = det2(line.zw, line.xy - result);
        }
    }
    return result;
}

// Buffer `obstacles`: the segments of walls, solid on their left, [segment].
struct Segment {
    a: vec2<f32>,       // m
    b: vec2<f32>,       // m
    along: vec2<f32>,   // unit direction from a to b
    before: vec2<f32>,  // of the segment before
    after: vec2<f32>,   // of the segment after
    corners: vec2<f32>, // of a and b: above 0 where convex; their sizes say at which heights it stands (stands_at)
}

// Added to the heights of a segment that stands at some heights only, so that they cannot be taken for flags.
const RAISED: f32 = 3000.0;
// Height of a body that has to pass under something, m.
const TALL: f32 = 1.8;

// Whether a segment with these two corners is in the way of an agent that stands at `elevation`.
fn stands_at(corners: vec2<f32>, elevation: f32) -> bool {
    let low = abs(corners.x) - RAISED;
    let high = abs(corners.y) - RAISED;
    return low < -1500.0 || (elevation + TALL > low && elevation < high);
}

// Squared distance from p to a segment if p is on its open (right) side, else FAR_AWAY.
fn segment_distance2(a: vec2<f32>, b: vec2<f32>, p: vec2<f32>) -> f32 {
    let ab = b - a;
    let ap = p - a;
    if det2(ab, ap) >= 0.0 {
        return FAR_AWAY;
    }
    let t = clamp(dot2(ap, ab) / dot2(ab, ab), 0.0, 1.0);
    let off = ap - ab * t;
    return dot2(off, off);
}

// Whether lines[0..count] already keep the agent off the whole segment.
fn is_covered(count: u32, rate: f32, to_a: vec2<f32>, to_b: vec2<f32>, radius: f32) -> bool {
    let slack = rate * radius - EPSILON;
    var covered = false;
    for (var i = 0u; i < count && !covered; i++) {
        let line = lines[i];
        covered = det2(to_a * rate - line.xy, line.zw) >= slack && det2(to_b * rate - line.xy, line.zw) >= slack;
    }
    return covered;
}

// Tangent direction from the agent to a corner seen as a disc: side +1 is the left leg, -1 the right.
fn leg(to: vec2<f32>, distance2: f32, radius: f32, side: f32) -> vec2<f32> {
    let length = sqrt(max(distance2 - radius * radius, 0.0));
    return vec2<f32>(to.x * length - side * to.y * radius, side * to.x * radius + to.y * length) / distance2;
}

fn around(centre: vec2<f32>, relative: vec2<f32>, reach: f32) -> vec4<f32> {
    let unit = unit_or(relative, vec2<f32>(1.0, 0.0));
    return vec4<f32>(centre + unit * reach, unit.y, -unit.x);
}

fn beside(centre: vec2<f32>, dir: vec2<f32>, reach: f32) -> vec4<f32> {
    return vec4<f32>(centre.x - dir.y * reach, centre.y + dir.x * reach, dir);
}

fn off_line2(relative: vec2<f32>, dir: vec2<f32>, t: f32) -> f32 {
    let d = relative - dir * t;
    return dot2(d, d);
}

struct MaybeLine {
    line: vec4<f32>,
    is_there: bool,
}

// The line that an obstacle segment imposes, if any; lines[0..count] are those of nearer segments.
fn obstacle_line(count: u32, segment: Segment, position: vec2<f32>, velocity: vec2<f32>, radius: f32, rate: f32) -> MaybeLine {
    var s_ = segment;
    let nothing = MaybeLine(vec4<f32>(0.0), false);
    let to_a = s_.a - position;
    let to_b = s_.b - position;
    if is_covered(count, rate, to_a, to_b, radius) {
        return nothing;
    }
    let a2 = dot2(to_a, to_a);
    let b2 = dot2(to_b, to_b);
    let radius2 = radius * radius;
    let ab = s_.b - s_.a;
    let s = -dot2(to_a, ab) / dot2(ab, ab);
    let off = -to_a - ab * s;
    let off2 = dot2(off, off);
    if s < 0.0 && a2 <= radius2 {
        // Touching the first corner.
        return MaybeLine(vec4<f32>(0.0, 0.0, unit_or(vec2<f32>(-to_a.y, to_a.x), vec2<f32>(1.0, 0.0))), (s_.corners.x > 0.0));
    }
    if s > 1.0 && b2 <= radius2 {
        // Touching the second corner, unless the next segment takes care of it.
        let dir = unit_or(vec2<f32>(-to_b.y, to_b.x), vec2<f32>(1.0, 0.0));
        return MaybeLine(vec4<f32>(0.0, 0.0, dir), (s_.corners.y > 0.0) && det2(to_b, s_.after) >= 0.0);
    }
    if s >= 0.0 && s <= 1.0 && off2 <= radius2 {
        // Touching the segment.
        return MaybeLine(vec4<f32>(0.0, 0.0, -s_.along), true);
    }
    // Legs: tangents to the corners; where a corner is concave the segment itself goes on.
    var left = -s_.along;
    var right = s_.along;
    var is_corner = false;
    if s < 0.0 && off2 <= radius2 {
        // Seen so obliquely that the first corner hides the rest.
        if !(s_.corners.x > 0.0) {
            return nothing;
        }
        is_corner = true;
        s_.b = s_.a;
        s_.corners.y = s_.corners.x;
        s_.after = s_.along;
        left = leg(to_a, a2, radius, 1.0);
        right = leg(to_a, a2, radius, -1.0);
    } else if s > 1.0 && off2 <= radius2 {
        if !(s_.corners.y > 0.0) {
            return nothing;
        }
        is_corner = true;
        s_.a = s_.b;
        s_.corners.x = s_.corners.y;
        s_.before = s_.along;
        left = leg(to_b, b2, radius, 1.0);
        right = leg(to_b, b2, radius, -1.0);
    } else {
        if s_.corners.x > 0.0 {
            left = leg(to_a, a2, radius, 1.0);
        }
        if s_.corners.y > 0.0 {
            right = leg(to_b, b2, radius, -1.0);
        }
    }
    // A leg never points into the neighbouring segment of a convex corner; a foreign leg adds no line.
    let left_foreign = (s_.corners.x > 0.0) && det2(left, -s_.before) >= 0.0;
    if left_foreign {
        left = -s_.before;
    }
    let right_foreign = (s_.corners.y > 0.0) && det2(right, s_.after) <= 0.0;
    if right_foreign {
        right = s_.after;
    }
    let cut_a = (s_.a - position) * rate;
    let cut_b = (s_.b - position) * rate;
    let cut = cut_b - cut_a;
    let from_a = velocity - cut_a;
    let from_b = velocity - cut_b;
    let reach = radius * rate;
    var t = 0.5;
    if !is_corner {
        t = dot2(from_a, cut) / dot2(cut, cut);
    }
    let t_left = dot2(from_a, left);
    let t_right = dot2(from_b, right);
    if (t < 0.0 && t_left < 0.0) || (is_corner && t_left < 0.0 && t_right < 0.0) {
        return MaybeLine(around(cut_a, from_a, reach), true);
    }
    if t > 1.0 && t_right < 0.0 {
        return MaybeLine(around(cut_b, from_b, reach), true);
    }
    let to_cut = select(off_line2(from_a, cut, t), FAR_AWAY, t < 0.0 || t > 1.0 || is_corner);
    let to_left = select(off_line2(from_a, left, t_left), FAR_AWAY, t_left < 0.0);
    let to_right = select(off_line2(from_b, right, t_right), FAR_AWAY, t_right < 0.0);
    if to_cut <= to_left && to_cut <= to_right {
        return MaybeLine(beside(cut_a, -s_.along, reach), true);
    }
    if to_left <= to_right {
        return MaybeLine(beside(cut_a, left, reach), !left_foreign);
    }
    return MaybeLine(beside(cut_b, -right, reach), !right_foreign);
}
