//! Ratings of gaits: means and labels by the rule of `gait ratings`, and how far they can be relied on.

use super::common::{CONFIDENCE, DRAWS, Error, bad, real, trials};
use crate::emotion::Emotion;
use crate::perception::ratings::{self, Analysis, label};
use crate::statistics::icc::{IccModels, icc};
use crate::statistics::kappa::{SelfAgreement, self_agreement};
use crate::statistics::stability::label_stability;
use crate::study::file::{Question, RATING_POINTS, StudyFile};
use crate::study::tables::{self, Role, Tables};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// The ratings of a study, evaluated.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RatingBlock {
    /// The part whose answers are ratings.
    pub part: String,
    /// The question about the four emotions.
    pub question: String,
    /// Means, labels, correlations and agreement, as `gait ratings` gives them; none without a rating.
    pub analysis: Option<Analysis>,
    /// Intraclass correlations of all six kinds for each emotion; none unless every rater rated every gait.
    pub complete: Option<[Option<IccModels>; 4]>,
    /// How far raters agree with themselves on gaits shown twice, for each emotion; none without such a gait.
    pub repeats: Option<[SelfAgreement; 4]>,
    /// How stable labels are; none without a rating.
    pub stability: Option<LabelStability>,
}

/// Whether labels depend on which raters answered.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LabelStability {
    /// Number of resamples of the raters of each gait.
    pub draws: usize,
    /// Mean share of resamples in which a label stays.
    pub mean: f64,
    /// Gaits whose label stays in 95 % of resamples or more.
    pub stable: usize,
    /// The share of each gait.
    pub gaits: BTreeMap<String, f64>,
}

/// The ratings, made ready from the study file.
pub(super) struct Planned<'s> {
    part: &'s str,
    question: &'s str,
    theta: f64,
    seed: u64,
}

impl<'s> Planned<'s> {
    /// None unless the file asks for ratings.
    pub(super) fn new(study: &'s StudyFile) -> Result<Option<Self>, Error> {
        let Some(asked) = &study.analysis.ratings else { return Ok(None) };
        let key = "analysis.ratings.part";
        let trials = trials(study, "analysis.ratings", &asked.part)?;
        if trials.show.gaits.is_none() {
            return Err(bad(key, &asked.part, "a part that shows gaits", "only gaits are rated"));
        }
        let is_rating = |name: &&String| study.questions.get(*name).is_some_and(Question::rates_emotions);
        let Some(question) = trials.ask.0.iter().find(is_rating) else {
            let allowed = "a part that asks how happy, angry, sad and neutral a gait looks, 1 to 5";
            return Err(bad(key, &asked.part, allowed, "a likert question of these four items is missing"));
        };
        let (part, question) = (asked.part.as_str(), question.as_str());
        Ok(Some(Self { part, question, theta: asked.theta, seed: study.study.seed }))
    }

    /// The sheet that `gait ratings` reads.
    pub(super) fn sheet(&self, tables: &Tables) -> String {
        tables::ratings(tables, self.part, self.question)
    }

    pub(super) fn block(&self, tables: &Tables) -> Result<RatingBlock, Error> {
        let sheet = self.sheet(tables);
        let responses = if sheet.lines().count() < 2 {
            Vec::new()
        } else {
            ratings::parse(&sheet, "ratings", &ratings::Options::default())?.responses
        };
        let mut units: BTreeMap<String, Vec<[u8; 4]>> = BTreeMap::new();
        for response in &responses {
            units.entry(response.video.clone()).or_default().push(response.scores);
        }
        let is_empty = responses.is_empty();
        Ok(RatingBlock {
            part: self.part.to_owned(),
            question: self.question.to_owned(),
            analysis: (!is_empty).then(|| ratings::analyse(&responses, self.theta)),
            complete: complete(&responses),
            repeats: self.repeats(tables)?,
            stability: if is_empty { None } else { Some(self.stability(&units)?) },
        })
    }

