//! Sine and cosine from plain arithmetic, so that generated gaits come out equal on every machine: the system's
//! own functions differ between C libraries in the last bit.

/// Half of pi split in two, so that the reduction below loses nothing for the angles of a walk.
const HALF_PI_HIGH: f64 = 1.5707963109016418;
const HALF_PI_LOW: f64 = 1.5893254773528196e-08;

/// An angle as its sine and cosine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turn {
    pub(super) sin: f64,
    pub(super) cos: f64,
}

impl Turn {
    /// From an angle in radians, |angle| below about 1000, error below 1e-15.
    pub(super) fn new(angle: f64) -> Self {
        let quarters = (angle / std::f64::consts::FRAC_PI_2).round();
        let rest = (angle - quarters * HALF_PI_HIGH) - quarters * HALF_PI_LOW;
        let (sin, cos) = (sine(rest), cosine(rest));
        match quarters.rem_euclid(4.0) {
            q if q < 0.5 => Self { sin, cos },
            q if q < 1.5 => Self { sin: cos, cos: -sin },
            q if q < 2.5 => Self { sin: -sin, cos: -cos },
            _ => Self { sin: -cos, cos: sin },
        }
    }
}

/// Sine of an angle in radians.
pub(super) fn sin(angle: f64) -> f64 {
    Turn::new(angle).sin
}

/// Cosine of an angle in radians.
pub(super) fn cos(angle: f64) -> f64 {
    Turn::new(angle).cos
}

/// Taylor series up to x^17; the next term is below 1e-19 for |x| <= pi / 4.
fn sine(x: f64) -> f64 {
    let mut sum = 0.0;
    for n in (1..=8).rev() {
        let n = f64::from(n);
        sum = -(1.0 + sum) * x * x / (2.0 * n * (2.0 * n + 1.0));
    }
    x * (1.0 + sum)
}

/// Taylor series up to x^18.
fn cosine(x: f64) -> f64 {
    let mut sum = 0.0;
    for n in (1..=9).rev() {
        let n = f64::from(n);
        sum = -(1.0 + sum) * x * x / (2.0 * n * (2.0 * n - 1.0));
    }
    1.0 + sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_agree_with_the_system_to_the_last_digits() {
        for step in -4000..4000 {
            let angle = f64::from(step) * 0.007;
            let turn = Turn::new(angle);
            assert!((turn.sin - angle.sin()).abs() < 2e-15, "sin {angle}");
            assert!((turn.cos - angle.cos()).abs() < 2e-15, "cos {angle}");
        }
    }
}
