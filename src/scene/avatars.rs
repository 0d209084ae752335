//! The bodies that a crowd has: generated ones, and files with their rig maps.

use super::Error;
use crate::avatar::{self, Avatar, RigMap, Sex};
use crate::scenario::{Clothes, Scenario};
use std::path::{Path, PathBuf};

/// The avatars of a scenario; its files are looked for in `folder`. `rig_maps` come before the scenario's own.
pub(super) fn avatars_of(
    scenario: &Scenario,
    folder: Option<&Path>,
    rig_maps: &[PathBuf],
) -> Result<Vec<Avatar>, crate::Error> {
    let beside = |name: &String| folder.map_or_else(|| PathBuf::from(name), |folder| folder.join(name));
    let population = &scenario.population;
    let files = rig_maps.iter().cloned().chain(population.rig_maps.iter().map(beside));
    let maps = files
        .map(|file| RigMap::read(&file).map(|map| (file, map)))
        .collect::<Result<Vec<_>, avatar::Error>>()?;
    let names: Vec<String> = population.avatars.iter().map(|name| stem(name)).collect();
    for (file, map) in &maps {
        if let Some(name) = map.avatar().filter(|name| !names.iter().any(|known| known == name)) {
            let hint = format!("its `avatar` must be one of {}, or left out", names.join(", "));
            return Err(Error::RigMap { file: file.clone(), name: name.to_owned(), hint }.into());
        }
    }
    let dressed = |avatar: Avatar| match population.clothes {
        Clothes::Varied => avatar,
        Clothes::Plain => Avatar { wardrobe: None, ..avatar },
    };
    population.avatars.iter().map(|name| character(name, &beside(name), &maps).map(dressed)).collect()
}

/// The name of a file without folder and ending.
fn stem(name: &str) -> String {
    Path::new(name).file_stem().map_or_else(|| name.to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// An avatar by name: a generated body, or a glTF or VRM file. Of the maps, one for this avatar alone comes before one for
/// all.
fn character(name: &str, path: &Path, maps: &[(PathBuf, RigMap)]) -> Result<Avatar, crate::Error> {
    if let Some(sex) = Sex::ALL.into_iter().find(|sex| sex.name() == name) {
        return Ok(avatar::generated(sex));
    }
    let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
    if !matches!(ending.as_deref(), Some("glb" | "gltf" | "vrm")) {
        return Err(Error::Avatar { name: name.to_owned() }.into());
    }
    let own = stem(name);
    let of = |name: Option<&str>| maps.iter().map(|(_, map)| map).find(|map| map.avatar() == name);
    let map = of(Some(&own)).or_else(|| of(None)).cloned().unwrap_or_default();
    Ok(avatar::load_with_map(path, &map)?.avatar)
}
