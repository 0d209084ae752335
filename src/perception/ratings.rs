//! Raw responses of raters to means, labels and GEA (paper, sections 3.2 and 3.3; S-05 to S-09).
//!
//! A rater watches a video of a gait and says to each of four statements ("this person looks happy", angry, sad,
//! neutral) how far they agree, 1 to 5. [`read()`] takes the sheet of answers; [`analyse`] gives the mean of every video,
//! its label, how the four questions go together, how far raters agree and how many gaits each emotion has; [`apply`]
//! writes ratings and labels into gaits. Ambiguities of the paper and their resolution: A-05 (threshold and ties), A-06
//! (n is counted, never assumed), A-07 (correlations over gaits are the headline, over responses are given too).

mod key;
mod read;

use crate::emotion::Emotion;
use crate::gait::{Gait, LabelOrigin};
use crate::statistics::agreement::{Agreement, Correlation, agreement, correlation};
pub use key::{KEY_HEAD, parse_key, read_key};
pub use read::{Fault, MOST_BYTES, Options, Sheet, parse, read};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// The paper's threshold theta: a gait looks like an emotion if its mean rating is above it (section 3.3).
#[doc(hidden)]
pub const THETA: f64 = 3.5;

/// Fewest responses per video in the paper (section 3.2; S-04).
#[doc(hidden)]
pub const FEWEST_RESPONSES: usize = 10;

/// What one participant answered to one video.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Who answered.
    pub participant: String,
    /// Which video: the gait's name.
    pub video: String,
    /// Answers in the order of [`Emotion::ALL`], each 1 (strongly disagree) to 5 (strongly agree).
    pub scores: [u8; 4],
    /// The participant's gender as written, if the sheet has it.
    pub gender: Option<String>,
    /// The participant's age in years, if the sheet has it.
    pub age: Option<f64>,
    /// Line of the sheet, from 1.
    pub line: usize,
}

/// What all raters together say about one video.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Video {
    /// The gait's name.
    pub name: String,
    /// Number of responses, the paper's `n_p`.
    pub responses: usize,
    /// Mean responses r^e in the order of [`Emotion::ALL`], 1 to 5 (section 3.2).
    pub mean: [f64; 4],
    /// Standard deviations of the responses (divisor n - 1; 0 for a single response).
    pub deviation: [f64; 4],
    /// The perceived emotion; none if no mean is above the threshold.
    pub label: Option<Emotion>,
    /// Emotions that share the highest mean above the threshold, if more than one; the label is the first.
    pub tied: Vec<Emotion>,
    /// Without a label: emotions whose mean is exactly the threshold, which is not above it.
    pub at_threshold: Vec<Emotion>,
}

impl Video {
    /// Mean of the emotion minus the highest mean of another one: how clearly a gait shows it (spec 1.11).
    pub fn margin(&self, emotion: Emotion) -> f64 {
        margin(self.mean, emotion)
    }
}

/// `values[emotion]` minus the largest other value.
#[doc(hidden)]
pub fn margin(values: [f64; 4], emotion: Emotion) -> f64 {
    let others = Emotion::ALL.into_iter().filter(|other| *other != emotion);
    let best_other = others.map(|other| values[other.index()]).fold(f64::NEG_INFINITY, f64::max);
    values[emotion.index()] - best_other
}

/// How many gaits look like each emotion (paper, figure of label shares; S-09).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Distribution {
    /// Gaits of each emotion in the order of [`Emotion::ALL`].
    pub counts: [usize; 4],
    /// Gaits with a label: what the shares are fractions of.
    pub labelled: usize,
    /// Gaits without a label (the paper's "non-expressive" ones).
    pub dropped: usize,
}

impl Distribution {
    /// Counts the labels.
    pub fn of(labels: impl IntoIterator<Item = Option<Emotion>>) -> Self {
        let mut found = Self { counts: [0; 4], labelled: 0, dropped: 0 };
        for label in labels {
            if let Some(emotion) = label {
                found.counts[emotion.index()] += 1;
                found.labelled += 1;
            } else {
                found.dropped += 1;
            }
        }
        found
    }

    /// Share of the labelled gaits, 0 to 1; 0 if there are none.
    pub fn share(&self, emotion: Emotion) -> f64 {
        ratio(self.counts[emotion.index()], self.labelled)
    }
}

/// The raters, each counted once.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Demographics {
    /// Number of raters.
    pub participants: usize,
    /// Raters by gender, as written (lower case), where reported.
    pub genders: BTreeMap<String, usize>,
    /// Raters without a reported gender.
    pub gender_unreported: usize,
    /// Mean reported age, years; none if no rater reported one.
    pub mean_age: Option<f64>,
    /// Raters without a reported age.
    pub age_unreported: usize,
}

