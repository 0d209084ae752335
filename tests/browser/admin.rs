//! The operators' pages beside a participant.

use super::driver::{Browser, Options};
use super::looks::assert_clean;
use super::visit::{Given, Hands, Visit};
use fantoccini::key::Key;

pub(super) const PASSWORD: &str = "a long password";

/// A participant, and the first operator with the live page before them.
/// `options` are the operator's.
pub(super) fn operated(options: Options) -> Option<(Visit, Browser)> {
    let mut visit = Visit::new(Options::default(), Hands::Mouse)?;
    let operator = Browser::open(options)?;
    operator.go(&visit.server.first_link());
    operator.click("#name");
    operator.type_text("ann");
    operator.press(Key::Tab);
    operator.type_text(PASSWORD);
    operator.press(Key::Enter);
    operator.wait_for_text("h1", "Live");
    Some((visit, operator))
}

/// Waits until the live page says so, without a reload.
pub(super) fn wait_for(operator: &Browser, text: &str) {
    operator.until(&format!("no {text:?}"), |operator| operator.text("#live").contains(text).then_some(()));
}

/// Does something with the only participant, with a text.
fn act(operator: &Browser, act: &str, text: &str) {
    if !text.is_empty() {
        operator.click("td input[name=text]");
        operator.type_text(text);
    }
    operator.click(&format!("button[value={act}]"));
    operator.wait_for_text("p[role=status]", "Done.");
}

#[test]
fn the_live_page_follows_a_participant() {
    let Some((visit, operator)) = operated(Options::default()) else { return };
    operator.run("window.stays = true", &[]);
    wait_for(&operator, "0 under way");
    visit.open();
    visit.go_on("consent");
    wait_for(&operator, "1 under way");
    visit.go_on("practice/*:film");
    wait_for(&operator, "practice");
    let mut given = Given::new();
    for _ in 0..8 {
        let page = visit.page();
        visit.pass(&mut given);
        visit.after(&page);
    }
    wait_for(&operator, "walks");
    visit.go_on("");
    wait_for(&operator, "0 under way");
    wait_for(&operator, "finished 1");
    let stays = operator.run("return window.stays === true", &[]);
    assert_eq!(stays, serde_json::json!(true), "the page was loaded again");
    assert_eq!(operator.complaints(), Vec::<String>::new());
    visit.assert_quiet();
}

#[test]
fn an_operator_pauses_resumes_and_excludes() {
    let Some((mut visit, operator)) = operated(Options::default()) else { return };
    visit.open();
    visit.go_on("practice/1");
    operator.click("a[href='/admin/participants']");
    act(&operator, "pause", "");
    visit.choose("emotions.happy", 2);
    visit.browser.wait_for_text("h1", "Paused");
    assert_clean(&mut visit.browser, "paused");
    act(&operator, "resume", "");
    // the page goes on by itself
    visit.browser.wait_for_text("h1", "What do you think?");
    assert_eq!(visit.browser.count("input:checked"), 0, "an answer that was not taken is not shown");
    visit.go_on("walks/*:film");
    act(&operator, "note", "asked for a pause");
    operator.click("button[value=exclude]");
    operator.wait_for_text("p[role=status]", "Give a reason or a text.");
    act(&operator, "exclude", "fell asleep");
    assert!(operator.text("table").contains("fell asleep"));
    visit.wait_for_film();
    visit.press(".play");
    visit.browser.wait_for_text("h1", "The study ends here");
    assert_clean(&mut visit.browser, "excluded");
    assert_eq!(visit.stored("SELECT count(*) FROM participant WHERE state = 'excluded'"), 1);
    assert_eq!(operator.complaints(), Vec::<String>::new());
}

#[test]
fn operators_pages_pass_axe_in_light_and_dark_and_at_320_pixels() {
    let Some((mut visit, mut operator)) = operated(Options::default()) else { return };
    visit.open();
    visit.go_on("walks/*:film");
    for name in ["Live", "Participants", "Balance", "Operators"] {
        let page = name.to_lowercase();
        operator.click(&format!("a[href='/admin/{page}']"));
        operator.wait_for_text("h1", name);
        assert_clean(&mut operator, &format!("admin {page}"));
        operator.set_size([320, 568]);
        operator.shot(&format!("narrow-admin-{page}"));
        let wide = "return document.documentElement.scrollWidth <= document.documentElement.clientWidth";
        assert_eq!(operator.run(wide, &[]), serde_json::json!(true), "{page} is too wide");
        operator.set_size([1024, 768]);
    }
    operator.click("a[href='/admin/live']");
    operator.click("button[name=open]");
    operator.wait_for_text("p[role=status]", "Admission is closed.");
    visit.browser.go(&format!("{}?new", visit.lab.address()));
    visit.press("form[action$='/begin'] button");
    visit.browser.wait_for_text("h1", "The study is closed");
    assert_clean(&mut visit.browser, "closed");
    assert_eq!(operator.complaints(), Vec::<String>::new());
    operator.click("a[href='/admin/operators']");
    operator.wait_for_text("h1", "Operators");
    let at = operator.address().replace("operators", "nothing");
    operator.go(&at);
    assert_clean(&mut operator, "admin nothing");
    operator.go(&at.replace("nothing", "live"));
    operator.click("header form button");
    operator.wait_for_text("h1", "Sign in");
    assert_clean(&mut operator, "admin sign in");
    operator.click("#name");
    operator.type_text("ann");
    operator.click("#password");
    operator.type_text("a wrong password");
    operator.press(Key::Enter);
    operator.wait_for_text(".lacking", "Name or password is wrong.");
    assert_clean(&mut operator, "admin wrong");
    // a live page whose session has ended leads to the door
    operator.click("#name");
    operator.type_text("ann");
    operator.click("#password");
    operator.type_text(PASSWORD);
    operator.press(Key::Enter);
    operator.wait_for_text("h1", "Live");
    operator.devtools("Network.clearBrowserCookies", &serde_json::json!({}));
    operator.wait_for_text("h1", "Sign in");
}
