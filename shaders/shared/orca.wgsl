// uses: exact
// ORCA lines and the linear programs over them; twin: reference::orca.
// Based on: van den Berg, Guy, Lin, Manocha, "Reciprocal n-Body Collision Avoidance" (2011); the treatment of
// obstacle segments is RVO2's. A line is (point, direction): m/s, unit; velocities to its left are permitted.
const NEIGHBOURS = 10u;
const SEGMENTS = 12u;
const OTHERS = 13u; // where the lines of neighbours begin, for least_bad
const LINES = 23u;
const ALL = 0xffffffffu; // of Solved: all lines are satisfied
const EPSILON = 0.00001;
const FAR_AWAY = 3.4028235e38;
const FREE = vec4<f32>(0.0, -1e30, 1.0, 0.0); // a line that forbids nothing

// Lines in 0..LINES, their bisectors in LINES..2 LINES: one array, because the programs run over either.
var<private> lines: array<vec4<f32>, 46>;

fn unit_or(v: vec2<f32>, fallback: vec2<f32>) -> vec2<f32> {
    let length = sqrt(dot2(v, v));
    if length > 0.0 {
        return v / length;
    }
    return fallback;
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
    let circle = colliding || (d < 0.0 && d * d > radius2 * w2);
    let u = select(on_leg, on_circle, circle);
    return vec4<f32>(velocity + u * share, select(tangent, vec2<f32>(unit.y, -unit.x), circle));
}

// The part of a line that is still permitted: line.xy + line.zw t with t in left..right.
struct Span {
    left: f32,
    right: f32,
    possible: bool,
}

// The part within the disc of permitted speeds.
fn span_in_disc(line: vec4<f32>, radius: f32) -> Span {
    let d = dot2(line.xy, line.zw);
    let discriminant = d * d + radius * radius - dot2(line.xy, line.xy);
    let root = sqrt(max(discriminant, 0.0));
    return Span(-d - root, -d + root, discriminant >= 0.0);
}

// What another line leaves of it.
fn cut(span: Span, line: vec4<f32>, other: vec4<f32>) -> Span {
    let denominator = det2(line.zw, other.zw);
    let numerator = det2(other.zw, line.xy - other.xy);
    let parallel = abs(denominator) <= EPSILON;
    let t = numerator / denominator;
    let right = select(span.right, min(span.right, t), denominator >= 0.0 && !parallel);
    let left = select(max(span.left, t), span.left, denominator >= 0.0 || parallel);
    let possible = select(left <= right, numerator >= 0.0, parallel);
    return Span(left, right, span.possible && possible);
}

// The velocity in the span that is nearest to `wanted` (or farthest along it).
fn best_in(span: Span, line: vec4<f32>, wanted: vec2<f32>, far: bool) -> vec2<f32> {
    let direct = clamp(dot2(line.zw, wanted - line.xy), span.left, max(span.left, span.right));
    let t = select(direct, select(span.left, span.right, dot2(wanted, line.zw) > 0.0), far);
    return line.xy + line.zw * t;
}

// Whether a line forbids a velocity.
fn forbids(line: vec4<f32>, velocity: vec2<f32>) -> bool {
    return det2(line.zw, line.xy - velocity) > 0.0;
}

struct Solved {
    velocity: vec2<f32>,
    satisfied: u32, // all lines, or the number of the first that could not be satisfied
}

// The velocity that is wanted if there are no lines, within the disc.
fn unconstrained(radius: f32, wanted: vec2<f32>, far: bool) -> vec2<f32> {
    let length2 = dot2(wanted, wanted);
    let limited = select(wanted, wanted / sqrt(length2) * radius, length2 > radius * radius);
    return select(limited, wanted * radius, far);
}

// The permitted velocity nearest to `wanted` (or farthest along it), of lines[base..base + count].
fn within(base: u32, count: u32, radius: f32, wanted: vec2<f32>, far: bool) -> Solved {
    var result = unconstrained(radius, wanted, far);
    var number = 0u;
    for (; number < count; number++) {
        let line = lines[base + number];
        if forbids(line, result) {
            var span = span_in_disc(line, radius);
            for (var i = 0u; i < number && span.possible; i++) {
                span = cut(span, line, lines[base + i]);
            }
            if !span.possible {
                break;
            }
            result = best_in(span, line, wanted, far);
        }
    }
    return Solved(result, number);
}

// The lines of the neighbours, nearest first. They stay in registers: an array with a computed index is slow memory on
// every device. A missing neighbour has a line that forbids nothing.
var<private> n0: vec4<f32>;
var<private> n1: vec4<f32>;
var<private> n2: vec4<f32>;
var<private> n3: vec4<f32>;
var<private> n4: vec4<f32>;
var<private> n5: vec4<f32>;
var<private> n6: vec4<f32>;
var<private> n7: vec4<f32>;
var<private> n8: vec4<f32>;
var<private> n9: vec4<f32>;

fn cut1(span: Span, line: vec4<f32>) -> Span { return cut(span, line, n0); }
fn cut2(span: Span, line: vec4<f32>) -> Span { return cut(cut1(span, line), line, n1); }
fn cut3(span: Span, line: vec4<f32>) -> Span { return cut(cut2(span, line), line, n2); }
fn cut4(span: Span, line: vec4<f32>) -> Span { return cut(cut3(span, line), line, n3); }
fn cut5(span: Span, line: vec4<f32>) -> Span { return cut(cut4(span, line), line, n4); }
fn cut6(span: Span, line: vec4<f32>) -> Span { return cut(cut5(span, line), line, n5); }
fn cut7(span: Span, line: vec4<f32>) -> Span { return cut(cut6(span, line), line, n6); }
fn cut8(span: Span, line: vec4<f32>) -> Span { return cut(cut7(span, line), line, n7); }
fn cut9(span: Span, line: vec4<f32>) -> Span { return cut(cut8(span, line), line, n8); }

