//! Avatars: low-polygon bodies, generated or loaded, reduced to the 16 joints that gaits drive, and the
//! offline retargeting of gaits onto them.
//!
//! Any rigged character is reduced on loading: a joint that no gait drives (fingers, twist helpers) is
//! rigid to its nearest driven ancestor, so its weights move there and the shape in the rest pose is unchanged.
//! Toes are no joints either, but the device bends what lies before the ball of a foot.
//! Every avatar therefore has exactly the 16 joints of [`Joint`](crate::gait::Joint) and the device needs one layout only.
//!
//! ```
//! use gaitway::avatar::{Sex, generated, retarget};
//! use gaitway::{Emotion, GaitLibrary};
//!
//! # fn main() -> gaitway::Result<()> {
//! let avatar = generated(Sex::Male); // or avatar::load("hero.glb".as_ref())?
//! let library = GaitLibrary::built_in()?;
//! let angry = &library.gaits()[library.gaits_for(Emotion::Angry)[0] as usize];
//! let clip = retarget(angry, &avatar)?;
//! println!("{} of {:.2} m walks {} at {:.2} m/s", avatar.name, avatar.height, angry.name, clip.speed);
//! # Ok(())
//! # }
//! ```

#[doc(hidden)]
pub mod anthropometry;
mod body;
mod body_model;
mod error;
mod far;
pub(crate) mod foot;
mod glb;
pub(crate) mod kinematics;
#[cfg_attr(not(feature = "import"), path = "without_import.rs")]
mod load;
mod model;
mod posture;
mod retarget;
mod rig_map;
mod standing;
pub(crate) mod waist;
#[doc(hidden)]
pub mod wardrobe;

pub use body::{Sex, generated};
pub use body_model::{
    Avatar, CLIP_FRAMES, Clip, ClipFrame, FaceVertex, LEVELS, Material, Mesh, RestJoint, Vertex,
};
pub use error::Error;
pub use far::{FarMesh, FarVertex, Limb};
pub use glb::{glb, write_glb};
pub(crate) use load::place;
pub use load::{load, load_bytes, load_with_map, model, triangles};
pub use model::{Loaded, Model};
#[doc(hidden)]
pub use model::{Paint, PaintCorner, PlaceModel, PlaceVertex, Textured, TexturedMaterial};
pub use posture::Posture;
pub use retarget::retarget;
pub use rig_map::RigMap;
pub use standing::standing;
