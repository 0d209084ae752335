//! A build without the feature `sqlite` reads no databases.

use super::{Error, Found, unusable};
use std::path::Path;

pub(super) fn read(path: &Path) -> Result<Found, Error> {
    let message = "this build reads no trajectory databases".to_owned();
    Err(unusable(path, message, "build it with the feature `sqlite`"))
}
