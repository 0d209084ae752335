//! What participants ask for and send.

use super::cookie::{PARTICIPATION, mark};
use super::form::{self, Fields, Sheet};
use super::gate::is_json;
use super::pages::{self, Filled, Notice, Texts, Visit, Welcome};
use super::platform::{self, encoded};
use super::reply::{self, Told, page, see_other, with_cookie};
use super::site::{Site, ask, now};
use super::visit::Visitor;
use crate::study::file::Front;
use crate::study::plan::Ending;
use crate::study::protocol::{Answer, Content, Event, Refusal, State as Stage};
use crate::study::store::{Arrival, Arrived, Trouble, Turn};
use axum::extract::{Path, Request, State};
use axum::http::header::ACCEPT;
use axum::http::{HeaderMap, StatusCode, Uri};
use axum::response::Response;
use std::sync::Arc;

/// The field that begins a participation beside the one that the browser has, as on a shared machine.
const NEW: &str = "new";
/// What a program that reads pages accepts.
const JSON: &str = "application/json";
/// Longest name or key that a client may send, bytes.
const LONGEST_NAME: usize = 200;
/// Longest reason of a fault or kind of a sign, letters.
const LONGEST_REASON: usize = 200;

type Shared = State<Arc<Site>>;

/// The first page; a returning participant goes on.
pub(super) async fn welcome(
    State(site): Shared,
    Path(id): Path<String>,
    address: Uri,
    headers: HeaderMap,
) -> Result<Response, Told> {
    let visitor = Visitor::new(&site, &id, headers)?;
    let query = form::query(&address);
    let version = site.store.current();
    let study = &version.study.file;
    let platform = study.recruit.platform;
    if let Some(code) = query.get("code") {
        let arrived = ask(|then| site.store.resume(code, Front::Web, then)).await;
        return arrived
            .map(|arrived| enter(&site, &id, &arrived))
            .map_err(|trouble| visitor.trouble(&trouble));
    }
    let is_preview = platform::is_preview(platform, &query);
    let comes_by_link = platform::id(platform, &query).is_some();
    let is_new = query.contains_key(NEW) || comes_by_link || is_preview;
    if !is_new && visitor.turn().await.is_ok() {
        return Ok(see_other(&format!("/s/{id}/go")));
    }
    let languages = &study.study.languages;
    let asked = query.get("lang").filter(|lang| languages.contains(lang)).cloned();
    let language = asked.unwrap_or_else(|| site.language(&version, &visitor.headers));
    let mut carried = platform::carried(platform, &query);
    if query.contains_key(NEW) {
        carried.push((NEW, "1"));
    }
    let links: Vec<(String, String)> =
        languages.iter().map(|tag| (tag.clone(), link(&id, tag, &carried))).collect();
    let welcome = Welcome { carried: &carried, is_preview, languages: &links };
    Ok(page(StatusCode::OK, pages::welcome(&site.frame(&version, &language, None), welcome)))
}

/// The address of the first page in a language, with what the platform sent.
fn link(id: &str, language: &str, carried: &[(&str, &str)]) -> String {
    let pair = |(name, value): &(&str, &str)| format!("&{}={}", encoded(name), encoded(value));
    let rest: String = carried.iter().map(pair).collect();
    format!("/s/{id}?lang={}{rest}", encoded(language))
}

/// Gives the browser its secret and shows the current page.
fn enter(site: &Site, id: &str, arrived: &Arrived) -> Response {
    with_cookie(see_other(&format!("/s/{id}/go")), &site.cookie.set(&arrived.token, PARTICIPATION))
}

/// Begins a participation; with `agree`, says whether the participant agrees.
pub(super) async fn begin(
    State(site): Shared,
    Path(id): Path<String>,
    request: Request,
) -> Result<Response, Told> {
    let (visitor, fields) = Visitor::form(&site, &id, request).await?;
    match fields.get("agree").map(String::as_str) {
        Some(answer) => {
            visitor.check_mark(&fields)?;
            decide(&visitor, answer == "yes").await
        }
        None => arrive(&visitor, &fields).await,
    }
}

