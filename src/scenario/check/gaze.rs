//! Gaze.

use crate::scenario::error::Error;
use crate::scenario::file::{Budget, Gaze, MAX_AGENTS};

pub(super) fn check(gaze: &Gaze) -> Result<(), Error> {
    if let Some(Budget::Most(count)) = gaze.budget
        && count > MAX_AGENTS
    {
        let allowed = format!("0 to {MAX_AGENTS}, or \"all\"");
        return Err(Error::value("gaze.budget", count, allowed, "12 is usual"));
    }
    let [least, most] = gaze.turn;
    if !(least >= 0.1 && least <= most && most <= 60.0) {
        let allowed = "[shortest, longest] within 0.1 to 60 s";
        return Err(Error::value("gaze.turn", format!("[{least}, {most}]"), allowed, "try [1, 4]"));
    }
    Ok(())
}
