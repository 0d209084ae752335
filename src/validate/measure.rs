//! Measures of a crowd's motion: density, flow, lanes, distributions.

use super::tracks::Tracks;
use glam::Vec2;
use std::ops::Range;

/// A rectangle along the axes, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// Least x and z.
    pub low: Vec2,
    /// Greatest x and z.
    pub high: Vec2,
}

impl Area {
    /// The rectangle between two corners.
    pub const fn new(low: [f32; 2], high: [f32; 2]) -> Self {
        Self { low: Vec2::from_array(low), high: Vec2::from_array(high) }
    }

    /// Whether a point is in it.
    pub fn contains(&self, p: Vec2) -> bool {
        p.cmpge(self.low).all() && p.cmplt(self.high).all()
    }

    /// m².
    pub fn size(&self) -> f64 {
        let extent = (self.high - self.low).as_dvec2();
        extent.x * extent.y
    }

    fn corners(&self) -> Vec<Vec2> {
        vec![self.low, Vec2::new(self.high.x, self.low.y), self.high, Vec2::new(self.low.x, self.high.y)]
    }
}

/// The classic density of people/m²: how many are in the area, over its size.
#[allow(clippy::cast_precision_loss, reason = "thousands of people")]
pub fn classic_density(people: impl IntoIterator<Item = Vec2>, area: Area) -> f64 {
    people.into_iter().filter(|p| area.contains(*p)).count() as f64 / area.size()
}

/// Voronoi density of people/m² and speed, m/s, in an area (Steffen and Seyfried 2010): each person's
/// Voronoi cell within the rectangle `walkable` carries one over its size as density, and the person's speed. Both are
/// averaged over the area. `None` where no cell reaches the area.
pub fn voronoi(people: &[(Vec2, f64)], walkable: Area, area: Area) -> Option<(f64, f64)> {
    let (mut density, mut speed, mut covered) = (0.0, 0.0, 0.0);
    let mut others: Vec<(f32, Vec2)> = Vec::with_capacity(people.len());
    for (index, &(at, v)) in people.iter().enumerate() {
        others.clear();
        others.extend(
            people.iter().enumerate().filter(|(i, _)| *i != index).map(|(_, p)| (p.0.distance(at), p.0)),
        );
        others.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut cell = walkable.corners();
        for &(distance, other) in &others {
            let reach = cell.iter().map(|corner| corner.distance(at)).fold(0.0, f32::max);
            if distance > 2.0 * reach {
                break;
            }
            if distance > 1e-4 {
                let (middle, normal) = ((at + other) * 0.5, at - other);
                clip(&mut cell, |p| (p - middle).dot(normal));
            }
        }
        let whole = polygon_area(&cell);
        clip(&mut cell, |p| p.x - area.low.x);
        clip(&mut cell, |p| area.high.x - p.x);
        clip(&mut cell, |p| p.y - area.low.y);
        clip(&mut cell, |p| area.high.y - p.y);
        let part = polygon_area(&cell);
        if whole > 1e-9 && part > 0.0 {
            density += part / whole;
            speed += v * part;
            covered += part;
        }
    }
    (covered > 0.0).then(|| (density / area.size(), speed / covered))
}

/// Keeps what lies where `inside` is not negative of a convex polygon (Sutherland and Hodgman 1974).
fn clip(polygon: &mut Vec<Vec2>, inside: impl Fn(Vec2) -> f32) {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (da, db) = (inside(a), inside(b));
        if da >= 0.0 {
            kept.push(a);
        }
        if (da >= 0.0) != (db >= 0.0) {
            kept.push(a + (b - a) * (da / (da - db)));
        }
    }
    *polygon = kept;
}

fn polygon_area(corners: &[Vec2]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let twice: f64 = corners.iter().zip(next).map(|(a, b)| f64::from(a.perp_dot(*b))).sum();
    0.5 * twice.abs()
}

/// When people first pass the line from `a` to `b` from its left side (looking from `a` to `b` with x to the right and z up)
/// to its right, s, in rising order.
pub fn crossings(tracks: &Tracks, a: Vec2, b: Vec2) -> Vec<f64> {
    crossings_of(tracks, 0..u32::MAX, a, b)
}

