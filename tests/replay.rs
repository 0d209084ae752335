//! Claims about recordings of crowds: what is read, and how it is walked again.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::needless_range_loop,
    clippy::print_stdout,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a failing unwrap fails the test, counts are small, and what was measured is printed"
)]

#[path = "replay/data.rs"]
mod data;
#[path = "common/gpu.rs"]
mod gpu;
#[path = "replay/reading.rs"]
mod reading;
#[path = "replay/walking.rs"]
mod walking;
