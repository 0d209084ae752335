//! Friedman tests of a study, one an item and a scene, with what follows them.

use super::common::{CONFIDENCE, DRAWS, Error, bad, real, trials};
use super::parts;
use crate::statistics::friedman::{self as statistic, Friedman, concordance_interval, exact_p};
use crate::statistics::wilcoxon::{self, Options, Shift, Wilcoxon, shift, wilcoxon};
use crate::statistics::{Adjustment, Description, adjust, describe};
use crate::study::file::{Adjust, FollowUp, Question, StudyFile, Zeros};
use crate::study::instrument::Instrument;
use crate::study::tables::Tables;
use serde::Serialize;
use std::collections::BTreeMap;

/// Pairs are compared where p is below this.
pub const LEVEL: f64 = 0.05;

/// The Friedman tests that one entry of the study file asks for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FriedmanBlock {
    /// `PART.QUESTION.ITEM`, as the file says it.
    pub of: String,
    /// What is compared: `condition` or `scene`.
    pub by: String,
    /// What each test holds fixed; none if each test takes a participant's mean over it.
    pub within: Option<String>,
    /// The levels compared, in the order of the file.
    pub levels: Vec<String>,
    /// How the p of pairs are adjusted by the file; none if it asks for no pairs.
    pub adjust: Option<Adjust>,
    /// What becomes of pairs without a difference; none if the file asks for no pairs.
    pub zeros: Option<Zeros>,
    /// The tests: by item, then by level of `within`.
    pub tests: Vec<FriedmanTest>,
}

/// One Friedman test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FriedmanTest {
    /// The item: `presence.q1`.
    pub item: String,
    /// Its statement, in the first language; empty where a licence keeps it out.
    pub text: String,
    /// The level of `within`.
    pub within: Option<String>,
    /// Participants with an answer under every level compared.
    pub people: usize,
    /// The plan's least participants, if there are fewer.
    pub short_of: Option<usize>,
    /// What was found; none without a complete participant.
    pub outcome: Option<Outcome>,
}

/// What a Friedman test found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// The levels compared, in the order of the file.
    pub levels: Vec<Level>,
    /// Q, its p by the chi-square distribution, and Kendall's W.
    #[serde(flatten)]
    pub friedman: Friedman,
    /// Exact p; none where it would take too long or there are more than four levels.
    pub p_exact: Option<f64>,
    /// p by Holm over all tests of the block.
    pub p_holm: f64,
    /// 95 % interval of W by a bootstrap over people.
    pub w_interval: [f64; 2],
    /// Every pair; none unless the file asks for pairs and p is below [`LEVEL`].
    pub pairs: Option<Vec<Pair>>,
}

/// Answers under one level.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Level {
    /// Its name.
    pub name: String,
    /// Its answers.
    #[serde(flatten)]
    pub answers: Description,
}

/// A pair of levels; differences are the second less the first.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pair {
    /// The first level.
    pub first: String,
    /// The second level.
    pub second: String,
    /// The signed-rank test.
    #[serde(flatten)]
    pub wilcoxon: Wilcoxon,
    /// p adjusted over the pairs of this test by the method of the file.
    pub p_adjusted: f64,
    /// p adjusted over the pairs of this test by Holm.
    pub p_holm: f64,
    /// The Hodges-Lehmann estimate of the difference with its 95 % interval.
    pub shift: Shift,
}

/// A block of tests, made ready from the study file.
pub(super) struct Planned<'s> {
    key: String,
    of: String,
    part: &'s str,
    /// Items with their statements.
    items: Vec<(String, String)>,
    by: Factor,
    levels: Vec<String>,
    is_within: bool,
    others: Vec<String>,
    least: usize,
}

/// What answers about scenes are compared by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Factor {
    Condition,
    Scene,
}

impl Factor {
    const fn name(self) -> &'static str {
        match self {
            Self::Condition => "condition",
            Self::Scene => "scene",
        }
    }

    const fn other(self) -> Self {
        match self {
            Self::Condition => Self::Scene,
            Self::Scene => Self::Condition,
        }
    }
}

