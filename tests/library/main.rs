//! The procedural walker and the gait library, seen from outside.

mod differences;
mod file;
mod picture;
mod walking;
