//! What both eyes cost: one pass with multiview, two passes, and two frames made one after the other.
//!
//! - `stereo_one_pass`: bodies animated once, one shadow map, both eyes in one pass (multiview).
//! - `stereo_two_passes`: bodies and shadow map once, then a pass for each eye: what this engine does without multiview.
//! - `stereo_two_pictures`: everything twice (culling, bodies, shadow map and pass), as in an engine that knows one eye.
//!
//! Variants of the first row with less show what it consists of: `stereo_without_shadows`, `stereo_without_far` (only posed
//! people), `stereo_one_sample` (one sample a pixel instead of four), `stereo_few_pixels` (a hundredth of the pixels: mostly
//! vertices and the shadow map). `stereo_bodies` is culling and animation alone, which both eyes share.
//!
//! The variants take turns within one run, so that a busy machine slows all of them alike. Every time is by the clock, from
//! the simulation's state to the image on the device. Nothing is copied to the host.

use super::crowds::{EYE_HEIGHT, dressed};
use super::runs::{RUNS, Row, WARM_UP};
use crate::render::camera::{Camera, View};
use crate::render::show::level_distances;
use crate::render::{Settings, Show, Stereo};
use crate::scenario::EnvironmentMesh;
use crate::sim::bodies::LEVEL_DISTANCES;
use crate::sim::{Backend, Simulation};
use glam::Vec3;
use std::time::Instant;

/// Pixels of one eye.
pub(super) const EYE: (u32, u32) = (640, 720);
/// A side has so many times fewer pixels where pixels shall not count.
const FEWER: u32 = 10;
/// Distance of the eyes, m.
pub(super) const INTERPUPILLARY: f32 = 0.063;
/// Vertical field of view of an eye, radians (100 degrees, as headsets have).
pub(super) const FIELD: f32 = 1.745;
/// How far in front of the crowd the user stands, m.
pub(super) const BEFORE: f32 = 4.0;

/// A square of ground under the crowd.
pub(super) fn ground(side: f32) -> EnvironmentMesh {
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
        layers: vec![1; 4],
        indices: vec![0, 1, 2, 0, 2, 3],
        ..EnvironmentMesh::default()
    }
}

/// Times the three ways of drawing both eyes in front of a crowd, all of which they see, and the parts of the first.
pub(super) fn stereo(
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
    let camera = Camera::user_eyes(Vec3::new(middle, EYE_HEIGHT, -BEFORE), 0.0, -0.1).with_fov(FIELD);
    let both = View::stereo(&camera, INTERPUPILLARY, EYE.0, EYE.1);
    let alone = [0, 1].map(|eye| View {
        clip_from_world: [both.clip_from_world[eye]; 2],
        eyes: [both.eyes[eye]; 2],
        eye_count: 1,
        ..both
    });
    let full = Settings { eyes: 2, stereo: Stereo::OnePass, ..Settings::sized(EYE.0, EYE.1) };
    let mut show = |settings| Show::new(&mut simulation, &meshes, &scenery, settings, device).map(Box::new);
    let mut without_far = show(full)?;
    let [first, second, farthest] = LEVEL_DISTANCES;
    let ([.., far_begins], _) = level_distances(&both, &full, [first, second, f32::MAX, 0.0]);
    without_far.set_level_distances([first, second, far_begins]);
    let mut few_pixels = show(Settings { width: EYE.0 / FEWER, height: EYE.1 / FEWER, ..full })?;
    #[allow(clippy::cast_precision_loss, reason = "a small number")]
    let same_levels = [first * FEWER as f32, second * FEWER as f32, farthest];
    few_pixels.set_level_distances(same_levels);
    let mut ways = [
        ("stereo_one_pass", show(full)?, vec![both]),
        ("stereo_two_passes", show(Settings { stereo: Stereo::TwoPasses, ..full })?, vec![both]),
        ("stereo_two_pictures", show(Settings { eyes: 1, ..full })?, alone.to_vec()),
        ("stereo_without_shadows", show(Settings { shadow_size: 0, ..full })?, vec![both]),
        ("stereo_without_far", without_far, vec![both]),
        ("stereo_one_sample", show(Settings { samples: 1, ..full })?, vec![both]),
        ("stereo_few_pixels", few_pixels, vec![both]),
    ];
    let mut bodies_only = Vec::new();
    let mut times = vec![Vec::new(); ways.len()];
    let (begin, (fewest, most, budget)) = (Instant::now(), RUNS);
    let mut round = 0;
    while round < WARM_UP + fewest || (round < WARM_UP + most && begin.elapsed() < 5 * budget) {
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
