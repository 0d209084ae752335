//! `gaitway completions` and `gaitway man`: the command line for shells and for man.

use super::output::say;
use crate::{Error, export, file};
use clap::Args;
use clap_complete::Shell;
use std::path::PathBuf;

/// Arguments of `gaitway completions`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway completions bash > ~/.local/share/bash-completion/completions/gaitway\n  gaitway \
                  completions zsh > ~/.zfunc/_gaitway\n  gaitway completions fish > \
                  ~/.config/fish/completions/gaitway.fish"
)]
pub(super) struct CompletionsArguments {
    /// Which shell
    shell: Shell,
}

/// Arguments of `gaitway man`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway man | man -l -\n  gaitway man --out ~/.local/share/man/man1 --force"
)]
pub(super) struct ManArguments {
    /// Folder for a page of each command [default: the first page alone, printed]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// The whole command line, built, without what is not shown.
fn shown() -> clap::Command {
    let mut command = super::command_line();
    command.build();
    command
}

/// Prints a script for a shell.
pub(super) fn completions(arguments: &CompletionsArguments) -> Result<bool, Error> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut shown(), "gaitway", &mut script);
    say(String::from_utf8_lossy(&script).trim_end());
    Ok(true)
}

/// Prints or writes man pages.
pub(super) fn man(arguments: &ManArguments) -> Result<bool, Error> {
    let Some(folder) = &arguments.out else {
        say(page(shown())?.trim_end());
        return Ok(true);
    };
    super::outputs::make_folder(folder)?;
    let mut all = vec![shown()];
    while let Some(command) = all.pop() {
        all.extend(command.get_subcommands().filter(|one| !one.is_hide_set()).cloned());
        let name = command.get_display_name().unwrap_or_else(|| command.get_name());
        let path = folder.join(format!("{name}.1"));
        let text = page(command)?;
        file::write(&path, text.as_bytes())
            .map_err(|source| export::Error::Write { path: path.clone(), source })?;
        say(&format!("written  {}", path.display()));
    }
    Ok(true)
}

/// A command's page.
fn page(command: clap::Command) -> Result<String, Error> {
    let mut page = Vec::new();
    let written = clap_mangen::Man::new(command).render(&mut page);
    written
        .map_err(|error| super::failed(format!("the page cannot be made: {error}"), "see --help instead"))?;
    Ok(String::from_utf8_lossy(&page).into_owned())
}
