//! Who takes part beside the participant: the store, and the operator.

use crate::study::lab::Order;
use crate::study::protocol::{Event, Page, PageQuestion};
use crate::study::theatre::Showing;

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

    /// The text to agree to, by the name that the page gives it.
    ///
    /// # Errors
    /// When there is no such text.
    fn consent(&mut self, name: &str) -> Result<ConsentText, crate::Error>;

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

/// A text to agree to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConsentText {
    /// The text, Markdown.
    pub text: String,
    /// Its hash, which the store keeps.
    pub hash: String,
}

/// Who sits beside the participant.
pub trait Operator {
    /// Takes a line to read.
    fn note(&mut self, line: &str);

    /// What the operator wants, if anything; asked often.
    fn order(&mut self) -> Option<Order> {
        None
    }

    /// Whether the participant has agreed to this text and is old enough (years); none while that is not said. Asked often.
    fn agreed(&mut self, text: &str, minimum_age: u32) -> Option<bool>;

    /// The participant is asked a question of a page from now on.
    fn asks(&mut self, page: &str, question: &PageQuestion);

    /// The answer to that question as far as it was typed; asked often.
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
