//! Every kind of page by axe-core, in light and dark; the pictures of the documentation.

use super::admin::{operated, wait_for};
use super::driver::{Browser, Options};
use super::visit::{Given, Hands, Visit};
use serde_json::json;
use std::collections::BTreeSet;

/// Asserts that axe-core finds nothing, neither in light nor in dark.
pub(super) fn assert_clean(browser: &mut Browser, page: &str) {
    for dark in [false, true] {
        browser.set_dark(dark);
        assert_eq!(browser.violations(), [], "{page}, dark: {dark}");
        let scheme = if dark { "dark" } else { "light" };
        browser.shot(&format!("{scheme}-{}", page.replace(['/', ':', '?', ' '], "-")));
    }
    browser.set_dark(false);
}

/// A page's kind: that of its part, before and after the film.
fn kind(page: &str) -> String {
    let film = if page.ends_with(":film") { " film" } else { "" };
    format!("{}{film}", page.split(['/', ':']).next().unwrap())
}

#[test]
fn every_kind_of_page_passes_axe_in_light_and_dark() {
    let Some(mut visit) = Visit::new(Options::default(), Hands::Mouse) else { return };
    visit.open();
    let mut kinds = BTreeSet::new();
    for _ in 0..60 {
        let page = if visit.is_over() { "end".to_owned() } else { visit.page() };
        // the instruction has a page of its own kind
        let kind =
            if visit.browser.count(".instruction") == 1 { "instruction".to_owned() } else { kind(&page) };
        if page.ends_with(":film") {
            visit.wait_for_film();
        }
        if kinds.insert(kind.clone()) {
            assert_clean(&mut visit.browser, &kind);
            visit.assert_quiet();
        }
        if visit.is_over() {
            break;
        }
        visit.pass(&mut Given::new());
        visit.after(&page);
    }
    let all =
        ["", "about-you", "check", "comments", "consent", "debrief", "end", "how-it-works", "instruction"];
    let all = all.into_iter().chain(["practice", "practice film", "walks", "walks film"]);
    assert_eq!(kinds, all.map(str::to_owned).collect());
}

#[test]
fn errors_withdrawal_and_refusals_pass_axe_too() {
    let Some((mut visit, _)) = Visit::at(Options::default(), "check/1") else { return };
    visit.browser.click("footer summary");
    assert_clean(&mut visit.browser, "code");
    for index in 0..2 {
        visit.choose(&format!("question-{}", index + 1), 1 - index);
    }
    visit.press("button.next");
    visit.after("check/1");
    assert!(visit.browser.text("main").contains("Not all answers were right."));
    assert_clean(&mut visit.browser, "check again");
    visit.press("form[action$='/withdraw'] button");
    visit.browser.wait_for_text("h1", "Do you want to stop and withdraw?");
    assert_clean(&mut visit.browser, "withdrawal");
    visit.press("button[value=yes]");
    visit.browser.wait_for_text("h1", "You have withdrawn");
    assert!(visit.browser.text("main").contains("Your answers are deleted."));
    assert_clean(&mut visit.browser, "withdrawn");
    visit.assert_quiet();
    let host = visit.lab.host();
    for (name, path) in [
        ("not found", "/nothing"),
        ("unknown study", "/s/another"),
        ("unknown code", "/s/eva-gaits?code=NONE"),
        ("gone", "/s/eva-gaits/go"),
        ("again", "/s/eva-gaits?new"),
    ] {
        visit.browser.go(&format!("{host}{path}"));
        assert_clean(&mut visit.browser, name);
        visit.assert_fits();
    }
    visit.press("form[action$='/begin'] button");
    visit.press("button[value=no]");
    visit.browser.wait_for_text("h1", "You do not take part");
    assert_clean(&mut visit.browser, "declined");
    // a status of 4xx is a line in the log, and all that may be there
    let rest =
        visit.browser.complaints().into_iter().filter(|one| !one.contains("responded with a status of 4"));
    assert_eq!(rest.collect::<Vec<_>>(), Vec::<String>::new());
}

/// `GAITWAY_SHOTS=assets/pictures` makes them again.
#[test]
fn pictures_of_the_documentation() {
    let Some((mut visit, operator)) = operated(Options { size: [720, 560], ..Options::default() }) else {
        return;
    };
    visit.browser.set_size([720, 400]);
    visit.open();
    visit.browser.shot("study-welcome");
    visit.go_on("walks/*:film");
    let film = visit.page();
    visit.pass(&mut Given::new());
    visit.after(&film);
    visit.wait_for_film();
    visit.browser.set_size([640, 1400]);
    let sharp = "const canvas = document.querySelector('canvas'); \
        return canvas.width === Math.round(canvas.clientWidth * devicePixelRatio) && canvas.clientWidth > 300";
    visit
        .browser
        .until("a film of few pixels", |browser| (browser.run(sharp, &[]) == json!(true)).then_some(()));
    for (question, choice) in [("happy", 3), ("sad", 1)] {
        visit.choose(&format!("emotions.{question}"), choice);
    }
    visit.browser.run("window.scrollTo(0, 0)", &[]);
    visit.browser.shot("study-film");
    wait_for(&operator, "walks");
    operator.shot("study-admin");
}
