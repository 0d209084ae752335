//! Listeners, threads, beginning and end.

use super::admin::{self, Console};
use super::assets::Assets;
use super::cookie::{Cookie, random};
use super::guard::{Limits, Origin};
use super::patience::{Patient, Peer};
use super::reply::{Framing, hex};
use super::site::{Site, ask};
use super::stimulus::Stimuli;
use super::words::Interfaces;
use super::{Error, Settings, router};
use crate::study::lab::Lab;
use crate::study::store::Store;
use axum::Router;
use axum::body::{Body, to_bytes};
use axum::extract::ConnectInfo;
use axum::http::{Request, Response};
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::runtime::{Builder, Runtime};
use tokio::sync::watch;
use tower_service::Service as _;

/// How often it is looked whether the server is to end.
const LOOK: Duration = Duration::from_millis(100);
/// How long requests that are under way may take at the end.
const LAST_REQUESTS: Duration = Duration::from_secs(10);

/// A server that listens and does not answer yet.
#[derive(Debug)]
pub struct Server {
    runtime: Runtime,
    public: Option<Listening>,
    console: Option<Listening>,
    entrance: String,
    first_link: Option<String>,
}

type Listening = (TcpListener, SocketAddr, Router);

/// Serves a study until `stop` says so. `announce` is called when requests are taken: there is time to print the addresses.
///
/// # Errors
/// As [`Server::bind`] and [`Server::run`].
pub fn serve(
    store: Store,
    settings: &Settings,
    announce: impl FnOnce(&Server),
    stop: impl Fn() -> bool + Send + 'static,
) -> Result<(), Error> {
    let server = Server::bind(store, settings)?;
    announce(&server);
    server.run(stop)
}

impl Server {
    /// Listens, and makes pages and stimuli ready. Port 0 is any free port.
    ///
    /// # Errors
    /// [`Error::Listen`], [`Error::Unencrypted`], [`Error::PublicUrl`], [`Error::Embedding`] and [`Error::Console`] for addresses; [`Error::Clips`],
    /// [`Error::Library`] and [`Error::NoGait`] for stimuli; others when the system lacks threads or random bits.
    pub fn bind(store: Store, settings: &Settings) -> Result<Self, Error> {
        let origin = origin(settings)?;
        if let Some(address) = settings.console.filter(|address| !address.ip().is_loopback()) {
            return Err(Error::Console { address });
        }
        let framing = Framing::of(&store.current().study.file.recruit.embed_in)?;
        let stimuli = Stimuli::of(store.versions(), &settings.clips)?;
        let runtime = Builder::new_multi_thread().enable_all().build();
        let runtime = runtime.map_err(|source| Error::Failed { source })?;
        let console = settings.console.map(|address| listen(&runtime, address)).transpose()?;
        let (listener, address) = listen(&runtime, settings.listen)?;
        let entrance = match &origin {
            Origin::Public(url) => url.clone(),
            Origin::Loopback => format!("http://{address}"),
        };
        let entrance = format!("{entrance}/s/{}", store.current().study.file.study.id);
        let (console, first_link) = match console {
            Some(at) => {
                let made =
                    Console::new(store.clone(), random()?, settings.requests_of_one, Some(entrance.clone()))?;
                let (console, first_link) = open(&runtime, at, made)?;
                (Some(console), first_link)
            }
            None => (None, None),
        };
        let site = Site {
            store,
            assets: Assets::new()?,
            stimuli,
            interfaces: Interfaces::built_in()?,
            cookie: Cookie::of_participants(origin.is_encrypted(), framing.is_open),
            framing,
            origin,
            limits: Limits::new(random()?),
            is_behind_proxy: settings.is_behind_proxy,
            requests_per_minute: settings.requests_per_minute,
            requests_of_one: settings.requests_of_one,
        };
        let public = Some((listener, address, router::router(Arc::new(site))));
        Ok(Self { runtime, public, console, entrance, first_link })
    }

    /// Listens for operators alone, who sit beside a headset. Port 0 is any free port.
    ///
    /// # Errors
    /// [`Error::Listen`] and [`Error::Console`]; others when the system lacks threads or random bits.
    pub fn beside(store: &Store, address: SocketAddr, lab: Arc<Lab>) -> Result<Self, Error> {
        if !address.ip().is_loopback() {
            return Err(Error::Console { address });
        }
        let runtime = Builder::new_multi_thread().worker_threads(1).enable_all().build();
        let runtime = runtime.map_err(|source| Error::Failed { source })?;
        let at = listen(&runtime, address)?;
        let made =
            Console::new(store.clone(), random()?, Settings::default().requests_of_one, None)?.beside(lab);
        let (console, first_link) = open(&runtime, at, made)?;
        Ok(Self { runtime, public: None, console: Some(console), entrance: String::new(), first_link })
    }

    /// Where it listens for participants, if it does.
    pub fn address(&self) -> Option<SocketAddr> {
        self.public.as_ref().map(|(_, address, _)| *address)
    }

    /// The address of the first page, to be given to participants; empty where it does not listen for them.
    pub fn entrance(&self) -> &str {
        &self.entrance
    }

    /// Where it listens for operators.
    pub fn console_address(&self) -> Option<SocketAddr> {
        self.console.as_ref().map(|(_, address, _)| *address)
    }

