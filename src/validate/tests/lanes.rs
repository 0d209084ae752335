//! Two streams against one another.

use super::super::judge::{Bench, Criterion, Draws, Origin, Test};
use super::super::measure::{Area, crossings_of, lane_order, mean};
use super::super::rooms::{corridor, places, walker};
use super::super::scene::{Experiment, Run};
use crate::Error;
use crate::export::chart::{Curve, Plot, Stroke};
use crate::reference::exact::hash_u32;
use glam::Vec2;

const BLUE: [u8; 3] = [66, 118, 190];

pub(super) const LANES: Test = Test {
    name: "lanes",
    title: "Two opposite streams part into lanes",
    source: "Observed: Helbing et al. 2005, Zhang et al. 2012; recording bi_corr_400_b_03 (Forschungszentrum Jülich)",
    about: "Two groups of 90 people, 1 person/m², walk through one another in a corridor 4 m wide, keeping to no side of it. The order \
            parameter (after Rex and Löwen 2007, over those within 0.4 m to either side and 3 m along; 1 is perfect) is taken where both \
            are, from 8 to 20 s. The recording, measured the same way, has 0.91, its least tenth 0.75, and 0.39 with directions shuffled. \
            Ours: at least 0.75, and at least 0.6 of the way from the shuffled order to 1.",
    run: lanes,
    draws: Draws::TurnedSeeds,
    grows: true,
};

/// Order parameter of a frame: the middle of the corridor in pieces of 3 m.
fn order(run: &Run, frame: usize, first_west: u32, is_shuffled: bool) -> Option<f64> {
    let people = run.tracks.frames.get(frame)?;
    let mut found = Vec::new();
    for k in 0..8_u8 {
        let from = 78.0 + 3.0 * f32::from(k);
        let mut here: Vec<(f64, f64)> = people
            .iter()
            .filter(|person| (from..from + 3.0).contains(&person.1.x))
            .map(|&(who, at)| (f64::from(at.y), if who < first_west { 1.0 } else { -1.0 }))
            .collect();
        if is_shuffled {
            shuffle(&mut here, frame);
        }
        let east = here.iter().filter(|person| person.1 > 0.0).count();
        // a piece in which only one stream is has no lanes to speak of
        if here.len() >= 6 && (2..=here.len() - 2).contains(&east) {
            found.push(lane_order(&here, 0.4));
        }
    }
    (!found.is_empty()).then(|| mean(&found))
}

/// Shuffles which agent goes where.
#[allow(clippy::cast_possible_truncation, reason = "a few dozen people, hundreds of frames")]
fn shuffle(people: &mut [(f64, f64)], frame: usize) {
    for i in (1..people.len()).rev() {
        let other = hash_u32((i * 7919 + frame * 104_729) as u32) as usize % (i + 1);
        (people[i].1, people[other].1) = (people[other].1, people[i].1);
    }
}

/// The corridor with both groups; `others` says whether the second one is there.
fn streams(bench: &Bench<'_>, count: usize, has_others: bool) -> Result<Experiment, Error> {
    // so far away that everyone walks along the corridor and keeps to no side of it
    const FAR: f32 = 1e4;
    let long = bench.along(25.0);
    let mut scene = corridor("lanes", 200.0, 4.0, 48.0 + 0.6 * (long - 25.0))?;
    for place in places(Area::new([90.0 - long, 0.3], [90.0, 3.7]), count, bench.lane(61)) {
        scene.walkers.push(walker(place, 1.34, vec![(Vec2::new(FAR, 2.0), 1.0)]));
    }
    let others = if has_others { count } else { 0 };
    for place in places(Area::new([90.0, 0.3], [90.0 + long, 3.7]), others, bench.lane(71)) {
        scene.walkers.push(walker(place, 1.34, vec![(Vec2::new(-FAR, 2.0), 1.0)]));
    }
    Ok(scene)
}

#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "a few hundred people and frames"
)]
fn lanes(bench: &Bench<'_>) -> Result<(), Error> {
    let count = bench.people(if bench.is_quick { 60 } else { 90 });
    let run = bench.run(&streams(bench, count, true)?)?;
    let frames = run.tracks.frames.len();
    let course = |is_shuffled: bool| -> Vec<[f64; 2]> {
        let at = |frame: usize| {
            Some([frame as f64 / run.tracks.rate, order(&run, frame, count as u32, is_shuffled)?])
        };
        (0..frames).step_by(5).filter_map(at).collect()
    };
    let (points, shuffled) = (course(false), course(true));
    let between = |points: &[[f64; 2]], low: f64, high: f64| {
        mean(&points.iter().filter(|p| p[0] >= low && p[0] < high).map(|p| p[1]).collect::<Vec<_>>())
    };
    let time = |run: &Run| {
        let past = crossings_of(&run.tracks, 0..count as u32, Vec2::new(105.0, -0.1), Vec2::new(105.0, 4.1));
        past.get(count * 3 / 4).copied().unwrap_or(f64::NAN)
    };
    let alone = bench.run(&streams(bench, count, false)?)?;
    let (order, chance) = (between(&points, 8.0, 20.0), between(&shuffled, 8.0, 20.0));
    bench.report("order-at-start", between(&points, 0.0, 6.0), "");
    bench.report("order-shuffled", chance, "");
    bench.judge("order", order, Criterion::AtLeast(0.75), "(1 is perfect)", Origin::Ours);
    let above = (order - chance) / (1.0 - chance);
    let unit = "of the way from the shuffled order to 1";
    bench.judge("order-above-chance", above, Criterion::AtLeast(0.6), unit, Origin::Ours);
    bench.report("time", time(&run) / time(&alone), "times that without the others, for three in four");
    bench.never("outside", run.outside as usize, "places outside the walls", Origin::Ours);
    bench.draw("lanes", || Plot {
        title: "Lanes in counter-flow".into(),
        axes: ["time, s".into(), "order parameter".into()],
        curves: vec![Curve { name: "gaitway".into(), points, stroke: Stroke::Line, color: BLUE }],
        note: format!("{count} people each way in a corridor 4 m wide."),
    });
    Ok(())
}

