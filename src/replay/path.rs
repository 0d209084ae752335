//! A smooth path through a track's samples.
//!
//! Positions: cubic Hermite polynomials through the samples, with the slopes of the parabola through each sample and its
//! two neighbours (Catmull-Rom for samples that are not evenly spaced); velocities are their derivative, so both are
//! continuous. Smoothing against tracking jitter comes first: a straight line is fitted to the neighbours of each sample with
//! Gaussian weights, and its value at that time replaces the sample. This local linear regression preserves straight uniform
//! walks, to the ends.

use super::read::tracks::{Sample, Track};
use glam::{DVec2, Vec2};

/// Weights beyond so many standard deviations are left out.
const REACH: f64 = 3.0;

/// The state of a person at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Ground (x, z), m.
    pub position: Vec2,
    /// m/s.
    pub velocity: Vec2,
    /// Heading of body or head about +y as the file has it, at the nearest sample, rad.
    pub heading: Option<f32>,
}

/// A track as a function of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// Time, place, slope.
    knots: Vec<(f64, DVec2, DVec2)>,
    headings: Vec<Option<f32>>,
}

impl Path {
    /// The path of a track, smoothed with a Gaussian of `smooth` s (its standard deviation); 0: through every sample.
    pub fn new(track: &Track, smooth: f64) -> Self {
        let times: Vec<f64> = track.samples.iter().map(|sample| sample.time).collect();
        let raw: Vec<DVec2> = track.samples.iter().map(|sample| sample.position.as_dvec2()).collect();
        let places = if smooth > 0.0 { smoothed(&times, &raw, smooth) } else { raw };
        let slopes = slopes(&times, &places);
        let knots = times.into_iter().zip(places).zip(slopes).map(|((t, p), m)| (t, p, m)).collect();
        Self { knots, headings: track.samples.iter().map(|sample: &Sample| sample.heading).collect() }
    }

    /// First and last moment, s.
    pub fn span(&self) -> (f64, f64) {
        let time = |knot: Option<&(f64, DVec2, DVec2)>| knot.map_or(0.0, |knot| knot.0);
        (time(self.knots.first()), time(self.knots.last()))
    }

    /// Where and how fast at a time; `None` before the first and after the last sample.
    pub fn at(&self, time: f64) -> Option<Moment> {
        // Steps and frames are counted, so times that mean the same may differ in the last bits.
        const SLACK: f64 = 1e-4;
        let (first, last) = self.span();
        if !(first - SLACK..=last + SLACK).contains(&time) {
            return None;
        }
        let time = time.clamp(first, last);
        let next = self.knots.partition_point(|knot| knot.0 <= time).clamp(1, self.knots.len().max(2) - 1);
        let (&(t0, p0, m0), Some(&(t1, p1, m1))) = (self.knots.get(next - 1)?, self.knots.get(next)) else {
            let &(_, place, _) = self.knots.first()?;
            return Some(moment(place, DVec2::ZERO, self.headings.first().copied().flatten()));
        };
        let (span, u) = (t1 - t0, (time - t0) / (t1 - t0));
        let (u2, u3) = (u * u, u * u * u);
        let position = p0 * (2.0 * u3 - 3.0 * u2 + 1.0)
            + m0 * (span * (u3 - 2.0 * u2 + u))
            + p1 * (3.0 * u2 - 2.0 * u3)
            + m1 * (span * (u3 - u2));
        let velocity = (p0 - p1) * ((6.0 * u2 - 6.0 * u) / span)
            + m0 * (3.0 * u2 - 4.0 * u + 1.0)
            + m1 * (3.0 * u2 - 2.0 * u);
        let nearest = if u < 0.5 { next - 1 } else { next };
        Some(moment(position, velocity, self.headings.get(nearest).copied().flatten()))
    }

    /// Mean speed while walking (faster than `slowest` m/s between two samples), m/s; `None` if that is never.
    pub fn walking_speed(&self, slowest: f64) -> Option<f64> {
        let (mut way, mut time) = (0.0, 0.0);
        for two in self.knots.windows(2) {
            let (distance, seconds) = ((two[1].1 - two[0].1).length(), two[1].0 - two[0].0);
            if distance > slowest * seconds {
                (way, time) = (way + distance, time + seconds);
            }
        }
        (time > 0.0).then(|| way / time)
    }
}

fn moment(position: DVec2, velocity: DVec2, heading: Option<f32>) -> Moment {
    Moment { position: position.as_vec2(), velocity: velocity.as_vec2(), heading }
}

