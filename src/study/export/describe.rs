//! `dataset_description.json`: what the dataset is, and every column of its tables.

use super::sheet::Sheet;
use crate::study::BLANK;
use crate::study::analyse::{Analysis, Error};
use crate::study::file::{Front, Part, StudyFile};
use crate::study::plan::{Scale, prompts};
use crate::study::tables::name;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// Version of the specification that the dataset follows.
const PSYCH_DS: &str = "Psych-DS 1.5.1";

/// A column: what it is, its unit.
const COLUMNS: [(&str, &str, &str); 26] = [
    ("participant", "Code or number of the participant", ""),
    ("front", "Where the participant took part", ""),
    ("excluded", "Whether the rules of the study file exclude the participant from the main analysis", ""),
    ("page", "Page of the study on which the question stood", ""),
    ("position", "Position of the trial within its part, from 1; empty outside of counted trials", ""),
    ("role", "What the trial is for; empty outside of counted trials", ""),
    ("wanted", "Answer that an instructed trial asks for", ""),
    ("gait", "Name of the gait that was shown", ""),
    ("scene", "Name of the scene that was shown", ""),
    ("condition", "Condition under which it was shown", ""),
    ("emotion", "Emotion that the agent was to show", ""),
    ("body", "Avatar of the agent", ""),
    ("question", "Question or item that was answered", ""),
    (
        "value",
        "Number that was answered: the point of a scale, the index of an option from 0, or a number; empty where the answer was taken back",
        "",
    ),
    ("text", "Free text that was answered. A leading ' keeps spreadsheets from computing it", ""),
    ("ms", "Time from the moment the question was seen to the answer", "ms"),
    ("state", "Where the participation ended", ""),
    ("placed", "Whether the participant got a place in the plan", ""),
    ("reasons", "Rules of the study file that exclude the participant", ""),
    ("frames", "Frames of all stimuli", ""),
    ("late_frames", "Frames of all stimuli that were shown late", ""),
    ("gender", "Gender, as the participant said it", ""),
    ("age", "Age, as the participant said it", "years"),
    (
        "age_band",
        "Age in a band, first and last year included; in place of the age where too few people share gender and age",
        "years",
    ),
    ("part", "Part of the study", ""),
    ("questionnaire", "Published questionnaire", ""),
];
/// Those of the table of scores.
const SCORES: [(&str, &str, &str); 2] =
    [("score", "Score of the questionnaire", ""), ("score_value", "Value of the score", "")];

pub(super) fn dataset(study: &StudyFile, analysis: &Analysis, sheets: &[Sheet]) -> Result<String, Error> {
    let names: BTreeSet<&str> = sheets.iter().flat_map(|sheet| sheet.columns.iter().copied()).collect();
    let known = COLUMNS.iter().chain(&SCORES).filter(|(name, ..)| names.contains(name));
    let variables: Vec<Value> =
        known.map(|&column| variable(column, study, sheets)).collect::<Result<_, _>>()?;
    let simulated = if analysis.participants.is_simulated { " All participants are simulated." } else { "" };
    let title = if analysis.title.is_empty() { &analysis.study } else { &analysis.title };
    let mut found = json!({
        "@context": "https://schema.org/",
        "@type": "Dataset",
        "name": title,
        "description": format!(
            "Answers to the study {}, version {}: {} participants arrived, {} got a place.{simulated}",
            analysis.study, analysis.version, analysis.participants.arrived, analysis.participants.placed
        ),
        "schemaVersion": PSYCH_DS,
        "version": analysis.version.to_string(),
        "inLanguage": study.study.languages,
        "keywords": ["Psych-DS", "gaitway", analysis.study],
        "variableMeasured": variables,
    });
    let languages = &study.study.languages;
    let contact = study.study.contact.find(languages.first().map_or("", String::as_str), languages);
    if let Some(fields) = found.as_object_mut().filter(|_| !contact.is_empty() && !contact.starts_with(BLANK))
    {
        fields.insert("author".to_owned(), json!([{ "@type": "Organization", "name": contact }]));
    }
    Ok(serde_json::to_string_pretty(&found).unwrap_or_default() + "\n")
}

/// The cells of a column in all tables.
fn cells<'s>(sheets: &'s [Sheet], column: &str) -> impl Iterator<Item = &'s str> {
    let places = sheets
        .iter()
        .filter_map(move |sheet| Some((sheet, sheet.columns.iter().position(|name| *name == column)?)));
    places.collect::<Vec<_>>().into_iter().flat_map(|(sheet, at)| {
        sheet
            .rows
            .iter()
            .filter_map(move |row| row.get(at))
            .map(String::as_str)
            .filter(|cell| !cell.is_empty())
    })
}

