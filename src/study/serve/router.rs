//! The addresses of participants, and what every request passes through.

use super::PATIENCE_SECONDS;
use super::gate::{Gate, is_bare, told};
use super::guard;
use super::pages::Notice;
use super::participant as handlers;
use super::patience::Peer;
use super::reply::{self, Told};
use super::site::{Site, ask};
use axum::Router;
use axum::extract::{ConnectInfo, Path, Request, State};
use axum::http::{HeaderMap, StatusCode};
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

/// What every request passes through: limits, the own origin, the longest time, headers of the reply.
async fn pass(
    State(site): State<Arc<Site>>,
    ConnectInfo(Peer(peer)): ConnectInfo<Peer>,
    request: Request,
    next: Next,
) -> Response {
    let headers = request.headers().clone();
    let address = guard::address(peer.ip(), &headers, site.is_behind_proxy);
    let gate = Gate {
        origin: &site.origin,
        limits: &site.limits,
        cookie: site.cookie,
        requests_of_one: site.requests_of_one,
    };
    let is_within = site.limits.allow_address("address", address, site.requests_per_minute);
    let refused = if is_within { gate.refuses(request.method(), &headers) } else { Some(Notice::TooMany) };
    let mut response = match refused {
        Some(what) => told(&site, &headers, what),
        None => {
            let replied =
                tokio::time::timeout(Duration::from_secs(PATIENCE_SECONDS), next.run(request)).await;
            match replied {
                Ok(response) if is_bare(&response) => told(&site, &headers, Notice::BadRequest),
                Ok(response) => response,
                Err(_late) => told(&site, &headers, Notice::Timeout),
            }
        }
    };
    reply::harden(response.headers_mut(), site.origin.is_encrypted(), &site.framing);
    response
}
