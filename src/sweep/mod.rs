//! Sweeps: many runs of one scenario, planned on one machine and done on any number of them.
//!
//! ```text
//!  sweep.toml ──► SweepFile ──► Plan ──► plan.jsonl ──► one run after the other, anywhere ──► runs/run=KEY/
//! ```
//! A run is a pure function of what its [`key`] is made of: version, scenario, values, seed, length and what is written. So
//! a scheduler needs to know nothing of it: a folder of that name is a run that is done ([`folder`]).

mod error;
mod file;
pub mod folder;
pub mod key;
mod plan;

pub use error::Error;
pub use file::{Seeds, SweepFile};
pub use plan::{Header, OutsideFile, Plan, PlannedRun};
