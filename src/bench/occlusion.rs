//! Cost and gain of leaving out hidden people: the same frames with and without, in turns.
//!
//! - `inside`: at eye level in the middle of the crowd, `before`: at eye level in front of it,
//! - `over`: from three metres up, over their heads, `above`: from a roof, where no agent hides another.
//!
//! Both eyes as a headset has them, in one pass. Times as in [`super::stereo`].

use super::crowds::{EYE_HEIGHT, dressed};
use super::runs::{RUNS, Row, WARM_UP};
use super::stereo::{BEFORE, EYE, FIELD, INTERPUPILLARY, ground};
use crate::render::camera::{Camera, View};
use crate::render::{Occlusion, Settings, Show};
use crate::sim::{Backend, Simulation};
use glam::Vec3;
use std::time::Instant;

/// Times frames of a crowd on a plane from four places.
pub(super) fn occlusion(
    agents: usize,
    backend: Backend,
    device: Option<&str>,
) -> Result<(Vec<Row>, String), crate::Error> {
    let (store, meshes) = dressed(agents)?;
    let side = store.step.wrap;
    let mut simulation = Simulation::from_store(store, backend, device)?;
    simulation.step(30)?;
    let scenery = ground(side);
    let middle = 0.5 * side;
    let from = |y, z, pitch| {
        let camera = Camera::user_eyes(Vec3::new(middle, y, z), 0.0, pitch).with_fov(FIELD);
        View::stereo(&camera, INTERPUPILLARY, EYE.0, EYE.1)
    };
    let views = [
        (["occlusion_inside_off", "occlusion_inside_on"], from(EYE_HEIGHT, middle, -0.1)),
        (["occlusion_before_off", "occlusion_before_on"], from(EYE_HEIGHT, -BEFORE, -0.1)),
        (["occlusion_over_off", "occlusion_over_on"], from(3.0, -BEFORE, -0.2)),
        (["occlusion_above_off", "occlusion_above_on"], from(0.4 * side, -0.3 * side, -0.6)),
    ];
    let mut show = |occlusion| {
        let settings = Settings { eyes: 2, occlusion, ..Settings::sized(EYE.0, EYE.1) };
        Show::new(&mut simulation, &meshes, &scenery, settings, device)
    };
    let mut shows = [show(Occlusion::Off)?, show(Occlusion::On)?];
    let mut times = vec![[Vec::new(), Vec::new()]; views.len()];
    let (begin, (fewest, most, budget)) = (Instant::now(), RUNS);
    let mut round = 0;
    while round < WARM_UP + fewest || (round < WARM_UP + most && begin.elapsed() < 10 * budget) {
        for ((_, view), times) in views.iter().zip(&mut times) {
            for (show, times) in shows.iter_mut().zip(times) {
                let begin = Instant::now();
                show.make(&mut simulation, view, view.center())?;
                let ms = begin.elapsed().as_secs_f64() * 1e3;
                times.extend((round >= WARM_UP).then_some(ms));
            }
        }
        round += 1;
    }
    let rows = views.iter().zip(times).flat_map(|((names, _), times)| {
        names.iter().zip(times).map(|(name, times)| Row::new(name, agents, times)).collect::<Vec<_>>()
    });
    Ok((rows.collect(), shows[0].device()))
}
