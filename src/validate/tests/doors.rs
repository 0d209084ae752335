//! Rooms with doors: how long it takes to leave, where people jam, how many pass a second.

use super::super::files;
use super::super::judge::{Bench, Criterion, Draws, Origin, Test};
use super::super::measure::{Area, classic_density, crossings, flow, mean};
use super::super::rooms::{Room, places, unit, walker};
use super::super::scene::Experiment;
use super::super::tracks::Tracks;
use super::single::speeds;
use crate::Error;
use crate::export::chart::{Curve, Plot, Stroke};
use glam::Vec2;

const BLUE: [u8; 3] = [66, 118, 190];
const RED: [u8; 3] = [200, 66, 52];

/// Free walking speed, m/s (Weidmann 1993).
const FREE: f32 = 1.34;

/// Mean density, people/m², and speed, m/s, in an area over some frames (from, to); NaN where it is empty.
fn crowd_in(tracks: &Tracks, area: Area, frames: [f64; 2]) -> (f64, f64) {
    let (mut densities, mut speeds) = (Vec::new(), Vec::new());
    for (frame, people) in tracks.frames.iter().enumerate() {
        if (frames[0]..frames[1]).contains(&number(frame)) {
            densities.push(classic_density(people.iter().map(|p| p.1), area));
            let inside = people.iter().filter(|p| area.contains(p.1));
            let moving = inside.filter_map(|p| tracks.velocity(frame, p.0, 0.3));
            speeds.extend(moving.map(|v| f64::from(v.length())));
        }
    }
    let known = |sample: &[f64]| if sample.is_empty() { f64::NAN } else { mean(sample) };
    (known(&densities), known(&speeds))
}

/// `count` people anywhere in a room, at least 0.5 m from the wall with the door; `lane` is their stream of places.
fn fill(scene: &mut Experiment, room: &Room, count: usize, speed: f32, lane: u32) {
    let area = Area::new([0.3, 0.5], [room.width - 0.3, room.depth - 0.3]);
    for (index, place) in places(area, count, lane).into_iter().enumerate() {
        scene.walkers.push(walker(place, speed, room.way_out(index, place)));
    }
}

#[allow(clippy::cast_precision_loss, reason = "thousands of people")]
fn number(count: usize) -> f64 {
    count as f64
}

/// When everyone is out, s; NaN if one is not.
fn emptied(times: &[f64], count: usize) -> f64 {
    if times.len() == count { times.last().copied().unwrap_or(0.0) } else { f64::NAN }
}

pub(super) const RIMEA_8: Test = Test {
    name: "rimea-8",
    title: "A room empties sooner with faster people and a wider door, later with more people",
    source: "After RiMEA 4.1.1, test 8 (p. 31)",
    about: "The source varies one parameter at a time in a house of three storeys, and has no bound. Here a room of 8 m by 8 m: speeds of \
            0.6 to 1.8 m/s, doors of 0.8 to 2.4 m, 80 to 20 people, each the mean of three runs; every step must shorten the time (ours). \
            A spread of speeds about the same mean, 0.5 to 1.0 and 0.25 to 1.25 m/s about 0.75, is shown.",
    run: study,
    draws: Draws::Seeds,
    grows: false,
};

/// The mean time, s, of three runs in which `count` people of these speeds leave by the door; everyone's speed is drawn evenly.
fn leaving(bench: &Bench<'_>, door: f32, count: usize, [least, most]: [f32; 2]) -> Result<f64, Error> {
    let room = Room { width: 8.0, depth: 8.0, door, wall: 0.3 };
    let mut times = Vec::new();
    for run in 0..3 {
        let mut scene = room.scene("study", 240.0)?;
        fill(&mut scene, &room, count, FREE, bench.lane(11 + 20 * run));
        for (index, walker) in scene.walkers.iter_mut().enumerate() {
            walker.speed = least + (most - least) * unit(index, bench.lane(13 + 20 * run));
        }
        let [a, b] = room.line();
        times.push(emptied(&crossings(&bench.run(&scene)?.tracks, a, b), count));
    }
    Ok(mean(&times))
}

