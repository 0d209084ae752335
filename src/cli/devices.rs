//! `gaitway devices`: what this machine has for Vulkan and for a headset, and what is missing.

use super::output::{say, say_json, table};
use crate::Error;
use clap::Args;
use serde::Serialize;

/// Arguments of `gaitway devices`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway devices\n  gaitway devices --json\n  gaitway simulate crossing \
                        --device 1\n  GAITWAY_DEVICE=llvmpipe gaitway verify"
)]
pub(super) struct Arguments {
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Row {
    index: usize,
    name: String,
    kind: &'static str,
    api: String,
    driver: String,
    /// Whether it draws images tile by tile in memory of its own.
    tiler: bool,
    /// Whether crowds are drawn by arguments that stay on the device, unless `GAITWAY_DRAWS` says otherwise.
    indirect_draws: bool,
    usable: bool,
    reason: Option<String>,
}

#[derive(Debug, Serialize)]
struct List {
    devices: Vec<Row>,
    /// The one that draws when none is named.
    best: Option<usize>,
    /// The one that crowds walk on when none is named; null where that is the CPU.
    crowds: Option<usize>,
    /// The one that `GAITWAY_DEVICE` names: null where it names none; left out where it is not set.
    #[serde(skip_serializing_if = "Option::is_none")]
    named: Option<Option<usize>>,
    /// Why there is none at all.
    missing: Option<String>,
    hint: Option<String>,
    /// What there is for a headset; null in a build without it.
    #[cfg(feature = "xr")]
    openxr: crate::xr::Survey,
    #[cfg(not(feature = "xr"))]
    openxr: Option<()>,
}

/// Longest wait for an OpenXR runtime that hangs.
#[cfg(feature = "xr")]
const PATIENCE: std::time::Duration = std::time::Duration::from_secs(10);

#[cfg(feature = "xr")]
fn openxr() -> crate::xr::Survey {
    crate::xr::hush_loader();
    crate::xr::survey(PATIENCE)
}

#[cfg(not(feature = "xr"))]
fn openxr() -> Option<()> {
    None
}

/// Runs the subcommand. No device is no error: the CPU backend needs none.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let list = list();
    if arguments.json {
        say_json(&list)?;
        return Ok(true);
    }
    if !list.devices.is_empty() {
        let rows: Vec<Vec<String>> = list.devices.iter().map(|row| row.words(list.best)).collect();
        table(&["", "name", "kind", "Vulkan", "driver", "usable"], &rows);
    }
    say(&match (list.best, &list.missing) {
        (Some(best), _) if list.crowds == list.best => {
            format!("\nDevice {best} is taken unless --device or GAITWAY_DEVICE names another.")
        }
        (Some(best), _) => format!(
            "\nDevice {best} draws unless --device or GAITWAY_DEVICE names another. It is software, so crowds walk on the \
             CPU unless it is named or asked for with --backend vulkan."
        ),
        (None, Some(missing)) => format!("No Vulkan device: {missing}."),
        (None, None) => "\nNo device can be used.".to_owned(),
    });
    match list.named {
        Some(Some(index)) => say(&format!("GAITWAY_DEVICE names device {index}.")),
        Some(None) => {
            say("GAITWAY_DEVICE names none of these that can be used: commands that need one will fail.");
        }
        None => {}
    }
    if let Some(hint) = &list.hint {
        say(&format!("hint: {hint}"));
    }
    if list.best.is_none() {
        say("The CPU backend works without: --backend cpu. Pictures need a device, if only a software one.");
    }
    say_openxr(&list.openxr);
    Ok(true)
}

/// From the loader up to the headset, and what is missing.
#[cfg(feature = "xr")]
fn say_openxr(openxr: &crate::xr::Survey) {
    say("\nHeadset (OpenXR)");
    let line = |name: &str, text: &str| say(&format!("  {name:<11}{text}"));
    let yes = |there: bool, yes: &str| if there { yes.to_owned() } else { "no".to_owned() };
    line("loader", &yes(openxr.loader, "yes"));
    let manifest = openxr.manifest.as_ref().map(|path| format!("yes, {}", path.display()));
    line("installed", &yes(openxr.installed, manifest.as_deref().unwrap_or("yes")));
    line("answers", &yes(openxr.answers, "yes"));
    if let Some(runtime) = &openxr.runtime {
        line("runtime", &runtime.runtime);
        let [width, height] = runtime.eye_size;
        line("headset", &format!("{}, {width}x{height} pixels an eye", runtime.headset));
        line("uses", &runtime.extensions.join(", "));
        if !runtime.absent.is_empty() {
            line("not offered", &runtime.absent.join(", "));
        }
    }
    if let Some(missing) = &openxr.missing {
        say(&format!("No headset: {missing}."));
    }
    if let Some(hint) = &openxr.hint {
        say(&format!("hint: {hint}"));
    }
}

#[cfg(not(feature = "xr"))]
fn say_openxr(_: &Option<()>) {
    say("\nThis build has no headset: build with the feature `xr` (it is on by default).");
}

impl Row {
    fn words(&self, best: Option<usize>) -> Vec<String> {
        let mark = if best == Some(self.index) { "*" } else { "" };
        vec![
            format!("{}{mark}", self.index),
            self.name.clone(),
            if self.tiler { format!("{}, tiler", self.kind) } else { self.kind.to_owned() },
            self.api.clone(),
            self.driver.clone(),
            self.reason.as_ref().map_or("yes".to_owned(), |reason| format!("no: {reason}")),
        ]
    }
}

#[cfg(feature = "vulkan")]
fn list() -> List {
    use crate::gpu::Wanted;
    let devices = match crate::gpu::list() {
        Ok(devices) => devices,
        Err(error) => {
            let hint = error.hint().map(str::to_owned);
            return List {
                devices: Vec::new(),
                best: None,
                crowds: None,
                named: None,
                missing: Some(error.to_string()),
                hint,
                openxr: openxr(),
            };
        }
    };
    let best = Wanted::Best.choose(&devices).map(|info| info.index);
    let crowds = Wanted::Hardware.choose(&devices).map(|info| info.index);
    let wanted = Wanted::of(None);
    let named = (wanted != Wanted::Best).then(|| wanted.choose(&devices).map(|info| info.index));
    let hint = best.is_none().then(|| {
        "update the driver, or install a software one: Debian/Ubuntu: apt install mesa-vulkan-drivers; Fedora: dnf \
         install mesa-vulkan-drivers; Arch: pacman -S vulkan-swrast; or run scripts/setup and prefix the command \
         with scripts/gpu-env"
            .to_owned()
    });
    let rows = devices.into_iter().map(|info| Row {
        index: info.index,
        name: info.name,
        kind: info.kind.name(),
        api: info.api,
        driver: info.driver,
        tiler: info.is_tiler,
        indirect_draws: info.draws_indirectly,
        usable: info.unusable.is_none(),
        reason: info.unusable,
    });
    List { devices: rows.collect(), best, crowds, named, missing: None, hint, openxr: openxr() }
}

#[cfg(not(feature = "vulkan"))]
fn list() -> List {
    let missing = Some("this build has no Vulkan backend".to_owned());
    let hint = Some("build with the feature `vulkan` (it is on by default)".to_owned());
    List { devices: Vec::new(), best: None, crowds: None, named: None, missing, hint, openxr: openxr() }
}
