//! Simulated participants: whole studies through the very protocol, without a person.
//!
//! Ratings: `z = a_i^e + b_j + ε`, cut by thresholds to the points of the scale; `a_i^e` is what gait i shows of emotion e, `b_j` is how
//! far rater j agrees with anything. Scenes: `q = μ_scene + δ_condition + u_person + trend · position + ε`, cut to the scale.
//! Identification: a row of a confusion matrix. A share answers at random; others leave, withdraw or come back late.
//!
//! The participants share one store in simulated time, many at once, and their leases lapse as those of people do. Their front is
//! [`Front::Simulated`](crate::study::file::Front): an analysis never mixes them with people.

mod agents;
mod draws;
mod habits;
mod people;
mod ratings;
mod run;
mod store;
mod tables;

pub use agents::{Confusion, LinearModel, PAPER_CONFUSION};
pub use habits::{Habits, hazard};
pub use ratings::RatingModel;
pub use run::{Minds, Setup, run};
pub use store::Store;
pub(super) use tables::answers;
pub use tables::{AnswerRow, Participant, Run, mean_ratings};