/// The same of some of the people.
#[allow(clippy::cast_precision_loss, reason = "thousands of frames")]
pub fn crossings_of(tracks: &Tracks, who_of: Range<u32>, a: Vec2, b: Vec2) -> Vec<f64> {
    let along = (b - a).normalize_or(Vec2::X);
    let (length, side) = (a.distance(b), |p: Vec2| along.perp_dot(p - a));
    let mut seen = std::collections::BTreeMap::new();
    for frame in 1..tracks.frames.len() {
        for &(who, now) in &tracks.frames[frame] {
            let Some(before) = tracks.at(frame - 1, who).filter(|_| who_of.contains(&who)) else { continue };
            let (from, to) = (side(before), side(now));
            if from > 0.0 && to <= 0.0 && !seen.contains_key(&who) {
                let t = from / (from - to);
                let along = along.dot(before + (now - before) * t - a);
                if (0.0..=length).contains(&along) {
                    seen.insert(who, ((frame - 1) as f64 + f64::from(t)) / tracks.rate);
                }
            }
        }
    }
    let mut times: Vec<f64> = seen.into_values().collect();
    times.sort_by(f64::total_cmp);
    times
}

/// People a second between the first and the last of rising `times`; 0 for fewer than two.
#[allow(clippy::cast_precision_loss, reason = "thousands of people")]
pub fn flow(times: &[f64]) -> f64 {
    match times {
        [first, .., last] if last > first => (times.len() - 1) as f64 / (last - first),
        _ => 0.0,
    }
}

/// How far two opposite streams have parted into lanes, 0 to 1 (after Rex and Löwen 2007): the mean over people of
/// ((same - other) / (same + other))². `same` and `other` count the people at most `half` m to either side, by direction.
/// `people`: place across the corridor, m, and direction (+1 or -1).
pub fn lane_order(people: &[(f64, f64)], half: f64) -> f64 {
    let mut sum = 0.0;
    for &(across, way) in people {
        let beside = people.iter().filter(|other| (other.0 - across).abs() <= half);
        let (count, same) = beside.fold((0.0, 0.0), |(n, s), other| (n + 1.0, s + other.1 * way));
        let share: f64 = same / count;
        sum += share * share;
    }
    #[allow(clippy::cast_precision_loss, reason = "thousands of people")]
    let count = people.len().max(1) as f64;
    sum / count
}

/// The Kolmogorov-Smirnov distance of two samples: the largest difference of their cumulative shares; 1 if one is empty.
#[allow(clippy::cast_precision_loss, reason = "samples of at most millions")]
pub fn kolmogorov_smirnov(a: &[f64], b: &[f64]) -> f64 {
    if a.is_empty() || b.is_empty() {
        return 1.0;
    }
    let sorted = |sample: &[f64]| {
        let mut sample = sample.to_vec();
        sample.sort_by(f64::total_cmp);
        sample
    };
    let (a, b) = (sorted(a), sorted(b));
    let (mut i, mut j, mut most) = (0, 0, 0.0_f64);
    while i < a.len() && j < b.len() {
        let value = a[i].min(b[j]);
        while i < a.len() && a[i] <= value {
            i += 1;
        }
        while j < b.len() && b[j] <= value {
            j += 1;
        }
        most = most.max((i as f64 / a.len() as f64 - j as f64 / b.len() as f64).abs());
    }
    most
}

/// Mean; 0 of nothing.
#[allow(clippy::cast_precision_loss, reason = "samples of at most millions")]
pub fn mean(sample: &[f64]) -> f64 {
    sample.iter().sum::<f64>() / sample.len().max(1) as f64
}

/// Standard deviation of a sample, by n - 1; 0 of less than two.
#[allow(clippy::cast_precision_loss, reason = "samples of at most millions")]
pub fn deviation(sample: &[f64]) -> f64 {
    let middle = mean(sample);
    let squares: f64 = sample.iter().map(|x| (x - middle).powi(2)).sum();
    (squares / sample.len().saturating_sub(1).max(1) as f64).sqrt()
}

