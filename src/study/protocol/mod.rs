//! One protocol for browser and headset: a pure function of plan and events gives the page.
//!
//! ```text
//!  arrived ─► consented ─► told ─► checked ─► placed ─► trial 1 … trial n ─► asked ─► debriefed ─► finished
//!     │           │                   │          └ lease renewed by every sign of life                │
//!  declined   withdrawn ◄─ at any time ─┼─ paused, resumed (same page) ─ lapsed ─► back: goes on, place kept if still free
//!                                   screened out                           excluded (operator, with a reason)
//! ```
//!
//! Fronts show pages and send events; a store keeps the events. [`page()`] computes the current page from what is stored, so that
//! resuming is replaying. Nothing here keeps time: events carry theirs.
//!
//! A store hands each event to [`conduct()`], which returns what to write in one transaction: the event, if it is new, and what
//! follows from it. [`Session::page`] is then the answer. Three contents are the store's own business and never last beyond
//! [`conduct()`]: [`Content::Place`] (a place from the [`Ledger`](crate::study::plan::Ledger), or none), [`Content::Lapsed`] (the
//! participant is back) and [`Content::Broken`] (another stimulus). When a store starts it rebuilds sessions and ledger with
//! [`follow`].

mod conduct;
mod event;
mod page;
mod render;
mod session;
mod stops;
mod verdict;

pub use conduct::{conduct, follow, lapse};
pub use event::{Answer, Entry, Event, Exposure};
pub use page::{Content, Page, PageQuestion, Progress};
pub use session::{Given, Session, State};
pub use verdict::{Refusal, Verdict};

use super::plan::Plan;

/// The page of a participant after these events, oldest first.
pub fn page(plan: &Plan, events: &[Entry]) -> Page {
    Session::replay(plan, events).page(plan)
}
