//! Who gets what: a study with its stimuli, the trials of each participant, and the ledger of places.
//!
//! [`Plan`] is a study made ready: its steps in order, its questions spelled out, its stimuli by name. It does not change while
//! the study runs. [`Ledger`] counts what was given and answered, and gives places. Designs: [`fill`], [`blocks`], [`square`].

mod account;
pub mod blocks;
mod compile;
mod draw;
pub mod fill;
mod ledger;
mod questions;
mod rows;
pub mod square;
mod trials;
pub mod williams;

pub use compile::{Ending, Plan, Shows, Step, StepKind, TrialsStep};
pub(super) use draw::{Purpose, random, word};
pub use ledger::{Counts, Ledger, Place};
pub(super) use questions::prompts;
pub use questions::{BUILT_IN_QUESTIONS, Prompt, Scale};
pub use rows::Rows;
pub use trials::{Role, Stimulus, Swap, Trial};
