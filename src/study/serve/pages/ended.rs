//! The last page, by how the participation ended.

use super::frame::{Frame, View};
use crate::study::file::OnWithdrawal;
use crate::study::plan::Ending;
use crate::study::serve::platform::way_back;
use maud::{Markup, html};

pub(super) fn view(frame: &Frame<'_>, ending: Ending, code: Option<&str>, credit: Option<&str>) -> View {
    let words = frame.words;
    let withdrawn = match frame.study.consent.on_withdrawal {
        OnWithdrawal::Delete => &words.withdrawn_delete,
        OnWithdrawal::KeepAnonymous => &words.withdrawn_keep,
    };
    let (title, text) = match ending {
        Ending::Finished => (&words.finished_title, &words.finished_text),
        Ending::Declined => (&words.declined_title, &words.declined_text),
        Ending::Withdrawn => (&words.withdrawn_title, withdrawn),
        Ending::ScreenedOut => (&words.screened_out_title, &words.screened_out_text),
        Ending::Excluded => (&words.excluded_title, &words.excluded_text),
        Ending::Full => (&words.full_title, &words.full_text),
    };
    let body = html! {
        p { @if credit.is_some() { (words.credit_note) } @else { (text) } }
        @if let Some(address) = credit {
            // the script goes there once; the link is for browsers without scripts, and for coming back
            p { a.button href=(address) rel="noreferrer" data-credit="" { (words.to_sona) } }
        }
        @if let Some(code) = code.filter(|_| credit.is_none()) { (completion(frame, code)) }
        @if ending == Ending::Full {
            p { a.button href=(frame.at("/go")) { (words.try_again) } }
        }
    };
    let can_withdraw = !matches!(ending, Ending::Declined | Ending::Withdrawn);
    View { can_withdraw, ..View::new(title, body) }
}

/// The platform's code, and the way back where the platform has one.
fn completion(frame: &Frame<'_>, code: &str) -> Markup {
    let words = frame.words;
    let back = way_back(frame.study.recruit.platform, code);
    html! {
        p { (words.completion) ": " strong.code { (code) } }
        @match back {
            Some(address) => p { a.button href=(address) rel="noreferrer" { (words.to_prolific) } },
            None => p { (words.completion_note) },
        }
    }
}