fn study(bench: &Bench<'_>) -> Result<(), Error> {
    let all = |times: [Result<f64, Error>; 4]| times.into_iter().collect::<Result<Vec<_>, _>>();
    let studies = [
        ("speed", all([0.6, 0.9, 1.3, 1.8].map(|speed| leaving(bench, 1.2, 40, [speed; 2])))?),
        ("door", all([0.8, 1.2, 1.8, 2.4].map(|door| leaving(bench, door, 60, [1.3; 2])))?),
        ("people", all([80, 60, 40, 20].map(|count| leaving(bench, 1.2, count, [1.3; 2])))?),
    ];
    for (name, times) in studies {
        // a time that is no number is no right step
        let right = times.windows(2).filter(|pair| pair[1] < pair[0]).count();
        let wrong = number(times.len() - 1 - right);
        bench.judge(&format!("{name}-wrong-steps"), wrong, Criterion::AtMost(0.0), "steps", Origin::Ours);
    }
    for (name, speeds) in [("0", [0.75; 2]), ("0.25", [0.5, 1.0]), ("0.5", [0.25, 1.25])] {
        bench.report(&format!("time-spread-{name}"), leaving(bench, 1.2, 40, speeds)?, "s");
    }
    Ok(())
}

pub(super) const RIMEA_9: Test = Test {
    name: "rimea-9",
    title: "1,000 people leave a hall by four exits of 1 m, then by two",
    source: "After RiMEA 3.0.0 and 4.1.1, test 9 (p. 34)",
    about: "With two of the four exits closed it takes approximately twice as long; the guideline has no bound, 1.6 to 2.4 times is \
            JuPedSim's. A hall of 30 m by 20 m (the figure of 4.1.1 has 20 m by 20 m); free speeds after Weidmann (1993), normal, 1.34 m/s, \
            deviation 0.26. At the measured flows of doors, 250 people take 90 to 146 s a door: shown.",
    run: public_space,
    draws: Draws::TurnedSeeds,
    grows: true,
};

/// The hall at x 0 to `length`, z 0 to 20 in a yard; exits in its long walls.
fn hall(
    length: f32,
    exits: &[(f32, f32)],
    people: &[(Vec2, f32)],
    seconds: f32,
) -> Result<Experiment, Error> {
    const WALL: f32 = 0.3;
    const EXIT: f32 = 0.5;
    let far = length + 12.0;
    let mut scene =
        Experiment::new("hall", &[[-12.0, -17.0], [far, -17.0], [far, 37.0], [-12.0, 37.0]], seconds)?;
    scene.until = Some(2);
    let mut wall = |x: [f32; 2], z: [f32; 2]| {
        scene.solid(&[[x[0], z[0]], [x[1], z[0]], [x[1], z[1]], [x[0], z[1]]]);
    };
    wall([-WALL, 0.0], [-WALL, 20.0 + WALL]);
    wall([length, length + WALL], [-WALL, 20.0 + WALL]);
    for z in [-WALL, 20.0] {
        let mut from = 0.0;
        for &(x, _) in exits.iter().filter(|exit| (exit.1 < 10.0) == (z < 10.0)) {
            wall([from, x - EXIT], [z, z + WALL]);
            from = x + EXIT;
        }
        wall([from, length], [z, z + WALL]);
    }
    for (index, &(place, speed)) in people.iter().enumerate() {
        let nearest = exits.iter().min_by(|a, b| {
            let distance = |exit: &&(f32, f32)| place.distance(Vec2::new(exit.0, exit.1));
            distance(a).total_cmp(&distance(b))
        });
        let Some(&(x, z)) = nearest else { continue };
        let out = if z < 10.0 { -1.0 } else { 1.0 };
        let goal = Vec2::new(x + 14.0 * (unit(index, 5) - 0.5), z + out * (5.0 + 10.0 * unit(index, 6)));
        let way =
            vec![(Vec2::new(x, z - 0.1 * out), EXIT + 0.3), (Vec2::new(x, z + out * 0.9), 0.9), (goal, 0.5)];
        scene.walkers.push(walker(place, speed, way));
    }
    Ok(scene)
}

