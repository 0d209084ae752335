//! A build without the feature `charts` draws no figures and no captions.

use crate::picture::Image;

const MISSING: &str = "this build draws no text: build it with the feature `charts`";

pub(super) fn pixels(_: &str, _: f32) -> Result<Image, String> {
    Err(MISSING.to_owned())
}

pub(super) fn reach(_: &str) -> Result<f32, String> {
    Err(MISSING.to_owned())
}
