//! Strikes, speed and flags on generated gaits, where every strike is known: the left foot at whole cycles, the right
//! at halves; with noise, on a treadmill, on a circle, at any rate.

use super::movements::Noise;
use super::walker::Walker;
use gaitway::Emotion;
use gaitway::gait::walker::{Sex, WalkerStyle, walk};
use gaitway::gait::{Gait, Pose, Recording, stride};
use glam::{Quat, Vec3};

/// How a generated gait is turned into a take.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Way {
    pub(crate) rate: f32,
    pub(crate) seconds: f32,
    /// Phase at the first frame.
    pub(crate) start: f32,
    pub(crate) heading: f32,
    /// Radius of the circle that is walked to the left; infinite is straight.
    pub(crate) radius: f32,
    pub(crate) treadmill: bool,
    /// Standard deviation of the noise of every coordinate, m.
    pub(crate) noise: f32,
}

pub(crate) const STRAIGHT: Way = Way {
    rate: 60.0,
    seconds: 8.0,
    start: 0.3,
    heading: 0.7,
    radius: f32::INFINITY,
    treadmill: false,
    noise: 0.0,
};

fn style(emotion: Emotion, sex: Sex, speed: f64) -> WalkerStyle {
    let mut style = WalkerStyle::preset(emotion, sex);
    // A stride changes with the root of the speed, as people do it.
    let factor = speed / style.speed;
    style.cycle_time /= factor.sqrt();
    style.speed = speed;
    style
}

fn pose_at(gait: &Gait, phase: f32) -> Pose {
    let count = gait.poses.len();
    let frame = phase.rem_euclid(1.0) * count as f32;
    let at = (frame as usize).min(count - 1);
    let (a, b, t) = (&gait.poses[at], &gait.poses[(at + 1) % count], frame - at as f32);
    std::array::from_fn(|joint| a[joint].lerp(b[joint], t))
}

pub(crate) fn take(gait: &Gait, way: Way) -> Recording {
    let cycle = gait.cycle_time();
    let mut noise = Noise(7);
    let frames = (way.seconds * way.rate) as usize;
    let poses = (0..frames).map(|i| {
        let t = i as f32 / way.rate;
        let travelled = if way.treadmill { 0.0 } else { gait.speed * t };
        let turned = travelled / way.radius;
        let centre = if way.radius.is_finite() {
            // A circle to the left of a walker towards +z has its centre at +x.
            Vec3::new(1.0 - turned.cos(), 0.0, turned.sin()) * way.radius
        } else {
            Vec3::Z * travelled
        };
        let world = |point: Vec3| {
            let placed = Quat::from_rotation_y(turned) * point + centre;
            Quat::from_rotation_y(way.heading) * placed
        };
        let mut shake = || Vec3::new(noise.next(), noise.next(), noise.next()) * way.noise;
        pose_at(gait, way.start + t / cycle).map(|point| world(point) + shake())
    });
    Recording::new("generated", way.rate, poses.collect())
}

/// Compares strikes found with those known; returns the largest distance, s. Strikes within 0.3 cycles of the
/// ends may be missed.
fn worst_strike(gait: &Gait, way: Way, survey: &stride::Survey, what: &str) -> f32 {
    let cycle = gait.cycle_time();
    let mut worst = 0.0_f32;
    for (side, offset) in [(0, 0.0), (1, 0.5)] {
        assert!(!survey.by_height[side], "{what}: by height");
        let known = (0..40)
            .map(|k| (k as f32 + offset - way.start) * cycle)
            .filter(|t| *t >= 0.0 && *t < way.seconds);
        let found = &survey.strikes[side];
        for t in known.clone() {
            let off = found.iter().map(|f| (f - t).abs()).fold(f32::MAX, f32::min);
            if t > 0.3 * cycle && t < way.seconds - 0.3 * cycle {
                assert!(
                    off < 0.3 * cycle,
                    "{what}: the strike of foot {side} at {t:.2} s was missed: {found:?}"
                );
            }
            if off < 0.3 * cycle {
                worst = worst.max(off);
            }
        }
        for f in found {
            let off = known.clone().map(|t| (f - t).abs()).fold(f32::MAX, f32::min);
            assert!(
                off < 0.1,
                "{what}: a strike of foot {side} at {f:.2} s that is none (off by {off:.3} s)"
            );
        }
    }
    worst
}