/// A study, evaluated.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Analysis {
    /// The threshold used.
    pub theta: f64,
    /// Number of responses.
    pub responses: usize,
    /// The raters.
    pub demographics: Demographics,
    /// Every video, by name.
    pub videos: Vec<Video>,
    /// Correlations between the four questions over the means of the videos: the headline.
    pub over_videos: Correlation,
    /// The same over single responses.
    pub over_responses: Correlation,
    /// How far raters agree on each question, in the order of [`Emotion::ALL`].
    pub agreement: [Agreement; 4],
    /// How many gaits look like each emotion.
    pub distribution: Distribution,
}

impl Analysis {
    /// Videos with fewer than `fewest` responses.
    pub fn short_of(&self, fewest: usize) -> Vec<&Video> {
        self.videos.iter().filter(|video| video.responses < fewest).collect()
    }

    /// Videos by name.
    pub fn by_name(&self) -> HashMap<&str, &Video> {
        self.videos.iter().map(|video| (video.name.as_str(), video)).collect()
    }

    /// One line for every label that hangs on A-05: a tie, or a mean that is exactly the threshold.
    pub fn warnings(&self) -> Vec<String> {
        let names = |emotions: &[Emotion]| {
            emotions.iter().map(|emotion| emotion.name()).collect::<Vec<_>>().join(" and ")
        };
        let warn = |video: &Video| {
            if let Some(label) = video.label.filter(|_| video.tied.len() > 1) {
                let mean = video.mean[label.index()];
                let name = &video.name;
                let tied = names(&video.tied);
                return Some(format!("{name}: {tied} tie at {mean:.3}; labelled {label}, the first of them"));
            }
            (!video.at_threshold.is_empty()).then(|| {
                let (name, at) = (&video.name, names(&video.at_threshold));
                format!("{name}: {at} is exactly at the threshold {}, not above it; not labelled", self.theta)
            })
        };
        self.videos.iter().filter_map(warn).collect()
    }
}

/// The label of a gait with these mean ratings: the emotion of the highest one, if that is above `theta`. Also the
/// emotions that share it, in the order of [`Emotion::ALL`], of which the label is the first (equation 1; A-05).
pub fn label(mean: [f64; 4], theta: f64) -> (Option<Emotion>, Vec<Emotion>) {
    let highest = mean.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let is_above = highest > theta;
    if !is_above {
        return (None, Vec::new());
    }
    // Means of equal sums over equal counts are equal to the last bit, so that exact comparison finds every tie.
    #[allow(clippy::float_cmp, reason = "a tie is exact")]
    let tied: Vec<Emotion> =
        Emotion::ALL.into_iter().filter(|emotion| mean[emotion.index()] == highest).collect();
    (tied.first().copied(), tied)
}

/// Evaluates a study: every response counts once; `theta` is the threshold of the labels ([`THETA`] in the paper).
///
/// Correlations and agreement are NaN where they do not exist (too few values, no variance).
pub fn analyse(responses: &[Response], theta: f64) -> Analysis {
    let mut of_video: BTreeMap<&str, Vec<[u8; 4]>> = BTreeMap::new();
    for response in responses {
        of_video.entry(&response.video).or_default().push(response.scores);
    }
    let videos: Vec<Video> = of_video.iter().map(|(name, scores)| video(name, scores, theta)).collect();
    let means: Vec<[f64; 4]> = videos.iter().map(|video| video.mean).collect();
    let singles: Vec<[f64; 4]> = responses.iter().map(|response| response.scores.map(f64::from)).collect();
    let agreement = Emotion::ALL.map(|emotion| {
        let answers = of_video.values();
        let units = answers.map(|scores| scores.iter().map(|score| score[emotion.index()]).collect());
        agreement(&units.collect::<Vec<Vec<u8>>>())
    });
    Analysis {
        theta,
        responses: responses.len(),
        demographics: demographics(responses),
        over_videos: correlation(&means),
        over_responses: correlation(&singles),
        agreement,
        distribution: Distribution::of(videos.iter().map(|video| video.label)),
        videos,
    }
}

