//! A panel to be answered, and the answer.

use super::answer::Means;
use super::panel::{Choice, Panel};
use crate::picture::Image;

/// A panel that is to be shown.
#[derive(Debug)]
pub(super) struct Question {
    /// Names it among all of this program.
    pub(super) number: u64,
    pub(super) panel: Panel,
    pub(super) targets: Vec<Choice>,
    /// Without what its answer so far adds.
    pub(super) picture: Image,
}

/// The answer to a panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answered {
    /// What was chosen.
    pub choice: Choice,
    /// How.
    pub means: Means,
    /// From the display time of the first frame that showed the panel to that of the last one before the choice, s. Of a
    /// gap between two frames no more than a second counts.
    pub seconds: f64,
    /// The frames that showed it so far.
    pub frames: u64,
}
