//! Statures, weights and girths by age, from 2 years on: adults as measured by the National Center for Health Statistics from
//! August 2021 to August 2023 (Fryar et al. 2025, Vital and Health Statistics 3(50), doi 10.15620/cdc/174595), children as in the
//! CDC 2000 growth charts (Kuczmarski et al. 2002, Vital and Health Statistics 11(246)). Both are in the public domain.

use super::Measure;
use crate::avatar::Sex;

/// Least age of the tables, years.
pub(super) const YOUNGEST: f32 = 2.0;
/// From this age on adults' tables hold, years.
const GROWN: f32 = 20.0;

/// Means of an age group: stature, weight, girths of waist, hips and upper arm; 0: not measured.
#[derive(Debug, Clone, Copy)]
struct Group {
    stature: f32,
    weight: f32,
    waist: f32,
    hips: f32,
    arm: f32,
}

/// cm, kg, cm, cm, cm.
const fn group(stature: f32, weight: f32, waist: f32, hips: f32, arm: f32) -> Group {
    Group { stature, weight, waist, hips, arm }
}

/// The middle of each age group, years.
const AGES: [f32; 16] =
    [3.0, 5.0, 7.0, 9.0, 11.0, 13.0, 15.0, 17.0, 19.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0, 84.0];

/// Women, men: in the order of [`Sex`].
#[rustfmt::skip]
const GROUPS: [[Group; 16]; 2] = [
    // women
    [
        group(94.4, 14.5, 49.2, 0.0, 16.6),
        group(108.9, 19.5, 54.1, 0.0, 17.9),
        group(122.7, 26.0, 59.4, 0.0, 19.8),
        group(134.8, 34.3, 65.0, 0.0, 22.1),
        group(148.7, 46.0, 72.1, 0.0, 24.7),
        group(156.4, 55.4, 76.7, 91.9, 26.7),
        group(159.6, 61.9, 80.2, 96.9, 28.3),
        group(161.5, 64.4, 82.2, 99.1, 29.1),
        group(161.5, 69.1, 85.0, 101.8, 30.4),
        group(163.5, 74.8, 90.5, 107.0, 31.9),
        group(162.5, 80.9, 97.8, 111.6, 33.9),
        group(161.7, 80.4, 98.2, 111.1, 33.6),
        group(161.2, 81.6, 101.5, 111.5, 33.8),
        group(160.5, 77.5, 100.3, 110.1, 32.8),
        group(158.3, 73.8, 99.6, 108.6, 32.1),
        group(156.8, 67.9, 96.5, 104.7, 29.8),
    ],
    // men
    [
        group(95.2, 15.0, 49.8, 0.0, 16.6),
        group(110.2, 20.3, 54.5, 0.0, 18.1),
        group(122.6, 25.5, 57.9, 0.0, 19.3),
        group(134.6, 33.5, 63.9, 0.0, 21.5),
        group(146.8, 46.7, 73.8, 0.0, 25.1),
        group(162.0, 58.3, 78.3, 90.5, 27.1),
        group(171.1, 71.2, 83.1, 97.0, 29.7),
        group(175.0, 76.3, 85.3, 99.9, 31.4),
        group(175.1, 77.0, 87.0, 100.1, 31.4),
        group(176.3, 86.8, 95.1, 104.5, 34.3),
        group(176.1, 91.4, 101.3, 106.3, 35.4),
        group(176.4, 95.3, 104.7, 107.4, 36.0),
        group(174.3, 92.1, 106.4, 106.2, 35.2),
        group(174.7, 89.2, 105.4, 104.2, 34.0),
        group(172.4, 87.7, 107.5, 105.0, 33.4),
        group(170.5, 81.7, 104.1, 102.5, 31.7),
    ],
];

/// Stature of adults of 20 to 29 years and each decade on: mean, 10th and 90th percentile, cm. Weight: [`PERCENTILES`], kg.
type Decade = (f32, [f32; 2], [f32; 9]);

