//! `gaitway study`: studies with people, from the file to the analysis.

mod analyse;
mod beside;
mod check;
#[cfg(all(feature = "study", feature = "video", feature = "vulkan"))]
mod clips;
mod export;
mod folder;
mod new;
#[cfg(feature = "study")]
mod opening;
mod power;
#[cfg(feature = "study")]
mod register;
#[cfg(feature = "study")]
mod rehearse;
#[cfg(all(feature = "study", feature = "xr"))]
mod replay;
#[cfg(all(feature = "study", feature = "xr"))]
mod run;
#[cfg(feature = "study")]
mod serve;
mod simulate;
#[cfg(feature = "study")]
mod status;
#[cfg(all(feature = "study", feature = "xr"))]
mod terminal;
#[cfg(feature = "study")]
mod upkeep;

use crate::Error;
use clap::{Args, Subcommand};

/// Arguments of `gaitway study`.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Write the files of a study into a folder, to be filled in
    New(new::Arguments),
    /// Check a study: errors with their line, what is missing, how long it takes, how many people it needs
    Check(check::Arguments),
    /// Let simulated participants take part
    Simulate(simulate::Arguments),
    /// Test what a study's answers say, as its file plans it
    Analyse(analyse::Arguments),
    /// Write a study's data as a Psych-DS dataset, with an R script and the results
    Export(export::Arguments),
    /// How many people Friedman's test needs
    Power(power::Arguments),
    /// Write a page that registers a study before its first participant
    #[cfg(feature = "study")]
    Register(register::Arguments),
    /// Film what a study in the browser shows of scenes and agents
    #[cfg(all(feature = "study", feature = "video", feature = "vulkan"))]
    Clips(clips::Arguments),
    /// Serve a study to browsers, until Ctrl-C
    #[cfg(feature = "study")]
    Serve(serve::Arguments),
    /// Show a study in a headset to one participant
    #[cfg(all(feature = "study", feature = "xr"))]
    Run(Box<run::Arguments>),
    /// Do recorded trials of a headset again, and compare
    #[cfg(all(feature = "study", feature = "xr"))]
    Replay(replay::Arguments),
    /// Let simulated browsers take part at a running server
    #[cfg(feature = "study")]
    Rehearse(rehearse::Arguments),
    /// A running or finished study at a glance
    #[cfg(feature = "study")]
    Status(status::Arguments),
    /// Copy the data of a study, while it runs or not
    #[cfg(feature = "study")]
    Backup(upkeep::BackupArguments),
    /// Withdraw a participant who asks for it
    #[cfg(feature = "study")]
    Withdraw(upkeep::WithdrawArguments),
    /// Delete what is older than the study's dates allow
    #[cfg(feature = "study")]
    Purge(upkeep::PurgeArguments),
    /// Make one folder of data of several
    #[cfg(feature = "study")]
    Merge(upkeep::MergeArguments),
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    match &arguments.command {
        Command::New(arguments) => new::run(arguments),
        Command::Check(arguments) => check::run(arguments),
        Command::Simulate(arguments) => simulate::run(arguments),
        Command::Analyse(arguments) => analyse::run(arguments),
        Command::Export(arguments) => export::run(arguments),
        Command::Power(arguments) => power::run(arguments),
        #[cfg(feature = "study")]
        Command::Register(arguments) => register::run(arguments),
        #[cfg(all(feature = "study", feature = "video", feature = "vulkan"))]
        Command::Clips(arguments) => clips::run(arguments),
        #[cfg(feature = "study")]
        Command::Serve(arguments) => serve::run(arguments),
        #[cfg(all(feature = "study", feature = "xr"))]
        Command::Run(arguments) => run::run(arguments),
        #[cfg(all(feature = "study", feature = "xr"))]
        Command::Replay(arguments) => replay::run(arguments),
        #[cfg(feature = "study")]
        Command::Rehearse(arguments) => rehearse::run(arguments),
        #[cfg(feature = "study")]
        Command::Status(arguments) => status::run(arguments),
        #[cfg(feature = "study")]
        Command::Backup(arguments) => upkeep::make_backup(arguments),
        #[cfg(feature = "study")]
        Command::Withdraw(arguments) => upkeep::withdraw(arguments),
        #[cfg(feature = "study")]
        Command::Purge(arguments) => upkeep::purge(arguments),
        #[cfg(feature = "study")]
        Command::Merge(arguments) => upkeep::run_merge(arguments),
    }
}
