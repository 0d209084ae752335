//! Parts with trials.

use super::notes::Notes;
use super::parts::asked;
use crate::emotion::Emotion;
use crate::study::file::{Design, Question, Seeds, Show, Trials};
use crate::study::materials::Materials;
use crate::study::plan::williams;

/// Conditions of the paper (S-26).
const CONDITIONS: [&str; 3] = ["baseline", "eva-o", "eva-g"];

pub(super) fn check(notes: &mut Notes<'_>, key: &str, trials: &Trials, materials: &Materials) {
    asked(notes, &format!("{key}.ask"), &trials.ask);
    trials.after_block.iter().for_each(|names| asked(notes, &format!("{key}.after_block"), names));
    let stimuli = show(notes, &format!("{key}.show"), &trials.show, materials);
    match &trials.design {
        Some(Design::Fill { each, at_least }) => fill(notes, key, (*each, *at_least), stimuli),
        Some(Design::Blocks { blocks, within }) => self::blocks(notes, key, [blocks, within], &trials.show),
        Some(Design::Square) => {
            let found = stimuli.unwrap_or(2);
            size(notes, &format!("{key}.design"), found, "stimuli of a square");
        }
        None if trials.counted && trials.show.gaits.is_some() => {
            let hint = "add design = { kind = \"fill\", each = 10, at_least = 10 }";
            notes.warn(key, "no design", "designed: every participant sees every gait", hint);
        }
        None => {}
    }
    extras(notes, key, trials);
    let is_blocks = matches!(trials.design, Some(Design::Blocks { .. }));
    if !is_blocks && (trials.after_block.is_some() || trials.rest_after_blocks.is_some()) {
        let hint = "add design = { kind = \"blocks\", .. }, or remove after_block and rest_after_blocks";
        notes.error(key, "after_block or rest_after_blocks", "left out without blocks", hint);
    }
    if !is_blocks && trials.seeds == Seeds::PerBlock {
        notes.error(&format!("{key}.seeds"), "\"per-block\"", "\"per-trial\" without blocks", "remove it");
    }
    if let Some(every) = trials.rest_after_blocks {
        notes.within(&format!("{key}.rest_after_blocks"), every, [1, 12], "2 gives a rest every two blocks");
    }
}

/// Checks what is shown; returns the number of stimuli, if it is known.
fn show(notes: &mut Notes<'_>, key: &str, show: &Show, materials: &Materials) -> Option<usize> {
    let own = |name: &str| format!("{key}.{name}");
    notes.within(&own("seconds"), show.seconds, [0.5, 600.0], "walks take about 4 s, scenes 45 s");
    notes.within(&own("plays"), show.plays, [1, 10], "1 is once");
    let kinds = [show.gaits.is_some(), show.scenes.is_some(), show.agents.is_some()];
    let count = kinds.iter().filter(|&&is_there| is_there).count();
    if count != 1 {
        notes.error(
            key,
            format!("{count} of them"),
            "one of gaits, scenes and agents",
            "use a part for each",
        );
        return None;
    }
    if let Some(view) = &show.view {
        notes.known(&own("view"), view, &["front"], "\"front\", as in the paper");
    }
    if show.view.is_some() && show.gaits.is_none() {
        notes.error(&own("view"), "set", "left out but with gaits", "scenes are seen by the user's eyes");
    }
    let conditions = conditions(notes, key, show);
    if let Some(library) = &show.gaits {
        return gaits(notes, &own("gaits"), library, materials);
    }
    if let Some(scenes) = &show.scenes {
        distinct(notes, &own("scenes"), scenes);
        return Some(scenes.len() * conditions);
    }
    let agents = show.agents.as_ref()?;
    let emotions = Emotion::ALL.map(Emotion::name);
    for (index, emotion) in agents.each_of.iter().enumerate() {
        notes.known(&own(&format!("agents.each_of[{index}]")), emotion, &emotions, "an emotion");
    }
    distinct(notes, &own("agents.each_of"), &agents.each_of);
    distinct(notes, &own("agents.bodies"), &agents.bodies);
    if conditions != 1 {
        notes.error(
            key,
            format!("{conditions} conditions"),
            "one condition with agents",
            "write condition = \"eva-g\"",
        );
    }
    Some(agents.each_of.len() * agents.bodies.len())
}

fn gaits(notes: &mut Notes<'_>, key: &str, library: &str, materials: &Materials) -> Option<usize> {
    let Some(gaits) = materials.gaits.get(library) else {
        let hint = "put the library beside the study file, or write practice for the built-in examples";
        notes.error(key, format!("{library:?}"), "a library of gaits that is there", hint);
        return None;
    };
    if gaits.is_empty() {
        notes.error(key, format!("{library:?} of 0 gaits"), "a library with gaits", "take another one");
    }
    distinct(notes, key, gaits);
    Some(gaits.len())
}

