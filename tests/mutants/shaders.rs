//! The errors of the shaders: which are tried, and what becomes of them.

use crate::check::{kernels_with, source};
use crate::plant::{Mutant, plant};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, VecDeque};
use std::hash::Hasher;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// A process that has said nothing for so long does not end.
const PATIENCE: Duration = Duration::from_secs(90);

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// What became of an error.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Fate {
    /// The compiler refuses it, or makes the same code of it: it is none.
    None,
    /// A case notices it; the coarser one of the same place only, if so.
    Caught { coarse: bool },
    /// Nothing does.
    Survived,
}

/// A shader file and the errors tried in it.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Planted {
    /// `integrate`, `shared/exact`.
    pub(crate) name: String,
    /// Errors that could be planted.
    pub(crate) possible: usize,
    /// Those that were, by their names.
    pub(crate) fates: BTreeMap<String, Fate>,
}

/// Plants at most `most` errors in every file whose name holds one of `only` (none: every file), and tries them in `workers` processes at a time.
///
/// Those that `always` names are among them.
pub(crate) fn run(
    only: &[&str],
    most: usize,
    workers: usize,
    always: &[String],
) -> Result<Vec<Planted>, Failure> {
    let files = files()?;
    let is_meant = |file: &PathBuf| {
        let name = file.display().to_string();
        only.is_empty() || only.iter().any(|part| name.contains(part))
    };
    let queue: Mutex<VecDeque<PathBuf>> = Mutex::new(files.into_iter().filter(is_meant).collect());
    let found = Mutex::new(Vec::new());
    let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).pop_front();
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..workers)
            .map(|_| {
                scope.spawn(|| -> Result<(), Failure> {
                    while let Some(file) = next() {
                        let planted = try_file(&file, most, always)?;
                        print!("{}", summary(&planted));
                        found.lock().unwrap_or_else(PoisonError::into_inner).push(planted);
                    }
                    Ok(())
                })
            })
            .collect();
        threads
            .into_iter()
            .try_for_each(|thread| thread.join().unwrap_or_else(|_| Err("a worker failed".into())))
    })?;
    let mut found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    found.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(found)
}

fn summary(planted: &Planted) -> String {
    let count = |is: &dyn Fn(&Fate) -> bool| planted.fates.values().filter(|fate| is(fate)).count();
    let caught = count(&|fate| matches!(fate, Fate::Caught { .. }));
    let survived = count(&|fate| *fate == Fate::Survived);
    let head =
        format!("{}: {} possible, {caught} caught, {survived} survived\n", planted.name, planted.possible);
    let alive = planted.fates.iter().filter(|(_, fate)| **fate == Fate::Survived);
    alive.fold(head, |text, (id, _)| format!("{text}  {id}\n"))
}

/// The kernels and what they share, as paths in `shaders/`; what only pictures use is not among them.
fn files() -> Result<Vec<PathBuf>, Failure> {
    let folder = Path::new("shaders");
    let mut files = Vec::new();
    for part in ["", "shared"] {
        for entry in std::fs::read_dir(folder.join(part))? {
            let path = Path::new(part).join(entry?.file_name());
            let is_used = path.extension().is_some_and(|end| end == "wgsl")
                && !kernels_with(folder, &path).map_err(|error| error.to_string())?.is_empty();
            files.extend(is_used.then_some(path));
        }
    }
    files.sort();
    Ok(files)
}

/// Errors of a file, in an order that other lines do not change: those that must be tried first.
fn mutants(file: &Path, always: &[String]) -> Result<Vec<Mutant>, Failure> {
    let folder = Path::new("shaders");
    let kernels = kernels_with(folder, file).map_err(|error| error.to_string())?;
    let kernel = *kernels.last().ok_or("no kernel has it")?;
    let source = source(folder, kernel)?;
    let start = source.start_of(&folder.join(file)).ok_or("not a part of its kernel")?;
    let floats = crate::types::floats(source.text())?;
    let is_float = |at: usize| floats.iter().any(|range| range.contains(&(start + at)));
    let name = file.with_extension("").display().to_string();
    let text = std::fs::read_to_string(folder.join(file))?;
    let mut found = plant(&name, &text, &is_float);
    found.sort_by_cached_key(|mutant| {
        let mut hash = Fnv(0xcbf2_9ce4_8422_2325);
        hash.write(mutant.id.as_bytes());
        (!always.contains(&mutant.id), hash.finish())
    });
    Ok(found)
}

struct Fnv(u64);

impl Hasher for Fnv {
    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn finish(&self) -> u64 {
        self.0 ^ self.0 >> 29
    }
}

fn try_file(file: &Path, most: usize, always: &[String]) -> Result<Planted, Failure> {
    let mutants = mutants(file, always)?;
    let possible = mutants.len();
    let (mut fates, mut tried) = (BTreeMap::new(), 0);
    let mut waiting = mutants.into_iter();
    // those that are no errors make room for others
    while tried < most {
        let some: Vec<Mutant> = waiting.by_ref().take(most - tried).collect();
        if some.is_empty() {
            break;
        }
        let found = try_some(file, &some)?;
        tried += found.iter().filter(|fate| **fate != Fate::None).count();
        fates.extend(some.into_iter().map(|mutant| mutant.id).zip(found));
    }
    fates.retain(|_, fate| *fate != Fate::None);
    Ok(Planted { name: file.with_extension("").display().to_string(), possible, fates })
}

