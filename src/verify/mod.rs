//! Runs every kernel against its CPU twin.

pub mod cases;