/// How likely a sample of a normal distribution lies as far from it as this one or farther: p of the Kolmogorov-Smirnov test
/// with Stephens' (1970) correction for the size of the sample; 0 of nothing.
#[allow(clippy::cast_precision_loss, reason = "samples of at most millions")]
pub fn fits_normal(sample: &[f64], mean: f64, deviation: f64) -> f64 {
    if sample.is_empty() || sample.iter().any(|x| !x.is_finite()) {
        return 0.0;
    }
    let mut sorted = sample.to_vec();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len() as f64;
    let below = |x: f64| 0.5 * (1.0 + libm::erf((x - mean) / (deviation * std::f64::consts::SQRT_2)));
    let steps = sorted.iter().enumerate().map(|(i, x)| (i as f64, below(*x)));
    let most = steps.map(|(i, share)| (share - i / count).max((i + 1.0) / count - share)).fold(0.0, f64::max);
    let scaled = (count.sqrt() + 0.12 + 0.11 / count.sqrt()) * most;
    let terms = (1..=100_u8).map(f64::from);
    let sum: f64 =
        terms.map(|k| (if k % 2.0 == 0.0 { -1.0 } else { 1.0 }) * (-2.0 * (k * scaled).powi(2)).exp()).sum();
    // the series does not converge where the samples are alike
    if scaled < 0.2 { 1.0 } else { (2.0 * sum).clamp(0.0, 1.0) }
}

/// The value below which a share of a sample lies; 0 of nothing.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "samples of at most millions"
)]
pub fn quantile(sample: &[f64], share: f64) -> f64 {
    let mut sorted = sample.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = (share.clamp(0.0, 1.0) * sorted.len().saturating_sub(1) as f64).round() as usize;
    sorted.get(place).copied().unwrap_or(0.0)
}

