//! The figures of a report.

use super::page::{Page, interval, plain, texts};
use crate::emotion::Emotion;
use crate::export::chart::{
    Bar, Bars, EMOTION_COLORS, Funnel, FunnelStep, Likert, LikertRow, Matrix, Mean, MeanSeries, Means,
    SERIES_COLORS, Series, Strip, StripColumn,
};
use crate::perception::ratings::Analysis as Ratings;
use crate::study::analyse::{Analysis, ConfusionBlock, Gaits, Group, ItemAnswers};
use crate::study::plan::Ending;
use crate::study::protocol::State;
use crate::study::tables::name;

/// Colour of a gait without a label.
const NO_LABEL: [u8; 3] = [128, 90, 150];

#[allow(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
const fn real(count: usize) -> f64 {
    count as f64
}

/// Where participants went.
pub(super) fn flow(analysis: &Analysis) -> Funnel {
    let all = &analysis.participants;
    let of = |state: State| {
        let state = name(&state);
        let count = all.states.get(&state).copied().unwrap_or(0);
        (state, count)
    };
    let finished = of(State::Ended(Ending::Finished)).1;
    let early =
        [State::Ended(Ending::Declined), State::Ended(Ending::ScreenedOut), State::Ended(Ending::Full)];
    let late = [State::Lapsed, State::Ended(Ending::Withdrawn), State::Ended(Ending::Excluded)];
    let losses = |states: &[State], of_step: usize| {
        let mut losses: Vec<(String, usize)> = states.iter().map(|&state| of(state)).collect();
        // a state says where a participation ended, not whether there was a place: what is left is under way or left early
        let named: usize = losses.iter().map(|(_, count)| count).sum();
        losses.push(("others".to_owned(), of_step.saturating_sub(named)));
        losses
    };
    let step = |name: &str, count, losses| FunnelStep { name: name.to_owned(), count, losses };
    let excluded = analysis.exclusions.excluded.len();
    Funnel {
        title: "Participants".to_owned(),
        steps: vec![
            step("arrived", all.arrived, losses(&early, all.arrived.saturating_sub(all.placed))),
            step("got a place", all.placed, losses(&late, all.placed.saturating_sub(finished))),
            step("finished", finished, vec![("excluded by the rules, of all".to_owned(), excluded)]),
            step("with answers that count", all.analysed, Vec::new()),
        ],
    }
}

/// How many gaits have how many answers.
pub(super) fn answers_of_gaits(part: &str, gaits: &Gaits) -> Bars {
    let (groups, bars): (Vec<String>, Vec<Bar>) = gaits
        .by_answers
        .iter()
        .map(|(answers, &count)| {
            (answers.to_string(), Bar { value: real(count), interval: None, text: count.to_string() })
        })
        .unzip();
    Bars {
        title: format!("Answers of each gait, {part}"),
        axis: "gaits with so many answers".to_owned(),
        groups,
        series: vec![Series { name: String::new(), bars, colors: vec![SERIES_COLORS[0]] }],
        line: None,
        decimals: 0,
        note: format!("{} gaits with an answer", gaits.count),
    }
}

/// The answers to every scale: distributions by condition, means by scene and condition.
pub(super) fn answers(page: &mut Page, analysis: &Analysis) {
    if analysis.answers.iter().all(|item| item.groups.iter().all(|group| group.people == 0)) {
        return;
    }
    page.heading(2, "Answers");
    let question = |item: &ItemAnswers| item.item.split('.').next().unwrap_or_default().to_owned();
    let is_one = |a: &ItemAnswers, b: &ItemAnswers| {
        (&a.part, question(a), a.least, a.greatest) == (&b.part, question(b), b.least, b.greatest)
    };
    for items in analysis.answers.chunk_by(is_one) {
        let Some(first) = items.first() else { continue };
        let of = format!("{}, part {}", question(first), first.part);
        let caption = format!(
            "Answers to `{}` in percent, without the excluded. Bars part at the middle of the scale.",
            question(first)
        );
        page.figure(&distribution(&of, items), caption);
        let has_means =
            |item: &&ItemAnswers| item.groups.iter().filter(|group| group.mean.is_some()).count() > 1;
        for item in items.iter().filter(has_means) {
            let text = if item.text.is_empty() { String::new() } else { format!(": {}", plain(&item.text)) };
            page.figure(&means(item), format!("Means of `{}`{text}.", item.item));
        }
        table(page, items);
    }
}

