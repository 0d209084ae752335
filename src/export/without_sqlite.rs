//! A build without the feature `sqlite` writes no databases.

use super::Error;
use super::agents::{AgentInfo, Presence};
use super::area::{Area, Ground};
use super::trajectory::Sample;
use std::convert::Infallible;
use std::path::Path;

/// There is none.
#[derive(Debug)]
pub(super) struct Sqlite(Infallible);

impl Sqlite {
    pub(super) fn create(path: &Path, _: f64, _: Area) -> Result<Self, Error> {
        let message =
            "this build writes no databases: build it with the feature `sqlite`, or write .txt or .csv";
        Err(Error::Unusable { path: path.to_owned(), message: message.to_owned() })
    }

    pub(super) fn frame<People: Iterator<Item = Sample>>(
        &mut self,
        _: u32,
        _: impl Fn() -> People,
        _: impl Iterator<Item = Sample>,
    ) -> Result<(), Error> {
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
