//! A plan: every run of a sweep, a line each, below one line with what all have in common. The file needs no other: scenario
//! and values stand in it.
//!
//! ```text
//! {"gaitway_plan":1,"version":"0.1.0","scenario":"hall","text":"name = …","seconds":60.0,…,"vary":["condition"],"runs":12}
//! {"key":"6f0c…","seed":1,"values":["baseline"]}
//! ```

use super::file::{Axis, MAX_RUNS, Seeds, Sweep};
use super::key::{Key, Keys, of_file};
use super::{Error, SweepFile};
use crate::file;
use crate::scenario::{Scenario, Setting};
use crate::scene::SceneBuilder;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::io::{BufRead as _, BufReader, BufWriter, Write as _};
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Version of the format.
const FORMAT: u32 = 1;
/// Largest file beside a scenario, bytes.
const MAX_OUTSIDE: u64 = 1 << 30;
/// Longest line of a plan that is read, bytes: a scenario file, with its line ends and quotes escaped.
const MAX_LINE: u64 = 256 << 20;
/// Values that are tried on the scenario, at most: each takes as long as reading it.
const TRIED: usize = 1000;

/// What all runs of a plan have in common.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Version of the format: marks the file as a plan.
    pub gaitway_plan: u32,
    /// Version of the program that made it, and that does its runs.
    pub version: String,
    /// Name of the built-in scene or of the file.
    pub scenario: String,
    /// Text of the scenario file.
    pub text: String,
    /// Where files beside the scenario's are; null where it names none.
    pub folder: Option<PathBuf>,
    /// Files that the scenario names, with the hashes of their content.
    pub files: Vec<OutsideFile>,
    /// As in the sweep file.
    pub seconds: f64,
    /// As in the sweep file.
    pub fps: f64,
    /// As in the sweep file.
    pub until_empty: bool,
    /// As in the sweep file.
    pub agents: bool,
    /// As in the sweep file.
    pub trajectories: bool,
    /// Settings of all runs, `KEY=VALUE`.
    pub set: Vec<String>,
    /// Keys that differ between runs.
    pub vary: Vec<String>,
    /// How many runs there are.
    pub runs: usize,
}

/// A file that a scenario names: an avatar, a rig map, a model, a walkable area.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct OutsideFile {
    /// As the scenario has it.
    pub name: String,
    /// Of its content.
    pub hash: String,
}

/// A line of a plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedRun {
    /// Name of the run.
    pub key: String,
    /// Seed of every random draw.
    pub seed: u64,
    /// Values of the keys that differ, in their order; null leaves one as it is.
    pub values: Vec<Option<Value>>,
}

/// All runs of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// What all have in common.
    pub header: Header,
    /// The runs, in order.
    pub runs: Vec<PlannedRun>,
    /// Combinations that came up twice, and stand in it once.
    pub repeated: usize,
}

impl Header {
    /// The settings of a run.
    pub fn settings(&self, run: &PlannedRun) -> Vec<String> {
        let varied = self.vary.iter().zip(&run.values);
        let varied = varied.filter_map(|(key, value)| value.as_ref().map(|value| setting(key, value)));
        self.set.iter().cloned().chain(varied).collect()
    }

    /// The scene of settings, not yet built.
    ///
    /// # Errors
    /// As [`crate::Scene::load`].
    pub fn scene(&self, settings: &[String]) -> Result<SceneBuilder, crate::Error> {
        let parse = |text: &String| {
            text.parse::<Setting>().map_err(|error| crate::Error::Usage {
                message: format!("{text}: {error}"),
                hint: "see the keys of scenarios".to_owned(),
            })
        };
        let settings = settings.iter().map(parse).collect::<Result<Vec<_>, _>>()?;
        SceneBuilder::parse(&self.text, &self.scenario, &settings, self.folder.as_deref())
    }

