//! The user.

use super::ranges::{point, within};
use crate::scenario::error::Error;
use crate::scenario::file::User;

pub(super) fn check(user: &User) -> Result<(), Error> {
    if let Some(position) = user.position {
        point("user.position", position)?;
    }
    within("user.heading_deg", user.heading_deg)?;
    within("user.elevation", user.elevation)?;
    within("user.eye_height", user.eye_height)?;
    within("user.radius", user.radius)?;
    within("user.comfort", user.comfort)
}