fn public_space(bench: &Bench<'_>) -> Result<(), Error> {
    let (count, length) = (bench.people(if bench.is_quick { 200 } else { 1000 }), bench.along(30.0));
    let places = places(Area::new([0.3, 0.5], [length - 0.3, 19.5]), count, bench.lane(21));
    let people: Vec<(Vec2, f32)> = places.into_iter().zip(speeds(bench.seed, count)?).collect();
    let (left, right) = (0.25 * length, 0.75 * length);
    let four = [(left, 0.0), (right, 0.0), (left, 20.0), (right, 20.0)];
    let mut times = Vec::new();
    let (mut outside, mut curves) = (0, Vec::new());
    for (exits, color) in [(&four[..], BLUE), (&four[..2], RED)] {
        let scene = hall(length, exits, &people, 1400.0)?;
        let run = bench.run(&scene)?;
        let mut out: Vec<f64> = Vec::new();
        for z in [-0.3, 20.3] {
            let (left, right) = (Vec2::new(-0.5, z), Vec2::new(length + 0.5, z));
            out.extend(if z < 0.0 {
                crossings(&run.tracks, left, right)
            } else {
                crossings(&run.tracks, right, left)
            });
        }
        out.sort_by(f64::total_cmp);
        times.push(emptied(&out, count));
        outside += run.outside;
        let points = out.iter().enumerate().map(|(n, t)| [*t, number(n + 1)]).collect();
        curves.push(Curve { name: format!("{} exits", exits.len()), points, stroke: Stroke::Line, color });
    }
    bench.report("time-4-exits", times[0], "s");
    bench.judge(
        "ratio",
        times[1] / times[0],
        Criterion::Within(1.6, 2.4),
        "times as long with two exits",
        Origin::Source("JuPedSim, RiMEA 9"),
    );
    bench.never("outside", outside as usize, "places outside the walls", Origin::Ours);
    bench.draw("rimea-9", || Plot {
        title: format!("RiMEA 9: {count} people leave a hall"),
        axes: ["time, s".into(), "people outside".into()],
        curves,
        note: "Four exits of 1 m, then two of them.".into(),
    });
    Ok(())
}

pub(super) const RIMEA_12: Test = Test {
    name: "rimea-12",
    title: "A jam before the first of two bottlenecks, none before the second",
    source: "RiMEA 3.0.0, test 12",
    about: "150 people in the far half of a room of 10 m by 10 m, a passage 1 m wide and 5 m long, a second such room with an exit of 1 m: \
            congestion in the first room only; the guideline has no bound. Ours: before the passage at least 1.5 people/m², before the \
            exit at most 1.0 people/m² at 0.8 of the free speed or more. JuPedSim's: the exit passes at most 0.05 people/s more than \
            the passage.",
    run: two_bottlenecks,
    draws: Draws::TurnedSeeds,
    grows: true,
};

/// Both rooms, a passage 1 m wide and 5 m long between them, and a yard; the first lies at x `near` to 10.
fn two_rooms(near: f32) -> [[f32; 2]; 20] {
    [
        [near, 0.0],
        [10.0, 0.0],
        [10.0, 4.5],
        [15.0, 4.5],
        [15.0, 0.0],
        [25.0, 0.0],
        [25.0, 4.5],
        [25.3, 4.5],
        [25.3, -10.0],
        [45.0, -10.0],
        [45.0, 20.0],
        [25.3, 20.0],
        [25.3, 5.5],
        [25.0, 5.5],
        [25.0, 10.0],
        [15.0, 10.0],
        [15.0, 5.5],
        [10.0, 5.5],
        [10.0, 10.0],
        [near, 10.0],
    ]
}

