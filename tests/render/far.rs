//! Crowds drawn by level of detail: no agent is lost, none pops.

use crate::common::gpu;
use gaitway::avatar::{self, Sex};
use gaitway::emotion::Emotion;
use gaitway::gait::walker;
use gaitway::kernels::BufferId;
use gaitway::kernels::layout::{Appearance, Attention, GazeState, Stance};
use gaitway::library::GaitLibrary;
use gaitway::reference::exact::hash_u32;
use gaitway::render::camera::{Camera, View};
use gaitway::render::{Image, Settings, Show};
use gaitway::scenario::{EnvironmentMesh, Scenario, populate_from};
use gaitway::sim::{AvatarSet, Backend, Simulation, bodies, setup};
use gaitway::verify::cases::crossing;
use glam::Vec3;

const W: u32 = 480;
const H: u32 = 270;

/// The crossing with so many people on the device, and what draws it; none without a device.
fn crossing(agents: u32) -> Option<(Simulation, Show, Vec3)> {
    crossing_as(agents, Settings::sized(W, H))
}

/// The same, drawn in another way.
pub(super) fn crossing_as(agents: u32, settings: Settings) -> Option<(Simulation, Show, Vec3)> {
    let library = GaitLibrary::built_in().unwrap();
    let scenario = Scenario::builtin("crossing").unwrap().with_agents(agents);
    let crowd = populate_from(&scenario, &library).unwrap();
    let cast = AvatarSet::new(library.gaits(), Sex::ALL.map(avatar::generated).to_vec()).unwrap();
    let geometry = scenario.geometry();
    let mut store = setup::store(&scenario, &geometry, &crowd, &cast);
    let meshes = bodies::fill(&mut store, &cast, bodies::SMALLEST_STORAGE_RANGE);
    let mut simulation = gpu::on_device(Simulation::from_store(store, Backend::Vulkan, None))?;
    let scenery = geometry.scenery();
    let show = Show::new(&mut simulation, &meshes, &scenery, settings, None).unwrap();
    let user = gaitway::ground::world_from_ground(geometry.focus, 1.7);
    Some((simulation, show, user))
}

/// The agents drawn last: with a pose, and as far bodies.
fn drawn(simulation: &mut Simulation) -> [u32; 2] {
    let store = simulation.read(&[BufferId::DrawArgs]).unwrap();
    let buckets = store.mesh_table.len();
    let counts: Vec<u32> = store.draw_args.chunks(5).take(buckets).map(|args| args[1]).collect();
    let (posed, far) = counts.split_at(store.frame.bucket_count as usize);
    [posed.iter().sum(), far.iter().sum()]
}

fn keep(name: &str, image: &Image) {
    if let Some(folder) = std::env::var_os("GAITWAY_PICTURES") {
        let path = std::path::PathBuf::from(folder).join(format!("{name}.png"));
        gaitway::export::image::write_png(&path, image).unwrap();
    }
}

#[test]
fn all_twenty_thousand_are_drawn_most_of_them_without_a_pose() {
    let Some((mut simulation, mut show, user)) = crossing(20_000) else { return };
    // from high above, all agents are in view
    let camera = Camera::look_at(user + Vec3::new(0.0, 260.0, 260.0), user, Vec3::Y).with_fov(1.4);
    let image = show.draw(&mut simulation, &View::mono(&camera, W, H), user).unwrap();
    keep("far_all", &image);
    assert_eq!(drawn(&mut simulation), [0, 20_000]);
    // in the middle of it the near ones have a pose, and the user sees about a quarter of all
    let view = View::mono(&Camera::user_eyes(user, 0.0, 0.0), W, H);
    let image = show.draw(&mut simulation, &view, user).unwrap();
    keep("far_eyes", &image);
    let [posed, far] = drawn(&mut simulation);
    assert!(posed > 50 && far > 5 * posed, "{posed} {far}");
    gpu::assert_silent();
}

