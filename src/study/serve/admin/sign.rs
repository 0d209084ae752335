//! Signing in and out, and the first password.

use super::super::form::{Fields, query};
use super::super::reply::{Told, page, see_other, with_cookie};
use super::super::site::ask;
use super::console::Console;
use super::pages;
use super::sessions::{PASSWORD, hash, verify};
use crate::study::store::{Operator, Role};
use axum::extract::{Request, State};
use axum::http::{HeaderMap, StatusCode, Uri};
use axum::response::Response;
use std::sync::Arc;

/// Attempts a minute for a name, and for all names.
const ATTEMPTS: [u32; 2] = [5, 20];
/// Longest name, letters.
const LONGEST_NAME: usize = 60;
/// How long the browser keeps a session's secret, s; the session itself ends by itself.
const TWELVE_HOURS: u32 = 12 * 3600;

type Shared = State<Arc<Console>>;

/// The page on which the first operator chooses name and password.
pub(super) async fn first(State(console): Shared, address: Uri) -> Response {
    let query = query(&address);
    let key = query.get("key").map_or("", String::as_str);
    if console.expects(key) {
        page(StatusCode::OK, pages::first(&console, key, ""))
    } else {
        see_other("/admin/login")
    }
}

/// Takes the first operator's name and password.
pub(super) async fn choose(State(console): Shared, request: Request) -> Result<Response, Told> {
    let fields = console.fields(request).await?;
    let key = fields.get("key").map_or("", String::as_str);
    if !console.expects(key) {
        return Ok(see_other("/admin/login"));
    }
    let wrong = |why: &str| page(StatusCode::UNPROCESSABLE_ENTITY, pages::first(&console, key, why));
    let operator = operator(&fields, Role::Own).await.map_err(|why| wrong(&why))?;
    let name = operator.name.clone();
    // from here on the link is used up
    let taken = console.first().take();
    if taken.is_none() {
        return Ok(see_other("/admin/login"));
    }
    if let Err(trouble) = ask(|then| console.store.set_operator(&name, operator, then)).await {
        *console.first() = taken;
        return Err(console.trouble(&trouble));
    }
    enter(&console, &name, Role::Own)
}

/// An operator as a form names them; else what is wrong with it.
pub(super) async fn operator(fields: &Fields, role: Role) -> Result<Operator, String> {
    let field = |name: &str| fields.get(name).map_or("", |value| value.trim());
    let name = field("name").to_owned();
    if name.is_empty() || name.chars().count() > LONGEST_NAME || name.chars().any(char::is_control) {
        return Err(format!("The name must have 1 to {LONGEST_NAME} letters."));
    }
    let password = field("password").to_owned();
    let (least, most) = (PASSWORD.start(), PASSWORD.end());
    if !PASSWORD.contains(&password.chars().count()) {
        return Err(format!("The password must have {least} to {most} letters."));
    }
    let hashed = tokio::task::spawn_blocking(move || hash(&password)).await;
    match hashed {
        Ok(Ok(hash)) => Ok(Operator { name, role, hash }),
        Ok(Err(error)) => Err(error.to_string()),
        Err(_panicked) => Err("The password could not be hashed. Try again.".to_owned()),
    }
}

/// The page to sign in.
pub(super) async fn form(State(console): Shared) -> Response {
    page(StatusCode::OK, pages::login(&console, ""))
}

/// Signs in.
pub(super) async fn login(State(console): Shared, request: Request) -> Result<Response, Told> {
    let fields = console.fields(request).await?;
    let field = |name: &str| fields.get(name).map_or("", |value| value.trim()).to_owned();
    let (name, password) = (field("name"), field("password"));
    let limits = &console.limits;
    if !limits.allow("attempt", name.as_bytes(), ATTEMPTS[0]) || !limits.allow("attempts", b"", ATTEMPTS[1]) {
        let why = "Too many attempts. Wait a minute.";
        return Err(Told::from(page(StatusCode::TOO_MANY_REQUESTS, pages::login(&console, why))));
    }
    let found = ask(|then| console.store.operator(&name, then)).await;
    let found = found.map_err(|trouble| console.trouble(&trouble))?;
    let known = found.as_ref().map(|operator| operator.hash.clone());
    let is_right = tokio::task::spawn_blocking(move || verify(&password, known.as_deref())).await;
    let role = found.map(|operator| operator.role).filter(|_| is_right.unwrap_or(false));
    let said = if role.is_some() { "signed in" } else { "failed to sign in" };
    let about: String = name.chars().take(LONGEST_NAME).collect();
    let noted = ask(|then| console.store.audit(&about, said, "", then)).await;
    noted.map_err(|trouble| console.trouble(&trouble))?;
    match role {
        Some(role) => enter(&console, &name, role),
        None => {
            Err(page(StatusCode::UNAUTHORIZED, pages::login(&console, "Name or password is wrong.")).into())
        }
    }
}

fn enter(console: &Console, name: &str, role: Role) -> Result<Response, Told> {
    let failed = |error: super::super::Error| {
        pages::problem(console, StatusCode::SERVICE_UNAVAILABLE, "Not signed in", &error.to_string())
    };
    let secret = console.sessions.begin(name, role).map_err(failed)?;
    Ok(with_cookie(see_other("/admin/live"), &console.cookie.set(&secret, TWELVE_HOURS)))
}

/// Signs out.
pub(super) async fn logout(State(console): Shared, headers: HeaderMap) -> Response {
    if let Some(secret) = console.cookie.find(&headers) {
        console.sessions.end(&secret);
    }
    with_cookie(see_other("/admin/login"), &console.cookie.set("x", 0))
}
