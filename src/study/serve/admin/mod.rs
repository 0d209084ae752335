//! Operators' pages, at an address of their own on this machine. They are in English and work without scripts, but for the live
//! page, which then is as old as its loading.

mod acts;
mod console;
mod gate;
mod headset;
mod live;
mod pages;
mod sessions;
mod sign;

pub(super) use console::Console;

use super::gate::{Gate, is_bare};
use super::reply::Told;
use super::{PATIENCE_SECONDS, reply};
use axum::Router;
use axum::extract::{Path, Request, State};
use axum::http::{HeaderMap, StatusCode};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::Response;
use axum::routing::{get, post};
use std::sync::Arc;
use std::time::Duration;

/// The addresses of operators.
pub(super) fn router(console: Arc<Console>) -> Router {
    Router::new()
        .route("/", get(home))
        .route("/admin", get(home))
        .route("/admin/first", get(sign::first).post(sign::choose))
        .route("/admin/login", get(sign::form).post(sign::login))
        .route("/admin/logout", post(sign::logout))
        .route("/admin/live", get(live::page))
        .route("/admin/live/events", get(live::events))
        .route("/admin/participants", get(acts::participants).post(acts::act))
        .route("/admin/balance", get(acts::balance))
        .route("/admin/admission", post(acts::admission))
        .route("/admin/backup", post(acts::backup))
        .route("/admin/headset", post(headset::order))
        .route("/admin/headset/eye", get(headset::eye))
        .route("/admin/operators", get(acts::operators).post(acts::name))
        .route("/static/{hash}/{file}", get(file))
        .fallback(unknown)
        .layer(from_fn_with_state(console.clone(), pass))
        .with_state(console)
}

async fn home() -> Response {
    reply::see_other("/admin/live")
}

async fn file(
    State(console): State<Arc<Console>>,
    Path((hash, file)): Path<(String, String)>,
    headers: HeaderMap,
) -> Result<Response, Told> {
    let found = console.assets.find(&hash, &file, reply::takes_gzip(&headers));
    found.ok_or_else(|| pages::problem(&console, StatusCode::NOT_FOUND, "No such page", "").into())
}

async fn unknown(State(console): State<Arc<Console>>) -> Response {
    pages::problem(&console, StatusCode::NOT_FOUND, "No such page", "The pages are listed above.")
}

/// What every request passes through.
async fn pass(State(console): State<Arc<Console>>, request: Request, next: Next) -> Response {
    let gate = Gate {
        origin: &console.origin,
        limits: &console.limits,
        cookie: console.cookie,
        requests_of_one: console.requests_of_one,
    };
    let mut response = match gate.refuses(request.method(), request.headers()) {
        Some(what) => {
            let text = "The request came from another page, too often, or is no form.";
            pages::problem(&console, what.status(), "Not allowed", text)
        }
        None => {
            let replied =
                tokio::time::timeout(Duration::from_secs(PATIENCE_SECONDS), next.run(request)).await;
            let late =
                |_late| pages::problem(&console, StatusCode::SERVICE_UNAVAILABLE, "Too slow", "Try again.");
            match replied.unwrap_or_else(late) {
                bare if is_bare(&bare) => {
                    pages::problem(&console, bare.status(), "Not a page", "The pages are listed above.")
                }
                response => response,
            }
        }
    };
    reply::harden(response.headers_mut(), console.origin.is_encrypted(), &console.framing);
    response
}
