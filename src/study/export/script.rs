//! An R script with mixed models of what the study file tests.

use super::names::Names;
use crate::study::file::{Part, StudyFile, Test};
use std::fmt::Write as _;

const HEAD: &str = r#"# Mixed models of the planned tests. Run in this folder: Rscript models.R
# The tests themselves are in results.md. Models use all answers of a participant, also of those that left early.
suppressPackageStartupMessages({
  library(ordinal)
  library(lme4)
})

read_answers <- function(file) {
  answers <- read.csv(file.path("..", "data", file), colClasses = c(participant = "character"))
  answers$excluded <- as.logical(answers$excluded)
  answers <- answers[!answers$excluded & answers$role == "ordinary" & !is.na(answers$value), ]
  answers$participant <- factor(answers$participant)
  answers
}

# Prints a model, or why there is none, and goes on.
fit <- function(title, model) {
  cat("\n== ", title, " ==\n", sep = "")
  tryCatch(print(summary(model)), error = function(e) cat("no model:", conditionMessage(e), "\n"))
}
"#;

/// The script: one block a planned test, one for ratings.
pub(super) fn script(study: &StudyFile, names: &Names) -> String {
    let mut text = String::from(HEAD);
    for test in &study.analysis.tests {
        let (Test::Friedman { of, .. } | Test::Confusion { of }) = test;
        let mut pieces = of.split('.');
        let (Some(part), Some(question)) = (pieces.next(), pieces.next()) else { continue };
        let Some(file) = names.part(part) else { continue };
        match test {
            Test::Friedman { by, within, .. } => {
                let item = pieces.next().unwrap_or("*");
                friedman(&mut text, file, [question, item], by, within.as_deref());
            }
            Test::Confusion { .. } => confusion(&mut text, study, file, [part, question]),
        }
    }
    if let Some(ratings) = &study.analysis.ratings {
        let trials = study.parts.get(&ratings.part).and_then(Part::trials);
        if let (Some(file), Some(question)) =
            (names.part(&ratings.part), trials.and_then(|one| one.ask.0.first()))
        {
            rated(&mut text, file, question);
        }
    }
    text
}

/// A text as R writes it.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

// writing to a string cannot fail
fn friedman(text: &mut String, file: &str, [question, item]: [&str; 2], by: &str, within: Option<&str>) {
    let fixed = within.map_or_else(|| by.to_owned(), |within| format!("{by} * {within}"));
    let chosen = match item {
        "*" => format!("startsWith(answers$question, {})", quoted(&format!("{question}."))),
        item => format!("answers$question == {}", quoted(&format!("{question}.{item}"))),
    };
    let factors: String = std::iter::once(by)
        .chain(within)
        .fold(String::new(), |all, name| all + &format!("answers${name} <- factor(answers${name})\n"));
    let _ = write!(
        text,
        r#"
# {question}.{item} by {fixed}: cumulative links for the points of the scale, and a linear model of the same with the trend over trials
answers <- read_answers({file})
answers <- answers[{chosen}, ]
{factors}answers$point <- factor(answers$value, ordered = TRUE)
for (item in sort(unique(answers$question))) {{
  own <- droplevels(answers[answers$question == item, ])
  fit(paste(item, "clmm"), clmm(point ~ {fixed} + (1 | participant), data = own))
  fit(paste(item, "lmer"), lmer(value ~ {fixed} + position + (1 | participant), data = own))
}}
"#,
        file = quoted(file)
    );
}

fn confusion(text: &mut String, study: &StudyFile, file: &str, [part, question]: [&str; 2]) {
    let languages = &study.study.languages;
    let preferred = languages.first().map_or("", String::as_str);
    let Some(crate::study::file::Question::Choice { options, .. }) = study.questions.get(question) else {
        return;
    };
    let names: Vec<String> = options.iter().map(|one| quoted(one.find(preferred, languages))).collect();
    let _ = write!(
        text,
        r#"
# {part}.{question}: right answers by emotion, people as random effects
answers <- read_answers({file})
answers <- answers[answers$question == {own}, ]
options_shown <- c({names})
answers$right <- tolower(options_shown[answers$value + 1]) == tolower(answers$emotion)
answers$emotion <- factor(answers$emotion)
fit("{part}.{question} glmer", glmer(right ~ emotion + (1 | participant), data = answers, family = binomial))
"#,
        file = quoted(file),
        own = quoted(question),
        names = names.join(", ")
    );
}

fn rated(text: &mut String, file: &str, question: &str) {
    let _ = write!(
        text,
        r#"
# Ratings of {question}: how much of them lies between gaits and how much between raters
answers <- read_answers({file})
answers <- answers[startsWith(answers$question, {own}), ]
answers$gait <- factor(answers$gait)
answers$point <- factor(answers$value, ordered = TRUE)
for (item in sort(unique(answers$question))) {{
  own <- droplevels(answers[answers$question == item, ])
  fit(paste(item, "clmm"), clmm(point ~ 1 + (1 | participant) + (1 | gait), data = own))
  fit(paste(item, "lmer"), lmer(value ~ 1 + (1 | participant) + (1 | gait), data = own))
}}
"#,
        file = quoted(file),
        own = quoted(&format!("{question}."))
    );
}