fn two_bottlenecks(bench: &Bench<'_>) -> Result<(), Error> {
    let count = bench.people(if bench.is_quick { 80 } else { 150 });
    let near = 10.0 - bench.along(10.0);
    let mut scene = Experiment::new("bottlenecks", &two_rooms(near), 400.0)?;
    scene.until = Some(4);
    for (index, place) in
        places(Area::new([near + 0.3, 0.3], [0.5 * (near + 10.0), 9.7]), count, bench.lane(31))
            .into_iter()
            .enumerate()
    {
        let goal = Vec2::new(34.0 + 10.0 * unit(index, 8), -9.0 + 28.0 * unit(index, 9));
        let way = vec![
            (Vec2::new(9.9, 5.0), 0.8),
            (Vec2::new(15.6, 5.0), 0.8),
            (Vec2::new(24.9, 5.0), 0.8),
            (Vec2::new(25.9, 5.0), 0.8),
            (goal, 0.5),
        ];
        scene.walkers.push(walker(place, FREE, way));
    }
    let run = bench.run(&scene)?;
    let first = crossings(&run.tracks, Vec2::new(10.0, 4.4), Vec2::new(10.0, 5.6));
    let last = crossings(&run.tracks, Vec2::new(25.3, 4.4), Vec2::new(25.3, 5.6));
    let before = |area: Area, times: &[f64]| {
        let frame = |t: f64| (t * run.tracks.rate).max(0.0);
        let (from, to) =
            (times.first().copied().unwrap_or(0.0), times.get(times.len() * 8 / 10).copied().unwrap_or(0.0));
        crowd_in(&run.tracks, area, [frame(from), frame(to)])
    };
    let (before_first, _) = before(Area::new([8.0, 4.0], [10.0, 6.0]), &first);
    let (before_last, speed) = before(Area::new([23.0, 4.0], [25.0, 6.0]), &last);
    let jupedsim = Origin::Source("JuPedSim, RiMEA 12");
    bench.never("not-out", count - last.len().min(count), "people", Origin::Ours);
    bench.judge("density-first", before_first, Criterion::AtLeast(1.5), "people/m²", Origin::Ours);
    bench.judge("density-last", before_last, Criterion::AtMost(1.0), "people/m²", Origin::Ours);
    let share = speed / f64::from(FREE);
    bench.judge("speed-last", share, Criterion::AtLeast(0.8), "of the free speed", Origin::Ours);
    let more = flow(&last) - flow(&first);
    bench.judge("flow-last", more, Criterion::AtMost(0.05), "people/s more than the first", jupedsim);
    bench.never("outside", run.outside as usize, "places outside the walls", Origin::Ours);
    Ok(())
}

pub(super) const RIMEA_12B: Test = Test {
    name: "rimea-12b",
    title: "A long bottleneck takes no less time than a short one",
    source: "After RiMEA 4.1.1, tests 12b and 12d (p. 37 to 41)",
    about: "100 people leave a room of 8 m by 5 m by a passage 1 m wide and 0.2 m, then 5 m long: the longer one is slower. Of \
            passages 0.8, 1.0 and 1.2 m wide and 0.3 m long, the wider one passes more people a second.",
    run: passages,
    draws: Draws::TurnedSeeds,
    grows: true,
};

fn passages(bench: &Bench<'_>) -> Result<(), Error> {
    let count = bench.people(if bench.is_quick { 50 } else { 100 });
    let leave = |door: f32, wall: f32| -> Result<Vec<f64>, Error> {
        let room = Room { width: 5.0, depth: bench.along(8.0), door, wall };
        let mut scene = room.scene("passage", 400.0)?;
        fill(&mut scene, &room, count, FREE, bench.lane(11));
        let [a, b] = room.line();
        Ok(crossings(&bench.run(&scene)?.tracks, a, b))
    };
    let longer = emptied(&leave(1.0, 5.0)?, count) - emptied(&leave(1.0, 0.2)?, count);
    bench.judge(
        "longer",
        longer,
        Criterion::AtLeast(0.0),
        "s more for the long one",
        Origin::Source("RiMEA 4.1.1, 12b"),
    );
    let mut flows = Vec::new();
    for door in [0.8, 1.0, 1.2] {
        let times = leave(door, 0.3)?;
        flows.push(if times.len() == count { flow(&times) } else { f64::NAN });
    }
    let wider = flows.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let wider = if flows.iter().any(|flow| flow.is_nan()) { f64::NAN } else { wider };
    bench.judge(
        "wider",
        wider,
        Criterion::AtLeast(0.0),
        "people/s more by the next width",
        Origin::Source("RiMEA 4.1.1, 12d"),
    );
    Ok(())
}

