//! Who walked, how, and what raters saw: an index file beside the motion files.
//!
//! `gaits.csv`, `labels.csv` or `trials.csv` in the folder of a motion file (or the one above), with a header: a
//! column `key`, `file`, `trial` or `name` that names the take, and any of `subject`, `acted` (or
//! `acted_emotion`, `style`), `label` (or `perceived_label`, `egait_perceived_label`). Acted is not perceived.
//! A missing or unreadable index is no error: the takes simply stay unlabelled.

use super::csv::cells;
use crate::gait::Recording;
use std::collections::HashMap;
use std::path::Path;

pub(super) const INDEX_FILES: [&str; 3] = ["gaits.csv", "labels.csv", "trials.csv"];
/// Index files beyond this size are not index files.
const MAX_INDEX_BYTES: u64 = 16 << 20;

/// Fills subject, acted style and label of takes that the index files near `path` name.
pub(super) fn apply(path: &Path, takes: &mut [Recording]) {
    let folders = [path.parent(), path.parent().and_then(Path::parent)];
    for folder in folders.into_iter().flatten() {
        for name in INDEX_FILES {
            let index = folder.join(name);
            let small = std::fs::metadata(&index).is_ok_and(|m| m.is_file() && m.len() <= MAX_INDEX_BYTES);
            if small
                && index != path
                && let Ok(text) = super::read(&index)
            {
                apply_index(&text, name, takes);
            }
        }
    }
}

/// Fills takes from the text of one index file.
fn apply_index(text: &str, index_name: &str, takes: &mut [Recording]) {
    let mut lines = text.lines();
    let header = cells(lines.next().unwrap_or_default(), ',');
    let column = |names: &[&str]| names.iter().find_map(|name| header.iter().position(|&cell| cell == *name));
    let Some(key) = column(&["key", "file", "trial", "name"]) else { return };
    let subject = column(&["subject"]);
    let acted = column(&["acted", "acted_emotion", "style"]);
    let label = column(&["label", "perceived_label", "egait_perceived_label"]);
    let mut rows: HashMap<&str, Vec<&str>> = HashMap::new();
    for line in lines {
        let row = cells(line, ',');
        if let Some(&name) = row.get(key) {
            // A file column may carry the extension, a take's name does not.
            let name = Path::new(name).file_stem().and_then(|s| s.to_str()).unwrap_or(name);
            rows.insert(name, row);
        }
    }
    for take in takes {
        let Some(row) = rows.get(take.name.as_str()) else { continue };
        let cell = |column: Option<usize>| {
            column.and_then(|c| row.get(c)).filter(|cell| !cell.is_empty()).map(|cell| (*cell).to_owned())
        };
        take.subject = take.subject.take().or_else(|| cell(subject));
        take.acted = take.acted.take().or_else(|| cell(acted));
        take.label = take.label.or_else(|| cell(label).and_then(|cell| cell.parse().ok()));
        take.report.push(format!("subject, style and label: {index_name}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Emotion;

    #[test]
    fn an_index_names_subject_style_and_label() {
        let mut takes = vec![Recording::new("a_01", 30.0, vec![]), Recording::new("b", 30.0, vec![])];
        let text = "file,subject,style,perceived_label\na_01.bvh,7,proud,happy\nc.bvh,8,sad,sad\n";
        apply_index(text, "labels.csv", &mut takes);
        assert_eq!(takes[0].subject.as_deref(), Some("7"));
        assert_eq!(takes[0].acted.as_deref(), Some("proud"));
        assert_eq!(takes[0].label, Some(Emotion::Happy));
        assert_eq!((takes[1].label, takes[1].subject.as_deref()), (None, None));
    }
}
