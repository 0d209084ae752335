//! The analysis that the file plans.

use super::Source;
use super::page::Page;
use crate::study::analyse::{CONFIDENCE, DRAWS, LEVEL};
use crate::study::file::{Adjust, Exclude, FollowUp, OnWithdrawal, Test, Zeros};

pub(super) fn write(page: &mut Page, from: &Source<'_>) {
    page.section("Analysis plan");
    page.field("Statistical models");
    let mut tests: Vec<String> = from.file.analysis.tests.iter().map(test).collect();
    if let Some(ratings) = &from.file.analysis.ratings {
        tests.push(format!(
            "agreement of raters in `{}`: ICC(1,1), ICC(1,k), Krippendorff's alpha, and the share of {DRAWS} resamples of raters \
             in which a label stays",
            ratings.part
        ));
    }
    page.list_or_blank(&tests, "the tests; the file plans none");
    page.field("Transformations");
    page.text("None, but that reversed items of questionnaires are turned round.");
    page.field("Inference criteria");
    if from.file.analysis.tests.is_empty() {
        page.blank("what counts as evidence; the file plans no test");
    } else {
        page.text(&format!(
            "The level is {LEVEL}. Wilcoxon's tests are two-sided, the test against chance is one-sided. Intervals have {:.0} %. \
             Every p is printed as it is; those of Friedman's and Wilcoxon's tests are printed adjusted, too.",
            100.0 * CONFIDENCE
        ));
    }
    page.field("Data exclusion");
    let rules = exclusions(&from.file.exclude);
    if rules.is_empty() {
        page.text("The file has no rule that excludes a participant.");
    } else {
        page.list(&rules);
        page.text("Every result is computed with and without the excluded; the one without them counts.");
    }
    page.text("An operator may exclude a participant with a reason. The answers stay, and the report names the number.");
    page.field("Missing data");
    page.text(
        "A participant counts in a test if all answers that the test compares are there. Nothing is imputed.",
    );
    page.text(match from.file.consent.on_withdrawal {
        OnWithdrawal::Delete => "Answers of participants who withdraw are deleted.",
        OnWithdrawal::KeepAnonymous => {
            "Answers of participants who withdraw stay, without anything that leads to the participant."
        }
    });
    page.field("Exploratory analysis");
    page.blank("what is looked at without a hypothesis, if anything");
}

fn test(test: &Test) -> String {
    match test {
        Test::Friedman { of, by, within, then } => {
            let each = within.as_ref().map_or_else(
                || format!("one test an item, each participant's mean over everything but {by}"),
                |within| format!("one test an item and {within}"),
            );
            let then = then.as_ref().map_or_else(String::new, follow_up);
            format!(
                "`{of}`: Friedman's test compares the levels of {by} over participants, {each}; chi-square and exact p, \
                 Kendall's W, p adjusted by Holm over all of them{then}"
            )
        }
        Test::Confusion { of } => format!(
            "`{of}`: table of what was shown and what was answered; accuracy with a bootstrap over participants, Cohen's kappa, \
             recall and precision with Wilson's intervals, a binomial test against chance"
        ),
    }
}

fn follow_up(then: &FollowUp) -> String {
    let FollowUp::Wilcoxon { adjust, zeros } = then;
    let adjust = match adjust {
        Adjust::Bonferroni => "Bonferroni (Holm is printed too)",
        Adjust::Holm => "Holm",
    };
    let zeros = match zeros {
        Zeros::Wilcoxon => "dropped",
        Zeros::Pratt => "ranked and then dropped (Pratt)",
    };
    format!(
        "; where p is below {LEVEL}, Wilcoxon's signed ranks for every pair, adjusted within a test by {adjust}, differences of 0 {zeros}"
    )
}

fn exclusions(rules: &Exclude) -> Vec<String> {
    let Exclude { failed_catch, median_ms_below, same_answer_share, late_frames_share } = rules;
    let mut said = Vec::new();
    said.extend(failed_catch.map(|least| format!("instructed answers given wrongly: {least} or more")));
    said.extend(median_ms_below.map(|ms| format!("median time of an answer below {ms} ms")));
    said.extend(
        same_answer_share
            .map(|share| format!("share of the most frequent answer to a question above {share}")),
    );
    said.extend(late_frames_share.map(|share| format!("share of late frames above {share}")));
    said
}