/// Checks the conditions of what is shown; returns how many there are.
fn conditions(notes: &mut Notes<'_>, key: &str, show: &Show) -> usize {
    let all = show.conditions.as_deref().unwrap_or_default();
    for (index, name) in all.iter().enumerate() {
        notes.known(&format!("{key}.conditions[{index}]"), name, &CONDITIONS, "a condition");
    }
    if show.conditions.is_some() {
        distinct(notes, &format!("{key}.conditions"), all);
    }
    if let Some(name) = &show.condition {
        notes.known(&format!("{key}.condition"), name, &CONDITIONS, "a condition");
    }
    let has_any = show.condition.is_some() || show.conditions.is_some();
    if show.condition.is_some() && show.conditions.is_some() {
        notes.error(key, "both", "either condition or conditions", "leave one of the two out");
    } else if show.gaits.is_some() && has_any {
        notes.error(key, "a condition", "left out with gaits", "a gait is shown alone, without gaze");
    } else if show.gaits.is_none() && !has_any {
        notes.error(key, "no condition", "a condition", "try condition = \"eva-g\"");
    }
    all.len() + usize::from(show.condition.is_some())
}

/// Names that are there, not empty, and different from one another.
fn distinct(notes: &mut Notes<'_>, key: &str, names: &[String]) {
    if names.is_empty() {
        notes.error(key, "[]", "one name or more", "or remove the part");
    }
    let mut seen = std::collections::BTreeSet::new();
    for name in names {
        if name.trim().is_empty() || !seen.insert(name) {
            let hint = "answers are stored by name";
            notes.error(key, format!("{name:?}"), "names that differ from one another", hint);
            return;
        }
    }
}

fn fill(notes: &mut Notes<'_>, key: &str, (each, at_least): (u32, u32), stimuli: Option<usize>) {
    let most = stimuli.and_then(|count| u32::try_from(count).ok()).unwrap_or(1_000_000).max(1);
    let hint = "each participant sees a stimulus once; repeat = 1 shows one again";
    notes.within(&format!("{key}.design.each"), each, [1, most], hint);
    notes.within(
        &format!("{key}.design.at_least"),
        at_least,
        [1, 10_000],
        "the paper has 10 responses a video",
    );
}

fn blocks(notes: &mut Notes<'_>, key: &str, [blocks, within]: [&String; 2], show: &Show) {
    let own = |name: &str| format!("{key}.design.{name}");
    notes.known(&own("blocks"), blocks, &["scenes"], "what a block holds fixed");
    notes.known(&own("within"), within, &["conditions"], "what differs within a block");
    let sizes = (show.scenes.as_ref().map(Vec::len), show.conditions.as_ref().map(Vec::len));
    let (Some(scenes), Some(conditions)) = sizes else {
        let hint = "write show = { scenes = [..], conditions = [..], .. }";
        notes.error(&format!("{key}.design"), "\"blocks\"", "with scenes and conditions", hint);
        return;
    };
    size(notes, &format!("{key}.show.scenes"), scenes, "scenes of blocks");
    size(notes, &format!("{key}.show.conditions"), conditions, "conditions of blocks");
}

/// A number of items that there is a Williams square for.
fn size(notes: &mut Notes<'_>, key: &str, count: usize, what: &str) {
    let (least, most) = (*williams::SIZES.start(), *williams::SIZES.end());
    if !williams::SIZES.contains(&count) {
        let hint = "orders are balanced by Williams squares";
        notes.error(key, count, format!("{least} to {most} {what}"), hint);
    }
}

/// Repeated and instructed trials.
fn extras(notes: &mut Notes<'_>, key: &str, trials: &Trials) {
    let Trials { repeat, catches, .. } = *trials;
    let Some(Design::Fill { each, .. }) = trials.design else {
        if repeat + catches > 0 {
            let hint = "add design = { kind = \"fill\", .. }, or remove repeat and catch";
            notes.error(key, "repeat or catch", "left out without fill", hint);
        }
        return;
    };
    let hint = "what was seen in the first half is shown again at the end";
    notes.within(&format!("{key}.repeat"), repeat, [0, (each / 2).min(10)], hint);
    notes.within(&format!("{key}.catch"), catches, [0, 10], "1 instructed answer tells enough");
    let has_points = trials.ask.0.iter().any(|name| {
        matches!(notes.file().questions.get(name), Some(Question::Likert { .. }))
            || crate::study::instrument::names().contains(&name.as_str())
    });
    if catches > 0 && !has_points {
        let hint = "ask a question of kind likert, or remove catch";
        notes.error(&format!("{key}.catch"), catches, "0 without a scale of points", hint);
    }
    if let Some(instruction) = &trials.instruction {
        notes.words(&format!("{key}.instruction"), instruction);
        let texts = match instruction {
            crate::study::Words::Same(text) => vec![text],
            crate::study::Words::By(texts) => texts.values().collect(),
        };
        if texts.iter().any(|text| !text.contains("{answer}")) {
            let hint = "put {answer} where the answer's words are to stand";
            notes.error(&format!("{key}.instruction"), "no {answer}", "a text with {answer}", hint);
        }
    }
}
