//! A study made ready.

use super::draw::{Purpose, random, word};
use super::questions::{Prompt, Scale, prompts};
use super::trials::Stimulus;
use crate::random::Random;
use crate::spelling::suggestion;
use crate::study::asked::words;
use crate::study::error::Error;
use crate::study::file::{
    Check, Codes, Design, Front, Names, OnWithdrawal, Part, Question, Seeds, Show, StudyFile, Trials,
};
use crate::study::materials::Materials;
use crate::study::words::Words;

/// The name of the step that is no part.
pub(crate) const CONSENT: &str = "consent";

/// A study made ready: what [`page`](crate::study::protocol::page) and [`Ledger`](super::Ledger) need.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Name of the study.
    pub id: String,
    /// Version of its file.
    pub version: u32,
    /// Seed of every draw.
    pub seed: u64,
    /// Key of the names of stimuli. Set it to random bits that no participant knows: with the seed alone, which files carry, names
    /// could be computed.
    pub secret: u64,
    /// Languages; the first is the one that others fall back to.
    pub languages: Vec<String>,
    /// Whether participants may see clips that were made before.
    pub(super) shows_clips: bool,
    /// The steps in order.
    pub steps: Vec<Step>,
    /// Longest silence before a place is given to another participant, ms.
    pub lease_ms: i64,
    /// Most participants that are under way or finished at a time.
    pub most_participants: u32,
    /// What becomes of the answers of a participant who withdraws.
    pub on_withdrawal: OnWithdrawal,
    /// The platform's codes.
    codes: Codes,
}

/// How a participation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// Every page was answered.
    Finished,
    /// The participant did not agree.
    Declined,
    /// The participant withdrew.
    Withdrawn,
    /// The check was failed too often.
    ScreenedOut,
    /// The operator excluded the participant; answers stay.
    Excluded,
    /// There is no place now. The only ending that another event may undo.
    Full,
}

/// A step of the flow.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Name of the part, or `consent`.
    pub name: String,
    /// What it is.
    pub kind: StepKind,
}

/// What a step is.
#[derive(Debug, Clone, PartialEq)]
pub enum StepKind {
    /// A text to agree to: its file, and the youngest age, years.
    Consent {
        /// Name of the file.
        text: Words,
        /// Youngest age, years.
        minimum_age: u32,
    },
    /// A text.
    Text(Words),
    /// A form.
    Form(Vec<Prompt>),
    /// Questions with right answers.
    Check {
        /// How often they may be answered.
        attempts: u32,
        /// The questions.
        prompts: Vec<Prompt>,
        /// Index of the right answer of each.
        right: Vec<i64>,
    },
    /// Trials.
    Trials(Box<TrialsStep>),
}

/// How a stimulus is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Shows {
    /// How long, s.
    pub seconds: f64,
    /// How often.
    pub plays: u32,
    /// Whether it may be played again.
    pub replay: bool,
}

/// Trials made ready.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialsStep {
    /// How stimuli are shown.
    pub shows: Shows,
    /// All stimuli. Of scenes the conditions follow one another first: item = scene x conditions + condition.
    pub stimuli: Vec<Stimulus>,
    /// Number of conditions of scenes.
    pub conditions: usize,
    /// Who gets what.
    pub design: Option<Design>,
    /// Whether answers count.
    pub counted: bool,
    /// Stimuli that are shown again.
    pub repeat: u32,
    /// Instructed trials.
    pub catches: u32,
    /// What they say, with `{answer}`.
    pub instruction: Words,
    /// How trials are seeded.
    pub seeds: Seeds,
    /// What is asked after each stimulus.
    pub prompts: Vec<Prompt>,
    /// What is asked after each block.
    pub after_block: Vec<Prompt>,
    /// A rest after each so many blocks.
    pub rest_after_blocks: Option<u32>,
}

impl TrialsStep {
    /// Whether participants get their trials in blocks.
    pub(super) const fn is_in_blocks(&self) -> bool {
        matches!(self.design, Some(Design::Blocks { .. }))
    }

