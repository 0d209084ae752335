//! Where recordings and gaits come from: facts, one field each.

use super::walker::Sex;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Where a recording or a gait comes from.
///
/// Its [`Display`](fmt::Display) is a sentence for people. Nothing reads that sentence: what a program needs to know is
/// a field.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Provenance {
    /// The data set: the name of a file of many takes, or of the folder of files of one take each. Empty if unknown.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub dataset: String,
    /// Name of the file, without folders. Empty if there was none.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub file: String,
    /// Format of the file, such as `BVH`, or the generator and its version.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub format: String,
    /// Name of the take within its data set. Empty if unknown.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub take: String,
    /// The person. Equal subjects of one data set are one person.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub subject: Option<String>,
    /// Sex of the person.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sex: Option<Sex>,
    /// The origin of the label.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub label_origin: Option<LabelOrigin>,
    /// The model that gave the label, where one did, and its confidence: `affective-svm (p 0.83)`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub label_model: Option<String>,
    /// What else is worth knowing: the seconds of the take, how its speed was measured, the generator's parameters.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// The origin of a gait's label: raters, a model or a generator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LabelOrigin {
    /// People's: the label came with the recording, or from ratings.
    Rated,
    /// A model's.
    Predicted,
    /// The generator's: what the walk was made to look like.
    Generated,
}

impl LabelOrigin {
    /// Lower-case name, as written in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rated => "rated",
            Self::Predicted => "predicted",
            Self::Generated => "generated",
        }
    }
}

impl fmt::Display for Provenance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let origin = match (self.file.as_str(), self.format.as_str()) {
            ("", "") => self.take.clone(),
            ("", format) => format.to_owned(),
            (file, "") => file.to_owned(),
            (file, format) => format!("{file} ({format})"),
        };
        let label = self.label_model.as_ref().map(|model| format!("label predicted by {model}"));
        let parts = [origin].into_iter().chain(self.notes.iter().cloned()).chain(label);
        let parts: Vec<String> = parts.filter(|part| !part.is_empty()).collect();
        f.pad(&parts.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sentence_holds_what_is_known() {
        let mut of = Provenance { file: "07_01.bvh".into(), format: "BVH".into(), ..Provenance::default() };
        assert_eq!(of.to_string(), "07_01.bvh (BVH)");
        of.notes = vec!["1.00 s to 2.10 s".into(), "running".into()];
        of.label_model = Some("affective-svm (p 0.83)".into());
        assert_eq!(
            of.to_string(),
            "07_01.bvh (BVH), 1.00 s to 2.10 s, running, label predicted by affective-svm (p 0.83)"
        );
        let walker = Provenance { format: "gaitway walker 1".into(), ..Provenance::default() };
        assert_eq!(walker.to_string(), "gaitway walker 1");
        assert_eq!(Provenance { take: "walk".into(), ..Provenance::default() }.to_string(), "walk");
        assert_eq!(Provenance::default().to_string(), "");
    }
}
