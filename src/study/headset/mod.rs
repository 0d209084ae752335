//! A study in a headset: the pages of the [protocol](super::protocol) on one [stage](crate::xr::Stage).
//!
//! ```text
//!  store ── page ──► front ── panel, world ──► stage ──► headset
//!    ▲                 │                         │
//!    └──── event ◄─────┴──── answer, walk ◄──────┘
//! ```
//!
//! The front shows the current page and sends what comes of it; the store keeps it and says what page follows. So a program that
//! was killed goes on where it was: the store tells. What cannot be answered in a headset (a number to be written, free text) the
//! participant says, and the [`Operator`] types.
//!
//! The world of the next trial is made while the questions of the current one are answered. Every trial is recorded. One in which the
//! headset was away for a second or more is shown again.

mod front;
#[cfg(feature = "study")]
mod kept;
mod panels;
mod parties;
mod questions;
mod trial;
mod watch;
mod words;

pub use super::lab::Order;
pub use super::theatre::{Showing, Theatre};
pub use front::{Front, Setup};
#[cfg(feature = "study")]
pub use kept::Kept;
pub use parties::{ConsentText, Operator, Participation, Typed};
