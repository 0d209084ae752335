//! Operators' pages, at an address of their own on this machine. They are in English and work without scripts, but for the live
//! page, which then is as old as its loading.

mod acts;
mod live;
mod pages;
mod sessions;
mod sign;

use super::assets::Assets;
use super::cookie::{Cookie, mark};
use super::guard::{Limits, Origin};
use super::reply::Told;
use super::router::Gate;
use super::{Error, PATIENCE_SECONDS, form, reply};
use super::{LONGEST_BODY, form::Fields};
use crate::study::store::{Role, Store, Trouble};
use axum::Router;
use axum::body::to_bytes;
use axum::extract::{Path, Request, State};
use axum::http::{HeaderMap, StatusCode};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::Response;
use axum::routing::{get, post};
use sessions::{Session, Sessions};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// What all requests of operators share.
pub(super) struct Console {
    store: Store,
    assets: Assets,
    cookie: Cookie,
    origin: Origin,
    limits: Limits,
    sessions: Sessions,
    /// The address that participants use.
    entrance: String,
    /// The mark of the key that the first operator comes with, once.
    first: Mutex<Option<String>>,
}

impl Console {
    /// Pages for operators of a store, with a key of random bits for its limits.
    ///
    /// # Errors
    /// [`Error::Compress`].
    pub(super) fn new(store: Store, key: [u8; 32], entrance: String) -> Result<Self, Error> {
        Ok(Self {
            store,
            assets: Assets::new()?,
            cookie: Cookie::of_operators(false),
            origin: Origin::Loopback,
            limits: Limits::new(key),
            sessions: Sessions::default(),
            entrance,
            first: Mutex::default(),
        })
    }

    /// Lets whom the program has told this key choose the first password.
    pub(super) fn expect_first(&self, key: &str) {
        *self.first.lock().unwrap_or_else(PoisonError::into_inner) = Some(mark(key));
    }

    /// Whether a key is the one of [`Console::expect_first`].
    fn expects(&self, key: &str) -> bool {
        self.first.lock().unwrap_or_else(PoisonError::into_inner).as_deref() == Some(mark(key).as_str())
    }

    /// The session of a request.
    ///
    /// # Errors
    /// The reply: to the sign-in page, or that the role does not allow it.
    fn signed(&self, headers: &HeaderMap, least: Role) -> Result<Session, Told> {
        let session = self.cookie.find(headers).and_then(|secret| self.sessions.find(&secret));
        let session = session.ok_or_else(|| reply::see_other("/admin/login"))?;
        if session.role >= least {
            return Ok(session);
        }
        let text = format!("Your role is {}; this takes {}.", session.role.name(), least.name());
        Err(pages::problem(self, StatusCode::FORBIDDEN, "Not allowed", &text).into())
    }

    /// Reads a form of an operator who is signed in.
    ///
    /// # Errors
    /// The reply, where the form is not of this session or too long.
    async fn read(&self, request: Request, least: Role) -> Result<(Session, Fields), Told> {
        let session = self.signed(request.headers(), least)?;
        let fields = self.fields(request).await?;
        if fields.get("mark") == Some(&session.mark) {
            return Ok((session, fields));
        }
        let text = "The form is not of this session. Load the page again.";
        Err(pages::problem(self, StatusCode::FORBIDDEN, "Not allowed", text).into())
    }

    async fn fields(&self, request: Request) -> Result<Fields, Told> {
        let body = to_bytes(request.into_body(), LONGEST_BODY).await.ok();
        let wrong = || pages::problem(self, StatusCode::BAD_REQUEST, "Not a form", "Load the page again.");
        body.and_then(|body| form::fields(&body)).ok_or_else(|| wrong().into())
    }

    /// What an operator is shown when the store has not done what was asked.
    fn trouble(&self, trouble: &Trouble) -> Told {
        let status = match trouble {
            Trouble::Unavailable(_) => StatusCode::SERVICE_UNAVAILABLE,
            Trouble::Unknown => StatusCode::NOT_FOUND,
            _ => StatusCode::CONFLICT,
        };
        pages::problem(self, status, "Not done", &trouble.to_string()).into()
    }
}

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
    let gate = Gate { origin: &console.origin, limits: &console.limits, cookie: console.cookie };
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
            replied.unwrap_or_else(late)
        }
    };
    reply::harden(response.headers_mut(), console.origin.is_encrypted());
    response
}
