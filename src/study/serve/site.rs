//! What all requests of participants share.

use super::assets::Assets;
use super::cookie::Cookie;
use super::guard::{Limits, Origin};
use super::pages::{Frame, Visit};
use super::reply::Framing;
use super::stimulus::Stimuli;
use super::words::{Interfaces, negotiate};
use crate::study::store::{Store, Trouble, Version};
use axum::http::HeaderMap;
use axum::http::header::ACCEPT_LANGUAGE;
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};
use tokio::sync::oneshot;

/// What all requests of participants share.
pub(super) struct Site {
    pub(super) store: Store,
    pub(super) assets: Assets,
    pub(super) stimuli: Stimuli,
    pub(super) interfaces: Interfaces,
    pub(super) origin: Origin,
    pub(super) cookie: Cookie,
    pub(super) framing: Framing,
    pub(super) limits: Limits,
    pub(super) is_behind_proxy: bool,
    pub(super) requests_per_minute: u32,
    pub(super) requests_of_one: u32,
}

impl Site {
    /// The frame of a page in a language.
    pub(super) fn frame<'a>(
        &'a self,
        version: &'a Version,
        language: &'a str,
        visit: Option<Visit<'a>>,
    ) -> Frame<'a> {
        let (_, words) = self.interfaces.find(language);
        Frame { words, language, study: &version.study.file, assets: &self.assets, visit }
    }

    /// The language of a page for a browser of which nothing else is known.
    pub(super) fn language(&self, version: &Version, headers: &HeaderMap) -> String {
        negotiate(super::reply::text(headers, &ACCEPT_LANGUAGE), &version.study.file.study.languages)
    }

    /// The version of a participant; the current one if it is not there any more.
    pub(super) fn version(&self, number: u32) -> Arc<Version> {
        self.store.version(number).unwrap_or_else(|| self.store.current())
    }
}

/// Waits for what the store says.
pub(super) async fn ask<T: Send + 'static>(
    call: impl FnOnce(Box<dyn FnOnce(Result<T, Trouble>) + Send>),
) -> Result<T, Trouble> {
    let (tell, told) = oneshot::channel();
    call(Box::new(move |result| {
        // a request that was given up waits no longer
        let _ = tell.send(result);
    }));
    told.await.unwrap_or_else(|_| Err(Trouble::Unavailable("the store has ended".to_owned())))
}

/// Now, UTC ms.
pub(super) fn now() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    i64::try_from(since.as_millis()).unwrap_or(i64::MAX)
}