impl<'s> Planned<'s> {
    /// `within` is empty if no factor is held fixed.
    pub(super) fn new(
        study: &'s StudyFile,
        key: &str,
        of: &'s str,
        [by, within]: [&str; 2],
    ) -> Result<Self, Error> {
        let of_key = format!("{key}.of");
        let pieces: Vec<&str> = of.split('.').collect();
        let [part, question, item] = pieces[..] else {
            return Err(bad(&of_key, of, "PART.QUESTION.ITEM", "* is every item"));
        };
        let show = &trials(study, key, part)?.show;
        let Some(scenes) = &show.scenes else {
            return Err(bad(&of_key, of, "of a part that shows scenes", "only scenes have conditions"));
        };
        let conditions = show.conditions.clone().unwrap_or_else(|| show.condition.iter().cloned().collect());
        let factors = [Factor::Condition, Factor::Scene];
        let Some(by) = factors.into_iter().find(|factor| factor.name() == by) else {
            return Err(bad(&format!("{key}.by"), by, "condition or scene", "it says what is compared"));
        };
        if !(within.is_empty() || within == by.other().name()) {
            let allowed = format!("{}, or left out", by.other().name());
            return Err(bad(&format!("{key}.within"), within, allowed, "it says what a test holds fixed"));
        }
        let (levels, others) = match by {
            Factor::Condition => (conditions, scenes.clone()),
            Factor::Scene => (scenes.clone(), conditions),
        };
        if levels.len() < 2 {
            let hint = format!("part.{part}.show has {} of them", levels.len());
            return Err(bad(&format!("{key}.by"), by.name(), "a factor of two levels or more", hint));
        }
        let items = items(study, &of_key, question, item)?;
        let least = parts::least(trials(study, key, part)?);
        let is_within = !within.is_empty();
        let (key, of) = (key.to_owned(), of.to_owned());
        Ok(Self { key, of, part, items, by, levels, is_within, others, least })
    }

    /// The tests of these tables.
    pub(super) fn block(
        &self,
        tables: &Tables,
        then: Option<&FollowUp>,
        seed: u64,
    ) -> Result<FriedmanBlock, Error> {
        let sums = self.sums(tables)?;
        let mut tests = Vec::new();
        for (item, text) in &self.items {
            let together = if self.is_within { 1 } else { self.others.len().max(1) };
            for others in self.others.chunks(together) {
                let rows = self.rows(&sums, item, others);
                let outcome = self.outcome(&rows, real(others.len()), then, seed)?;
                tests.push(FriedmanTest {
                    item: item.clone(),
                    text: text.clone(),
                    within: others.first().filter(|_| self.is_within).cloned(),
                    people: rows.len(),
                    short_of: (rows.len() < self.least).then_some(self.least),
                    outcome,
                });
            }
        }
        let mut outcomes: Vec<&mut Outcome> =
            tests.iter_mut().filter_map(|test| test.outcome.as_mut()).collect();
        let p: Vec<f64> = outcomes.iter().map(|outcome| outcome.friedman.p).collect();
        for (outcome, p) in outcomes.iter_mut().zip(self.adjusted(&p, Adjustment::Holm)?) {
            outcome.p_holm = p;
        }
        let pairs = then.map(|FollowUp::Wilcoxon { adjust, zeros }| (*adjust, *zeros));
        Ok(FriedmanBlock {
            of: self.of.clone(),
            by: self.by.name().to_owned(),
            within: self.is_within.then(|| self.by.other().name().to_owned()),
            levels: self.levels.clone(),
            adjust: pairs.map(|(adjust, _)| adjust),
            zeros: pairs.map(|(_, zeros)| zeros),
            tests,
        })
    }

