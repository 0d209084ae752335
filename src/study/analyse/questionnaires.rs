//! Scores of questionnaires, and what changes between two of the same.

use super::common::{CONFIDENCE, Error};
use crate::statistics::icc::{Cronbach, cronbach};
use crate::statistics::wilcoxon::{Options, Shift, Wilcoxon, shift, wilcoxon};
use crate::statistics::{Adjustment, Description, adjust, describe};
use crate::study::file::{Part, StudyFile};
use crate::study::instrument::Instrument;
use crate::study::tables::{Answer, Tables};
use serde::Serialize;
use std::collections::BTreeMap;

/// One questionnaire of a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Questionnaire {
    /// Its id, such as `ssq`.
    pub questionnaire: String,
    /// Its title, in the first language.
    pub title: String,
    /// Named variants of scoring that the study file chose.
    pub variants: Vec<String>,
    /// Scores wherever it was asked, in the order of the flow.
    pub pages: Vec<PageScores>,
    /// Changes from the first form that asks it to each later one.
    pub changes: Vec<Change>,
}

/// Scores of a questionnaire at one place of the flow.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PageScores {
    /// The part.
    pub part: String,
    /// The page, or scene and condition where it follows a trial.
    pub page: String,
    /// Participants that answered all items.
    pub people: usize,
    /// Participants that answered some items only; they have no scores.
    pub incomplete: usize,
    /// The scores, in the order of the questionnaire.
    pub scores: Vec<Score>,
}

/// One score over participants.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Score {
    /// Its name, such as `total`.
    pub score: String,
    /// Its values; none without a complete participant.
    pub values: Option<Description>,
    /// Cronbach's alpha of its items with a 95 % interval; none where it does not exist.
    pub alpha: Option<Cronbach>,
}

/// What a score changes by, from one form to a later one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Change {
    /// The score.
    pub score: String,
    /// The part of the first form.
    pub before: String,
    /// The part of the later form.
    pub after: String,
    /// Participants with both scores.
    pub people: usize,
    /// The test; none without such a participant.
    pub test: Option<ChangeTest>,
}

/// A change over participants. Differences are after less before.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChangeTest {
    /// The differences.
    pub difference: Description,
    /// Wilcoxon's signed ranks.
    pub wilcoxon: Wilcoxon,
    /// p by Holm over all changes of the questionnaire.
    pub p_holm: f64,
    /// The Hodges-Lehmann estimate of the difference with its 95 % interval.
    pub shift: Shift,
}

/// A score of one participant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScoreRow {
    /// The participant.
    pub participant: String,
    /// The part.
    pub part: String,
    /// The page.
    pub page: String,
    /// The questionnaire.
    pub questionnaire: String,
    /// The score.
    pub score: String,
    /// Its value.
    pub value: f64,
}

/// Where a questionnaire was filled in: place of the part in the flow, then the name of the page in an order that people expect.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    step: usize,
    number: u32,
    page: String,
}

/// One filled-in questionnaire.
struct Sheet<'t> {
    participant: &'t str,
    page: &'t str,
    answers: BTreeMap<String, i64>,
}

/// A questionnaire with all that was filled in.
struct Filled<'t> {
    instrument: Instrument,
    variants: Vec<String>,
    sheets: BTreeMap<Place, Vec<Sheet<'t>>>,
}

/// The scores of all questionnaires that the parts of a study ask.
pub(super) fn questionnaires(study: &StudyFile, tables: &Tables) -> Result<Vec<Questionnaire>, Error> {
    asked(study)?.into_iter().map(|instrument| filled(study, tables, instrument).block(study)).collect()
}

/// The scores of each participant, wherever a questionnaire was filled in whole; by questionnaire, place, then participant.
///
/// # Errors
/// [`Error::Study`] for an answer off the scale or an unknown variant of scoring.
pub fn scores(study: &StudyFile, tables: &Tables) -> Result<Vec<ScoreRow>, Error> {
    let mut rows = Vec::new();
    for instrument in asked(study)? {
        let filled = filled(study, tables, instrument);
        for (place, sheets) in &filled.sheets {
            for sheet in sheets.iter().filter(|sheet| filled.is_whole(sheet)) {
                for (score, value) in filled.instrument.score(&sheet.answers, &filled.variants)? {
                    rows.push(ScoreRow {
                        participant: sheet.participant.to_owned(),
                        part: study.study.flow[place.step].clone(),
                        page: sheet.page.to_owned(),
                        questionnaire: filled.instrument.id.clone(),
                        score,
                        value,
                    });
                }
            }
        }
    }
    Ok(rows)
}

