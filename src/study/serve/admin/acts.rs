//! What operators do: with participants, with admission, with copies, with one another.

use super::super::form::{Fields, query};
use super::super::reply::{Told, page, see_other};
use super::super::site::ask;
use super::console::Console;
use super::live::{clock, late, place};
use super::pages;
use super::sessions::Session;
use super::sign::operator;
use crate::study::file::Front;
use crate::study::plan::Stimulus;
use crate::study::protocol::State as Stage;
use crate::study::store::{Act, Person, Role, Version, backup as write_backup};
use axum::extract::{Request, State};
use axum::http::{HeaderMap, StatusCode, Uri};
use axum::response::Response;
use maud::{Markup, html};
use std::sync::Arc;

/// Longest reason or note, letters.
const LONGEST: usize = 2000;
/// The act that cannot be undone, and what confirms it.
const WITHDRAW: &str = "withdraw";
/// What pages say after something was done, by the word in their address.
const SAID: [(&str, &str); 7] = [
    ("act", "Done."),
    ("opened", "Admission is open."),
    ("closed", "Admission is closed."),
    ("backup", "A copy is in the folder backups of the data."),
    ("operator", "The operator is named."),
    ("reason", "Give a reason or a text."),
    ("sure", "To withdraw a participant write \"withdraw\" into their field: it cannot be undone."),
];

type Shared = State<Arc<Console>>;

/// What was done before, as the address says it.
fn said(query: &Fields) -> Markup {
    let word = query.get("said").map_or("", String::as_str);
    let text = SAID.iter().find(|(own, _)| *own == word).map(|(_, text)| text);
    html! { @if let Some(text) = text { p role="status" { strong { (text) } } } }
}

/// All participants, with what can be done.
pub(super) async fn participants(
    State(console): Shared,
    address: Uri,
    headers: HeaderMap,
) -> Result<Response, Told> {
    let session = console.signed(&headers, Role::Watch)?;
    let people = ask(|then| console.store.people(then)).await.map_err(|trouble| console.trouble(&trouble))?;
    let heads =
        ["Code", "State", "Front", "Version", "Part", "Page", "Silent", "Late frames", "Reason", "Manage"];
    let body = html! {
        (said(&query(&address)))
        table {
            caption { (people.len()) @if people.len() == 1 { " participant" } @else { " participants" } ", in the order of arrival" }
            thead { tr { @for head in heads { th scope="col" { (head) } } } }
            tbody { @for person in &people { (row(&session, person)) } }
        }
    };
    Ok(page(StatusCode::OK, pages::document(&console, Some(&session), "Participants", &body)))
}

fn row(session: &Session, person: &Person) -> Markup {
    let front = match person.front {
        Front::Web => "web",
        Front::Headset => "headset",
        Front::Simulated => "simulated",
    };
    html! {
        tr id=(person.code) {
            th.code scope="row" { (person.code) }
            td { (person.state.name()) }
            td { (front) }
            td { (person.version) }
            td { (person.part) }
            td { (place(person)) }
            td { (clock(person.silent_ms)) }
            td { (late(person)) }
            td { (person.reason) }
            td { @if session.role >= Role::Run { (acts(session, person)) } }
        }
    }
}

/// The forms of one participant.
fn acts(session: &Session, person: &Person) -> Markup {
    let is_paused = person.state == Stage::Paused;
    let is_over = matches!(person.state, Stage::Ended(_));
    html! {
        form method="post" action="/admin/participants" {
            (pages::mark(session))
            input type="hidden" name="code" value=(person.code);
            @if is_paused { button.quiet name="act" value="resume" { "Resume" } }
            @else if !is_over { button.quiet name="act" value="pause" { "Pause" } }
            input name="text" maxlength=(LONGEST) placeholder="reason or note" aria-label="Reason or note";
            button.quiet name="act" value="note" { "Note" }
            button.quiet name="act" value="exclude" { "Exclude" }
            button.quiet name="act" value=(WITHDRAW) { "Withdraw" }
        }
    }
}

/// Does something with a participant.
pub(super) async fn act(State(console): Shared, request: Request) -> Result<Response, Told> {
    let (session, fields) = console.read(request, Role::Run).await?;
    let field = |name: &str| fields.get(name).map_or("", |value| value.trim());
    let text: String = field("text").chars().take(LONGEST).collect();
    let act = match field("act") {
        "note" | "exclude" if text.is_empty() => return Ok(see_other("/admin/participants?said=reason")),
        WITHDRAW if text != WITHDRAW => return Ok(see_other("/admin/participants?said=sure")),
        WITHDRAW => Act::Withdraw,
        "pause" => Act::Pause,
        "resume" => Act::Resume,
        "note" => Act::Note { text },
        "exclude" => Act::Exclude { reason: text },
        _ => {
            let text = "Load the page again.";
            return Err(pages::problem(&console, StatusCode::BAD_REQUEST, "Not a form", text).into());
        }
    };
    let done = ask(|then| console.store.operate(&session.name, field("code"), act, then)).await;
    done.map_err(|trouble| console.trouble(&trouble))?;
    Ok(see_other("/admin/participants?said=act"))
}

