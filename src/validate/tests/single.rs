//! People alone keep their speed; groups keep together.

use super::super::judge::{Bench, Criterion, Test};
use super::super::measure::{crossings, quantile};
use super::super::rooms::{corridor, unit, walker};
use super::super::scene::Walker;
use crate::Error;
use glam::Vec2;

pub(super) const RIMEA_1: Test = Test {
    name: "rimea-1",
    title: "One person keeps the speed of 1.33 m/s along 40 m of a corridor 2 m wide",
    about: "RiMEA guideline, test 1: the way takes 26 to 34 s.",
    run: |bench| alone(bench, 1.33, Criterion::Within(26.0, 34.0)),
    has_variants: true,
};

pub(super) const NIST_CORRIDOR: Test = Test {
    name: "nist-corridor",
    title: "One person walks 40 m at 1 m/s",
    about: "NIST Technical Note 1822, verification of movement in a corridor: 40 s. Ours: to 2 %.",
    run: |bench| alone(bench, 1.0, Criterion::Within(39.2, 40.8)),
    has_variants: true,
};

fn alone(bench: &Bench<'_>, speed: f32, criterion: Criterion) -> Result<(), Error> {
    let mut scene = corridor("corridor", 44.0, 2.0, 100.0)?;
    scene.walkers.push(walker(Vec2::new(1.0, 1.0), speed, vec![(Vec2::new(43.0, 1.0), 0.3)]));
    scene.until = Some(1);
    let run = bench.run(&scene)?;
    let time = |x: f32| crossings(&run.tracks, Vec2::new(x, -0.1), Vec2::new(x, 2.1)).first().copied();
    let taken = time(42.0).zip(time(2.0)).map_or(f64::NAN, |(end, start)| end - start);
    bench.say("time", taken, criterion, "s");
    bench.say("outside", f64::from(run.outside), Criterion::AtMost(0.0), "places outside the walls");
    Ok(())
}

pub(super) const RIMEA_7: Test = Test {
    name: "rimea-7",
    title: "50 adults of three age groups walk at the speeds assigned to them",
    about: "RiMEA guideline, test 7, with Weidmann's ranges by age as Zhou (2015) quotes them: 0.58 to 1.61 m/s under 30, \
            1.41 to 1.54 at 30 to 50, 0.68 to 1.41 over 50. Each of 50 people has a lane; ours: to 3 %.",
    run: ages,
    has_variants: true,
};

#[allow(clippy::cast_precision_loss, reason = "50 people")]
fn ages(bench: &Bench<'_>) -> Result<(), Error> {
    const RANGES: [[f32; 2]; 3] = [[0.58, 1.61], [1.41, 1.54], [0.68, 1.41]];
    let mut scene = corridor("ages", 34.0, 50.0, 60.0)?;
    scene.until = Some(1);
    for i in 0..50 {
        let [low, high] = RANGES[i % 3];
        let z = i as f32 + 0.5;
        let speed = low + (high - low) * unit(i, 1);
        scene.walkers.push(walker(Vec2::new(1.0, z), speed, vec![(Vec2::new(33.0, z), 0.3)]));
    }
    let run = bench.run(&scene)?;
    let (mut worst, mut out_of_range) = (0.0_f64, 0);
    for (i, walker) in scene.walkers.iter().enumerate() {
        let z = i as f32;
        let time = |x: f32| crossings(&run.tracks, Vec2::new(x, z), Vec2::new(x, z + 1.0)).first().copied();
        let walked = time(32.0).zip(time(2.0)).map_or(0.0, |(end, start)| 30.0 / (end - start));
        worst = worst.max((walked / f64::from(walker.speed) - 1.0).abs());
        let [low, high] = RANGES[i % 3].map(f64::from);
        out_of_range += u32::from(!(walked >= 0.97 * low && walked <= 1.03 * high));
    }
    bench.say("deviation", worst, Criterion::AtMost(0.03), "of the assigned speed");
    bench.say(
        "out-of-range",
        f64::from(out_of_range),
        Criterion::AtMost(0.0),
        "people outside their group's range",
    );
    Ok(())
}

pub(super) const NIST_GROUPS: Test = Test {
    name: "nist-groups",
    title: "Groups of three with different speeds stay together among others",
    about: "NIST Technical Note 1822, verification of group behaviour: eight groups of three (0.9, 1.2 and 1.5 m/s) and 24 people \
            alone walk 60 m in a corridor 8 m wide. Ours: from 10 s on, 95 % of the distances of members to the middle of \
            their group are at most 2 m, and the last of a group passes at most 4 s after its first.",
    run: groups,
    has_variants: true,
};

#[allow(clippy::cast_precision_loss, reason = "a few dozen people")]
fn groups(bench: &Bench<'_>) -> Result<(), Error> {
    let mut scene = corridor("groups", 90.0, 8.0, 90.0)?;
    scene.until = Some(1);
    for group in 0..8_u32 {
        for member in 0..3_u32 {
            let (column, row) = ((group / 4) as f32, (group % 4) as f32);
            let position = Vec2::new(1.5 + 6.0 * column, 0.7 + 2.0 * row + 0.6 * member as f32);
            let mut companions = [u32::MAX; 4];
            let others = (0..3).filter(|other| *other != member).map(|other| group * 3 + other);
            companions.iter_mut().zip(others).for_each(|(place, other)| *place = other);
            let goal = Vec2::new(75.0, position.y);
            let one = walker(
                position,
                [0.9, 1.2, 1.5][member as usize],
                vec![(goal, 2.0), (Vec2::new(88.0, position.y), 0.5)],
            );
            scene.walkers.push(Walker { companions, ..one });
        }
    }
    for i in 0..24_u32 {
        let position = Vec2::new(4.0 + 6.0 * (i / 12) as f32, 0.4 + 0.65 * (i % 12) as f32);
        scene.walkers.push(walker(
            position,
            1.34,
            vec![(Vec2::new(75.0, position.y), 2.0), (Vec2::new(88.0, position.y), 0.5)],
        ));
    }
    let run = bench.run(&scene)?;
    let (mut distances, mut spread) = (Vec::new(), 0.0_f64);
    for group in 0..8_u32 {
        let members = [0, 1, 2].map(|member| group * 3 + member);
        let mut passed = [f64::NAN; 3];
        for frame in 0..run.tracks.frames.len() {
            let [Some(a), Some(b), Some(c)] = members.map(|who| run.tracks.at(frame, who)) else { continue };
            for (time, at) in passed.iter_mut().zip([a, b, c]) {
                if time.is_nan() && at.x >= 61.5 + 6.0 * (group / 4) as f32 {
                    *time = frame as f64 / run.tracks.rate;
                }
            }
            if frame as f64 >= 10.0 * run.tracks.rate && passed.iter().all(|time| time.is_nan()) {
                let middle = (a + b + c) / 3.0;
                distances.extend([a, b, c].map(|at| f64::from(at.distance(middle))));
            }
        }
        let (first, last) = passed.iter().fold((f64::INFINITY, 0.0), |(first, last): (f64, f64), time| {
            (first.min(*time), if time.is_nan() { f64::NAN } else { last.max(*time) })
        });
        spread = if last.is_nan() || spread.is_nan() { f64::NAN } else { spread.max(last - first) };
    }
    bench.say("distance", quantile(&distances, 0.95), Criterion::AtMost(2.0), "m to the middle of the group");
    bench.say("spread", spread, Criterion::AtMost(4.0), "s between the first and the last of a group");
    Ok(())
}