/// Tries errors, then the coarser ones in the places where nothing was noticed.
fn try_some(file: &Path, mutants: &[Mutant]) -> Result<Vec<Fate>, Failure> {
    let mut fates = vec![Fate::None; mutants.len()];
    for round in 0..2 {
        let is_open = |fate: &Fate| round == 0 || *fate == Fate::Survived || *fate == Fate::None;
        let job: Vec<(usize, String)> = mutants
            .iter()
            .enumerate()
            .filter(|(number, _)| is_open(&fates[*number]))
            .filter_map(|(number, mutant)| Some((number, mutant.texts.get(round)?.clone())))
            .collect();
        for (number, fate) in Worker::new(file)?.work(job)? {
            fates[number] = match (fate, round) {
                (Fate::Caught { .. }, 1) => Fate::Caught { coarse: true },
                // the coarse error is none, the fine one was not noticed
                (Fate::None, 1) => fates[number].clone(),
                (fate, _) => fate,
            };
        }
    }
    Ok(fates)
}

/// A program, started through the one that `GAITWAY_RUNNER` names: as `scripts/gpu-env` wants it.
pub(crate) fn on_driver(program: &Path) -> Command {
    match std::env::var_os("GAITWAY_RUNNER") {
        Some(runner) => {
            let mut command = Command::new(runner);
            command.arg(program);
            command
        }
        None => Command::new(program),
    }
}

/// Processes that try errors of a file, one after the other.
struct Worker {
    file: PathBuf,
    folder: tempfile::TempDir,
}

impl Worker {
    fn new(file: &Path) -> Result<Self, Failure> {
        Ok(Self { file: file.to_path_buf(), folder: tempfile::tempdir()? })
    }

    fn start(&self, job: &[(usize, String)]) -> Result<Child, Failure> {
        let shaders = self.folder.path().join("shaders");
        for part in ["", "shared"] {
            std::fs::create_dir_all(shaders.join(part))?;
            for entry in std::fs::read_dir(Path::new("shaders").join(part))? {
                let entry = entry?;
                if entry.file_type()?.is_file() {
                    std::fs::copy(entry.path(), shaders.join(part).join(entry.file_name()))?;
                }
            }
        }
        let list = self.folder.path().join("job.json");
        std::fs::write(&list, serde_json::to_string(job)?)?;
        // not current_exe: that is the loader where this was started through it
        let own = std::env::args_os().next().map(PathBuf::from).ok_or("started without a name")?;
        let mut command = on_driver(&own);
        command.arg("check").args([&shaders, &self.file, &list]);
        command.env("GAITWAY_SHADERS", &shaders);
        // one of these processes for each core, and no folder full of wrong shaders
        command.envs([
            ("RAYON_NUM_THREADS", "1"),
            ("LP_NUM_THREADS", "1"),
            ("MESA_SHADER_CACHE_DISABLE", "true"),
        ]);
        Ok(command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn()?)
    }

    fn work(&self, mut job: Vec<(usize, String)>) -> Result<Vec<(usize, Fate)>, Failure> {
        let mut fates = Vec::new();
        while !job.is_empty() {
            let before = fates.len();
            let is_done = self.attempt(&job, &mut fates)?;
            if !is_done && fates.len() == before {
                return Err(format!("{}: the check ends before it begins", self.file.display()).into());
            }
            job.retain(|(number, _)| !fates.iter().any(|(known, _)| known == number));
        }
        Ok(fates)
    }

    /// One process, until it ends: by itself, by an error that kills it, or because it does not end.
    fn attempt(&self, job: &[(usize, String)], fates: &mut Vec<(usize, Fate)>) -> Result<bool, Failure> {
        let mut child = self.start(job)?;
        let output = child.stdout.take().ok_or("no output")?;
        let (send, receive) = mpsc::channel();
        let reader = std::thread::spawn(move || {
            BufReader::new(output).lines().map_while(Result::ok).try_for_each(|line| send.send(line))
        });
        let (mut trying, mut is_done) = (None, false);
        loop {
            match receive.recv_timeout(PATIENCE) {
                Ok(line) => {
                    let mut words = line.split(' ');
                    let (verb, number) =
                        (words.next().unwrap_or_default(), words.next().and_then(|n| n.parse().ok()));
                    let fate = match verb {
                        "refused" | "same" => Some(Fate::None),
                        "caught" => Some(Fate::Caught { coarse: false }),
                        "survived" => Some(Fate::Survived),
                        _ => None,
                    };
                    is_done |= verb == "done";
                    trying = number.filter(|_| verb == "try");
                    fates.extend(number.zip(fate));
                }
                Err(reason) => {
                    if reason == RecvTimeoutError::Timeout {
                        let _ = child.kill();
                    }
                    break;
                }
            }
        }
        let _ = child.wait();
        let _ = reader.join();
        // it never ended, or the process died of it
        fates.extend(trying.filter(|_| !is_done).map(|number| (number, Fate::Caught { coarse: false })));
        Ok(is_done)
    }
}
