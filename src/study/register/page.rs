//! The page while it is written.

use crate::study::load::BLANK;

/// A page in Markdown.
pub(super) struct Page {
    text: String,
}

impl Page {
    pub(super) fn new(title: &str) -> Self {
        Self { text: format!("# {}\n", plain(title)) }
    }

    pub(super) fn into_text(self) -> String {
        self.text
    }

    /// A section of the template.
    pub(super) fn section(&mut self, name: &str) {
        self.text += &format!("\n## {name}\n");
    }

    /// A field of the template.
    pub(super) fn field(&mut self, name: &str) {
        self.text += &format!("\n### {name}\n");
    }

    pub(super) fn text(&mut self, text: &str) {
        self.text += &format!("\n{}\n", plain(text));
    }

    /// Something that the study file does not say.
    pub(super) fn blank(&mut self, what: &str) {
        self.text(&format!("{BLANK}: {what}."));
    }

    pub(super) fn list(&mut self, items: &[String]) {
        self.text += "\n";
        for item in items {
            self.text += &format!("- {}\n", plain(item));
        }
    }

    /// A list, or a blank where there is nothing to list.
    pub(super) fn list_or_blank(&mut self, items: &[String], what: &str) {
        if items.is_empty() {
            self.blank(what);
        } else {
            self.list(items);
        }
    }
}

/// A text on one line, so that it stays in its paragraph or its item.
fn plain(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
