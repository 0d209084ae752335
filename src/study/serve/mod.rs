//! A study in the browser: pages for participants at one address, pages for operators at another.
//!
//! ```text
//!  browser ─► guard ─► participant ─► store (commit) ─► page
//!             origin   cookie, form     one writer       escaped HTML; scripts only for films and at-once answers
//!             limits   or JSON
//! ```
//!
//! ```no_run
//! use gaitway::study::serve::{Server, Settings};
//! # fn f(store: gaitway::study::store::Store) -> Result<(), gaitway::study::serve::Error> {
//! let server = Server::bind(store, &Settings::default())?;
//! println!("participants: {}", server.entrance());
//! if let Some(link) = server.first_link() {
//!     println!("choose the first password once at {link}");
//! }
//! server.run(gaitway::stop::asked)
//! # }
//! ```
//!
//! Nothing that a browser gets names a gait, an emotion of a stimulus or a condition.

mod admin;
mod assets;
mod clip;
mod cookie;
mod form;
mod gate;
mod guard;
mod markdown;
mod pages;
mod participant;
mod patience;
mod platform;
mod reply;
mod router;
mod server;
mod site;
mod stimulus;
mod visit;
mod words;

pub use server::{Server, serve};

use std::net::SocketAddr;
use std::path::PathBuf;

/// Longest body of a form or of JSON, bytes.
const LONGEST_BODY: usize = 16 << 10;
/// Longest time until a reply, s.
const PATIENCE_SECONDS: u64 = 10;

/// How a study is served.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Settings {
    /// Where participants' requests arrive. Beyond this machine it needs `public_url`.
    pub listen: SocketAddr,
    /// The address that participants use, `https://HOST`: that of the reverse proxy that has the certificate.
    pub public_url: Option<String>,
    /// Whether a proxy stands before it, whose `X-Forwarded-For` tells the participant's address.
    pub is_behind_proxy: bool,
    /// Requests a minute from neighbouring addresses (/24, or /48 of IPv6); 0 is without limit.
    pub requests_per_minute: u32,
    /// Requests a minute of one participant or one operator; 0 is without limit.
    pub requests_of_one: u32,
    /// Where operators' requests arrive, on this machine; none for no operators' pages.
    pub console: Option<SocketAddr>,
    /// Folder with the clips of stimuli that are no walks, `NAME.mp4`.
    pub clips: PathBuf,
}

/// Port 8080 for participants and 8081 for operators, on this machine alone.
impl Default for Settings {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from(([127, 0, 0, 1], 8080)),
            public_url: None,
            is_behind_proxy: false,
            requests_per_minute: 600,
            requests_of_one: 300,
            console: Some(SocketAddr::from(([127, 0, 0, 1], 8081))),
            clips: PathBuf::from("clips"),
        }
    }
}

/// A study cannot be served.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Another program listens there, or this one may not.
    #[error("cannot listen at {address}: {source}; choose another port")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// Why.
        source: std::io::Error,
    },
    /// Answers would travel unencrypted.
    #[error(
        "{address} can be reached from other machines: say with --public-url https://HOST which proxy has the certificate"
    )]
    Unencrypted {
        /// The address.
        address: SocketAddr,
    },
    /// The public address is none.
    #[error("public address {url:?}: must be https:// and a host, without a path")]
    PublicUrl {
        /// What was given.
        url: String,
    },
    /// A page that may show the study in a frame is named by more or less than its origin.
    #[error("recruit.embed_in: {origin:?} must be https:// and a host, without a path")]
    Embedding {
        /// What the study file says.
        origin: String,
    },
    /// Operators' pages would be reachable from other machines.
    #[error(
        "{address} can be reached from other machines: operators' pages stay on this one; reach them through ssh -L"
    )]
    Console {
        /// The address.
        address: SocketAddr,
    },
    /// Stimuli that are clips are not there.
    #[error("{count} clips are missing in {folder:?}: {first}; `gaitway study clips` makes them")]
    Clips {
        /// Where they should be.
        folder: PathBuf,
        /// How many are missing.
        count: usize,
        /// The first of them, with what they show.
        first: String,
    },
    /// A frozen library cannot be read.
    #[error(transparent)]
    Library(#[from] crate::library::Error),
    /// A frozen library lacks a gait of the plan.
    #[error(
        "part {part:?}: its frozen library has no gait {gait:?}; restore the folder of data from its backup"
    )]
    NoGait {
        /// The part.
        part: String,
        /// The gait.
        gait: String,
    },
    /// The words of the interface are incomplete, which a test excludes.
    #[error("assets/web/words.toml: {message}")]
    Words {
        /// What is wrong.
        message: String,
    },
    /// A file could not be compressed.
    #[error("cannot compress a page's file: {source}")]
    Compress {
        /// Why.
        source: std::io::Error,
    },
    /// A walk could not be written as JSON.
    #[error("cannot write a walk as JSON: {source}")]
    Encode {
        /// Why.
        source: serde_json::Error,
    },
    /// The system has no random bits.
    #[error("the system gives no random bits: {reason}")]
    NoRandomness {
        /// Why.
        reason: String,
    },
    /// The threads or connections of the server failed.
    #[error("the server failed: {source}")]
    Failed {
        /// Why.
        source: std::io::Error,
    },
    /// The store did not answer when the server started.
    #[error(transparent)]
    Store(#[from] super::store::Trouble),
}
