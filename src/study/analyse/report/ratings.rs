//! Ratings of gaits.

use super::figures;
use super::page::{Page, interval, many, percent, plain, texts};
use crate::emotion::Emotion;
use crate::perception::ratings::Analysis;
use crate::study::analyse::{LabelStability, RatingBlock};

/// Most gaits that the page lists; the JSON has all.
const LISTED: usize = 60;

pub(super) fn block(page: &mut Page, found: &RatingBlock) {
    let (Some(analysis), Some(stability)) = (&found.analysis, &found.stability) else {
        page.paragraph("No answer counts.");
        return;
    };
    page.paragraph(format!(
        "{} of {} by {}. A gait looks like the emotion of its highest mean rating, if that is above {}.",
        many(analysis.responses, "rating"),
        many(analysis.videos.len(), "gait"),
        many(analysis.demographics.participants, "person"),
        analysis.theta
    ));
    labels(page, analysis);
    agreement(page, found, analysis);
    stable(page, analysis, stability);
    page.figure(
        &figures::ratings(analysis),
        "Mean ratings: one dot a gait, by the emotion that was asked for.",
    );
    gaits(page, analysis, stability);
}

fn labels(page: &mut Page, analysis: &Analysis) {
    let labels = &analysis.distribution;
    let row = |emotion: Emotion| {
        vec![emotion.to_string(), labels.counts[emotion.index()].to_string(), percent(labels.share(emotion))]
    };
    page.table(&texts(&["label", "gaits", "share of labelled"]), 1, Emotion::ALL.map(row).to_vec());
    page.paragraph(format!("{} without a label.", many(labels.dropped, "gait")));
}

/// How far raters agree with one another and with themselves.
fn agreement(page: &mut Page, found: &RatingBlock, analysis: &Analysis) {
    let word = |value: f64| if value.is_finite() { format!("{value:.2}") } else { String::new() };
    let raters = word(analysis.agreement[0].raters);
    let mut head = vec!["question".to_owned(), "ICC(1,1)".to_owned(), format!("ICC(1,k), k = {raters}")];
    head.extend(texts(&["alpha, ordinal", "alpha, interval"]));
    if found.complete.is_some() {
        head.extend(texts(&["ICC(2,1)", "ICC(2,k)", "Cronbach's alpha"]));
    }
    if found.repeats.is_some() {
        head.extend(texts(&["repeats", "equal", "mean difference", "kappa", "kappa, 95 %"]));
    }
    let row = |emotion: Emotion| {
        let all = &analysis.agreement[emotion.index()];
        let mut row = vec![emotion.to_string()];
        row.extend([all.icc_single, all.icc_mean, all.alpha_ordinal, all.alpha_interval].map(word));
        if let Some(complete) = &found.complete {
            let models = complete[emotion.index()].as_ref();
            // Cronbach's alpha over raters is ICC(3,k)
            let of =
                models.map(|found| [found.agreement.single, found.agreement.mean, found.consistency.mean]);
            row.extend(of.map_or_else(Default::default, |values| values.map(word)));
        }
        if let Some(repeats) = &found.repeats {
            let own = &repeats[emotion.index()];
            row.extend([own.pairs.to_string(), percent(own.equal), word(own.mean_difference)]);
            let kappa = own.kappa.map(|kappa| [word(kappa.kappa), interval(kappa.interval)]);
            row.extend(kappa.unwrap_or_default());
        }
        row
    };
    page.table(&head, 1, Emotion::ALL.map(row).to_vec());
    page.paragraph(
        "ICC of the one-way model, since each gait has raters of its own. Alpha is Krippendorff's. Repeats are gaits that a rater \
         saw twice; their kappa has quadratic weights.",
    );
}

fn stable(page: &mut Page, analysis: &Analysis, stability: &LabelStability) {
    page.paragraph(format!(
        "Labels stay in {} of {} resamples of the raters, on average over gaits. {} of {} gaits keep theirs in 95 % or more.",
        percent(stability.mean),
        stability.draws,
        stability.stable,
        analysis.videos.len()
    ));
}

fn gaits(page: &mut Page, analysis: &Analysis, stability: &LabelStability) {
    let rows = analysis.videos.iter().take(LISTED).map(|video| {
        let mut row =
            vec![plain(&video.name), video.label.map_or_else(|| "-".to_owned(), |label| label.to_string())];
        row.push(video.responses.to_string());
        row.extend(video.mean.map(|mean| format!("{mean:.2}")));
        row.push(video.label.map_or_else(String::new, |label| format!("{:.2}", video.margin(label))));
        row.push(stability.gaits.get(&video.name).map_or_else(String::new, |&share| percent(share)));
        row
    });
    let head = ["gait", "label", "n", "happy", "angry", "sad", "neutral", "margin", "label stays"];
    page.table(&texts(&head), 2, rows.collect());
    let more = analysis.videos.len().saturating_sub(LISTED);
    if more > 0 {
        page.paragraph(format!("The results as JSON have the other {}.", many(more, "gait")));
    }
}
