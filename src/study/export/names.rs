//! Names of the files of a dataset.

use crate::study::file::StudyFile;
use crate::study::tables::Tables;
use std::collections::BTreeSet;

/// Names of data files: keys and values of letters and digits, as Psych-DS asks.
pub(super) struct Names {
    study: String,
    /// Parts with answers, in the order of the flow, with their files.
    pub(super) parts: Vec<(String, String)>,
}

impl Names {
    pub(super) fn new(study: &StudyFile, tables: &Tables) -> Self {
        let word = |text: &str| text.chars().filter(char::is_ascii_alphanumeric).collect::<String>();
        let id = word(&study.study.id);
        let answered: BTreeSet<&str> = tables.answers.iter().map(|row| row.part.as_str()).collect();
        let known = study.study.flow.iter().map(String::as_str).filter(|part| answered.contains(part));
        let unknown =
            answered.iter().copied().filter(|part| !study.study.flow.iter().any(|known| known == part));
        let mut taken: BTreeSet<String> = BTreeSet::new();
        let mut parts = Vec::new();
        for part in known.chain(unknown) {
            // two parts may differ in signs alone
            let base = Some(word(part)).filter(|word| !word.is_empty()).unwrap_or_else(|| "part".to_owned());
            let numbered =
                (1..).map(|number| if number == 1 { base.clone() } else { format!("{base}x{number}") });
            let Some(value) = numbered.into_iter().find(|value| taken.insert(value.to_lowercase())) else {
                continue;
            };
            parts.push((part.to_owned(), format!("study-{id}_task-{value}_data.csv")));
        }
        Self { study: id, parts }
    }

    /// The file of something else than a part.
    pub(super) fn of(&self, description: &str) -> String {
        format!("study-{}_description-{description}_data.csv", self.study)
    }

    /// The file of a part, if it has answers.
    pub(super) fn part(&self, part: &str) -> Option<&str> {
        self.parts.iter().find(|(name, _)| name == part).map(|(_, file)| file.as_str())
    }
}
