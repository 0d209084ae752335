//! The command line: one file per subcommand. [`main`] is the whole program.
//!
//! Results go to standard output (one JSON object and nothing else with `--json`), progress and errors to standard
//! error. Exit codes: 0 done, 1 it went wrong (`error: …`, `hint: …`), 2 the command line is wrong.

mod avatars;
mod bench;
#[cfg(feature = "vulkan")]
mod demo;
mod devices;
mod figures;
mod gait;
#[cfg(all(feature = "view", feature = "xr"))]
mod mirror;
mod output;
mod perceive;
mod place;
mod preference;
mod progress;
#[cfg(feature = "vulkan")]
mod render;
mod replay;
mod scene;
#[cfg(feature = "vulkan")]
mod sheet;
mod simulate;
#[cfg(feature = "vulkan")]
mod stage;
mod validate;
#[cfg(feature = "vulkan")]
mod verify;
#[cfg(feature = "view")]
mod view;
#[cfg(feature = "xr")]
mod xr;

use crate::Error;
use clap::{Parser, Subcommand};
use output::complain;
use std::process::ExitCode;

/// Crowds of thousands of people who look happy, angry, sad or neutral.
#[derive(Debug, Parser)]
#[command(
    name = "gaitway",
    version,
    propagate_version = true,
    max_term_width = 100,
    after_help = "Examples:\n  gaitway simulate crossing --agents 2000 --seconds 10\n  gaitway render garden \
                  --camera eyes --out garden.png\n  gaitway verify --quick\n\nThe scenes are crossing, garden, \
                  parking and scifi, or a TOML file.\nEnvironment: GAITWAY_DEVICE names the Vulkan device, \
                  GAITWAY_VALIDATION=core|sync|gpu-av turns the validation layer on."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Simulate a crowd and measure it
    Simulate(simulate::Arguments),
    /// Draw a crowd into pictures or a video
    #[cfg(feature = "vulkan")]
    Render(render::Arguments),
    /// Look at a crowd in a window: stop it, ask it, change it, film it
    #[cfg(feature = "view")]
    View(view::Arguments),
    /// Walk other people's crowds, recorded or simulated, with bodies, gaits and emotions
    Replay(replay::Arguments),
    /// Walk through a crowd with a headset
    #[cfg(feature = "xr")]
    Xr(xr::Arguments),
    /// The window of `xr --mirror`, which that starts
    #[cfg(all(feature = "view", feature = "xr"))]
    #[command(hide = true)]
    Mirror(mirror::Arguments),
    /// Take scenes of other programs over
    Scene(place::Arguments),
    /// Ask a classifier which emotions the crowd shows
    Perceive(perceive::Arguments),
    /// Import, show or generate gaits
    Gait(gait::Arguments),
    /// Compare every kernel on this machine's Vulkan device with its CPU twin
    #[cfg(feature = "vulkan")]
    Verify(verify::Arguments),
    #[allow(clippy::doc_markdown, reason = "shown as it is by --help")]
    /// Test whether crowds move like people: RiMEA, NIST, fundamental diagrams, recorded crowds
    Validate(validate::Arguments),
    /// Time every kernel and the whole step
    Bench(bench::Arguments),
    /// List the Vulkan devices of this machine
    Devices(devices::Arguments),
    /// A crowd in the Crossing: trajectories, pictures, a contact sheet of the four emotions
    #[cfg(feature = "vulkan")]
    Demo(demo::Arguments),
}

/// Reads the command line, does what it says and returns the exit code.
pub fn main() -> ExitCode {
    let command = Cli::parse().command;
    let outcome = match command {
        Command::Simulate(arguments) => simulate::run(&arguments),
        #[cfg(feature = "vulkan")]
        Command::Render(arguments) => render::run(&arguments),
        #[cfg(feature = "view")]
        Command::View(arguments) => view::run(&arguments),
        Command::Replay(arguments) => replay::run(&arguments),
        #[cfg(feature = "xr")]
        Command::Xr(arguments) => xr::run(&arguments),
        #[cfg(all(feature = "view", feature = "xr"))]
        Command::Mirror(arguments) => mirror::run(&arguments),
        Command::Scene(arguments) => place::run(&arguments),
        Command::Perceive(arguments) => perceive::run(&arguments),
        Command::Gait(arguments) => gait::run(&arguments),
        #[cfg(feature = "vulkan")]
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Validate(arguments) => validate::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Devices(arguments) => devices::run(&arguments),
        #[cfg(feature = "vulkan")]
        Command::Demo(arguments) => demo::run(&arguments),
    };
    let is_good = match outcome {
        Ok(is_good) => is_good,
        Err(error) => {
            complain(&error);
            false
        }
    };
    if is_good && validation_is_silent() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Whether the validation layer had nothing to say; prints what it said.
fn validation_is_silent() -> bool {
    #[cfg(feature = "vulkan")]
    if std::env::var_os("GAITWAY_VALIDATION").is_some() {
        let messages = crate::gpu::validation_messages();
        for message in &messages {
            output::note(&format!("validation: {message}"));
        }
        if !messages.is_empty() {
            output::note(&format!("error: the validation layer had {} messages", messages.len()));
        }
        return messages.is_empty();
    }
    true
}

/// An error of the command line's own: what is not possible, and what to do instead.
fn usage(message: impl Into<String>, hint: impl Into<String>) -> Error {
    Error::Usage { message: message.into(), hint: hint.into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_sound_and_every_subcommand_shows_an_example() {
        let command = Cli::command();
        command.clone().debug_assert();
        let mut all: Vec<clap::Command> = command.get_subcommands().cloned().collect();
        while let Some(one) = all.pop() {
            let nested: Vec<_> = one.get_subcommands().cloned().collect();
            if nested.is_empty() && !one.is_hide_set() {
                let help = one.get_after_help().map(ToString::to_string).unwrap_or_default();
                assert!(help.contains("gaitway "), "{} has no example", one.get_name());
            }
            all.extend(nested);
        }
    }
}
