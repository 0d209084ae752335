//! A build without the feature `parquet` writes no Parquet files.

use super::Error;
use super::agents::{AgentInfo, Attendance, Presence};
use super::area::{Area, Ground};
use super::trajectory::Frame;
use std::convert::Infallible;
use std::path::Path;

/// There is none.
#[derive(Debug)]
pub(super) struct Parquet(Infallible);

/// Refuses to write a table of agents.
pub(super) fn write_agents<'a>(
    path: &Path,
    _: impl Iterator<Item = (Option<&'a AgentInfo>, Option<Presence>)>,
    _: u32,
    _: f64,
) -> Result<(), Error> {
    Err(missing(path))
}

fn missing(path: &Path) -> Error {
    let message = "this build writes no Parquet: build it with the feature `parquet`, or write .txt or .csv";
    Error::Unusable { path: path.to_owned(), message: message.to_owned() }
}

impl Parquet {
    pub(super) fn create(path: &Path, _: f64, _: Option<Area>, _: &[AgentInfo]) -> Result<Self, Error> {
        Err(missing(path))
    }

    pub(super) fn frame(&mut self, _: u32, _: &Frame<'_>, _: &mut Attendance) -> Result<(), Error> {
        match self.0 {}
    }

    pub(super) fn finish<'a>(
        self,
        _: impl Iterator<Item = (Option<&'a AgentInfo>, Option<Presence>)>,
        _: u32,
        _: f64,
    ) -> Result<Ground, Error> {
        match self.0 {}
    }
}