#[rustfmt::skip]
const DECADES: [[Decade; 7]; 2] = [
    // women
    [
        (163.5, [155.1, 171.9], [47.6, 52.9, 54.9, 59.4, 68.9, 82.9, 98.2, 107.3, 121.3]),
        (162.5, [152.8, 170.8], [51.4, 55.4, 58.9, 63.1, 75.0, 93.3, 107.9, 114.6, 125.9]),
        (161.7, [152.3, 170.4], [52.8, 56.0, 58.7, 63.9, 74.8, 90.6, 101.1, 111.5, 123.7]),
        (161.2, [152.6, 170.4], [53.1, 57.9, 60.2, 65.2, 78.5, 95.5, 105.0, 111.5, 121.4]),
        (160.5, [151.6, 169.4], [51.6, 55.5, 58.9, 63.3, 74.3, 89.9, 98.4, 104.5, 109.3]),
        (158.3, [150.7, 166.2], [49.8, 54.6, 56.8, 62.0, 71.7, 82.4, 91.4, 96.3, 103.5]),
        (156.8, [145.9, 165.5], [46.8, 50.6, 52.9, 57.9, 65.7, 75.2, 83.0, 87.3, 94.2]),
    ],
    // men
    [
        (176.3, [167.7, 185.9], [57.0, 60.5, 64.2, 72.2, 83.7, 98.2, 108.1, 114.7, 128.3]),
        (176.1, [166.6, 185.1], [63.6, 69.8, 71.1, 77.1, 87.1, 101.5, 110.0, 121.0, 132.5]),
        (176.4, [166.9, 186.8], [66.0, 69.7, 73.2, 78.5, 88.4, 107.7, 119.7, 125.1, 141.9]),
        (174.3, [164.7, 183.6], [61.0, 68.1, 71.2, 76.8, 87.8, 102.0, 113.6, 119.8, 138.7]),
        (174.7, [165.2, 184.1], [62.6, 67.1, 69.9, 76.0, 86.9, 99.0, 108.3, 114.0, 123.9]),
        (172.4, [162.6, 181.6], [60.8, 66.2, 68.8, 74.5, 86.6, 96.5, 106.8, 111.7, 121.3]),
        (170.5, [160.1, 179.3], [58.0, 63.3, 66.7, 70.8, 79.9, 90.0, 96.5, 99.6, 108.5]),
    ],
];

/// The 5th, 10th, 15th, 25th, 50th, 75th, 85th, 90th and 95th percentile of a normal number.
const PERCENTILES: [f32; 9] = [-1.6449, -1.2816, -1.0364, -0.6745, 0.0, 0.6745, 1.0364, 1.2816, 1.6449];

/// From the 10th to the 90th percentile of a normal number.
const TENTHS: f32 = 2.5631;

/// Box and Cox's power, median and coefficient of variation.
type Cole = [f32; 3];

/// Age in years; stature, cm; weight, kg.
type Year = (f32, Cole, Cole);

#[rustfmt::skip]
const GROWTH: [[Year; 19]; 2] = [
    // girls
    [
        (2.04, [1.0513, 85.40, 0.0409], [-0.7522, 12.13, 0.1077]),
        (3.04, [0.5420, 94.21, 0.0420], [-1.0245, 13.94, 0.1195]),
        (4.04, [0.2257, 101.03, 0.0433], [-1.1770, 15.88, 0.1318]),
        (5.04, [-0.0577, 107.96, 0.0443], [-1.2877, 18.02, 0.1412]),
        (6.04, [-0.2191, 115.01, 0.0450], [-1.3268, 20.34, 0.1496]),
        (7.04, [-0.2102, 121.76, 0.0455], [-1.2655, 22.87, 0.1597]),
        (8.04, [-0.0793, 127.83, 0.0460], [-1.1277, 25.76, 0.1721]),
        (9.04, [0.0842, 133.13, 0.0469], [-0.9707, 29.14, 0.1852]),
        (10.04, [0.2848, 138.21, 0.0487], [-0.8469, 33.06, 0.1960]),
        (11.04, [0.7443, 144.26, 0.0505], [-0.7874, 37.39, 0.2020]),
        (12.04, [1.3030, 151.49, 0.0486], [-0.8076, 41.83, 0.2023]),
        (13.04, [1.2430, 157.34, 0.0439], [-0.9155, 45.98, 0.1974]),
        (14.04, [0.9566, 160.48, 0.0410], [-1.1116, 49.49, 0.1886]),
        (15.04, [0.8956, 161.90, 0.0401], [-1.3765, 52.14, 0.1779]),
        (16.04, [0.9412, 162.57, 0.0398], [-1.6513, 53.95, 0.1681]),
        (17.04, [0.9995, 162.92, 0.0397], [-1.8381, 55.18, 0.1618]),
        (18.04, [1.0476, 163.13, 0.0397], [-1.8510, 56.23, 0.1604]),
        (19.04, [1.0833, 163.26, 0.0397], [-1.6933, 57.35, 0.1631]),
        (20.00, [1.1080, 163.34, 0.0396], [-1.5134, 58.22, 0.1666]),
    ],
    // boys
    [
        (2.04, [1.0072, 86.86, 0.0404], [-0.2165, 12.74, 0.1082]),
        (3.04, [-0.3909, 95.27, 0.0405], [-0.6213, 14.40, 0.1119]),
        (4.04, [0.8276, 102.51, 0.0413], [-0.9152, 16.32, 0.1200]),
        (5.04, [1.2664, 109.18, 0.0426], [-1.0005, 18.49, 0.1299]),
        (6.04, [1.1374, 115.66, 0.0437], [-1.0875, 20.78, 0.1391]),
        (7.04, [0.7532, 122.03, 0.0444], [-1.2365, 23.17, 0.1473]),
        (8.04, [0.4553, 128.12, 0.0451], [-1.3518, 25.75, 0.1560]),
        (9.04, [0.4157, 133.73, 0.0462], [-1.3394, 28.68, 0.1667]),
        (10.04, [0.5056, 138.82, 0.0476], [-1.2067, 32.09, 0.1789]),
        (11.04, [0.4879, 143.73, 0.0489], [-1.0193, 36.07, 0.1900]),
        (12.04, [0.4209, 149.31, 0.0500], [-0.8370, 40.67, 0.1966]),
        (13.04, [0.8162, 156.41, 0.0503], [-0.6982, 45.81, 0.1967]),
        (14.04, [1.6704, 164.14, 0.0490], [-0.6319, 51.23, 0.1908]),
        (15.04, [2.2052, 170.14, 0.0459], [-0.6656, 56.49, 0.1817]),
        (16.04, [2.1130, 173.61, 0.0431], [-0.8020, 61.10, 0.1725]),
        (17.04, [1.7247, 175.34, 0.0414], [-0.9732, 64.70, 0.1656]),
        (18.04, [1.4000, 176.19, 0.0406], [-1.0662, 67.29, 0.1619]),
        (19.04, [1.2292, 176.62, 0.0404], [-1.0233, 69.19, 0.1601]),
        (20.00, [1.1673, 176.85, 0.0404], [-0.9165, 70.60, 0.1615]),
    ],
];

