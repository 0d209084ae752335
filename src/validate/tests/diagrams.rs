//! Fundamental diagrams.

use super::super::diagram::{RING_RADIUS, Ring, speed_round, weidmann};
use super::super::files;
use super::super::judge::{Bench, Criterion, Draws, Origin, Test};
use super::super::measure::{Area, mean, voronoi};
use super::super::tracks::Tracks;
use crate::Error;
use crate::export::chart::{Curve, Plot, Stroke};
use glam::Vec2;

const BLUE: [u8; 3] = [66, 118, 190];
const RED: [u8; 3] = [200, 66, 52];
const YELLOW: [u8; 3] = [222, 158, 20];

pub(super) const RIMEA_4: Test = Test {
    name: "rimea-4",
    title: "The more people to a square metre, the slower they walk, up to 6 people/m²",
    source: "After RiMEA 4.1.1, test 4 (p. 29)",
    about: "The source has a corridor of 1,000 m by 10 m, without tolerance or curve. Here all walk one way round a ring 75 m long \
            and 3 m wide, then round one of 0.8 m, too narrow to overtake, for 60 s after 10 s. Density is people over the ring's \
            area, speed the mean along it. Two values are judged. From one density to the next the speed rises by at most 0.01 m/s \
            (free speeds differ by rounding). The greatest flow is 1.2 to 1.8 people/(m s), the spread of the literature (Zhang \
            and Seyfried 2010). Weidmann's curve (1993) is shown and not judged, since `crowding` multiplies by it. In \
            juelich-corridor recorded speeds judge.",
    run: ring_diagram,
    draws: Draws::TurnedSeeds,
    grows: true,
};

/// Speeds round a ring of this width at each density; and how many places are outside its walls.
fn speeds_round(bench: &Bench<'_>, width: f32, densities: &[f32]) -> Result<(Vec<[f64; 2]>, usize), Error> {
    let (seconds, from) = if bench.is_quick { (12.0, 6.0) } else { (70.0, 10.0) };
    let (mut points, mut outside) = (Vec::new(), 0);
    for &density in densities {
        let ring = Ring { middle: bench.along(RING_RADIUS), width, density, lane: bench.lane(0) };
        let run = bench.run(&ring.scene(seconds)?)?;
        points.push([f64::from(density), speed_round(&run.tracks, from)]);
        outside += run.outside as usize;
    }
    Ok((points, outside))
}

/// Speeds that differ by no more than this are alike, m/s: at low densities everyone walks freely.
const FREE_ALIKE: f64 = 0.01;

/// The greatest rise of speed from a density to the next, m/s.
fn rise(points: &[[f64; 2]]) -> f64 {
    points.windows(2).map(|pair| pair[1][1] - pair[0][1]).fold(f64::NEG_INFINITY, f64::max)
}

fn ring_diagram(bench: &Bench<'_>) -> Result<(), Error> {
    let unit = "m/s from a density to the next";
    let densities: &[f32] =
        if bench.is_quick { &[0.5, 1.5, 3.0] } else { &[0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0] };
    let (points, outside) = speeds_round(bench, 3.0, densities)?;
    for &[density, speed] in &points {
        bench.report(&format!("speed-{density:.1}"), speed, "m/s");
        // beyond 5.4 people/m² all stand, by Weidmann
        if density < 5.4 {
            let deviation = speed / weidmann(density) - 1.0;
            bench.report(&format!("weidmann-{density:.1}"), deviation, "from Weidmann's speed");
        }
    }
    bench.judge("rise", rise(&points), Criterion::AtMost(FREE_ALIKE), unit, Origin::Ours);
    let capacity = points.iter().map(|point| point[0] * point[1]).fold(0.0, f64::max);
    let literature = Origin::Source("spread of the literature");
    bench.judge("capacity", capacity, Criterion::Within(1.2, 1.8), "people/(m s)", literature);
    let narrow = if bench.is_quick { &[0.5, 2.0][..] } else { &[0.5, 1.0, 2.0, 3.0] };
    let (in_file, outside_file) = speeds_round(bench, 0.8, narrow)?;
    for &[density, speed] in &in_file {
        bench.report(&format!("narrow-{density:.1}"), speed, "m/s");
    }
    bench.judge("narrow-rise", rise(&in_file), Criterion::AtMost(FREE_ALIKE), unit, Origin::Ours);
    bench.never("outside", outside + outside_file, "places outside the walls", Origin::Ours);
    bench.draw("rimea-4", || Plot {
        title: "Speed over density, one way".into(),
        axes: ["density, people/m²".into(), "speed, m/s".into()],
        curves: vec![
            curve_of_weidmann(),
            Curve { name: "gaitway".into(), points, stroke: Stroke::Points, color: BLUE },
        ],
        note: "A ring 3 m wide and 75 m long.".into(),
    });
    Ok(())
}