async fn arrive(visitor: &Visitor<'_>, fields: &Fields) -> Result<Response, Told> {
    let site = visitor.site;
    let version = site.store.current();
    let study = &version.study.file;
    let platform = study.recruit.platform;
    if platform::is_preview(platform, fields) {
        return Err(visitor.told(Notice::Refused));
    }
    let platform = platform::id(platform, fields);
    if platform.is_none() && !fields.contains_key(NEW) {
        // a double click, or a second tab, makes no second participant
        let current = visitor.turn().await;
        if current.is_ok_and(|turn| !matches!(turn.state, Stage::Ended(_))) {
            return Ok(see_other(&visitor.at("/go")));
        }
    }
    let wished = fields.get("language").filter(|wished| study.study.languages.contains(wished)).cloned();
    let language = wished.unwrap_or_else(|| site.language(&version, &visitor.headers));
    let arrival = Arrival { front: Front::Web, language, platform };
    let arrived = ask(|then| site.store.arrive(arrival, then)).await;
    arrived.map(|arrived| enter(site, visitor.id, &arrived)).map_err(|trouble| visitor.trouble(&trouble))
}

async fn decide(visitor: &Visitor<'_>, is_agreed: bool) -> Result<Response, Told> {
    let turn = visitor.turn().await?;
    if let Content::Consent { .. } = turn.page.content {
        let text = visitor.consent_hash(&turn);
        visitor.submit(if is_agreed { Event::Consented { text } } else { Event::Declined }).await?;
    }
    Ok(see_other(&visitor.at("/go")))
}