/// The numbers of the figures.
fn table(page: &mut Page, items: &[ItemAnswers]) {
    let row = |item: &ItemAnswers, group: &Group| {
        let name = |name: &Option<String>| name.as_deref().map_or_else(String::new, plain);
        let answers: usize = group.counts.iter().sum();
        let counts = [group.people, answers].map(|count| count.to_string());
        let mean = group.mean.map_or_else(String::new, |mean| format!("{mean:.2}"));
        let ends = group.interval.map_or_else(String::new, interval);
        [plain(&item.item), name(&group.scene), name(&group.condition)]
            .into_iter()
            .chain(counts)
            .chain([mean, ends])
            .collect()
    };
    let rows = items.iter().flat_map(|item| item.groups.iter().map(move |group| row(item, group)));
    let head = ["item", "scene", "condition", "people", "answers", "mean", "mean, 95 %"];
    page.table(&texts(&head), 3, rows.collect());
    page.paragraph("Means of all answers, without the excluded. Intervals by a bootstrap over people.");
}

fn distribution(of: &str, items: &[ItemAnswers]) -> Likert {
    let mut rows = Vec::new();
    for item in items {
        let mut conditions: Vec<&Option<String>> = Vec::new();
        for group in &item.groups {
            if !conditions.contains(&&group.condition) {
                conditions.push(&group.condition);
            }
        }
        let short = item.item.split_once('.').map_or(item.item.as_str(), |(_, id)| id);
        for condition in &conditions {
            let own = item.groups.iter().filter(|group| group.condition == **condition);
            let mut counts = vec![0; item.groups.first().map_or(0, |group| group.counts.len())];
            for group in own {
                counts.iter_mut().zip(&group.counts).for_each(|(sum, count)| *sum += count);
            }
            let condition = condition.as_deref().filter(|_| conditions.len() > 1);
            let name =
                condition.map_or_else(|| short.to_owned(), |condition| format!("{short}, {condition}"));
            rows.push(LikertRow { name, counts });
        }
    }
    let point = |first: &ItemAnswers, point: i64| {
        let label = first.labels.iter().find(|(labelled, _)| *labelled == point);
        label.map_or_else(|| point.to_string(), |(_, words)| format!("{point} {words}"))
    };
    let points = items.first().map_or_else(Vec::new, |first| {
        (first.least..=first.greatest).map(|number| point(first, number)).collect()
    });
    Likert { title: format!("Answers to {of}"), points, rows, note: "percent of answers".to_owned() }
}

fn means(item: &ItemAnswers) -> Means {
    let mut scenes: Vec<&Option<String>> = Vec::new();
    let mut conditions: Vec<&Option<String>> = Vec::new();
    for group in &item.groups {
        if !scenes.contains(&&group.scene) {
            scenes.push(&group.scene);
        }
        if !conditions.contains(&&group.condition) {
            conditions.push(&group.condition);
        }
    }
    let mean = |group: &Group| Some(Mean { value: group.mean?, interval: group.interval? });
    let series = conditions.iter().map(|condition| MeanSeries {
        name: (*condition).clone().unwrap_or_default(),
        means: scenes
            .iter()
            .map(|scene| {
                let is_it = |group: &&Group| group.scene == **scene && group.condition == **condition;
                item.groups.iter().find(is_it).and_then(mean)
            })
            .collect(),
    });
    #[allow(clippy::cast_precision_loss, reason = "scales are short")]
    let range = [item.least as f64, item.greatest as f64];
    Means {
        title: format!("Means of {}", item.item),
        axis: format!("mean answer, {} to {}", item.least, item.greatest),
        range,
        groups: scenes.iter().map(|scene| (*scene).clone().unwrap_or_else(|| "all".to_owned())).collect(),
        series: series.collect(),
        note: "intervals: 95 %, bootstrap over people".to_owned(),
    }
}

pub(super) fn confusion(block: &ConfusionBlock) -> Matrix {
    Matrix::confusion("Emotions shown and answered", ["shown", "answered"], &block.classes, &block.counts)
}

/// One dot a gait, by emotion.
pub(super) fn ratings(analysis: &Ratings) -> Strip {
    let column = |emotion: Emotion| StripColumn {
        name: emotion.to_string(),
        dots: analysis
            .videos
            .iter()
            .map(|video| {
                let color = video.label.map_or(NO_LABEL, |label| EMOTION_COLORS[label.index()]);
                (video.mean[emotion.index()], color)
            })
            .collect(),
    };
    let mut legend: Vec<(String, [u8; 3])> =
        Emotion::ALL.map(|emotion| (format!("labelled {emotion}"), EMOTION_COLORS[emotion.index()])).to_vec();
    legend.push(("no label".to_owned(), NO_LABEL));
    Strip {
        title: "Ratings of gaits".to_owned(),
        axis: "mean rating, 1 to 5".to_owned(),
        range: [1.0, 5.0],
        columns: Emotion::ALL.map(column).to_vec(),
        line: Some((analysis.theta, format!("theta = {}", analysis.theta))),
        legend,
        note: format!("{} gaits, {} ratings", analysis.videos.len(), analysis.responses),
    }
}
