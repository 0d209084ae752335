//! Studies: files, plans, the protocol, simulated participants.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::float_cmp,
    clippy::needless_range_loop,
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "tests: a failure is a panic that prints, counts are small, and equal means equal"
)]

mod analyse;
mod blocks;
mod check;
mod export;
mod fill;
mod fronts;
mod protocol;
mod questionnaires;
mod report;
mod scoring_keys;
mod simulate;

use gaitway::study::plan::Plan;
use gaitway::study::{Materials, Study};

/// Names of walks.
fn walks(count: usize) -> Vec<String> {
    (1..=count).map(|number| format!("walk {number}")).collect()
}

/// The plan of a built-in study, with a library of so many walks.
fn plan(name: &str, count: usize) -> Plan {
    let materials = Materials::default().with_gaits("library.glb", walks(count));
    Plan::of(&Study::builtin(name).unwrap().file, &materials).unwrap()
}
