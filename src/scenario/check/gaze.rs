//! Gaze.

use super::ranges::{count, ends};
use crate::scenario::error::Error;
use crate::scenario::file::{Budget, Gaze};

pub(super) fn check(gaze: &Gaze) -> Result<(), Error> {
    if let Some(Budget::Most(most)) = gaze.budget {
        count("gaze.budget", most)?;
    }
    ends("gaze.turn", gaze.turn, "")
}