#[test]
fn where_far_bodies_begin_the_picture_hardly_changes() {
    let Some((mut simulation, mut show, user)) = crossing(3_000) else { return };
    simulation.step(30).unwrap();
    let camera = Camera::look_at(user + Vec3::new(0.0, 8.0, 2.0), user - Vec3::Z * 15.0, Vec3::Y);
    let view = View::mono(&camera, W, H);
    let mut draw = |simulation: &mut Simulation, distances: [f32; 3]| {
        show.set_level_distances(distances);
        let image = show.draw(simulation, &view, user).unwrap();
        (image, drawn(simulation))
    };
    let (fine, [all, none]) = draw(&mut simulation, [12.0, 3500.0, 2000.0]);
    let (mixed, [posed, far]) = draw(&mut simulation, bodies::LEVEL_DISTANCES);
    let (empty, none_far) = draw(&mut simulation, [0.0; 3]);
    keep("far_none", &fine);
    keep("far_mixed", &mixed);
    assert_eq!((none, none_far, posed + far), (0, [0; 2], all));
    assert!(far > 300 && posed > 100, "{posed} {far}");
    // where people are 16 pixels high, the change of level is no more than what two tenths of a second of walking change
    let difference = |a: &Image, b: &Image| {
        let each = a.pixels.iter().zip(&b.pixels).map(|(a, b)| f64::from(a.abs_diff(*b)));
        each.sum::<f64>() / a.pixels.len() as f64
    };
    let change = difference(&fine, &mixed);
    simulation.step(6).unwrap();
    let later = draw(&mut simulation, [12.0, 3500.0, 2000.0]).0;
    let walked = difference(&fine, &later);
    println!("far bodies change the picture by {change:.2}, walking by {walked:.2} of 255");
    assert!(change < walked && change > 0.0, "{change}, walking {walked}");
    // and none of their brightness: the mean of the picture stays
    let mean =
        |image: &Image| image.pixels.iter().map(|p| f64::from(*p)).sum::<f64>() / image.pixels.len() as f64;
    let (a, b, bare) = (mean(&fine), mean(&mixed), mean(&empty));
    assert!((a - b).abs() < 0.2 * (a - bare).abs().max(1.0), "{a} {b} {bare}");
    gpu::assert_silent();
}

#[test]
fn far_bodies_are_held_as_their_emotion_walks() {
    let gaits = Emotion::ALL.map(|emotion| walker::person(emotion, walker::Sex::Female, 1, 0).unwrap());
    let cast = AvatarSet::new(&gaits, Sex::ALL.map(avatar::generated).to_vec()).unwrap();
    let draw = |emotion: Emotion| {
        let mut store = crossing::crossing(400, 1.0);
        for agent in 0..400 {
            let (avatar, dice) = (agent & 1, hash_u32(agent));
            store.appearance.push(Appearance {
                skin_and_hair: dice,
                top_and_bottom: hash_u32(dice),
                ..Appearance::new(avatar, emotion as u32, false, 1.0, [0; 4])
            });
            store.gaits.push([cast.clip_index(avatar, emotion as u32); 4]);
            store.gait_weights.push([1.0, 0.0, 0.0, 0.0]);
            store.gaze_state.push(GazeState::default());
            store.gaze_frame.push(u32::MAX);
            store.attention.push(Attention::default());
        }
        store.heading.fill(1.57); // seen from the side
        store.stance.iter_mut().for_each(|own| {
            *own = Stance { phase: own.phase, walk_weight: 1.0, stride: 1.4, ..Stance::default() }
        });
        let meshes = bodies::fill(&mut store, &cast, bodies::SMALLEST_STORAGE_RANGE);
        let middle = 0.5 * store.step.wrap;
        let mut simulation = gpu::on_device(Simulation::from_store(store, Backend::Vulkan, None))?;
        let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z) * 100.0;
        let plane = EnvironmentMesh {
            positions: vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)],
            normals: vec![Vec3::Y; 4],
            colors: vec![Vec3::splat(0.35); 4],
            layers: vec![1; 4],
            indices: vec![0, 1, 2, 0, 2, 3],
            ..EnvironmentMesh::default()
        };
        let mut show = Show::new(&mut simulation, &meshes, &plane, Settings::sized(W, H), None).unwrap();
        show.set_level_distances([1.0, 2.0, 2000.0]);
        let eyes = Vec3::new(middle, 6.0, middle + 36.0);
        let camera = Camera::look_at(eyes, Vec3::new(middle, 1.0, middle), Vec3::Y).with_fov(0.2);
        let image = show.draw(&mut simulation, &View::mono(&camera, W, H), eyes).unwrap();
        assert_eq!(drawn(&mut simulation)[0], 0, "no agent has a pose");
        Some(image)
    };
    let Some(sad) = draw(Emotion::Sad) else { return };
    let happy = draw(Emotion::Happy).unwrap();
    keep("far_sad", &sad);
    keep("far_happy", &happy);
    let differ =
        |a: &Image, b: &Image| a.pixels.chunks(4).zip(b.pixels.chunks(4)).filter(|(a, b)| a != b).count();
    assert_eq!(differ(&sad, &draw(Emotion::Sad).unwrap()), 0, "the same crowd again");
    // places, phases and colours are the same; only how they are held is not
    let share = differ(&sad, &happy) as f64 / f64::from(W * H);
    println!("{:.1} % of the pixels differ", 100.0 * share);
    assert!(share > 0.05, "{share}");
    gpu::assert_silent();
}