/// The questionnaires that the parts of the flow ask, in its order. A question of the file hides a questionnaire of its name.
fn asked(study: &StudyFile) -> Result<Vec<Instrument>, Error> {
    let mut found: Vec<Instrument> = Vec::new();
    for part in study.study.flow.iter().filter_map(|name| study.parts.get(name)) {
        let names = match part {
            Part::Form(form) => form.ask.0.iter().collect(),
            Part::Trials(trials) if trials.counted => {
                trials.ask.0.iter().chain(trials.after_block.iter().flat_map(|names| &names.0)).collect()
            }
            _ => Vec::new(),
        };
        for name in names {
            if study.questions.contains_key(name) || found.iter().any(|one| one.id == *name) {
                continue;
            }
            found.extend(Instrument::builtin(name)?);
        }
    }
    Ok(found)
}

fn filled<'t>(study: &StudyFile, tables: &'t Tables, instrument: Instrument) -> Filled<'t> {
    let variants = study.analysis.scoring.get(&instrument.id).map(|scoring| scoring.variants.clone());
    let is_practice = |part: &Part| part.trials().is_some_and(|trials| !trials.counted);
    let mut sheets: BTreeMap<Place, Vec<Sheet<'t>>> = BTreeMap::new();
    for row in &tables.answers {
        let item = row.question.strip_prefix(&instrument.id).and_then(|rest| rest.strip_prefix('.'));
        let step = study.study.flow.iter().position(|name| *name == row.part);
        let (Some(item), Some(step), Some(value)) = (item, step, row.number()) else { continue };
        let is_counted = row.trial.is_none() || row.is_ordinary();
        if !is_counted || study.parts.get(&row.part).is_some_and(is_practice) {
            continue;
        }
        let group = sheets.entry(place(step, row)).or_default();
        let is_same = |sheet: &&mut Sheet<'_>| sheet.participant == row.participant && sheet.page == row.page;
        match group.iter_mut().rev().find(is_same) {
            Some(sheet) => {
                sheet.answers.insert(item.to_owned(), value);
            }
            None => group.push(Sheet {
                participant: &row.participant,
                page: &row.page,
                answers: BTreeMap::from([(item.to_owned(), value)]),
            }),
        }
    }
    Filled { instrument, variants: variants.unwrap_or_default(), sheets }
}

fn place(step: usize, row: &Answer) -> Place {
    if row.trial.is_some() {
        let shown =
            [&row.shown.gait, &row.shown.scene, &row.shown.emotion, &row.shown.body, &row.shown.condition];
        let page = shown.into_iter().flatten().cloned().collect::<Vec<_>>().join(" ");
        return Place { step, number: 0, page };
    }
    let number = row.page.rsplit('/').next().and_then(|last| last.parse().ok()).unwrap_or(0);
    Place { step, number, page: row.page.clone() }
}