/// How near to the strike a foot that rolls over its heel is seen to come to rest, s: two frames at 30 Hz, or half the way to
/// where it is flat.
fn roll(gait: &Gait) -> f32 {
    f32::max(0.06, 0.05 * gait.cycle_time())
}

fn check(gait: &Gait, way: Way, strike_off: f32, speed_off: f32, what: &str) -> f32 {
    let survey = stride::survey(&take(gait, way)).unwrap();
    let worst = worst_strike(gait, way, &survey, what);
    assert!(worst < strike_off, "{what}: a strike is off by {worst:.3} s");
    let least = (way.seconds / gait.cycle_time()).floor() as usize - 1;
    assert!(
        survey.strides.len() >= least,
        "{what}: {} strides of {least}: {:?}",
        survey.strides.len(),
        survey.refused
    );
    for found in &survey.strides {
        let ratio = found.gait.speed / gait.speed;
        assert!((ratio - 1.0).abs() < speed_off, "{what}: {:.3} m/s of {:.3}", found.gait.speed, gait.speed);
        assert_eq!(found.on_the_spot, way.treadmill, "{what}");
    }
    worst
}

#[test]
fn every_strike_of_every_emotion_and_speed_is_found() {
    let mut worst = 0.0_f32;
    for emotion in Emotion::ALL {
        for sex in [Sex::Female, Sex::Male] {
            for speed in [0.5, 0.8, 1.1, 1.4, 1.7] {
                let Ok(gait) = walk(&style(emotion, sex, speed), "g") else { continue };
                for rate in [30.0, 120.0] {
                    let what = format!("{emotion} {} {speed} m/s at {rate} Hz", sex.name());
                    worst = worst.max(check(&gait, Way { rate, ..STRAIGHT }, roll(&gait), 0.03, &what));
                }
            }
        }
    }
    println!("generated gaits: strikes within {:.0} ms", worst * 1000.0);
}

#[test]
fn strikes_survive_the_noise_of_pose_estimation() {
    let mut worst = [0.0_f32; 3];
    for emotion in Emotion::ALL {
        let gait = walk(&WalkerStyle::preset(emotion, Sex::Female), "g").unwrap();
        for (noise, off, worst) in [(0.002, 0.0), (0.005, 0.025), (0.015, 0.04)]
            .into_iter()
            .zip(&mut worst)
            .map(|((noise, more), worst)| (noise, roll(&gait) + more, worst))
        {
            for rate in [30.0, 120.0] {
                let what = format!("{emotion} with {noise} m of noise at {rate} Hz");
                *worst = worst.max(check(&gait, Way { noise, rate, ..STRAIGHT }, off, 0.08, &what));
            }
        }
    }
    println!("noise of 2, 5, 15 mm: strikes within {:.0?} ms", worst.map(|w| w * 1000.0));
}

#[test]
fn a_treadmill_is_recognised_and_gives_the_speed_of_its_belt() {
    let mut worst = 0.0_f32;
    for emotion in Emotion::ALL {
        for speed in [0.8, 1.2, 1.6] {
            let Ok(gait) = walk(&style(emotion, Sex::Male, speed), "g") else { continue };
            let way = Way { treadmill: true, ..STRAIGHT };
            let recording = take(&gait, way);
            let what = format!("{emotion} {speed} m/s on a treadmill");
            check(&gait, way, 0.05, 0.08, &what);
            let survey = stride::survey(&recording).unwrap();
            assert!(
                survey.on_the_spot && survey.strides[0].gait.provenance.to_string().contains("on the spot")
            );
            assert!(stride::Course::of(&recording).unwrap().on_the_spot);
            let mean = survey.strides.iter().map(|s| s.gait.speed).sum::<f32>() / survey.strides.len() as f32;
            worst = worst.max((mean / gait.speed - 1.0).abs());
        }
    }
    println!("treadmill: speed within {:.1} %", worst * 100.0);
}

