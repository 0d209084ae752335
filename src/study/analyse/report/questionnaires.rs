//! Scores of questionnaires.

use super::page::{Page, interval, p, plain, texts};
use crate::study::analyse::{Change, PageScores, Questionnaire, Score};

pub(super) fn block(page: &mut Page, found: &Questionnaire) {
    let title = if found.title.is_empty() { String::new() } else { format!(": {}", plain(&found.title)) };
    page.heading(3, format!("`{}`{title}", found.questionnaire));
    if found.pages.is_empty() {
        page.paragraph("No answer counts.");
        return;
    }
    if !found.variants.is_empty() {
        page.paragraph(format!("Scoring: {}.", plain(&found.variants.join(", "))));
    }
    let rows = found.pages.iter().flat_map(|place| place.scores.iter().map(|score| row(place, score)));
    let head = texts(&[
        "part",
        "page",
        "score",
        "n",
        "mean",
        "SD",
        "median",
        "least",
        "greatest",
        "alpha",
        "alpha, 95 %",
    ]);
    page.table(&head, 3, rows.collect());
    let incomplete: usize = found.pages.iter().map(|place| place.incomplete).sum();
    page.paragraph(format!(
        "Each n counts people that answered all items; {incomplete} answered some only. Alpha is Cronbach's, with Feldt's interval."
    ));
    if !found.changes.is_empty() {
        changes(page, &found.changes);
    }
}

fn row(place: &PageScores, score: &Score) -> Vec<String> {
    let mut row = [&place.part, &place.page, &score.score].map(|text| plain(text)).to_vec();
    row.push(place.people.to_string());
    if let Some(values) = &score.values {
        row.push(format!("{:.2}", values.mean));
        row.push(values.deviation.map_or_else(String::new, |deviation| format!("{deviation:.2}")));
        row.extend([values.quartiles[1], values.least, values.greatest].map(|value| format!("{value:.2}")));
    }
    row.resize(9, String::new());
    let alpha = score.alpha.map(|found| [format!("{:.2}", found.alpha), interval(found.interval)]);
    row.extend(alpha.unwrap_or_default());
    row
}

fn changes(page: &mut Page, changes: &[Change]) {
    let row = |change: &Change| {
        let mut row = vec![
            plain(&change.score),
            format!("{} to {}", plain(&change.before), plain(&change.after)),
            change.people.to_string(),
        ];
        if let Some(test) = &change.test {
            row.push(format!("{:.2}", test.difference.mean));
            row.push(
                test.difference.deviation.map_or_else(String::new, |deviation| format!("{deviation:.2}")),
            );
            row.push(format!("{:.2}", test.difference.quartiles[1]));
            row.push(p(test.wilcoxon.p) + if test.wilcoxon.exact { "" } else { " (normal)" });
            row.push(p(test.p_holm));
            row.push(format!("{:.2}", test.wilcoxon.rank_biserial));
            row.push(format!("{:.2}", test.shift.estimate));
            row.push(interval(test.shift.interval));
        }
        row.resize(11, String::new());
        row
    };
    let head = [
        "score",
        "change",
        "n",
        "mean",
        "SD",
        "median",
        "p",
        "p Holm",
        "rank-biserial",
        "shift",
        "shift, 95 %",
    ];
    page.table(&texts(&head), 2, changes.iter().map(row).collect());
    page.paragraph(
        "Differences are after less before. Wilcoxon's signed ranks, without differences of 0. Holm adjusts over the rows. \
         Shift is the Hodges-Lehmann estimate.",
    );
}