/// Everyone's distance to the nearest other, m.
pub fn nearest_distances(people: &[(u32, Vec2)]) -> Vec<f64> {
    let nearest = |&(who, at): &(u32, Vec2)| {
        let others =
            people.iter().filter(|other| other.0 != who).map(|other| f64::from(other.1.distance(at)));
        others.min_by(f64::total_cmp)
    };
    people.iter().filter_map(nearest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALL: Area = Area::new([0.0, 0.0], [10.0, 4.0]);

    #[test]
    fn densities_of_a_lattice_are_those_of_its_cells() {
        let lattice: Vec<Vec2> = (0..20)
            .flat_map(|i| (0..8).map(move |j| Vec2::new(0.25 + 0.5 * i as f32, 0.25 + 0.5 * j as f32)))
            .collect();
        let area = Area::new([2.0, 1.0], [6.0, 3.0]);
        assert!((classic_density(lattice.iter().copied(), area) - 4.0).abs() < 1e-9);
        let people: Vec<(Vec2, f64)> = lattice.iter().map(|p| (*p, f64::from(p.x))).collect();
        let (density, speed) = voronoi(&people, HALL, area).unwrap();
        assert!((density - 4.0).abs() < 1e-4, "{density}");
        assert!((speed - 4.0).abs() < 1e-4, "{speed}");
        assert_eq!(voronoi(&[], HALL, area), None);
    }

    #[test]
    fn two_people_share_a_hall_by_their_bisector() {
        let people = [(Vec2::new(1.0, 2.0), 1.0), (Vec2::new(5.0, 2.0), 3.0)];
        // the bisector is at x = 3: cells of 12 and 28 m²
        let (density, speed) = voronoi(&people, HALL, HALL).unwrap();
        assert!((density - 2.0 / 40.0).abs() < 1e-6 && (speed - (12.0 + 84.0) / 40.0).abs() < 1e-5);
        let (density, _) = voronoi(&people, HALL, Area::new([0.0, 0.0], [2.0, 4.0])).unwrap();
        assert!((density - 1.0 / 12.0).abs() < 1e-6);
    }

    /// Person k walks along x at 1 m/s from -2 k.
    fn file(count: u32) -> Tracks {
        let mut tracks = Tracks::new(10.0);
        for frame in 0..400 {
            let at = |k: u32| Some(Vec2::new(0.1 * frame as f32 - 2.0 * k as f32 - 0.05, 0.5));
            tracks.push(&(0..count).map(at).collect::<Vec<_>>());
        }
        tracks
    }

    #[test]
    fn a_file_two_metres_apart_at_one_metre_a_second_flows_at_a_half() {
        let tracks = file(15);
        // walking along +x is from the left of a line that points to -z... and back for the other
        let times = crossings(&tracks, Vec2::new(3.0, 1.0), Vec2::new(3.0, 0.0));
        assert!(times.is_empty(), "the wrong way");
        let times = crossings(&tracks, Vec2::new(3.0, 0.0), Vec2::new(3.0, 1.0));
        assert_eq!(times.len(), 15);
        assert!((times[0] - 3.05).abs() < 1e-4 && (flow(&times) - 0.5).abs() < 1e-5, "{times:?}");
        assert!(flow(&[1.0]).abs() < 1e-9);
        assert!(crossings(&tracks, Vec2::new(3.0, 2.0), Vec2::new(3.0, 3.0)).is_empty(), "beside the line");
        let v = tracks.velocity(100, 3, 0.4).unwrap();
        assert!((v - Vec2::X).length() < 1e-4);
    }

    #[test]
    fn who_crosses_a_line_again_has_passed_it_once_the_first_time() {
        let mut tracks = Tracks::new(10.0);
        // to and fro across x = 0, to its right after 0.45 s, 4.45 s and 8.45 s
        (0..100).for_each(|frame| {
            let phase = frame % 40;
            let x = 0.1 * if phase < 20 { phase as f32 - 4.5 } else { 34.5 - phase as f32 };
            tracks.push(&[Some(Vec2::new(x, 0.5))]);
        });
        let times = crossings(&tracks, Vec2::ZERO, Vec2::new(0.0, 1.0));
        assert!(times.len() == 1 && (times[0] - 0.45).abs() < 1e-4, "{times:?}");
    }

    #[test]
    fn lanes_have_order_one_and_a_mixture_little() {
        let lanes: Vec<(f64, f64)> =
            (0..100).map(|i| (f64::from(i) * 0.04, if i < 50 { 1.0 } else { -1.0 })).collect();
        assert!(lane_order(&lanes, 0.3) > 0.9);
        let mixed: Vec<(f64, f64)> = (0..100)
            .map(|i| {
                (f64::from(i) * 0.04, if crate::reference::exact::hash_u32(i) & 1 == 0 { 1.0 } else { -1.0 })
            })
            .collect();
        assert!(lane_order(&mixed, 0.3) < 0.25, "{}", lane_order(&mixed, 0.3));
    }

    #[test]
    fn how_well_a_sample_fits_a_normal_distribution() {
        let sample = [0.9, 1.1, 1.2, 1.25, 1.3, 1.4, 1.45, 1.5, 1.7, 2.0];
        // the exact p of scipy 1.15's kstest; Stephens' correction is good to a hundredth
        assert!((fits_normal(&sample, 1.34, 0.26) - 0.9963).abs() < 0.01);
        assert!((fits_normal(&sample.map(|x| x + 0.3), 1.34, 0.26) - 0.0037).abs() < 0.002);
        assert!((deviation(&sample) - 0.311_091_269).abs() < 1e-9);
        assert!(fits_normal(&[], 1.0, 1.0) == 0.0 && fits_normal(&[f64::NAN], 1.0, 1.0) == 0.0);
    }

    #[test]
    fn kolmogorov_smirnov_of_known_samples() {
        let ramp = |from: f64| (0..1000).map(|i| from + f64::from(i) * 1e-3).collect::<Vec<_>>();
        assert!(kolmogorov_smirnov(&ramp(0.0), &ramp(0.0)) < 1e-9);
        assert!((kolmogorov_smirnov(&ramp(0.0), &ramp(0.25)) - 0.25).abs() < 2e-3);
        assert!((kolmogorov_smirnov(&[1.0, 2.0], &[3.0]) - 1.0).abs() < 1e-9);
        assert!((kolmogorov_smirnov(&[], &[3.0]) - 1.0).abs() < 1e-9);
        assert!((quantile(&ramp(0.0), 0.5) - 0.5).abs() < 1e-2 && (mean(&[1.0, 3.0]) - 2.0).abs() < 1e-9);
    }

    #[test]
    fn the_nearest_is_the_nearest() {
        let people = [(3, Vec2::ZERO), (5, Vec2::new(3.0, 4.0)), (9, Vec2::new(3.0, 5.0))];
        assert_eq!(nearest_distances(&people), [5.0, 1.0, 1.0]);
        assert!(nearest_distances(&people[..1]).is_empty());
    }
}
