// Functions that give the same bits on the CPU and on every device with exact arithmetic: built from + - * / sqrt,
// comparisons and integer operations only. Twin: reference::exact. Errors against f64: sine and cosine 9e-8
// (|x| < 100), atan2 2.7e-7, acos 2.9e-7, exp2 1e-7 relative.

// (sin x, cos x)
fn exact_sin_cos(x: f32) -> vec2<f32> {
    let k = floor(x * 0.63661975 + 0.5);
    let r = ((x - k * 1.5703125) - k * 4.837513e-4) - k * 7.54979e-8;
    let quadrant = i32(k) & 3;
    let z = r * r;
    let s = r + r * z * (-0.16666655 + z * (0.008332161 + z * -0.00019515296));
    let c = (1.0 - 0.5 * z) + z * z * (0.041666646 + z * (-0.0013887316 + z * 2.4433157e-5));
    let even = (quadrant & 1) == 0;
    let sine = select(c, s, even);
    let cosine = select(s, c, even);
    return vec2<f32>(
        select(-sine, sine, (quadrant & 2) == 0),
        select(-cosine, cosine, ((quadrant + 1) & 2) == 0),
    );
}

// Angle of (x, y) in (-pi, pi]; 0 at the origin.
fn exact_atan2(y: f32, x: f32) -> f32 {
    let ax = abs(x);
    let ay = abs(y);
    let high = max(ax, ay);
    let low = min(ax, ay);
    if high == 0.0 {
        return 0.0;
    }
    let a = low / high;
    let z = a * a;
    let p = 1.0 + z * (-0.33333036 + z * (0.19991872 + z * (-0.14197798 + z * (0.10618371 + z * (-0.07456855 + z * (0.042137623 + z * (-0.015731249 + z * 0.0027662835)))))));
    var angle = a * p;
    if ay > ax {
        angle = 1.5707964 - angle;
    }
    if x < 0.0 {
        angle = 3.1415927 - angle;
    }
    return select(angle, -angle, y < 0.0);
}

fn exact_acos(x: f32) -> f32 {
    let c = clamp(x, -1.0, 1.0);
    return exact_atan2(sqrt((1.0 - c) * (1.0 + c)), c);
}

fn exact_asin(x: f32) -> f32 {
    let s = clamp(x, -1.0, 1.0);
    return exact_atan2(s, sqrt((1.0 - s) * (1.0 + s)));
}

fn exact_exp2(x: f32) -> f32 {
    let c = clamp(x, -126.0, 127.0);
    let k = floor(c + 0.5);
    let f = c - k;
    let p = 1.0 + f * (0.6931472 + f * (0.2402265 + f * (0.05550327 + f * (0.009618057 + f * (0.0013400428 + f * 0.00015461445)))));
    return p * bitcast<f32>(u32(i32(k) + 127) << 23u);
}

// Angle brought to (-pi, pi].
fn exact_wrap(angle: f32) -> f32 {
    return angle - 6.2831855 * floor(angle * 0.15915494 + 0.5);
}

fn dot2(a: vec2<f32>, b: vec2<f32>) -> f32 {
    return a.x * b.x + a.y * b.y;
}

// Twice the signed area of the triangle (0, a, b).
fn det2(a: vec2<f32>, b: vec2<f32>) -> f32 {
    return a.x * b.y - a.y * b.x;
}

// A well-mixed u32 from a u32 (the finaliser of the crossing workload).
fn hash_u32(value: u32) -> u32 {
    var x = value;
    x = x ^ (x >> 16u);
    x = x * 0x7feb352du;
    x = x ^ (x >> 15u);
    x = x * 0x846ca68bu;
    return x ^ (x >> 16u);
}

// Uniform in [0, 1) with 24 bits.
fn unit_f32(bits: u32) -> f32 {
    return f32(bits >> 8u) * 5.9604645e-8;
}

fn is_finite2(v: vec2<f32>) -> bool {
    return abs(v.x) < 1e30 && abs(v.y) < 1e30;
}

// What fades to nothing ends at this size. Below some 1e-38 one device keeps a number and another takes it for zero, so that
// two crowds that stand still would come apart.
const FAINT: f32 = 1e-12;

fn unless_faint(x: f32) -> f32 {
    return select(x, 0.0, abs(x) < FAINT);
}

fn unless_faint2(v: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(unless_faint(v.x), unless_faint(v.y));
}
