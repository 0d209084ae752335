//! Round a corner.

use super::super::judge::{Bench, Criterion, Draws, Origin, Test};
use super::super::measure::{Area, crossings};
use super::super::rooms::{RADIUS, corridor, places, walker};
use super::super::scene::Experiment;
use crate::Error;
use glam::Vec2;
use std::f32::consts::FRAC_1_SQRT_2;

pub(super) const RIMEA_6: Test = Test {
    name: "rimea-6",
    title: "20 people walk round a left corner of a corridor 2 m wide",
    source: "RiMEA 4.1.1, test 6 (p. 30)",
    about: "Arms of 10 m and 2 m of corner, the start spread over 6 m: all get round, none through a wall. The source has no \
            bound for the time. Ours: no centre comes nearer to a wall than 0.9 of the radius.",
    run: |bench| twenty(bench, Origin::Source("RiMEA 4.1.1, 6")),
    draws: Draws::TurnedSeeds,
    grows: true,
};

pub(super) const NIST_CORNER: Test = Test {
    name: "nist-corner",
    title: "20 people walk round a corner without passing through its walls",
    source: "NIST Technical Note 1822, 2.3; ISO 20414, test 4",
    about: "The scene of RiMEA 6.",
    run: |bench| twenty(bench, Origin::Source("NIST TN 1822, 2.3")),
    draws: Draws::TurnedSeeds,
    grows: true,
};

/// How much broader than the corridor the yard behind it is, on each side, m.
const SIDE: f32 = 8.0;

/// An L whose arms are `width` wide: along x, as far as `inner` at its inner side, then along z as far as `line`; from there a
/// yard `deep`.
fn corner(width: f32, inner: f32, line: f32, deep: f32, seconds: f32) -> Result<Experiment, Error> {
    let (outer, far) = (inner + width, line + deep);
    let outline = [
        [0.0, 0.0],
        [outer, 0.0],
        [outer, line],
        [outer + SIDE, line],
        [outer + SIDE, far],
        [inner - SIDE, far],
        [inner - SIDE, line],
        [inner, line],
        [inner, width],
        [0.0, width],
    ];
    Experiment::new("corner", &outline, seconds)
}

/// The way of a person who starts at a place of the first arm: round the corner as far from its inner side as they start, then
/// past z = `line`, and to `end`.
fn round(place: Vec2, width: f32, inner: f32, line: f32, end: Vec2) -> Vec<(Vec2, f32)> {
    let pivot = Vec2::new(inner, width);
    let away = width - place.y.clamp(2.0 * RADIUS, width - 2.0 * RADIUS);
    let reach = 0.9;
    let points = [Vec2::new(0.0, -away), Vec2::new(away, -away) * FRAC_1_SQRT_2, Vec2::new(away, 0.0)];
    let mut way: Vec<(Vec2, f32)> = points.iter().map(|point| (pivot + *point, reach)).collect();
    way.extend([(Vec2::new(inner + away, line + 1.0), reach), (end, 0.5)]);
    way
}

fn twenty(bench: &Bench<'_>, source: Origin) -> Result<(), Error> {
    const WIDTH: f32 = 2.0;
    const END: f32 = 12.0;
    let (count, spread) = (bench.people(20), bench.along(6.0));
    let (inner, deep) = (spread + 4.0, bench.along(12.0));
    let mut scene = corner(WIDTH, inner, END, deep, 60.0)?;
    scene.until = Some(4);
    let yard = Area::new([inner - SIDE + 0.5, END + 3.0], [inner + WIDTH + SIDE - 0.5, END + deep - 0.5]);
    let ends = places(yard, count, bench.lane(7));
    let start = places(Area::new([0.3, 0.3], [spread, WIDTH - 0.3]), count, bench.lane(3));
    for (place, end) in start.into_iter().zip(ends) {
        scene.walkers.push(walker(place, 1.34, round(place, WIDTH, inner, END, end)));
    }
    let run = bench.run(&scene)?;
    let times = crossings(&run.tracks, Vec2::new(inner + 2.1, END), Vec2::new(inner - 0.1, END));
    bench.never("not-round", count - times.len().min(count), "people", source);
    bench.never("outside", run.outside as usize, "places outside the walls", source);
    let nearest = f64::from(run.nearest_wall / RADIUS);
    bench.judge(
        "wall",
        nearest,
        Criterion::AtLeast(0.9),
        "radii from a wall, the nearest centre",
        Origin::Ours,
    );
    bench.report("time", times.last().copied().unwrap_or(f64::NAN), "s");
    Ok(())
}

