//! Replies: their headers, bodies that are compressed once, hexadecimal digits.

use super::Error;
use crate::study::file::Recruit;
use axum::body::{Body, Bytes};
use axum::http::header::{
    ACCEPT_ENCODING, CACHE_CONTROL, CONTENT_ENCODING, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderName,
    LOCATION, REFERRER_POLICY, SET_COOKIE, STRICT_TRANSPORT_SECURITY, VARY, X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use flate2::Compression;
use flate2::write::GzEncoder;
use maud::Markup;
use std::io::Write as _;

/// What a page may load: only what comes from its own host. Who may show it in a frame follows.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; media-src 'self'; \
                      connect-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors";
/// A name that never means other bytes.
const FOR_EVER: &str = "public, max-age=31536000, immutable";

/// A reply in place of what was asked for.
#[derive(Debug)]
pub(super) struct Told(Box<Response>);

impl From<Response> for Told {
    fn from(response: Response) -> Self {
        Self(Box::new(response))
    }
}

impl IntoResponse for Told {
    fn into_response(self) -> Response {
        *self.0
    }
}

/// Bytes with their type, compressed once.
#[derive(Debug, Clone)]
pub(super) struct Packed {
    kind: &'static str,
    plain: Bytes,
    pub(super) gzipped: Bytes,
}

impl Packed {
    /// Compresses bytes.
    ///
    /// # Errors
    /// [`Error::Compress`].
    pub(super) fn new(kind: &'static str, plain: Vec<u8>) -> Result<Self, Error> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        let written = encoder.write_all(&plain).and_then(|()| encoder.finish());
        let gzipped = written.map_err(|source| Error::Compress { source })?;
        Ok(Self { kind, plain: plain.into(), gzipped: gzipped.into() })
    }

    /// The reply, which may be kept for ever.
    pub(super) fn reply(&self, takes_gzip: bool) -> Response {
        let body = if takes_gzip { &self.gzipped } else { &self.plain };
        let mut response = Response::new(Body::from(body.clone()));
        let headers = response.headers_mut();
        headers.insert(CONTENT_TYPE, HeaderValue::from_static(self.kind));
        headers.insert(VARY, HeaderValue::from_static("accept-encoding"));
        if takes_gzip {
            headers.insert(CONTENT_ENCODING, HeaderValue::from_static("gzip"));
        }
        keep_for_ever(headers);
        response
    }
}

/// Marks a reply as one that never changes.
pub(super) fn keep_for_ever(headers: &mut HeaderMap) {
    headers.insert(CACHE_CONTROL, HeaderValue::from_static(FOR_EVER));
}

/// Whether a browser unpacks gzip.
pub(super) fn takes_gzip(headers: &HeaderMap) -> bool {
    text(headers, &ACCEPT_ENCODING).split(',').any(|entry| {
        let (name, rest) = entry.split_once(';').unwrap_or((entry, ""));
        name.trim().eq_ignore_ascii_case("gzip") && rest.trim() != "q=0"
    })
}

/// A header as text; empty if it is missing or no text.
pub(super) fn text<'h>(headers: &'h HeaderMap, name: &HeaderName) -> &'h str {
    headers.get(name).and_then(|value| value.to_str().ok()).unwrap_or_default()
}

/// A page.
pub(super) fn page(status: StatusCode, markup: Markup) -> Response {
    let kind = [(CONTENT_TYPE, "text/html; charset=utf-8")];
    (status, kind, markup.into_string()).into_response()
}

/// A reply to a script.
pub(super) fn json<T: serde::Serialize>(status: StatusCode, value: &T) -> Response {
    let body = serde_json::to_vec(value).unwrap_or_default();
    (status, [(CONTENT_TYPE, "application/json")], body).into_response()
}

/// Sends the browser to another address of this host, by GET.
pub(super) fn see_other(address: &str) -> Response {
    let mut response = StatusCode::SEE_OTHER.into_response();
    if let Ok(address) = HeaderValue::from_str(address) {
        response.headers_mut().insert(LOCATION, address);
    }
    response
}

