//! Who takes part, how many, and when it ends.

use super::Source;
use super::page::Page;
use crate::statistics::power::friedman_power_finite;
use crate::study::analyse::LEVEL;
use crate::study::error::Error;
use crate::study::file::{Design, Platform, Test};
use crate::study::tables::name;

pub(super) fn write(page: &mut Page, from: &Source<'_>, data: Option<&str>) -> Result<(), Error> {
    page.section("Sampling plan");
    page.field("Existing data");
    match data {
        Some(data) => page.text(&format!(
            "Registration prior to creation of data. The program looked into `{data}`: no participant has had a place."
        )),
        None => page.blank("whether there are data already; with `--data` the program looks"),
    }
    page.field("Explanation of existing data");
    page.blank("of what kind existing data are, if there are any");
    page.field("Data collection procedures");
    procedures(page, from);
    page.field("Sample size");
    size(page, from);
    page.field("Sample size rationale");
    rationale(page, from)?;
    page.field("Stopping rule");
    stopping(page, from);
    Ok(())
}

fn procedures(page: &mut Page, from: &Source<'_>) {
    let file = from.file;
    let fronts = file.study.fronts.iter().map(name).collect::<Vec<_>>().join(", ");
    let platform = match file.recruit.platform {
        Platform::None | Platform::Links => {
            "Participants come by an address that the lab hands out.".to_owned()
        }
        platform => format!("Participants come by the platform {}.", name(&platform)),
    };
    page.list(&[
        platform,
        format!("Fronts: {fronts}. Languages: {}.", file.study.languages.join(", ")),
        format!(
            "Participants are at least {} years old and agree to `{}`.",
            file.consent.minimum_age,
            from.find(&file.consent.text)
        ),
    ]);
    page.blank("who is invited, what they are paid, when the study runs");
}

fn size(page: &mut Page, from: &Source<'_>) {
    let most = from.file.recruit.most_participants;
    if let Some(summary) = from.summary {
        let multiple = if summary.multiple > 1 {
            format!(" The design is balanced for multiples of {}.", summary.multiple)
        } else {
            String::new()
        };
        page.text(&format!(
            "The design is complete with {} participants if all stay, and with about {} if 3 in 10 leave.{multiple}",
            summary.least, summary.with_drop_outs
        ));
    }
    page.text(&format!("At most {most} participants are under way or finished."));
}

/// The power to find the effect that the file names.
fn rationale(page: &mut Page, from: &Source<'_>) -> Result<(), Error> {
    let levels: Vec<usize> =
        from.file.analysis.tests.iter().filter_map(|test| compared(from, test)).collect();
    let Some(w) = from.file.registration.smallest_w.filter(|_| !levels.is_empty()) else {
        page.blank(
            "why so many; `registration.smallest_w` in the study file computes the power of Friedman's test",
        );
        return Ok(());
    };
    let most = from.file.recruit.most_participants as usize;
    let least = from.summary.map_or(most, |summary| summary.least);
    let mut people = vec![least.min(most), most];
    people.dedup();
    let mut lines = Vec::new();
    for conditions in levels {
        for &people in &people {
            let power = friedman_power_finite(people, conditions, w, LEVEL);
            let wrong = |error: crate::statistics::Error| {
                Error::value("registration.smallest_w", w, "above 0 and below 1", error.to_string())
            };
            lines.push(format!(
                "{people} participants, {conditions} levels: power {:.1} % at alpha = {LEVEL}",
                100.0 * power.map_err(wrong)?
            ));
        }
    }
    lines.dedup();
    page.text(&format!(
        "The smallest effect of interest is Kendall's W = {w}. Power of one Friedman test, without adjustment for several tests \
         (noncentral chi-square, lambda = (n - 1) (k - 1) W / (1 - W)):"
    ));
    page.list(&lines);
    Ok(())
}

/// How many levels a test compares; none of a test that compares none.
fn compared(from: &Source<'_>, test: &Test) -> Option<usize> {
    let Test::Friedman { of, by, .. } = test else { return None };
    let part = of.split('.').next().unwrap_or_default();
    let step = from.plan.trials_of(part)?;
    let conditions = step.conditions.max(1);
    Some(if by == "scene" { step.stimuli.len() / conditions } else { conditions })
}

fn stopping(page: &mut Page, from: &Source<'_>) {
    let fills = from.plan.counted().filter_map(|(_, name, step)| match step.design {
        Some(Design::Fill { at_least, .. }) => {
            Some(format!("every stimulus of `{name}` has {at_least} answers"))
        }
        _ => None,
    });
    let fills: Vec<String> = fills.collect();
    let minutes = from.file.recruit.lease_minutes;
    if fills.is_empty() {
        page.text(&format!("Admission ends at {} participants.", from.file.recruit.most_participants));
    } else {
        page.text(&format!("Admission ends when {}.", fills.join(" and ")));
    }
    page.text(&format!(
        "A participant who is silent for {minutes} min loses the place, and it is given to the next one."
    ));
    page.blank("a date or a cost at which the study ends in any case, if there is one");
}