pub(super) const RIMEA_15: Test = Test {
    name: "rimea-15",
    title: "500 people walk round a corner in a time between those of two straight ways",
    source: "RiMEA 4.1.1, test 15 (p. 45)",
    about: "Corridors 20 m wide: a corner with arms of 34 m and 30 m, a straight one of 44 m, the length of the corner's inner side, and one of \
            75.4 m, that of its outer side. All arrive; the corner lies between both. Here all start in the first 14 m, 1.9 people/m², \
            and each keeps their distance from the inner side (the source does not say).",
    run: large,
    draws: Draws::TurnedSeeds,
    grows: true,
};

/// When all have crossed a line, s; NaN if one has not.
fn last(times: &[f64], count: usize) -> f64 {
    if times.len() == count { times.last().copied().unwrap_or(0.0) } else { f64::NAN }
}

fn large(bench: &Bench<'_>) -> Result<(), Error> {
    const WIDTH: f32 = 20.0;
    const ARM: f32 = 30.0;
    let count = bench.people(if bench.is_quick { 150 } else { 500 });
    let inner = bench.along(14.0);
    let behind = bench.along(60.0);
    let line = WIDTH + ARM;
    let start = places(Area::new([0.3, 0.3], [inner - 0.3, WIDTH - 0.3]), count, bench.lane(3));
    let free = Area::new([inner + 0.4, line + 10.0], [inner + WIDTH - 0.4, line + behind - 1.0]);
    let ends = places(free, count, bench.lane(7));
    let mut scene = corner(WIDTH, inner, line, behind, 600.0)?;
    scene.until = Some(4);
    for (place, end) in start.iter().zip(&ends) {
        scene.walkers.push(walker(*place, 1.34, round(*place, WIDTH, inner, line, *end)));
    }
    let run = bench.run(&scene)?;
    let (right, left) = (Vec2::new(inner + WIDTH + 0.1, line), Vec2::new(inner - 0.1, line));
    let round = last(&crossings(&run.tracks, right, left), count);
    bench.never("outside", run.outside as usize, "places outside the walls", Origin::Ours);
    // both straight ones at once: agents past the shorter line walk on to the longer one
    let [short, long] = [inner + ARM, inner + ARM + 0.5 * std::f32::consts::PI * WIDTH];
    let mut scene = corridor("straight", long + behind + 15.0, WIDTH, 600.0)?;
    scene.until = Some(1);
    for (place, end) in start.iter().zip(&ends) {
        let on = long + 10.0 + (end.y - line - 10.0);
        let way = vec![(Vec2::new(long + 1.6, place.y), 1.0), (Vec2::new(on, place.y), 0.5)];
        scene.walkers.push(walker(*place, 1.34, way));
    }
    let run = bench.run(&scene)?;
    let straight = [short, long]
        .map(|x| last(&crossings(&run.tracks, Vec2::new(x, -0.1), Vec2::new(x, WIDTH + 0.1)), count));
    let source = Origin::Source("RiMEA 4.1.1, 15");
    bench.report("time", round, "s");
    bench.judge(
        "beyond-short",
        round - straight[0],
        Criterion::AtLeast(0.0),
        "s more than the short straight way",
        source,
    );
    bench.judge(
        "below-long",
        straight[1] - round,
        Criterion::AtLeast(0.0),
        "s less than the long straight way",
        source,
    );
    Ok(())
}