    /// An answer that every statement of an instructed trial can have, but not the middle one; none if there are no points.
    pub(super) fn instructed_answer(&self, random: &mut Random) -> Option<i64> {
        let scales = self.prompts.iter().map(|prompt| &prompt.scale);
        let ends = scales.filter_map(|scale| match scale {
            Scale::Points { least, greatest, .. } => Some((*least, *greatest)),
            _ => None,
        });
        let (least, greatest) = ends.reduce(|a, b| (a.0.max(b.0), a.1.min(b.1)))?;
        let values: Vec<i64> = (least..=greatest).filter(|value| 2 * value != least + greatest).collect();
        values.get(random.below(values.len())).copied()
    }
}

impl Plan {
    /// Makes a study ready. Values are assumed to be [checked](fn@crate::study::check).
    ///
    /// # Errors
    /// [`Error::Value`] for a name that nothing has, or a library that `materials` lack.
    pub fn of(file: &StudyFile, materials: &Materials) -> Result<Self, Error> {
        let step = |(index, name): (usize, &String)| {
            let kind = if name == CONSENT {
                StepKind::Consent { text: file.consent.text.clone(), minimum_age: file.consent.minimum_age }
            } else {
                let known: Vec<&str> = file.parts.keys().map(String::as_str).chain([CONSENT]).collect();
                let unknown = || {
                    let hint = suggestion(name, &known, "there are");
                    let key = format!("study.flow[{index}]");
                    Error::value(key, format!("{name:?}"), "\"consent\" or the name of a part", hint)
                };
                kind(file, materials, name, file.parts.get(name).ok_or_else(unknown)?)?
            };
            Ok(Step { name: name.clone(), kind })
        };
        Ok(Self {
            id: file.study.id.clone(),
            version: file.study.version,
            seed: file.study.seed,
            secret: file.study.seed,
            languages: file.study.languages.clone(),
            shows_clips: file.study.fronts.contains(&Front::Web),
            steps: file.study.flow.iter().enumerate().map(step).collect::<Result<_, Error>>()?,
            lease_ms: i64::from(file.recruit.lease_minutes) * 60_000,
            most_participants: file.recruit.most_participants,
            on_withdrawal: file.consent.on_withdrawal,
            codes: file.recruit.codes.clone(),
        })
    }

    /// The platform's code for an ending, if it has one.
    pub fn code(&self, ending: Ending) -> Option<&str> {
        match ending {
            Ending::Finished => self.codes.complete.as_deref(),
            Ending::ScreenedOut => self.codes.screened_out.as_deref(),
            Ending::Withdrawn => self.codes.withdrawn.as_deref(),
            Ending::Declined | Ending::Excluded | Ending::Full => None,
        }
    }

    /// The name of a stimulus in addresses, 26 letters and digits: it tells nothing about what the stimulus shows.
    pub fn name(&self, stimulus: &Stimulus, seed: u64) -> String {
        let mut random = random(self.secret, Purpose::Names, &[word(&stimulus.key()), seed]);
        let mut bits = (u128::from(random.bits()) << 64) | u128::from(random.bits());
        let mut name = String::new();
        for _ in 0..26 {
            let digit = usize::try_from(bits & 31).unwrap_or(0);
            name.push(char::from(b"0123456789abcdefghjkmnpqrstvwxyz"[digit]));
            bits >>= 5;
        }
        name
    }

    /// Steps of counted trials, which need a place: index, name and trials.
    pub fn counted(&self) -> impl Iterator<Item = (usize, &str, &TrialsStep)> {
        self.steps.iter().enumerate().filter_map(|(index, step)| match &step.kind {
            StepKind::Trials(trials) if trials.counted => Some((index, step.name.as_str(), &**trials)),
            _ => None,
        })
    }

    /// The trials of a part; none if it has none.
    pub fn trials_of(&self, part: &str) -> Option<&TrialsStep> {
        self.steps.iter().find_map(|step| match &step.kind {
            StepKind::Trials(trials) if step.name == part => Some(&**trials),
            _ => None,
        })
    }
}

fn kind(file: &StudyFile, materials: &Materials, name: &str, part: &Part) -> Result<StepKind, Error> {
    let key = |rest: &str| format!("part.{name}.{rest}");
    Ok(match part {
        Part::Text(text) => StepKind::Text(text.text.clone()),
        Part::Form(form) => StepKind::Form(asked(file, &key("ask"), &form.ask)?),
        Part::Comprehension(check) => self::check(check),
        Part::Trials(trials) => {
            let (stimuli, conditions) = stimuli(materials, &key("show"), &trials.show)?;
            let after = trials.after_block.as_ref();
            StepKind::Trials(Box::new(TrialsStep {
                prompts: asked(file, &key("ask"), &trials.ask)?,
                after_block: after.map_or(Ok(Vec::new()), |names| asked(file, &key("after_block"), names))?,
                ..ready(&file.study.languages, trials, (stimuli, conditions))
            }))
        }
    })
}

