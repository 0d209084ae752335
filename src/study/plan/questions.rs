//! Questions spelled out: one prompt for every answer.

use crate::study::asked::{Asked, words};
use crate::study::error::Error;
use crate::study::file::{ItemOrder, Question, StudyFile};
use crate::study::instrument::Instrument;
use crate::study::words::Words;
use serde::{Deserialize, Serialize};

/// The questions that every study has without writing them; a study may word them itself.
pub const BUILT_IN_QUESTIONS: [&str; 2] = ["gender", "age"];

/// What can be answered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "scale", rename_all = "kebab-case")]
pub enum Scale<T> {
    /// A number from `least` to `greatest`, with words for some.
    Points {
        /// Least.
        least: i64,
        /// Greatest.
        greatest: i64,
        /// Words by number.
        labels: Vec<(i64, T)>,
    },
    /// One of several: index and text.
    Options {
        /// What to choose from, in the order in which it is shown.
        options: Vec<(i64, T)>,
    },
    /// A whole number that is written.
    Number {
        /// Least.
        least: i64,
        /// Greatest.
        greatest: i64,
    },
    /// Free text.
    Text {
        /// Most characters.
        most: u32,
    },
}

impl<T> Scale<T> {
    /// Whether a number is an answer on it.
    pub fn allows(&self, value: i64) -> bool {
        match self {
            Self::Points { least, greatest, .. } | Self::Number { least, greatest } => {
                (*least..=*greatest).contains(&value)
            }
            Self::Options { options } => options.iter().any(|(index, _)| *index == value),
            Self::Text { .. } => false,
        }
    }
}

/// One question that takes one answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Prompt {
    /// Name in tables: `emotions.happy`, `which`, `ssq.nausea`.
    pub id: String,
    /// The question that it belongs to: `emotions`.
    pub group: String,
    /// What stands above the group.
    pub heading: Words,
    /// The question or statement.
    pub text: Words,
    /// What can be answered.
    pub scale: Scale<Words>,
    /// Order of the group's prompts, or of its options.
    pub order: ItemOrder,
    /// Whether it may be left out.
    pub optional: bool,
}

/// The prompts of a name that a part asks: a question of the file, a questionnaire or a built-in question. None if nothing has
/// the name.
///
/// # Errors
/// [`Error::Syntax`] if a built-in questionnaire cannot be read, which a test excludes.
pub(crate) fn prompts(file: &StudyFile, name: &str) -> Result<Option<Vec<Prompt>>, Error> {
    if let Some(question) = file.questions.get(name) {
        return Ok(Some(of_question(name, question)));
    }
    if let Some(instrument) = Instrument::builtin(name)? {
        return Ok(Some(of_instrument(file, &instrument)));
    }
    Ok(built_in(&file.study.languages, name).map(|question| of_question(name, &question)))
}

/// The questions of [`BUILT_IN_QUESTIONS`].
fn built_in(languages: &[String], name: &str) -> Option<Question> {
    let say = |text: fn(&Asked) -> &String| words(languages, text);
    match name {
        "gender" => Some(Question::Choice {
            text: say(|asked| &asked.gender),
            options: vec![
                say(|asked| &asked.woman),
                say(|asked| &asked.man),
                say(|asked| &asked.another),
                say(|asked| &asked.not_said),
            ],
            order: ItemOrder::Fixed,
            optional: true,
        }),
        "age" => {
            Some(Question::Number { text: say(|asked| &asked.age), least: 0, greatest: 120, optional: true })
        }
        _ => None,
    }
}

fn of_question(name: &str, question: &Question) -> Vec<Prompt> {
    let one = |text: &Words, scale, order, optional| {
        let optional = optional || BUILT_IN_QUESTIONS.contains(&name);
        let (id, group) = (name.to_owned(), name.to_owned());
        vec![Prompt { id, group, heading: Words::default(), text: text.clone(), scale, order, optional }]
    };
    match question {
        Question::Likert { text, order, points, items, optional } => {
            let (least, greatest) = points.ends().unwrap_or((0, 0));
            let labels = points.labels().into_iter().map(|(point, text)| (point, text.clone())).collect();
            let scale = Scale::Points { least, greatest, labels };
            let prompt = |item: &crate::study::file::LikertItem| Prompt {
                id: format!("{name}.{}", item.id),
                group: name.to_owned(),
                heading: text.clone(),
                text: item.text.clone(),
                scale: scale.clone(),
                order: *order,
                optional: *optional,
            };
            items.iter().map(prompt).collect()
        }
        Question::Choice { text, options, order, optional } => {
            let options = (0..).zip(options.iter().cloned()).collect();
            one(text, Scale::Options { options }, *order, *optional)
        }
        Question::Number { text, least, greatest, optional } => {
            one(text, Scale::Number { least: *least, greatest: *greatest }, ItemOrder::Fixed, *optional)
        }
        Question::Text { text, most } => one(text, Scale::Text { most: *most }, ItemOrder::Fixed, true),
    }
}

fn of_instrument(file: &StudyFile, instrument: &Instrument) -> Vec<Prompt> {
    let written = file.wording.get(&instrument.id);
    let labels: Vec<(i64, Words)> = instrument
        .labels
        .iter()
        .filter_map(|(point, text)| Some((point.parse().ok()?, text.clone())))
        .collect();
    let (least, greatest) = (instrument.least, instrument.greatest);
    let prompt = |item: &crate::study::instrument::InstrumentItem| Prompt {
        id: format!("{}.{}", instrument.id, item.id),
        group: instrument.id.clone(),
        heading: instrument.title.clone(),
        text: written
            .and_then(|texts| texts.get(&item.id))
            .or(item.text.as_ref())
            .cloned()
            .unwrap_or_default(),
        scale: Scale::Points { least, greatest, labels: labels.clone() },
        order: ItemOrder::Fixed,
        optional: false,
    };
    instrument.items.iter().map(prompt).collect()
}
