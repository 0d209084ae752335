//! What lies beside a study file, as far as plans need it.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What lies beside a study file: names of gaits by library, texts by file. The caller reads them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Materials {
    /// Names of gaits by what `show.gaits` says.
    pub gaits: BTreeMap<String, Vec<String>>,
    /// Texts by the name of their file.
    pub texts: BTreeMap<String, String>,
}

/// The built-in examples alone: `practice`, of three gaits.
impl Default for Materials {
    fn default() -> Self {
        let practice = (1..=3).map(|number| format!("practice {number}")).collect();
        Self { gaits: BTreeMap::from([("practice".to_owned(), practice)]), texts: BTreeMap::new() }
    }
}

impl Materials {
    /// The same with a library of gaits.
    #[must_use]
    pub fn with_gaits(mut self, library: &str, names: Vec<String>) -> Self {
        self.gaits.insert(library.to_owned(), names);
        self
    }

    /// The same with a text.
    #[must_use]
    pub fn with_text(mut self, file: &str, text: &str) -> Self {
        self.texts.insert(file.to_owned(), text.to_owned());
        self
    }
}
