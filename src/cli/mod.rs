//! The command line: one file per subcommand. [`main`] is the whole program.
//!
//! Results go to standard output (one JSON object and nothing else with `--json`), progress and errors to standard
//! error. Exit codes: 0 done, 1 the run failed (`error: …`, `hint: …`), 2 the command line is wrong, 130
//! interrupted.

mod bench;
mod course;
#[cfg(feature = "vulkan")]
mod demo;
mod devices;
#[cfg(all(test, feature = "study", feature = "video", feature = "view", feature = "xr"))]
mod documents;
mod failure;
mod figures;
mod gait;
mod manual;
#[cfg(all(feature = "view", feature = "xr"))]
mod mirror;
mod output;
mod outputs;
mod perceive;
mod place;
mod plan;
mod preference;
mod progress;
#[cfg(feature = "xr")]
mod recorded;
#[cfg(feature = "vulkan")]
mod render;
mod replay;
mod run;
mod scenario;
mod scene;
mod scenes;
#[cfg(feature = "vulkan")]
mod sheet;
mod simulate;
mod study;
mod threads;
mod validate;
mod verify;
#[cfg(feature = "view")]
mod view;
#[cfg(feature = "xr")]
mod xr;

use crate::{Error, stop};
use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use failure::{WENT_WRONG, WRONG_COMMAND_LINE, failed, usage};
use output::complain;
use std::ffi::OsString;
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
                  GAITWAY_ARITHMETIC=native|careful says how it computes, GAITWAY_DRAWS=direct draws people where the driver shows none, GAITWAY_PIPELINE_CACHE names another folder for compiled \
                  pipelines or says off, GAITWAY_VALIDATION=core|sync|gpu-av turns the validation layer on.\nExit codes: 0 done; 1 it went \
                  wrong while doing, or a test failed; 2 the command line is wrong: an unknown option or name, a value \
                  out of range; 130 interrupted by Ctrl-C.\nFiles that exist are kept unless --force is given."
)]
struct Cli {
    #[command(flatten)]
    manner: Manner,
    #[command(subcommand)]
    command: Command,
}

/// How every command goes about it.
#[derive(Debug, Clone, Copy, clap::Args)]
struct Manner {
    /// Replace files that exist, and write into folders that are not empty
    #[arg(long, global = true, help_heading = "Everywhere")]
    force: bool,
    /// Say nothing but results and errors
    #[arg(short, long, global = true, conflicts_with = "verbose", help_heading = "Everywhere")]
    quiet: bool,
    /// Say what is read, where it is computed and how long it takes
    #[arg(short, long, global = true, help_heading = "Everywhere")]
    verbose: bool,
    /// Arithmetic of a Vulkan device: its own, or careful code; `auto` takes careful code for what the device does not compute
    /// exactly [default: `GAITWAY_ARITHMETIC`, or auto]
    #[cfg(feature = "vulkan")]
    #[arg(long, value_enum, global = true, value_name = "WHICH", help_heading = "Everywhere")]
    arithmetic: Option<Arithmetic>,
}

/// Arithmetic that a Vulkan device can be told to take.
#[cfg(feature = "vulkan")]
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Arithmetic {
    Auto,
    Native,
    Careful,
}

#[cfg(feature = "vulkan")]
impl Arithmetic {
    /// Makes it the choice of this process.
    fn choose(self) {
        use crate::gpu::arithmetic::Wanted;
        let wanted = match self {
            Self::Auto => Wanted::Auto,
            Self::Native => Wanted::Native,
            Self::Careful => Wanted::Careful,
        };
        wanted.choose();
    }
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
    /// Plan a sweep: many runs of one scenario, for this machine or a cluster
    Plan(plan::Arguments),
    /// Do runs of a plan; those that are done are skipped
    Run(run::Arguments),
    /// Walk other people's crowds, recorded or simulated, with bodies, gaits and emotions
    Replay(replay::Arguments),
    /// Walk through a crowd with a headset
    #[cfg(feature = "xr")]
    Xr(xr::Arguments),
    /// The window of `xr --mirror`, which that starts
    #[cfg(all(feature = "view", feature = "xr"))]
    #[command(hide = true)]
    Mirror(mirror::Arguments),
    /// Begin, check and explain scenario files, take scenes of other programs over, list the built-in ones
    Scene(place::Arguments),
    /// Ask a classifier which emotions the crowd shows
    Perceive(perceive::Arguments),
    /// Import, show or generate gaits
    Gait(gait::Arguments),
    /// Plan a study with people, simulate its participants, analyse its answers
    Study(study::Arguments),
    /// Compare every kernel on this machine's Vulkan device, and by the CPU's lanes, with its plain twin
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
    /// Completions of commands and options for a shell
    Completions(manual::CompletionsArguments),
    /// The manual as man pages
    Man(manual::ManArguments),
}

impl Command {
    /// Whether it can do its work without a Vulkan device, with `--backend cpu`.
    fn has_backend(&self) -> bool {
        match self {
            Self::Simulate(_) | Self::Run(_) | Self::Perceive(_) | Self::Validate(_) | Self::Bench(_) => true,
            Self::Replay(arguments) => !arguments.draws(),
            _ => false,
        }
    }

    /// Whether the command only lists the scenes, and whether in JSON.
    fn lists_scenes(&self) -> Option<bool> {
        let (list, json) = match self {
            Self::Simulate(arguments) => arguments.lists(),
            #[cfg(feature = "vulkan")]
            Self::Render(arguments) => arguments.lists(),
            Self::Perceive(arguments) => arguments.lists(),
            #[cfg(feature = "view")]
            Self::View(arguments) => arguments.lists(),
            #[cfg(feature = "xr")]
            Self::Xr(arguments) => arguments.lists(),
            _ => return None,
        };
        list.then_some(json)
    }
}

