//! A scene on stage: its crowd in motion, a renderer, cameras.

use super::scene::{PlaceArguments, Scene, start};
use super::usage;
use crate::Error;
use crate::ground::world_from_ground;
use crate::picture::Image;
use crate::render::camera::{OrbitControl, View};
use crate::render::{Atmosphere, Camera, Markers, Settings, Show};
use crate::scenario::Layout;
use crate::sim::{Simulation, bodies};
use glam::{Vec2, Vec3};
use std::str::FromStr;

/// How fast the orbiting camera goes round, radians/s.
const ORBIT_RATE: f64 = 0.12;
/// How far behind an agent the following camera is, m.
const FOLLOW_DISTANCE: f32 = 3.5;
/// Room about the place on a map, as a factor.
const MAP_MARGIN: f32 = 1.04;

/// Which camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CameraName {
    /// The user's eyes, or an onlooker's where the scene has no user.
    Eyes,
    /// The scene at a glance, slowly going round in videos.
    Orbit,
    /// A map.
    Top,
    /// Over an agent's shoulder.
    Follow(u32),
}

impl FromStr for CameraName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            None if text == "eyes" => Ok(Self::Eyes),
            None if text == "orbit" => Ok(Self::Orbit),
            None if text == "top" => Ok(Self::Top),
            None if text == "follow" => Ok(Self::Follow(0)),
            Some(("follow", agent)) => {
                agent.parse().map(Self::Follow).map_err(|error| format!("agent {agent:?}: {error}"))
            }
            _ => Err("use eyes, orbit, top, follow or follow:AGENT".to_owned()),
        }
    }
}

/// Width and height of a picture in pixels, written `1280x720`.
pub(super) fn size(text: &str) -> Result<(u32, u32), String> {
    let parts = text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    match parts {
        Some((w, h)) if (1..=16_384).contains(&w) && (1..=16_384).contains(&h) => Ok((w, h)),
        _ => Err("use WIDTHxHEIGHT in pixels, 1 to 16384 each, such as 1280x720".to_owned()),
    }
}

/// A crowd in motion that can be drawn.
#[derive(Debug)]
pub(super) struct Stage {
    pub(super) scene: Scene,
    pub(super) simulation: Simulation,
    show: Show,
    size: (u32, u32),
}

impl Stage {
    /// Puts a scene on stage for pictures of `size`.
    pub(super) fn new(
        scene: Scene,
        place: &PlaceArguments,
        size: (u32, u32),
        has_markers: bool,
    ) -> Result<Self, Error> {
        let settings = Settings {
            atmosphere: atmosphere(scene.scenario.layout),
            markers: has_markers.then(Markers::default),
            ..Settings::sized(size.0, size.1)
        };
        Self::with(scene, place, settings)
    }

    /// The same with other settings.
    pub(super) fn with(scene: Scene, place: &PlaceArguments, settings: Settings) -> Result<Self, Error> {
        let mut store = scene.store()?;
        let meshes = bodies::fill(&mut store, &scene.cast, bodies::SMALLEST_STORAGE_RANGE);
        let mut simulation = start(store, place)?;
        let geometry = &scene.geometry;
        let scenery = geometry.scenery();
        let device = place.device.as_deref();
        let mut show = Show::new(&mut simulation, &meshes, &scenery, settings, device)?;
        show.set_gaze(&scene.scenario.gaze);
        Ok(Self { scene, simulation, show, size: (settings.width, settings.height) })
    }

    /// Does steps without drawing.
    pub(super) fn step(&mut self, count: u32) -> Result<(), Error> {
        self.scene.step(&mut self.simulation, count)
    }

    /// The device that draws.
    pub(super) fn device(&self) -> String {
        self.show.device()
    }

    /// The device that simulates, and the one that draws if it is another.
    pub(super) fn devices(&self) -> String {
        let (simulates, draws) = (self.simulation.device(), self.device());
        if simulates == draws { draws } else { format!("{simulates}, drawn on {draws}") }
    }

    /// Pixels a row, and rows.
    pub(super) const fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Draws in another size from now on.
    pub(super) fn resize(&mut self, size: (u32, u32)) -> Result<(), Error> {
        self.show.renderer().resize(size.0, size.1)?;
        self.size = size;
        Ok(())
    }

