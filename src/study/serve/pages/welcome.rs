//! The first page: nothing is stored before its button is pressed.

use super::frame::{Frame, View, document};
use crate::study::serve::words::fill;
use maud::{Markup, html};

/// What the first page needs.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Welcome<'a> {
    /// Fields of the platform's link that the form sends on.
    pub(in super::super) carried: &'a [(&'static str, &'a str)],
    /// Whether the platform only shows the study: there is nothing to begin.
    pub(in super::super) is_preview: bool,
    /// The address of this page in another language, by tag.
    pub(in super::super) languages: &'a [(String, String)],
}

/// The document.
pub(in super::super) fn welcome(frame: &Frame<'_>, welcome: Welcome<'_>) -> Markup {
    let words = frame.words;
    let study = &frame.study.study;
    let body = html! {
        p { (fill(&words.minutes, &[("minutes", &study.minutes)])) }
        @if welcome.is_preview {
            p.instruction { strong { (words.preview) } }
        } @else {
            p { (words.start_note) }
            form method="post" action=(frame.at("/begin")) {
                input type="hidden" name="language" value=(frame.language);
                @for (name, value) in welcome.carried { input type="hidden" name=(name) value=(value); }
                button type="submit" { (words.start) }
            }
        }
        @if welcome.languages.len() > 1 {
            nav aria-label=(words.language) {
                @for (tag, address) in welcome.languages {
                    a.button href=(address) lang=(tag) hreflang=(tag)
                        aria-current=[(tag == frame.language).then_some("true")] { (tag) }
                }
            }
        }
    };
    document(frame, &View::new(&frame.text(&study.title), body))
}