    /// Refuses files beside the scenario's that are not those of the plan.
    ///
    /// # Errors
    /// [`Error::Read`] or [`Error::Plan`] with the file.
    pub fn check_files(&self) -> Result<(), Error> {
        for OutsideFile { name, hash } in &self.files {
            let path = self.folder.as_ref().map_or_else(|| PathBuf::from(name), |folder| folder.join(name));
            if hash_of(&path)? != *hash {
                let message = "it has changed since the plan was made".to_owned();
                return Err(Error::Plan { path, message, hint: "plan the sweep again".to_owned() });
            }
        }
        Ok(())
    }
}

fn hash_of(path: &Path) -> Result<String, Error> {
    let bytes =
        file::read(path, MAX_OUTSIDE).map_err(|source| Error::Read { path: path.to_owned(), source })?;
    Ok(of_file(&bytes).to_string())
}

/// `KEY=VALUE`.
fn setting(key: &str, value: &Value) -> String {
    format!("{key}={value}")
}

impl Plan {
    /// Plans the sweep of a file. Every value is tried on the scenario by itself, the first thousand of them.
    ///
    /// # Errors
    /// What is wrong with the file, its scenario or a value, with its place.
    pub fn of_file(path: &Path) -> Result<Self, crate::Error> {
        let sweep = Sweep::load(path)?;
        Self::of(&sweep, path.parent())
    }

    fn of(sweep: &Sweep, folder: Option<&Path>) -> Result<Self, crate::Error> {
        let SweepFile { scenario, seconds, fps, until_empty, agents, trajectories, .. } = sweep.file.clone();
        let (text, folder) = text_of(&scenario, folder)?;
        let set = sweep.fixed()?.iter().map(|(key, value)| setting(key, value)).collect();
        let axes = sweep.axes()?;
        let mut header = Header {
            gaitway_plan: FORMAT,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scenario,
            text,
            folder,
            files: Vec::new(),
            seconds,
            fps,
            until_empty,
            agents,
            trajectories,
            set,
            vary: axes.iter().flat_map(|axis| axis.keys.clone()).collect(),
            runs: 0,
        };
        let seed = tried(sweep, &axes, &mut header)?;
        let seeds = match &sweep.file.seeds {
            None => vec![seed],
            Some(Seeds::Count(count)) => (1..=u64::from(*count)).collect(),
            Some(Seeds::List(list)) => list.clone(),
        };
        let (runs, repeated) = combined(sweep, &axes, &seeds, &header)?;
        header.runs = runs.len();
        Ok(Self { header, runs, repeated })
    }

    /// Writes the plan.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let wrong = |source| Error::Write { path: path.to_owned(), source };
        let mut file = BufWriter::new(file::Partial::create(path).map_err(wrong)?);
        let mut line = |value: serde_json::Result<Vec<u8>>| -> std::io::Result<()> {
            let mut line = value?;
            line.push(b'\n');
            file.write_all(&line)
        };
        line(serde_json::to_vec(&self.header)).map_err(wrong)?;
        for run in &self.runs {
            line(serde_json::to_vec(run)).map_err(wrong)?;
        }
        file.into_inner()
            .map_err(std::io::IntoInnerError::into_error)
            .and_then(file::Partial::finish)
            .map_err(wrong)
    }

    /// Reads what a plan's runs have in common, and those whose numbers are `wanted`.
    ///
    /// # Errors
    /// [`Error::Read`], or [`Error::Plan`] for what is no plan, is of another version, or was changed by hand.
    pub fn read(
        path: &Path,
        wanted: impl Fn(usize) -> bool,
    ) -> Result<(Header, Vec<(usize, PlannedRun)>), Error> {
        let read = |source| Error::Read { path: path.to_owned(), source };
        let wrong = |message: String, hint: &str| Error::Plan {
            path: path.to_owned(),
            message,
            hint: hint.to_owned(),
        };
        let again = "plan the sweep again: gaitway plan sweep.toml --out plan.jsonl";
        file::regular(path).map_err(read)?;
        let mut lines = BufReader::new(std::fs::File::open(path).map_err(read)?);
        let mut line = Vec::new();
        let mut next = |line: &mut Vec<u8>| -> Result<bool, Error> {
            line.clear();
            let mut bounded = std::io::Read::take(&mut lines, MAX_LINE);
            Ok(bounded.read_until(b'\n', line).map_err(read)? > 0)
        };
        next(&mut line)?;
        let header: Header = serde_json::from_slice(&line)
            .map_err(|error| wrong(format!("its first line is not that of a plan: {error}"), again))?;
        if header.gaitway_plan != FORMAT || header.version != env!("CARGO_PKG_VERSION") {
            let found = format!(
                "it was made by version {}, and this is {}",
                header.version,
                env!("CARGO_PKG_VERSION")
            );
            return Err(wrong(found, "use that version, or plan the sweep again: its runs get other keys"));
        }
        let keys = Keys::of(&header);
        let (mut runs, mut number) = (Vec::new(), 0);
        while next(&mut line)? {
            if wanted(number) {
                let faulty = |message: String| wrong(format!("line {}: {message}", number + 2), again);
                let run: PlannedRun =
                    serde_json::from_slice(&line).map_err(|error| faulty(error.to_string()))?;
                let settings = header.settings(&run);
                let key = keys.key(settings.iter().map(String::as_str), run.seed).to_string();
                if run.values.len() != header.vary.len() || key != run.key {
                    return Err(faulty(format!(
                        "the run's key is {key}, not {:?}: a line was changed",
                        run.key
                    )));
                }
                runs.push((number, run));
            }
            number += 1;
        }
        if number != header.runs {
            return Err(wrong(format!("{number} runs, and the first line says {}", header.runs), again));
        }
        Ok((header, runs))
    }
}