pub(super) const NIST_CONGESTION: Test = Test {
    name: "nist-congestion",
    title: "Where more people come than pass, they queue, and the queue dissolves",
    source: "NIST Technical Note 1822, 5.1, without its stair; ISO 20414, test 10",
    about: "100 people in a room of 8 m by 5 m leave by an opening as wide as the corridor of 2 m behind it: they queue before the \
            opening, and walk steadily behind it. By JuPedSim's areas: while the middle half pass, people are denser before the \
            opening (2 m by 0.5 m) than in the corridor (2 m by 2 m). Ours: everyone gets out.",
    run: congestion,
    draws: Draws::TurnedSeeds,
    grows: true,
};

fn congestion(bench: &Bench<'_>) -> Result<(), Error> {
    let count = bench.people(if bench.is_quick { 60 } else { 100 });
    let room = Room { width: 5.0, depth: bench.along(8.0), door: 2.0, wall: 10.0 };
    let start = Area::new([0.3, 0.3], [4.7, room.depth - 0.3]);
    let mut scene = room.scene("congestion", 300.0)?;
    for (index, place) in places(start, count, bench.lane(11)).into_iter().enumerate() {
        // straight along the corridor, on the side that they come from
        let x = room.middle() + (place.x - room.middle()) * 0.28;
        let ways = room.way_out(index, place);
        let mut way = vec![(Vec2::new(x, 0.0), 1.0), (Vec2::new(x, -room.wall - 0.5), 1.0)];
        way.extend(ways.last());
        scene.walkers.push(walker(place, FREE, way));
    }
    let run = bench.run(&scene)?;
    let times = crossings(&run.tracks, Vec2::new(1.4, 0.0), Vec2::new(3.6, 0.0));
    let at = |share: usize| times.get(times.len() * share / 4).copied().unwrap_or(0.0) * run.tracks.rate;
    let (queue, _) = crowd_in(&run.tracks, Area::new([1.5, 0.0], [3.5, 0.5]), [at(1), at(3)]);
    let (corridor, speed) = crowd_in(&run.tracks, Area::new([1.5, -6.0], [3.5, -4.0]), [at(1), at(3)]);
    bench.report("density-corridor", corridor, "people/m²");
    bench.report("speed-corridor", speed, "m/s");
    bench.judge(
        "density",
        queue / corridor,
        Criterion::AtLeast(1.0),
        "times that in the corridor",
        Origin::Source("JuPedSim, ISO 20414, 10"),
    );
    bench.never("not-out", count - times.len().min(count), "people", Origin::Ours);
    Ok(())
}

pub(super) const NIST_MAXIMUM_FLOW: Test = Test {
    name: "nist-maximum-flow",
    title: "Doors of 0.8, 1.0 and 1.2 m pass as many people as real ones, and no more",
    source: "NIST Technical Note 1822, 5.2; ISO 20414, test 11; measured doors",
    about: "100 people leave a room of 8 m by 5 m. Judged by what was measured: 1.29 to 1.74 people/s at 0.8 m, 1.71 to 2.77 at 1.0 m, \
            2.03 to 2.75 at 1.2 m (Kretz 2006, Seyfried 2009 and of 2006, Müller 1981, Nagai 2006, Daamen 2010). NIST asks for at most \
            1.33 people/(m s), the flow of plans (IMO MSC/Circ.1238). Every measured door passes more, so that is shown and not judged.",
    run: maximum_flow,
    draws: Draws::TurnedSeeds,
    grows: true,
};

