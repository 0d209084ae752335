// Times until bodies touch, as rates (1 / time, 1/s), since a rate needs no infinity; twin: reference::contact. Needs exact.
const NEARLY_TOUCHING = 1e-9;
// Corners of walls count as discs of this share of the own radius: who slides along a wall is not stopped by its joints.
const CORNER = 0.98;

// Until a point of velocity `velocity` enters the disc of `radius` m around `to`; 0: never. At most `most`; that much for
// who is inside and goes farther in.
fn disc_rate(to: vec2<f32>, velocity: vec2<f32>, radius: f32, most: f32) -> f32 {
    let b = dot2(to, velocity);
    let c = dot2(to, to) - radius * radius;
    let discriminant = b * b - dot2(velocity, velocity) * c;
    if !(b > 0.0) || discriminant < 0.0 {
        return 0.0;
    }
    return min((b + sqrt(discriminant)) / max(c, NEARLY_TOUCHING), most);
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