    fn stability(&self, units: &BTreeMap<String, Vec<[u8; 4]>>) -> Result<LabelStability, Error> {
        let theta = self.theta;
        let of = |answers: &[&[u8; 4]]| {
            let sum = |emotion: usize| answers.iter().map(|scores| f64::from(scores[emotion])).sum::<f64>();
            label(std::array::from_fn(|emotion| sum(emotion) / real(answers.len())), theta).0
        };
        let answers: Vec<Vec<[u8; 4]>> = units.values().cloned().collect();
        let found = label_stability(&answers, of, DRAWS, self.seed).map_err(wrong)?;
        let stable = found.units.iter().filter(|&&share| share >= CONFIDENCE).count();
        let gaits = units.keys().cloned().zip(found.units).collect();
        Ok(LabelStability { draws: DRAWS, mean: found.mean, stable, gaits })
    }

    /// First and second answers of one rater to one gait.
    fn repeats(&self, tables: &Tables) -> Result<Option<[SelfAgreement; 4]>, Error> {
        let mut first: BTreeMap<[&str; 3], i64> = BTreeMap::new();
        let ours = || tables.answers.iter().filter(|row| row.part == self.part);
        let key = |row: &'_ tables::Answer| -> Option<(usize, i64)> {
            let item = row.question.strip_prefix(self.question)?.strip_prefix('.')?;
            Some((item.parse::<Emotion>().ok()?.index(), row.number()?))
        };
        for row in ours().filter(|row| row.is_ordinary()) {
            let (Some((_, value)), Some(gait)) = (key(row), row.shown.gait.as_deref()) else { continue };
            first.insert([&row.participant, gait, &row.question], value);
        }
        let mut pairs: [Vec<[u8; 2]>; 4] = Default::default();
        for row in ours().filter(|row| row.trial.is_some_and(|trial| trial.role == Role::Repeat)) {
            let (Some((emotion, second)), Some(gait)) = (key(row), row.shown.gait.as_deref()) else {
                continue;
            };
            let Some(&first) = first.get(&[row.participant.as_str(), gait, row.question.as_str()]) else {
                continue;
            };
            let point = |value: i64| u8::try_from(value).unwrap_or(0);
            pairs[emotion].push([point(first), point(second)]);
        }
        if pairs.iter().any(Vec::is_empty) {
            return Ok(None);
        }
        let points = u8::try_from(RATING_POINTS).unwrap_or(u8::MAX);
        let [happy, angry, sad, neutral] = pairs.map(|pairs| self_agreement(&pairs, points).map_err(wrong));
        Ok(Some([happy?, angry?, sad?, neutral?]))
    }
}

/// The six intraclass correlations for each emotion, where every rater rated every gait once.
fn complete(responses: &[ratings::Response]) -> Option<[Option<IccModels>; 4]> {
    let mut table: BTreeMap<(&str, &str), [u8; 4]> = BTreeMap::new();
    let (mut gaits, mut raters) = (BTreeSet::new(), BTreeSet::new());
    for response in responses {
        gaits.insert(response.video.as_str());
        raters.insert(response.participant.as_str());
        table.insert((&response.video, &response.participant), response.scores);
    }
    if table.is_empty() || table.len() != gaits.len() * raters.len() || table.len() != responses.len() {
        return None;
    }
    Some(Emotion::ALL.map(|emotion| {
        let score = |gait: &str, rater: &str| {
            table.get(&(gait, rater)).map_or(f64::NAN, |scores| f64::from(scores[emotion.index()]))
        };
        let row = |gait: &&str| raters.iter().map(|rater| score(gait, rater)).collect::<Vec<f64>>();
        icc(&gaits.iter().map(row).collect::<Vec<_>>(), CONFIDENCE).ok()
    }))
}

fn wrong(source: crate::statistics::Error) -> Error {
    Error::Statistics { test: "analysis.ratings".to_owned(), source }
}
