//! The procedural walker and the gait library, seen from outside.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    clippy::unwrap_used,
    reason = "numbers of tests are small and their helpers may fail loudly"
)]

mod choose;
mod differences;
mod file;
mod picture;
mod walking;