/// Adds a cookie to a reply.
pub(super) fn with_cookie(mut response: Response, cookie: &str) -> Response {
    if let Ok(cookie) = HeaderValue::from_str(cookie) {
        response.headers_mut().append(SET_COOKIE, cookie);
    }
    response
}

/// Who may show the pages in a frame.
#[derive(Debug, Clone)]
pub(super) struct Framing {
    policy: HeaderValue,
    /// Whether any page may.
    pub(super) is_open: bool,
}

impl Framing {
    /// Pages of these origins may; of none, no page may.
    ///
    /// # Errors
    /// [`Error::Embedding`] for what is no origin: it would change the policy.
    pub(super) fn of(origins: &[String]) -> Result<Self, Error> {
        if let Some(wrong) = origins.iter().find(|origin| !Recruit::is_origin(origin)) {
            return Err(Error::Embedding { origin: wrong.clone() });
        }
        let list = if origins.is_empty() { "'none'".to_owned() } else { origins.join(" ") };
        let policy = HeaderValue::from_str(&format!("{POLICY} {list}"));
        let policy = policy.map_err(|_unprintable| Error::Embedding { origin: list })?;
        Ok(Self { policy, is_open: !origins.is_empty() })
    }
}

/// Adds the headers that every reply has.
pub(super) fn harden(headers: &mut HeaderMap, is_encrypted: bool, framing: &Framing) {
    headers.entry(CONTENT_SECURITY_POLICY).or_insert_with(|| framing.policy.clone());
    let mut set = |name: HeaderName, value: &'static str| {
        headers.entry(name).or_insert(HeaderValue::from_static(value));
    };
    set(X_CONTENT_TYPE_OPTIONS, "nosniff");
    set(REFERRER_POLICY, "same-origin");
    set(CACHE_CONTROL, "no-store");
    set(HeaderName::from_static("cross-origin-opener-policy"), "same-origin");
    set(HeaderName::from_static("cross-origin-resource-policy"), "same-origin");
    if !framing.is_open {
        // older than the policy, and knows no origins
        set(HeaderName::from_static("x-frame-options"), "DENY");
    }
    set(
        HeaderName::from_static("permissions-policy"),
        "camera=(), geolocation=(), microphone=(), payment=(), usb=()",
    );
    if is_encrypted {
        set(STRICT_TRANSPORT_SECURITY, "max-age=31536000");
    }
}

/// Bytes as hexadecimal digits.
pub(super) fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gzip_is_sent_to_browsers_that_take_it() {
        let takes = |value: &'static str| {
            let headers = HeaderMap::from_iter([(ACCEPT_ENCODING, HeaderValue::from_static(value))]);
            takes_gzip(&headers)
        };
        assert!(takes("br, gzip") && takes("GZIP;q=0.5"));
        assert!(!takes("br") && !takes("gzip;q=0") && !takes_gzip(&HeaderMap::new()));
        assert_eq!(hex(&[0, 171]), "00ab");
    }

    #[test]
    fn only_origins_come_into_the_policy() {
        let framing =
            |origins: &[&str]| Framing::of(&origins.iter().map(|&own| own.to_owned()).collect::<Vec<_>>());
        let none = framing(&[]).unwrap();
        assert!(none.policy.to_str().unwrap().ends_with("; frame-ancestors 'none'") && !none.is_open);
        let two = framing(&["https://lab.example.org", "http://localhost:8000"]).unwrap();
        let end = "; frame-ancestors https://lab.example.org http://localhost:8000";
        assert!(two.policy.to_str().unwrap().ends_with(end) && two.is_open);
        for wrong in [
            "*",
            "https://*",
            "https://*.org",
            "http://lab.org",
            "https://lab.org/x",
            "https://a; script-src *",
            "https://a b",
            "https://a:0",
            "https://",
            "https://.",
            "'self'",
            "",
        ] {
            assert!(matches!(framing(&[wrong]), Err(Error::Embedding { .. })), "{wrong}");
        }
    }
}
