//! Round a corner.

use super::super::judge::{Bench, Criterion, Test};
use super::super::measure::{Area, crossings};
use super::super::rooms::{corridor, places, walker};
use super::super::scene::Scene;
use crate::Error;
use glam::Vec2;

pub(super) const RIMEA_6: Test = Test {
    name: "rimea-6",
    title: "20 people walk round a left corner of a corridor 2 m wide",
    about: "After RiMEA 6 (3.0.0), with arms of 16 m: all get round, nobody through a wall. It has no bound for the time.",
    run: twenty,
    has_variants: true,
};

pub(super) const NIST_CORNER: Test = Test {
    name: "nist-corner",
    title: "20 people walk round a corner without passing through its walls",
    about: "NIST Technical Note 1822, 2.3 (movement around a corner): as RiMEA 6.",
    run: twenty,
    has_variants: true,
};

/// An L: along x, then along z; `width` wide, the legs `leg` and `second` long at their outer sides.
fn corner(width: f32, leg: f32, second: f32, seconds: f32) -> Result<Scene, Error> {
    let inner = leg - width;
    let outline = [[0.0, 0.0], [leg, 0.0], [leg, second], [inner, second], [inner, width], [0.0, width]];
    Scene::new("corner", &outline, seconds)
}

/// They walk to places from `ends[0]` to `ends[1]`, m, of the second leg.
fn crowd(scene: &mut Scene, width: f32, leg: f32, count: usize, start: Area, ends: [f32; 2]) {
    let ends = places(Area::new([leg - width + 0.4, ends[0]], [leg - 0.4, ends[1]]), count, 7);
    let middle = leg - 0.5 * width;
    for (place, end) in places(start, count, 3).into_iter().zip(ends) {
        let offset = (place.y / width).clamp(0.1, 0.9);
        // each on a way as far from the inner side as they start, behind the corner, too
        let end = Vec2::new(leg - width * offset, end.y);
        let turn = Vec2::new(middle + width * (0.5 - offset) * 0.5, width * offset);
        scene.walkers.push(walker(place, 1.34, vec![(turn, 0.45 * width), (end, 0.5)]));
    }
}

fn twenty(bench: &Bench<'_>) -> Result<(), Error> {
    let mut scene = corner(2.0, 16.0, 16.0, 40.0)?;
    crowd(&mut scene, 2.0, 16.0, 20, Area::new([0.3, 0.3], [6.0, 1.7]), [10.0, 15.6]);
    let run = bench.run(&scene)?;
    let times = crossings(&run.tracks, Vec2::new(16.1, 8.0), Vec2::new(13.9, 8.0));
    let round = u32::try_from(times.len()).unwrap_or(0);
    bench.say("round", f64::from(round), Criterion::AtLeast(20.0), "people");
    bench.say("outside", f64::from(run.outside), Criterion::AtMost(0.0), "places outside the walls");
    bench.say("overlapping", f64::from(run.overlapping), Criterion::Report, "");
    bench.say("time", times.last().copied().unwrap_or(f64::NAN), Criterion::Report, "");
    Ok(())
}

pub(super) const RIMEA_15: Test = Test {
    name: "rimea-15",
    title: "A large crowd walks round a corner",
    about: "RiMEA guideline, test 15 in our words: 70, 140 and 210 people, at the start up to 2.8 to a square metre; the time grows with the number of people, and is no shorter than in a straight \
            corridor of the length of the corner's inner side and no more than 1.3 times that of one as long as its outer \
            side.",
    run: large,
    has_variants: true,
};

fn large(bench: &Bench<'_>) -> Result<(), Error> {
    const WIDTH: f32 = 4.0;
    const LEG: f32 = 30.0;
    let most: usize = if bench.is_quick { 100 } else { 210 };
    let start = Area::new([0.3, 0.3], [22.0, WIDTH - 0.3]);
    let mut times = Vec::new();
    let mut outside = 0;
    for count in [most / 3, 2 * most / 3, most] {
        let mut scene = corner(WIDTH, LEG, 80.0, 240.0)?;
        // far behind, so that those who stand there already are in nobody's way
        crowd(&mut scene, WIDTH, LEG, count, start, [30.0, 79.0]);
        scene.until = Some(1);
        let run = bench.run(&scene)?;
        let round = crossings(&run.tracks, Vec2::new(LEG + 0.1, 5.0), Vec2::new(LEG - WIDTH - 0.1, 5.0));
        times.push(if round.len() * 100 >= count * 95 { round[count * 95 / 100 - 1] } else { f64::NAN });
        outside += run.outside;
    }
    // straight ones, to where the inner and the outer side of the corner come to the same line
    let mut straight = Vec::new();
    for length in [LEG - WIDTH + 1.0, LEG + 5.0] {
        let mut scene = corridor("straight", 60.0, WIDTH, 240.0)?;
        for place in places(start, most, 3) {
            scene.walkers.push(walker(
                place,
                1.34,
                vec![(Vec2::new(50.0, place.y), 2.0), (Vec2::new(59.0, place.y), 0.5)],
            ));
        }
        let run = bench.run(&scene)?;
        let past = crossings(&run.tracks, Vec2::new(length, -0.1), Vec2::new(length, WIDTH + 0.1));
        straight.push(past.get(most * 95 / 100 - 1).copied().unwrap_or(f64::NAN));
    }
    let steps = [times[1] - times[0], times[2] - times[1]];
    bench.say(
        "growth",
        steps[0].min(steps[1]),
        Criterion::AtLeast(0.0),
        "s more for each third of the people",
    );
    bench.say(
        "time",
        times[2],
        Criterion::Within(straight[0], 1.3 * straight[1]),
        "s for 95 % of the people",
    );
    bench.say("outside", f64::from(outside), Criterion::AtMost(0.0), "places outside the walls");
    Ok(())
}
