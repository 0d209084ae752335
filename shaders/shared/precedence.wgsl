// uses: exact, orca
// Which agent goes first where it is crowded, and how much room a body takes there. Twin: reference::precedence, which has
// the equations.

// How fast the share changes with how far the other is ahead: 5 % of the sum of the radii decide.
const PRECEDENCE_STEEPNESS: f32 = 10.0;
// A priority that is higher by 1 counts like so much further ahead, m.
const PLACE: f32 = 2.0;
// How much broader than deep a body is: (0.46 - 0.28) / (0.46 + 0.28).
const SHOULDERS: f32 = 0.24324324;
// The sum of the radii shrinks to no less than this share of it.
const NEAREST: f32 = 0.9;
// An agent that goes first keeps this share of the sum of the radii from the other.
const SQUEEZE: f32 = 0.8;
// Priorities that are farther apart decide alone: those of robots, of vehicles, of a right of way that was given.
const PEERS: f32 = 1.0;
// The cosine above which two want to go the same way.
const SAME_WAY: f32 = 0.95;
// Shares above this are all of the avoidance.
const ALL_OF_IT: f32 = 0.99;
// A velocity that has less than this of the wanted one gets nowhere.
const GAIN: f32 = 0.5;

// What a pair is to one of it.
struct Precedence {
    share: f32,    // the part of the avoidance that it takes, 0 to 1
    radius: f32,   // the sum of the radii, m
    follows: bool, // whether it follows the other the same way
}

// Of two agents, `to` the other, m, with the directions in which they want to go (unit; 0: it stands); radius is the sum of the
// radii as discs, m; equal the share of both without precedence; lead how much further ahead the other counts than it is, m. Where
// one stands, and where discs overlap, shares are equal.
fn precedence(to: vec2<f32>, own: vec2<f32>, theirs: vec2<f32>, radius: f32, equal: f32, lead: f32) -> Precedence {
    let both = own + theirs;
    let agreement = 0.5 * sqrt(dot2(both, both));
    let ahead = dot2(to, unit_or(both, vec2<f32>(0.0, 0.0)));
    let distance2 = dot2(to, to);
    let is_standing = dot2(own, own) < 0.5 || dot2(theirs, theirs) < 0.5;
    if is_standing || distance2 < radius * radius {
        return Precedence(equal, radius, false);
    }
    let share = clamp(equal + PRECEDENCE_STEEPNESS * agreement * ((ahead + lead) / radius), 0.0, 1.0);
    let breadth = max(1.0 + SHOULDERS * agreement * (1.0 - 2.0 * (ahead * ahead / distance2)), NEAREST);
    return Precedence(share, radius * breadth, share > ALL_OF_IT && dot2(own, theirs) > SAME_WAY);
}

// The line of an agent that follows, without its demand to walk backwards because the one ahead is near.
fn standing(line: vec4<f32>) -> vec4<f32> {
    let need = line.x * -line.w + line.y * line.z;
    if need > 0.0 {
        return vec4<f32>(line.x - -line.w * need, line.y - line.z * need, line.z, line.w);
    }
    return line;
}

// Whether a velocity leads nowhere although `wanted` is wanted, m/s.
fn gets_nowhere(velocity: vec2<f32>, wanted: vec2<f32>) -> bool {
    return dot2(velocity, wanted) < GAIN * dot2(wanted, wanted);
}
