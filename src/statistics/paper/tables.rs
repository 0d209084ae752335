//! The tables that the paper prints.
//!
//! Randhavane, Bera, Kapsaskis, Sheth, Gray, Manocha 2019, "EVA: Generating Emotional Behavior of Virtual Agents using
//! Expressive Features of Gait and Gaze", SAP 2019 (arXiv 1907.02102): the tables of the Friedman test, the Wilcoxon
//! signed-rank test and the confusion matrix.

/// Number of participants of the study with the headset.
pub const PEOPLE: usize = 30;

/// Number of conditions.
pub const CONDITIONS: usize = 3;

/// The questions: rows of the tables.
pub const QUESTIONS: [&str; 5] = ["Q1", "Q2", "Q3", "Q4", "Q5"];

/// The scenarios: columns of the tables.
pub const SCENARIOS: [&str; 4] = ["Crossing", "Garden", "Parking", "Scifi"];

/// The pairs of conditions in each cell of [`WILCOXON_P`].
pub const PAIRS: [&str; 3] = ["Baseline and EVA-O", "EVA-O and EVA-G", "Baseline and EVA-G"];

/// The emotions: rows and columns of [`CONFUSION`].
pub const EMOTIONS: [&str; 4] = ["happy", "angry", "sad", "neutral"];

/// Level of the Friedman tests.
pub const FRIEDMAN_LEVEL: f64 = 0.05;

/// Level of the Wilcoxon tests, after Bonferroni.
pub const WILCOXON_LEVEL: f64 = 0.017;

/// Chi-square of the Friedman tests, `[question][scenario]`.
pub const CHI_SQUARE: [[f64; 4]; 5] = [
    [9.75, 4.67, 15.13, 2.46],
    [19.58, 26.45, 30.28, 27.30],
    [20.26, 27.27, 20.17, 24.90],
    [13.77, 12.30, 24.45, 10.53],
    [23.36, 41.32, 35.04, 43.38],
];

/// p of the Friedman tests as the paper's text prints them, to two decimals.
pub const FRIEDMAN_P: [[f64; 4]; 5] = [
    [0.01, 0.10, 0.00, 0.29],
    [0.00, 0.00, 0.00, 0.00],
    [0.00, 0.00, 0.00, 0.00],
    [0.00, 0.00, 0.00, 0.01],
    [0.00, 0.00, 0.00, 0.00],
];

/// p of the Wilcoxon tests to three decimals, `[question][scenario][pair]`; `None` where the Friedman test found nothing.
pub const WILCOXON_P: [[Option<[f64; 3]>; 4]; 5] = [
    [Some([0.018, 0.323, 0.005]), None, Some([0.179, 0.019, 0.003]), None],
    [
        Some([0.037, 0.002, 0.000]),
        Some([0.095, 0.000, 0.000]),
        Some([0.540, 0.000, 0.000]),
        Some([0.179, 0.000, 0.000]),
    ],
    [
        Some([0.012, 0.005, 0.000]),
        Some([0.007, 0.000, 0.000]),
        Some([0.256, 0.001, 0.000]),
        Some([0.153, 0.000, 0.000]),
    ],
    [
        Some([0.038, 0.276, 0.001]),
        Some([0.026, 0.160, 0.012]),
        Some([0.005, 0.035, 0.000]),
        Some([0.054, 0.041, 0.010]),
    ],
    [
        Some([0.000, 0.011, 0.000]),
        Some([0.000, 0.070, 0.000]),
        Some([0.001, 0.000, 0.000]),
        Some([0.000, 0.000, 0.000]),
    ],
];

/// The confusion matrix in percent of each row, `[desired][answered]`.
pub const CONFUSION_PERCENT: [[f64; 4]; 4] = [
    [60.41, 4.17, 4.17, 31.25],
    [18.75, 52.08, 0.00, 29.17],
    [0.00, 0.00, 100.00, 0.00],
    [8.33, 4.17, 16.67, 70.83],
];

/// The counts behind [`CONFUSION_PERCENT`], of 48 answers a row; the paper does not print them.
pub const CONFUSION: [[u64; 4]; 4] = [[29, 2, 2, 15], [9, 25, 0, 14], [0, 0, 48, 0], [4, 2, 8, 34]];

/// Number of gaits that the paper's raters judged.
pub const GAITS: u32 = 342;

/// Shares of the labels of the paper's gaits, percent, in the order of [`EMOTIONS`]; its text prints the greatest and the least.
pub const LABEL_SHARES: [Option<f64>; 4] = [Some(32.07), None, None, Some(16.35)];

/// What cannot be computed from what the paper prints.
pub const NOT_RECOVERABLE: [&str; 3] = [
    "mean answers of each condition: they are a figure only",
    "Z of the Wilcoxon tests, and with it their effect sizes",
    "the number of responses to each video",
];
