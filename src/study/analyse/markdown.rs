//! An analysis as one Markdown page.

use super::{
    Analysis, ConfusionBlock, Excluded, FriedmanBlock, FriedmanTest, LEVEL, Outcome, Reason, Rule, Sides,
    Test,
};
use crate::statistics::Description;
use crate::study::file::{Adjust, Zeros};
use crate::study::tables::name;

/// The page: who took part, exclusions, the tests without and with the excluded, remarks.
pub fn markdown(analysis: &Analysis) -> String {
    let mut page = Page::default();
    let title = if analysis.title.is_empty() { &analysis.study } else { &analysis.title };
    page.heading(1, title);
    page.paragraph(&format!("Study `{}`, version {}.", analysis.study, analysis.version));
    if analysis.participants.is_simulated {
        page.paragraph("**All participants are simulated.** These numbers describe a model, not people.");
    }
    if analysis.is_short {
        page.paragraph("**The data fall short of the plan.** The remarks say where.");
    }
    participants(&mut page, analysis);
    exclusions(&mut page, analysis);
    for test in &analysis.tests {
        match test {
            Test::Friedman(sides) => both(&mut page, sides, &format!("`{}`", sides.kept.of), friedman),
            Test::Confusion(sides) => both(&mut page, sides, &format!("`{}`", sides.kept.of), confusion),
        }
    }
    remarks(&mut page, analysis);
    page.text
}

/// Markdown, as it grows.
#[derive(Default)]
struct Page {
    text: String,
}

impl Page {
    fn paragraph(&mut self, text: &str) {
        if !self.text.is_empty() {
            self.text.push('\n');
        }
        self.text.push_str(text);
        self.text.push('\n');
    }

    fn heading(&mut self, level: usize, text: &str) {
        self.paragraph(&format!("{} {}", "#".repeat(level), plain(text)));
    }

    /// A table; columns from `numbers` on are numbers.
    fn table(&mut self, head: &[String], numbers: usize, rows: &[Vec<String>]) {
        let line = |cells: &[String]| format!("| {} |", cells.join(" | "));
        let rule = (0..head.len()).map(|column| if column < numbers { "---" } else { "---:" }.to_owned());
        let mut lines = vec![line(head), line(&rule.collect::<Vec<_>>())];
        lines.extend(rows.iter().map(|row| line(row)));
        self.paragraph(&lines.join("\n"));
    }

    fn list(&mut self, items: &[String]) {
        self.paragraph(&items.iter().map(|item| format!("- {item}")).collect::<Vec<_>>().join("\n"));
    }
}

/// Text of the study file or the tables, so that Markdown takes no sign of it for its own.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    for letter in text.split_whitespace().collect::<Vec<_>>().join(" ").chars() {
        if "\\`*_{}[]<>#|&".contains(letter) {
            plain.push('\\');
        }
        plain.push(letter);
    }
    plain
}

fn texts(cells: &[&str]) -> Vec<String> {
    cells.iter().map(|&cell| cell.to_owned()).collect()
}

/// A count with its noun.
fn many(count: usize, noun: &str) -> String {
    match (count, noun) {
        (1, _) => format!("1 {noun}"),
        (_, "person") => format!("{count} people"),
        _ => format!("{count} {noun}s"),
    }
}