fn curve_of_weidmann() -> Curve {
    let points = (6..108).map(|i| f64::from(i) * 0.05).map(|density| [density, weidmann(density)]).collect();
    Curve { name: "Weidmann 1993".into(), points, stroke: Stroke::Dashed, color: RED }
}

/// The recordings, each with as many people as its entrance and exit let in and out.
const RECORDINGS: [&str; 6] = [
    "uo-050-180-180",
    "uo-060-180-180",
    "uo-070-180-180",
    "uo-100-180-180",
    "uo-145-180-180",
    "uo-180-180-095",
];
/// The corridor, and the area in it that PedPy measures.
const CORRIDOR: Area = Area::new([0.0, -4.0], [1.8, 4.0]);
const MEASURED: Area = Area::new([0.0, -2.0], [1.8, 0.0]);

pub(super) const JUELICH_CORRIDOR: Test = Test {
    name: "juelich-corridor",
    title: "Speed over density as in the corridor of Jülich",
    source: "Six recordings of uni-directional flow (Forschungszentrum Jülich)",
    about: "Experiments in a corridor 1.8 m wide; Voronoi density and speed in x 0 to 1.8 m, y -2 to 0 m, averaged in steps of 0.5 people/m². \
            In the ring, people with the free speed of the experiment (its mean below 0.75 people/m²) walk at the same density. Ours: \
            the mean difference over the steps is at most 20 % of the measured speed.",
    run: juelich,
    draws: Draws::Seeds,
    grows: false,
};

/// Density and speed in the measured area, once a second.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "frames")]
fn measured(tracks: &Tracks) -> Vec<[f64; 2]> {
    let mut found = Vec::new();
    for frame in (0..tracks.frames.len()).step_by((tracks.rate as usize).max(1)) {
        let people: Vec<(Vec2, f64)> = tracks.frames[frame]
            .iter()
            .filter(|person| CORRIDOR.contains(person.1))
            .filter_map(|&(who, at)| tracks.velocity(frame, who, 0.4).map(|v| (at, -f64::from(v.y))))
            .collect();
        // an empty area says nothing about speed
        if people.iter().any(|(at, _)| MEASURED.contains(*at))
            && let Some((density, speed)) = voronoi(&people, CORRIDOR, MEASURED)
        {
            found.push([density, speed]);
        }
    }
    found
}

fn juelich(bench: &Bench<'_>) -> Result<(), Error> {
    let mut points = Vec::new();
    for name in RECORDINGS {
        let Some(path) = bench.file(&format!("crowd-juelich/uni-directional/{name}.txt")) else {
            return Ok(());
        };
        points.extend(measured(&files::juelich(&path, 0.01, 16.0).map_err(super::super::unusable)?));
    }
    let speeds = |low: f64, high: f64| -> Vec<f64> {
        points.iter().filter(|p| p[0] >= low && p[0] < high).map(|p| p[1]).collect()
    };
    let free = mean(&speeds(0.0, 0.75));
    let (mut found, mut differences) = (Vec::new(), Vec::new());
    for step in 1..=6_u8 {
        let density = 0.5 * f64::from(step);
        let real = speeds(density - 0.25, density + 0.25);
        if real.len() < 5 {
            continue;
        }
        #[allow(clippy::cast_possible_truncation, reason = "a density and a speed")]
        let (density32, free32) = (density as f32, free as f32);
        let ring = Ring { middle: RING_RADIUS, width: 1.8, density: density32, lane: bench.lane(0) };
        let mut scene = ring.scene(if bench.is_quick { 12.0 } else { 24.0 })?;
        scene.walkers.iter_mut().for_each(|walker| walker.speed = free32);
        let run = bench.run(&scene)?;
        let speed = speed_round(&run.tracks, 0.5 * f64::from(scene.seconds));
        found.push([density, speed]);
        bench.report(&format!("measured-{density:.1}"), mean(&real), "m/s");
        differences.push((speed / mean(&real) - 1.0).abs());
    }
    for point in &found {
        bench.report(&format!("speed-{:.1}", point[0]), point[1], "m/s");
    }
    bench.report("free-speed", free, "m/s");
    let criterion = Criterion::AtMost(0.2);
    bench.judge("difference", mean(&differences), criterion, "of the measured speed", Origin::Ours);
    bench.draw("juelich-corridor", || Plot {
        title: "Speed over density in a corridor".into(),
        axes: ["density, people/m²".into(), "speed, m/s".into()],
        curves: vec![
            Curve {
                name: "Jülich, each second".into(),
                points: points.clone(),
                stroke: Stroke::Points,
                color: YELLOW,
            },
            curve_of_weidmann(),
            Curve { name: "gaitway".into(), points: found, stroke: Stroke::Line, color: BLUE },
        ],
        note: "Data: Forschungszentrum Jülich, IAS-7; Voronoi density and speed as in PedPy.".into(),
    });
    Ok(())
}
