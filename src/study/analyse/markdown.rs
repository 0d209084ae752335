//! An analysis as a page.

use super::{Analysis, Conditions, Finding, Identified, Reason};
use crate::emotion::Emotion;
use std::fmt;

impl fmt::Display for Analysis {
    /// Markdown.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "# Results of {}, version {}\n", self.study, self.version)?;
        if self.is_simulated {
            writeln!(f, "The participants are simulated. This says nothing about people.\n")?;
        }
        writeln!(f, "## Participants\n\n| state | participants |\n|---|---:|")?;
        self.states.iter().try_for_each(|(state, count)| writeln!(f, "| {state} | {count} |"))?;
        let (kept, out) = (self.finished - self.excluded.len(), self.excluded.len());
        writeln!(
            f,
            "\n{} finished. The rules of the study file leave {out} of them out; {kept} count.",
            self.finished
        )?;
        for one in &self.excluded {
            let reasons: Vec<String> = one.reasons.iter().map(ToString::to_string).collect();
            writeln!(f, "\n- participant {}: {}", one.participant, reasons.join("; "))?;
        }
        self.results.iter().try_for_each(|finding| finding.fmt(f))?;
        if out > 0 && !self.with_excluded.is_empty() {
            writeln!(f, "\n# The same with the {out} that were left out")?;
            self.with_excluded.iter().try_for_each(|finding| finding.fmt(f))?;
        }
        Ok(())
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FailedCatch { found } => write!(f, "{found} instructed trials answered wrongly"),
            Self::MedianMsBelow { found } => write!(f, "median time of an answer {found} ms"),
            Self::SameAnswerShare { found } => {
                write!(f, "{:.0} % of the answers are the same", 100.0 * found)
            }
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Friedman(found) => friedman(f, found),
            Self::Confusion(found) => confusion(f, found),
        }
    }
}

fn friedman(f: &mut fmt::Formatter<'_>, found: &Conditions) -> fmt::Result {
    writeln!(f, "\n## {} by {}\n", found.of, found.by)?;
    let means: String = found.levels.iter().map(|level| format!(" {level} |")).collect();
    writeln!(f, "| item | within | n |{means} chi-square | p | p exact | p Holm | W (95 %) |")?;
    writeln!(f, "|---|---|---:|{}---:|---:|---:|---:|---|", "---:|".repeat(found.levels.len()))?;
    for test in &found.tests {
        let means: String = test
            .answers
            .iter()
            .map(|one| {
                let deviation = one.deviation.map_or_else(String::new, |sd| format!(" ({sd:.2})"));
                format!(" {:.2}{deviation} |", one.mean)
            })
            .collect();
        let [low, high] = test.w_interval;
        writeln!(
            f,
            "| {} | {} | {} |{means} {:.2} | {} | {} | {} | {:.2} ({low:.2} to {high:.2}) |",
            test.item,
            test.within.as_deref().unwrap_or(""),
            test.friedman.people,
            test.friedman.chi_square,
            p(test.friedman.p),
            test.exact_p.map_or_else(String::new, p),
            p(test.p_holm),
            test.friedman.w,
        )?;
    }
    writeln!(f, "\nMeans, with standard deviations. Pairs are compared where p is below .05:\n")?;
    writeln!(f, "| item | within | pair | Z | p | p adjusted | p Holm | rank-biserial | shift (95 %) |")?;
    writeln!(f, "|---|---|---|---:|---:|---:|---:|---:|---|")?;
    for (test, pair) in found.tests.iter().flat_map(|test| test.pairs.iter().map(move |pair| (test, pair))) {
        let [first, second] = &pair.levels;
        let [low, high] = pair.shift.interval;
        writeln!(
            f,
            "| {} | {} | {second} - {first} | {:.2} | {} | {} | {} | {:.2} | {:.2} ({low:.2} to {high:.2}) |",
            test.item,
            test.within.as_deref().unwrap_or(""),
            pair.wilcoxon.z,
            p(pair.wilcoxon.p),
            p(pair.p_adjusted),
            p(pair.p_holm),
            pair.wilcoxon.rank_biserial,
            pair.shift.estimate,
        )?;
    }
    Ok(())
}

fn confusion(f: &mut fmt::Formatter<'_>, found: &Identified) -> fmt::Result {
    let names: String = Emotion::ALL.map(|emotion| format!(" {emotion} |")).concat();
    writeln!(f, "\n## {}\n\n| shown |{names} recall % (95 %) | precision % (95 %) |", found.of)?;
    writeln!(f, "|---|---:|---:|---:|---:|---|---|")?;
    let share = |share: Option<f64>, [low, high]: [f64; 2]| {
        let [low, high] = [low, high].map(|end| 100.0 * end);
        share.map_or_else(String::new, |share| format!("{:.1} ({low:.0} to {high:.0})", 100.0 * share))
    };
    for ((emotion, counts), class) in Emotion::ALL.into_iter().zip(found.counts).zip(&found.confusion.classes)
    {
        let counts: String = counts.map(|count| format!(" {count} |")).concat();
        let recall = share(class.recall, class.recall_interval);
        writeln!(
            f,
            "| {emotion} |{counts} {recall} | {} |",
            share(class.precision, class.precision_interval)
        )?;
    }
    let all = &found.confusion;
    let [low, high] = all.accuracy_interval.map(|end| 100.0 * end);
    let [least, most] = found.over_people.interval.map(|end| 100.0 * end);
    writeln!(f, "\n- right answers: {} of {}, {:.1} %", all.right, all.answers, 100.0 * all.accuracy)?;
    writeln!(
        f,
        "- 95 % interval: {low:.1} to {high:.1} % by Wilson, {least:.1} to {most:.1} % by a bootstrap over people"
    )?;
    if let Some(kappa) = &all.kappa {
        writeln!(f, "- Cohen's kappa: {:.2}", kappa.kappa)?;
    }
    writeln!(
        f,
        "- p of so many right answers by chance ({:.0} %): {}",
        100.0 * all.chance,
        p(all.p_above_chance)
    )
}

/// A probability with three digits after the point, or in powers of ten.
fn p(value: f64) -> String {
    if value >= 0.001 { format!("{value:.3}") } else { format!("{value:.1e}") }
}
