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
//! The world of the next trial is made while the questions of the current one are answered. Every trial is recorded.

mod front;
mod panels;
mod watch;

pub use super::theatre::{Showing, Theatre};
pub use front::{Front, Order, Setup};

use super::protocol::{Event, Page, PageQuestion};

/// A participation in a store. An event is stored when the call returns.
pub trait Participation {
    /// The current page.
    ///
    /// # Errors
    /// When the store fails.
    fn page(&mut self) -> Result<Page, crate::Error>;

    /// Stores an event. Returns the page after it.
    ///
    /// # Errors
    /// When the store fails or refuses it.
    fn submit(&mut self, event: Event) -> Result<Page, crate::Error>;

    /// What the current trial shows; none between trials.
    ///
    /// # Errors
    /// When the store fails.
    fn trial(&mut self) -> Result<Option<Showing>, crate::Error>;

    /// What the next trial of the part will show, as far as that is known.
    ///
    /// # Errors
    /// When the store fails.
    fn next_trial(&mut self) -> Result<Option<Showing>, crate::Error>;
}

/// Who sits beside the participant.
pub trait Operator {
    /// Takes a line to read.
    fn note(&mut self, line: &str);

    /// What the operator wants, if anything; asked often.
    fn order(&mut self) -> Option<Order> {
        None
    }

    /// Whether the participant has agreed to this text and is old enough: the hash of the text. None if not.
    fn agreed(&mut self, text: &str, minimum_age: u32) -> Option<String>;

    /// The answer to a question that is not asked in the headset, as far as it was typed; asked often.
    fn typed(&mut self, question: &PageQuestion) -> Typed;
}

/// What the operator typed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Typed {
    /// Nothing yet.
    Waiting,
    /// Left out.
    LeftOut,
    /// A number.
    Number(i64),
    /// A text.
    Text(String),
}
