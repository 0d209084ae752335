//! What both eyes cost: one pass with multiview, two passes, and two pictures made one after the other.
//!
//! - `stereo_one_pass`: bodies animated once, one shadow map, both eyes in one pass (multiview).
//! - `stereo_two_passes`: bodies and shadow map once, then a pass for each eye: what this engine does without multiview.
//! - `stereo_two_pictures`: everything twice, culling, bodies, shadow map and pass: what an engine does that knows one eye.
//!
//! The three take turns within one run, so that a busy machine slows all of them alike. Every time is by the clock, from
//! the simulation's state to the picture on the device; nothing is copied to the host.

use super::{EYE_HEIGHT, RUNS, Row, SPACING, WARM_UP, cast, dress};
use crate::render::camera::{Camera, View};
use crate::render::{Settings, Show, Stereo};
use crate::scenario::EnvironmentMesh;
use crate::sim::{Backend, Simulation, bodies};
use crate::verify::cases::crossing::crossing;
use glam::Vec3;
use std::time::Instant;

/// Pixels of one eye.
const EYE: (u32, u32) = (640, 720);
/// Distance of the eyes, m.
const INTERPUPILLARY: f32 = 0.063;
/// Vertical field of view of an eye, radians (100 degrees, as headsets have).
const FIELD: f32 = 1.745;
/// How far in front of the crowd the user stands, m.
const BEFORE: f32 = 4.0;

/// A square of ground under the crowd.
fn ground(side: f32) -> EnvironmentMesh {
    let out = side;
    let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    EnvironmentMesh {
        positions: vec![
            corner(-out, -out),
            corner(-out, side + out),
            corner(side + out, side + out),
            corner(side + out, -out),
        ],
        normals: vec![Vec3::Y; 4],
        colors: vec![Vec3::splat(0.35); 4],
        indices: vec![0, 1, 2, 0, 2, 3],
    }
}

/// Times the three ways of drawing both eyes in front of a crowd, all of which they see, and the parts of the first.
pub(super) fn stereo(
    agents: usize,
    backend: Backend,
    device: Option<&str>,
) -> Result<(Vec<Row>, String), crate::Error> {
    let cast = cast()?;
    let mut store = crossing(agents, SPACING);
    dress(&mut store, &cast);
    let meshes = bodies::fill(&mut store, &cast, bodies::SMALLEST_STORAGE_RANGE);
    let side = store.step.wrap;
    let mut simulation = Simulation::from_store(store, backend, device)?;
    simulation.step(30)?;
    let scenery = ground(side);
    let middle = 0.5 * side;
    let camera = Camera::user_eyes(Vec3::new(middle, EYE_HEIGHT, -BEFORE), 0.0, -0.1).with_fov(FIELD);
    let both = View::stereo(&camera, INTERPUPILLARY, EYE.0, EYE.1);
    let alone = [0, 1].map(|eye| View {
        clip_from_world: [both.clip_from_world[eye]; 2],
        eyes: [both.eyes[eye]; 2],
        eye_count: 1,
        ..both
    });
    let show = |simulation: &mut Simulation, eyes, stereo, shadow_size| {
        let settings = Settings { eyes, stereo, shadow_size, ..Settings::sized(EYE.0, EYE.1) };
        Show::new(simulation, &meshes, &scenery, settings, device)
    };
    let shadows = Settings::default().shadow_size;
    let mut ways = [
        ("stereo_one_pass", show(&mut simulation, 2, Stereo::OnePass, shadows)?, vec![both]),
        ("stereo_two_passes", show(&mut simulation, 2, Stereo::TwoPasses, shadows)?, vec![both]),
        ("stereo_two_pictures", show(&mut simulation, 1, Stereo::Auto, shadows)?, alone.to_vec()),
        ("stereo_without_shadows", show(&mut simulation, 2, Stereo::OnePass, 0)?, vec![both]),
    ];
    let mut bodies_only = Vec::new();
    let mut times = [const { Vec::new() }; 4];
    let (begin, (fewest, most, budget)) = (Instant::now(), RUNS);
    let mut round = 0;
    while round < WARM_UP + fewest || (round < WARM_UP + most && begin.elapsed() < 4 * budget) {
        for ((_, show, views), times) in ways.iter_mut().zip(&mut times) {
            let begin = Instant::now();
            for view in views.iter() {
                show.make(&mut simulation, view, both.center())?;
            }
            let ms = begin.elapsed().as_secs_f64() * 1e3;
            times.extend((round >= WARM_UP).then_some(ms));
        }
        let begin = Instant::now();
        ways[0].1.prepare(&mut simulation, &both, both.center())?;
        let ms = begin.elapsed().as_secs_f64() * 1e3;
        bodies_only.extend((round >= WARM_UP).then_some(ms));
        round += 1;
    }
    let name = ways[0].1.device();
    let mut rows: Vec<Row> =
        ways.iter().zip(times).map(|((name, _, _), times)| Row::new(name, agents, times)).collect();
    rows.push(Row::new("stereo_bodies", agents, bodies_only));
    Ok((rows, name))
}
