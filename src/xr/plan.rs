//! The parameters of a session.

use super::Error;
use super::answer::Means;
use super::mirror::Mirror;
use super::runtime::Runtime;
use crate::gpu::Validation;
use crate::picture::Image;
use crate::render::{Face, Quality};
use std::sync::Arc;

/// How far the edge of the view is darkened by default while a stick moves the user.
pub const DEFAULT_VIGNETTE: f32 = 0.7;

/// What a frame showed.
#[derive(Debug)]
pub struct Shot {
    /// Its number.
    pub frame: u64,
    /// Both eyes, left beside right.
    pub image: Image,
    /// Midpoint of the user's eyes in the world, m.
    pub user_eyes: glam::Vec3,
    /// The faces of the agents that were drawn.
    pub faces: Vec<Face>,
}

/// Takes what a frame showed.
pub type Shots = Box<dyn FnMut(&Shot) -> Result<(), crate::Error> + Send>;

/// Finds the runtime; called again after every loss.
pub type Opener = Box<dyn Fn() -> Result<Runtime, Error> + Send>;

/// The parameters of a session.
pub struct Plan {
    /// Time until the session is ended, s; none: until the runtime ends it.
    pub seconds: Option<f64>,
    /// Pixels of one eye; none: as the runtime recommends.
    pub eye_size: Option<[u32; 2]>,
    /// Refresh rate of the display to ask for, Hz: the nearest that is offered; none: the runtime's.
    pub refresh_rate: Option<f32>,
    /// Whether sticks move the user. In a study they walk in their room.
    pub moves: bool,
    /// How far the edge of the view is darkened while a stick moves the user, 0 not at all to 1.
    pub vignette: f32,
    /// How much [`run`](super::run) spends on light and surfaces.
    pub quality: Quality,
    /// How panels may be answered. A look counts only while no controller is there, unless it comes first.
    pub means: Vec<Means>,
    /// Whether to wait for a runtime or headset that is not there yet.
    pub waits: bool,
    /// Takes what every n-th frame shows: n, and the callback.
    pub shots: Option<(u64, Shots)>,
    /// Takes copies of what the user sees.
    pub mirror: Option<Arc<Mirror>>,
    /// Vulkan's validation on the headset's device.
    pub validation: Validation,
    /// Finds the runtime.
    pub open: Opener,
}

impl std::fmt::Debug for Plan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Plan")
            .field("seconds", &self.seconds)
            .field("eye_size", &self.eye_size)
            .finish_non_exhaustive()
    }
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            seconds: None,
            eye_size: None,
            refresh_rate: None,
            moves: true,
            vignette: DEFAULT_VIGNETTE,
            quality: Quality::Low,
            means: Means::ALL.to_vec(),
            waits: false,
            shots: None,
            mirror: None,
            // the program reports an unknown name when it begins
            validation: Validation::from_environment().unwrap_or_default(),
            open: Box::new(Runtime::open),
        }
    }
}
