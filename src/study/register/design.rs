//! The design: what is shown, who gets what, and who knows.

use super::Source;
use super::page::Page;
use crate::study::file::{Design, Seeds, Show};
use crate::study::plan::TrialsStep;
use crate::study::plan::blocks::Blocks;
use crate::study::plan::square::Square;

pub(super) fn write(page: &mut Page, from: &Source<'_>) {
    page.section("Design plan");
    page.field("Study type");
    if from.plan.counted().any(|(_, _, step)| step.design.is_some()) {
        page.text("Experiment. The plan assigns stimuli to participants, and each sees several (within participants).");
    } else {
        page.blank("the type of the study; every participant sees the same stimuli in the same order");
    }
    page.field("Blinding");
    page.text("No page, address or file name tells a participant the condition, the acted emotion or the label of a stimulus.");
    page.blank(
        "who else knows which participant sees what; operators can see the current page of a participant",
    );
    page.field("Is there any additional blinding in this study?");
    page.blank("whether the analysts are blind to conditions");
    page.field("Study design");
    let parts: Vec<String> =
        from.plan.counted().map(|(_, name, step)| format!("`{name}`: {}", shown(from, name, step))).collect();
    page.list_or_blank(&parts, "the design; the file has no counted trials");
    page.field("Randomization");
    let parts: Vec<String> =
        from.plan.counted().map(|(_, name, step)| format!("`{name}`: {}", assigned(step))).collect();
    page.list_or_blank(&parts, "the assignment; the file has no counted trials");
}

/// What a part shows.
fn shown(from: &Source<'_>, name: &str, step: &TrialsStep) -> String {
    let Some(trials) = from.file.parts.get(name).and_then(crate::study::file::Part::trials) else {
        return String::new();
    };
    let Show { gaits, scenes, agents, conditions, condition, seconds, plays, replay, .. } = &trials.show;
    let mut said = Vec::new();
    if let Some(library) = gaits {
        said.push(format!("{} gaits of `{library}`", step.stimuli.len()));
    }
    if let Some(scenes) = scenes {
        said.push(format!("scenes {}", scenes.join(", ")));
    }
    if let Some(agents) = agents {
        said.push(format!("single agents: {} x {}", agents.each_of.join(", "), agents.bodies.join(", ")));
    }
    match (conditions, condition) {
        (Some(all), _) => said.push(format!("conditions {}, within participants", all.join(", "))),
        (None, Some(one)) => said.push(format!("condition {one}")),
        (None, None) => {}
    }
    let replay = if *replay { ", may be played again" } else { "" };
    let plays = if *plays == 1 { "once".to_owned() } else { format!("{plays} times") };
    said.push(format!("{seconds} s each, played {plays}{replay}"));
    said.push(format!("{} trials of one participant", from.plan.trial_count(step)));
    if step.repeat > 0 {
        said.push(format!("{} of them show a stimulus a second time", step.repeat));
    }
    if step.catches > 0 {
        said.push(format!("{} of them show nothing and ask for a certain answer", step.catches));
    }
    said.join("; ")
}

/// Who gets what.
fn assigned(step: &TrialsStep) -> String {
    let seeds = match step.seeds {
        Seeds::PerBlock => "; the trials of a block show the same people",
        Seeds::PerTrial => "",
    };
    let balance = match &step.design {
        Some(Design::Fill { each, at_least }) => format!(
            "each participant gets the {each} stimuli with the fewest answers and leases, ties drawn by the seed, in a drawn order, \
             until every stimulus has {at_least} answers"
        ),
        Some(Design::Blocks { .. }) => {
            let conditions = step.conditions.max(1);
            let scenes = step.stimuli.len() / conditions;
            format!(
                "one block a scene; scenes and conditions in the orders of Williams squares, {} rows; rows are handed out so that \
                 their numbers differ by one at most",
                Blocks::new(scenes, conditions).rows()
            )
        }
        Some(Design::Square) => format!(
            "all stimuli, in the orders of a Williams square of {} rows; rows are handed out in turn",
            Square::new(step.stimuli.len()).rows()
        ),
        None => "every participant gets all stimuli in the order of the file".to_owned(),
    };
    format!("{balance}{seeds}")
}
