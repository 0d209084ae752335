//! The probe of a device's arithmetic: what the kernel `arithmetic` computes, the cases it is given and the results that IEEE 754
//! demands.

/// What a lane of the results shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Primitive {
    /// `a / d`
    Division,
    /// `sqrt(a)`
    SquareRoot,
    /// `a * b + c`: two roundings, not one.
    ProductAndSum,
    /// `a * b + b * c + c * a`: in this order.
    Products,
    /// `min(a, b)`
    Minimum,
    /// `max(c, b)`
    Maximum,
    /// `clamp(a, -abs(b), abs(c))`
    Clamp,
    /// `floor(a)`
    Floor,
    /// `i32(a)` and back.
    ToInteger,
    /// `f32(u)` of any 32 bits.
    FromInteger,
    /// `u32(abs(b))` and back.
    ToUnsigned,
    /// `abs(c)`
    Absolute,
}

impl Primitive {
    /// In the order of the kernel's results.
    pub const ALL: [Self; 12] = [
        Self::Division,
        Self::SquareRoot,
        Self::ProductAndSum,
        Self::Products,
        Self::Minimum,
        Self::Maximum,
        Self::Clamp,
        Self::Floor,
        Self::ToInteger,
        Self::FromInteger,
        Self::ToUnsigned,
        Self::Absolute,
    ];

    /// In words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Division => "division",
            Self::SquareRoot => "square root",
            Self::ProductAndSum => "product and sum",
            Self::Products => "sum of products",
            Self::Minimum => "minimum",
            Self::Maximum => "maximum",
            Self::Clamp => "clamp",
            Self::Floor => "floor",
            Self::ToInteger => "conversion to integers",
            Self::FromInteger => "conversion from integers",
            Self::ToUnsigned => "conversion to unsigned integers",
            Self::Absolute => "absolute value",
        }
    }
}

/// What kind of numbers a case holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// Normal numbers, and zeros of both signs.
    Normal,
    /// A subnormal number, or a result that is one.
    Subnormal,
}

/// The numbers `(a, b, c, d)` of a case, and their kind.
pub type Case = ([f32; 4], Class);

/// What correctly rounded operations give, in the order of [`Primitive::ALL`].
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "conversions are what is probed"
)]
pub fn expected([x, y, z, w]: [f32; 4]) -> [[f32; 4]; 3] {
    let (least, most) = (if x < y { x } else { y }, if y < z { z } else { y });
    [
        [x / w, x.abs().sqrt(), x * y + z, x * y + y * z + z * x],
        [least, most, x.clamp(-y.abs(), z.abs()), x.floor()],
        [
            (x as i32).wrapping_add(1) as f32,
            x.to_bits() as f32,
            (y.abs() as u32).wrapping_add(1) as f32,
            z.abs(),
        ],
    ]
}

/// `count` cases `(a, b, c, d)`: numbers of like size, quotients next to a midpoint, zeros of both signs, numbers of all
/// sizes; at the end an eighth with subnormal numbers.
#[allow(clippy::cast_possible_truncation, reason = "bits")]
pub fn cases(count: usize) -> Vec<Case> {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    let mut float = move |least: u32, span: u32| {
        let bits = random();
        let exponent = least + ((bits >> 32) as u32) % span;
        f32::from_bits((bits as u32 & 0x807f_ffff) | exponent << 23)
    };
    let mut one = |index: usize| {
        let like = [float(124, 7), float(124, 7), float(124, 7), float(124, 7)];
        if index >= count - count / 8 {
            let [a, b] = [float(0, 1), float(126, 3)];
            let small = [float(1, 20), float(20, 40), float(20, 40)];
            let case = match index % 3 {
                0 => [a, b, float(0, 2), b],
                1 => [small[0], float(130, 20), a, a],
                _ => [small[1], small[2], a, b],
            };
            return (case, Class::Subnormal);
        }
        let zero = |bit: usize| if index >> (3 + bit) & 1 == 1 { -0.0 } else { 0.0 };
        let case = match index % 8 {
            0..4 => like,
            4 => near_midpoint(like),
            5 => [zero(0), zero(1), zero(2), like[3]],
            6 => [float(100, 54), float(100, 54), float(100, 54), float(100, 54)],
            _ => [float(127, 24), float(120, 8), float(127, 12), float(127, 2)],
        };
        (case, Class::Normal)
    };
    (0..count).map(&mut one).collect()
}

/// A dividend whose quotient lies next to the middle between two floats.
#[allow(clippy::cast_possible_truncation, reason = "bits")]
fn near_midpoint([a, b, c, d]: [f32; 4]) -> [f32; 4] {
    let mantissa = |x: f32| u64::from(x.to_bits() & 0x7f_ffff | 0x80_0000);
    let product = ((2 * mantissa(a) + 1) * mantissa(d)) >> 1;
    let shift = 64 - product.leading_zeros() - 24;
    [f32::from_bits((product >> shift) as u32 + 0x3f00_0000), b, c, d]
}