impl Filled<'_> {
    fn is_whole(&self, sheet: &Sheet<'_>) -> bool {
        self.instrument.items.iter().all(|item| sheet.answers.contains_key(&item.id))
    }

    fn block(&self, study: &StudyFile) -> Result<Questionnaire, Error> {
        let languages = &study.study.languages;
        let preferred = languages.first().map_or("", String::as_str);
        let pages = self.sheets.iter().map(|(place, sheets)| self.page(study, place, sheets));
        Ok(Questionnaire {
            questionnaire: self.instrument.id.clone(),
            title: self.instrument.title.find(preferred, languages).to_owned(),
            variants: self.variants.clone(),
            pages: pages.collect::<Result<_, _>>()?,
            changes: self.changes(study)?,
        })
    }

    fn page(&self, study: &StudyFile, place: &Place, sheets: &[Sheet<'_>]) -> Result<PageScores, Error> {
        let whole: Vec<&Sheet<'_>> = sheets.iter().filter(|sheet| self.is_whole(sheet)).collect();
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); self.instrument.scores.len()];
        for sheet in &whole {
            let scores = self.instrument.score(&sheet.answers, &self.variants)?;
            values.iter_mut().zip(scores).for_each(|(values, (_, value))| values.push(value));
        }
        let scores = self.instrument.scores.iter().zip(&values).map(|(score, values)| Score {
            score: score.id.clone(),
            values: describe(values).ok(),
            alpha: cronbach(&self.items_of(score, &whole), CONFIDENCE).ok(),
        });
        Ok(PageScores {
            part: study.study.flow[place.step].clone(),
            page: place.page.clone(),
            people: whole.len(),
            incomplete: sheets.len() - whole.len(),
            scores: scores.collect(),
        })
    }

    /// `[participant][item]` of a score, reversed items turned.
    fn items_of(&self, score: &crate::study::instrument::Score, whole: &[&Sheet<'_>]) -> Vec<Vec<f64>> {
        let left_out = |item: &String| {
            self.variants.iter().any(|name| score.without.get(name).is_some_and(|items| items.contains(item)))
        };
        let items: Vec<&String> = score.items.iter().filter(|item| !left_out(item)).collect();
        let value = |sheet: &Sheet<'_>, item: &str| {
            let given = sheet.answers.get(item).copied().unwrap_or_default();
            let is_reversed = self.instrument.items.iter().any(|one| one.id == item && one.reversed);
            let ends = self.instrument.least + self.instrument.greatest;
            #[allow(clippy::cast_precision_loss, reason = "answers are small")]
            let value = (if is_reversed { ends - given } else { given }) as f64;
            value
        };
        whole.iter().map(|sheet| items.iter().map(|item| value(sheet, item)).collect()).collect()
    }

    /// Changes from the first form to each later one.
    fn changes(&self, study: &StudyFile) -> Result<Vec<Change>, Error> {
        let is_form = |place: &Place| {
            study.parts.get(&study.study.flow[place.step]).is_some_and(|part| matches!(part, Part::Form(_)))
        };
        let mut forms = self.sheets.iter().filter(|(place, _)| is_form(place));
        let Some((first, before)) = forms.next() else { return Ok(Vec::new()) };
        let mut changes = Vec::new();
        for (place, after) in forms {
            for (index, score) in self.instrument.scores.iter().enumerate() {
                let differences = self.differences(before, after, index)?;
                changes.push(Change {
                    score: score.id.clone(),
                    before: study.study.flow[first.step].clone(),
                    after: study.study.flow[place.step].clone(),
                    people: differences.len(),
                    test: self.test(&differences)?,
                });
            }
        }
        let mut tests: Vec<&mut ChangeTest> =
            changes.iter_mut().filter_map(|one| one.test.as_mut()).collect();
        let p: Vec<f64> = tests.iter().map(|test| test.wilcoxon.p).collect();
        let holm = adjust(&p, Adjustment::Holm).map_err(|source| self.wrong(source))?;
        for (test, p) in tests.iter_mut().zip(holm) {
            test.p_holm = p;
        }
        Ok(changes)
    }

    /// A score after less the same before, of each participant with both.
    fn differences(
        &self,
        before: &[Sheet<'_>],
        after: &[Sheet<'_>],
        index: usize,
    ) -> Result<Vec<f64>, Error> {
        let of = |sheet: &Sheet<'_>| -> Result<f64, Error> {
            let scores = self.instrument.score(&sheet.answers, &self.variants)?;
            Ok(scores.get(index).map_or(f64::NAN, |(_, value)| *value))
        };
        let mut differences = Vec::new();
        for sheet in after.iter().filter(|sheet| self.is_whole(sheet)) {
            let is_same = |one: &&Sheet<'_>| one.participant == sheet.participant && self.is_whole(one);
            if let Some(first) = before.iter().find(is_same) {
                differences.push(of(sheet)? - of(first)?);
            }
        }
        Ok(differences)
    }

    fn test(&self, differences: &[f64]) -> Result<Option<ChangeTest>, Error> {
        if differences.is_empty() {
            return Ok(None);
        }
        let wrong = |source| self.wrong(source);
        let wilcoxon = wilcoxon(differences, Options::default()).map_err(wrong)?;
        Ok(Some(ChangeTest {
            difference: describe(differences).map_err(wrong)?,
            // over all changes, once they are there
            p_holm: wilcoxon.p,
            wilcoxon,
            shift: shift(differences, CONFIDENCE).map_err(wrong)?,
        }))
    }

    fn wrong(&self, source: crate::statistics::Error) -> Error {
        Error::Statistics { test: format!("questionnaire {}", self.instrument.id), source }
    }
}
