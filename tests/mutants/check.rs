//! Runs kernels with an error in them against their twins, in a process of its own: an error may be a loop without an end.

use gaitway::gpu::{Device, Validation};
use gaitway::kernels::KernelId;
use gaitway::kernels::compile::{Source, compile, fault};
use gaitway::sim::order;
use gaitway::verify::Expected;
use gaitway::verify::cases::{self, Case};
use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Sizes and seeds of the cases: as of the test of equivalence, the cheapest first.
const SIZES: [(usize, u32); 2] = [(65, 1), (1000, 7)];
/// Steps that follow one another in a case.
const ROUNDS: usize = 3;
/// Steps along the trajectory of `verify` at which its kernels are looked at, too.
const TRAJECTORY: [usize; 4] = [0, 5, 20, 60];

type Failure = Box<dyn std::error::Error>;

/// Says something to the process that waits.
fn say(line: &str) {
    let mut out = std::io::stdout().lock();
    let _ = writeln!(out, "{line}").and_then(|()| out.flush());
}

/// Tries the texts of a job (a JSON list of numbers and texts) in the place of `file`, on every kernel that uses it.
///
/// `folder` holds the shaders, and is the one that the environment variable `GAITWAY_SHADERS` names.
pub(crate) fn check(folder: &Path, file: &Path, job: &Path) -> Result<(), Failure> {
    let job: Vec<(usize, String)> = serde_json::from_str(&std::fs::read_to_string(job)?)?;
    let device = Device::open(None, Validation::Off)?;
    let place = folder.join(file);
    let original = std::fs::read_to_string(&place)?;
    let mut left: BTreeSet<usize> = (0..job.len()).collect();
    let mut changed = BTreeSet::new();
    for kernel in kernels_with(folder, file)? {
        let code = spirv(folder, kernel)?;
        let mut wanted = Vec::new();
        for entry in left.clone() {
            std::fs::write(&place, &job[entry].1)?;
            // the compiler panics at some errors instead of refusing them
            match std::panic::catch_unwind(|| spirv(folder, kernel)) {
                Ok(Ok(new)) if new == code => {}
                Ok(Ok(_)) => wanted.push(entry),
                _ => {
                    left.remove(&entry);
                    say(&format!("refused {}", job[entry].0));
                }
            }
        }
        changed.extend(wanted.iter().copied());
        let expected = if wanted.is_empty() { Vec::new() } else { expected(kernel) };
        for entry in wanted {
            say(&format!("try {}", job[entry].0));
            std::fs::write(&place, &job[entry].1)?;
            if let Some(case) = differs(&device, &expected) {
                left.remove(&entry);
                say(&format!("caught {} {case}", job[entry].0));
            }
        }
        std::fs::write(&place, &original)?;
    }
    for entry in left {
        let outcome = if changed.contains(&entry) { "survived" } else { "same" };
        say(&format!("{outcome} {}", job[entry].0));
    }
    say("done");
    Ok(())
}

/// The kernels whose text holds a file, the functions of `exact` first.
pub(crate) fn kernels_with(folder: &Path, file: &Path) -> Result<Vec<KernelId>, Failure> {
    let mut found = Vec::new();
    for kernel in KernelId::ALL {
        if source(folder, kernel)?.files().any(|part| part == folder.join(file)) {
            found.push(kernel);
        }
    }
    found.sort_by_key(|kernel| *kernel != KernelId::Numerics);
    Ok(found)
}

pub(crate) fn source(folder: &Path, kernel: KernelId) -> Result<Source, fault::Error> {
    let file: PathBuf = folder.join(kernel.kernel().name).with_extension("wgsl");
    Source::read(&file, &folder.join("shared"), kernel as usize)
}

/// The code of all phases of a kernel.
fn spirv(folder: &Path, kernel: KernelId) -> Result<Vec<Vec<u32>>, fault::Error> {
    Ok(compile(&source(folder, kernel)?)?.entries.into_iter().map(|entry| entry.spirv).collect())
}

/// Everything that the cases, and the trajectory of `verify`, ask of a kernel.
fn expected(kernel: KernelId) -> Vec<(String, Expected)> {
    let mut found = Vec::new();
    let mut add = |case: &Case| {
        say("ready");
        let count = case
            .dispatches
            .iter()
            .rposition(|dispatch| dispatch.kernel() == kernel)
            .map_or(0, |last| last + 1);
        let own = Expected::of(&case.store, &case.dispatches[..count]).filter(|e| e.kernel == kernel);
        found.extend(own.map(|expected| (case.name.clone(), expected)));
    };
    match kernel {
        KernelId::Arithmetic => add(&cases::arithmetic(cases::PROBED)),
        KernelId::Numerics => add(&cases::functions(cases::PROBED)),
        _ => {}
    }
    let has = |case: &Case| case.dispatches.iter().any(|dispatch| dispatch.kernel() == kernel);
    for (size, seed) in SIZES {
        for case in cases::all(size, seed).into_iter().filter(has) {
            let rounds = std::iter::successors(Some(case), |case| case.clone().next_step());
            rounds.take(ROUNDS).for_each(|case| add(&case));
        }
    }
    for model in order::MODELS {
        let case = cases::crowd(1000, 5, model);
        if has(&case) {
            let steps = std::iter::successors(Some(case), |case| case.clone().next_step()).enumerate();
            let last = TRAJECTORY.iter().max().map_or(0, |last| last + 1);
            steps.take(last).filter(|(step, _)| TRAJECTORY.contains(step)).for_each(|(_, case)| add(&case));
        }
    }
    found
}

/// The first case in which the kernel, as the folder has it now, is not its twin.
fn differs(device: &Arc<Device>, expected: &[(String, Expected)]) -> Option<String> {
    let (_, first) = expected.first()?;
    let mut engine = match first.engine(device) {
        Ok(engine) => engine,
        Err(error) => return Some(format!("{error}")),
    };
    expected.iter().find_map(|(name, expected)| match expected.compare(&mut engine, |_, _| ()) {
        Ok(comparison) => (comparison.exact < comparison.compared).then(|| name.clone()),
        Err(error) => Some(format!("{error}")),
    })
}