/// Trials of these stimuli under so many conditions, before anything is asked.
fn ready(languages: &[String], trials: &Trials, (stimuli, conditions): (Vec<Stimulus>, usize)) -> TrialsStep {
    let instruction = || words(languages, |asked| &asked.instruction);
    let Show { seconds, plays, replay, .. } = trials.show;
    TrialsStep {
        shows: Shows { seconds, plays, replay },
        stimuli,
        conditions,
        design: trials.design.clone(),
        counted: trials.counted,
        repeat: trials.repeat,
        catches: trials.catches,
        instruction: trials.instruction.clone().unwrap_or_else(instruction),
        seeds: trials.seeds,
        prompts: Vec::new(),
        after_block: Vec::new(),
        rest_after_blocks: trials.rest_after_blocks,
    }
}

fn check(check: &Check) -> StepKind {
    let prompt = |(index, choice): (usize, &crate::study::file::RightChoice)| {
        let Question::Choice { text, options, order, .. } = choice.into() else { return None };
        let id = format!("question-{}", index + 1);
        let scale = Scale::Options { options: (0..).zip(options).collect() };
        let heading = Words::default();
        Some(Prompt { group: id.clone(), id, heading, text, scale, order, optional: false })
    };
    StepKind::Check {
        attempts: check.attempts,
        prompts: check.questions.iter().enumerate().filter_map(prompt).collect(),
        right: check.questions.iter().map(|q| i64::try_from(q.right).unwrap_or(i64::MAX)).collect(),
    }
}

/// The prompts of some names.
fn asked(file: &StudyFile, key: &str, names: &Names) -> Result<Vec<Prompt>, Error> {
    let mut all = Vec::new();
    for (index, name) in names.0.iter().enumerate() {
        let Some(found) = prompts(file, name)? else {
            let own = file.questions.keys().map(String::as_str);
            let known: Vec<&str> = own
                .chain(super::questions::BUILT_IN_QUESTIONS)
                .chain(crate::study::instrument::names())
                .collect();
            let hint = suggestion(name, &known, "there are");
            let key = if names.0.len() == 1 { key.to_owned() } else { format!("{key}[{index}]") };
            let allowed = "the name of a question, a questionnaire or a built-in question";
            return Err(Error::value(key, format!("{name:?}"), allowed, hint));
        };
        all.extend(found);
    }
    Ok(all)
}

/// All stimuli of what is shown, and the number of conditions.
fn stimuli(materials: &Materials, key: &str, show: &Show) -> Result<(Vec<Stimulus>, usize), Error> {
    let one = show.condition.iter().cloned().collect::<Vec<_>>();
    let conditions = show.conditions.as_ref().unwrap_or(&one);
    if let Some(library) = &show.gaits {
        let Some(gaits) = materials.gaits.get(library) else {
            let key = format!("{key}.gaits");
            let hint = "put the library beside the study file, or write practice for the built-in examples";
            return Err(Error::value(key, format!("{library:?}"), "a library of gaits that is there", hint));
        };
        return Ok((gaits.iter().map(|gait| Stimulus::Gait { gait: gait.clone() }).collect(), 0));
    }
    if let Some(scenes) = &show.scenes {
        let of = |scene: &String| {
            let scene = scene.clone();
            conditions
                .iter()
                .map(move |condition| Stimulus::Scene { scene: scene.clone(), condition: condition.clone() })
        };
        return Ok((scenes.iter().flat_map(of).collect(), conditions.len()));
    }
    let Some(agents) = &show.agents else {
        let hint = "add gaits, scenes or agents to it";
        return Err(Error::value(key, "{..}", "one of gaits, scenes and agents", hint));
    };
    let condition = conditions.first().cloned().unwrap_or_default();
    let of = |emotion: &String| {
        let (emotion, condition) = (emotion.clone(), condition.clone());
        agents.bodies.iter().map(move |body| Stimulus::Agent {
            emotion: emotion.clone(),
            body: body.clone(),
            condition: condition.clone(),
        })
    };
    Ok((agents.each_of.iter().flat_map(of).collect(), conditions.len()))
}
