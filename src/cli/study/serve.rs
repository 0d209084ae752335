//! `gaitway study serve`: a study in the browser, until Ctrl-C.

use super::super::output::{note, say};
use super::opening::OpeningArguments;
use crate::Error;
use crate::study::serve::{Server, Settings, serve};
use std::net::SocketAddr;

/// Folder of clips within the study's data.
pub(super) const CLIPS: &str = "clips";

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
    #[command(flatten)]
    opening: OpeningArguments,
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
    let heed = crate::stop::heed();
    let store = arguments.opening.open()?;
    let settings = Settings {
        listen: arguments.listen,
        public_url: arguments.public_url.clone(),
        is_behind_proxy: arguments.behind_proxy,
        requests_per_minute: arguments.requests_per_minute,
        console: Some(arguments.console),
        clips: arguments.opening.data.join(CLIPS),
        ..Settings::default()
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
