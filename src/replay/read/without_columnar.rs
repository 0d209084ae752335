//! A build without the feature `parquet` reads no Parquet files.

use super::{Error, Found, unusable};
use std::path::Path;

pub(super) fn read(path: &Path) -> Result<Found, Error> {
    let message = "this build reads no Parquet files".to_owned();
    Err(unusable(path, message, "build it with the feature `parquet`"))
}
