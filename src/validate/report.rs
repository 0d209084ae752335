//! The report: one page of Markdown and its figures.

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
    let failed: Vec<_> = validation.outcomes.iter().filter(|outcome| !outcome.pass).collect();
    let total = validation.outcomes.len();
    // writing into a String cannot fail
    let _ = writeln!(
        page,
        "gaitway {}, on {}{}. Seeds are fixed: the same program gives the same page, on every device whose arithmetic \
         is exact.\n\n**gaitway is no certified evacuation tool.** These are tests of plausibility, most of them in our own \
         words and with bounds of our own where the source states none; they say so. Nobody's safety may be built on them.\n",
        env!("CARGO_PKG_VERSION"),
        validation.device,
        if options.is_quick { ", quick run (fewer people, scenes only as they are)" } else { "" },
    );
    if failed.is_empty() {
        let _ = writeln!(page, "All {total} values meet their criteria.\n");
    } else {
        let _ = writeln!(page, "**{} of {total} values fail:**\n", failed.len());
        for outcome in &failed {
            let _ = writeln!(
                page,
                "- {} ({}): {}, wanted {}",
                outcome.name,
                outcome.variant,
                number(outcome.value),
                outcome.criterion
            );
        }
        page.push('\n');
    }
    if !validation.skipped.is_empty() {
        page += "Left out, because the recordings are not there:\n\n";
        for skipped in &validation.skipped {
            let _ = writeln!(page, "- {skipped}");
        }
        page.push('\n');
    }
    for test in chosen(&options.tests)? {
        let of_test = |name: &str| name.strip_prefix(test.name).is_some_and(|rest| rest.starts_with('.'));
        let outcomes: Vec<_> = validation.outcomes.iter().filter(|outcome| of_test(&outcome.name)).collect();
        let about = test.about.split_whitespace().collect::<Vec<_>>().join(" ");
        let _ = writeln!(page, "## {}: {}\n\n{about}\n", test.name, test.title);
        if outcomes.is_empty() {
            page += "Left out.\n\n";
            continue;
        }
        page += "| value | variant | found | criterion | |\n|---|---|---:|---|---|\n";
        for outcome in outcomes {
            let name = outcome.name.split_once('.').map_or("", |parts| parts.1);
            let _ = writeln!(
                page,
                "| {name} | {} | {} | {} | {} |",
                outcome.variant,
                number(outcome.value),
                outcome.criterion,
                if outcome.pass { "pass" } else { "**fail**" }
            );
        }
        page.push('\n');
        for (name, figure) in validation.figures.iter().filter(|(name, _)| belongs(name, test.name)) {
            let _ = writeln!(page, "![{}]({name}.svg)\n", figure.title);
        }
    }
    Ok(page)
}

/// Which figure stands under which test.
fn belongs(figure: &str, test: &str) -> bool {
    figure.strip_prefix(test).is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
}

fn number(value: f64) -> String {
    if value.is_finite() { format!("{value:.3}") } else { "nothing (not everyone came through)".to_owned() }
}
