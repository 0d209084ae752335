//! Scores of questionnaires.

use super::{Instrument, Score, ScoreKind};
use crate::spelling::suggestion;
use crate::study::error::Error;
use std::collections::BTreeMap;

impl Instrument {
    /// The scores of one filled-in questionnaire, in the order of its file: `answers` by item, on its scale and as given
    /// (reversed items are turned here). `variants` are names of other ways of scoring, such as `d_without_nausea`.
    ///
    /// # Errors
    /// [`Error::Unanswered`], [`Error::OffScale`] or [`Error::UnknownVariant`].
    pub fn score(
        &self,
        answers: &BTreeMap<String, i64>,
        variants: &[String],
    ) -> Result<Vec<(String, f64)>, Error> {
        let known = self.variants();
        if let Some(variant) = variants.iter().find(|variant| !known.contains(&variant.as_str())) {
            return Err(Error::UnknownVariant {
                questionnaire: self.id.clone(),
                variant: variant.clone(),
                hint: suggestion(variant, &known, "there are"),
            });
        }
        let mut raw: BTreeMap<&str, f64> = BTreeMap::new();
        let mut scores = Vec::new();
        for score in &self.scores {
            let mut values = self.values(score, answers, variants)?;
            values.extend(score.of.iter().filter_map(|id| raw.get(id.as_str())));
            let number = self.number(score, &values);
            raw.insert(&score.id, number);
            scores.push((score.id.clone(), number * score.factor));
        }
        Ok(scores)
    }

    fn values(
        &self,
        score: &Score,
        answers: &BTreeMap<String, i64>,
        variants: &[String],
    ) -> Result<Vec<f64>, Error> {
        let is_left_out = |item: &String| {
            variants
                .iter()
                .any(|variant| score.without.get(variant).is_some_and(|items| items.contains(item)))
        };
        score.items.iter().filter(|item| !is_left_out(item)).map(|item| self.value(item, answers)).collect()
    }

    fn value(&self, id: &str, answers: &BTreeMap<String, i64>) -> Result<f64, Error> {
        let unanswered = || Error::Unanswered { questionnaire: self.id.clone(), item: id.to_owned() };
        let value = *answers.get(id).ok_or_else(unanswered)?;
        if !(self.least..=self.greatest).contains(&value) {
            return Err(Error::OffScale {
                questionnaire: self.id.clone(),
                item: id.to_owned(),
                value,
                least: self.least,
                greatest: self.greatest,
            });
        }
        let is_reversed = self.items.iter().any(|item| item.id == id && item.reversed);
        Ok(number(if is_reversed { self.least + self.greatest - value } else { value }))
    }

    fn number(&self, score: &Score, values: &[f64]) -> f64 {
        let sum: f64 = values.iter().sum();
        #[allow(clippy::cast_precision_loss, reason = "a few items")]
        let count = values.len().max(1) as f64;
        match score.kind {
            ScoreKind::Sum => sum,
            ScoreKind::Mean => sum / count,
            ScoreKind::Percent => {
                let [least, greatest] = [self.least, self.greatest].map(number);
                100.0 * (sum - count * least) / (count * (greatest - least))
            }
            ScoreKind::Count => {
                let reached = values.iter().filter(|&&value| value >= number(score.at_least));
                reached.map(|_| 1.0).sum()
            }
        }
    }
}

#[allow(clippy::cast_precision_loss, reason = "answers are small")]
const fn number(value: i64) -> f64 {
    value as f64
}
