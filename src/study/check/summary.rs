//! What participants will do, and how many are needed.

use crate::study::file::{Design, StudyFile};
use crate::study::materials::Materials;
use crate::study::plan::blocks::Blocks;
use crate::study::plan::square::Square;
use crate::study::plan::{Plan, Prompt, Scale, StepKind, TrialsStep};
use serde::Serialize;
use std::fmt;

/// Words a minute that adults read silently (Brysbaert 2019).
const WORDS_PER_MINUTE: f64 = 238.0;
/// Time for one answer on a scale, s.
const ANSWER: f64 = 3.0;
/// Time for a free text, which most leave empty, s.
const FREE_TEXT: f64 = 15.0;
/// Time for turning a page or starting a stimulus, s.
const TURN: f64 = 1.5;
/// Length of a rest, s.
const REST: f64 = 60.0;

/// The trials of a part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PartSummary {
    /// Name of the part.
    pub part: String,
    /// All stimuli.
    pub stimuli: usize,
    /// Trials of one participant, repeated and instructed ones included.
    pub trials: usize,
    /// Fewest participants with whom the design is complete.
    pub least: usize,
    /// Participants with whom it is balanced are multiples of this; 1 for any number.
    pub multiple: usize,
}

/// What participants will do, and how many are needed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Counted parts with trials.
    pub parts: Vec<PartSummary>,
    /// Counted trials of one participant.
    pub trials: usize,
    /// Estimated time of one participant, min.
    pub minutes: f64,
    /// Fewest participants with whom every design is complete, if all stay.
    pub least: usize,
    /// Participants with whom all is balanced are multiples of this.
    pub multiple: usize,
    /// Estimated participants if 3 in 10 leave at any page with equal probability.
    pub with_drop_outs: usize,
}

impl Summary {
    pub(super) fn of(plan: &Plan, file: &StudyFile, materials: &Materials) -> Self {
        let parts: Vec<PartSummary> = plan.counted().map(|(_, name, step)| part(plan, name, step)).collect();
        let multiple = parts.iter().map(|part| part.multiple).fold(1, lcm);
        let least = parts.iter().map(|part| part.least).max().unwrap_or(0).next_multiple_of(multiple);
        let is_filled =
            |(_, _, step): (usize, &str, &TrialsStep)| matches!(step.design, Some(Design::Fill { .. }));
        // of a fill what was answered before stays, half on average; a row has to be gone through whole
        let (by, of) = if plan.counted().all(is_filled) { (20, 17) } else { (10, 7) };
        Self {
            trials: parts.iter().map(|part| part.trials).sum(),
            minutes: seconds(plan, file, materials) / 60.0,
            with_drop_outs: (least * by).div_ceil(of),
            least,
            multiple,
            parts,
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for PartSummary { part, stimuli, trials, least, multiple } in &self.parts {
            write!(f, "{part}: {trials} trials of {stimuli} stimuli; {least} participants or more")?;
            writeln!(
                f,
                "{}",
                if *multiple > 1 { format!(", in multiples of {multiple}") } else { String::new() }
            )?;
        }
        let Self { trials, minutes, least, with_drop_outs, .. } = self;
        writeln!(f, "one participant: {trials} counted trials, about {minutes:.0} min")?;
        writeln!(f, "participants: {least} if all stay, about {with_drop_outs} if 3 in 10 leave")
    }
}

fn part(plan: &Plan, name: &str, step: &TrialsStep) -> PartSummary {
    let stimuli = step.stimuli.len();
    let (least, multiple) = match step.design {
        Some(Design::Fill { each, at_least }) => {
            let (each, at_least) = ((each as usize).min(stimuli).max(1), at_least as usize);
            ((stimuli * at_least).div_ceil(each).max(at_least), 1)
        }
        Some(Design::Blocks { .. }) => {
            let conditions = step.conditions.max(1);
            let rows = Blocks::new(stimuli / conditions, conditions).rows();
            (rows, rows)
        }
        Some(Design::Square) => {
            let rows = Square::new(stimuli).rows();
            (rows, rows)
        }
        None => (1, 1),
    };
    PartSummary { part: name.to_owned(), stimuli, trials: plan.trial_count(step), least, multiple }
}

/// Estimated time of one participant, s.
fn seconds(plan: &Plan, file: &StudyFile, materials: &Materials) -> f64 {
    let consent = file.study.languages.first().map_or("", |language| file.consent.text.find(language, &[]));
    let consent = materials.texts.get(consent).map_or(300, |text| text.split_whitespace().count());
    let step = |kind: &StepKind| match kind {
        StepKind::Consent { .. } => reading(consent),
        StepKind::Text(words) => reading(words.length()),
        StepKind::Form(prompts) | StepKind::Check { prompts, .. } => answering(prompts),
        StepKind::Trials(trials) => trials_seconds(plan, trials),
    };
    plan.steps.iter().map(|one| step(&one.kind) + TURN).sum()
}

fn trials_seconds(plan: &Plan, step: &TrialsStep) -> f64 {
    let shown = step.shows.seconds * f64::from(step.shows.plays) + 2.0 * TURN;
    let trials = number(plan.trial_count(step)) * (shown + answering(&step.prompts));
    let blocks = match step.design {
        Some(Design::Blocks { .. }) => step.stimuli.len() / step.conditions.max(1),
        _ => 0,
    };
    let rests = step.rest_after_blocks.map_or(0, |every| blocks.saturating_sub(1) / every.max(1) as usize);
    trials + number(blocks) * answering(&step.after_block) + number(rests) * REST
}

fn answering(prompts: &[Prompt]) -> f64 {
    let one = |prompt: &Prompt| {
        let time = if matches!(prompt.scale, Scale::Text { .. }) { FREE_TEXT } else { ANSWER };
        time + reading(prompt.text.length()) / 4.0
    };
    prompts.iter().map(one).sum()
}

fn reading(words: usize) -> f64 {
    number(words) / WORDS_PER_MINUTE * 60.0
}

#[allow(clippy::cast_precision_loss, reason = "counts are small")]
const fn number(count: usize) -> f64 {
    count as f64
}

fn lcm(a: usize, b: usize) -> usize {
    let (mut x, mut y) = (a, b);
    while y > 0 {
        (x, y) = (y, x % y);
    }
    a / x.max(1) * b
}
