//! The headset that the operator sits beside: what its user sees, and orders.

use super::super::reply::{Told, see_other};
use super::super::site::ask;
use super::console::Console;
use super::pages;
use super::sessions::Session;
use crate::study::lab::{Lab, Order};
use crate::study::store::{Act, Role};
use axum::extract::{Request, State};
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse as _, Response};
use maud::{Markup, html};
use std::sync::Arc;

type Shared = State<Arc<Console>>;

/// The buttons: what they send and what they say.
const ORDERS: [(&str, &str); 5] = [
    ("pause", "Pause"),
    ("resume", "Resume"),
    ("repeat", "Repeat trial"),
    ("skip", "Skip trial"),
    ("end", "End: grey at once"),
];

/// What the user sees, and what happened last.
pub(super) fn view(lab: &Lab) -> Markup {
    html! {
        section.headset {
            h2 { "In the headset: " (super::live::short(&lab.participant)) }
            @if let Some((number, _)) = lab.eye() {
                img src=(format!("/admin/headset/eye?{number}")) alt="What the participant sees";
            } @else {
                p { "The headset has shown nothing yet." }
            }
            ol.log { @for line in lab.lines() { li { (line) } } }
        }
    }
}

/// The buttons of orders.
pub(super) fn orders(lab: &Lab, session: &Session) -> Markup {
    html! {
        form.choice method="post" action="/admin/headset" {
            (pages::mark(session))
            input type="hidden" name="code" value=(lab.participant);
            @for (act, text) in ORDERS { button.quiet type="submit" name="act" value=(act) { (text) } }
        }
    }
}

/// Takes an order.
pub(super) async fn order(State(console): Shared, request: Request) -> Result<Response, Told> {
    let (session, fields) = console.read(request, Role::Run).await?;
    let lab = console.lab.as_ref().ok_or_else(|| no_headset(&console))?;
    let (act, order) = match fields.get("act").map_or("", String::as_str) {
        "pause" => (Ok(Act::Pause), Some(Order::Look)),
        "resume" => (Ok(Act::Resume), None),
        "repeat" => (Err("repeat a trial"), Some(Order::Repeat)),
        "skip" => (Err("skip a trial"), Some(Order::Skip)),
        "end" => (Err("end the session"), Some(Order::End)),
        _ => {
            let text = "Load the page again.";
            return Err(pages::problem(&console, StatusCode::BAD_REQUEST, "Not a form", text).into());
        }
    };
    let (name, code) = (&session.name, &lab.participant);
    match act {
        Ok(act) => ask(|then| console.store.operate(name, code, act, then)).await.map(drop),
        Err(what) => ask(|then| console.store.audit(name, what, code, then)).await,
    }
    .map_err(|trouble| console.trouble(&trouble))?;
    order.into_iter().for_each(|order| lab.order(order));
    Ok(see_other("/admin/live"))
}

/// What the user saw last.
pub(super) async fn eye(State(console): Shared, headers: HeaderMap) -> Result<Response, Told> {
    console.signed(&headers, Role::Watch)?;
    let picture = console.lab.as_ref().and_then(|lab| lab.eye());
    let (_, png) = picture.ok_or_else(|| no_headset(&console))?;
    Ok(([(CONTENT_TYPE, "image/png"), (CACHE_CONTROL, "no-store")], png.to_vec()).into_response())
}

fn no_headset(console: &Console) -> Told {
    let text = "No headset is shown here.";
    pages::problem(console, StatusCode::NOT_FOUND, "No such page", text).into()
}
