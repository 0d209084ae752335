//! The addresses of participants, and what every request passes through.

use super::cookie::Cookie;
use super::guard::{self, Limits, Origin};
use super::pages::{Notice, notice};
use super::participant as handlers;
use super::patience::Peer;
use super::reply::{self, Told};
use super::site::{Site, ask};
use super::{PATIENCE_SECONDS, REQUESTS_OF_ONE};
use axum::Router;
use axum::extract::{ConnectInfo, Path, Request, State};
use axum::http::header::CONTENT_TYPE;
use axum::http::{HeaderMap, Method, StatusCode};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse as _, Response};
use axum::routing::{get, post};
use std::sync::Arc;
use std::time::Duration;

/// The addresses of participants.
pub(super) fn router(site: Arc<Site>) -> Router {
    Router::new()
        .route("/s/{id}", get(handlers::welcome))
        .route("/s/{id}/begin", post(handlers::begin))
        .route("/s/{id}/go", get(handlers::go))
        .route("/s/{id}/answer", post(handlers::answer))
        .route("/s/{id}/event", post(handlers::event))
        .route("/s/{id}/withdraw", post(handlers::withdraw))
        .route("/stimuli/{name}", get(stimulus))
        .route("/static/{hash}/{file}", get(file))
        .route("/healthz", get(health))
        .fallback(unknown)
        .method_not_allowed_fallback(unknown)
        .layer(from_fn_with_state(site.clone(), pass))
        .with_state(site)
}

async fn stimulus(
    State(site): State<Arc<Site>>,
    Path(name): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Told> {
    let found = site.stimuli.reply(&name, &headers).await;
    found.ok_or_else(|| told(&site, &headers, Notice::NotFound).into())
}

async fn file(
    State(site): State<Arc<Site>>,
    Path((hash, file)): Path<(String, String)>,
    headers: HeaderMap,
) -> Result<Response, Told> {
    let found = site.assets.find(&hash, &file, reply::takes_gzip(&headers));
    found.ok_or_else(|| told(&site, &headers, Notice::NotFound).into())
}

/// Writes and reads one row: what a monitor asks for.
async fn health(State(site): State<Arc<Site>>) -> Response {
    match ask(|then| site.store.health(then)).await {
        Ok(()) => "ok\n".into_response(),
        Err(trouble) => (StatusCode::SERVICE_UNAVAILABLE, format!("{trouble}\n")).into_response(),
    }
}

async fn unknown(State(site): State<Arc<Site>>, headers: HeaderMap) -> Response {
    told(&site, &headers, Notice::NotFound)
}

/// What a request is answered with in place of a page: JSON for scripts, a page for people.
pub(super) fn told(site: &Site, headers: &HeaderMap, what: Notice) -> Response {
    if is_json(headers) {
        return (what.status(), axum::Json(serde_json::json!({ "notice": format!("{what:?}") })))
            .into_response();
    }
    let version = site.store.current();
    let language = site.language(&version, headers);
    reply::page(what.status(), notice(&site.frame(&version, &language, None), what))
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

/// What every request passes through: limits, the own origin, the longest time, headers of the reply.
async fn pass(
    State(site): State<Arc<Site>>,
    ConnectInfo(Peer(peer)): ConnectInfo<Peer>,
    request: Request,
    next: Next,
) -> Response {
    let headers = request.headers().clone();
    let address = guard::address(peer.ip(), &headers, site.is_behind_proxy);
    let gate = Gate { origin: &site.origin, limits: &site.limits, cookie: site.cookie };
    let is_within = site.limits.allow_address("address", address, site.requests_per_minute);
    let refused = if is_within { gate.refuses(request.method(), &headers) } else { Some(Notice::TooMany) };
    let mut response = match refused {
        Some(what) => told(&site, &headers, what),
        None => {
            let replied =
                tokio::time::timeout(Duration::from_secs(PATIENCE_SECONDS), next.run(request)).await;
            replied.unwrap_or_else(|_late| told(&site, &headers, Notice::Timeout))
        }
    };
    reply::harden(response.headers_mut(), site.origin.is_encrypted());
    response
}

/// What stands before both groups of pages.
#[derive(Debug)]
pub(super) struct Gate<'a> {
    pub(super) origin: &'a Origin,
    pub(super) limits: &'a Limits,
    pub(super) cookie: Cookie,
}

impl Gate<'_> {
    /// Why a request is not looked at.
    pub(super) fn refuses(&self, method: &Method, headers: &HeaderMap) -> Option<Notice> {
        if !self.origin.serves(headers) {
            return Some(Notice::Forbidden);
        }
        let secret = self.cookie.find(headers);
        if secret.is_some_and(|secret| !self.limits.allow("secret", secret.as_bytes(), REQUESTS_OF_ONE)) {
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
