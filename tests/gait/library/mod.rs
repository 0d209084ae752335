//! The procedural walker and the gait library, seen from outside.

mod choose;
mod differences;
mod file;
mod picture;
mod walking;
