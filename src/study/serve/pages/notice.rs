//! Pages beside the study's own: what went wrong with a way out, and the question before a withdrawal.

use super::frame::{Frame, View, document};
use crate::study::file::OnWithdrawal;
use crate::study::serve::words::Interface;
use axum::http::StatusCode;
use maud::{Markup, html};

/// What a request is answered with in place of the study's page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Notice {
    /// Not stored; to be tried again.
    Unavailable,
    /// Takes no participants now.
    Closed,
    /// The participant has withdrawn before.
    Gone,
    /// The page is not the current one, or is not answered so.
    Refused,
    /// No participation has this code or secret.
    Unknown,
    /// No such address.
    NotFound,
    /// More requests than allowed.
    TooMany,
    /// A longer body than allowed.
    TooLarge,
    /// Neither a form nor JSON, or one that cannot be read.
    BadRequest,
    /// The content is of another type than forms and JSON.
    WrongType,
    /// Sent by a page of another host.
    Forbidden,
    /// The page belongs to an earlier participation in this browser.
    Other,
    /// It took too long.
    Timeout,
}

impl Notice {
    /// The status of the reply.
    pub(in super::super) const fn status(self) -> StatusCode {
        match self {
            Self::Unavailable | Self::Timeout => StatusCode::SERVICE_UNAVAILABLE,
            Self::Closed | Self::Gone => StatusCode::GONE,
            Self::Refused => StatusCode::CONFLICT,
            Self::Unknown => StatusCode::UNAUTHORIZED,
            Self::NotFound => StatusCode::NOT_FOUND,
            Self::TooMany => StatusCode::TOO_MANY_REQUESTS,
            Self::TooLarge => StatusCode::PAYLOAD_TOO_LARGE,
            Self::BadRequest => StatusCode::BAD_REQUEST,
            Self::WrongType => StatusCode::UNSUPPORTED_MEDIA_TYPE,
            Self::Forbidden | Self::Other => StatusCode::FORBIDDEN,
        }
    }

    /// Heading, text, and the button: its address within the study, its text.
    fn words(self, words: &Interface) -> (&str, &str, Option<(&'static str, &str)>) {
        let again = Some(("/go", words.try_again.as_str()));
        let start = Some(("", words.to_start.as_str()));
        let on = Some(("/go", words.go_on.as_str()));
        match self {
            Self::Unavailable | Self::Timeout => (&words.unavailable_title, &words.unavailable_text, again),
            Self::Closed => (&words.closed_title, &words.closed_text, None),
            Self::Gone => (&words.withdrawn_title, &words.gone_text, None),
            Self::Refused => (&words.refused_title, &words.refused_text, on),
            Self::Unknown => (&words.unknown_title, &words.unknown_text, start),
            Self::NotFound => (&words.not_found_title, &words.not_found_text, start),
            Self::TooMany => (&words.too_many_title, &words.too_many_text, again),
            Self::TooLarge => (&words.too_large_title, &words.too_large_text, on),
            Self::BadRequest | Self::WrongType => (&words.bad_request_title, &words.bad_request_text, on),
            Self::Forbidden => (&words.forbidden_title, &words.forbidden_text, start),
            Self::Other => (&words.other_title, &words.other_text, on),
        }
    }
}

/// The document of a notice.
pub(in super::super) fn notice(frame: &Frame<'_>, notice: Notice) -> Markup {
    let (title, text, way_out) = notice.words(frame.words);
    let body = html! {
        p { (text) }
        @if let Some((route, text)) = way_out {
            p { a.button href=(frame.at(route)) { (text) } }
        }
    };
    document(frame, &View::new(title, body))
}

/// The question before a withdrawal.
pub(in super::super) fn withdrawal(frame: &Frame<'_>) -> Markup {
    let words = frame.words;
    let text = match frame.study.consent.on_withdrawal {
        OnWithdrawal::Delete => &words.withdraw_delete,
        OnWithdrawal::KeepAnonymous => &words.withdraw_keep,
    };
    let body = html! {
        p { (text) }
        form.choice method="post" action=(frame.at("/withdraw")) {
            (frame.mark())
            button type="submit" name="sure" value="yes" { (words.withdraw_yes) }
            a.button href=(frame.at("/go")) { (words.withdraw_no) }
        }
    };
    document(frame, &View::new(&words.withdraw_title, body))
}
