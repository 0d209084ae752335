//! A scene on stage: its crowd in motion, a renderer, cameras.

use super::{Error, Scene};
use crate::ground::world_from_ground;
use crate::picture::Image;
use crate::render::camera::{OrbitControl, View};
use crate::render::{Atmosphere, Camera, Settings, Show};
use crate::scenario::Layout;
use crate::sim::Simulation;
use glam::{Vec2, Vec3};
use std::num::ParseIntError;
use std::str::FromStr;

/// How fast the orbiting camera goes round, radians/s.
const ORBIT_RATE: f64 = 0.12;
/// How far behind an agent the following camera is, m.
const FOLLOW_DISTANCE: f32 = 3.5;
/// Room about the place on a map, as a factor.
const MAP_MARGIN: f32 = 1.04;

/// Which camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CameraChoice {
    /// The user's eyes, or an onlooker's where the scene has no user.
    Eyes,
    /// The scene at a glance, slowly going round in videos.
    Orbit,
    /// A map.
    Top,
    /// Over an agent's shoulder; when the agent has left, where it was last seen.
    Follow(u32),
}

/// Text that is no [`CameraChoice`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraChoiceError {
    /// What stands behind `follow:` is no number of an agent.
    #[error("agent {agent:?}: {reason}")]
    Agent {
        /// What stands there.
        agent: String,
        /// Why that is none.
        reason: ParseIntError,
    },
    /// There is no such camera.
    #[error("use eyes, orbit, top, follow or follow:AGENT")]
    Unknown,
}

impl FromStr for CameraChoice {
    type Err = CameraChoiceError;

    fn from_str(text: &str) -> Result<Self, CameraChoiceError> {
        match text.split_once(':') {
            None if text == "eyes" => Ok(Self::Eyes),
            None if text == "orbit" => Ok(Self::Orbit),
            None if text == "top" => Ok(Self::Top),
            None if text == "follow" => Ok(Self::Follow(0)),
            Some(("follow", agent)) => agent
                .parse()
                .map(Self::Follow)
                .map_err(|reason| CameraChoiceError::Agent { agent: agent.to_owned(), reason }),
            _ => Err(CameraChoiceError::Unknown),
        }
    }
}

/// A crowd in motion that can be drawn.
///
/// ```no_run
/// use gaitway::render::Settings;
/// use gaitway::scene::{CameraChoice, Scene, Stage};
///
/// # fn main() -> gaitway::Result<()> {
/// let mut stage = Stage::new(Scene::load("garden")?.build()?, Settings::sized(1280, 720))?;
/// for frame in 0..100_u8 {
///     stage.step(1)?;
///     let camera = stage.camera(CameraChoice::Orbit, f64::from(frame) / 30.0)?;
///     let image = stage.picture(&camera)?;
///     println!("{} by {} pixels", image.width, image.height);
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Stage {
    /// What is on stage.
    pub scene: Scene,
    /// Its crowd in motion.
    pub simulation: Simulation,
    show: Show,
    size: (u32, u32),
    /// Where the camera was that followed an agent, for when the agent is gone.
    followed: Option<Camera>,
}

impl Stage {
    /// Puts a scene on stage, in the light of its place unless `settings` say otherwise.
    ///
    /// # Errors
    /// As [`Scene::start`], and when no Vulkan device can draw.
    pub fn new(scene: Scene, settings: Settings) -> Result<Self, crate::Error> {
        let (mut simulation, meshes) = scene.start_with_bodies()?;
        let scenery = scene.geometry.scenery_of(settings.quality.finish());
        let mut show = Show::new(&mut simulation, &meshes, &scenery, settings, scene.device.as_deref())?;
        show.set_gaze(&scene.scenario.gaze);
        Ok(Self { scene, simulation, show, size: (settings.width, settings.height), followed: None })
    }

    /// Does steps without drawing.
    ///
    /// # Errors
    /// When the simulation fails.
    pub fn step(&mut self, count: u32) -> Result<(), crate::Error> {
        self.scene.step(&mut self.simulation, count)
    }

    /// The device that draws.
    pub fn device(&self) -> String {
        self.show.device()
    }

