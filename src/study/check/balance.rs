//! Whether the announced numbers of participants and minutes fit the plan.

use super::notes::Notes;
use super::summary::Summary;
use crate::study::file::Design;
use crate::study::plan::Plan;
use crate::study::plan::blocks::Blocks;

pub(super) fn check(notes: &mut Notes<'_>, plan: &Plan, summary: &Summary) {
    let key = "recruit.most_participants";
    let most = plan.most_participants as usize;
    let multiple = summary.multiple;
    if most < summary.least && multiple == 1 {
        let hint = "allow more, or ask for fewer answers of a stimulus";
        notes.error(key, most, format!("{} or more", summary.least), hint);
    } else if most < multiple {
        let hint =
            format!("{most} participants cannot be balanced over {multiple} rows: good for a pilot alone");
        notes.warn(key, most, format!("{multiple} or a multiple"), hint);
    } else if !most.is_multiple_of(multiple) {
        let below = most / multiple * multiple;
        let hint = format!("{most} participants cannot be balanced over {multiple} rows");
        notes.warn(key, most, format!("{below} or {}", below + multiple), hint);
    } else if multiple == 1 && most < summary.with_drop_outs {
        let hint = "or else drop-outs may leave stimuli below at_least";
        notes.warn(key, most, format!("about {} if 3 in 10 leave", summary.with_drop_outs), hint);
    }
    let announced = notes.file().study.minutes;
    if summary.minutes > 1.25 * f64::from(announced) {
        let hint = "the welcome page announces it, and platforms pay by it";
        notes.warn("study.minutes", announced, format!("about {:.0}", summary.minutes.ceil()), hint);
    }
    for (_, name, step) in plan.counted() {
        let conditions = step.conditions.max(1);
        let scenes = step.stimuli.len() / conditions;
        let is_blocks = matches!(step.design, Some(Design::Blocks { .. }));
        if is_blocks && !Blocks::new(scenes, conditions).balances_across_blocks() {
            let hint =
                "within a block all is balanced; the paper's four scenes and three conditions are in full";
            let allowed = "4 scenes and 3 conditions, for balance of conditions across blocks, too";
            let found = format!("{scenes} scenes, {conditions} conditions");
            notes.warn(&format!("part.{name}.design"), found, allowed, hint);
        }
    }
}