fn p(value: f64) -> String {
    if value < 0.001 { "< 0.001".to_owned() } else { format!("{value:.3}") }
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

fn interval([low, high]: [f64; 2]) -> String {
    format!("{low:.2} to {high:.2}")
}

fn percents([low, high]: [f64; 2]) -> String {
    format!("{:.1} to {:.1} %", 100.0 * low, 100.0 * high)
}

fn mean(of: &Description) -> String {
    match of.deviation {
        Some(deviation) => format!("{:.2} ({deviation:.2})", of.mean),
        None => format!("{:.2}", of.mean),
    }
}

fn participants(page: &mut Page, analysis: &Analysis) {
    let all = &analysis.participants;
    page.heading(2, "Participants");
    let fronts: Vec<String> =
        all.fronts.iter().map(|(front, count)| format!("{count} {}", name(front))).collect();
    let by = if fronts.is_empty() { String::new() } else { format!(" ({})", fronts.join(", ")) };
    page.paragraph(&format!("{} arrived{by}. {} got a place.", many(all.arrived, "participant"), all.placed));
    let rows: Vec<Vec<String>> =
        all.states.iter().map(|(state, count)| vec![state.clone(), count.to_string()]).collect();
    page.table(&texts(&["state", "participants"]), 1, &rows);
    if analysis.parts.is_empty() {
        return;
    }
    let rows: Vec<Vec<String>> = analysis
        .parts
        .iter()
        .map(|part| {
            let gaits = part.gaits.map_or(String::new(), |gaits| {
                format!("{} ({} to {} answers each)", gaits.count, gaits.fewest, gaits.most)
            });
            let counts = [part.people, part.complete, part.answers].map(|count| count.to_string());
            std::iter::once(plain(&part.part)).chain(counts).chain([gaits]).collect()
        })
        .collect();
    page.table(&texts(&["part", "people", "complete", "answers", "gaits"]), 1, &rows);
    page.paragraph("The counts of parts leave the excluded participants out.");
}

fn exclusions(page: &mut Page, analysis: &Analysis) {
    let exclusions = &analysis.exclusions;
    page.heading(2, "Exclusions");
    let rules = &exclusions.rules;
    let written = [
        rules
            .failed_catch
            .map(|least| format!("{} or more with a wrong answer", many(least as usize, "instructed trial"))),
        rules.median_ms_below.map(|below| format!("a median time of an answer below {below} ms")),
        rules.same_answer_share.map(|above| format!("one answer in more than {} of all", percent(above))),
        rules.late_frames_share.map(|above| format!("more than {} of frames late", percent(above))),
    ];
    let written: Vec<String> = written.into_iter().flatten().collect();
    if written.is_empty() {
        page.paragraph("The study file has no rule of exclusion.");
    } else {
        page.paragraph("The study file excludes a participant for any of these:");
        page.list(&written);
    }
    if exclusions.excluded.is_empty() {
        page.paragraph("No participant is excluded.");
        return;
    }
    page.paragraph(&format!(
        "{} excluded. Every test follows without and with them.",
        many(exclusions.excluded.len(), "participant")
    ));
    let row = |one: &Excluded| {
        vec![plain(&one.participant), one.reasons.iter().map(reason).collect::<Vec<_>>().join("; ")]
    };
    let rows: Vec<Vec<String>> = exclusions.excluded.iter().map(row).collect();
    page.table(&texts(&["participant", "reasons"]), 2, &rows);
}

fn reason(reason: &Reason) -> String {
    match reason {
        Reason::Operator => "excluded by the operator".to_owned(),
        Reason::FailedCatch { failed, .. } => {
            format!("{} with a wrong answer", many(*failed as usize, "instructed trial"))
        }
        Reason::MedianMsBelow { median, .. } => format!("median time of an answer {median:.0} ms"),
        Reason::SameAnswerShare { question, share, .. } => {
            format!("one answer in {} of `{question}`", percent(*share))
        }
        Reason::LateFramesShare { share, .. } => format!("{} of frames late", percent(*share)),
    }
}

/// A test without the excluded, and with them.
fn both<T>(page: &mut Page, sides: &Sides<T>, of: &str, write: impl Fn(&mut Page, &T)) {
    page.paragraph(&format!(
        "## {of}{}",
        if sides.everyone.is_some() { ", without the excluded" } else { "" }
    ));
    write(page, &sides.kept);
    if let Some(everyone) = &sides.everyone {
        page.paragraph(&format!("## {of}, with the excluded"));
        write(page, everyone);
    }
}

fn friedman(page: &mut Page, block: &FriedmanBlock) {
    let over = block.within.as_ref().map_or_else(String::new, |within| format!(" for each {within}"));
    page.paragraph(&format!("Friedman's test compares the levels of {}{over}.", block.by));
    let mut seen: Vec<&str> = Vec::new();
    let statements = block.tests.iter().filter(|test| {
        let is_new = !seen.contains(&test.item.as_str());
        seen.push(&test.item);
        is_new && !test.text.is_empty()
    });
    let statements: Vec<String> =
        statements.map(|test| format!("{}: {}", plain(&test.item), plain(&test.text))).collect();
    if !statements.is_empty() {
        page.list(&statements);
    }
    let mut head = vec!["item".to_owned()];
    head.extend(block.within.iter().cloned());
    let numbers = head.len();
    head.push("n".to_owned());
    head.extend(block.levels.iter().map(|level| plain(level)));
    head.extend(texts(&["χ²", "p", "exact p", "p Holm", "W", "W, 95 %"]));
    let width = head.len();
    let rows: Vec<Vec<String>> = block.tests.iter().map(|test| row(test, width)).collect();
    page.table(&head, numbers, &rows);
    page.paragraph(&format!(
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
        page.paragraph(&format!("No test has p below {LEVEL}, so no pairs are compared."));
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
    page.table(&head, numbers, &rows);
    let zeros = match block.zeros {
        Some(Zeros::Pratt) => "ranks differences of 0, then drops them (Pratt)",
        _ => "drops differences of 0",
    };
    page.paragraph(&format!(
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
    page.table(&head, 1, &rows);
    page.paragraph("Columns are answers. Intervals of recall and precision are Wilson's.");
    let kappa = found.kappa.as_ref().map_or_else(
        || "kappa is undefined".to_owned(),
        |kappa| format!("kappa {:.2} (95 % {})", kappa.kappa, interval(kappa.interval)),
    );
    page.list(&[
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

fn remarks(page: &mut Page, analysis: &Analysis) {
    let mut remarks = Vec::new();
    for part in &analysis.parts {
        if let Some(least) = part.short_of {
            let name = plain(&part.part);
            remarks.push(match part.gaits {
                Some(gaits) => format!(
                    "Part {name}: a gait has {}; the plan asks for {least} or more of each gait.",
                    many(gaits.fewest, "answer")
                ),
                None => format!(
                    "Part {name}: {} answered all trials; the plan is complete with {least}.",
                    many(part.complete, "person")
                ),
            });
        }
    }
    for test in &analysis.tests {
        let (of, people, least) = match test {
            Test::Friedman(sides) => {
                let short = sides.kept.tests.iter().filter(|test| test.short_of.is_some());
                let fewest = short.min_by_key(|test| test.people);
                (&sides.kept.of, fewest.map_or(0, |test| test.people), fewest.and_then(|test| test.short_of))
            }
            Test::Confusion(sides) => (&sides.kept.of, sides.kept.people, sides.kept.short_of),
        };
        if let Some(least) = least {
            let people = many(people, "person");
            remarks.push(format!("Test `{of}` has as few as {people}; the plan is complete with {least}."));
        }
        if let Test::Friedman(sides) = test {
            let tests = || sides.kept.tests.iter();
            let empty = tests().filter(|test| test.outcome.is_none()).count();
            if empty > 0 {
                let tests = many(empty, "test");
                remarks.push(format!("Test `{of}`: {tests} without a complete participant."));
            }
            let is_long = |test: &&FriedmanTest| test.outcome.as_ref().is_some_and(|o| o.p_exact.is_none());
            let long = tests().filter(is_long).count();
            if long > 0 {
                let tests = many(long, "test");
                remarks.push(format!(
                    "Test `{of}`: {tests} without exact p, since the table is too large for it."
                ));
            }
        }
    }
    for rule in &analysis.exclusions.not_judged {
        let (rule, lacks) = match rule {
            Rule::FailedCatch => ("failed_catch", "instructed trials"),
            Rule::MedianMsBelow => ("median_ms_below", "times of answers"),
            Rule::SameAnswerShare => ("same_answer_share", "enough answers of any participant"),
            Rule::LateFramesShare => ("late_frames_share", "counts of frames"),
        };
        remarks.push(format!("The rule `{rule}` could not be applied: the tables lack {lacks}."));
    }
    if analysis.free_texts > 0 {
        let texts = many(analysis.free_texts, "free text");
        remarks.push(format!("Participants wrote {texts}. The table of answers has them."));
    }
    page.heading(2, "Remarks");
    if remarks.is_empty() {
        page.paragraph("None.");
    } else {
        page.list(&remarks);
    }
}
