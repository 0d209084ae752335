//! The report: one page of Markdown and its figures.

use super::judge::Outcome;
use super::tests::KNOWN;
use super::{Options, Validation, chosen};
use crate::Error;
use crate::export::{AtomicFile, chart};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Writes `validation.md` and its figures into a folder, which is made if it is not there; returns the page.
///
/// # Errors
/// When a file cannot be written.
pub fn write(folder: &Path, validation: &Validation, options: &Options) -> Result<PathBuf, Error> {
    for (name, figure) in &validation.figures {
        chart::write(folder, name, figure)?;
    }
    let path = folder.join("validation.md");
    let wrong = |source| crate::export::Error::Write { path: path.clone(), source };
    std::fs::create_dir_all(folder).map_err(wrong)?;
    let mut file = AtomicFile::create(&path)?;
    file.write_all(page(validation, options)?.as_bytes()).map_err(wrong)?;
    file.finish()?;
    Ok(path)
}

/// The page.
///
/// # Errors
/// When a test of the options is unknown.
pub fn page(validation: &Validation, options: &Options) -> Result<String, Error> {
    let mut page = String::from("# Validation of gaitway's crowds\n\n");
    // writing into a String cannot fail
    let _ = writeln!(
        page,
        "gaitway {}, on {}{}. Seeds are fixed: the same program gives the same page, on every device whose arithmetic \
         is exact.\n\n**gaitway is no certified evacuation tool.** These are tests of plausibility; the column \"by\" names \
         the origin of each criterion. No safety case may rest on them.\n\nPeople are what a scenario's defaults make them: \
         discs of {} m, every setting of `[navigation]` left alone. A test with random draws is repeated {} times, with other \
         places and draws. Every third scene is turned by 37 degrees, every third moved by half a cell. \"Found\" is the first \
         draw. A value passes if nine draws in ten meet its criterion; for events that must never happen, if all do. Two \
         columns show the first draw with 1.5 times and twice as many people.\n",
        env!("CARGO_PKG_VERSION"),
        validation.device,
        if options.is_quick { ", quick run (fewer people, shorter, one draw)" } else { "" },
        super::rooms::RADIUS,
        if options.is_quick { 1 } else { options.draws },
    );
    summary(&mut page, validation);
    for test in chosen(&options.tests)? {
        let of_test = |name: &str| belongs(name.split_once('.').map_or(name, |parts| parts.0), test.name);
        let outcomes: Vec<_> = validation.outcomes.iter().filter(|outcome| of_test(&outcome.name)).collect();
        let about = test.about.split_whitespace().collect::<Vec<_>>().join(" ");
        let _ = writeln!(page, "## {}: {}\n\n{}. {about}\n", test.name, test.title, test.source);
        if outcomes.is_empty() {
            page += "Left out.\n\n";
            continue;
        }
        page += "| value | found | unit | least to most | 1.5 times | twice | criterion | by | draws | |\n";
        page += "|---|---:|---|---|---:|---:|---|---|---:|---|\n";
        outcomes.into_iter().for_each(|outcome| row(&mut page, outcome));
        page.push('\n');
        if let Some((_, known)) = KNOWN.iter().find(|known| known.0 == test.name) {
            let _ = writeln!(page, "Known: {}\n", known.split_whitespace().collect::<Vec<_>>().join(" "));
        }
        for (name, figure) in validation.figures.iter().filter(|(name, _)| belongs(name, test.name)) {
            let _ = writeln!(page, "![{}]({name}.svg)\n", figure.title);
        }
    }
    Ok(page)
}

/// What fails, and what was left out.
fn summary(page: &mut String, validation: &Validation) {
    let failed: Vec<_> = validation.failed().collect();
    let judged = validation.judged();
    let shown = validation.outcomes.len() - judged;
    if failed.is_empty() {
        let _ = writeln!(page, "All {judged} judged values meet their criteria; {shown} more are shown.\n");
    } else {
        let _ =
            writeln!(page, "**{} of {judged} judged values fail** ({shown} more are shown):\n", failed.len());
        for outcome in &failed {
            let _ = writeln!(
                page,
                "- {}: {} {}, wanted {}; {} of {} draws pass",
                outcome.name,
                number(outcome.value),
                outcome.unit,
                outcome.criterion.as_deref().unwrap_or_default(),
                outcome.passes,
                outcome.draws
            );
        }
        page.push('\n');
    }
    if !validation.skipped.is_empty() {
        *page += "Left out, because the recordings are not there:\n\n";
        for skipped in &validation.skipped {
            let _ = writeln!(page, "- {skipped}");
        }
        page.push('\n');
    }
}

fn row(page: &mut String, outcome: &Outcome) {
    let name = outcome.name.split_once('.').map_or("", |parts| parts.1);
    let [least, most] = outcome.range;
    let range =
        if outcome.draws == 1 { String::new() } else { format!("{} to {}", number(least), number(most)) };
    let larger = |size: usize| outcome.larger.get(size).map_or_else(String::new, |value| number(*value));
    let origin = outcome.origin.map_or_else(String::new, |origin| origin.to_string());
    let verdict = match (outcome.is_judged(), outcome.pass) {
        (false, _) => "",
        (true, true) => "pass",
        (true, false) => "**FAIL**",
    };
    let draws =
        if outcome.is_judged() { format!("{} of {}", outcome.passes, outcome.draws) } else { String::new() };
    let _ = writeln!(
        page,
        "| {name} | {} | {} | {range} | {} | {} | {} | {origin} | {draws} | {verdict} |",
        number(outcome.value),
        outcome.unit,
        larger(0),
        larger(1),
        outcome.criterion.as_deref().unwrap_or("shown only"),
    );
}

/// Whether a figure or a group of values is of a test: it has its name, or that and more behind a hyphen.
fn belongs(name: &str, test: &str) -> bool {
    name.strip_prefix(test).is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
}

fn number(value: f64) -> String {
    if value.is_finite() { format!("{value:.3}") } else { "not all came".to_owned() }
}
