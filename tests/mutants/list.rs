//! What survives and why, and the table.

use crate::rust::Tried;
use crate::shaders::{Fate, Planted};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::fmt::Write as _;

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Least share of the errors that are not equivalent which must be caught.
const LEAST: f64 = 0.95;

const HEAD: &str = "\
# Mutants

`scripts/test mutants` writes this page. It plants single errors, one at a time, and runs the cheapest test that ought to notice.

In the shaders an error is another operator, sign, component, index or argument, a condition that is always or never met, a
statement left out, or a constant one unit in the last place larger. The cases of `gaitway verify` and states of its trajectory
run each on a Vulkan device. Where they notice nothing, a constant becomes 1 % larger and a comparison of floats is reversed:
random numbers seldom fall on a bound. Those are counted as coarse. Errors that earlier versions of the cases did not notice are
always tried. An error counts in a shared file when one of the kernels
that use it differs from its twin. Of a file at most the number of errors named below is tried, the same ones every time.

In the Rust sources the errors are those of `tests/mutants/rust/`; each names the test that must notice.

Errors that change no result are equivalent; `tests/mutants/survivors.toml` says why. At least 95 % of the others must be caught.
";

/// The file of survivors.
#[derive(Debug, Deserialize)]
pub(crate) struct Survivors {
    /// Errors that are always tried, and must be caught.
    pub(crate) always: Vec<String>,
    #[serde(default)]
    group: Vec<Group>,
}

/// Survivors with one reason.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Group {
    /// Whether no input that can occur distinguishes them from the original.
    equivalent: bool,
    reason: String,
    mutants: Vec<String>,
}

impl Survivors {
    pub(crate) fn read(path: &str) -> Result<Self, Failure> {
        Ok(toml::from_str(&std::fs::read_to_string(path)?)?)
    }

    fn group_of(&self, id: &str) -> Option<&Group> {
        self.group.iter().find(|group| group.mutants.iter().any(|mutant| mutant == id))
    }
}

/// One row of the table.
#[derive(Debug, Default, Clone, Copy)]
struct Row {
    possible: usize,
    tried: usize,
    caught: usize,
    coarse: usize,
    equivalent: usize,
    survived: usize,
}

impl Row {
    fn of(planted: &Planted, survivors: &Survivors) -> Self {
        let mut row = Self { possible: planted.possible, tried: planted.fates.len(), ..Self::default() };
        for (id, fate) in &planted.fates {
            match fate {
                Fate::Caught { coarse } => {
                    row.caught += 1;
                    row.coarse += usize::from(*coarse);
                }
                _ if survivors.group_of(id).is_some_and(|group| group.equivalent) => row.equivalent += 1,
                _ => row.survived += 1,
            }
        }
        row
    }

    fn add(&mut self, other: Self) {
        self.possible += other.possible;
        self.tried += other.tried;
        self.caught += other.caught;
        self.coarse += other.coarse;
        self.equivalent += other.equivalent;
        self.survived += other.survived;
    }

    fn text(&self, name: &str) -> String {
        let Self { possible, tried, caught, coarse, equivalent, survived } = self;
        format!("| {name} | {possible} | {tried} | {caught} | {coarse} | {equivalent} | {survived} |\n")
    }
}

/// What the page says, and what is wrong.
pub(crate) struct Outcome {
    pub(crate) page: String,
    pub(crate) faults: Vec<String>,
}

/// Judges what became of the errors. `most` is the number tried in a file.
pub(crate) fn judge(planted: &[Planted], tried: &[Tried], survivors: &Survivors, most: usize) -> Outcome {
    let (mut page, mut faults, mut all) = (HEAD.to_owned(), Vec::new(), Row::default());
    let _ = writeln!(page, "\n## Shaders\n\nAt most {most} errors of a file are tried.\n");
    page.push_str("| file | possible | tried | caught | of these coarse | equivalent | survived |\n");
    page.push_str("| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n");
    for file in planted {
        let row = Row::of(file, survivors);
        page.push_str(&row.text(&format!("`{}`", file.name)));
        all.add(row);
    }
    page.push_str(&all.text("all"));
    let alive: BTreeSet<&str> = planted
        .iter()
        .flat_map(|file| &file.fates)
        .filter(|(_, fate)| **fate == Fate::Survived)
        .map(|(id, _)| id.as_str())
        .collect();
    for id in alive.iter().filter(|id| survivors.group_of(id).is_none()) {
        faults.push(format!("survived, and is not listed: {id}"));
    }
    let caught =
        |id: &String| planted.iter().any(|file| matches!(file.fates.get(id), Some(Fate::Caught { .. })));
    for id in survivors.always.iter().filter(|id| !caught(id)) {
        faults.push(format!("must be caught, and is not, or is there no more: {id}"));
    }
    let share = all.caught as f64 / (all.caught + all.survived).max(1) as f64;
    let _ = writeln!(
        page,
        "\n{:.1} % of the {} that are not equivalent are caught.",
        100.0 * share,
        all.caught + all.survived
    );
    if share < LEAST {
        faults.push(format!(
            "{:.1} % of the errors of the shaders are caught, at least 95 % must be",
            100.0 * share
        ));
    }
    page.push_str("\n## Errors of the shaders that survive\n");
    for group in &survivors.group {
        let own: Vec<&String> = group.mutants.iter().filter(|id| alive.contains(id.as_str())).collect();
        if own.is_empty() {
            continue;
        }
        let kind = if group.equivalent { "Equivalent" } else { "Not equivalent" };
        let _ = writeln!(page, "\n{kind}: {}\n", group.reason);
        own.iter().for_each(|id| page.push_str(&format!("- `{}`\n", id.replace('`', "'"))));
    }
    page.push_str("\n## Rust\n\n| error | file | test | |\n| --- | --- | --- | --- |\n");
    for one in tried {
        let outcome = if one.caught { "caught" } else { "survived" };
        let _ = writeln!(page, "| {} | `{}` | `{}` | {outcome} |", one.name, one.file, one.test);
        if !one.caught {
            faults.push(format!("survived: {} ({})", one.name, one.file));
        }
    }
    Outcome { page, faults }
}
