//! What light and surfaces cost: the same pictures at low, medium and high quality, in turns.
//!
//! The scene `crossing`, ten seconds on: from the user's eyes, and from above. Each quality has its own scenery. Times are by the
//! clock, from the simulation's state to the image on the device. No step is part of them, and nothing is copied to the host.

use super::runs::{RUNS, Row, WARM_UP};
use crate::render::Quality::{High, Low, Medium};
use crate::render::Settings;
use crate::scene::{CameraChoice, Scene, Stage};
use crate::sim::Backend;
use std::time::Instant;

/// Pixels of a picture.
const SIZE: (u32, u32) = (1280, 720);
/// Time of the pictures, s.
const SECONDS: f64 = 10.0;
/// From where, and the rows' names at low, medium and high quality.
const ROWS: [(CameraChoice, [&str; 3]); 2] = [
    (CameraChoice::Eyes, ["light_eyes_low", "light_eyes_medium", "light_eyes_high"]),
    (CameraChoice::Orbit, ["light_orbit_low", "light_orbit_medium", "light_orbit_high"]),
];

/// Times the pictures; rows and the device.
pub(super) fn light(
    agents: usize,
    backend: Backend,
    device: Option<&str>,
) -> Result<(Vec<Row>, String), crate::Error> {
    let stage = |quality| -> Result<Stage, crate::Error> {
        let count = u32::try_from(agents).unwrap_or(u32::MAX);
        let scene = Scene::load("crossing")?.agents(count).build()?.on(backend, device);
        let steps = scene.steps(SECONDS);
        let mut stage = Stage::new(scene, Settings { quality, ..Settings::sized(SIZE.0, SIZE.1) })?;
        stage.step(steps)?;
        Ok(stage)
    };
    let mut stages = [Low, Medium, High].into_iter().map(stage).collect::<Result<Vec<_>, _>>()?;
    let (fewest, most, budget) = RUNS;
    let mut rows = Vec::new();
    for (camera, names) in ROWS {
        let mut times = [(); 3].map(|()| Vec::new());
        let (begin, mut round) = (Instant::now(), 0);
        while round < WARM_UP + fewest || (round < WARM_UP + most && begin.elapsed() < 5 * budget) {
            for (stage, times) in stages.iter_mut().zip(&mut times) {
                let camera = stage.camera(camera, 0.0)?;
                let begin = Instant::now();
                stage.make(&camera)?;
                let ms = begin.elapsed().as_secs_f64() * 1e3;
                times.extend((round >= WARM_UP).then_some(ms));
            }
            round += 1;
        }
        rows.extend(names.into_iter().zip(times).map(|(name, times)| Row::new(name, agents, times)));
    }
    Ok((rows, stages[0].devices()))
}