/// Reads the command line, does what it says and returns the exit code.
pub fn main() -> ExitCode {
    ExitCode::from(run_with(std::env::args_os()))
}

/// The same for words of a command line that did not start this process as they are; the first is the program's name.
pub fn run_with(words: impl IntoIterator<Item = OsString>) -> u8 {
    stop::listen();
    threads::start();
    let parsed = command_line()
        .try_get_matches_from(words)
        .and_then(|found| Ok((Cli::from_arg_matches(&found)?, found)));
    match parsed {
        Err(answer) => output::print(&answer),
        Ok((cli, found)) => {
            output::set_manner(cli.manner.quiet, cli.manner.verbose);
            #[cfg(feature = "vulkan")]
            cli.manner.arithmetic.into_iter().for_each(Arithmetic::choose);
            let has_backend = cli.command.has_backend();
            let outcome = check_environment().and_then(|()| match cli.command.lists_scenes() {
                Some(is_json) => scenes::list(is_json),
                None => outputs::check(&found, cli.manner.force).and_then(|()| run(cli.command)),
            });
            exit_code(outcome, has_backend)
        }
    }
}

/// The command line. A negative number is a value, so that its error names the allowed range, not an unknown option.
fn command_line() -> clap::Command {
    fn all(command: clap::Command) -> clap::Command {
        let number = |argument: clap::Arg| {
            let takes = argument.get_action().takes_values();
            if takes { argument.allow_negative_numbers(true) } else { argument }
        };
        command.mut_args(number).mut_subcommands(all)
    }
    all(Cli::command())
}

/// Checks the values of environment variables, whether they are needed or not.
fn check_environment() -> Result<(), Error> {
    #[cfg(feature = "vulkan")]
    crate::gpu::Validation::from_environment()
        .and_then(|_| crate::gpu::arithmetic::Setting::of_process())
        .and_then(|_| crate::gpu::Draws::of_process())
        .map_err(|error| usage(error.to_string(), "or leave it out"))?;
    Ok(())
}

/// The exit code of an outcome; prints its error.
fn exit_code(outcome: Result<bool, Error>, has_backend: bool) -> u8 {
    let is_silent = validation_is_silent();
    match outcome.and_then(|is_good| output::said().map(|()| is_good)) {
        Ok(_) if stop::asked() => {
            output::note("interrupted: what was written ends where it was");
            stop::EXIT_CODE
        }
        Ok(is_good) if is_good && is_silent => 0,
        Ok(_) => WENT_WRONG,
        Err(error) => {
            complain(&error, has_backend);
            if is_of_the_command_line(&error) { WRONG_COMMAND_LINE } else { WENT_WRONG }
        }
    }
}

/// Whether an error comes from the command line, not from the work or from files.
fn is_of_the_command_line(error: &Error) -> bool {
    use crate::export::image::Error as Picture;
    use crate::scenario::Error as Scenario;
    match error {
        Error::Usage { .. }
        | Error::Scenario(Scenario::UnknownScene { .. } | Scenario::Setting { .. })
        | Error::Scene(crate::scene::Error::NoAgent { .. }) => true,
        Error::Export(crate::export::Error::Picture(Picture::Ending { .. } | Picture::FrameRate(_))) => true,
        Error::Scenario(Scenario::Value(bad)) => is_set(&bad.place),
        Error::Scenario(Scenario::Syntax { place, .. }) => is_set(place),
        _ => false,
    }
}

/// Whether a place is the option `--set` and no file.
fn is_set(place: &str) -> bool {
    place.starts_with("--set ")
}

/// Does what a command says; false when what it tested is not good.
fn run(command: Command) -> Result<bool, Error> {
    match command {
        Command::Simulate(arguments) => simulate::run(&arguments),
        #[cfg(feature = "vulkan")]
        Command::Render(arguments) => render::run(&arguments),
        #[cfg(feature = "view")]
        Command::View(arguments) => view::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        Command::Run(arguments) => run::run(&arguments),
        Command::Replay(arguments) => replay::run(&arguments),
        #[cfg(feature = "xr")]
        Command::Xr(arguments) => xr::run(&arguments),
        #[cfg(all(feature = "view", feature = "xr"))]
        Command::Mirror(arguments) => mirror::run(&arguments),
        Command::Scene(arguments) => place::run(&arguments),
        Command::Perceive(arguments) => perceive::run(&arguments),
        Command::Gait(arguments) => gait::run(&arguments),
        Command::Study(arguments) => study::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Validate(arguments) => validate::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Devices(arguments) => devices::run(&arguments),
        #[cfg(feature = "vulkan")]
        Command::Demo(arguments) => demo::run(&arguments),
        Command::Completions(arguments) => manual::completions(&arguments),
        Command::Man(arguments) => manual::man(&arguments),
    }
}

/// Whether the validation layer had nothing to say; prints what it said.
fn validation_is_silent() -> bool {
    #[cfg(feature = "vulkan")]
    if std::env::var_os("GAITWAY_VALIDATION").is_some() {
        let messages = crate::gpu::validation_messages();
        for message in &messages {
            output::warn(&format!("validation: {message}"));
        }
        if !messages.is_empty() {
            output::warn(&format!("error: the validation layer had {} messages", messages.len()));
        }
        return messages.is_empty();
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_sound_and_every_subcommand_shows_an_example() {
        let command = command_line();
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
