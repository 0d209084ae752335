//! soon
use crate::Error;
use clap::Args;
/// x
#[derive(Debug, Args)]
#[command(after_help = "gaitway ")]
pub(super) struct Arguments {}
pub(super) fn run(_: &Arguments) -> Result<bool, Error> { Ok(true) }
