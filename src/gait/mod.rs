//! A gait is one walk cycle of the paper's 16 joints: captured, imported or generated.
//!
//! Recordings (files of many frames, with the walker's travel) become gaits by [`stride`] extraction; the
//! procedural [`walker`] makes gaits from nothing. Paper: section 3, `G = {P_1 … P_tau}`.
//!
//! ```
//! use gaitway::Emotion;
//! use gaitway::gait::walker::{Sex, person};
//! use gaitway::gait::{import, stride};
//!
//! # fn main() -> gaitway::Result<()> {
//! let sad = person(Emotion::Sad, Sex::Female, 1, 0)?;
//! println!("{}: {:.2} m/s, {:.2} s a stride", sad.name, sad.speed, sad.cycle_time());
//! # if std::path::Path::new("walk.bvh").exists() {
//! for take in import::import_file("walk.bvh".as_ref())? {
//!     let gait = stride::best(&take)?; // the steadiest stride of the take
//!     println!("{}: {:.2} m/s", gait.name, gait.speed);
//! }
//! # }
//! # Ok(())
//! # }
//! ```

pub mod fit;
pub mod import;
mod norm;
mod provenance;
pub mod skeleton;
pub mod stride;
pub mod walker;

use crate::emotion::Emotion;
use glam::Vec3;
pub use provenance::{LabelOrigin, Provenance};
pub use skeleton::{JOINT_COUNT, Joint, JointSet};

/// Positions of the 16 joints, indexed by [`Joint`], metres, y up.
pub type Pose = [Vec3; JOINT_COUNT];

/// A take as it came from a file: world positions with the walker's travel, on our 16 joints.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// Name, usually the file stem.
    pub name: String,
    /// Frames per second, Hz.
    pub frame_rate: f32,
    /// Poses `[frame][joint]`, metres, y up, world frame of the file turned to y up.
    pub poses: Vec<Pose>,
    /// Whether the poses are whole walk cycles, so that frame 0 follows the last frame.
    pub cyclic: bool,
    /// Where it comes from.
    pub provenance: Provenance,
    /// The style the actor was asked for, if an index beside the file says so.
    pub acted: Option<String>,
    /// The perceived emotion, if an index beside the file says so.
    pub label: Option<Emotion>,
    /// Joints that were not captured; a standing body's stand in for them.
    pub missing: JointSet,
    /// What the importer inferred (unit, up axis, rate, joint map) and had to repair, one line each.
    pub report: Vec<String>,
}

impl Recording {
    /// A take of `poses` at `frame_rate` (Hz) that is not cyclic and of which nothing else is known.
    pub fn new(name: impl Into<String>, frame_rate: f32, poses: Vec<Pose>) -> Self {
        Self { name: name.into(), frame_rate, poses, ..Self::default() }
    }
}

/// One walk cycle.
///
/// `poses` covers phase [0, 1) at equal steps: frame `i` is phase `i / poses.len()`, and frame 0 follows the
/// last one. Phase 0 is the foot strike of the **left** foot. The walker stands at the origin and walks
/// towards +z on the spot: its mean horizontal travel is taken out (natural sway about it stays), feet touch y = 0.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Gait {
    /// Unique name within a library.
    pub name: String,
    /// Poses `[frame][joint]`, metres, y up, facing +z.
    pub poses: Vec<Pose>,
    /// Frames per second of `poses`, Hz; `poses.len() / frame_rate` is the cycle time.
    pub frame_rate: f32,
    /// Preferred speed `v_des` in m/s: travel over one stride divided by its duration (A-11).
    pub speed: f32,
    /// Where it comes from, the person, and the origin of the label.
    pub provenance: Provenance,
    /// The style the actor was asked for, if known. Acted is not perceived.
    pub acted: Option<String>,
    /// Mean responses `r^e` to the four questions, 1 to 5, in the order of [`Emotion::ALL`].
    pub ratings: Option<[f32; 4]>,
    /// The perceived emotion, if the gait is expressive.
    pub label: Option<Emotion>,
    /// Joints that were not captured. They walk as the neutral walker's, and say nothing about the person.
    pub missing: JointSet,
}

impl Gait {
    /// Sets a label that a model gave; `by` is words for the model, such as `affective-svm (p 0.83)`. What an earlier
    /// model said is forgotten; ratings stay.
    pub fn set_predicted(&mut self, emotion: Emotion, by: &str) {
        self.label = Some(emotion);
        self.provenance.label_origin = Some(LabelOrigin::Predicted);
        self.provenance.label_model = Some(by.to_owned());
    }

    /// That every joint was captured, which all that judges a gait needs.
    ///
    /// # Errors
    /// [`Error::Unusable`] with the names of the joints that were not.
    pub fn check_whole(&self) -> Result<(), Error> {
        if self.missing.is_empty() {
            return Ok(());
        }
        let message = format!(
            "not captured: {}; judging a gait needs all {JOINT_COUNT} joints (it can still be walked with)",
            self.missing
        );
        Err(Error::Unusable { name: self.name.clone(), message })
    }

    /// Seconds per stride, the paper's gait time `gt`.
    pub fn cycle_time(&self) -> f32 {
        self.poses.len() as f32 / self.frame_rate
    }

    /// Metres of ground covered by one stride at [`Gait::speed`]. (Not the paper's feature `stride_length`.)
    pub fn stride_travel(&self) -> f32 {
        self.speed * self.cycle_time()
    }

    /// The paper's stride length: largest distance between the feet over the cycle, m (equation 2).
    pub fn stride_length(&self) -> f32 {
        let apart = |pose: &Pose| pose[Joint::LeftFoot as usize].distance(pose[Joint::RightFoot as usize]);
        self.poses.iter().map(apart).fold(0.0, f32::max)
    }
}

/// A motion file or gait could not be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file could not be read.
    #[error("cannot read {path:?}: {source}")]
    Read {
        /// The file.
        path: std::path::PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file is not what its format demands.
    #[error("{path}:{line}: {message}")]
    Syntax {
        /// The file, as named to the importer.
        path: String,
        /// Line number from 1; 0 when the fault is the file as a whole.
        line: usize,
        /// What is wrong, with the value found and what was expected.
        message: String,
    },
    /// The motion cannot be used as a gait.
    #[error("gait {name:?}: {message}")]
    Unusable {
        /// Recording or gait.
        name: String,
        /// Why, with values and allowed range.
        message: String,
    },
}