pub(super) const NIST_COUNTER_FLOW: Test = Test {
    name: "nist-counter-flow",
    title: "People who come the other way slow a crowd down, and none is stuck",
    source: "NIST Technical Note 1822, 2.8; ISO 20414, test 6; IMO test 8",
    about: "Two rooms of 10 m by 10 m, a passage of 2 m by 10 m between them; 100 people go over while 0, 10, 50, 100 come back. The time \
            rises with the number coming back; NIST states no figure. At the 1.0 to 1.5 people/(m s) of measured counter-flow (Jülich, \
            bi_corr_400_b_03; Zhang et al. 2012) 100 against 100 take 75 to 110 s. Ours: at most twice that, 200 s, 150 s with 50, and \
            all arrive.",
    run: counter_flow,
    draws: Draws::TurnedSeeds,
    grows: true,
};

/// Number of people coming back, for a hundred going over.
const BACK: [usize; 4] = [0, 10, 50, 100];

#[allow(clippy::cast_possible_truncation, reason = "some hundred people")]
fn counter_flow(bench: &Bench<'_>) -> Result<(), Error> {
    let (count, back) = if bench.is_quick { (40, &[0, 20][..]) } else { (bench.people(100), &BACK[..]) };
    let room = bench.along(10.0);
    let (near, far) = (10.0 - room, 20.0 + room);
    let outline = [
        [near, 0.0],
        [10.0, 0.0],
        [10.0, 4.0],
        [20.0, 4.0],
        [20.0, 0.0],
        [far, 0.0],
        [far, 10.0],
        [20.0, 10.0],
        [20.0, 6.0],
        [10.0, 6.0],
        [10.0, 10.0],
        [near, 10.0],
    ];
    let (west, east) = (Area::new([near + 0.3, 0.3], [8.5, 9.7]), Area::new([21.5, 0.3], [far - 0.3, 9.7]));
    let (mut times, mut missing, mut outside) = (Vec::new(), 0, 0);
    for &others in back {
        let others = bench.people(others);
        let mut scene = Experiment::new("counter-flow", &outline, 600.0)?;
        scene.until = Some(3);
        let mut add = |from: Area, to: Area, count: usize, east: bool, lane: u32| {
            let ends = places(to, count, bench.lane(lane + 2));
            for (place, end) in places(from, count, bench.lane(lane)).into_iter().zip(ends) {
                let points = if east { [9.6, 19.4, 20.6] } else { [20.6, 10.6, 9.4] };
                // on the side of the passage that they come from
                let z = 5.0 + (place.y - 5.0) * 0.12;
                let mut way: Vec<(Vec2, f32)> = points.into_iter().map(|x| (Vec2::new(x, z), 1.0)).collect();
                way.push((end, 0.5));
                scene.walkers.push(walker(place, 1.34, way));
            }
        };
        add(west, east, count, true, 41);
        add(east, west, others, false, 51);
        let run = bench.run(&scene)?;
        let first = count as u32;
        let over = crossings_of(&run.tracks, 0..first, Vec2::new(20.0, 3.9), Vec2::new(20.0, 6.1));
        let came = crossings_of(&run.tracks, first..u32::MAX, Vec2::new(10.0, 6.1), Vec2::new(10.0, 3.9));
        missing += count.saturating_sub(over.len()) + others.saturating_sub(came.len());
        times.push(if over.len() == count { over.last().copied().unwrap_or(0.0) } else { f64::NAN });
        outside += run.outside as usize;
    }
    for (others, time) in back.iter().zip(&times) {
        let name = format!("time-{others}");
        match others {
            50 => bench.judge(&name, *time, Criterion::AtMost(150.0), "s", Origin::Ours),
            100 => bench.judge(&name, *time, Criterion::AtMost(200.0), "s", Origin::Ours),
            _ => bench.report(&name, *time, "s"),
        }
    }
    let rise = times.first().zip(times.last()).map_or(f64::NAN, |(none, most)| most - none);
    let source = Origin::Source("NIST TN 1822, 2.8");
    // the source says that it rises: any rise is one
    bench.judge("rise", rise, Criterion::AtLeast(0.1), "s from none to most", source);
    bench.never("missing", missing, "people", Origin::Ours);
    bench.never("outside", outside, "places outside the walls", Origin::Ours);
    Ok(())
}