    /// Ordinary answers by participant, item, level compared and other level.
    fn sums<'t>(&self, tables: &'t Tables) -> Result<BTreeMap<Cell<'t>, i64>, Error> {
        let mut cells = BTreeMap::new();
        for row in tables.answers.iter().filter(|row| row.part == self.part && row.is_ordinary()) {
            let shown = (row.shown.condition.as_deref(), row.shown.scene.as_deref());
            let (Some(value), (Some(condition), Some(scene))) = (row.number(), shown) else { continue };
            let (level, other) = match self.by {
                Factor::Condition => (condition, scene),
                Factor::Scene => (scene, condition),
            };
            let cell = Cell { participant: &row.participant, item: &row.question, level, other };
            if cells.insert(cell, value).is_some() {
                let what = format!("{} of {scene} under {condition}", row.question);
                let hint = format!("participant {} has two ordinary answers", row.participant);
                return Err(bad(&self.key, &what, "answered once by a participant", hint));
            }
        }
        Ok(cells)
    }

    /// `[participant][level]`: the sum of a participant's answers over the other levels. It ranks as their mean does, and stays whole.
    fn rows(&self, cells: &BTreeMap<Cell<'_>, i64>, item: &str, others: &[String]) -> Vec<Vec<f64>> {
        let mut people: Vec<&str> = cells.keys().map(|cell| cell.participant).collect();
        people.dedup();
        let sum = |participant: &str, level: &str| -> Option<f64> {
            let of = |other: &String| cells.get(&Cell { participant, item, level, other }).copied();
            let sum: i64 = others.iter().map(of).sum::<Option<i64>>()?;
            #[allow(clippy::cast_precision_loss, reason = "answers are far below 2^53")]
            Some(sum as f64)
        };
        let row = |participant: &&str| self.levels.iter().map(|level| sum(participant, level)).collect();
        people.iter().filter_map(row).collect()
    }

    /// What the rows give; each number in them is a sum of `scale` answers.
    fn outcome(
        &self,
        rows: &[Vec<f64>],
        scale: f64,
        then: Option<&FollowUp>,
        seed: u64,
    ) -> Result<Option<Outcome>, Error> {
        if rows.is_empty() {
            return Ok(None);
        }
        let wrong = |source| Error::Statistics { test: self.key.clone(), source };
        let friedman = statistic::friedman(rows).map_err(wrong)?;
        let column = |index: usize| -> Vec<f64> { rows.iter().map(|row| row[index] / scale).collect() };
        let level = |(index, name): (usize, &String)| {
            Ok(Level { name: name.clone(), answers: describe(&column(index))? })
        };
        let levels: Result<_, _> = self.levels.iter().enumerate().map(level).collect();
        let pairs = match then {
            Some(then) if friedman.p < LEVEL => Some(self.pairs(rows, scale, then)?),
            _ => None,
        };
        Ok(Some(Outcome {
            levels: levels.map_err(wrong)?,
            p_exact: exact_p(rows).ok(),
            // over the block, once all of its tests are there
            p_holm: friedman.p,
            w_interval: concordance_interval(rows, DRAWS, CONFIDENCE, seed).map_err(wrong)?,
            friedman,
            pairs,
        }))
    }

    fn pairs(&self, rows: &[Vec<f64>], scale: f64, then: &FollowUp) -> Result<Vec<Pair>, Error> {
        let FollowUp::Wilcoxon { adjust, zeros } = then;
        let zeros = match zeros {
            Zeros::Wilcoxon => wilcoxon::Zeros::Wilcoxon,
            Zeros::Pratt => wilcoxon::Zeros::Pratt,
        };
        let method = match adjust {
            Adjust::Bonferroni => Adjustment::Bonferroni,
            Adjust::Holm => Adjustment::Holm,
        };
        let wrong = |source| Error::Statistics { test: self.key.clone(), source };
        let mut pairs = Vec::new();
        for first in 0..self.levels.len() {
            for second in first + 1..self.levels.len() {
                let differences: Vec<f64> = rows.iter().map(|row| row[second] - row[first]).collect();
                let options = Options { zeros, ..Options::default() };
                let wilcoxon = wilcoxon(&differences, options).map_err(wrong)?;
                let scaled: Vec<f64> = differences.iter().map(|difference| difference / scale).collect();
                pairs.push(Pair {
                    first: self.levels[first].clone(),
                    second: self.levels[second].clone(),
                    p_adjusted: wilcoxon.p,
                    p_holm: wilcoxon.p,
                    wilcoxon,
                    shift: shift(&scaled, CONFIDENCE).map_err(wrong)?,
                });
            }
        }
        let p: Vec<f64> = pairs.iter().map(|pair| pair.wilcoxon.p).collect();
        let adjusted = self.adjusted(&p, method)?.into_iter().zip(self.adjusted(&p, Adjustment::Holm)?);
        for (pair, (own, holm)) in pairs.iter_mut().zip(adjusted) {
            (pair.p_adjusted, pair.p_holm) = (own, holm);
        }
        Ok(pairs)
    }

    fn adjusted(&self, p: &[f64], method: Adjustment) -> Result<Vec<f64>, Error> {
        adjust(p, method).map_err(|source| Error::Statistics { test: self.key.clone(), source })
    }
}

/// What one answer is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Cell<'t> {
    participant: &'t str,
    item: &'t str,
    level: &'t str,
    other: &'t str,
}

/// The items of a question with their statements: all for `*`, or one.
fn items(study: &StudyFile, key: &str, question: &str, item: &str) -> Result<Vec<(String, String)>, Error> {
    let languages = &study.study.languages;
    let preferred = languages.first().map_or("", String::as_str);
    let all: Vec<(String, String)> = match (study.questions.get(question), Instrument::builtin(question)?) {
        (Some(Question::Likert { items, .. }), _) => {
            items.iter().map(|one| (one.id.clone(), one.text.find(preferred, languages).to_owned())).collect()
        }
        (None, Some(instrument)) => {
            let written = study.wording.get(question);
            let text = |id: &str, own: Option<&crate::study::words::Words>| {
                let words = written.and_then(|texts| texts.get(id)).or(own);
                words.map_or_else(String::new, |words| words.find(preferred, languages).to_owned())
            };
            instrument.items.iter().map(|one| (one.id.clone(), text(&one.id, one.text.as_ref()))).collect()
        }
        _ => return Err(bad(key, question, "a question with statements", "its kind is likert")),
    };
    let ids: Vec<String> = all.iter().map(|(id, _)| id.clone()).collect();
    let chosen = all.into_iter().filter(|(id, _)| item == "*" || id == item);
    let chosen: Vec<_> = chosen.map(|(id, text)| (format!("{question}.{id}"), text)).collect();
    if chosen.is_empty() {
        return Err(bad(key, item, format!("{}, or *", ids.join(", ")), "* is every item"));
    }
    Ok(chosen)
}
