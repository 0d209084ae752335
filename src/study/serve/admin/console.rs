//! What all requests of operators share.

use super::super::Error;
use super::super::assets::Assets;
use super::super::cookie::{Cookie, mark};
use super::super::guard::{Limits, Origin};
use super::super::reply::Framing;
use super::sessions::Sessions;
use crate::study::lab::Lab;
use crate::study::store::Store;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What all requests of operators share.
pub(in super::super) struct Console {
    pub(in super::super) store: Store,
    pub(super) assets: Assets,
    pub(super) cookie: Cookie,
    pub(super) origin: Origin,
    pub(super) limits: Limits,
    pub(super) requests_of_one: u32,
    pub(super) framing: Framing,
    pub(super) sessions: Sessions,
    /// The address that participants use; none where they wear a headset.
    pub(super) entrance: Option<String>,
    /// The headset that the operator sits beside.
    pub(super) lab: Option<Arc<Lab>>,
    /// The mark of the key that the first operator comes with, once.
    first: Mutex<Option<String>>,
}

impl Console {
    /// Pages for operators of a store, with a key of random bits for its limits and the most requests a minute of one operator.
    ///
    /// # Errors
    /// [`Error::Compress`].
    pub(in super::super) fn new(
        store: Store,
        key: [u8; 32],
        requests_of_one: u32,
        entrance: Option<String>,
    ) -> Result<Self, Error> {
        Ok(Self {
            store,
            assets: Assets::new()?,
            cookie: Cookie::of_operators(false),
            origin: Origin::Loopback,
            limits: Limits::new(key),
            requests_of_one,
            framing: Framing::of(&[])?,
            sessions: Sessions::default(),
            entrance,
            lab: None,
            first: Mutex::default(),
        })
    }

    /// The same beside a headset.
    pub(in super::super) fn beside(self, lab: Arc<Lab>) -> Self {
        Self { lab: Some(lab), ..self }
    }

    /// Lets whom the program has told this key choose the first password.
    pub(in super::super) fn expect_first(&self, key: &str) {
        *self.first() = Some(mark(key));
    }

    /// Whether a key is the one of [`Console::expect_first`].
    pub(super) fn expects(&self, key: &str) -> bool {
        self.first().as_deref() == Some(mark(key).as_str())
    }

    /// The mark of the key that the first operator comes with.
    pub(super) fn first(&self) -> MutexGuard<'_, Option<String>> {
        self.first.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
