//! The user.

use super::ranges::{point, within};
use crate::scenario::error::Error;
use crate::scenario::file::User;

pub(super) fn check(user: &User) -> Result<(), Error> {
    if let Some(position) = user.position {
        point("user.position", position)?;
    }
    within("user.heading_deg", user.heading_deg, -360.0, 360.0, "degrees; 0 looks along +z")?;
    within("user.elevation", user.elevation, -100.0, 100.0, "metres above the ground; 0 is the ground")?;
    within("user.eye_height", user.eye_height, 0.3, 2.5, "metres; 1.65 is usual")?;
    within("user.radius", user.radius, 0.05, 5.0, "metres; 0.3 is usual")?;
    within("user.comfort", user.comfort, 0.0, 5.0, "metres; 0.5 is usual")
}
