//! A study's registration: a page for a registry, written before the first participant has a place.
//!
//! ```text
//!  study.toml ─► page: study · design · sampling · variables · analysis · other
//! ```
//!
//! The headings are those of the template "OSF Preregistration", in its order. Everything under them comes from the study file,
//! from what lies beside it and from what this program does with it. What none of them says is a blank that begins with
//! [`BLANK`](super::BLANK): nothing is made up.
//!
//! ```
//! use gaitway::study::register::{Registration, register};
//! use gaitway::study::{Materials, Study};
//!
//! # fn main() -> Result<(), gaitway::study::Error> {
//! let study = Study::builtin("eva-agents")?;
//! let page = register(&Registration { study: &study, materials: &Materials::default(), hash: None, data: None })?;
//! assert!(page.contains("### Hypotheses\n\nTO FILL IN"));
//! # Ok(())
//! # }
//! ```

mod analysis;
mod design;
mod page;
mod sampling;
mod variables;

use super::check::{self, Severity};
use super::error::Error;
use super::file::StudyFile;
use super::load::Study;
use super::materials::Materials;
use super::plan::Plan;
use super::words::Words;
use page::Page;

/// What a registration is written from.
#[derive(Debug, Clone, Copy)]
pub struct Registration<'r> {
    /// The study.
    pub study: &'r Study,
    /// What lies beside it.
    pub materials: &'r Materials,
    /// The hash of study file, texts and libraries; none where one of them is not there yet.
    pub hash: Option<&'r str>,
    /// A folder of data in which no participant has had a place; none where no folder was looked at.
    pub data: Option<&'r str>,
}

/// The page, in Markdown.
///
/// # Errors
/// [`Error::Value`] for a study that cannot be planned.
pub fn register(registration: &Registration<'_>) -> Result<String, Error> {
    let study = registration.study;
    let plan = Plan::of(&study.file, registration.materials)?;
    let report = check::check(study, registration.materials);
    let from = Source { file: &study.file, plan: &plan, summary: report.summary.as_ref() };
    let mut page = Page::new(&format!("Registration: {}", from.find(&study.file.study.title)));
    information(&mut page, &from);
    design::write(&mut page, &from);
    sampling::write(&mut page, &from, registration.data)?;
    variables::write(&mut page, &from)?;
    analysis::write(&mut page, &from);
    other(&mut page, registration, &report);
    Ok(page.into_text())
}

/// What the sections read.
struct Source<'r> {
    file: &'r StudyFile,
    plan: &'r Plan,
    summary: Option<&'r check::Summary>,
}

impl Source<'_> {
    /// A text in the study's first language.
    fn find<'w>(&self, words: &'w Words) -> &'w str {
        let languages = &self.file.study.languages;
        words.find(languages.first().map_or("", String::as_str), languages)
    }
}

fn information(page: &mut Page, from: &Source<'_>) {
    let StudyFile { study, registration, .. } = from.file;
    page.section("Study information");
    page.field("Title");
    page.text(from.find(&study.title));
    page.field("Authors");
    page.list_or_blank(&registration.authors, "names of the authors");
    page.field("Description");
    let parts = study.flow.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    page.text(&format!(
        "Study `{}`, version {} of its file. A participation is announced to take {} min. Its parts, in this order: {parts}.",
        study.id, study.version, study.minutes
    ));
    page.blank("the question that the study answers");
    page.field("Hypotheses");
    page.list_or_blank(&registration.hypotheses, "the hypotheses, each with its direction");
}

/// What identifies the study, and what its file still lacks.
fn other(page: &mut Page, registration: &Registration<'_>, report: &check::Report) {
    let file = &registration.study.file;
    page.section("Other");
    page.field("Other");
    let hash = registration.hash.map_or_else(
        || "TO FILL IN: a file that the study names is not there yet; register again when it is".to_owned(),
        |hash| format!("`{hash}`"),
    );
    page.list(&[
        format!("SHA-256 of study file, texts and libraries: {hash}"),
        format!(
            "Program: gaitway {}. The same program, file and seed give the same plan.",
            env!("CARGO_PKG_VERSION")
        ),
        format!("Seed of every draw of the plan: {}", file.study.seed),
    ]);
    let is_missing = |note: &&check::Note| note.severity == Severity::Missing;
    let missing: Vec<String> =
        report.notes.iter().filter(is_missing).map(|note| format!("`{}`", note.key)).collect();
    if !missing.is_empty() {
        page.text(&format!(
            "The study file has blanks, too: {}. Filling them in changes the hash: fill them in before this page is handed in.",
            missing.join(", ")
        ));
    }
}
