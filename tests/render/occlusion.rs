//! Occluded agents are left out, and the picture is the same.

use crate::common::gpu;
use gaitway::avatar::{self, Sex};
use gaitway::kernels::layout::{Appearance, Attention, GazeState};
use gaitway::kernels::{BufferId, Store};
use gaitway::library::GaitLibrary;
use gaitway::reference::exact::{hash_u32, unit_f32};
use gaitway::render::camera::{Camera, View};
use gaitway::render::{Image, Occlusion, Settings, Show, Stereo};
use gaitway::scenario::{EnvironmentMesh, Scenario, populate_from};
use gaitway::sim::{AvatarSet, Backend, Simulation, bodies, setup};
use gaitway::verify::cases::crossing::crossing;
use glam::Vec3;

const W: u32 = 320;
const H: u32 = 180;

/// A crowd, and where its user's eyes are.
struct Crowd {
    simulation: Simulation,
    show: Show,
    user: Vec3,
}

/// What the people are among.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    /// One to a square metre on a plane.
    Plane,
    /// The Crossing with its buildings.
    Crossing,
}

/// A crowd on a plane, one to a square metre.
fn dense(agents: u32, cast: &AvatarSet) -> Store {
    let mut store = crossing(agents as usize, 1.0);
    for agent in 0..agents {
        let (avatar, dice) = (agent & 1, hash_u32(agent));
        let scale = 0.95 + 0.1 * unit_f32(dice);
        store.appearance.push(Appearance {
            skin_and_hair: dice,
            top_and_bottom: hash_u32(dice),
            ..Appearance::new(avatar, dice & 3, false, scale, [0; 4])
        });
        store.gaits.push([cast.clip_index(avatar, dice & 3); 4]);
        store.gait_weights.push([1.0, 0.0, 0.0, 0.0]);
        store.gaze_state.push(GazeState::default());
        store.gaze_frame.push(u32::MAX);
        store.attention.push(Attention::default());
    }
    store
}

fn ground() -> EnvironmentMesh {
    let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z) * 300.0;
    EnvironmentMesh {
        positions: vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)],
        normals: vec![Vec3::Y; 4],
        colors: vec![Vec3::splat(0.35); 4],
        layers: vec![1; 4],
        indices: vec![0, 1, 2, 0, 2, 3],
        ..EnvironmentMesh::default()
    }
}

/// None without a device. `shrink` makes the boxes around the bodies smaller than these.
fn crowd(place: Place, agents: u32, settings: Settings, shrink: f32) -> Option<Crowd> {
    let library = GaitLibrary::built_in().unwrap();
    let cast = AvatarSet::new(library.gaits(), Sex::ALL.map(avatar::generated).to_vec()).unwrap();
    let scenario = Scenario::builtin("crossing").unwrap().with_agents(agents);
    let geometry = scenario.geometry();
    let (mut store, scenery, user) = if place == Place::Plane {
        let store = dense(agents, &cast);
        let middle = 0.5 * store.step.wrap;
        (store, ground(), Vec3::new(middle, 1.4, middle))
    } else {
        let crowd = populate_from(&scenario, &library).unwrap();
        let store = setup::store(&scenario, &geometry, &crowd, &cast);
        let scenery = geometry.scenery();
        (store, scenery, gaitway::ground::world_from_ground(geometry.focus, 1.65))
    };
    let mut meshes = bodies::fill(&mut store, &cast, bodies::SMALLEST_STORAGE_RANGE);
    for [side, bottom, top, _] in meshes.bounds.iter_mut().flatten() {
        let middle = 0.5 * (*bottom + *top);
        (*side, *bottom, *top) =
            (*side * shrink, middle + (*bottom - middle) * shrink, middle + (*top - middle) * shrink);
    }
    let mut simulation = gpu::on_device(Simulation::from_store(store, Backend::Vulkan, None))?;
    let show = Show::new(&mut simulation, &meshes, &scenery, settings, None).unwrap();
    Some(Crowd { simulation, show, user })
}

/// A crowd drawn with all agents, and again without the occluded ones.
struct Pair([Box<Crowd>; 2]);

