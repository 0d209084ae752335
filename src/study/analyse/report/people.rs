//! Who took part, who was excluded, and what the reader has to know.

use super::figures;
use super::page::{Page, many, percent, plain, texts};
use crate::study::analyse::{Analysis, Excluded, FriedmanTest, Reason, Rule, Test};
use crate::study::tables::name;

pub(super) fn participants(page: &mut Page, analysis: &Analysis) {
    let all = &analysis.participants;
    page.heading(2, "Participants");
    let fronts: Vec<String> =
        all.fronts.iter().map(|(front, count)| format!("{count} {}", name(front))).collect();
    let by = if fronts.is_empty() { String::new() } else { format!(" ({})", fronts.join(", ")) };
    page.paragraph(format!("{} arrived{by}. {} got a place.", many(all.arrived, "participant"), all.placed));
    if !all.left_out.is_empty() {
        let fronts = all.left_out.iter().map(|(front, count)| format!("{count} {}", name(front)));
        page.paragraph(format!("Left out of this analysis: {}.", fronts.collect::<Vec<_>>().join(", ")));
    }
    let rows: Vec<Vec<String>> =
        all.states.iter().map(|(state, count)| vec![state.clone(), count.to_string()]).collect();
    page.table(&texts(&["state", "participants"]), 1, rows);
    page.figure(&figures::flow(analysis), "Participants at each step, and where the others went.");
    if analysis.parts.is_empty() {
        return;
    }
    let rows: Vec<Vec<String>> = analysis
        .parts
        .iter()
        .map(|part| {
            let gaits = part.gaits.as_ref().map_or(String::new(), |gaits| {
                format!("{} ({} to {} answers each)", gaits.count, gaits.fewest, gaits.most)
            });
            let counts = [part.people, part.complete, part.answers].map(|count| count.to_string());
            std::iter::once(plain(&part.part)).chain(counts).chain([gaits]).collect()
        })
        .collect();
    page.table(&texts(&["part", "people", "complete", "answers", "gaits"]), 1, rows);
    page.paragraph("The counts of parts leave the excluded participants out.");
    for (part, gaits) in analysis.parts.iter().filter_map(|part| Some((&part.part, part.gaits.as_ref()?))) {
        page.figure(&figures::answers_of_gaits(part, gaits), "Numbers of gaits by their number of answers.");
    }
}

pub(super) fn exclusions(page: &mut Page, analysis: &Analysis) {
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
        page.list(written);
    }
    if exclusions.excluded.is_empty() {
        page.paragraph("No participant is excluded.");
        return;
    }
    page.paragraph(format!(
        "{} excluded. Every test follows without and with them.",
        many(exclusions.excluded.len(), "participant")
    ));
    let row = |one: &Excluded| {
        vec![plain(&one.participant), one.reasons.iter().map(reason).collect::<Vec<_>>().join("; ")]
    };
    let rows: Vec<Vec<String>> = exclusions.excluded.iter().map(row).collect();
    page.table(&texts(&["participant", "reasons"]), 2, rows);
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

pub(super) fn remarks(page: &mut Page, analysis: &Analysis) {
    let mut remarks = Vec::new();
    for part in &analysis.parts {
        if let Some(least) = part.short_of {
            let name = plain(&part.part);
            remarks.push(match &part.gaits {
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
        page.list(remarks);
    }
}
