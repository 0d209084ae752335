//! What is varied, what is asked, what is computed from it.

use super::Source;
use super::page::Page;
use crate::study::error::Error;
use crate::study::file::{Part, Show};
use crate::study::instrument::{Instrument, ScoreKind};
use crate::study::plan::{Prompt, Scale, prompts};

pub(super) fn write(page: &mut Page, from: &Source<'_>) -> Result<(), Error> {
    page.section("Variables");
    page.field("Manipulated variables");
    manipulated(page, from);
    page.field("Measured variables");
    measured(page, from)?;
    page.field("Indices");
    indices(page, from)
}

fn manipulated(page: &mut Page, from: &Source<'_>) {
    let mut lines = Vec::new();
    for (_, name, _) in from.plan.counted() {
        let Some(trials) = from.file.parts.get(name).and_then(Part::trials) else { continue };
        let Show { scenes, conditions, agents, .. } = &trials.show;
        let mut levels =
            |what: &str, of: &[String]| lines.push(format!("`{name}`, {what}: {}", of.join(", ")));
        conditions.iter().for_each(|all| levels("condition", all));
        scenes.iter().for_each(|all| levels("scene", all));
        if let Some(agents) = agents {
            levels("acted emotion", &agents.each_of);
            levels("body", &agents.bodies);
        }
    }
    if lines.is_empty() {
        page.text("None. Stimuli differ in what they show, and no condition is varied.");
    } else {
        page.list(&lines);
    }
}

fn measured(page: &mut Page, from: &Source<'_>) -> Result<(), Error> {
    let mut lines = Vec::new();
    for (part, kind) in in_order(from) {
        for group in asked(kind) {
            let all = prompts(from.file, group)?.unwrap_or_default();
            lines.push(format!("`{part}`, `{group}`: {}", question(from, group, &all)?));
        }
    }
    page.list_or_blank(&lines, "what is measured; the file asks nothing");
    if !lines.is_empty() {
        page.text("Of every answer the time from the moment the question was seen is stored, ms; of every stimulus late frames.");
    }
    Ok(())
}

/// The parts of the flow, in its order.
fn in_order<'f>(from: &Source<'f>) -> impl Iterator<Item = (&'f str, &'f Part)> {
    let file = from.file;
    file.study.flow.iter().filter_map(|name| Some((name.as_str(), file.parts.get(name)?)))
}

/// Names of the questions that a part asks, practice left out.
fn asked(part: &Part) -> Vec<&str> {
    let names = match part {
        Part::Form(form) => vec![&form.ask],
        Part::Trials(trials) if trials.counted => {
            std::iter::once(&trials.ask).chain(&trials.after_block).collect()
        }
        _ => Vec::new(),
    };
    names.into_iter().flat_map(|names| &names.0).map(String::as_str).collect()
}

/// Statements and scale of a question, or the name of a questionnaire.
fn question(from: &Source<'_>, group: &str, all: &[Prompt]) -> Result<String, Error> {
    let Some(first) = all.first() else { return Ok(String::new()) };
    let answers = scale(from, &first.scale);
    if let Some(instrument) = Instrument::builtin(group)?.filter(|_| !from.file.questions.contains_key(group))
    {
        let s = if all.len() == 1 { "" } else { "s" };
        return Ok(format!("{} item{s}, {answers}. {}", all.len(), instrument.source));
    }
    let texts: Vec<String> = all.iter().map(|one| format!("“{}”", from.find(&one.text))).collect();
    let optional = if first.optional { "; may be left blank" } else { "" };
    Ok(format!("{}; {answers}{optional}", texts.join(", ")))
}

fn scale(from: &Source<'_>, scale: &Scale<crate::study::words::Words>) -> String {
    match scale {
        Scale::Points { least, greatest, labels } => {
            let words = labels.iter().map(|(point, text)| format!("{point} = {}", from.find(text)));
            let words: Vec<String> = words.collect();
            let words = if words.is_empty() { String::new() } else { format!(" ({})", words.join(", ")) };
            format!("{least} to {greatest}{words}")
        }
        Scale::Options { options } => {
            let words: Vec<&str> = options.iter().map(|(_, text)| from.find(text)).collect();
            format!("one of {}", words.join(", "))
        }
        Scale::Number { least, greatest } => format!("a number, {least} to {greatest}"),
        Scale::Text { .. } => "free text".to_owned(),
    }
}

fn indices(page: &mut Page, from: &Source<'_>) -> Result<(), Error> {
    let mut lines = Vec::new();
    if let Some(ratings) = &from.file.analysis.ratings {
        lines.push(format!(
            "label of a gait: the emotions whose mean rating in `{}` is above {}",
            ratings.part, ratings.theta
        ));
    }
    let mut done: Vec<&str> = Vec::new();
    for group in in_order(from).flat_map(|(_, part)| asked(part)) {
        if done.contains(&group) || from.file.questions.contains_key(group) {
            continue;
        }
        done.push(group);
        let Some(instrument) = Instrument::builtin(group)? else { continue };
        let scores: Vec<String> = instrument.scores.iter().map(score).collect();
        let variants = from.file.analysis.scoring.get(group).map_or(&[][..], |scoring| &scoring.variants);
        let variants =
            if variants.is_empty() { String::new() } else { format!("; variants {}", variants.join(", ")) };
        lines.push(format!("`{group}`: {}{variants}", scores.join("; ")));
    }
    if lines.is_empty() {
        page.text("None.");
    } else {
        page.list(&lines);
    }
    Ok(())
}

fn score(score: &crate::study::instrument::Score) -> String {
    let kind = match score.kind {
        ScoreKind::Sum => "sum",
        ScoreKind::Mean => "mean",
        ScoreKind::Percent => "percent of the range",
        ScoreKind::Count => "count of high answers",
    };
    let of: Vec<&str> = score.items.iter().chain(&score.of).map(String::as_str).collect();
    #[allow(clippy::float_cmp, reason = "a factor that is not written is exactly 1")]
    let factor = if score.factor == 1.0 { String::new() } else { format!(", times {}", score.factor) };
    format!("{} = {kind} of {}{factor}", score.id, of.join(", "))
}
