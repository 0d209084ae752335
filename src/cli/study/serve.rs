//! `gaitway study serve`: a study in the browser, until Ctrl-C.

use super::super::output::{note, say};
use super::super::{failed, usage};
use super::beside::{Beside, Gaits, libraries};
use crate::Error;
use crate::study::check::Severity;
use crate::study::serve::{Server, Settings, serve};
use crate::study::store::{Opening, Store};
use crate::study::{self, Study};
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};

/// Folder of clips within the study's data.
const CLIPS: &str = "clips";

/// Arguments of `gaitway study serve`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  gaitway study serve mine/ --data run1/\n  gaitway study serve mine/ --data run1/ --public-url \
                  https://study.example.org --behind-proxy\n\nParticipants come to http://127.0.0.1:8080/s/ID, operators to \
                  http://127.0.0.1:8081/admin. For participants on other machines a reverse proxy holds the certificate: \
                  docs/studies.md has examples for Caddy and nginx.\nAn answer is on the disk before its page moves on. Ctrl-C ends \
                  the server in good order; the same command goes on with the same data."
)]
pub(super) struct Arguments {
    /// Study file, or folder with study.toml
    #[arg(value_name = "STUDY")]
    study: String,
    /// Library of gaits to take in place of the one that the study names
    #[arg(long, value_name = "LIB.glb")]
    library: Option<PathBuf>,
    /// Folder of the study's data; made if it is not there
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// Address and port for participants
    #[arg(long, default_value = "127.0.0.1:8080", value_name = "ADDRESS:PORT")]
    listen: SocketAddr,
    /// Address that participants use: that of the reverse proxy with the certificate
    #[arg(long, value_name = "https://HOST")]
    public_url: Option<String>,
    /// A proxy stands before it: trust its X-Forwarded-For
    #[arg(long)]
    behind_proxy: bool,
    /// Address and port for operators, on this machine
    #[arg(long, default_value = "127.0.0.1:8081", value_name = "ADDRESS:PORT")]
    console: SocketAddr,
    /// Requests a minute from neighbouring addresses; 0: without limit
    #[arg(long, default_value_t = Settings::default().requests_per_minute, value_name = "N")]
    requests_per_minute: u32,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let study = super::study(&arguments.study)?;
    let beside = Beside::of(&study, &Gaits::of(arguments.library.clone()))?;
    check(&study, &beside)?;
    let opening = Opening { libraries: files(&study, arguments)?, materials: beside.materials, study };
    let heed = crate::stop::heed();
    let store = Store::open(&arguments.data, &opening)?;
    let settings = Settings {
        listen: arguments.listen,
        public_url: arguments.public_url.clone(),
        is_behind_proxy: arguments.behind_proxy,
        requests_per_minute: arguments.requests_per_minute,
        console: Some(arguments.console),
        clips: arguments.data.join(CLIPS),
    };
    serve(store, &settings, announce, crate::stop::asked)?;
    drop(heed);
    note("note: the server has ended; all answers are stored");
    Ok(true)
}

fn announce(server: &Server) {
    say(&format!("participants  {}", server.entrance()));
    if let Some(address) = server.console_address() {
        say(&format!("operators     http://{address}/admin"));
    }
    if let Some(link) = server.first_link() {
        say(&format!("password      choose the first operator's, once, at {link}"));
    }
    note("note: Ctrl-C ends the server; the same command goes on with the same data");
}

/// A study with errors, or with something left to fill in, is not served.
fn check(study: &Study, beside: &Beside) -> Result<(), Error> {
    let report = study::check(study, &beside.materials);
    let is_serious = |note: &&study::check::Note| note.severity != Severity::Warning;
    let mut serious = report.notes.iter().filter(is_serious);
    let Some(first) = serious.next() else { return Ok(()) };
    let more = serious.count();
    let hint = match more {
        0 => first.hint.clone(),
        _ => format!("`gaitway study check` lists {more} more"),
    };
    Err(failed(first.to_string(), hint))
}

/// The files of the libraries that the study shows.
fn files(study: &Study, arguments: &Arguments) -> Result<BTreeMap<String, PathBuf>, Error> {
    let folder = study.folder.as_deref().unwrap_or(Path::new("."));
    let mut files = BTreeMap::new();
    for name in libraries(study) {
        let path = arguments.library.clone().unwrap_or_else(|| folder.join(&name));
        if !path.is_file() {
            let message = format!("{}: the library of gaits is not there", path.display());
            return Err(usage(message, "put it beside the study file, or name one with --library"));
        }
        files.insert(name, path);
    }
    Ok(files)
}
