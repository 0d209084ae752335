//! The paper's tables beside those of its two studies done again.

use super::page::{Page, many, p, percent, plain, texts};
use crate::emotion::Emotion;
use crate::statistics::paper;
use crate::study::analyse::{Analysis, ConfusionBlock, FriedmanBlock, RatingBlock, Test};

/// Ids of the built-in studies that repeat the paper's.
const STUDIES: [&str; 2] = ["eva-gaits", "eva-agents"];

/// What of the paper's tables this study has a counterpart for; nothing for other studies.
pub(super) fn section(page: &mut Page, analysis: &Analysis) {
    if !STUDIES.contains(&analysis.study.as_str()) {
        return;
    }
    let mut found = Page::default();
    if let Some(ratings) = &analysis.ratings {
        labels(&mut found, &ratings.kept);
    }
    for test in &analysis.tests {
        match test {
            Test::Friedman(sides) => friedman(&mut found, &sides.kept),
            Test::Confusion(sides) => confusion(&mut found, &sides.kept),
        }
    }
    if found.blocks.is_empty() {
        return;
    }
    page.heading(2, "Beside the paper");
    page.paragraph(
        "Ours are the answers of this study, without the excluded. The paper's are as printed, of other people and other gaits.",
    );
    if analysis.participants.is_simulated {
        page.paragraph("Simulated participants answer by formulas. Agreement with the paper is no evidence.");
    }
    page.blocks.append(&mut found.blocks);
}

fn labels(page: &mut Page, found: &RatingBlock) {
    let Some(analysis) = &found.analysis else { return };
    let row = |emotion: Emotion| {
        let share = percent(analysis.distribution.share(emotion));
        let printed = paper::LABEL_SHARES[emotion.index()];
        vec![
            emotion.to_string(),
            share,
            printed.map_or_else(|| "-".to_owned(), |share| format!("{share:.2} %")),
        ]
    };
    page.heading(3, "Labels of gaits");
    page.table(&texts(&["label", "share, ours", "share, paper"]), 1, Emotion::ALL.map(row).to_vec());
    page.paragraph(format!(
        "The paper prints the greatest and the least share. Our {} stand in for its {} recorded ones.",
        many(analysis.videos.len(), "gait"),
        paper::GAITS
    ));
}

/// Place of a word in a list; case does not matter.
fn index(words: &[&str], word: &str) -> Option<usize> {
    words.iter().position(|known| known.eq_ignore_ascii_case(word))
}

fn friedman(page: &mut Page, block: &FriedmanBlock) {
    let (mut tests, mut pairs, mut agree) = (Vec::new(), Vec::new(), 0);
    for test in &block.tests {
        let item = test.item.split_once('.').map_or(test.item.as_str(), |(_, id)| id);
        let places = (
            index(&paper::QUESTIONS, item),
            test.within.as_deref().and_then(|scene| index(&paper::SCENARIOS, scene)),
        );
        let ((Some(question), Some(scene)), Some(outcome)) = (places, &test.outcome) else { continue };
        let names = [item, paper::SCENARIOS[scene]].map(plain);
        let printed = [paper::CHI_SQUARE[question][scene], paper::FRIEDMAN_P[question][scene]];
        let level = paper::FRIEDMAN_LEVEL;
        let is_same = (outcome.friedman.p < level) == (printed[1] < level);
        agree += usize::from(is_same);
        let mut row = names.to_vec();
        row.push(format!("{:.2}", outcome.friedman.chi_square));
        row.push(format!("{:.2}", printed[0]));
        row.push(p(outcome.friedman.p));
        row.push(format!("{:.2}", printed[1]));
        row.push(if is_same { "yes" } else { "no" }.to_owned());
        tests.push(row);
        let printed = paper::WILCOXON_P[question][scene];
        for pair in outcome.pairs.iter().flatten() {
            let of = format!("{} and {}", pair.first, pair.second);
            let paper = printed.zip(index(&paper::PAIRS, &of)).map(|(cell, place)| cell[place]);
            let mut row = names.to_vec();
            row.extend([plain(&of), p(pair.wilcoxon.p)]);
            row.push(paper.map_or_else(|| "-".to_owned(), |p| format!("{p:.3}")));
            pairs.push(row);
        }
    }
    if tests.is_empty() {
        return;
    }
    let count = tests.len();
    page.heading(3, format!("Friedman tests of `{}`", block.of));
    let head = ["question", "scene", "χ², ours", "χ², paper", "p, ours", "p, paper", "same side of .05"];
    page.table(&texts(&head), 2, tests);
    page.paragraph(format!("{agree} of {count} tests lie on the same side of .05 as the paper's."));
    if !pairs.is_empty() {
        page.heading(3, "Pairs of conditions");
        page.table(&texts(&["question", "scene", "pair", "p, ours", "p, paper"]), 3, pairs);
        page.paragraph("Both are p of Wilcoxon's signed ranks before any adjustment. The paper prints no pair where Friedman's test found nothing.");
    }
}

fn confusion(page: &mut Page, block: &ConfusionBlock) {
    let places: Option<Vec<usize>> =
        block.classes.iter().map(|class| index(&paper::EMOTIONS, class)).collect();
    let (Some(places), Some(statistics)) = (places, &block.statistics) else { return };
    let row = |(shown, counts): (usize, &Vec<u64>)| {
        let all: u64 = counts.iter().sum();
        let mut row = vec![plain(&block.classes[shown])];
        for (answered, &count) in counts.iter().enumerate() {
            #[allow(clippy::cast_precision_loss, reason = "counts of answers")]
            let ours = 100.0 * count as f64 / all.max(1) as f64;
            row.push(format!("{ours:.1} / {:.1}", paper::CONFUSION_PERCENT[places[shown]][places[answered]]));
        }
        row
    };
    let mut head = texts(&["shown"]);
    head.extend(block.classes.iter().map(|class| format!("{}, ours / paper", plain(class))));
    page.heading(3, format!("Identification of `{}`, percent", block.of));
    page.table(&head, 1, block.counts.iter().enumerate().map(row).collect());
    let (right, all) = paper_right();
    page.paragraph(format!(
        "Right: {} of {} ({}), in the paper {right} of {all} ({}).",
        statistics.right,
        statistics.answers,
        percent(statistics.accuracy),
        percent(right_share(right, all))
    ));
}

/// Right answers and answers of the paper's matrix.
fn paper_right() -> (u64, u64) {
    let right = paper::CONFUSION.iter().enumerate().map(|(index, row)| row[index]).sum();
    (right, paper::CONFUSION.iter().flatten().sum())
}

#[allow(clippy::cast_precision_loss, reason = "counts of answers")]
fn right_share(right: u64, all: u64) -> f64 {
    right as f64 / all.max(1) as f64
}
