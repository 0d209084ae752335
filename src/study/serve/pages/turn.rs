//! The current page of a participation, whatever it is.

use super::ended;
use super::frame::{Frame, View, document, paragraphs};
use super::questions::{Filled, Hidden, form};
use crate::study::protocol::{Content, Page};
use crate::study::serve::markdown;
use crate::study::serve::words::fill;
use maud::{Markup, html};

/// What a page needs besides the page itself.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Texts<'a> {
    /// The consent text, Markdown.
    pub(in super::super) consent: &'a str,
    /// How long the films of the part last, s.
    pub(in super::super) seconds: f64,
    /// The address that grants credit to the participant.
    pub(in super::super) credit: Option<&'a str>,
    /// Now, UTC ms.
    pub(in super::super) now: i64,
}

/// The document of a page; `filled` is what was sent before and could not be taken.
pub(in super::super) fn turn(frame: &Frame<'_>, page: &Page, texts: Texts<'_>, filled: &Filled) -> Markup {
    let view = view(frame, page, texts, filled);
    let is_ended = matches!(page.content, Content::Ended { .. });
    let view = View {
        progress: page.progress,
        page: (!is_ended).then(|| page.id.clone()),
        is_ended,
        can_withdraw: view.can_withdraw || !is_ended,
        ..view
    };
    document(frame, &view)
}

fn view(frame: &Frame<'_>, page: &Page, texts: Texts<'_>, filled: &Filled) -> View {
    let words = frame.words;
    let hidden = Hidden { page: &page.id, shown: texts.now };
    match &page.content {
        Content::Consent { minimum_age, .. } => consent(frame, texts.consent, *minimum_age),
        Content::Text { text } => {
            View::new(&words.text_title, html! { (paragraphs(text)) (form(frame, hidden, &[], filled)) })
        }
        Content::Form { questions } => View::new(&words.form_title, form(frame, hidden, questions, filled)),
        Content::Check { attempt, attempts, questions } => {
            let note = fill(&words.attempt, &[("attempt", attempt), ("attempts", attempts)]);
            let body = html! {
                @if *attempt > 1 { p.lacking role="alert" { (words.attempt_again) } }
                p { (note) }
                (form(frame, hidden, questions, filled))
            };
            View::new(&words.check_title, body)
        }
        Content::Show { name, seconds, plays } => {
            let view = View::new(&words.show_title, film(frame, &words.play, true));
            View { film: Some((name.clone(), *seconds, *plays)), ..view }
        }
        Content::Ask { replay, instruction, questions } => {
            let body = html! {
                @if replay.is_some() { (film(frame, &words.replay, false)) }
                @if let Some(instruction) = instruction { p.instruction { strong { (instruction) } } }
                (form(frame, hidden, questions, filled))
            };
            let film = replay.as_ref().map(|name| (name.clone(), texts.seconds, 0));
            View { film, ..View::new(&words.ask_title, body) }
        }
        Content::Rest => {
            let body = html! { p { (words.rest_text) } (form(frame, hidden, &[], filled)) };
            View::new(&words.rest_title, body)
        }
        Content::Paused => View::new(&words.paused_title, wait(frame, &words.paused_text)),
        // they do not last: the store is about to put another page in their place
        Content::Place | Content::Lapsed | Content::Broken => {
            View::new(&words.unavailable_title, wait(frame, &words.unavailable_text))
        }
        Content::Ended { ending, code } => ended::view(frame, *ending, code.as_deref(), texts.credit),
    }
}

fn consent(frame: &Frame<'_>, text: &str, minimum_age: u32) -> View {
    let words = frame.words;
    let rendered = markdown::render(text);
    let body = html! {
        div.prose { (rendered.markup) }
        p { (fill(&words.minimum_age, &[("age", &minimum_age)])) }
        form.choice method="post" action=(frame.at("/begin")) {
            (frame.mark())
            button type="submit" name="agree" value="yes" { (words.agree) }
            button type="submit" name="agree" value="no" { (words.decline) }
        }
    };
    let title = rendered.title.as_deref().unwrap_or(&words.consent_title);
    View { has_heading: rendered.title.is_some(), ..View::new(title, body) }
}

/// The box of a film, which the script fills; without scripts it says what to do.
fn film(frame: &Frame<'_>, button: &str, is_first: bool) -> Markup {
    let words = frame.words;
    html! {
        noscript { p.lacking { (words.no_scripts) } }
        div.film hidden {
            div.box {}
            p.film-status role="status" data-loading=(words.loading) data-ready=[is_first.then_some(&words.ready)]
                data-playing=(words.playing) data-hidden=(words.hidden) data-broken=(words.broken)
                data-offline=(words.film_offline) {}
            button.play type="button" disabled { (button) }
            p.motion { (words.motion_note) }
        }
    }
}

/// A page that waits: it asks again by itself, and without scripts by its link.
fn wait(frame: &Frame<'_>, text: &str) -> Markup {
    html! {
        p { (text) }
        p { a.button href=(frame.at("/go")) data-again="5" { (frame.words.try_again) } }
    }
}