    /// The link by which the first operator chooses a password, once; none where there are operators.
    pub fn first_link(&self) -> Option<&str> {
        self.first_link.as_deref()
    }

    /// Answers one request of a participant without a connection: what the pages say, for tests and for other servers. None
    /// where participants have no pages.
    ///
    /// # Errors
    /// [`Error::Failed`] where the reply breaks off.
    pub fn answer(&self, request: Request<Vec<u8>>) -> Option<Result<Response<Vec<u8>>, Error>> {
        self.public.as_ref().map(|listening| self.pass(listening, request))
    }

    /// The same for a request of an operator; none where operators have no pages.
    ///
    /// # Errors
    /// As [`Server::answer`].
    pub fn answer_operator(&self, request: Request<Vec<u8>>) -> Option<Result<Response<Vec<u8>>, Error>> {
        self.console.as_ref().map(|listening| self.pass(listening, request))
    }

    fn pass(
        &self,
        (_, address, router): &Listening,
        request: Request<Vec<u8>>,
    ) -> Result<Response<Vec<u8>>, Error> {
        let mut request = request.map(Body::from);
        request.extensions_mut().insert(ConnectInfo(Peer(*address)));
        self.runtime.block_on(async {
            let Ok(response) = router.clone().call(request).await;
            let (head, body) = response.into_parts();
            let bytes = to_bytes(body, usize::MAX).await;
            let bytes = bytes.map_err(|error| Error::Failed { source: std::io::Error::other(error) })?;
            Ok(Response::from_parts(head, bytes.to_vec()))
        })
    }

    /// Answers requests until `stop` says so; those under way then have ten seconds.
    ///
    /// # Errors
    /// [`Error::Failed`] when a listener fails.
    pub fn run(self, stop: impl Fn() -> bool + Send + 'static) -> Result<(), Error> {
        let (end, ends) = watch::channel(false);
        self.runtime.block_on(async move {
            let mut tasks = tokio::task::JoinSet::new();
            for (listener, _, router) in [self.public, self.console].into_iter().flatten() {
                let mut ends = ends.clone();
                let service = router.into_make_service_with_connect_info::<Peer>();
                let ended = async move {
                    let _ = ends.wait_for(|&end| end).await;
                };
                let served = axum::serve(Patient::new(listener), service).with_graceful_shutdown(ended);
                tasks.spawn(served.into_future());
            }
            while !stop() {
                tokio::time::sleep(LOOK).await;
            }
            let _ = end.send(true);
            let last = tokio::time::timeout(LAST_REQUESTS, tasks.join_all()).await;
            let failed = last.into_iter().flatten().find_map(Result::err);
            failed.map_or(Ok(()), |source| Err(Error::Failed { source }))
        })
    }
}

/// Operators' pages, and the link for the first operator where there is none yet.
fn open(
    runtime: &Runtime,
    (listener, address): (TcpListener, SocketAddr),
    console: Console,
) -> Result<(Listening, Option<String>), Error> {
    let mut first_link = None;
    if runtime.block_on(ask(|then| console.store.operators(then)))? == 0 {
        let key = hex(&random()?);
        first_link = Some(format!("http://{address}/admin/first?key={key}"));
        console.expect_first(&key);
    }
    Ok(((listener, address, admin::router(Arc::new(console))), first_link))
}

/// From where forms may come: the public address, or this machine.
fn origin(settings: &Settings) -> Result<Origin, Error> {
    let Some(url) = &settings.public_url else {
        let is_local = settings.listen.ip().is_loopback();
        let address = settings.listen;
        return if is_local { Ok(Origin::Loopback) } else { Err(Error::Unencrypted { address }) };
    };
    let host = url.trim_end_matches('/').strip_prefix("https://").unwrap_or_default();
    let is_host =
        !host.is_empty() && host.bytes().all(|b| b.is_ascii_alphanumeric() || b"-.:[]".contains(&b));
    let wrong = || Error::PublicUrl { url: url.clone() };
    is_host.then(|| Origin::Public(format!("https://{}", host.to_ascii_lowercase()))).ok_or_else(wrong)
}

fn listen(runtime: &Runtime, address: SocketAddr) -> Result<(TcpListener, SocketAddr), Error> {
    let bound = runtime.block_on(TcpListener::bind(address));
    let listened = bound.and_then(|listener| Ok((listener.local_addr()?, listener)));
    let (own, listener) = listened.map_err(|source| Error::Listen { address, source })?;
    Ok((listener, own))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_travel_encrypted_or_stay_on_this_machine() {
        let at = |listen: &str, url: Option<&str>| {
            origin(&Settings {
                listen: listen.parse().unwrap(),
                public_url: url.map(str::to_owned),
                ..Settings::default()
            })
        };
        assert_eq!(at("127.0.0.1:1", None).unwrap(), Origin::Loopback);
        assert_eq!(at("[::1]:1", None).unwrap(), Origin::Loopback);
        assert!(matches!(at("0.0.0.0:1", None), Err(Error::Unencrypted { .. })));
        let public = Origin::Public("https://lab.org".to_owned());
        assert_eq!(at("0.0.0.0:1", Some("https://Lab.org/")).unwrap(), public);
        for wrong in ["http://lab.org", "lab.org", "https://", "https://lab.org/path", "https://a b"] {
            assert!(matches!(at("127.0.0.1:1", Some(wrong)), Err(Error::PublicUrl { .. })), "{wrong}");
        }
    }
}
