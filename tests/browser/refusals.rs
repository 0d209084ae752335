//! Pages that say why a participant cannot go on now: the study is full, the store cannot write.

use super::driver::{Browser, Options};
use super::looks::assert_clean;
use super::visit::{Given, Hands, Visit};
use gaitway::study::store::STORE;
use rusqlite::Connection;

/// Narrow, where not all that stands on a page may fit.
fn narrow() -> Options {
    Options { size: [320, 568], ..Options::default() }
}

/// Asserts that a page reads well, in light and dark, at 320 pixels and wide.
fn assert_reads_well(visit: &mut Visit, page: &str) {
    for size in [[320, 568], [1024, 768]] {
        visit.browser.set_size(size);
        visit.assert_fits();
        assert_clean(&mut visit.browser, &format!("{page} {}", size[0]));
    }
    visit.browser.set_size([320, 568]);
}

#[test]
fn a_participant_too_many_reads_why_and_gets_a_place_that_becomes_free() {
    // each sees all walks, and one answer of each is enough
    let one = [("each = 2, at_least = 2", "each = 8, at_least = 1")];
    let Some(mut visit) = Visit::to(narrow(), Hands::Mouse, &one) else { return };
    visit.open();
    visit.go_on("walks/*");
    // another person at the same machine
    visit.browser.go(&format!("{}?new", visit.lab.address()));
    visit.go_on("");
    visit.browser.wait_for_text("h1", "There is no place now");
    assert_reads_well(&mut visit, "full");
    visit.assert_quiet();
    assert!(!visit.browser.text("main").contains("C1ABCDEF"), "a code without a participation");
    // the first one withdraws
    let code = "SELECT code FROM participant ORDER BY id";
    let code: String = visit.store().query_row(code, [], |row| row.get(0)).unwrap();
    let other = Browser::open(Options::default()).unwrap();
    other.go(&format!("{}?code={code}", visit.lab.address()));
    other.click("form[action$='/withdraw'] button");
    other.click("button[value=yes]");
    other.wait_for_text("h1", "You have withdrawn");
    visit.press("main a.button");
    visit.browser.until("no place", |_| (!visit.is_over() && !visit.page().is_empty()).then_some(()));
    visit.go_on("");
    assert!(visit.browser.text("main").contains("C1ABCDEF"));
    assert_eq!(visit.stored("SELECT count(*) FROM participant WHERE state = 'finished'"), 1);
}

#[test]
fn while_nothing_can_be_stored_a_page_says_so_and_later_all_goes_on() {
    let Some(mut visit) = Visit::new(narrow(), Hands::Mouse) else { return };
    visit.open();
    let path = visit.lab.data().join(STORE);
    let lock = || {
        let other = Connection::open(&path).unwrap();
        other.execute_batch("BEGIN IMMEDIATE").unwrap();
        other
    };
    // without a participation
    let held = lock();
    visit.press("form[action$='/begin'] button");
    visit.browser.wait_for_text("h1", "The study does not answer at the moment");
    assert_reads_well(&mut visit, "unavailable");
    drop(held);
    visit.press("main a.button");
    visit.browser.wait_for_text("h1", "How do these people feel?");
    assert_eq!(visit.stored("SELECT count(*) FROM participant"), 0, "what was not acknowledged is not there");
    visit.go_on("consent");
    // with one
    let held = lock();
    visit.press("button[value=yes]");
    visit.browser.wait_for_text("h1", "The study does not answer at the moment");
    assert_reads_well(&mut visit, "unavailable with a participation");
    drop(held);
    visit.press("main a.button");
    visit.browser.until("not back", |_| (visit.page() == "consent").then_some(()));
    let mut given = visit.go_on("practice/1");
    // an answer of a page with scripts waits in the browser
    let held = lock();
    let mut here = Given::new();
    visit.answer("practice/1", &mut here);
    visit.press("button.next");
    visit.browser.wait_for_text("#status", "Offline: your answer waits here and is sent again.");
    assert_eq!(visit.page(), "practice/1");
    drop(held);
    visit.after("practice/1");
    given.extend(here);
    visit.assert_stored(&given);
    let rest: Vec<String> =
        visit.browser.complaints().into_iter().filter(|one| !one.contains("status of 503")).collect();
    assert_eq!(rest, Vec::<String>::new());
}