/// The text of a scenario, and the folder that files beside it are looked for in.
fn text_of(name: &str, beside: Option<&Path>) -> Result<(String, Option<PathBuf>), crate::Error> {
    let path = Path::new(name);
    let is_file = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    if !is_file && !name.contains(std::path::MAIN_SEPARATOR) {
        return Ok((Scenario::builtin_text(name)?.to_owned(), None));
    }
    let path = beside.map_or_else(|| path.to_owned(), |folder| folder.join(path));
    let read = |source| Error::Read { path: path.clone(), source };
    let text = file::read_text(&path, MAX_OUTSIDE).map_err(read)?;
    let whole = std::path::absolute(&path).map_err(read)?;
    Ok((text, whole.parent().map(Path::to_owned)))
}

/// Tries every value by itself, and notes the files that scenarios name. Returns the scenario's own seed.
fn tried(sweep: &Sweep, axes: &[Axis], header: &mut Header) -> Result<u64, crate::Error> {
    let mut names = Vec::new();
    let base = header.scene(&header.set)?;
    let seed = base.scenario().seed;
    names_of(header, &header.set, base.scenario(), &mut names);
    let alternatives = axes.iter().flat_map(|axis| axis.values.iter().map(move |values| (axis, values)));
    for (axis, values) in alternatives.take(TRIED) {
        let own: Vec<String> = axis
            .keys
            .iter()
            .zip(values)
            .filter_map(|(key, value)| value.as_ref().map(|value| setting(key, value)))
            .collect();
        let settings: Vec<String> = header.set.iter().chain(&own).cloned().collect();
        let scene = header.scene(&settings).map_err(|error| Error::Setting {
            place: sweep.origin.clone(),
            setting: own.join(", "),
            message: error.to_string(),
        })?;
        names_of(header, &settings, scene.scenario(), &mut names);
    }
    names.sort_unstable();
    names.dedup();
    for name in names {
        let path = header.folder.as_ref().map_or_else(|| PathBuf::from(&name), |folder| folder.join(&name));
        header.files.push(OutsideFile { hash: hash_of(&path)?, name });
    }
    if header.files.is_empty() {
        header.folder = None;
    }
    Ok(seed)
}

