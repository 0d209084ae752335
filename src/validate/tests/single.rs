//! People alone, and populations: the speeds that they keep.

use super::super::judge::{Bench, Criterion, Draws, Origin, Test};
use super::super::measure::{crossings, deviation, fits_normal, mean};
use super::super::rooms::{corridor, walker};
use crate::Error;
use crate::library::GaitLibrary;
use crate::scenario::{Scenario, populate};
use glam::Vec2;

pub(super) const RIMEA_1: Test = Test {
    name: "rimea-1",
    title: "One person keeps the speed of 1.33 m/s along 40 m of a corridor 2 m wide",
    source: "RiMEA 4.1.1, test 1 (p. 29)",
    about: "The speed stays between 4.5 and 5.1 km/h; the way takes 26 to 34 s. Timed from 2 m behind the start.",
    run: |bench| {
        let taken = alone(bench, 1.33)?;
        let source = Origin::Source("RiMEA 4.1.1, 1");
        bench.judge("time", taken, Criterion::Within(26.0, 34.0), "s", source);
        bench.judge("speed", 3.6 * 40.0 / taken, Criterion::Within(4.5, 5.1), "km/h", source);
        Ok(())
    },
    draws: Draws::Turned,
    grows: false,
};

pub(super) const NIST_CORRIDOR: Test = Test {
    name: "nist-corridor",
    title: "One person walks 40 m at 1 m/s in 40 s",
    source: "NIST Technical Note 1822, 2.1; ISO 20414, test 2",
    about: "The source says 40 s; how near to that is ours: 2 %.",
    run: |bench| {
        bench.judge("time", alone(bench, 1.0)?, Criterion::Within(39.2, 40.8), "s", Origin::Ours);
        Ok(())
    },
    draws: Draws::Turned,
    grows: false,
};

/// How long one person takes for 40 m of a corridor, s.
fn alone(bench: &Bench<'_>, speed: f32) -> Result<f64, Error> {
    let mut scene = corridor("corridor", 44.0, 2.0, 100.0)?;
    scene.walkers.push(walker(Vec2::new(1.0, 1.0), speed, vec![(Vec2::new(43.0, 1.0), 0.3)]));
    scene.until = Some(1);
    let run = bench.run(&scene)?;
    let time = |x: f32| crossings(&run.tracks, Vec2::new(x, -0.1), Vec2::new(x, 2.1)).first().copied();
    bench.never("outside", run.outside as usize, "places outside the walls", Origin::Ours);
    Ok(time(42.0).zip(time(2.0)).map_or(f64::NAN, |(end, start)| end - start))
}

pub(super) const RIMEA_7: Test = Test {
    name: "rimea-7",
    title: "A population's speeds are distributed as its source says",
    source: "RiMEA 4.1.1, test 7 (p. 31); ISO 20414, test 5",
    about: "Five populations of 50 adults are drawn as a scenario's classes draw them, with the free speeds of Weidmann (1993): normal, \
            1.34 m/s, deviation 0.26, cut at 0.5 and 2.2 m/s. Each person walks 30 m in a lane of their own. RiMEA demands that the distribution agrees with its source, without a bound. The bounds are those of JuPedSim's tests \
            of ISO 20414: mean and deviation to 0.05 m/s, Kolmogorov-Smirnov p above 0.05. Ours: every person walks as fast as \
            drawn, to 3 %.",
    run: population,
    draws: Draws::Seeds,
    grows: true,
};

/// Mean, deviation, least and greatest of Weidmann's free speeds, m/s.
const WEIDMANN: [f32; 4] = [1.34, 0.26, 0.5, 2.2];

/// Speeds of a population as users draw one.
pub(super) fn speeds(seed: u32, count: usize) -> Result<Vec<f32>, Error> {
    let [mean, deviation, least, greatest] = WEIDMANN;
    let text = format!(
        "name = \"adults\"\nbounds = [[-99, -99], [99, -99], [99, 99], [-99, 99]]\n\
         [[routes]]\nname = \"along\"\nwaypoints = [[-80, 0], [80, 0]]\nwidth = 100\n[population]\nagents = {count}\n\
         [[population.classes]]\nname = \"adults\"\nshare = 1.0\n\
         speed = {{ mean = {mean}, deviation = {deviation}, least = {least}, greatest = {greatest} }}\n"
    );
    let mut scenario = Scenario::parse(&text, "adults")?;
    scenario.seed = u64::from(seed);
    let library = GaitLibrary::built_in()?;
    let crowd = populate(&scenario, |emotion| library.gaits_for(emotion))?;
    Ok(crowd.agents.iter().filter_map(|agent| agent.speed).collect())
}

#[allow(clippy::cast_precision_loss, reason = "some hundred people")]
fn population(bench: &Bench<'_>) -> Result<(), Error> {
    let count = bench.people(50);
    let (mut walked, mut worst) = (Vec::new(), 0.0_f64);
    for part in 0..5 {
        let drawn = speeds(5 * bench.seed + part, count)?;
        let mut scene = corridor("adults", 34.0, drawn.len() as f32, 80.0)?;
        scene.until = Some(1);
        for (lane, speed) in drawn.iter().enumerate() {
            let z = lane as f32 + 0.5;
            scene.walkers.push(walker(Vec2::new(1.0, z), *speed, vec![(Vec2::new(33.0, z), 0.3)]));
        }
        let run = bench.run(&scene)?;
        for (lane, speed) in drawn.iter().enumerate() {
            let z = lane as f32;
            let line = |x: f32| crossings(&run.tracks, Vec2::new(x, z), Vec2::new(x, z + 1.0));
            let times = line(32.0).first().copied().zip(line(2.0).first().copied());
            let found = times.map_or(0.0, |(end, start)| 30.0 / (end - start));
            worst = worst.max((found / f64::from(*speed) - 1.0).abs());
            walked.push(found);
        }
    }
    let [wanted, spread, ..] = WEIDMANN.map(f64::from);
    let source = Origin::Source("ISO 20414, 5, as JuPedSim tests it");
    let near = |value: f64| Criterion::Within(value - 0.05, value + 0.05);
    bench.judge("mean", mean(&walked), near(wanted), "m/s", source);
    bench.judge("deviation", deviation(&walked), near(spread), "m/s", source);
    bench.judge(
        "p",
        fits_normal(&walked, wanted, spread),
        Criterion::AtLeast(0.05),
        "(Kolmogorov-Smirnov)",
        source,
    );
    bench.judge("as-drawn", worst, Criterion::AtMost(0.03), "of the speed drawn", Origin::Ours);
    Ok(())
}
