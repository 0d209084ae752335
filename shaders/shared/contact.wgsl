// Times until bodies touch, as rates (1 / time, 1/s), since a rate needs no infinity; twin: reference::contact. Needs exact.
const NEARLY_TOUCHING: f32 = 1e-9;
// Corners of walls count as discs of this share of the own radius, so that the joints of a wall do not stop a sliding agent.
const CORNER: f32 = 0.98;

// Returns the inverse of the time until a point of velocity `velocity` enters the disc of `radius` m around `to`; 0: never.
// The result is at most `most`, and `most` for a point inside that goes farther in.
fn disc_rate(to: vec2<f32>, velocity: vec2<f32>, radius: f32, most: f32) -> f32 {
    let b = dot2(to, velocity);
    let c = dot2(to, to) - radius * radius;
    let discriminant = b * b - dot2(velocity, velocity) * c;
    if !(b > 0.0) || discriminant < 0.0 {
        return 0.0;
    }
    return min((b + sqrt(discriminant)) / max(c, NEARLY_TOUCHING), most);
}

// The same for four velocities.
fn disc_rates(to: vec2<f32>, x: vec4<f32>, y: vec4<f32>, radius: f32, most: f32) -> vec4<f32> {
    let b = to.x * x + to.y * y;
    let c = dot2(to, to) - radius * radius;
    let discriminant = b * b - (x * x + y * y) * c;
    let meets = (b > vec4<f32>(0.0)) & !(discriminant < vec4<f32>(0.0));
    let root = sqrt(select(vec4<f32>(0.0), discriminant, meets));
    return select(vec4<f32>(0.0), min((b + root) / max(c, NEARLY_TOUCHING), vec4<f32>(most)), meets);
}

// Until a disc of `radius` m on the open side of a wall touches it; `to_a` and `to_b` lead to the wall's ends, `along`
// is its unit direction.
fn segment_rate(to_a: vec2<f32>, to_b: vec2<f32>, along: vec2<f32>, velocity: vec2<f32>, radius: f32, most: f32) -> f32 {
    let gap = max(det2(along, to_a) - radius, NEARLY_TOUCHING);
    let inward = det2(along, velocity);
    var rate = 0.0;
    if inward > 0.0 {
        let s = dot2(along, velocity) * (gap / inward) - dot2(along, to_a);
        if s >= 0.0 && s <= dot2(along, to_b - to_a) {
            rate = min(inward / gap, most);
        }
    }
    rate = max(rate, disc_rate(to_a, velocity, radius * CORNER, most));
    return max(rate, disc_rate(to_b, velocity, radius * CORNER, most));
}

// The same for four velocities.
fn segment_rates(to_a: vec2<f32>, to_b: vec2<f32>, along: vec2<f32>, x: vec4<f32>, y: vec4<f32>, radius: f32, most: f32) -> vec4<f32> {
    let gap = max(det2(along, to_a) - radius, NEARLY_TOUCHING);
    let inward = along.x * y - along.y * x;
    let comes = inward > vec4<f32>(0.0);
    let s = (along.x * x + along.y * y) * (gap / select(vec4<f32>(1.0), inward, comes)) - dot2(along, to_a);
    let meets = comes & (s >= vec4<f32>(0.0)) & (s <= vec4<f32>(dot2(along, to_b - to_a)));
    var rates = select(vec4<f32>(0.0), min(inward / gap, vec4<f32>(most)), meets);
    rates = max(rates, disc_rates(to_a, x, y, radius * CORNER, most));
    return max(rates, disc_rates(to_b, x, y, radius * CORNER, most));
}
