// uses: exact
// Vectors and quaternions (x, y, z, w), every sum written out from left to right. Twin: reference::quaternion.
// A quaternion `b_from_a` turns vectors of frame a into frame b; products read right to left. Nothing is added to or
// multiplied with a constant zero: devices may drop that, which changes the sign of a zero.

// x kept in [low, high]; unlike clamp the same on every device, signed zeros included.
fn limit(x: f32, low: f32, high: f32) -> f32 {
    return select(select(x, low, x < low), high, x > high);
}

fn dot3(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

fn cross3(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

fn dot4(a: vec4<f32>, b: vec4<f32>) -> f32 {
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}

fn quat_conjugate(q: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(-q.x, -q.y, -q.z, q.w);
}

fn quat_mul(a: vec4<f32>, b: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(
        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
        a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
    );
}

// q / |q|; no rotation when q is (nearly) zero.
fn quat_normalize(q: vec4<f32>) -> vec4<f32> {
    let square = dot4(q, q);
    if square > 1e-12 {
        // one division: they are dear where they are careful
        return q * (1.0 / sqrt(square));
    }
    return vec4<f32>(0.0, 0.0, 0.0, 1.0);
}

// v turned by the unit quaternion q.
fn quat_rotate(q: vec4<f32>, v: vec3<f32>) -> vec3<f32> {
    let axis = q.xyz;
    let t = cross3(axis, v);
    let twice = t + t;
    return v + twice * q.w + cross3(axis, twice);
}

// From a to b along the shorter way, not normalised.
fn quat_lerp(a: vec4<f32>, b: vec4<f32>, t: f32) -> vec4<f32> {
    let near = select(b, -b, dot4(a, b) < 0.0);
    return a + (near - a) * t;
}

// First turned by `pitch` about x (chin down), then by `yaw` about y (to the left), radians.
fn quat_yaw_pitch(yaw: f32, pitch: f32) -> vec4<f32> {
    let y = exact_sin_cos(yaw * 0.5);
    let x = exact_sin_cos(pitch * 0.5);
    return vec4<f32>(y.y * x.x, y.x * x.y, -(y.x * x.x), y.y * x.y);
}

// A vector turned to the left about y by the angle of (sine, cosine).
fn turn_left(turn: vec2<f32>, v: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(turn.y * v.x + turn.x * v.z, v.y, turn.y * v.z - turn.x * v.x);
}

// q, then turned to the left about y by `yaw` radians.
fn quat_before_yaw(yaw: f32, q: vec4<f32>) -> vec4<f32> {
    let t = exact_sin_cos(yaw * 0.5);
    return vec4<f32>(t.y * q.x + t.x * q.z, t.y * q.y + t.x * q.w, t.y * q.z - t.x * q.x, t.y * q.w - t.x * q.y);
}

// Turned to the left about y by `yaw` radians, then q.
fn quat_after_yaw(q: vec4<f32>, yaw: f32) -> vec4<f32> {
    let t = exact_sin_cos(yaw * 0.5);
    return vec4<f32>(q.x * t.y - q.z * t.x, q.y * t.y + q.w * t.x, q.z * t.y + q.x * t.x, q.w * t.y - q.y * t.x);
}

// The rotation of a matrix given by rows, which may carry one scale for all axes.
fn quat_from_rows(row_x: vec3<f32>, row_y: vec3<f32>, row_z: vec3<f32>) -> vec4<f32> {
    let square = dot3(row_x, row_x);
    if !(square > 1e-12) {
        return vec4<f32>(0.0, 0.0, 0.0, 1.0);
    }
    let scale = sqrt(square);
    let x = row_x / scale;
    let y = row_y / scale;
    let z = row_z / scale;
    // the largest of the four components decides the way, so that nothing small is divided by
    if x.x + y.y + z.z > 0.0 {
        return quat_normalize(vec4<f32>(z.y - y.z, x.z - z.x, y.x - x.y, 1.0 + x.x + y.y + z.z));
    }
    if x.x > y.y && x.x > z.z {
        return quat_normalize(vec4<f32>(1.0 + x.x - y.y - z.z, x.y + y.x, x.z + z.x, z.y - y.z));
    }
    if y.y > z.z {
        return quat_normalize(vec4<f32>(x.y + y.x, 1.0 - x.x + y.y - z.z, y.z + z.y, x.z - z.x));
    }
    return quat_normalize(vec4<f32>(x.z + z.x, y.z + z.y, 1.0 - x.x - y.y + z.z, y.x - x.y));
}

// First to the right by `roll` about z (positive: the left side rises), then forwards by `pitch` about x.
fn quat_pitch_roll(pitch: f32, roll: f32) -> vec4<f32> {
    let x = exact_sin_cos(pitch * 0.5);
    let z = exact_sin_cos(roll * 0.5);
    return vec4<f32>(x.x * z.y, -(x.x * z.x), x.y * z.x, x.y * z.y);
}
