//! One request of a participant: who sends it, and what the store says to it.

use super::LONGEST_BODY;
use super::cookie::mark;
use super::form::{Fields, fields};
use super::gate::{is_json, told};
use super::pages::Notice;
use super::reply::{Told, json};
use super::site::{Site, ask};
use crate::study::protocol::{Content, Event};
use crate::study::store::{Trouble, Turn};
use axum::body::{Bytes, to_bytes};
use axum::extract::Request;
use axum::http::header::{CONTENT_LENGTH, HeaderName, HeaderValue, RETRY_AFTER};
use axum::http::{HeaderMap, StatusCode};

/// The header in which scripts send a page's mark.
const MARK: HeaderName = HeaderName::from_static("x-participation");

/// One request of a participant.
pub(super) struct Visitor<'a> {
    pub(super) site: &'a Site,
    /// The study, as the address has it.
    pub(super) id: &'a str,
    pub(super) headers: HeaderMap,
    /// The secret of the participation.
    pub(super) secret: Option<String>,
}

impl<'a> Visitor<'a> {
    /// A request without a body.
    ///
    /// # Errors
    /// The reply, for a study that is not served here.
    pub(super) fn new(site: &'a Site, id: &'a str, headers: HeaderMap) -> Result<Self, Told> {
        if site.store.current().study.file.study.id != id {
            return Err(told(site, &headers, Notice::NotFound).into());
        }
        let secret = site.cookie.find(&headers);
        Ok(Self { site, id, headers, secret })
    }

    /// A request with its body.
    ///
    /// # Errors
    /// The reply, for a study that is not served here or a body that is too long.
    pub(super) async fn read(site: &'a Site, id: &'a str, request: Request) -> Result<(Self, Bytes), Told> {
        let (parts, body) = request.into_parts();
        let visitor = Self::new(site, id, parts.headers)?;
        let announced =
            visitor.headers.get(CONTENT_LENGTH).and_then(|value| value.to_str().ok()?.parse().ok());
        if announced.is_some_and(|length: usize| length > LONGEST_BODY) {
            return Err(visitor.told(Notice::TooLarge));
        }
        let body = to_bytes(body, LONGEST_BODY).await.map_err(|_too_long| visitor.told(Notice::TooLarge))?;
        Ok((visitor, body))
    }

    /// A request with a form.
    ///
    /// # Errors
    /// As [`Visitor::read`]; also the reply to a body that is no form.
    pub(super) async fn form(site: &'a Site, id: &'a str, request: Request) -> Result<(Self, Fields), Told> {
        let (visitor, body) = Self::read(site, id, request).await?;
        let fields = fields(&body).ok_or_else(|| visitor.told(Notice::BadRequest))?;
        Ok((visitor, fields))
    }

    /// An address of the study.
    pub(super) fn at(&self, route: &str) -> String {
        format!("/s/{}{route}", self.id)
    }

    /// What the request is answered with in place of a page.
    pub(super) fn told(&self, what: Notice) -> Told {
        told(self.site, &self.headers, what).into()
    }

    /// That a form is of the participation that the browser has.
    ///
    /// # Errors
    /// The reply, for a page of an earlier participation or of another host.
    pub(super) fn check_mark(&self, fields: &Fields) -> Result<(), Told> {
        self.check(fields.get("mark").map(String::as_str))
    }

    /// The same for what a script sends.
    ///
    /// # Errors
    /// As [`Visitor::check_mark`].
    pub(super) fn check_header(&self) -> Result<(), Told> {
        self.check(self.headers.get(MARK).and_then(|value| value.to_str().ok()))
    }

    fn check(&self, sent: Option<&str>) -> Result<(), Told> {
        let Some(secret) = &self.secret else { return Err(self.told(Notice::Unknown)) };
        if sent == Some(mark(secret).as_str()) { Ok(()) } else { Err(self.told(Notice::Other)) }
    }

    /// Where the participant is.
    ///
    /// # Errors
    /// The reply, for an unknown participant or a store that does not answer.
    pub(super) async fn turn(&self) -> Result<Turn, Told> {
        let Some(secret) = &self.secret else { return Err(self.told(Notice::Unknown)) };
        let turn = ask(|then| self.site.store.turn(secret, then)).await;
        turn.map_err(|trouble| self.trouble(&trouble))
    }

    /// Stores an event; returns when it is on the disk.
    ///
    /// # Errors
    /// What the store says.
    pub(super) async fn offer(&self, event: Event) -> Result<Turn, Trouble> {
        let Some(secret) = &self.secret else { return Err(Trouble::Unknown) };
        ask(|then| self.site.store.submit(secret, event, then)).await
    }

    /// The same, with the reply where the event was not stored.
    ///
    /// # Errors
    /// The reply.
    pub(super) async fn submit(&self, event: Event) -> Result<Turn, Told> {
        self.offer(event).await.map_err(|trouble| self.trouble(&trouble))
    }

    /// What a participant is shown when the store has not done what was asked.
    pub(super) fn trouble(&self, trouble: &Trouble) -> Told {
        let what = match trouble {
            Trouble::Unknown | Trouble::Elsewhere(_) => Notice::Unknown,
            Trouble::Closed => Notice::Closed,
            Trouble::Gone => Notice::Gone,
            Trouble::Refused(refusal) if is_json(&self.headers) => {
                return json(StatusCode::CONFLICT, refusal).into();
            }
            Trouble::Refused(_) => Notice::Refused,
            Trouble::Unavailable(_) => Notice::Unavailable,
        };
        let mut response = told(self.site, &self.headers, what);
        if what == Notice::Unavailable {
            response.headers_mut().insert(RETRY_AFTER, HeaderValue::from_static("1"));
        }
        response.into()
    }

    /// The hash of the text that the participant's page asks to agree to; empty on other pages.
    pub(super) fn consent_hash(&self, turn: &Turn) -> String {
        let version = self.site.version(turn.version);
        match &turn.page.content {
            Content::Consent { text, .. } => version.text_hash(text),
            _ => String::new(),
        }
    }
}
