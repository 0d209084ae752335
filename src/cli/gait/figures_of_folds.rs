//! Figures of `compare` and `train`: accuracies with intervals, recall by emotion, confusion matrices.

use crate::Error;
use crate::emotion::Emotion;
use crate::export::chart::{self, Bar, Bars, EMOTION_COLORS, Matrix, Series};
use std::path::{Path, PathBuf};

const OURS: [u8; 3] = [0x1f, 0x6f, 0xb4];
const PAPERS: [u8; 3] = [0x9a, 0x9a, 0x9a];

/// What the figures of one method show; shares are 0 to 1.
pub(super) struct Found<'a> {
    pub(super) method: &'a str,
    /// What the paper prints.
    pub(super) published: Option<f64>,
    pub(super) accuracy: f64,
    pub(super) interval: Option<[f64; 2]>,
    /// By [`Emotion::index`].
    pub(super) recall: [f64; 4],
    /// Row: what people see; column: what the method says.
    pub(super) confusion: &'a [[u64; 4]; 4],
}

/// Writes the figures of all methods into `folder` as SVG and PNG; returns the files. `note` says gaits, folds, seeds.
pub(super) fn write(folder: &Path, found: &[Found<'_>], note: &str) -> Result<Vec<PathBuf>, Error> {
    let labels = Emotion::ALL.map(|emotion| emotion.name().to_owned());
    let mut files = Vec::new();
    for one in found {
        let counts = one.confusion.map(|row| row.to_vec());
        let matrix = Matrix::confusion(one.method, ["people see", "the method says"], &labels, &counts);
        let matrix = Matrix { note: format!("{}; {note}", matrix.note), ..matrix };
        files.extend(chart::write(folder, &format!("confusion-{}", one.method), &matrix)?);
    }
    files.extend(chart::write(folder, "accuracy", &accuracies(found, note))?);
    files.extend(chart::write(folder, "recall", &recalls(found, note))?);
    Ok(files)
}

fn groups(found: &[Found<'_>]) -> Vec<String> {
    found.iter().map(|one| one.method.to_owned()).collect()
}

fn accuracies(found: &[Found<'_>], note: &str) -> Bars {
    let percent = |share: f64| share * 100.0;
    let bar = |value: Option<f64>, interval: Option<[f64; 2]>| Bar {
        value: value.map_or(f64::NAN, percent),
        interval: interval.map(|ends| ends.map(percent)),
        text: String::new(),
    };
    let here = found.iter().map(|one| bar(Some(one.accuracy), one.interval)).collect();
    let mut series = vec![Series { name: "here".to_owned(), bars: here, colors: vec![OURS] }];
    if found.iter().any(|one| one.published.is_some()) {
        let bars = found.iter().map(|one| bar(one.published, None)).collect();
        series.push(Series { name: "the paper, its own gaits".to_owned(), bars, colors: vec![PAPERS] });
    }
    Bars {
        title: "Agreement with people".to_owned(),
        axis: "accuracy, %".to_owned(),
        groups: groups(found),
        series,
        line: Some((25.0, "chance".to_owned())),
        decimals: 1,
        note: note.to_owned(),
    }
}

fn recalls(found: &[Found<'_>], note: &str) -> Bars {
    let series = Emotion::ALL.map(|emotion| Series {
        name: emotion.name().to_owned(),
        bars: found
            .iter()
            .map(|one| Bar { value: one.recall[emotion.index()] * 100.0, ..Bar::default() })
            .collect(),
        colors: vec![EMOTION_COLORS[emotion.index()]],
    });
    Bars {
        title: "Recall".to_owned(),
        axis: "recognised of those that people see, %".to_owned(),
        groups: groups(found),
        series: series.into(),
        line: Some((25.0, "chance".to_owned())),
        decimals: 0,
        note: note.to_owned(),
    }
}