fn slopes(times: &[f64], places: &[DVec2]) -> Vec<DVec2> {
    let rise = |i: usize| (places[i + 1] - places[i]) / (times[i + 1] - times[i]);
    let last = times.len().saturating_sub(1);
    let slope = |i: usize| {
        if last == 0 {
            DVec2::ZERO
        } else if i == 0 {
            rise(0)
        } else if i == last {
            rise(last - 1)
        } else {
            let (before, after) = (times[i] - times[i - 1], times[i + 1] - times[i]);
            (rise(i - 1) * after + rise(i) * before) / (before + after)
        }
    };
    (0..times.len()).map(slope).collect()
}

/// Local linear regression with Gaussian weights.
fn smoothed(times: &[f64], places: &[DVec2], deviation: f64) -> Vec<DVec2> {
    let mut first = 0;
    let value = |(i, &now): (usize, &f64)| {
        while times[first] < now - REACH * deviation {
            first += 1;
        }
        let near = (first..times.len()).take_while(|&k| times[k] <= now + REACH * deviation);
        // moments of the weights about `now`
        let (mut s0, mut s1, mut s2) = (0.0, 0.0, 0.0);
        let (mut p0, mut p1) = (DVec2::ZERO, DVec2::ZERO);
        for k in near {
            let t = times[k] - now;
            let w = libm::exp(-0.5 * (t / deviation) * (t / deviation));
            s0 += w;
            s1 += w * t;
            s2 += w * t * t;
            p0 += places[k] * w;
            p1 += places[k] * (w * t);
        }
        let determinant = s0 * s2 - s1 * s1;
        if determinant > 1e-12 * s0 * s0 * deviation * deviation {
            (p0 * s2 - p1 * s1) / determinant
        } else {
            places[i] // alone in its neighbourhood
        }
    };
    times.iter().enumerate().map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(samples: &[(f64, [f32; 2])]) -> Track {
        let sample =
            |(time, p): &(f64, [f32; 2])| Sample { time: *time, position: Vec2::from(*p), heading: None };
        Track { person: 1, samples: samples.iter().map(sample).collect() }
    }

    #[test]
    fn a_path_goes_through_its_samples_and_its_velocity_is_its_derivative() {
        let path = Path::new(
            &track(&[(0.0, [0.0, 0.0]), (0.4, [0.5, 0.1]), (1.0, [0.9, 0.6]), (1.4, [0.9, 1.0])]),
            0.0,
        );
        for (time, place) in [(0.0, [0.0, 0.0]), (0.4, [0.5, 0.1]), (1.0, [0.9, 0.6]), (1.4, [0.9, 1.0])] {
            assert!(path.at(time).unwrap().position.distance(Vec2::from(place)) < 1e-6, "{time}");
        }
        for step in 1..139_u8 {
            let t = f64::from(step) * 0.01;
            let (a, b) = (path.at(t - 1e-4).unwrap(), path.at(t + 1e-4).unwrap());
            let measured = (b.position.as_dvec2() - a.position.as_dvec2()) / 2e-4;
            let said = path.at(t).unwrap().velocity.as_dvec2();
            assert!((measured - said).length() < 5e-3, "{t}: {measured} {said}");
        }
    }

    #[test]
    fn a_person_is_absent_before_the_first_and_after_the_last_sample() {
        let path = Path::new(&track(&[(2.0, [0.0, 0.0]), (3.0, [1.0, 0.0])]), 0.0);
        assert!(path.at(1.99).is_none() && path.at(3.01).is_none());
        assert!(path.at(2.0 - 1e-9).is_some() && path.at(3.0 + 1e-9).is_some());
        let alone = Path::new(&track(&[(2.0, [4.0, 5.0])]), 0.3);
        let there = alone.at(2.0).unwrap();
        assert_eq!((there.position, there.velocity), (Vec2::new(4.0, 5.0), Vec2::ZERO));
        assert!(alone.at(2.1).is_none() && alone.walking_speed(0.2).is_none());
    }

    #[test]
    fn smoothing_leaves_a_straight_walk_and_takes_jitter_away() {
        #[allow(clippy::cast_possible_truncation, reason = "small numbers")]
        let walk = |jitter: f64| -> Vec<(f64, [f32; 2])> {
            let at = |i: u8| {
                let t = f64::from(i) / 25.0;
                let sway = if i.is_multiple_of(2) { jitter } else { -jitter };
                (t, [(1.3 * t) as f32, sway as f32])
            };
            (0..100).map(at).collect()
        };
        let straight = Path::new(&track(&walk(0.0)), 0.2);
        let shaken = Path::new(&track(&walk(0.02)), 0.2);
        for step in 0..99_u8 {
            let t = f64::from(step) / 25.0;
            let at = straight.at(t).unwrap().position.as_dvec2();
            assert!((at - DVec2::new(1.3 * t, 0.0)).length() < 1e-6, "{t}: {at}");
            assert!(shaken.at(t).unwrap().position.y.abs() < 0.006, "{t}");
        }
        assert!((straight.walking_speed(0.2).unwrap() - 1.3).abs() < 1e-5);
    }
}