/// The current page, whatever it is.
pub(super) async fn go(
    State(site): Shared,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Told> {
    let visitor = Visitor::new(&site, &id, headers)?;
    if visitor.secret.is_none() {
        return Ok(see_other(&visitor.at("")));
    }
    let turn = visitor.turn().await?;
    if reply::text(&visitor.headers, &ACCEPT) == JSON {
        return Ok(visitor
            .secret
            .as_deref()
            .map_or_else(|| see_other(&visitor.at("")), |secret| told(secret, &turn)));
    }
    let credit = credit(&visitor, &turn).await?;
    Ok(show(&visitor, &turn, StatusCode::OK, credit.as_deref(), &Filled::default()))
}

/// The address that grants credit to a participant who has finished, where there is one.
async fn credit(visitor: &Visitor<'_>, turn: &Turn) -> Result<Option<String>, Told> {
    let version = visitor.site.version(turn.version);
    let recruit = &version.study.file.recruit;
    let is_finished = turn.state == Stage::Ended(Ending::Finished);
    let Some(secret) = visitor.secret.as_deref().filter(|_| is_finished && platform::grants_credit(recruit))
    else {
        return Ok(None);
    };
    let id = ask(|then| visitor.site.store.platform_id(secret, then)).await;
    let id = id.map_err(|trouble| visitor.trouble(&trouble))?;
    Ok(id.and_then(|id| platform::credit_of(recruit, &id)))
}

/// The current page for a program in place of a browser. It tells no more than the page does.
fn told(secret: &str, turn: &Turn) -> Response {
    reply::json(
        StatusCode::OK,
        &serde_json::json!({ "page": turn.page, "mark": mark(secret), "code": turn.code }),
    )
}

fn show(
    visitor: &Visitor<'_>,
    turn: &Turn,
    status: StatusCode,
    credit: Option<&str>,
    filled: &Filled,
) -> Response {
    let site = visitor.site;
    let version = site.version(turn.version);
    let mark = visitor.secret.as_deref().map(mark).unwrap_or_default();
    let visit = Visit { code: &turn.code, mark: &mark };
    let consent = match &turn.page.content {
        Content::Consent { text, .. } => version.text(text),
        _ => None,
    };
    let seconds = version.plan.trials_of(&turn.page.part).map_or(0.0, |trials| trials.shows.seconds);
    let texts = Texts { consent: consent.unwrap_or_default(), seconds, credit, now: now() };
    let frame = site.frame(&version, &turn.language, Some(visit));
    page(status, pages::turn(&frame, &turn.page, texts, filled))
}

/// One answer from a script, or all of a page's answers from a form.
pub(super) async fn answer(
    State(site): Shared,
    Path(id): Path<String>,
    request: Request,
) -> Result<Response, Told> {
    let (visitor, body) = Visitor::read(&site, &id, request).await?;
    if !is_json(&visitor.headers) {
        let fields = form::fields(&body).ok_or_else(|| visitor.told(Notice::BadRequest))?;
        visitor.check_mark(&fields)?;
        return fill_in(&visitor, &fields).await;
    }
    visitor.check_header()?;
    let answer: Answer =
        serde_json::from_slice(&body).map_err(|_unreadable| visitor.told(Notice::BadRequest))?;
    let names = [&answer.page, &answer.question, &answer.key];
    if answer.key.is_empty() || names.iter().any(|name| name.len() > LONGEST_NAME) {
        return Err(visitor.told(Notice::BadRequest));
    }
    Ok(committed(&visitor.submit(Event::Answer(answer)).await?))
}

/// The reply to a script: it is on the disk.
fn committed(turn: &Turn) -> Response {
    reply::json(StatusCode::OK, &serde_json::json!({ "page": turn.page.id }))
}

async fn fill_in(visitor: &Visitor<'_>, fields: &Fields) -> Result<Response, Told> {
    let turn = visitor.turn().await?;
    let asked = fields.get("page").map_or("", String::as_str);
    if asked != turn.page.id {
        return Ok(see_other(&visitor.at("/go")));
    }
    let Sheet { answers, mut filled } = form::sheet(fields, asked, turn.page.content.questions(), now());
    for answer in answers {
        visitor.submit(Event::Answer(answer)).await?;
    }
    if filled.lacking.is_empty() {
        match visitor.offer(Event::Next { page: asked.to_owned() }).await {
            Ok(_) => return Ok(see_other(&visitor.at("/go"))),
            Err(Trouble::Refused(Refusal::Unanswered { questions })) => filled.lacking.extend(questions),
            Err(trouble) => return Err(visitor.trouble(&trouble)),
        }
    }
    Ok(show(visitor, &turn, StatusCode::UNPROCESSABLE_ENTITY, None, &filled))
}

/// What happened on a page, from a script.
pub(super) async fn event(
    State(site): Shared,
    Path(id): Path<String>,
    request: Request,
) -> Result<Response, Told> {
    let (visitor, body) = Visitor::read(&site, &id, request).await?;
    if !is_json(&visitor.headers) {
        return Err(visitor.told(Notice::WrongType));
    }
    visitor.check_header()?;
    let mut event: Event =
        serde_json::from_slice(&body).map_err(|_unreadable| visitor.told(Notice::BadRequest))?;
    if !event.is_open_to_fronts() {
        return Err(visitor.told(Notice::Forbidden));
    }
    match &mut event {
        // what was agreed to is the server's to say
        Event::Consented { text } => *text = visitor.consent_hash(&visitor.turn().await?),
        Event::Fault { reason, .. } => shorten(reason),
        Event::Sign { kind, .. } => shorten(kind),
        _ => {}
    }
    Ok(committed(&visitor.submit(event).await?))
}

fn shorten(text: &mut String) {
    if let Some((end, _)) = text.char_indices().nth(LONGEST_REASON) {
        text.truncate(end);
    }
}

/// Asks once, then withdraws.
pub(super) async fn withdraw(
    State(site): Shared,
    Path(id): Path<String>,
    request: Request,
) -> Result<Response, Told> {
    let (visitor, fields) = Visitor::form(&site, &id, request).await?;
    visitor.check_mark(&fields)?;
    if fields.get("sure").is_some_and(|sure| sure == "yes") {
        let turn = visitor.submit(Event::Withdrawn).await?;
        return Ok(show(&visitor, &turn, StatusCode::OK, None, &Filled::default()));
    }
    let turn = visitor.turn().await?;
    if matches!(turn.state, Stage::Ended(Ending::Withdrawn | Ending::Declined)) {
        return Ok(see_other(&visitor.at("/go")));
    }
    let version = site.version(turn.version);
    let mark = visitor.secret.as_deref().map(mark).unwrap_or_default();
    let visit = Visit { code: &turn.code, mark: &mark };
    Ok(page(StatusCode::OK, pages::withdrawal(&site.frame(&version, &turn.language, Some(visit)))))
}
