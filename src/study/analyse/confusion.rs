//! The confusion matrix of an identification task.

use super::common::{CONFIDENCE, DRAWS, Error, bad, trials};
use super::parts;
use crate::statistics::confusion::{Confusion, OverPeople, accuracy_over_people, confusion};
use crate::study::file::{Question, StudyFile};
use crate::study::tables::Tables;
use crate::study::words::Words;
use serde::Serialize;
use std::collections::BTreeMap;

/// What was shown and what was answered.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConfusionBlock {
    /// `PART.QUESTION`, as the file says it.
    pub of: String,
    /// The options, in the order of the file, in the first language.
    pub classes: Vec<String>,
    /// Counts, `[shown][answered]`.
    pub counts: Vec<Vec<u64>>,
    /// Participants with an answer.
    pub people: usize,
    /// The plan's least participants, if there are fewer.
    pub short_of: Option<usize>,
    /// What the matrix says; none without an answer.
    pub statistics: Option<Confusion>,
    /// Accuracy with a 95 % interval by a bootstrap over people; none without an answer.
    pub over_people: Option<OverPeople>,
}

/// A confusion matrix, made ready from the study file.
pub(super) struct Planned<'s> {
    key: String,
    of: String,
    part: &'s str,
    question: &'s str,
    classes: Vec<String>,
    /// Index of the option of each emotion that is shown.
    shown: BTreeMap<&'s str, usize>,
    least: usize,
}

impl<'s> Planned<'s> {
    pub(super) fn new(study: &'s StudyFile, key: &str, of: &'s str) -> Result<Self, Error> {
        let of_key = format!("{key}.of");
        let Some((part, question)) = of.split_once('.') else {
            return Err(bad(&of_key, of, "PART.QUESTION", "the question is a choice"));
        };
        let trials = trials(study, key, part)?;
        let Some(agents) = &trials.show.agents else {
            let hint = "only single agents show one emotion each";
            return Err(bad(&of_key, of, "of a part that shows agents", hint));
        };
        let Some(Question::Choice { options, .. }) = study.questions.get(question) else {
            return Err(bad(&of_key, of, "of a question with options", "its kind is choice"));
        };
        let mut shown = BTreeMap::new();
        for emotion in &agents.each_of {
            let Some(index) = options.iter().position(|option| says(option, emotion)) else {
                let allowed = "an option of the question";
                let hint = format!("name an option of {question} so in one of its languages");
                return Err(bad(&format!("part.{part}.show.agents.each_of"), emotion, allowed, hint));
            };
            shown.insert(emotion.as_str(), index);
        }
        let languages = &study.study.languages;
        let preferred = languages.first().map_or("", String::as_str);
        Ok(Self {
            key: key.to_owned(),
            of: of.to_owned(),
            part,
            question,
            classes: options.iter().map(|option| option.find(preferred, languages).to_owned()).collect(),
            shown,
            least: parts::least(trials),
        })
    }

    /// The matrix of these tables.
    pub(super) fn block(&self, tables: &Tables, seed: u64) -> Result<ConfusionBlock, Error> {
        let mut people: BTreeMap<&str, Vec<[usize; 2]>> = BTreeMap::new();
        let mut counts = vec![vec![0; self.classes.len()]; self.classes.len()];
        let is_ours = |row: &&crate::study::tables::Answer| {
            row.part == self.part && row.question == self.question && row.is_ordinary()
        };
        for row in tables.answers.iter().filter(is_ours) {
            let Some(value) = row.number() else { continue };
            let emotion = row.shown.emotion.as_deref().unwrap_or_default();
            let Some(&shown) = self.shown.get(emotion) else {
                let known: Vec<&str> = self.shown.keys().copied().collect();
                let hint = format!("participant {}, page {}", row.participant, row.page);
                return Err(bad("emotion", emotion, known.join(", "), hint));
            };
            let answered = usize::try_from(value).ok().filter(|&index| index < self.classes.len());
            let Some(answered) = answered else {
                let allowed = format!("0 to {}", self.classes.len().saturating_sub(1));
                let hint = format!("participant {}, page {}", row.participant, row.page);
                return Err(bad("value", &value.to_string(), allowed, hint));
            };
            counts[shown][answered] += 1;
            people.entry(&row.participant).or_default().push([shown, answered]);
        }
        let wrong = |source| Error::Statistics { test: self.key.clone(), source };
        let each: Vec<Vec<[usize; 2]>> = people.into_values().collect();
        let has_answers = !each.is_empty();
        Ok(ConfusionBlock {
            of: self.of.clone(),
            classes: self.classes.clone(),
            people: each.len(),
            short_of: (each.len() < self.least).then_some(self.least),
            statistics: has_answers.then(|| confusion(&counts)).transpose().map_err(wrong)?,
            over_people: has_answers
                .then(|| accuracy_over_people(&each, DRAWS, CONFIDENCE, seed))
                .transpose()
                .map_err(wrong)?,
            counts,
        })
    }
}

/// Whether an option says a word in any language; case does not matter.
fn says(option: &Words, word: &str) -> bool {
    let is_it = |text: &String| text.trim().to_lowercase() == word.to_lowercase();
    match option {
        Words::Same(text) => is_it(text),
        Words::By(texts) => texts.values().any(is_it),
    }
}