    /// What draws.
    pub(super) fn show(&mut self) -> &mut Show {
        &mut self.show
    }

    /// A camera as it stands `since` seconds after the first picture.
    pub(super) fn camera(&mut self, name: CameraName, since: f64) -> Result<Camera, Error> {
        let geometry = &self.scene.geometry;
        Ok(match name {
            CameraName::Eyes => {
                let (eyes, heading) = self.scene.onlooker();
                Camera::user_eyes(eyes, heading, 0.0)
            }
            CameraName::Orbit => {
                let (eye, target) = geometry.overview;
                orbit(eye, target, since)
            }
            CameraName::Top => {
                let low = geometry.bounds.iter().copied().fold(Vec2::MAX, Vec2::min);
                let high = geometry.bounds.iter().copied().fold(Vec2::MIN, Vec2::max);
                let aspect = crate::render::camera::aspect(self.size.0, self.size.1);
                let extent = high - low;
                Camera::top((low + high) * 0.5, MAP_MARGIN * extent.y.max(extent.x / aspect))
            }
            CameraName::Follow(agent) => self.follow(agent)?,
        })
    }

    fn follow(&mut self, agent: u32) -> Result<Camera, Error> {
        let store = self.simulation.state()?;
        let agents = store.step.agent_count;
        let index = agent as usize;
        match (store.position.get(index), store.stance.get(index), store.elevation.get(index)) {
            (Some(position), Some([heading, ..]), Some(elevation)) if agent < agents => {
                let at = world_from_ground(Vec2::from_array(*position), *elevation);
                Ok(Camera::follow(at, *heading, FOLLOW_DISTANCE))
            }
            _ => Err(usage(
                format!("--camera follow:{agent}: there are {agents} agents"),
                format!("use follow:0 to follow:{}, or more --agents", agents.saturating_sub(1)),
            )),
        }
    }

    /// A picture through a camera.
    pub(super) fn picture(&mut self, camera: &Camera) -> Result<Image, Error> {
        let view = View::mono(camera, self.size.0, self.size.1);
        let eyes = self.scene.geometry.eyes(&self.scene.scenario);
        self.show.picture(&mut self.simulation, &view, eyes)
    }
}

/// The light of a place.
pub(super) const fn atmosphere(layout: Layout) -> Atmosphere {
    match layout {
        Layout::Scifi => Atmosphere { exposure: 1.6, ..Atmosphere::EVENING },
        _ => Atmosphere::DAY,
    }
}

/// The camera at `eye`, gone round `target` for a while.
fn orbit(eye: Vec3, target: Vec3, since: f64) -> Camera {
    let arm = eye - target;
    #[allow(clippy::cast_possible_truncation, reason = "an angle")]
    let turned = (since * ORBIT_RATE) as f32;
    let control = OrbitControl {
        target,
        distance: arm.length(),
        azimuth: arm.x.atan2(arm.z) + turned,
        elevation: arm.y.atan2(arm.x.hypot(arm.z)),
    };
    control.camera()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_and_sizes_are_read_and_wrong_ones_refused_with_the_way_out() {
        assert_eq!("follow:12".parse(), Ok(CameraName::Follow(12)));
        assert_eq!("top".parse(), Ok(CameraName::Top));
        assert!("follow:x".parse::<CameraName>().unwrap_err().contains("\"x\""));
        assert!("behind".parse::<CameraName>().unwrap_err().contains("orbit"));
        assert_eq!(size("640x360"), Ok((640, 360)));
        for wrong in ["640", "0x10", "99999x1", "ax2", ""] {
            assert!(size(wrong).unwrap_err().contains("1280x720"), "{wrong}");
        }
    }

    #[test]
    fn the_orbit_begins_where_the_overview_is() {
        let (eye, target) = (Vec3::new(3.0, 5.0, -7.0), Vec3::new(0.0, 1.0, 0.0));
        assert!((orbit(eye, target, 0.0).position - eye).length() < 1e-4);
        assert!((orbit(eye, target, 1.0).position - eye).length() > 0.5);
    }
}
