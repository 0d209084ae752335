//! The planned tests.

use super::figures;
use super::page::{Page, both, interval, many, mean, p, percent, percents, plain, texts};
use crate::study::analyse::{ConfusionBlock, FriedmanBlock, FriedmanTest, LEVEL, Outcome, Test};
use crate::study::file::{Adjust, Zeros};

/// A planned test, without and with the excluded.
pub(super) fn test(page: &mut Page, test: &Test) {
    match test {
        Test::Friedman(sides) => both(page, sides, &format!("`{}`", sides.kept.of), friedman),
        Test::Confusion(sides) => both(page, sides, &format!("`{}`", sides.kept.of), confusion),
    }
}

fn friedman(page: &mut Page, block: &FriedmanBlock) {
    let over = block.within.as_ref().map_or_else(String::new, |within| format!(" for each {within}"));
    page.paragraph(format!("Friedman's test compares the levels of {}{over}.", block.by));
    let mut seen: Vec<&str> = Vec::new();
    let statements = block.tests.iter().filter(|test| {
        let is_new = !seen.contains(&test.item.as_str());
        seen.push(&test.item);
        is_new && !test.text.is_empty()
    });
    let statements: Vec<String> =
        statements.map(|test| format!("{}: {}", plain(&test.item), plain(&test.text))).collect();
    if !statements.is_empty() {
        page.list(statements);
    }
    let mut head = vec!["item".to_owned()];
    head.extend(block.within.iter().cloned());
    let numbers = head.len();
    head.push("n".to_owned());
    head.extend(block.levels.iter().map(|level| plain(level)));
    head.extend(texts(&["χ²", "p", "exact p", "p Holm", "W", "W, 95 %"]));
    let width = head.len();
    let rows: Vec<Vec<String>> = block.tests.iter().map(|test| row(test, width)).collect();
    page.table(&head, numbers, rows);
    page.paragraph(format!(
        "Means with standard deviations. χ² has {} degrees of freedom. Holm adjusts over the {}. \
         Each n counts people with an answer under every level.",
        block.levels.len().saturating_sub(1),
        many(block.tests.iter().filter(|test| test.outcome.is_some()).count(), "test")
    ));
    if let Some(adjust) = block.adjust {
        pairs(page, block, adjust);
    }
}

/// Item and level of `within`, the first cells of a test's rows.
fn begin(test: &FriedmanTest) -> Vec<String> {
    std::iter::once(&test.item).chain(&test.within).map(|text| plain(text)).collect()
}

fn row(test: &FriedmanTest, width: usize) -> Vec<String> {
    let mut row = begin(test);
    row.push(test.people.to_string());
    if let Some(outcome) = &test.outcome {
        let Outcome { levels, friedman, p_exact, p_holm, w_interval, .. } = outcome;
        row.extend(levels.iter().map(|level| mean(&level.answers)));
        row.push(format!("{:.2}", friedman.chi_square));
        row.push(p(friedman.p));
        row.push(p_exact.map_or_else(String::new, p));
        row.push(p(*p_holm));
        row.push(format!("{:.2}", friedman.w));
        row.push(interval(*w_interval));
    }
    row.resize(width, String::new());
    row
}

fn pairs(page: &mut Page, block: &FriedmanBlock, adjust: Adjust) {
    let mut rows = Vec::new();
    for test in &block.tests {
        for pair in test.outcome.iter().filter_map(|outcome| outcome.pairs.as_ref()).flatten() {
            let mut row = begin(test);
            row.push(format!("{} to {}", plain(&pair.first), plain(&pair.second)));
            row.push(pair.wilcoxon.ranked.to_string());
            row.push(p(pair.wilcoxon.p) + if pair.wilcoxon.exact { "" } else { " (normal)" });
            if adjust != Adjust::Holm {
                row.push(p(pair.p_adjusted));
            }
            row.push(p(pair.p_holm));
            row.push(format!("{:.2}", pair.wilcoxon.r));
            row.push(format!("{:.2}", pair.wilcoxon.rank_biserial));
            row.push(format!("{:.2}", pair.shift.estimate));
            row.push(interval(pair.shift.interval));
            rows.push(row);
        }
    }
    if rows.is_empty() {
        page.paragraph(format!("No test has p below {LEVEL}, so no pairs are compared."));
        return;
    }
    let mut head = vec!["item".to_owned()];
    head.extend(block.within.iter().cloned());
    head.push("pair".to_owned());
    let numbers = head.len();
    head.extend(texts(&["ranked", "p"]));
    if adjust != Adjust::Holm {
        head.push("p Bonferroni".to_owned());
    }
    head.extend(texts(&["p Holm", "r", "rank-biserial", "shift", "shift, 95 %"]));
    page.table(&head, numbers, rows);
    let zeros = match block.zeros {
        Some(Zeros::Pratt) => "ranks differences of 0, then drops them (Pratt)",
        _ => "drops differences of 0",
    };
    page.paragraph(format!(
        "Wilcoxon's signed ranks follow each test with p below {LEVEL}. The test {zeros}. p is exact unless marked. \
         Adjusted p hold within a test. Differences are the second level less the first; shift is the Hodges-Lehmann estimate."
    ));
}

fn confusion(page: &mut Page, block: &ConfusionBlock) {
    let (Some(found), Some(people)) = (&block.statistics, &block.over_people) else {
        page.paragraph("No answer counts.");
        return;
    };
    let mut head = texts(&["shown"]);
    head.extend(block.classes.iter().map(|class| plain(class)));
    head.extend(texts(&["recall", "recall, 95 %", "precision", "precision, 95 %", "unbiased hit rate"]));
    let share = |share: Option<f64>| share.map_or_else(String::new, percent);
    let rows: Vec<Vec<String>> = block
        .classes
        .iter()
        .zip(block.counts.iter().zip(&found.classes))
        .map(|(class, (counts, of))| {
            let mut row = vec![plain(class)];
            row.extend(counts.iter().map(u64::to_string));
            row.extend([share(of.recall), percents(of.recall_interval)]);
            row.extend([share(of.precision), percents(of.precision_interval)]);
            row.push(of.unbiased_hit_rate.map_or_else(String::new, |rate| format!("{rate:.2}")));
            row
        })
        .collect();
    page.table(&head, 1, rows);
    page.figure(
        &figures::confusion(block),
        "What was shown (rows) and what was answered (columns), in percent of each row.",
    );
    page.paragraph("Columns are answers. Intervals of recall and precision are Wilson's.");
    let kappa = found.kappa.as_ref().map_or_else(
        || "kappa is undefined".to_owned(),
        |kappa| format!("kappa {:.2} (95 % {})", kappa.kappa, interval(kappa.interval)),
    );
    page.list(vec![
        format!("{} of {} answers right, by {}", found.right, found.answers, many(people.people, "person")),
        format!("accuracy {} (95 % over people {})", percent(people.accuracy), percents(people.interval)),
        format!("if all answers were independent: 95 % {} (Wilson)", percents(found.accuracy_interval)),
        kappa,
        format!(
            "chance {}; p {} of so many right answers by chance",
            percent(found.chance),
            p(found.p_above_chance)
        ),
    ]);
}
