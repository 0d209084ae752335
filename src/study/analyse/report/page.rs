//! A report as it grows: blocks, which become Markdown or HTML.
//!
//! Texts within blocks are Markdown of three signs alone: `code`, **strong** and a backslash before a sign that means nothing.

use crate::statistics::Description;
use crate::study::analyse::Sides;

/// A report.
#[derive(Debug, Default)]
pub(super) struct Page {
    pub(super) blocks: Vec<Block>,
}

/// A block of a report.
#[derive(Debug)]
pub(super) enum Block {
    /// Level, from 1, and text.
    Heading(usize, String),
    Paragraph(String),
    List(Vec<String>),
    /// Columns from `numbers` on are numbers.
    Table {
        head: Vec<String>,
        numbers: usize,
        rows: Vec<Vec<String>>,
    },
    /// A drawing, which Markdown leaves out.
    Figure {
        svg: String,
        caption: String,
    },
}

impl Page {
    pub(super) fn paragraph(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Paragraph(text.into()));
    }

    /// A heading whose text may hold code.
    pub(super) fn heading(&mut self, level: usize, text: impl Into<String>) {
        self.blocks.push(Block::Heading(level, text.into()));
    }

    /// A table; columns from `numbers` on are numbers.
    pub(super) fn table(&mut self, head: &[String], numbers: usize, rows: Vec<Vec<String>>) {
        self.blocks.push(Block::Table { head: head.to_vec(), numbers, rows });
    }

    pub(super) fn list(&mut self, items: Vec<String>) {
        self.blocks.push(Block::List(items));
    }

    /// A figure with what it shows.
    pub(super) fn figure(&mut self, figure: &dyn crate::export::chart::Figure, caption: impl Into<String>) {
        self.blocks.push(Block::Figure { svg: figure.svg(), caption: caption.into() });
    }

    /// The report as Markdown, without figures.
    pub(super) fn markdown(&self) -> String {
        let mut text = String::new();
        for block in &self.blocks {
            let written = match block {
                Block::Heading(level, words) => format!("{} {words}", "#".repeat(*level)),
                Block::Paragraph(words) => words.clone(),
                Block::List(items) => {
                    items.iter().map(|item| format!("- {item}")).collect::<Vec<_>>().join("\n")
                }
                Block::Table { head, numbers, rows } => table(head, *numbers, rows),
                Block::Figure { .. } => continue,
            };
            if !text.is_empty() {
                text.push('\n');
            }
            text.push_str(&written);
            text.push('\n');
        }
        text
    }
}

fn table(head: &[String], numbers: usize, rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| format!("| {} |", cells.join(" | "));
    let rule = (0..head.len()).map(|column| if column < numbers { "---" } else { "---:" }.to_owned());
    let mut lines = vec![line(head), line(&rule.collect::<Vec<_>>())];
    lines.extend(rows.iter().map(|row| line(row)));
    lines.join("\n")
}

/// Text of the study file or the tables, so that Markdown takes no sign of it for its own.
pub(super) fn plain(text: &str) -> String {
    let mut plain = String::new();
    for letter in text.split_whitespace().collect::<Vec<_>>().join(" ").chars() {
        if "\\`*_{}[]<>#|&".contains(letter) {
            plain.push('\\');
        }
        plain.push(letter);
    }
    plain
}

pub(super) fn texts(cells: &[&str]) -> Vec<String> {
    cells.iter().map(|&cell| cell.to_owned()).collect()
}

/// A count with its noun.
pub(super) fn many(count: usize, noun: &str) -> String {
    match (count, noun) {
        (1, _) => format!("1 {noun}"),
        (_, "person") => format!("{count} people"),
        _ => format!("{count} {noun}s"),
    }
}

pub(super) fn p(value: f64) -> String {
    if value < 0.001 { "< 0.001".to_owned() } else { format!("{value:.3}") }
}

pub(super) fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

pub(super) fn interval([low, high]: [f64; 2]) -> String {
    format!("{low:.2} to {high:.2}")
}

pub(super) fn percents([low, high]: [f64; 2]) -> String {
    format!("{:.1} to {:.1} %", 100.0 * low, 100.0 * high)
}

pub(super) fn mean(of: &Description) -> String {
    match of.deviation {
        Some(deviation) => format!("{:.2} ({deviation:.2})", of.mean),
        None => format!("{:.2}", of.mean),
    }
}

/// A result without the excluded, and with them.
pub(super) fn both<T>(page: &mut Page, sides: &Sides<T>, of: &str, write: impl Fn(&mut Page, &T)) {
    let without = if sides.everyone.is_some() { ", without the excluded" } else { "" };
    page.heading(2, format!("{of}{without}"));
    write(page, &sides.kept);
    if let Some(everyone) = &sides.everyone {
        page.heading(2, format!("{of}, with the excluded"));
        write(page, everyone);
    }
}
