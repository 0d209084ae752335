//! Reloads, two tabs, the back button, a browser that is closed: the page is always the one that the store has.

use super::driver::Options;
use super::visit::{Given, Hands, Visit};

#[test]
fn a_reload_of_every_page_shows_the_same_page_with_its_answers() {
    let Some(visit) = Visit::new(Options::default(), Hands::Mouse) else { return };
    visit.open();
    let mut before = Given::new();
    let given = visit.go_through("", |visit, page| {
        let shown = visit.browser.text("h1");
        visit.browser.reload();
        if !["welcome", "end"].contains(&page) {
            assert_eq!(visit.page(), page);
        }
        assert_eq!(visit.browser.text("h1"), shown);
        // what is answered comes again after a reload
        if page.starts_with("practice/") && !page.ends_with(":film") {
            visit.answer(page, &mut before);
            visit.browser.wait_for_text("#status", "Saved");
            visit.browser.reload();
            let checked = visit.browser.count("input:checked");
            assert_eq!(checked, 4, "{page}");
        }
        visit.assert_quiet();
    });
    assert_eq!(before.len(), 3 * 4);
    visit.assert_stored(&given);
    assert!(visit.browser.text("main").contains("C1ABCDEF"), "the code is there after a reload");
}

#[test]
fn two_tabs_double_nothing_and_show_the_right_page() {
    let Some((visit, mut given)) = Visit::at(Options::default(), "practice/1") else { return };
    let first = visit.browser.tab();
    let second = visit.browser.open_tab();
    visit.open();
    assert_eq!(visit.page(), "practice/1");
    // both hold the same page; the first one answers it
    visit.browser.switch_to(&first);
    visit.pass(&mut given);
    assert_eq!(visit.after("practice/1"), "practice/2:film");
    // the second one still shows it: what is chosen there comes too late
    visit.browser.switch_to(&second);
    assert_eq!(visit.page(), "practice/1");
    visit.choose("emotions.happy", 0);
    assert_eq!(visit.after("practice/1"), "practice/2:film");
    visit.assert_stored(&given);
    // the film is seen in the second one; the first one cannot count it again
    visit.pass(&mut given);
    assert_eq!(visit.after("practice/2:film"), "practice/2");
    visit.browser.switch_to(&first);
    assert_eq!(visit.page(), "practice/2:film");
    visit.wait_for_film();
    visit.press(".play");
    assert_eq!(visit.after("practice/2:film"), "practice/2");
    assert_eq!(visit.stored("SELECT count(*) FROM exposure WHERE page = 'practice/2'"), 1);
    // the first half of the answers here, the second half there
    let mut here = Given::new();
    visit.answer("practice/2", &mut here);
    visit.browser.wait_for_text("#status", "Saved");
    visit.browser.switch_to(&second);
    visit.browser.reload();
    assert_eq!(visit.browser.count("input:checked"), 4, "what the other tab was told");
    visit.press("button.next");
    visit.after("practice/2");
    given.extend(here);
    visit.assert_stored(&given);
    given.extend(visit.go_on(""));
    visit.assert_stored(&given);
    visit.browser.switch_to(&first);
    visit.press("button.next");
    visit.browser.until("not at the end", |_| visit.is_over().then_some(()));
    visit.assert_stored(&given);
}

#[test]
fn the_back_button_leads_to_the_page_of_now() {
    let Some((visit, mut given)) = Visit::at(Options::default(), "check/1") else { return };
    for _ in 0..3 {
        visit.browser.back();
        if visit.browser.address().starts_with("http") {
            visit.browser.until("not at the page of now", |_| (visit.page() == "check/1").then_some(()));
        }
    }
    visit.open();
    given.extend(visit.go_on("walks/*"));
    let page = visit.page();
    // some browsers keep the page that is left, and show it as it was
    let first = visit.browser.tab();
    let second = visit.browser.open_tab();
    visit.open();
    visit.pass(&mut given);
    let now = visit.after(&page);
    visit.browser.close_tab(&first);
    assert!(second != first && visit.page() == page);
    visit.browser.run("dispatchEvent(new PageTransitionEvent('pageshow', { persisted: true }))", &[]);
    assert_eq!(visit.after(&page), now);
    let page = now;
    visit.browser.back();
    if visit.browser.address().starts_with("http") {
        visit.browser.until("not at the page of now", |_| (visit.page() == page).then_some(()));
    } else {
        visit.open();
    }
    given.extend(visit.go_on(""));
    visit.assert_stored(&given);
}

#[test]
fn a_browser_that_was_closed_goes_on_where_it_was() {
    let Some((mut visit, mut given)) = Visit::at(Options::default(), "practice/1") else { return };
    visit.server.kill();
    let mut here = Given::new();
    visit.answer("practice/1", &mut here);
    visit.browser.wait_for_text("#status", "Offline: your answer waits here and is sent again.");
    visit.reopen();
    visit.server = visit.lab.serve();
    visit.open();
    given.extend(here);
    let is_stored =
        |visit: &Visit| visit.stored("SELECT count(*) FROM answer WHERE page = 'practice/1'") == 4;
    visit.browser.until("not sent", |_| is_stored(&visit).then_some(()));
    assert_eq!(visit.page(), "practice/1");
    visit.browser.until("not shown", |browser| (browser.count("input:checked") == 4).then_some(()));
    visit.assert_stored(&given);
    visit.press("button.next");
    visit.after("practice/1");
    given.extend(visit.go_on("walks/*:film"));
    let page = visit.page();
    visit.reopen();
    visit.open();
    assert_eq!(visit.page(), page);
    given.extend(visit.go_on(""));
    visit.reopen();
    visit.open();
    assert!(visit.browser.text("main").contains("C1ABCDEF"));
    visit.assert_stored(&given);
}
