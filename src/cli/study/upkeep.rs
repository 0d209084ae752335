//! `gaitway study backup, withdraw, purge, merge`: what happens to the data of a study beside the study.

use super::super::output::{say, say_json};
use super::super::usage;
use crate::Error;
use crate::study::protocol::State;
use crate::study::store::{Act, Store, Trouble, backup, merge, wait};
use serde::Serialize;
use std::path::PathBuf;

/// Who the audit says did it.
const OPERATOR: &str = "command line";

/// Arguments of `gaitway study backup`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  gaitway study backup run1/\n\nIt may be made while the study runs, and holds no ids of the \
                        platform. The newest 24 are kept. A running study makes one an hour by itself."
)]
pub(super) struct BackupArguments {
    /// Folder of the study's data
    #[arg(value_name = "DIR")]
    data: PathBuf,
}

/// Arguments of `gaitway study withdraw`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  gaitway study withdraw run1/ K7Q0-1XZB-...\n\nAs if the participant had withdrawn: answers are \
                        deleted or lose what leads to the participant, as consent.on_withdrawal says. Copies in backups/ keep \
                        them for a day. While a server runs, use its admin page."
)]
pub(super) struct WithdrawArguments {
    /// Folder of the study's data
    #[arg(value_name = "DIR")]
    data: PathBuf,
    /// The participant's code
    #[arg(value_name = "CODE")]
    code: String,
}

/// Arguments of `gaitway study purge`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  gaitway study purge run1/\n\nDeletes ids of the platform that are older than data.keep_links_days, \
                        and participants older than data.keep_answers_days. A running study does so every hour."
)]
pub(super) struct PurgeArguments {
    /// Folder of the study's data
    #[arg(value_name = "DIR")]
    data: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Arguments of `gaitway study merge`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  gaitway study merge run1/ run2/ --into all/\n\nFor analysis of what several machines collected \
                        with the same version of a study. The folders stay as they are."
)]
pub(super) struct MergeArguments {
    /// Folders of the study's data
    #[arg(value_name = "DIR", required = true, num_args = 2..)]
    data: Vec<PathBuf>,
    /// Folder to write
    #[arg(long, value_name = "DIR")]
    into: PathBuf,
}

#[derive(Debug, Serialize)]
struct Purged {
    links: usize,
    participants: usize,
}

/// Runs `backup`.
pub(super) fn make_backup(arguments: &BackupArguments) -> Result<bool, Error> {
    let path = backup(&arguments.data)?;
    say(&format!("written  {}", path.display()));
    Ok(true)
}

/// Runs `withdraw`.
pub(super) fn withdraw(arguments: &WithdrawArguments) -> Result<bool, Error> {
    let store = Store::open_again(&arguments.data)?;
    let turn = match wait(|then| store.operate(OPERATOR, &arguments.code, Act::Withdraw, then)) {
        Err(Trouble::Unknown) => {
            let message = format!("{}: no participant has this code", arguments.code);
            return Err(usage(message, "`gaitway study status --people` lists all codes"));
        }
        other => other.map_err(super::opening::trouble)?,
    };
    say(&format!("{}  {}", turn.code, State::name(turn.state)));
    Ok(true)
}

/// Runs `purge`.
pub(super) fn purge(arguments: &PurgeArguments) -> Result<bool, Error> {
    let store = Store::open_again(&arguments.data)?;
    let (links, participants) = wait(|then| store.purge(then)).map_err(super::opening::trouble)?;
    if arguments.json {
        say_json(&Purged { links, participants })?;
    } else {
        say(&format!("deleted  {links} ids of the platform, {participants} participants"));
    }
    Ok(true)
}

/// Runs `merge`.
pub(super) fn run_merge(arguments: &MergeArguments) -> Result<bool, Error> {
    let participants = merge(&arguments.data, &arguments.into)?;
    say(&format!("written  {} ({participants} participants)", arguments.into.display()));
    Ok(true)
}