    /// The device that simulates, and the one that draws if it is another.
    pub fn devices(&self) -> String {
        let (simulates, draws) = (self.simulation.device(), self.device());
        if simulates == draws { draws } else { format!("{simulates}, drawn on {draws}") }
    }

    /// Pixels a row, and rows.
    pub const fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Draws in another size from now on.
    ///
    /// # Errors
    /// When the device fails.
    pub fn resize(&mut self, size: (u32, u32)) -> Result<(), crate::Error> {
        self.show.renderer().resize(size.0, size.1)?;
        self.size = size;
        Ok(())
    }

    /// What draws.
    pub const fn show(&mut self) -> &mut Show {
        &mut self.show
    }

    /// A camera as it stands `since` seconds after the first picture.
    ///
    /// # Errors
    /// [`Error::NoAgent`] when an agent that is to be followed is not there; when the device fails.
    pub fn camera(&mut self, name: CameraChoice, since: f64) -> Result<Camera, crate::Error> {
        let geometry = &self.scene.geometry;
        Ok(match name {
            CameraChoice::Eyes => {
                let (eyes, heading) = self.scene.onlooker();
                Camera::user_eyes(eyes, heading, 0.0)
            }
            CameraChoice::Orbit => {
                let (eye, target) = geometry.overview;
                orbit(eye, target, since)
            }
            CameraChoice::Top => {
                let low = geometry.bounds.iter().copied().fold(Vec2::MAX, Vec2::min);
                let high = geometry.bounds.iter().copied().fold(Vec2::MIN, Vec2::max);
                let aspect = crate::render::camera::aspect(self.size.0, self.size.1);
                let extent = high - low;
                Camera::top((low + high) * 0.5, MAP_MARGIN * extent.y.max(extent.x / aspect))
            }
            CameraChoice::Follow(agent) => self.follow(agent)?,
        })
    }

    fn follow(&mut self, agent: u32) -> Result<Camera, crate::Error> {
        let agents = self.simulation.agent_count();
        if agent >= agents {
            return Err(Error::NoAgent { agent, agents }.into());
        }
        if let Some(person) = self.simulation.person(agent)? {
            let at = world_from_ground(person.position, person.elevation);
            self.followed = Some(Camera::follow(at, person.heading, FOLLOW_DISTANCE));
        }
        let (eye, target) = self.scene.geometry.overview;
        Ok(self.followed.unwrap_or_else(|| orbit(eye, target, 0.0)))
    }

    /// A picture through a camera.
    ///
    /// # Errors
    /// When the device fails.
    pub fn picture(&mut self, camera: &Camera) -> Result<Image, crate::Error> {
        let view = View::mono(camera, self.size.0, self.size.1);
        let eyes = self.scene.geometry.eyes(&self.scene.scenario);
        self.show.draw(&mut self.simulation, &view, eyes)
    }

    /// Draws a picture and leaves it on the device: for timings.
    pub(crate) fn make(&mut self, camera: &Camera) -> Result<(), crate::Error> {
        let view = View::mono(camera, self.size.0, self.size.1);
        let eyes = self.scene.geometry.eyes(&self.scene.scenario);
        self.show.make(&mut self.simulation, &view, eyes)
    }
}

/// The light of a place.
pub const fn atmosphere(layout: Layout) -> Atmosphere {
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
    fn cameras_are_read_and_wrong_ones_refused_with_the_way_out() {
        assert_eq!("follow:12".parse(), Ok(CameraChoice::Follow(12)));
        assert_eq!("top".parse(), Ok(CameraChoice::Top));
        let refused = |text: &str| text.parse::<CameraChoice>().unwrap_err().to_string();
        assert_eq!(refused("follow:x"), "agent \"x\": invalid digit found in string");
        assert_eq!(refused("behind"), "use eyes, orbit, top, follow or follow:AGENT");
    }

    #[test]
    fn the_orbit_begins_where_the_overview_is() {
        let (eye, target) = (Vec3::new(3.0, 5.0, -7.0), Vec3::new(0.0, 1.0, 0.0));
        assert!((orbit(eye, target, 0.0).position - eye).length() < 1e-4);
        assert!((orbit(eye, target, 1.0).position - eye).length() > 0.5);
    }
}
