//! The browser is killed in mid-study, and opened again with what it had on its disk.

use super::driver::Options;
use super::visit::{Given, Visit};

/// How often a question of a page has an answer in the store.
fn answers(visit: &Visit, page: &str) -> i64 {
    visit.stored(&format!("SELECT count(*) FROM answer WHERE page = '{page}'"))
}

#[test]
fn a_browser_that_was_killed_goes_on_at_the_same_page_with_every_answer_once() {
    let Some((mut visit, mut given)) = Visit::at(Options::default(), "practice/1") else { return };
    // Chromium writes its cookies half a minute later, or when it is closed
    visit.reopen();
    visit.open();
    assert_eq!(visit.page(), "practice/1");
    // two of four answers are acknowledged
    let mut here = Given::new();
    for (question, choice) in [("emotions.happy", 3), ("emotions.sad", 0)] {
        visit.choose(question, choice);
        here.insert(("practice/1".to_owned(), question.to_owned()), (choice + 1).to_string());
    }
    visit.browser.until("not stored", |_| (answers(&visit, "practice/1") == 2).then_some(()));
    visit.reopen_after_a_crash();
    visit.open();
    assert_eq!(visit.page(), "practice/1");
    given.extend(here);
    visit.assert_stored(&given);
    // what the page of the new browser does not show is answered once more, and the last answer counts
    let shown = visit.browser.count("input:checked");
    println!("the killed browser knows {shown} of 2 answers");
    visit.answer("practice/1", &mut given);
    visit.press("button.next");
    visit.after("practice/1");
    let once = "SELECT count(*) FROM (SELECT DISTINCT question FROM answer WHERE page = 'practice/1')";
    assert_eq!(visit.stored(once), 4);
    // in the middle of a film: it is shown again from its start, and counts once
    let film = visit.page();
    visit.wait_for_film();
    visit.press(".play");
    visit.reopen_after_a_crash();
    visit.open();
    let now = visit.page();
    assert!(now == film || now == film.replace(":film", ""), "{now} after {film}");
    given.extend(visit.go_on("walks/*:film"));
    let seen = "SELECT count(*) FROM exposure WHERE page = 'practice/2'";
    assert_eq!(visit.stored(seen), 1);
    // at the moment of an answer: it is stored or it is not, and it is never there twice
    let page = visit.page();
    visit.pass(&mut Given::new());
    let page = visit.after(&page);
    visit.choose("emotions.angry", 1);
    visit.reopen_after_a_crash();
    visit.open();
    assert_eq!(visit.page(), page);
    assert!(answers(&visit, &page) <= 1);
    given.extend(visit.go_on(""));
    assert!(visit.browser.text("main").contains("C1ABCDEF"));
    let last = "SELECT count(*) FROM (SELECT DISTINCT page, question FROM answer)";
    assert_eq!(visit.stored(last), i64::try_from(given.len()).unwrap());
    let keys = "SELECT count(*) - count(DISTINCT key) FROM answer";
    assert_eq!(visit.stored(keys), 0, "an answer was sent twice and counted twice");
    assert_eq!(visit.stored("SELECT count(*) FROM participant"), 1);
    assert_eq!(visit.stored("SELECT count(*) FROM exposure"), 6);
}

#[test]
fn a_link_of_the_platform_leads_back_though_the_killed_browser_has_no_cookie() {
    let Some((mut visit, _)) = Visit::at(Options::default(), "consent") else { return };
    let link = format!("{}?PROLIFIC_PID=p77&STUDY_ID=s&SESSION_ID=x1", visit.lab.address());
    visit.browser.go(&link);
    let mut given = visit.go_on("practice/1");
    visit.answer("practice/1", &mut given);
    visit.browser.until("not stored", |_| (answers(&visit, "practice/1") == 4).then_some(()));
    visit.reopen_after_a_crash();
    visit.browser.go(&link);
    visit.pass(&mut Given::new());
    visit.after("");
    assert_eq!(visit.page(), "practice/1");
    visit.assert_stored(&given);
}
