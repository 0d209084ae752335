//! The program on a device that is smaller, poorer or worse than the one that is there: [`on`]. What can be emulated is
//! listed at [`layer::profile::Profile`].
#![allow(dead_code, reason = "shared by test programs, of which none needs all of it")]

#[path = "layer.rs"]
pub(crate) mod layer;
mod tests;

use std::ffi::OsString;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// What a phone has at least, and what some phones lack.
pub(crate) const PHONE: &str = "android-15,no-timestamps,no-depth-reads";
/// The least that Vulkan demands, without multiview.
pub(crate) const LEAST: &str = "vulkan-minimum,no-multiview";
/// A discrete card's memory.
pub(crate) const CARD: &str = "discrete";
/// A headset's own GPU: a tiler that draws nothing by indexed indirect draws.
pub(crate) const HEADSET: &str = "android-15,adreno";
/// All kinds of devices on which everything must work as it does elsewhere.
pub(crate) const KINDS: [&str; 4] = [PHONE, LEAST, CARD, HEADSET];

const NAME: &str = "VK_LAYER_GAITWAY_wrong_device";
const KHRONOS: &str = "VK_LAYER_KHRONOS_validation";

/// Lets a program have such a device. The validation layer, where `GAITWAY_VALIDATION` wants it, sees what is emulated.
pub(crate) fn on<'a>(command: &'a mut Command, kind: &str) -> &'a mut Command {
    let is_validated = std::env::var("GAITWAY_VALIDATION").is_ok_and(|level| !matches!(&*level, "" | "off"));
    if is_validated { on_validated(command, kind) } else { through(command, kind, NAME) }
}

/// The same of a program that has the validation layer in any case.
pub(crate) fn on_validated<'a>(command: &'a mut Command, kind: &str) -> &'a mut Command {
    through(command, kind, &format!("{KHRONOS}:{NAME}"))
}

/// The layers in their order from the program to the driver.
fn through<'a>(command: &'a mut Command, kind: &str, layers: &str) -> &'a mut Command {
    let mut path = OsString::from(layer());
    // the variable replaces the system's own folders
    let paths = match std::env::var_os("VK_LAYER_PATH") {
        Some(others) => {
            path.push(":");
            path.push(others);
            "VK_LAYER_PATH"
        }
        None => "VK_ADD_LAYER_PATH",
    };
    command.env(paths, path).env("VK_INSTANCE_LAYERS", layers).env(layer::profile::VARIABLE, kind)
}

/// The folder of the layer, compiled when it is first wanted and kept as long as its source stays the same.
fn layer() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let mut hasher = DefaultHasher::new();
        [
            include_str!("layer.rs"),
            include_str!("calls.rs"),
            include_str!("pipelines.rs"),
            include_str!("profile.rs"),
            include_str!("vulkan.rs"),
        ]
        .hash(&mut hasher);
        let parent = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let folder = parent.join(format!("wrong-device-{:016x}", hasher.finish()));
        if !folder.exists() {
            // another test program may be compiling it, too
            let own = parent.join(format!("wrong-device-{}", std::process::id()));
            compile(&own, &folder);
            if std::fs::rename(&own, &folder).is_err() {
                std::fs::remove_dir_all(&own).unwrap();
            }
        }
        folder
    })
}

/// Compiles the layer into a folder that will have another name.
fn compile(folder: &Path, place: &Path) {
    const LIBRARY: &str = "libgaitway_wrong_device.so";
    std::fs::create_dir_all(folder).unwrap();
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let built = Command::new(rustc)
        .args(["--edition", "2024", "--crate-type", "cdylib", "--crate-name", "gaitway_wrong_device", "-o"])
        .arg(folder.join(LIBRARY))
        // the loader unloads layers with each instance, and the count of submissions with them
        .args(["-C", "link-arg=-Wl,-z,nodelete"])
        .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/device/layer.rs"))
        .status();
    assert!(built.unwrap().success(), "the layer does not compile");
    let manifest = serde_json::json!({
        "file_format_version": "1.2.0",
        "layer": {
            "name": NAME,
            "type": "GLOBAL",
            "library_path": place.join(LIBRARY),
            "api_version": "1.4.0",
            "implementation_version": "1",
            "description": "makes a device smaller, poorer or worse"
        }
    });
    std::fs::write(folder.join("wrong-device.json"), manifest.to_string()).unwrap();
}
