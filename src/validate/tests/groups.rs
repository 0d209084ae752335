//! Groups: people who belong together.

use super::super::judge::{Bench, Criterion, Draws, Origin, Test};
use super::super::measure::{Area, crossings_of, quantile};
use super::super::rooms::{Room, corridor, places, walker};
use super::super::scene::Walker;
use super::super::tracks::Tracks;
use crate::Error;
use glam::Vec2;
use std::ops::Range;

/// Makes one group of the walkers of a range, at most five.
fn join(walkers: &mut [Walker], members: Range<u32>) {
    for who in members.clone() {
        let others = members.clone().filter(|other| *other != who);
        let companions = &mut walkers[who as usize].companions;
        companions.iter_mut().zip(others).for_each(|(place, other)| *place = other);
    }
}

pub(super) const NIST_GROUPS: Test = Test {
    name: "nist-groups",
    title: "A group with one slow member leaves together, past a slow crowd",
    source: "NIST Technical Note 1822, 2.9; ISO 20414, test 14",
    about: "A room of 15 m by 20 m. A group of four at 1.25 m/s and one at 0.5 m/s crosses it, ten people at 0.2 m/s are in its way; \
            the group's first and last pass the exit within 10 s. As in JuPedSim's scene of it the exit is 1 m wide in the middle of the \
            short wall, the group starts in a corner opposite, and the ten in the middle of the room.",
    run: slow_member,
    draws: Draws::TurnedSeeds,
    grows: false,
};

fn slow_member(bench: &Bench<'_>) -> Result<(), Error> {
    const GROUP: u32 = 5;
    let room = Room { width: 15.0, depth: 20.0, door: 1.0, wall: 0.3 };
    let mut scene = room.scene("group", 240.0)?;
    // it ends when the group is out; the ten take longer
    scene.until = None;
    let start = places(Area::new([11.0, 16.5], [14.0, 19.5]), GROUP as usize, bench.lane(81));
    for (index, place) in start.into_iter().enumerate() {
        let speed = if index + 1 == GROUP as usize { 0.5 } else { 1.25 };
        scene.walkers.push(walker(place, speed, room.way_out(index, place)));
    }
    join(&mut scene.walkers, 0..GROUP);
    let others = places(Area::new([4.5, 9.0], [10.5, 13.0]), 10, bench.lane(83));
    for (index, place) in others.into_iter().enumerate() {
        scene.walkers.push(walker(place, 0.2, room.way_out(index + GROUP as usize, place)));
    }
    scene.seconds = 120.0;
    let run = bench.run(&scene)?;
    let [a, b] = room.line();
    let times = crossings_of(&run.tracks, 0..GROUP, a, b);
    let all = times.len() == GROUP as usize;
    let apart =
        times.first().zip(times.last()).filter(|_| all).map_or(f64::NAN, |(first, last)| last - first);
    let source = Origin::Source("NIST TN 1822, 2.9");
    bench.judge("apart", apart, Criterion::AtMost(10.0), "s between the first and the last", source);
    bench.never("outside", run.outside as usize, "places outside the walls", Origin::Ours);
    Ok(())
}

pub(super) const GROUPS: Test = Test {
    name: "groups",
    title: "Groups of three with different speeds stay together among others",
    source: "Ours",
    about: "Eight groups of three (0.9, 1.2 and 1.5 m/s) and 24 people alone walk 60 m in a corridor 8 m wide. From 10 s on, 95 % of \
            the distances of members to the middle of their group are at most 2 m, and the last of a group passes at most 4 s after \
            its first.",
    run: among_others,
    draws: Draws::TurnedSeeds,
    grows: true,
};

/// How far apart two groups start along the corridor, m, and where they are timed.
const BEHIND: f32 = 6.0;
const LINE: f32 = 61.5;

#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "a few dozen people")]
fn among_others(bench: &Bench<'_>) -> Result<(), Error> {
    let (groups, alone) = (bench.people(8), bench.people(24));
    let first_column = BEHIND * (groups.div_ceil(4) - 2) as f32;
    let mut scene = corridor("groups", 90.0 + first_column, 8.0, 90.0)?;
    scene.until = Some(1);
    let far = 75.0 + first_column;
    let way = |z: f32| vec![(Vec2::new(far, z), 2.0), (Vec2::new(far + 13.0, z), 0.5)];
    let moved = |index: usize| 0.2 * (super::super::rooms::unit(index, bench.lane(91)) - 0.5);
    for group in 0..groups {
        for (member, speed) in [0.9, 1.2, 1.5].into_iter().enumerate() {
            let (column, row) = ((group / 4) as f32, (group % 4) as f32);
            let index = 3 * group + member;
            let z = 0.7 + 2.0 * row + 0.6 * member as f32 + moved(index);
            scene.walkers.push(walker(Vec2::new(1.5 + BEHIND * column, z), speed, way(z)));
        }
        let first = 3 * group as u32;
        join(&mut scene.walkers, first..first + 3);
    }
    for i in 0..alone {
        let z = 0.4 + 0.65 * (i % 12) as f32 + 0.5 * moved(3 * groups + i);
        scene.walkers.push(walker(Vec2::new(4.0 + BEHIND * (i / 12) as f32, z), 1.34, way(z)));
    }
    let run = bench.run(&scene)?;
    let (mut distances, mut spread) = (Vec::new(), 0.0_f64);
    for group in 0..groups {
        let (far, apart) = together(&run.tracks, 3 * group as u32, LINE + BEHIND * (group / 4) as f32);
        distances.extend(far);
        spread = if apart.is_nan() || spread.is_nan() { f64::NAN } else { spread.max(apart) };
    }
    let far = quantile(&distances, 0.95);
    bench.judge("distance", far, Criterion::AtMost(2.0), "m to the middle of the group", Origin::Ours);
    bench.judge(
        "spread",
        spread,
        Criterion::AtMost(4.0),
        "s between the first and the last of a group",
        Origin::Ours,
    );
    Ok(())
}

/// Distances of the three from `first` on to their middle, from 10 s until one has passed x = `line`, m; and the time from the
/// first to the last there, s.
#[allow(clippy::cast_precision_loss, reason = "frames")]
fn together(tracks: &Tracks, first: u32, line: f32) -> (Vec<f64>, f64) {
    let members = [first, first + 1, first + 2];
    let (mut distances, mut passed) = (Vec::new(), [f64::NAN; 3]);
    for frame in 0..tracks.frames.len() {
        let [Some(a), Some(b), Some(c)] = members.map(|who| tracks.at(frame, who)) else { continue };
        for (time, at) in passed.iter_mut().zip([a, b, c]) {
            if time.is_nan() && at.x >= line {
                *time = frame as f64 / tracks.rate;
            }
        }
        if frame as f64 >= 10.0 * tracks.rate && passed.iter().all(|time| time.is_nan()) {
            let middle = (a + b + c) / 3.0;
            distances.extend([a, b, c].map(|at| f64::from(at.distance(middle))));
        }
    }
    let [a, b, c] = passed;
    // a time that is no number makes the difference none
    let apart =
        if passed.iter().any(|time| time.is_nan()) { f64::NAN } else { a.max(b).max(c) - a.min(b).min(c) };
    (distances, apart)
}