fn variable(
    (column, description, unit): (&str, &str, &str),
    study: &StudyFile,
    sheets: &[Sheet],
) -> Result<Value, Error> {
    let mut found = Map::new();
    found.insert("@type".to_owned(), "PropertyValue".into());
    found.insert("name".to_owned(), column.into());
    found.insert("description".to_owned(), description.into());
    if !unit.is_empty() {
        found.insert("unitText".to_owned(), unit.into());
    }
    let numbers = ["position", "wanted", "value", "ms", "frames", "late_frames", "age", "score_value"];
    if numbers.contains(&column) {
        let values = || cells(sheets, column).filter_map(|cell| cell.parse::<f64>().ok());
        if let (Some(least), Some(greatest)) = (values().reduce(f64::min), values().reduce(f64::max)) {
            found.insert("minValue".to_owned(), json!(least));
            found.insert("maxValue".to_owned(), json!(greatest));
        }
    }
    if column == "value" {
        found.insert("valueReference".to_owned(), questions(study, sheets)?.into());
    } else if let Some(levels) = levels(column, study, sheets) {
        found.insert("valueReference".to_owned(), levels.into());
    }
    Ok(Value::Object(found))
}

/// The levels of a column of words, each with what it means.
fn levels(column: &str, study: &StudyFile, sheets: &[Sheet]) -> Option<Vec<Value>> {
    let own: BTreeSet<&str> = cells(sheets, column).collect();
    let means = |level: &str| match (column, level) {
        ("front", "web") => "in a browser",
        ("front", "headset") => "in a headset",
        ("front", "simulated") => "no person: a simulated participant",
        ("role", "ordinary") => "its answers count",
        ("role", "repeat") => "shows a stimulus for the second time",
        ("role", "catch") => "shows nothing and asks for a certain answer",
        _ => "",
    };
    let words = [
        "front",
        "excluded",
        "role",
        "scene",
        "condition",
        "emotion",
        "body",
        "state",
        "placed",
        "gender",
        "age_band",
        "questionnaire",
        "score",
    ];
    if column == "part" {
        return Some(
            study
                .study
                .flow
                .iter()
                .filter(|part| own.contains(part.as_str()))
                .map(|part| level(part, ""))
                .collect(),
        );
    }
    words.contains(&column).then(|| own.iter().map(|one| level(one, means(one))).collect())
}

fn level(name: &str, description: &str) -> Value {
    let mut found = json!({ "@type": "PropertyValue", "name": name });
    if let Some(fields) = found.as_object_mut().filter(|_| !description.is_empty()) {
        fields.insert("description".to_owned(), description.into());
    }
    found
}

/// What each question is, with its range and the words of its answers.
fn questions(study: &StudyFile, sheets: &[Sheet]) -> Result<Vec<Value>, Error> {
    let asked: BTreeSet<&str> = cells(sheets, "question").collect();
    let languages = &study.study.languages;
    let preferred = languages.first().map_or("", String::as_str);
    let find = |words: &crate::study::words::Words| words.find(preferred, languages).to_owned();
    let mut groups: BTreeSet<&str> = BTreeSet::new();
    let mut found = Vec::new();
    for group in study.study.flow.iter().filter_map(|part| study.parts.get(part)).flat_map(groups_of) {
        if !groups.insert(group) {
            continue;
        }
        for prompt in
            prompts(study, group)?.into_iter().flatten().filter(|one| asked.contains(one.id.as_str()))
        {
            let mut one = json!({ "@type": "PropertyValue", "name": prompt.id });
            let Some(fields) = one.as_object_mut() else { continue };
            let text = find(&prompt.text);
            if !text.is_empty() {
                fields.insert("description".to_owned(), text.into());
            }
            let (range, words) = match &prompt.scale {
                Scale::Points { least, greatest, labels } => (Some((*least, *greatest)), labels.as_slice()),
                Scale::Options { options } => (None, options.as_slice()),
                Scale::Number { least, greatest } => (Some((*least, *greatest)), &[][..]),
                Scale::Text { .. } => (None, &[][..]),
            };
            if let Some((least, greatest)) = range {
                fields.insert("minValue".to_owned(), least.into());
                fields.insert("maxValue".to_owned(), greatest.into());
            }
            if !words.is_empty() {
                let level = |(value, words): &(i64, _)| json!({ "@type": "PropertyValue", "value": value, "name": find(words) });
                fields
                    .insert("valueReference".to_owned(), words.iter().map(level).collect::<Vec<_>>().into());
            }
            found.push(one);
        }
    }
    Ok(found)
}

/// Names of the questions that a part asks.
fn groups_of(part: &Part) -> Vec<&str> {
    match part {
        Part::Form(form) => form.ask.0.iter().map(String::as_str).collect(),
        Part::Trials(trials) => {
            let after = trials.after_block.iter().flat_map(|names| &names.0);
            trials.ask.0.iter().chain(after).map(String::as_str).collect()
        }
        _ => Vec::new(),
    }
}

/// The fronts of a study in words.
pub(super) fn fronts<'f>(fronts: impl Iterator<Item = &'f Front>) -> String {
    fronts.map(name).collect::<Vec<_>>().join(", ")
}
