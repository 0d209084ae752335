//! What all pages of a study have in common: head, footer, the place of what differs.

use super::super::assets::Assets;
use super::super::words::{Interface, direction, fill};
use crate::study::file::StudyFile;
use crate::study::protocol::Progress;
use maud::{DOCTYPE, Markup, html};

/// The `id` of the form with a page's questions.
pub(super) const FORM: &str = "answers";

/// What all pages of a study have in common.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Frame<'a> {
    /// The words of the interface.
    pub(in super::super) words: &'a Interface,
    /// The reader's language.
    pub(in super::super) language: &'a str,
    /// The study.
    pub(in super::super) study: &'a StudyFile,
    /// Addresses of script and style.
    pub(in super::super) assets: &'a Assets,
    /// The participation, once there is one.
    pub(in super::super) visit: Option<Visit<'a>>,
}

/// The participation that a page belongs to.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Visit<'a> {
    /// The participant's code.
    pub(in super::super) code: &'a str,
    /// What forms send back, so that no page of an earlier participation answers.
    pub(in super::super) mark: &'a str,
}

impl Frame<'_> {
    /// A text of the study in the reader's language.
    pub(super) fn text(&self, words: &crate::study::Words) -> String {
        words.find(self.language, &self.study.study.languages).to_owned()
    }

    /// An address of the study.
    pub(super) fn at(&self, route: &str) -> String {
        format!("/s/{}{route}", self.study.study.id)
    }

    /// The hidden field with the mark.
    pub(super) fn mark(&self) -> Markup {
        html! {
            @if let Some(visit) = self.visit { input type="hidden" name="mark" value=(visit.mark); }
        }
    }
}

/// What differs from page to page.
#[derive(Debug)]
pub(super) struct View {
    pub(super) title: String,
    pub(super) progress: Option<Progress>,
    /// The page's id, which events refer to.
    pub(super) page: Option<String>,
    /// Whether nothing follows.
    pub(super) is_ended: bool,
    /// Whether the participation can be withdrawn on it.
    pub(super) can_withdraw: bool,
    /// What stands below the heading; the heading itself, too, if `has_heading`.
    pub(super) body: Markup,
    pub(super) has_heading: bool,
    /// The film to be shown: name, length in s, how often.
    pub(super) film: Option<(String, f64, u32)>,
}

impl View {
    pub(super) fn new(title: &str, body: Markup) -> Self {
        Self {
            title: title.to_owned(),
            progress: None,
            page: None,
            is_ended: false,
            can_withdraw: false,
            body,
            has_heading: false,
            film: None,
        }
    }
}

/// The whole document.
pub(super) fn document(frame: &Frame<'_>, view: &View) -> Markup {
    let Frame { words, language, study, .. } = frame;
    let title = frame.text(&study.study.title);
    html! {
        (DOCTYPE)
        html lang=(language) dir=(direction(language)) {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="robots" content="noindex";
                title { (view.title) " · " (title) }
                link rel="icon" href=(frame.assets.href("icon.svg"));
                link rel="stylesheet" href=(frame.assets.href("web.css"));
                script type="module" src=(frame.assets.href("page.mjs")) {}
            }
            body {
                a.skip href="#main" { (words.skip) }
                header {
                    p.study { (title) }
                    p.progress { @if let Some(Progress { trial, of }) = view.progress {
                        (fill(&words.progress, &[("trial", &trial), ("of", &of)]))
                    } }
                }
                (main(frame, view))
                (footer(frame, view.can_withdraw))
            }
        }
    }
}

fn main(frame: &Frame<'_>, view: &View) -> Markup {
    let words = frame.words;
    let film = view.film.as_ref();
    html! {
        main #main data-study=(frame.study.study.id) data-page=[view.page.as_deref()] data-ended=[view.is_ended.then_some("yes")]
            data-mark=[frame.visit.map(|visit| visit.mark)] data-film=[film.map(|film| film.0.as_str())]
            data-seconds=[film.map(|film| film.1)] data-plays=[film.map(|film| film.2)] {
            @if !view.has_heading { h1 tabindex="-1" { (view.title) } }
            (view.body)
            p #status role="status" aria-live="polite" data-saving=(words.saving) data-saved=(words.saved)
                data-offline=(words.offline) data-refused=(words.refused) data-lost=(words.lost) {}
        }
    }
}

fn footer(frame: &Frame<'_>, can_withdraw: bool) -> Markup {
    let words = frame.words;
    html! {
        footer {
            p { (words.contact) ": " (frame.text(&frame.study.study.contact)) }
            @if let Some(visit) = frame.visit {
                details {
                    summary { (words.your_code) }
                    p { strong.code { (visit.code) } }
                    p { (words.code_note) }
                    p { a href=(frame.at(&format!("?code={}", visit.code))) { (words.code_link) } }
                }
                @if can_withdraw {
                    form method="post" action=(frame.at("/withdraw")) {
                        (frame.mark())
                        button.quiet type="submit" { (words.withdraw) }
                    }
                }
            }
        }
    }
}

/// A text in paragraphs, which empty lines part.
pub(super) fn paragraphs(text: &str) -> Markup {
    let mut all: Vec<String> = vec![String::new()];
    for line in text.lines() {
        match (line.trim().is_empty(), all.last_mut()) {
            (false, Some(last)) => {
                last.push_str(line);
                last.push('\n');
            }
            _ => all.push(String::new()),
        }
    }
    html! {
        @for paragraph in all.iter().filter(|paragraph| !paragraph.is_empty()) {
            p { (paragraph.trim_end()) }
        }
    }
}
