//! A contact sheet of the two bodies walking as each emotion, drawn by the renderer.

use super::scene::PlaceArguments;
use crate::Error;
use crate::avatar::{self, Avatar};
use crate::emotion::Emotion;
use crate::export::image::{Tile, contact_sheet};
use crate::gait::walker::Sex;
use crate::library::GaitLibrary;
use crate::picture::Image;
use crate::render::{Atmosphere, Camera, Settings};
use crate::scenario::{AgentStart, Crowd, Scenario, Stop};
use crate::scene::{Scene, Stage};
use crate::sim::AvatarSet;
use glam::{Vec2, Vec3};

/// Pixels of a tile.
const TILE: (u32, u32) = (150, 250);
/// Phases of a stride, one a column.
const PHASES: u32 = 8;
/// Metres between two people: they stand in one line and only one is drawn at a time.
const APART: f32 = 20.0;
/// Distance of the camera, m, and its field of view, radians.
const CAMERA: (f32, f32) = (5.0, 0.42);
/// Rows per emotion: a woman from the side, a man from the front.
const ROWS: u32 = 2;

/// The place: nothing but ground.
const PLACE: &str = "name = \"sheet\"\nbounds = [[-20.0, -20.0], [1400.0, -20.0], [1400.0, 20.0], [-20.0, 20.0]]\n\
                     [population]\nagents = 64\n\
                     [[routes]]\nname = \"line\"\nwaypoints = [[0.0, 0.0], [1300.0, 0.0]]\n";

/// Draws the sheet; the device that drew it, too.
pub(super) fn sheet(place: &PlaceArguments, progress: &mut dyn FnMut(f64)) -> Result<(Image, String), Error> {
    let settings = Settings {
        shadow_size: 1024,
        // the sun stands where both cameras see the lit side
        atmosphere: Atmosphere { haze: 0.0, sun_direction: Vec3::new(-0.5, 0.8, 0.6), ..Atmosphere::DAY },
        ..Settings::sized(TILE.0, TILE.1)
    };
    let mut stage = {
        let (backend, device) = place.get()?;
        Stage::new(scene()?.on(backend, device), settings)?
    };
    let (distance, fov) = CAMERA;
    stage.show().set_level_distances([1e3, 2e3, distance * 1.5]);
    let total = stage.scene.crowd.agents.len();
    let mut pictures = Vec::with_capacity(total);
    for number in 0..total {
        let agent = &stage.scene.crowd.agents[number];
        let at = Vec3::new(agent.position.x, 0.94, agent.position.y);
        let is_side = agent.avatar == 0;
        let (caption, direction) = (caption(number), if is_side { Vec3::NEG_X } else { Vec3::Z });
        // a woman walks towards +z and is seen from her right, a man walks towards the camera
        let camera = Camera::look_at(at + direction * distance + Vec3::Y * 0.15, at, Vec3::Y).with_fov(fov);
        pictures.push((caption, stage.picture(&camera)?));
        #[allow(clippy::cast_precision_loss, reason = "a few dozen")]
        progress((number + 1) as f64 / total as f64);
    }
    let tiles: Vec<Tile<'_>> = pictures.iter().map(|(caption, image)| Tile { caption, image }).collect();
    let image = contact_sheet(&tiles, PHASES).map_err(crate::export::Error::from)?;
    Ok((image, stage.device()))
}

fn caption(number: usize) -> String {
    let phases = PHASES as usize;
    let emotion = Emotion::ALL[(number / (phases * ROWS as usize)).min(3)];
    match number % phases {
        0 => emotion.name().to_uppercase(),
        phase => format!("{phase}/{phases}"),
    }
}

/// One agent per tile.
fn scene() -> Result<Scene, Error> {
    let scenario = Scenario::parse(PLACE, "contact sheet")?;
    let library = GaitLibrary::built_in()?;
    // all in the same clothes: what differs is how they walk
    let bodies = avatar::Sex::ALL.map(|sex| Avatar { wardrobe: None, ..avatar::generated(sex) });
    let cast = AvatarSet::new(library.gaits(), bodies.to_vec())?;
    let mut crowd = Crowd { stages: vec![Stop::waypoint(Vec2::ZERO, 1.0)], ..Crowd::default() };
    for emotion in Emotion::ALL {
        for (row, sex) in (0..ROWS).zip(Sex::ALL) {
            let gait = library.choose(emotion, Some(sex), 0)?;
            for phase in 0..PHASES {
                crowd.agents.push(walker(crowd.agents.len(), emotion, (row, gait), phase));
            }
        }
    }
    Ok(Scene::of_crowd(scenario, crowd, cast))
}

fn walker(place: usize, emotion: Emotion, (avatar, gait): (u32, u32), phase: u32) -> AgentStart {
    const TOPS: [u32; 4] = [0x00d8_a03c, 0x009a_3b3b, 0x0046_6a96, 0x0086_8a86];
    #[allow(clippy::cast_precision_loss, reason = "a few dozen")]
    let x = place as f32 * APART;
    AgentStart {
        emotion: emotion.weights(),
        gaits: [gait; 4],
        avatar,
        colors: [0x00d2_9f7b, 0x0033_241b, TOPS[emotion.index()], 0x002a_3b55],
        phase: phase * (u32::MAX / PHASES),
        waypoint: 0,
        ..AgentStart::at(Vec2::new(x, 0.0))
    }
}
