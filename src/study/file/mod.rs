//! What a study file says: types for serde, their units and defaults. Depends on nothing else in `study` but its texts.

mod analysis;
mod credit;
mod helpers;
mod parts;
mod questions;
mod schema;
mod sections;

pub use analysis::{Adjust, Analysis, FollowUp, Ratings, Scoring, Test, Zeros};
pub(in crate::study) use credit::{CreditFault, credit};
pub use helpers::Names;
pub use parts::{Agents, Check, Design, Form, Part, RightChoice, Seeds, Show, Text, Trials};
pub(super) use questions::RATING_POINTS;
pub use questions::{ItemOrder, LikertItem, Points, Question};
pub use schema::{Introduction, StudyFile};
pub use sections::{
    Codes, Consent, Crowd, Data, Exclude, Front, Headset, OnWithdrawal, Platform, Pointer, Recruit,
    Registration,
};
