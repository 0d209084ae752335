//! What stands before both groups of pages: what is refused, and how it is said.

use super::cookie::Cookie;
use super::guard::{Limits, Origin};
use super::pages::{Notice, notice};
use super::reply;
use super::site::Site;
use axum::http::header::CONTENT_TYPE;
use axum::http::{HeaderMap, Method};
use axum::response::Response;

/// What a request is answered with in place of a page: JSON for scripts, a page for people.
pub(super) fn told(site: &Site, headers: &HeaderMap, what: Notice) -> Response {
    if is_json(headers) {
        return reply::json(what.status(), &serde_json::json!({ "notice": format!("{what:?}") }));
    }
    let version = site.store.current();
    let language = site.language(&version, headers);
    reply::page(what.status(), notice(&site.frame(&version, &language, None), what))
}

/// Whether a reply is the bare words with which axum refuses an address that it cannot read: a page takes their place.
pub(super) fn is_bare(response: &Response) -> bool {
    response.status().is_client_error()
        && reply::text(response.headers(), &CONTENT_TYPE).starts_with("text/plain")
}

/// Whether the body is JSON, which only scripts send.
pub(super) fn is_json(headers: &HeaderMap) -> bool {
    kind(headers) == "application/json"
}

/// The type of the body, without its parameters.
pub(super) fn kind(headers: &HeaderMap) -> String {
    let kind = reply::text(headers, &CONTENT_TYPE).split(';').next().unwrap_or_default();
    kind.trim().to_ascii_lowercase()
}

/// What stands before both groups of pages.
#[derive(Debug)]
pub(super) struct Gate<'a> {
    pub(super) origin: &'a Origin,
    pub(super) limits: &'a Limits,
    pub(super) cookie: Cookie,
    /// Requests a minute of one secret; 0 is without limit.
    pub(super) requests_of_one: u32,
}

impl Gate<'_> {
    /// Why a request is not looked at.
    pub(super) fn refuses(&self, method: &Method, headers: &HeaderMap) -> Option<Notice> {
        if !self.origin.serves(headers) {
            return Some(Notice::Forbidden);
        }
        let secret = self.cookie.find(headers);
        if secret.is_some_and(|secret| !self.limits.allow("secret", secret.as_bytes(), self.requests_of_one))
        {
            return Some(Notice::TooMany);
        }
        if *method == Method::GET || *method == Method::HEAD {
            return None;
        }
        if !self.origin.allows(headers) {
            return Some(Notice::Forbidden);
        }
        let kind = kind(headers);
        let is_usable = kind == "application/json" || kind == "application/x-www-form-urlencoded";
        (!is_usable).then_some(Notice::WrongType)
    }
}