/// Counts by row or stimulus.
pub(super) async fn balance(State(console): Shared, headers: HeaderMap) -> Result<Response, Told> {
    let session = console.signed(&headers, Role::Watch)?;
    let overview =
        ask(|then| console.store.overview(then)).await.map_err(|trouble| console.trouble(&trouble))?;
    let version = console.store.current();
    let body = html! {
        p { "Answers and leases together: what is answered, and what participants under way are about to answer." }
        @for counts in overview.counts.iter().filter(|counts| !counts.counts.is_empty()) {
            @let is_filled = overview.answered.contains_key(&counts.part);
            table {
                caption { (counts.part) }
                thead { tr { th scope="col" { (if is_filled { "Stimulus" } else { "Row" }) } th scope="col" { "Count" } } }
                tbody {
                    @for (index, count) in counts.counts.iter().enumerate() {
                        tr { th scope="row" { (name_of(&version, &counts.part, index, is_filled)) } td { (count) } }
                    }
                }
            }
        }
    };
    Ok(page(StatusCode::OK, pages::document(&console, Some(&session), "Balance", &body)))
}

fn name_of(version: &Version, part: &str, index: usize, is_filled: bool) -> String {
    let step = version.plan.trials_of(part).filter(|_| is_filled);
    match step.and_then(|step| step.stimuli.get(index)) {
        Some(Stimulus::Gait { gait }) => gait.clone(),
        Some(Stimulus::Scene { scene, condition }) => format!("{scene}, {condition}"),
        Some(Stimulus::Agent { emotion, body, condition }) => format!("{emotion}, {body}, {condition}"),
        None => index.to_string(),
    }
}

/// Opens or closes admission.
pub(super) async fn admission(State(console): Shared, request: Request) -> Result<Response, Told> {
    let (session, fields) = console.read(request, Role::Run).await?;
    let is_open = fields.get("open").is_some_and(|open| open == "yes");
    let done = ask(|then| console.store.set_admission(&session.name, is_open, then)).await;
    done.map_err(|trouble| console.trouble(&trouble))?;
    Ok(see_other(&format!("/admin/participants?said={}", if is_open { "opened" } else { "closed" })))
}

/// Copies the store.
pub(super) async fn backup(State(console): Shared, request: Request) -> Result<Response, Told> {
    let (session, _) = console.read(request, Role::Run).await?;
    let folder = console.store.folder().to_owned();
    let written = tokio::task::spawn_blocking(move || write_backup(&folder)).await;
    let failed = |why: String| pages::problem(&console, StatusCode::SERVICE_UNAVAILABLE, "No copy", &why);
    written.map_err(|error| failed(error.to_string()))?.map_err(|error| failed(error.to_string()))?;
    let noted = ask(|then| console.store.audit(&session.name, "backup", "", then)).await;
    noted.map_err(|trouble| console.trouble(&trouble))?;
    Ok(see_other("/admin/participants?said=backup"))
}

/// The page to name operators.
pub(super) async fn operators(
    State(console): Shared,
    address: Uri,
    headers: HeaderMap,
) -> Result<Response, Told> {
    let session = console.signed(&headers, Role::Own)?;
    Ok(page(StatusCode::OK, naming(&console, &session, &said(&query(&address)))))
}

fn naming(console: &Console, session: &Session, above: &Markup) -> Markup {
    let body = html! {
        (above)
        p { "Names an operator, or gives one a new password or role. Watch sees; run also acts; own also names operators." }
        form method="post" action="/admin/operators" {
            (pages::mark(session))
            (pages::credentials("new-password"))
            fieldset.options {
                legend { "Role" }
                div.choices {
                    @for (role, name) in Role::ALL {
                        label {
                            input type="radio" name="role" value=(name) required checked[role == Role::Watch];
                            span { (name) }
                        }
                    }
                }
            }
            button type="submit" { "Name" }
        }
    };
    pages::document(console, Some(session), "Operators", &body)
}

/// Names an operator.
pub(super) async fn name(State(console): Shared, request: Request) -> Result<Response, Told> {
    let (session, fields) = console.read(request, Role::Own).await?;
    let wrong = |why: &str| {
        page(StatusCode::UNPROCESSABLE_ENTITY, naming(&console, &session, &pages::complaint(why)))
    };
    let role =
        fields.get("role").and_then(|role| Role::named(role)).ok_or_else(|| wrong("Choose a role."))?;
    let operator = operator(&fields, role).await.map_err(|why| wrong(&why))?;
    let name = operator.name.clone();
    let done = ask(|then| console.store.set_operator(&session.name, operator, then)).await;
    done.map_err(|trouble| console.trouble(&trouble))?;
    console.sessions.end_all(&name);
    Ok(see_other("/admin/operators?said=operator"))
}
