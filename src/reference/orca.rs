//! ORCA lines and the linear programs over them: twin of `shaders/shared/orca.wgsl`.
//!
//! Based on: van den Berg, Guy, Lin, Manocha, "Reciprocal n-Body Collision Avoidance" (2011); the treatment of
//! obstacle segments is RVO2's. A line is `[point.x, point.y, direction.x, direction.y]`; velocities to its left
//! are permitted.

use super::exact::{det2, dot2};

/// Most neighbours an agent avoids.
pub const NEIGHBOURS: usize = 10;
/// Most obstacle segments an agent avoids.
pub const SEGMENTS: usize = 12;
/// Most lines: segments, the user, neighbours.
pub const LINES: usize = SEGMENTS + 1 + NEIGHBOURS;
/// Below this a determinant counts as zero.
pub const EPSILON: f32 = 0.00001;

/// A half-plane of permitted velocities: point (m/s), unit direction.
pub type Line = [f32; 4];

fn point(line: Line) -> [f32; 2] {
    [line[0], line[1]]
}

fn direction(line: Line) -> [f32; 2] {
    [line[2], line[3]]
}

fn sub(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn along(line: Line, t: f32) -> [f32; 2] {
    [line[0] + line[2] * t, line[1] + line[3] * t]
}

/// `v` divided by its length, or `fallback` when it has none.
pub fn unit_or(v: [f32; 2], fallback: [f32; 2]) -> [f32; 2] {
    let length = dot2(v, v).sqrt();
    if length > 0.0 { [v[0] / length, v[1] / length] } else { fallback }
}

/// The part of the avoidance that an agent takes towards another: `equal` if they have the same priority.
pub fn share_of(equal: f32, own_priority: f32, their_priority: f32) -> f32 {
    (equal + 0.5 * (their_priority - own_priority)).clamp(0.0, 1.0)
}

/// The line that another disc imposes.
///
/// `relative_position` (m) and `relative_velocity` (m/s) are other minus own and own minus other; `radius` the sum
/// of the radii, m; `share` the part of the avoidance taken; `side` breaks the tie of two discs at one point.
#[allow(clippy::too_many_arguments, reason = "mirrors the shader")]
pub fn agent_line(
    velocity: [f32; 2],
    relative_position: [f32; 2],
    relative_velocity: [f32; 2],
    radius: f32,
    inverse_time_horizon: f32,
    inverse_time_step: f32,
    share: f32,
    side: f32,
) -> Line {
    let rp = relative_position;
    let rv = relative_velocity;
    let distance2 = dot2(rp, rp);
    let radius2 = radius * radius;
    let colliding = distance2 <= radius2;
    // Colliding: be apart after one step. Else: no contact within the horizon.
    let rate = if colliding { inverse_time_step } else { inverse_time_horizon };
    let w = [rv[0] - rp[0] * rate, rv[1] - rp[1] * rate];
    let w2 = dot2(w, w);
    let d = dot2(w, rp);
    let (dir, u);
    if colliding || (d < 0.0 && d * d > radius2 * w2) {
        // Project on the cut-off circle.
        let length = w2.sqrt();
        let unit = if length > 0.0 { [w[0] / length, w[1] / length] } else { [side, 0.0] };
        dir = [unit[1], -unit[0]];
        let scale = radius * rate - length;
        u = [unit[0] * scale, unit[1] * scale];
    } else {
        // Project on the nearer leg: left if w points left of the line to the other.
        let leg = (distance2 - radius2).sqrt();
        let sign = if det2(rp, w) > 0.0 { 1.0 } else { -1.0 };
        let x = rp[0] * leg - sign * rp[1] * radius;
        let y = sign * rp[0] * radius + rp[1] * leg;
        let scale = sign / distance2;
        dir = [x * scale, y * scale];
        let t = dot2(rv, dir);
        u = [dir[0] * t - rv[0], dir[1] * t - rv[1]];
    }
    [velocity[0] + u[0] * share, velocity[1] + u[1] * share, dir[0], dir[1]]
}

/// The part of line `number` that lies in the disc of permitted speeds and left of the lines before it, and on it
/// the point nearest to `wanted` (or farthest along `wanted`). `None` if there is none.
fn on_line(lines: &[Line], number: usize, radius: f32, wanted: [f32; 2], far: bool) -> Option<[f32; 2]> {
    let line = lines[number];
    let d = dot2(point(line), direction(line));
    let discriminant = d * d + radius * radius - dot2(point(line), point(line));
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let mut left = -d - root;
    let mut right = -d + root;
    for &other in &lines[..number] {
        let denominator = det2(direction(line), direction(other));
        let numerator = det2(direction(other), sub(point(line), point(other)));
        if denominator.abs() <= EPSILON {
            if numerator < 0.0 {
                return None;
            }
            continue;
        }
        let t = numerator / denominator;
        // not min and max, which have NaN to think of
        if denominator >= 0.0 {
            right = if t < right { t } else { right };
        } else {
            left = if t > left { t } else { left };
        }
        if left > right {
            return None;
        }
    }
    let t = if far {
        if dot2(wanted, direction(line)) > 0.0 { right } else { left }
    } else {
        let t = dot2(direction(line), sub(wanted, point(line)));
        if t < left {
            left
        } else if t > right {
            right
        } else {
            t
        }
    };
    Some(along(line, t))
}

/// The permitted velocity nearest to `wanted` (or farthest along it), and how many lines were satisfied: all of
/// them, or the number of the first that could not be.
pub fn within(lines: &[Line], radius: f32, wanted: [f32; 2], far: bool) -> (usize, [f32; 2]) {
    let length2 = dot2(wanted, wanted);
    let mut result = wanted;
    if far {
        result = [wanted[0] * radius, wanted[1] * radius];
    } else if length2 > radius * radius {
        let length = length2.sqrt();
        result = [wanted[0] / length * radius, wanted[1] / length * radius];
    }
    for (number, &line) in lines.iter().enumerate() {
        if det2(direction(line), sub(point(line), result)) > 0.0 {
            match on_line(lines, number, radius, wanted, far) {
                Some(better) => result = better,
                None => return (number, result),
            }
        }
    }
    (lines.len(), result)
}

/// When not all lines can be satisfied: the velocity that violates them least, never one of the `hard` first.
pub fn least_bad(lines: &[Line], hard: usize, begin: usize, radius: f32, start: [f32; 2]) -> [f32; 2] {
    let mut result = start;
    let mut violation = 0.0;
    for (number, &line) in lines.iter().enumerate().skip(begin) {
        if det2(direction(line), sub(point(line), result)) <= violation {
            continue;
        }
        let mut bisectors = [[0.0; 4]; LINES];
        let mut count = 0;
        for (other_number, &other) in lines[..number].iter().enumerate() {
            if other_number < hard {
                bisectors[count] = other;
                count += 1;
                continue;
            }
            let determinant = det2(direction(line), direction(other));
            let at = if determinant.abs() <= EPSILON {
                if dot2(direction(line), direction(other)) > 0.0 {
                    continue; // same direction: the nearer one is the stricter
                }
                [(line[0] + other[0]) * 0.5, (line[1] + other[1]) * 0.5]
            } else {
                along(line, det2(direction(other), sub(point(line), point(other))) / determinant)
            };
            let dir = unit_or(sub(direction(other), direction(line)), [1.0, 0.0]);
            bisectors[count] = [at[0], at[1], dir[0], dir[1]];
            count += 1;
        }
        let (satisfied, better) = within(&bisectors[..count], radius, [-line[3], line[2]], true);
        if satisfied == count {
            result = better; // else: by rounding only; the last result is kept
        }
        violation = det2(direction(line), sub(point(line), result));
    }
    result
}

/// An obstacle segment, solid on its left: `[0]` its two ends; `[1]` unit directions of itself and of the segment
/// before; `[2]` unit direction of the segment after, and 1 or 0 for a convex first and second corner. Where the segment
/// stands at some heights only, these two are [`RAISED`] more than its lowest and highest point, m, negative for a corner
/// that is not convex.
pub type Segment = [[f32; 4]; 3];

/// Added to the heights of a segment that stands at some heights only, so that they cannot be taken for flags.
pub const RAISED: f32 = 3000.0;
/// Height of a body that has to pass under something, m.
const TALL: f32 = 1.8;

/// Whether a segment with these two (its `[2][2..]`) is in the way of somebody who stands at `elevation`.
pub fn stands_at(first: f32, second: f32, elevation: f32) -> bool {
    let low = first.abs() - RAISED;
    let high = second.abs() - RAISED;
    low < -1500.0 || (elevation + TALL > low && elevation < high)
}

/// Squared distance from `p` to a segment if `p` is on its open (right) side, else infinity.
pub fn segment_distance2(segment: &Segment, p: [f32; 2]) -> f32 {
    let a = [segment[0][0], segment[0][1]];
    let b = [segment[0][2], segment[0][3]];
    let ab = sub(b, a);
    let ap = sub(p, a);
    if det2(ab, ap) >= 0.0 {
        return f32::MAX;
    }
    let t = (dot2(ap, ab) / dot2(ab, ab)).clamp(0.0, 1.0);
    let off = [ap[0] - ab[0] * t, ap[1] - ab[1] * t];
    dot2(off, off)
}

/// Whether `lines` already keep the agent off the whole segment.
fn is_covered(lines: &[Line], rate: f32, to_a: [f32; 2], to_b: [f32; 2], radius: f32) -> bool {
    let slack = rate * radius - EPSILON;
    lines.iter().any(|&line| {
        let a = [to_a[0] * rate - line[0], to_a[1] * rate - line[1]];
        let b = [to_b[0] * rate - line[0], to_b[1] * rate - line[1]];
        det2(a, direction(line)) >= slack && det2(b, direction(line)) >= slack
    })
}

/// Tangent directions from the agent to a corner seen as a disc: `side` +1 is the left leg, -1 the right.
fn leg(to: [f32; 2], distance2: f32, radius: f32, side: f32) -> [f32; 2] {
    let length = (distance2 - radius * radius).max(0.0).sqrt();
    let (x, y) = (to[0] * length - side * to[1] * radius, side * to[0] * radius + to[1] * length);
    [x / distance2, y / distance2]
}

/// The line that an obstacle segment imposes, if any. `lines` are those of nearer segments.
pub fn obstacle_line(
    lines: &[Line],
    segment: &Segment,
    position: [f32; 2],
    velocity: [f32; 2],
    radius: f32,
    rate: f32,
) -> Option<Line> {
    let mut a = [segment[0][0], segment[0][1]];
    let mut b = [segment[0][2], segment[0][3]];
    let along_ab = [segment[1][0], segment[1][1]];
    let mut along_before = [segment[1][2], segment[1][3]];
    let mut along_after = [segment[2][0], segment[2][1]];
    let mut a_convex = segment[2][2] > 0.0;
    let mut b_convex = segment[2][3] > 0.0;
    let (to_a, to_b) = (sub(a, position), sub(b, position));
    if is_covered(lines, rate, to_a, to_b, radius) {
        return None;
    }
    let (a2, b2, radius2) = (dot2(to_a, to_a), dot2(to_b, to_b), radius * radius);
    let ab = sub(b, a);
    let s = -dot2(to_a, ab) / dot2(ab, ab);
    let off = [-to_a[0] - ab[0] * s, -to_a[1] - ab[1] * s];
    let off2 = dot2(off, off);
    if s < 0.0 && a2 <= radius2 {
        // Touching the first corner.
        let dir = unit_or([-to_a[1], to_a[0]], [1.0, 0.0]);
        return a_convex.then_some([0.0, 0.0, dir[0], dir[1]]);
    }
    if s > 1.0 && b2 <= radius2 {
        // Touching the second corner, unless the next segment takes care of it.
        let dir = unit_or([-to_b[1], to_b[0]], [1.0, 0.0]);
        return (b_convex && det2(to_b, along_after) >= 0.0).then_some([0.0, 0.0, dir[0], dir[1]]);
    }
    if (0.0..=1.0).contains(&s) && off2 <= radius2 {
        // Touching the segment.
        return Some([0.0, 0.0, -along_ab[0], -along_ab[1]]);
    }
    // Legs: tangents to the corners; where a corner is concave the segment itself goes on.
    let (mut left, mut right);
    let mut is_corner = false;
    if s < 0.0 && off2 <= radius2 {
        // Seen so obliquely that the first corner hides the rest.
        if !a_convex {
            return None;
        }
        is_corner = true;
        (b, b_convex, along_after) = (a, a_convex, along_ab);
        (left, right) = (leg(to_a, a2, radius, 1.0), leg(to_a, a2, radius, -1.0));
    } else if s > 1.0 && off2 <= radius2 {
        if !b_convex {
            return None;
        }
        is_corner = true;
        (a, a_convex, along_before) = (b, b_convex, along_ab);
        (left, right) = (leg(to_b, b2, radius, 1.0), leg(to_b, b2, radius, -1.0));
    } else {
        left = if a_convex { leg(to_a, a2, radius, 1.0) } else { [-along_ab[0], -along_ab[1]] };
        right = if b_convex { leg(to_b, b2, radius, -1.0) } else { along_ab };
    }
    // A leg never points into the neighbouring segment of a convex corner; a foreign leg adds no line.
    let before = [-along_before[0], -along_before[1]];
    let left_foreign = a_convex && det2(left, before) >= 0.0;
    if left_foreign {
        left = before;
    }
    let right_foreign = b_convex && det2(right, along_after) <= 0.0;
    if right_foreign {
        right = along_after;
    }
    let cut_a = [(a[0] - position[0]) * rate, (a[1] - position[1]) * rate];
    let cut_b = [(b[0] - position[0]) * rate, (b[1] - position[1]) * rate];
    let cut = sub(cut_b, cut_a);
    let (from_a, from_b) = (sub(velocity, cut_a), sub(velocity, cut_b));
    let t = if is_corner { 0.5 } else { dot2(from_a, cut) / dot2(cut, cut) };
    let (t_left, t_right) = (dot2(from_a, left), dot2(from_b, right));
    let around = |centre: [f32; 2], from: [f32; 2]| {
        let unit = unit_or(from, [1.0, 0.0]);
        let scale = radius * rate;
        [centre[0] + unit[0] * scale, centre[1] + unit[1] * scale, unit[1], -unit[0]]
    };
    if (t < 0.0 && t_left < 0.0) || (is_corner && t_left < 0.0 && t_right < 0.0) {
        return Some(around(cut_a, from_a));
    }
    if t > 1.0 && t_right < 0.0 {
        return Some(around(cut_b, from_b));
    }
    let off_line = |from: [f32; 2], dir: [f32; 2], t: f32| {
        let d = [from[0] - dir[0] * t, from[1] - dir[1] * t];
        dot2(d, d)
    };
    let to_cut = if !(0.0..=1.0).contains(&t) || is_corner { f32::MAX } else { off_line(from_a, cut, t) };
    let to_left = if t_left < 0.0 { f32::MAX } else { off_line(from_a, left, t_left) };
    let to_right = if t_right < 0.0 { f32::MAX } else { off_line(from_b, right, t_right) };
    let beside = |centre: [f32; 2], dir: [f32; 2]| {
        let scale = radius * rate;
        [centre[0] - dir[1] * scale, centre[1] + dir[0] * scale, dir[0], dir[1]]
    };
    if to_cut <= to_left && to_cut <= to_right {
        Some(beside(cut_a, [-along_ab[0], -along_ab[1]]))
    } else if to_left <= to_right {
        (!left_foreign).then(|| beside(cut_a, left))
    } else {
        (!right_foreign).then(|| beside(cut_b, [-right[0], -right[1]]))
    }
}
