//! Measures of adults by stature and weight: ANSUR II (US Army Anthropometric Survey 2012, public release 2017; 4,082 men and
//! 1,986 women of 17 to 58 years; public domain). Gordon et al. 2014, NATICK/TR-15/007.
//!
//! What ships are figures alone: a regression of each measure and the correlations of what it leaves. They were computed from the
//! published rows of both sexes.

use super::MEASURES;

/// A measure by stature and weight: ln(mm) = intercept + stature ln(m) + weight ln(kg), and the deviation of what that leaves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub(super) intercept: f32,
    pub(super) stature: f32,
    pub(super) weight: f32,
    pub(super) residual: f32,
}

const fn line(intercept: f32, stature: f32, weight: f32, residual: f32) -> Line {
    Line { intercept, stature, weight, residual }
}

/// What a sex has of statures and weights.
#[derive(Debug, Clone, Copy)]
pub(super) struct Whole {
    /// Mean and deviation, m.
    pub(super) stature: [f32; 2],
    /// Mean and deviation of ln(kg).
    pub(super) log_weight: [f32; 2],
    /// Correlation of the two.
    pub(super) correlation: f32,
    /// Mean and deviation, kg/m².
    pub(super) body_mass_index: [f32; 2],
}

/// Women, men: in the order of `Sex`.
pub(super) const WHOLE: [Whole; 2] = [
    Whole {
        stature: [1.6285, 0.0642],
        log_weight: [4.2030, 0.1605],
        correlation: 0.539,
        body_mass_index: [25.50, 3.49],
    },
    Whole {
        stature: [1.7562, 0.0686],
        log_weight: [4.4351, 0.1654],
        correlation: 0.471,
        body_mass_index: [27.69, 4.04],
    },
];

/// Women, men; in the order of [`super::Measure`].
#[rustfmt::skip]
pub(super) const LINES: [[Line; MEASURES]; 2] = [
    // women
    [
        line(6.1543, 1.2944, -0.0295, 0.0299),
        line(5.0633, 1.0208, 0.0425, 0.0332),
        line(4.5501, 0.7634, 0.0656, 0.0412),
        line(5.9961, 0.1374, 0.0634, 0.0314),
        line(5.3271, 0.5636, 0.0709, 0.0405),
        line(4.6284, -0.2322, 0.3049, 0.0364),
        line(4.9278, -0.5704, 0.5233, 0.0444),
        line(4.3039, -0.0904, 0.3173, 0.0481),
        line(3.1575, -0.7732, 0.6481, 0.0617),
        line(4.1675, -0.8967, 0.7186, 0.0551),
        line(3.3291, -0.6246, 0.6358, 0.0600),
        line(2.2999, -1.3532, 0.8827, 0.0758),
        line(5.1294, -0.2955, 0.4617, 0.0280),
        line(4.2220, -0.1565, 0.4093, 0.0415),
        line(3.0977, -0.7744, 0.6483, 0.0480),
        line(3.4277, -0.7500, 0.6316, 0.0448),
        line(4.0607, -0.2062, 0.3839, 0.0393),
        line(4.2604, -0.5351, 0.5757, 0.0360),
        line(4.3074, -0.2390, 0.4112, 0.0449),
    ],
    // men
    [
        line(6.1919, 1.2870, -0.0399, 0.0275),
        line(5.1531, 1.0272, 0.0186, 0.0315),
        line(4.6220, 0.8017, 0.0428, 0.0374),
        line(5.9661, 0.0967, 0.0750, 0.0238),
        line(5.2747, 0.3881, 0.1208, 0.0349),
        line(4.6388, -0.3768, 0.3510, 0.0366),
        line(4.9830, -0.4917, 0.5084, 0.0297),
        line(4.4610, 0.0172, 0.2695, 0.0444),
        line(3.1814, -0.6412, 0.6112, 0.0483),
        line(4.0751, -0.8234, 0.7277, 0.0467),
        line(3.3410, -0.5634, 0.6220, 0.0489),
        line(2.3067, -1.1224, 0.8535, 0.0681),
        line(5.0592, -0.2476, 0.4519, 0.0250),
        line(4.2644, -0.0316, 0.3600, 0.0367),
        line(3.0099, -0.7182, 0.6523, 0.0450),
        line(3.7953, -0.6257, 0.5485, 0.0514),
        line(4.2071, -0.1877, 0.3681, 0.0409),
        line(4.1937, -0.5382, 0.5733, 0.0349),
        line(4.3028, -0.3149, 0.4156, 0.0404),
    ],
];

/// Correlations of what the regressions leave, in hundredths: women, men; below the diagonal, row by row.
#[rustfmt::skip]
pub(super) const RESIDUALS: [[i8; MEASURES * (MEASURES - 1) / 2]; 2] = [
    // women
    [
        44,
        38, 22,
        18, 2, 25,
        1, 1, 22, 15,
        -5, 0, 6, 17, 13,
        -17, 1, -16, -15, -2, 21,
        -22, -6, -14, -7, 21, 19, 50,
        -11, 2, -13, -14, -11, 13, 81, 22,
        -7, 1, -19, -16, -8, 10, 38, 21, 30,
        -21, -3, -26, -24, -10, 4, 37, 27, 27, 85,
        12, 10, 1, -2, -8, 12, 22, 2, 22, 74, 47,
        -11, -5, -15, -13, -12, -29, -21, -19, -20, 4, 14, -9,
        -22, -5, -20, -21, -12, -28, -8, -2, -10, 10, 30, -10, 83,
        15, 4, 2, 4, -11, -6, -13, -23, -8, 12, -1, 23, 37, 4,
        9, -3, 2, -2, -5, 6, -7, -8, -8, -10, -10, -9, -13, -15, -5,
        8, -3, 14, 6, 9, 22, -13, -8, -14, -20, -23, -14, -21, -24, -8, 50,
        7, -6, 0, 2, -7, -34, -42, -33, -37, -18, -13, -18, 63, 41, 34, 3, -6,
        -7, -11, -2, 0, -2, -23, -41, -15, -34, -44, -35, -42, -1, 2, -13, 4, 17, 15,
    ],
    // men
    [
        37,
        27, 19,
        -6, -5, 7,
        3, 6, 14, 8,
        -3, 2, 8, 16, 15,
        -1, 9, -5, -5, 15, 16,
        -13, -1, -8, 2, 30, 14, 41,
        7, 12, 0, -8, -15, 6, 60, -10,
        -15, 2, -17, -14, -23, -3, 22, 10, 21,
        -21, -4, -23, -12, -16, -12, 22, 20, 16, 79,
        -5, 5, -8, -14, -22, 5, 12, -1, 20, 80, 41,
        -10, -9, -15, -7, -10, -27, -25, -6, -20, 16, 28, -1,
        -17, -5, -13, -11, -5, -23, -9, 7, -11, 27, 44, 3, 76,
        -7, -10, -8, -4, -15, -9, -14, -10, -3, 26, 17, 30, 40, 10,
        14, -7, 12, 0, 11, 9, 3, -8, 3, -44, -36, -39, -20, -22, -23,
        9, -1, 23, 5, 14, 25, -1, -3, -3, -43, -43, -32, -26, -27, -24, 65,
        6, -10, -7, -3, -10, -32, -39, -22, -28, -14, 0, -25, 60, 32, 30, 7, -8,
        -4, -10, 2, 3, 1, -16, -28, -6, -20, -30, -18, -29, 2, 1, -10, 2, 11, 13,
    ],
];
