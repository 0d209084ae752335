//! The study at a glance, once a second.

use super::super::reply::{Told, page as reply};
use super::super::site::ask;
use super::console::Console;
use super::sessions::Session;
use super::{headset, pages};
use crate::study::plan::Counts;
use crate::study::protocol::State as Stage;
use crate::study::store::{Overview, Person, Role};
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse as _, Response};
use maud::{Markup, html};
use std::sync::Arc;

/// How soon the browser asks again, ms.
const PERIOD: u32 = 1000;
/// Participants under way that are listed.
const MOST_LISTED: usize = 200;

type Shared = State<Arc<Console>>;

/// The live page.
pub(super) async fn page(State(console): Shared, headers: HeaderMap) -> Result<Response, Told> {
    let session = console.signed(&headers, Role::Watch)?;
    let body = html! {
        p.lacking #old role="status" hidden { "The server does not answer. What stands here is old." }
        @if let Some(lab) = console.lab.as_ref().filter(|_| session.role >= Role::Run) {
            (headset::orders(lab, &session))
        }
        div #live data-events="/admin/live/events" { (now(&console).await?) }
        @if session.role >= Role::Run { (buttons(&console, &session).await?) }
    };
    Ok(reply(StatusCode::OK, pages::document(&console, Some(&session), "Live", &body)))
}

/// One event: the browser asks for the next by itself, and a session that has ended gets none.
pub(super) async fn events(State(console): Shared, headers: HeaderMap) -> Result<Response, Told> {
    let signed = console.signed(&headers, Role::Watch);
    signed.map_err(|_to_the_door| StatusCode::UNAUTHORIZED.into_response())?;
    let markup = now(&console).await?.into_string();
    let lines: String = markup.lines().map(|line| format!("data: {line}\n")).collect();
    Ok(([(CONTENT_TYPE, "text/event-stream")], format!("retry: {PERIOD}\n{lines}\n")).into_response())
}

async fn now(console: &Console) -> Result<Markup, Told> {
    let overview =
        ask(|then| console.store.overview(then)).await.map_err(|trouble| console.trouble(&trouble))?;
    let people = ask(|then| console.store.people(then)).await.map_err(|trouble| console.trouble(&trouble))?;
    let is_under_way = |person: &&Person| !matches!(person.state, Stage::Ended(_) | Stage::Lapsed);
    let under_way: Vec<&Person> = people.iter().filter(is_under_way).collect();
    let version = console.store.current();
    let admission = match (overview.is_closed, overview.is_admitting) {
        (true, _) => "closed",
        (false, true) => "open",
        (false, false) => "full",
    };
    Ok(html! {
        p.head {
            strong { (version.study.file.study.id) " · " (admission) }
            " · v" (version.number) " · " (under_way.len()) " under way"
        }
        @if let Some(entrance) = &console.entrance { p { "Participants begin at " a href=(entrance) { (entrance) } } }
        @if let Some(lab) = &console.lab { (headset::view(lab)) }
        (answers(&overview))
        (states(&overview))
        (list(&under_way))
    })
}

/// Fewest and most answers of each part, and counts of rows.
fn answers(overview: &Overview) -> Markup {
    let rows = |counts: &&Counts| !overview.answered.contains_key(&counts.part) && !counts.counts.is_empty();
    html! {
        @for (part, (least, most)) in &overview.answered {
            @let wanted = overview.at_least.get(part).copied().unwrap_or(0);
            p {
                (part) ": answers a stimulus, fewest " (least) " "
                progress value=(least.min(&wanted)) max=(wanted.max(1)) { (least) }
                " of " (wanted) ", most " (most)
            }
        }
        @for counts in overview.counts.iter().filter(rows) {
            p { (counts.part) ": rows 0 to " (counts.counts.len() - 1) ": "
                @for count in &counts.counts { (count) " " } }
        }
    }
}

fn states(overview: &Overview) -> Markup {
    html! {
        p {
            @for (state, count) in &overview.states { (state) " " strong { (count) } " · " }
            "faults " strong { (overview.faults) } " · places " strong { (overview.places) }
            " · needs about " strong { (overview.needs) } " more"
            @if let Some(days) = overview.links_days { " · platform ids are deleted in " (days) " days" }
        }
    }
}

fn list(people: &[&Person]) -> Markup {
    html! {
        table {
            caption { "Under way" }
            thead { tr { @for head in ["Code", "Part", "Page", "Silent", "Late frames", "Manage"] { th scope="col" { (head) } } } }
            tbody {
                @for person in people.iter().take(MOST_LISTED) {
                    tr {
                        th scope="row" { (short(&person.code)) }
                        td { (person.part) }
                        td { (place(person)) }
                        td { (clock(person.silent_ms)) }
                        td { (late(person)) }
                        td { a href=(format!("/admin/participants#{}", person.code)) { "manage" } }
                    }
                }
            }
        }
        @if people.len() > MOST_LISTED { p { "and " (people.len() - MOST_LISTED) " more" } }
    }
}

/// Enough of a code to know it again.
pub(super) fn short(code: &str) -> &str {
    code.get(..6).unwrap_or(code)
}

/// The page of a participant: how far they are, or its id.
pub(super) fn place(person: &Person) -> String {
    person.progress.map_or_else(|| person.page.clone(), |at| format!("{}/{}", at.trial, at.of))
}

/// Minutes and seconds.
pub(super) fn clock(ms: i64) -> String {
    format!("{}:{:02}", ms / 60_000, ms / 1000 % 60)
}

/// Share of frames that were shown late.
pub(super) fn late(person: &Person) -> String {
    let Some(share) = (person.late_frames * 100).checked_div(person.frames) else { return String::new() };
    format!("{share} %")
}

async fn buttons(console: &Console, session: &Session) -> Result<Markup, Told> {
    let overview =
        ask(|then| console.store.overview(then)).await.map_err(|trouble| console.trouble(&trouble))?;
    let (value, text) =
        if overview.is_closed { ("yes", "Open admission") } else { ("no", "Close admission") };
    Ok(html! {
        div.choice {
            form method="post" action="/admin/admission" {
                (pages::mark(session))
                button type="submit" name="open" value=(value) { (text) }
            }
            form method="post" action="/admin/backup" {
                (pages::mark(session))
                button.quiet type="submit" { "Backup" }
            }
        }
    })
}
