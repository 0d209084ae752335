//! Operators' pages as HTML.

use super::super::reply;
use super::console::Console;
use super::sessions::{PASSWORD, Session};
use axum::http::StatusCode;
use axum::response::Response;
use maud::{DOCTYPE, Markup, html};

/// The pages, in the order of the menu: address and name.
const MENU: [(&str, &str); 4] = [
    ("/admin/live", "Live"),
    ("/admin/participants", "Participants"),
    ("/admin/balance", "Balance"),
    ("/admin/operators", "Operators"),
];

/// A whole document; the menu is there for operators who are signed in.
pub(super) fn document(console: &Console, session: Option<&Session>, title: &str, body: &Markup) -> Markup {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) " · " (console.store.current().study.file.study.id) }
                link rel="icon" href=(console.assets.href("icon.svg"));
                link rel="stylesheet" href=(console.assets.href("web.css"));
                script type="module" src=(console.assets.href("admin.mjs")) {}
            }
            body.admin {
                header {
                    p.study { (console.store.current().study.file.study.id) }
                    @if let Some(session) = session { (menu(session, title)) }
                }
                main #main { h1 { (title) } (body) }
            }
        }
    }
}

fn menu(session: &Session, title: &str) -> Markup {
    html! {
        nav aria-label="Pages" {
            @for (address, name) in MENU {
                a href=(address) aria-current=[(name == title).then_some("page")] { (name) }
            }
        }
        form method="post" action="/admin/logout" {
            (mark(session))
            button.quiet type="submit" { "Sign out " (session.name) " (" (session.role.name()) ")" }
        }
    }
}

/// The hidden field that every form of a session has.
pub(super) fn mark(session: &Session) -> Markup {
    html! { input type="hidden" name="mark" value=(session.mark); }
}

/// The page to sign in, with what was wrong before.
pub(super) fn login(console: &Console, wrong: &str) -> Markup {
    let body = html! {
        (complaint(wrong))
        form method="post" action="/admin/login" {
            (credentials("current-password"))
            button type="submit" { "Sign in" }
        }
    };
    document(console, None, "Sign in", &body)
}

/// The page on which the first operator chooses name and password.
pub(super) fn first(console: &Console, key: &str, wrong: &str) -> Markup {
    let body = html! {
        (complaint(wrong))
        p { "This link works once. It names the first operator, who owns the study." }
        form method="post" action="/admin/first" {
            input type="hidden" name="key" value=(key);
            (credentials("new-password"))
            p.note { "A password of " (PASSWORD.start()) " letters or more." }
            button type="submit" { "Begin" }
        }
    };
    document(console, None, "First operator", &body)
}

/// What was wrong with a form.
pub(super) fn complaint(wrong: &str) -> Markup {
    html! { @if !wrong.is_empty() { p.lacking role="alert" { (wrong) } } }
}

/// Fields for name and password.
pub(super) fn credentials(kind: &str) -> Markup {
    html! {
        div.field {
            label for="name" { "Name" }
            input #name name="name" required autocomplete="username";
        }
        div.field {
            label for="password" { "Password" }
            input #password name="password" type="password" required autocomplete=(kind);
        }
    }
}

/// A page that says what went wrong.
pub(super) fn problem(console: &Console, status: StatusCode, title: &str, text: &str) -> Response {
    let body = html! {
        p { (text) }
        p { a.button href="/admin/live" { "To the live page" } }
    };
    reply::page(status, document(console, None, title, &body))
}