impl Pair {
    fn new(place: Place, agents: u32, settings: Settings, shrink: f32) -> Option<Self> {
        let all = crowd(place, agents, Settings { occlusion: Occlusion::Off, ..settings }, shrink)?;
        Some(Self([Box::new(all), Box::new(crowd(place, agents, settings, shrink)?)]))
    }

    /// Both pictures of a view.
    fn draw(&mut self, view: &View) -> [Image; 2] {
        self.0.each_mut().map(|crowd| crowd.show.draw(&mut crowd.simulation, view, crowd.user).unwrap())
    }

    /// Draws and steps while the eyes move through the crowd, turn, and now and then look from above: how many pixels
    /// differ in all, how many far bodies and specks the frusta kept, and how many of these are not hidden.
    fn walk(&mut self, settings: &Settings, pictures: u8, name: &str) -> (usize, [u32; 2]) {
        let (mut differ, mut counts) = (0, [0; 2]);
        for number in 0..pictures {
            let t = f32::from(number);
            let height = if number % 4 == 3 { 0.8 * t } else { 0.0 };
            let eyes = self.0[0].user + Vec3::new(2.0 * t, height, 1.5 * t);
            let camera = Camera::user_eyes(eyes, 0.9 * t, -0.05 * t).with_fov(1.2);
            let view = if settings.eyes == 2 {
                View::stereo(&camera, 0.063, W, H)
            } else {
                View::mono(&camera, W, H)
            };
            let images = self.draw(&view);
            keep(&format!("{name}{number}"), &images[1]);
            let [a, b] = images.each_ref().map(|image| image.pixels.chunks(4));
            differ += a.zip(b).filter(|(a, b)| a != b).count();
            let [kept, seen] = self.counts();
            println!("{name}{number}: {seen} of {kept} far people are seen, {differ} pixels differ so far");
            counts = [counts[0] + kept, counts[1] + seen];
            for crowd in &mut self.0 {
                crowd.simulation.step(7).unwrap();
            }
        }
        (differ, counts)
    }

    /// Far bodies and specks that the frusta kept in the last picture, and how many of them are not occluded.
    fn counts(&mut self) -> [u32; 2] {
        let store = self.0[1].simulation.read(&[BufferId::DrawArgs, BufferId::ShownArgs]).unwrap();
        let far = store.frame.bucket_count as usize..store.mesh_table.len();
        [&store.draw_args, &store.shown_args]
            .map(|args| args.chunks(5).skip(far.start).take(far.len()).map(|args| args[1]).sum())
    }
}

fn keep(name: &str, image: &Image) {
    if let Some(folder) = std::env::var_os("GAITWAY_PICTURES") {
        let path = std::path::PathBuf::from(folder).join(format!("{name}.png"));
        gaitway::export::image::write_png(&path, image).unwrap();
    }
}

#[test]
fn without_hidden_people_the_picture_is_the_same_while_crowd_and_eyes_move() {
    let ways = [(4, 1, Stereo::Auto), (1, 1, Stereo::Auto), (4, 2, Stereo::Auto), (4, 2, Stereo::TwoPasses)];
    for (samples, eyes, stereo) in ways {
        for place in [Place::Plane, Place::Crossing] {
            let settings = Settings { samples, eyes, stereo, ..Settings::sized(W, H) };
            let Some(mut pair) = Pair::new(place, 2_500, settings, 1.0) else { return };
            let is_plane = place == Place::Plane;
            let name = format!("occlusion_{samples}_{eyes}_{stereo:?}_{is_plane}_");
            let (differ, [kept, seen]) = pair.walk(&settings, if is_plane { 6 } else { 4 }, &name);
            assert_eq!(differ, 0, "{name}");
            // in the crowd many are hidden, in the Crossing, where people are farther apart, some
            assert!(
                seen > 0 && seen < kept && (!is_plane || 3 * seen < 2 * kept),
                "{name}: {seen} of {kept}"
            );
        }
    }
    gpu::assert_silent();
}

#[test]
fn with_boxes_smaller_than_the_bodies_an_agent_is_missed() {
    // that the test above sees what it is meant to see
    let settings = Settings::sized(W, H);
    let Some(mut pair) = Pair::new(Place::Plane, 2_500, settings, 0.2) else { return };
    let (differ, _) = pair.walk(&settings, 3, "occlusion_small_");
    assert!(differ > 0, "no agent is missed");
}