fn video(name: &str, scores: &[[u8; 4]], theta: f64) -> Video {
    let count = number(scores.len());
    let mean: [f64; 4] = std::array::from_fn(|question| {
        scores.iter().map(|score| f64::from(score[question])).sum::<f64>() / count
    });
    let deviation = std::array::from_fn(|question| {
        let squares = scores.iter().map(|score| (f64::from(score[question]) - mean[question]).powi(2));
        (squares.sum::<f64>() / (count - 1.0).max(1.0)).sqrt()
    });
    let (label, tied) = label(mean, theta);
    #[allow(clippy::float_cmp, reason = "at the threshold is exact")]
    let at_threshold = |emotion: &Emotion| label.is_none() && mean[emotion.index()] == theta;
    Video {
        name: name.to_owned(),
        responses: scores.len(),
        mean,
        deviation,
        label,
        tied: if tied.len() > 1 { tied } else { Vec::new() },
        at_threshold: Emotion::ALL.into_iter().filter(at_threshold).collect(),
    }
}

/// Counts each participant once; what they said first counts, if they say it in several rows.
fn demographics(responses: &[Response]) -> Demographics {
    let participants: BTreeSet<&str> = responses.iter().map(|r| r.participant.as_str()).collect();
    let mut gender_of: HashMap<&str, &str> = HashMap::new();
    let mut age_of: BTreeMap<&str, f64> = BTreeMap::new();
    for response in responses {
        if let Some(gender) = &response.gender {
            gender_of.entry(&response.participant).or_insert(gender);
        }
        if let Some(age) = response.age {
            age_of.entry(&response.participant).or_insert(age);
        }
    }
    let mut genders = BTreeMap::new();
    for gender in gender_of.values() {
        *genders.entry(gender.to_lowercase()).or_insert(0) += 1;
    }
    Demographics {
        participants: participants.len(),
        genders,
        gender_unreported: participants.len() - gender_of.len(),
        mean_age: (!age_of.is_empty()).then(|| age_of.values().sum::<f64>() / number(age_of.len())),
        age_unreported: participants.len() - age_of.len(),
    }
}

/// Writes ratings and labels into the gaits of these names; a gait without a label loses the one it had. Unrated
/// gaits stay as they are: their names are returned.
pub fn apply(analysis: &Analysis, gaits: &mut [Gait]) -> Vec<String> {
    let videos = analysis.by_name();
    let mut unrated = Vec::new();
    for gait in gaits {
        if let Some(video) = videos.get(gait.name.as_str()) {
            #[allow(clippy::cast_possible_truncation, reason = "a mean of 1 to 5, rounded to f32")]
            let ratings = video.mean.map(|mean| mean as f32);
            gait.ratings = Some(ratings);
            gait.label = video.label;
            gait.provenance.label_origin = video.label.and(Some(LabelOrigin::Rated));
            gait.provenance.label_model = None;
        } else {
            unrated.push(gait.name.clone());
        }
    }
    unrated
}

/// `part / whole`, 0 of nothing.
fn ratio(part: usize, whole: usize) -> f64 {
    if whole == 0 { 0.0 } else { number(part) / number(whole) }
}

#[allow(clippy::cast_precision_loss, reason = "counts of responses are far below 2^53")]
const fn number(count: usize) -> f64 {
    count as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_mean_above_the_threshold_labels_and_the_first_of_equal_ones_wins() {
        assert_eq!(label([3.5, 1.0, 3.5, 3.0], THETA), (None, vec![]));
        assert_eq!(label([3.6, 4.0, 1.0, 3.9], THETA).0, Some(Emotion::Angry));
        let (found, tied) = label([1.0, 4.0, 4.0, 2.0], THETA);
        assert_eq!((found, tied), (Some(Emotion::Angry), vec![Emotion::Angry, Emotion::Sad]));
        assert_eq!(label([f64::NAN; 4], THETA).0, None);
        // spelled out, so that another threshold is noticed: ratings are sums of whole numbers over a handful of people
        assert_eq!(label([3.5 + 1.0 / 64.0, 1.0, 1.0, 1.0], 3.5).0, Some(Emotion::Happy));
        assert_eq!(THETA.to_bits(), 3.5_f64.to_bits());
    }

    #[test]
    fn margins_are_against_the_best_other() {
        assert!((margin([4.0, 2.0, 3.5, 1.0], Emotion::Happy) - 0.5).abs() < 1e-12);
        assert!((margin([4.0, 2.0, 3.5, 1.0], Emotion::Sad) + 0.5).abs() < 1e-12);
    }

    #[test]
    fn shares_are_of_the_labelled_gaits_only() {
        let found = Distribution::of([Some(Emotion::Sad), None, Some(Emotion::Sad), Some(Emotion::Happy)]);
        assert_eq!((found.counts, found.labelled, found.dropped), ([1, 0, 2, 0], 3, 1));
        assert!((found.share(Emotion::Sad) - 2.0 / 3.0).abs() < 1e-12);
        assert!(Distribution::of([]).share(Emotion::Sad).abs() < 1e-12);
    }
}