/// Notes the files that a scenario names: what it takes from them is part of what a run depends on.
fn names_of(header: &Header, settings: &[String], scenario: &Scenario, names: &mut Vec<String>) {
    let population = &scenario.population;
    let is_file = |name: &&String| Path::new(name).extension().is_some();
    names.extend(population.avatars.iter().filter(is_file).cloned());
    names.extend(population.rig_maps.iter().cloned());
    names.extend(scenario.outsiders.iter().filter_map(|outsider| outsider.model.clone()));
    // the area is taken over as the file is read, so the text alone names it
    let text: Option<Table> = toml::from_str(&header.text).ok();
    let area = text.as_ref().and_then(|table| table.get("walkable_file")).and_then(Value::as_str);
    names.extend(area.filter(|name| !name.is_empty()).map(str::to_owned));
    let set = settings.iter().filter_map(|setting| setting.strip_prefix("walkable_file="));
    names.extend(set.map(|name| name.trim_matches(['"', '\'']).to_owned()).filter(|name| !name.is_empty()));
}

/// All combinations, each once, the seeds within them; and how many came up again.
fn combined(
    sweep: &Sweep,
    axes: &[Axis],
    seeds: &[u64],
    header: &Header,
) -> Result<(Vec<PlannedRun>, usize), Error> {
    let sizes = axes.iter().map(|axis| axis.values.len()).chain([seeds.len()]);
    let count = sizes.clone().try_fold(1_usize, usize::checked_mul).filter(|count| *count <= MAX_RUNS);
    let Some(count) = count else {
        let sizes: Vec<String> = sizes.map(|size| size.to_string()).collect();
        let allowed = format!("{MAX_RUNS} runs at most");
        return Err(sweep.wrong(
            "vary",
            format!("{} combinations", sizes.join(" x ")),
            &allowed,
            "make several sweeps",
        ));
    };
    let keys = Keys::of(header);
    let mut known: HashSet<Key> = HashSet::with_capacity(count);
    let mut runs = Vec::with_capacity(count);
    for number in 0..count / seeds.len() {
        let mut rest = number;
        let mut chosen: Vec<&[Option<Value>]> = Vec::with_capacity(axes.len());
        for axis in axes.iter().rev() {
            chosen.push(&axis.values[rest % axis.values.len()]);
            rest /= axis.values.len();
        }
        let values: Vec<Option<Value>> = chosen.into_iter().rev().flatten().cloned().collect();
        let mut run = PlannedRun { key: String::new(), seed: 0, values };
        let settings = header.settings(&run);
        for seed in seeds {
            let key = keys.key(settings.iter().map(String::as_str), *seed);
            if known.insert(key) {
                (run.key, run.seed) = (key.to_string(), *seed);
                runs.push(run.clone());
            }
        }
    }
    let repeated = count - runs.len();
    Ok((runs, repeated))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(text: &str) -> Result<Plan, crate::Error> {
        Plan::of(&Sweep::parse(text.to_owned(), "sweep.toml".to_owned())?, None)
    }

    #[test]
    fn lists_are_combined_rows_and_zips_go_together_and_seeds_vary_fastest() {
        let found = plan(
            "scenario = \"garden\"\nseeds = 2\n[set]\nnavigation.patience = 1.0\n[vary]\n\"population.agents\" = [4, 8]\n\
             condition = [\"baseline\", \"eva-g\"]\n[[zip]]\npopulation.emotions.happy = [1, 0]\npopulation.emotions.sad = [0, 1]\n\
             [[rows]]\nnavigation.model = \"rvo\"\n[[rows]]\n",
        )
        .unwrap();
        assert_eq!(found.header.vary[0], "navigation.model");
        assert_eq!(found.header.vary.len(), 5);
        assert_eq!((found.runs.len(), found.repeated), (2 * 2 * 2 * 2 * 2, 0));
        let settings = found.header.settings(&found.runs[0]).join(" ");
        assert_eq!(
            settings,
            "navigation.patience=1.0 navigation.model=\"rvo\" population.emotions.happy=1 population.emotions.sad=0 \
             condition=\"baseline\" population.agents=4"
        );
        assert_eq!((found.runs[0].seed, found.runs[1].seed), (1, 2));
        assert!(!found.header.settings(&found.runs[31]).iter().any(|one| one.contains("rvo")));
        let again = plan("scenario = \"garden\"\nseeds = [3, 3, 4]\n").unwrap();
        assert_eq!((again.runs.len(), again.repeated), (2, 1));
    }

    #[test]
    fn the_same_run_has_the_same_key_in_another_sweep() {
        let one = plan("scenario = \"garden\"\nseeds = 3\n[vary]\npopulation.agents = [4, 8]\n").unwrap();
        let two = plan("scenario = \"garden\"\nseeds = [3]\n[set]\npopulation.agents = 8\n").unwrap();
        assert_eq!(one.runs[5].key, two.runs[0].key);
        assert!(one.runs[..5].iter().all(|run| run.key != two.runs[0].key));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place_and_the_nearest_word() {
        for (text, wants) in [
            ("scenario = \"garden\"\nsecond = 3\n", ["sweep.toml:2", "did you mean `seconds`"]),
            ("scenario = \"gardn\"\n", ["gardn", "garden"]),
            ("scenario = \"garden\"\nseconds = -1\n", ["sweep.toml:2: seconds = -1", "0 to 86400"]),
            ("scenario = \"garden\"\nseeds = 0\n", ["sweep.toml:2: seeds", "from 1 up"]),
            ("scenario = \"garden\"\n[vary]\nnavigation.patience = 1.0\n", ["sweep.toml:2: vary", "lists"]),
            ("scenario = \"garden\"\n[vary]\nseed = [1, 2]\n", ["sweep.toml:2: vary", "seed"]),
            ("scenario = \"garden\"\n[set]\nseed = 1\n", ["sweep.toml:2: set", "seed"]),
            (
                "scenario = \"garden\"\n[vary]\nnavigation.patienc = [1.0]\n",
                ["navigation.patienc=1.0", "did you mean"],
            ),
            (
                "scenario = \"garden\"\n[vary]\npopulation.agents = [4, -3]\n",
                ["population.agents=-3", "sweep.toml"],
            ),
            ("scenario = \"garden\"\n[[zip]]\na = [1, 2]\nb = [1]\n", ["sweep.toml:2: zip[0]", "2 values"]),
            ("scenario = \"garden\"\n[vary]\nx = [1]\n[[rows]]\nx = 2\n", ["vary", "once"]),
        ] {
            let error = plan(text).unwrap_err().to_string();
            assert!(wants.iter().all(|want| error.contains(want)), "{text}: {error}");
        }
        let many =
            format!("scenario = \"garden\"\nseeds = {}\n[vary]\npopulation.agents = [4, 8]\n", MAX_RUNS);
        assert!(plan(&many).unwrap_err().to_string().contains("2 x 10000000"));
    }

    #[test]
    fn a_plan_is_read_as_it_was_written_and_one_changed_by_hand_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.jsonl");
        let made = plan("scenario = \"garden\"\nseeds = 3\n[vary]\npopulation.agents = [4, 8]\n").unwrap();
        made.write(&path).unwrap();
        let (header, runs) = Plan::read(&path, |number| number != 2).unwrap();
        assert_eq!(header, made.header);
        let numbers: Vec<usize> = runs.iter().map(|(number, _)| *number).collect();
        assert_eq!(numbers, [0, 1, 3, 4, 5]);
        assert!(runs.iter().all(|(number, run)| *run == made.runs[*number]));
        let text = std::fs::read_to_string(&path).unwrap();
        for (from, to, want) in [
            ("\"seed\":3", "\"seed\":7", "line 4"),
            ("[8]", "[9]", "a line was changed"),
            ("\"version\":\"", "\"version\":\"9", "made by version 9"),
            ("\"runs\":6", "\"runs\":7", "6 runs, and the first line says 7"),
            ("gaitway_plan", "plan", "not that of a plan"),
        ] {
            std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
            let error = Plan::read(&path, |_| true).unwrap_err().to_string();
            assert!(error.contains(want), "{to}: {error}");
        }
    }
}
