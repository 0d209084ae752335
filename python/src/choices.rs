//! What can be chosen of a simulation, by Python's names.

use crate::crowd::Crowd;
use crate::error::{Fault, Result};
use crate::recorder::Recorder;
use gaitway::GaitLibrary;
use gaitway::scenario::{Condition, Scenario, Setting};
use gaitway::scene::{CameraChoice, Scene, SceneBuilder};
use gaitway::sim::Backend;
use pyo3::prelude::*;

/// The arguments of `gaitway.Simulation`.
#[derive(Debug)]
pub(crate) struct Choices<'a> {
    /// Name, path or text.
    pub(crate) scene: &'a str,
    pub(crate) is_text: bool,
    /// `key=value`, each.
    pub(crate) settings: Vec<String>,
    pub(crate) agents: Option<u32>,
    pub(crate) seed: Option<u64>,
    pub(crate) condition: Option<&'a str>,
    pub(crate) library: Option<GaitLibrary>,
    pub(crate) backend: &'a str,
    pub(crate) device: Option<&'a str>,
    /// Seconds between two recorded frames.
    pub(crate) record: Option<f64>,
}

impl Choices<'_> {
    /// The crowd that was chosen, not started yet.
    pub(crate) fn crowd(self) -> Result<Crowd> {
        let mut builder = builder(self.scene, self.is_text, &self.settings)?.device(self.device);
        builder = builder.backend(named("backend", self.backend, &BACKENDS)?);
        if let Some(agents) = self.agents {
            builder = builder.agents(agents);
        }
        if let Some(seed) = self.seed {
            builder = builder.seed(seed);
        }
        if let Some(condition) = self.condition {
            builder = builder.condition(named("condition", condition, &CONDITIONS)?);
        }
        if let Some(library) = self.library {
            builder = builder.library(library);
        }
        let mut crowd = Crowd::new(builder.build()?, None);
        if let Some(seconds) = self.record {
            crowd.recorder = Some(Recorder::new(crowd.steps_of("record", seconds)?));
        }
        Ok(crowd)
    }
}

const BACKENDS: [(&str, Backend); 4] = [
    ("auto", Backend::Auto),
    ("vulkan", Backend::Vulkan),
    ("cpu", Backend::Cpu),
    ("reference", Backend::Reference),
];
const CONDITIONS: [(&str, Condition); 3] =
    [("baseline", Condition::Baseline), ("eva-o", Condition::EvaO), ("eva-g", Condition::EvaG)];

/// A choice by its name.
fn named<T: Copy>(what: &str, found: &str, known: &[(&str, T)]) -> Result<T> {
    let all = || known.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
    let chosen = known.iter().find(|(name, _)| *name == found);
    chosen.map(|(_, choice)| *choice).ok_or_else(|| {
        Fault::value(
            format!("{what} = {found:?}: must be one of {}", all()),
            format!("use {what}=\"{}\"", known[0].0),
        )
    })
}

/// A camera by its name.
pub(crate) fn camera_of(name: &str) -> Result<CameraChoice> {
    name.parse().map_err(|error| {
        Fault::value(format!("camera = {name:?}: {error}"), "\"orbit\" shows the place at a glance")
    })
}

/// A scene by name, from a file or from the text of one.
fn builder(scene: &str, is_text: bool, settings: &[String]) -> Result<SceneBuilder> {
    let parse = |text: &String| {
        let wrong = |error| Fault::value(format!("set {text}: {error}"), "keys are those of a scenario file");
        text.parse::<Setting>().map_err(wrong)
    };
    let settings = settings.iter().map(parse).collect::<Result<Vec<_>>>()?;
    if is_text {
        return Ok(Scene::of(Scenario::parse_with(scene, "scene text", &settings)?));
    }
    Ok(SceneBuilder::load(scene, &settings)?)
}

/// Names of the built-in scenes.
#[pyfunction]
pub(crate) fn scenes() -> [&'static str; 4] {
    Scenario::builtin_names()
}

/// The JSON Schema of a scenario file, as text.
#[pyfunction]
pub(crate) fn scenario_schema() -> String {
    gaitway::scenario::json_schema().to_string()
}
