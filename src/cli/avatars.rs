//! The bodies that a crowd has: generated ones, and files with their rig maps.

use super::failed;
use crate::Error;
use crate::avatar::{self, Avatar, RigMap, Sex};
use crate::scenario::Scenario;
use clap::Args;
use std::path::{Path, PathBuf};

/// How the joints of avatars are called.
#[derive(Debug, Clone, Default, Args)]
pub(super) struct RigArguments {
    /// Names of the joints of an avatar whose rig is not recognised, as the error prints them; may be repeated
    #[arg(long, value_name = "FILE.toml")]
    pub(super) rig_map: Vec<PathBuf>,
}

/// The avatars of a scenario; files are looked for beside the scenario's own, `base`.
pub(super) fn avatars_of(
    scenario: &Scenario,
    base: Option<&Path>,
    rigs: &RigArguments,
) -> Result<Vec<Avatar>, Error> {
    let beside = |name: &String| base.map_or_else(|| PathBuf::from(name), |base| base.join(name));
    let population = &scenario.population;
    let files = rigs.rig_map.iter().cloned().chain(population.rig_maps.iter().map(beside));
    let maps = files
        .map(|file| RigMap::read(&file).map(|map| (file, map)))
        .collect::<Result<Vec<_>, avatar::Error>>()?;
    let names: Vec<String> = population.avatars.iter().map(|name| stem(name)).collect();
    for (file, map) in &maps {
        if let Some(name) = map.avatar().filter(|name| !names.iter().any(|known| known == name)) {
            let hint = format!("its `avatar` must be one of {}, or left out", names.join(", "));
            return Err(failed(format!("rig map {}: there is no avatar {name:?}", file.display()), hint));
        }
    }
    population.avatars.iter().map(|name| character(name, &beside(name), &maps)).collect()
}

/// The name of a file without folder and ending.
fn stem(name: &str) -> String {
    Path::new(name).file_stem().map_or_else(|| name.to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// An avatar by name: a generated body, or a glTF or VRM file; of its maps the first that is for it alone, else the first
/// that is for all.
fn character(name: &str, path: &Path, maps: &[(PathBuf, RigMap)]) -> Result<Avatar, Error> {
    if let Some(sex) = Sex::ALL.into_iter().find(|sex| sex.name() == name) {
        return Ok(avatar::generated(sex));
    }
    let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
    if !matches!(ending.as_deref(), Some("glb" | "gltf" | "vrm")) {
        return Err(failed(
            format!("population.avatars: there is no avatar {name:?}"),
            "use \"female\", \"male\", or the path of a .glb, .gltf or .vrm file",
        ));
    }
    let own = stem(name);
    let of = |whom: Option<&str>| maps.iter().map(|(_, map)| map).find(|map| map.avatar() == whom);
    let map = of(Some(&own)).or_else(|| of(None)).cloned().unwrap_or_default();
    Ok(avatar::load_with_map(path, &map)?.avatar)
}