#[test]
fn a_circle_is_followed_where_it_is_wide_and_refused_where_it_is_tight() {
    for emotion in Emotion::ALL {
        let gait = walk(&WalkerStyle::preset(emotion, Sex::Female), "g").unwrap();
        let stride_deg = |radius: f32| (gait.stride_travel() / radius).to_degrees();
        for sign in [1.0, -1.0] {
            let radius = sign * gait.stride_travel() / 15.0_f32.to_radians();
            let way = Way { radius, ..STRAIGHT };
            check(&gait, way, 0.06, 0.04, &format!("{emotion} on a circle of {radius:.1} m"));
            let survey = stride::survey(&take(&gait, way)).unwrap();
            for found in &survey.strides {
                let turn = found.turn.to_degrees();
                assert!(
                    (turn - sign * 15.0).abs() < 3.0,
                    "{emotion}: turns by {turn:.1} of {:.1}",
                    stride_deg(radius)
                );
                assert!(found.is_curved() && found.gait.provenance.to_string().contains("curved"));
            }
            let course = stride::Course::of(&take(&gait, way)).unwrap();
            let whole = stride_deg(radius) * way.seconds / gait.cycle_time();
            assert!((course.turn_deg / whole - 1.0).abs() < 0.15, "{} of {whole}", course.turn_deg);
        }
        let tight = Way { radius: gait.stride_travel() / 40.0_f32.to_radians(), ..STRAIGHT };
        let survey = stride::survey(&take(&gait, tight)).unwrap();
        assert!(survey.strides.is_empty() && survey.refused.len() >= 4, "{emotion}: {survey:?}");
        assert!(
            survey.refused.iter().all(|refused| matches!(refused.why, stride::Refusal::Turn { .. })),
            "{:?}",
            survey.refused
        );
    }
}

#[test]
fn a_walk_between_standing_gives_only_the_strides_of_the_walk() {
    let gait = walk(&WalkerStyle::preset(Emotion::Neutral, Sex::Male), "g").unwrap();
    let walked = take(&gait, STRAIGHT);
    let still = |pose: &Pose, noise: &mut Noise| pose.map(|p| p + Vec3::splat(0.001) * noise.next());
    let mut noise = Noise(3);
    let (first, last) = (walked.poses[0], walked.poses[walked.poses.len() - 1]);
    let mut poses: Vec<Pose> = (0..180).map(|_| still(&first, &mut noise)).collect();
    poses.extend(&walked.poses);
    poses.extend((0..180).map(|_| still(&last, &mut noise)));
    let survey = stride::survey(&Recording::new("pause", 60.0, poses)).unwrap();
    let expected = (8.0 / gait.cycle_time()) as usize;
    assert!((expected - 2..=expected + 1).contains(&survey.apart().len()), "{survey:?}");
    for found in &survey.strides {
        assert!(found.begin > 2.5 && found.begin < 11.5, "a stride at {} s", found.begin);
    }
}

#[test]
fn resampling_keeps_strikes_and_speed() {
    let gait = walk(&WalkerStyle::preset(Emotion::Happy, Sex::Male), "g").unwrap();
    let way = Way { rate: 120.0, ..STRAIGHT };
    for hertz in [30.0, 50.0, 60.0, 240.0] {
        let resampled = take(&gait, way).resampled(hertz).unwrap();
        assert!((resampled.frame_rate - hertz).abs() < 1e-3);
        let survey = stride::survey(&resampled).unwrap();
        let worst = worst_strike(&gait, way, &survey, &format!("resampled to {hertz} Hz"));
        assert!(worst < 0.05, "{hertz} Hz: off by {worst}");
    }
}

#[test]
fn where_the_reach_says_nothing_the_lowest_foot_does() {
    // Steps so short that the feet hardly move forwards: the authors' rule, at the moment the foot comes down.
    let walker = Walker { speed: 0.2, cycle: 0.62, ..Walker::default() };
    for rate in [30.0, 120.0] {
        let survey = stride::survey(&walker.take(6.0, rate)).unwrap();
        assert_eq!(survey.by_height, [true, true]);
        for (side, offset) in [(0, 0.0), (1, 0.5)] {
            assert!(survey.strikes[side].len() >= 8, "{:?}", survey.strikes);
            for strike in &survey.strikes[side] {
                let cycles = (strike - walker.first_strike) / walker.cycle - offset;
                let off = (cycles - cycles.round()) * walker.cycle;
                assert!(off.abs() < 0.05, "{rate} Hz: foot {side} at {strike} s is off by {off} s");
            }
        }
        assert!(survey.strides.iter().all(|s| (s.gait.speed / 0.2 - 1.0).abs() < 0.1));
        assert!(
            survey.strides.len() >= 7
                && survey.strides[0].gait.provenance.to_string().contains("by lowest foot")
        );
    }
}
