//! What lies beside a study file: consent texts and libraries of gaits, or what stands in for them.

use super::super::output::note;
use super::super::scene::library;
use super::super::usage;
use crate::Error;
use crate::emotion::Emotion;
use crate::statistics::paper::GAITS;
use crate::study::file::Part;
use crate::study::{BUILTIN, Materials, Study};
use clap::Args;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Name by which a study file means the program's own examples.
const EXAMPLES: &str = "practice";

/// Gaits in place of the study's own library.
#[derive(Debug, Args)]
pub(super) struct Gaits {
    /// Library of gaits to take in place of the one that the study names
    #[arg(long, value_name = "LIB.glb", conflicts_with = "gaits")]
    library: Option<PathBuf>,
    /// Number of gaits that stand in for the study's library [default of the built-in studies: 342, as in the paper]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    gaits: Option<u32>,
}

impl Gaits {
    /// A library in place of the study's own, if it is one.
    #[cfg(feature = "study")]
    pub(super) const fn of(library: Option<PathBuf>) -> Self {
        Self { library, gaits: None }
    }
}

/// What lies beside a study, and the emotion of each gait that has a label.
pub(super) struct Beside {
    pub(super) materials: Materials,
    pub(super) labels: BTreeMap<String, Emotion>,
}

impl Beside {
    /// Reads it. A library or text that is not there is left out: the check names it with its line.
    pub(super) fn of(study: &Study, gaits: &Gaits) -> Result<Self, Error> {
        let mut beside = Self { materials: texts(study)?, labels: BTreeMap::new() };
        for name in libraries(study) {
            let own = study.folder.as_ref().map(|folder| folder.join(&name)).filter(|path| path.exists());
            let stand_in = gaits.gaits.or_else(|| study.folder.is_none().then_some(GAITS));
            let names =
                match (gaits.library.as_ref().or(own.as_ref().filter(|_| gaits.gaits.is_none())), stand_in) {
                    (Some(path), _) => beside.read(path)?,
                    (None, Some(count)) => {
                        note(&format!("note: {count} gaits without a library stand in for {name}"));
                        (1..=count).map(|number| format!("gait {number}")).collect()
                    }
                    (None, None) => continue,
                };
            beside.materials = beside.materials.with_gaits(&name, names);
        }
        Ok(beside)
    }

    fn read(&mut self, path: &Path) -> Result<Vec<String>, Error> {
        let library = library(Some(path))?;
        let gaits = library.gaits();
        self.labels.extend(gaits.iter().filter_map(|gait| Some((gait.name.clone(), gait.label?))));
        Ok(gaits.iter().map(|gait| gait.name.clone()).collect())
    }
}

/// The study of a file, of a folder with `study.toml`, or a built-in one by its id.
pub(super) fn study(name: &str) -> Result<Study, Error> {
    let path = Path::new(name);
    if path.exists() {
        return Ok(Study::load(path)?);
    }
    if name.contains(['/', '\\', '.']) {
        return Err(usage(
            format!("{name}: there is no such file or folder"),
            "`gaitway study new` makes one",
        ));
    }
    Study::builtin(name).map_err(|error| usage(error.to_string(), "or name a study file or its folder"))
}

/// Libraries that the parts of a study show.
pub(super) fn libraries(study: &Study) -> Vec<String> {
    let shown =
        study.file.parts.values().filter_map(Part::trials).filter_map(|trials| trials.show.gaits.clone());
    let mut all: Vec<String> = shown.filter(|name| name != EXAMPLES).collect();
    all.sort();
    all.dedup();
    all
}

/// The consent texts of a study, by the names that its file gives them.
pub(super) fn texts(study: &Study) -> Result<Materials, Error> {
    let mut materials = Materials::default();
    for language in &study.file.study.languages {
        let name = study.file.consent.text.find(language, &[]);
        let text = match &study.folder {
            Some(folder) => {
                let path = folder.join(name);
                if !path.is_file() {
                    continue;
                }
                std::fs::read_to_string(&path).map_err(|source| crate::study::Error::Read { path, source })?
            }
            None => match BUILTIN.iter().find(|builtin| builtin.consent_name == name) {
                Some(builtin) => builtin.consent.to_owned(),
                None => continue,
            },
        };
        materials = materials.with_text(name, &text);
    }
    Ok(materials)
}
