//! The connection of a simulated browser: HTTP/1.1, one request at a time.

use axum::body::{Body, to_bytes};
use axum::http::header::{HOST, SET_COOKIE};
use axum::http::{Method, Request, Response};
use hyper::body::Incoming;
use hyper::client::conn::http1::{SendRequest, handshake};
use hyper_util::rt::TokioIo;
use std::time::Duration;
use tokio::net::TcpStream;
use tokio::runtime::Runtime;
use tokio::time::timeout;

/// Longest reply that is read, bytes.
const LONGEST_REPLY: usize = 4 << 20;
/// Longest time from a request to the end of its reply.
const PATIENCE: Duration = Duration::from_secs(20);

/// A connection, made when it is needed.
pub(super) struct Client<'r> {
    runtime: &'r Runtime,
    /// Host and port.
    host: String,
    sender: Option<SendRequest<Body>>,
}

/// What is sent.
pub(super) struct Sent<'s> {
    pub(super) method: Method,
    /// What follows the host in the address.
    pub(super) path: &'s str,
    pub(super) headers: &'s [(&'s str, &'s str)],
    pub(super) body: String,
}

/// What comes back.
#[derive(Debug)]
pub(super) struct Reply {
    pub(super) status: u16,
    /// The cookie that is set, with its attributes.
    pub(super) cookie: Option<String>,
    pub(super) text: String,
}

/// Why nothing came back.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failure {
    #[error("{0}")]
    Connection(#[from] std::io::Error),
    #[error("{0}")]
    Http(#[from] hyper::Error),
    #[error("{0}")]
    Request(#[from] axum::http::Error),
    #[error("{0}")]
    Body(#[from] axum::Error),
    #[error("no reply within {} s", PATIENCE.as_secs())]
    Late,
}

impl<'r> Client<'r> {
    /// A client of the server at `host:port`.
    pub(super) const fn new(runtime: &'r Runtime, host: String) -> Self {
        Self { runtime, host, sender: None }
    }

    /// Sends a request and reads the reply to its end.
    pub(super) fn send(&mut self, sent: &Sent<'_>) -> Result<Reply, Failure> {
        let runtime = self.runtime;
        let found = runtime.block_on(async { timeout(PATIENCE, self.exchange(sent)).await });
        let found = found.unwrap_or(Err(Failure::Late));
        if found.is_err() {
            // what the connection would say next belongs to this request
            self.sender = None;
        }
        found
    }

    async fn exchange(&mut self, sent: &Sent<'_>) -> Result<Reply, Failure> {
        let mut request = Request::builder().method(&sent.method).uri(sent.path).header(HOST, &self.host);
        for (name, value) in sent.headers {
            request = request.header(*name, *value);
        }
        let request = request.body(Body::from(sent.body.clone()))?;
        let response = self.connected().await?.send_request(request).await?;
        read(response).await
    }

    /// The connection; a new one where there is none, or the server has closed it.
    async fn connected(&mut self) -> Result<&mut SendRequest<Body>, Failure> {
        let open = match self.sender.take() {
            Some(mut sender) => sender.ready().await.is_ok().then_some(sender),
            None => None,
        };
        let sender = match open {
            Some(sender) => sender,
            None => {
                let stream = TcpStream::connect(&self.host).await?;
                // small requests, each waited for
                stream.set_nodelay(true)?;
                let (sender, connection) = handshake(TokioIo::new(stream)).await?;
                // its errors are those of the requests, too
                let _driven = tokio::spawn(connection);
                sender
            }
        };
        Ok(self.sender.insert(sender))
    }
}

async fn read(response: Response<Incoming>) -> Result<Reply, Failure> {
    let (parts, body) = response.into_parts();
    let cookie = parts.headers.get(SET_COOKIE).and_then(|value| value.to_str().ok()).map(str::to_owned);
    let bytes = to_bytes(Body::new(body), LONGEST_REPLY).await?;
    Ok(Reply { status: parts.status.as_u16(), cookie, text: String::from_utf8_lossy(&bytes).into_owned() })
}