fn maximum_flow(bench: &Bench<'_>) -> Result<(), Error> {
    let count = bench.people(if bench.is_quick { 50 } else { 100 });
    let mut points = Vec::new();
    for (door, [least, most]) in [(0.8_f32, [1.29, 1.74]), (1.0, [1.71, 2.77]), (1.2, [2.03, 2.75])] {
        let room = Room { width: 5.0, depth: bench.along(8.0), door, wall: 0.3 };
        let mut scene = room.scene("door", 300.0)?;
        fill(&mut scene, &room, count, FREE, bench.lane(11));
        let [a, b] = room.line();
        let times = crossings(&bench.run(&scene)?.tracks, a, b);
        let found = if times.len() == count { flow(&times) } else { f64::NAN };
        points.push([f64::from(door), found]);
        let name = format!("door-{door}");
        let measured = Origin::Source("measured: Kretz, Seyfried, Müller, Nagai, Daamen");
        bench.judge(&name, found, Criterion::Within(least, most), "people/s", measured);
        let per_metre = found / f64::from(door);
        bench.report(&format!("{name}-per-metre"), per_metre, "people/(m s); NIST: at most 1.33");
    }
    bench.draw("nist-maximum-flow", || {
        let line = |name: &str, flow: f64, color| Curve {
            name: name.into(),
            points: vec![[0.0, 0.0], [1.4, 1.4 * flow]],
            stroke: Stroke::Dashed,
            color,
        };
        Plot {
            title: "Flow through doors".into(),
            axes: ["width, m".into(), "people a second".into()],
            curves: vec![
                line("NIST, at most 1.33 per m", 1.33, [128, 128, 128]),
                line("Seyfried 2009, 1.9 per m", 1.9, RED),
                Curve { name: "gaitway".into(), points, stroke: Stroke::Points, color: BLUE },
            ],
            note: format!("{count} people in a room 5 m wide."),
        }
    });
    Ok(())
}

pub(super) const JUELICH_BOTTLENECK: Test = Test {
    name: "juelich-bottleneck",
    title: "75 people pass a door of 0.5 m as in the experiment of Jülich",
    source: "Recording 040_c_56_h- (Forschungszentrum Jülich)",
    about: "Everyone starts where they stood in the experiment. The recording's flow is 1.148 people/s; to 10 % of it is ours.",
    run: juelich,
    draws: Draws::TurnedSeeds,
    grows: false,
};

fn juelich(bench: &Bench<'_>) -> Result<(), Error> {
    let Some(path) = bench.file("crowd-juelich/bottleneck/040_c_56_h-.txt") else { return Ok(()) };
    let real = files::juelich(&path, 1.0, 25.0).map_err(super::super::unusable)?;
    let line = [Vec2::new(-0.5, 0.0), Vec2::new(0.5, 0.0)];
    let measured = crossings(&real, line[0], line[1]);
    let start = real.frames.first().cloned().unwrap_or_default();
    let room = Room { width: 6.0, depth: 7.0, door: 0.5, wall: 0.1 };
    let mut scene = room.scene("juelich", 200.0)?;
    let shift = Vec2::new(room.middle(), 0.0);
    for (index, &(_, at)) in start.iter().enumerate() {
        let position = (at + shift).max(Vec2::new(0.25, 0.25));
        scene.walkers.push(walker(position, FREE, room.way_out(index, position)));
    }
    let times = crossings(&bench.run(&scene)?.tracks, line[0] + shift, line[1] + shift);
    let found = if times.len() == start.len() { flow(&times) } else { f64::NAN };
    let real = flow(&measured);
    bench.judge("flow", found, Criterion::Within(0.9 * real, 1.1 * real), "people/s", Origin::Ours);
    bench.report("flow-measured", real, "people/s");
    bench.draw("juelich-bottleneck", || {
        let curve = |name: &str, times: &[f64], stroke, color| Curve {
            name: name.into(),
            points: times.iter().enumerate().map(|(n, t)| [t - times[0], number(n + 1)]).collect(),
            stroke,
            color,
        };
        Plot {
            title: "75 people at a door of 0.5 m".into(),
            axes: ["time since the first, s".into(), "people past the door".into()],
            curves: vec![
                curve("Jülich", &measured, Stroke::Dashed, RED),
                curve("gaitway", &times, Stroke::Line, BLUE),
            ],
            note: "Data: Forschungszentrum Jülich, IAS-7.".into(),
        }
    });
    Ok(())
}