/// Stature, m, and weight, kg, of an age, for two normal numbers.
pub(super) fn size_at(sex: Sex, age: f32, [tall, heavy]: [f32; 2]) -> [f32; 2] {
    if age < GROWN {
        let years = &GROWTH[sex as usize];
        let after = years.iter().position(|year| year.0 >= age).unwrap_or(years.len() - 1).max(1);
        let (a, b) = (years[after - 1], years[after]);
        let way = ((age - a.0) / (b.0 - a.0)).clamp(0.0, 1.0);
        let of = |from: Cole, to: Cole, z| cole([0, 1, 2].map(|i| from[i] + (to[i] - from[i]) * way), z);
        return [0.01 * of(a.1, b.1, tall), of(a.2, b.2, heavy)];
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 6")]
    let decade = ((age - GROWN) / 10.0).clamp(0.0, 6.0) as usize;
    let (mean, [low, high], weights) = DECADES[sex as usize][decade];
    [0.01 * (mean + (high - low) / TENTHS * tall), by_percentiles(&weights, heavy)]
}

/// Cole's transformation.
fn cole([power, median, variation]: Cole, z: f32) -> f32 {
    median * libm::powf(1.0 + power * variation * z, 1.0 / power)
}

/// Through the percentiles, straight in the logarithm, and on beyond them.
fn by_percentiles(values: &[f32; 9], z: f32) -> f32 {
    let after = PERCENTILES.iter().position(|own| *own >= z).unwrap_or(PERCENTILES.len() - 1).max(1);
    let (from, to) = (PERCENTILES[after - 1], PERCENTILES[after]);
    let [a, b] = [values[after - 1], values[after]].map(libm::logf);
    libm::expf(a + (b - a) * (z - from) / (to - from))
}

/// By how much a girth of an age is greater than what `line` says for its mean stature, m, and weight, kg, in m.
pub(super) fn factor(sex: Sex, age: f32, measure: Measure, line: impl Fn(f32, f32) -> f32) -> f32 {
    let of_group = |number: usize| {
        let own = &GROUPS[sex as usize][number];
        let girth = match measure.of_trunk() {
            Some(Measure::Waist) => own.waist,
            Some(Measure::Hips) => own.hips,
            _ if measure == Measure::Biceps => own.arm,
            _ => 0.0,
        };
        if girth > 0.0 { 0.01 * girth / line(0.01 * own.stature, own.weight) } else { 1.0 }
    };
    let after = AGES.iter().position(|own| *own >= age).unwrap_or(AGES.len() - 1).max(1);
    let way = ((age - AGES[after - 1]) / (AGES[after] - AGES[after - 1])).clamp(0.0, 1.0);
    let [from, to] = [of_group(after - 1), of_group(after)];
    from + (to - from) * way
}
