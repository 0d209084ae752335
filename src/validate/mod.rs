//! Does it move like people? Small scenes with known outcomes, and what real crowds did.

pub mod diagram;
pub mod files;
pub mod measure;
pub mod scene;
pub mod tracks;