// Moves the result to a line that forbids it, given what the lines before leave of that line.
fn settle(s: Solved, line: vec4<f32>, span: Span, number: u32, wanted: vec2<f32>) -> Solved {
    let wrong = s.satisfied == ALL && forbids(line, s.velocity);
    let moved = select(s.velocity, best_in(span, line, wanted, false), wrong && span.possible);
    return Solved(moved, select(s.satisfied, number, wrong && !span.possible));
}

// `within` over lines[0..first] and then the lines of the neighbours; `satisfied` is ALL if all are.
fn within_all(first: u32, radius: f32, wanted: vec2<f32>) -> Solved {
    var s = within(0u, first, radius, wanted, false);
    s.satisfied = select(s.satisfied, ALL, s.satisfied == first);
    var span0 = span_in_disc(n0, radius);
    var span1 = span_in_disc(n1, radius);
    var span2 = span_in_disc(n2, radius);
    var span3 = span_in_disc(n3, radius);
    var span4 = span_in_disc(n4, radius);
    var span5 = span_in_disc(n5, radius);
    var span6 = span_in_disc(n6, radius);
    var span7 = span_in_disc(n7, radius);
    var span8 = span_in_disc(n8, radius);
    var span9 = span_in_disc(n9, radius);
    for (var i = 0u; i < first; i++) {
        let line = lines[i];
        span0 = cut(span0, n0, line);
        span1 = cut(span1, n1, line);
        span2 = cut(span2, n2, line);
        span3 = cut(span3, n3, line);
        span4 = cut(span4, n4, line);
        span5 = cut(span5, n5, line);
        span6 = cut(span6, n6, line);
        span7 = cut(span7, n7, line);
        span8 = cut(span8, n8, line);
        span9 = cut(span9, n9, line);
    }
    s = settle(s, n0, span0, first, wanted);
    s = settle(s, n1, cut1(span1, n1), first + 1u, wanted);
    s = settle(s, n2, cut2(span2, n2), first + 2u, wanted);
    s = settle(s, n3, cut3(span3, n3), first + 3u, wanted);
    s = settle(s, n4, cut4(span4, n4), first + 4u, wanted);
    s = settle(s, n5, cut5(span5, n5), first + 5u, wanted);
    s = settle(s, n6, cut6(span6, n6), first + 6u, wanted);
    s = settle(s, n7, cut7(span7, n7), first + 7u, wanted);
    s = settle(s, n8, cut8(span8, n8), first + 8u, wanted);
    s = settle(s, n9, cut9(span9, n9), first + 9u, wanted);
    return s;
}

// When not all lines can be satisfied: the velocity that violates them least, never one of the `hard` first.
fn least_bad(count: u32, first: u32, hard: u32, begin: u32, radius: f32, start: vec2<f32>) -> vec2<f32> {
    var result = start;
    var violation = 0.0;
    for (var number = begin; number < count; number++) {
        let line = lines[select(number, number - first + OTHERS, number >= first)];
        if det2(line.zw, line.xy - result) > violation {
            var made = 0u;
            for (var i = 0u; i < number; i++) {
                let other = lines[select(i, i - first + OTHERS, i >= first)];
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

// An obstacle segment, solid on its left.
struct Segment {
    a: vec2<f32>,
    b: vec2<f32>,
    along: vec2<f32>,  // unit direction from a to b
    before: vec2<f32>, // of the segment before
    after: vec2<f32>,  // of the segment after
    a_convex: bool,
    b_convex: bool,
}

// Squared distance from p to a segment if p is on its open (right) side, else FAR_AWAY.
fn segment_distance2(ends: vec4<f32>, p: vec2<f32>) -> f32 {
    let ab = ends.zw - ends.xy;
    let ap = p - ends.xy;
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
        return MaybeLine(vec4<f32>(0.0, 0.0, unit_or(vec2<f32>(-to_a.y, to_a.x), vec2<f32>(1.0, 0.0))), s_.a_convex);
    }
    if s > 1.0 && b2 <= radius2 {
        // Touching the second corner, unless the next segment takes care of it.
        let dir = unit_or(vec2<f32>(-to_b.y, to_b.x), vec2<f32>(1.0, 0.0));
        return MaybeLine(vec4<f32>(0.0, 0.0, dir), s_.b_convex && det2(to_b, s_.after) >= 0.0);
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
        if !s_.a_convex {
            return nothing;
        }
        is_corner = true;
        s_.b = s_.a;
        s_.b_convex = s_.a_convex;
        s_.after = s_.along;
        left = leg(to_a, a2, radius, 1.0);
        right = leg(to_a, a2, radius, -1.0);
    } else if s > 1.0 && off2 <= radius2 {
        if !s_.b_convex {
            return nothing;
        }
        is_corner = true;
        s_.a = s_.b;
        s_.a_convex = s_.b_convex;
        s_.before = s_.along;
        left = leg(to_b, b2, radius, 1.0);
        right = leg(to_b, b2, radius, -1.0);
    } else {
        if s_.a_convex {
            left = leg(to_a, a2, radius, 1.0);
        }
        if s_.b_convex {
            right = leg(to_b, b2, radius, -1.0);
        }
    }
    // A leg never points into the neighbouring segment of a convex corner; a foreign leg adds no line.
    let left_foreign = s_.a_convex && det2(left, -s_.before) >= 0.0;
    if left_foreign {
        left = -s_.before;
    }
    let right_foreign = s_.b_convex && det2(right, s_.after) <= 0.0;
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
