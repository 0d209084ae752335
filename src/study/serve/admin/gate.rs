//! Who may do what: the session of a request and its form.

use super::super::LONGEST_BODY;
use super::super::form::{self, Fields};
use super::super::reply::{self, Told};
use super::console::Console;
use super::pages;
use super::sessions::Session;
use crate::study::store::{Role, Trouble};
use axum::body::to_bytes;
use axum::extract::Request;
use axum::http::{HeaderMap, StatusCode};

impl Console {
    /// The session of a request.
    ///
    /// # Errors
    /// The reply: to the sign-in page, or that the role does not allow it.
    pub(super) fn signed(&self, headers: &HeaderMap, least: Role) -> Result<Session, Told> {
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
    pub(super) async fn read(&self, request: Request, least: Role) -> Result<(Session, Fields), Told> {
        let session = self.signed(request.headers(), least)?;
        let fields = self.fields(request).await?;
        if fields.get("mark") == Some(&session.mark) {
            return Ok((session, fields));
        }
        let text = "The form is not of this session. Load the page again.";
        Err(pages::problem(self, StatusCode::FORBIDDEN, "Not allowed", text).into())
    }

    pub(super) async fn fields(&self, request: Request) -> Result<Fields, Told> {
        let body = to_bytes(request.into_body(), LONGEST_BODY).await.ok();
        let wrong = || pages::problem(self, StatusCode::BAD_REQUEST, "Not a form", "Load the page again.");
        body.and_then(|body| form::fields(&body)).ok_or_else(|| wrong().into())
    }

    /// What an operator is shown when the store has not done what was asked.
    pub(super) fn trouble(&self, trouble: &Trouble) -> Told {
        let status = match trouble {
            Trouble::Unavailable(_) => StatusCode::SERVICE_UNAVAILABLE,
            Trouble::Unknown => StatusCode::NOT_FOUND,
            _ => StatusCode::CONFLICT,
        };
        pages::problem(self, status, "Not done", &trouble.to_string()).into()
    }
}
