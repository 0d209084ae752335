//! The facts as tables in Markdown.

use super::{CONFUSION, EMOTIONS, Recomputed};
use std::fmt::{Result, Write};

/// All facts as Markdown: the part of `docs/statistics.md` that the program writes.
pub fn markdown(facts: &Recomputed) -> String {
    let mut page = String::new();
    // writing to a string cannot fail
    let _ = write(&mut page, facts);
    page
}

fn write(page: &mut String, facts: &Recomputed) -> Result {
    friedman(page, facts)?;
    wilcoxon(page, facts)?;
    confusion(page, facts)?;
    writeln!(page, "### Power of what was seen\n")?;
    writeln!(page, "| W | people | power, limit | power, finite |\n|---:|---:|---:|---:|")?;
    for fact in &facts.power {
        let [limit, finite] = [fact.power, fact.power_finite].map(|power| 100.0 * power);
        writeln!(page, "| {:.2} | {} | {limit:.1} % | {finite:.1} % |", fact.w, fact.people)?;
    }
    writeln!(page, "\n### Not recoverable\n")?;
    for missing in &facts.not_recoverable {
        writeln!(page, "- {missing}")?;
    }
    Ok(())
}

fn friedman(page: &mut String, facts: &Recomputed) -> Result {
    let all = facts.friedman.len();
    writeln!(page, "### Friedman tests\n")?;
    writeln!(page, "| | scenario | chi-square | p printed | p | p by Holm | W | without ties |")?;
    writeln!(page, "|---|---|---:|---:|---:|---:|---:|---|")?;
    for fact in &facts.friedman {
        let ties = match (fact.without_ties_if_rounded, fact.without_ties) {
            (true, _) => "possible",
            (false, true) => "if cut off",
            (false, false) => "impossible",
        };
        writeln!(
            page,
            "| {} | {} | {:.2} | {:.2} | {:.2e} | {:.2e} | {:.2} | {ties} |",
            fact.question, fact.scenario, fact.chi_square, fact.printed_p, fact.p, fact.p_holm, fact.w
        )?;
    }
    writeln!(page, "\n- p that follow from their chi-square: {} of {all}", facts.p_that_follow)?;
    writeln!(page, "- significant at .05: {} of {all}", facts.significant)?;
    writeln!(page, "- significant after Holm over all tests: {} of {all}", facts.significant_by_holm)?;
    writeln!(
        page,
        "- significant after Bonferroni over all tests: {} of {all}",
        facts.significant_by_bonferroni
    )?;
    writeln!(page, "- impossible without ties, if rounded: {} of {all}", facts.need_ties_if_rounded)?;
    writeln!(page, "- impossible without ties, rounded or cut off: {} of {all}\n", facts.need_ties)
}

fn wilcoxon(page: &mut String, facts: &Recomputed) -> Result {
    let all = facts.pairs;
    writeln!(page, "### Wilcoxon tests\n")?;
    writeln!(page, "- significant at p < .017: {} of {all}", facts.pairs_significant)?;
    writeln!(page, "- significant by Holm in each cell of three: {} of {all}", facts.pairs_by_holm)?;
    writeln!(page, "- found at p < .017 and not by Holm: {}\n", facts.holm_loses.len())?;
    writeln!(page, "| Holm adds | scenario | pair | p printed | p by Holm |\n|---|---|---|---:|---:|")?;
    for pair in &facts.holm_adds {
        writeln!(
            page,
            "| {} | {} | {} | {:.3} | {:.3} |",
            pair.question, pair.scenario, pair.pair, pair.printed_p, pair.p_holm
        )?;
    }
    writeln!(page)
}

fn confusion(page: &mut String, facts: &Recomputed) -> Result {
    let found = &facts.confusion;
    let interval = |[low, high]: [f64; 2], digits: usize| {
        format!("{:.digits$} to {:.digits$}", 100.0 * low, 100.0 * high)
    };
    writeln!(page, "### Confusion matrix\n")?;
    writeln!(page, "| shown | happy | angry | sad | neutral | recall % | precision % | unbiased hit rate |")?;
    writeln!(page, "|---|---:|---:|---:|---:|---|---|---:|")?;
    for ((emotion, counts), class) in EMOTIONS.iter().zip(CONFUSION).zip(&found.classes) {
        write!(page, "| {emotion} |")?;
        for count in counts {
            write!(page, " {count} |")?;
        }
        let share = |share: Option<f64>| 100.0 * share.unwrap_or(f64::NAN);
        writeln!(
            page,
            " {:.1} ({}) | {:.1} ({}) | {:.3} |",
            share(class.recall),
            interval(class.recall_interval, 0),
            share(class.precision),
            interval(class.precision_interval, 0),
            class.unbiased_hit_rate.unwrap_or(f64::NAN)
        )?;
    }
    let accuracy = 100.0 * found.accuracy;
    writeln!(page, "\n- right answers: {} of {}, {accuracy:.2} %", found.right, found.answers)?;
    writeln!(page, "- 95 % interval by Wilson: {} %", interval(found.accuracy_interval, 1))?;
    if let Some(kappa) = &found.kappa {
        writeln!(page, "- Cohen's kappa: {:.2}, standard error {:.3}", kappa.kappa, kappa.error)?;
    }
    writeln!(page, "- p of so many right answers by chance (25 %): {:.1e}", found.p_above_chance)?;
    for cell in &facts.misprinted {
        writeln!(
            page,
            "- misprinted: {} shown, {} answered, {}/{} = {:.2} %, printed {:.2} %",
            cell.desired, cell.answered, cell.count, cell.of, cell.rounded, cell.printed
        )?;
    }
    writeln!(page)
}
