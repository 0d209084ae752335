//! From the first page to the last, without scripts but for films; back after a break; withdrawn.

use gaitway::study::tables::Value;

use crate::lab::{Lab, agree, begin, go_on, next, wait};

#[test]
fn a_whole_study_goes_by_forms_and_ends_with_a_code() {
    let lab = Lab::plain();
    let mut browser = lab.browser();
    let welcome = browser.open("/s/looks");
    assert!(welcome.body.contains("How do they look?") && welcome.body.contains("about 7 minutes"));
    assert_eq!(
        wait(|then| lab.store.people(then)).len(),
        0,
        "looking at the first page makes no participant"
    );
    let consent = begin(&mut browser);
    assert_eq!(consent.attribute("data-page"), "consent");
    assert!(consent.body.contains("<h1>Taking part</h1>") && consent.body.contains("at least 18 years"));
    let first = agree(&mut browser, &consent);
    let pages = go_on(&mut browser, first, "");
    let ids: Vec<String> = pages.iter().map(|page| page.attribute("data-page")).collect();
    // every film has a page to watch and one to answer; the instructed trial has no film
    let count = |part: &str| ids.iter().filter(|id| id.starts_with(part)).count();
    assert_eq!([count("practice/"), count("walks/")], [6, 9], "{ids:?}");
    assert!(
        pages.iter().any(|page| page.body.contains("<p class=\"progress\">3 of 5</p>")),
        "3 + 1 + 1 trials"
    );
    let last = pages.last().unwrap();
    assert!(last.body.contains("C1DONE") && last.body.contains("Thank you. You are done."));
    let answers = wait(|then| lab.store.tables(then)).answers;
    let of = |part: &str| answers.iter().filter(|answer| answer.part == part).count();
    assert_eq!([of("practice"), of("walks"), of("remarks"), of("check")], [6, 10, 1, 1]);
    assert!(answers.iter().all(|answer| answer.ms.is_some_and(|ms| ms < 600_000)));
}

#[test]
fn a_page_that_lacks_an_answer_comes_again_with_what_was_given() {
    let lab = Lab::plain();
    let (mut browser, page) = lab.agreed();
    let page = go_on(&mut browser, page, "practice/1").pop().unwrap();
    let page = next(&mut browser, &page);
    let (mark, id) = (page.attribute("data-mark"), page.attribute("data-page"));
    let fields = [("mark", mark.as_str()), ("page", &id), ("shown", "1"), ("q:health.well", "2")];
    let again = browser.post("/s/looks/answer", &fields);
    assert_eq!((again.status, again.attribute("data-page")), (422, id.clone()));
    assert!(again.body.contains("Some questions are not answered yet."));
    assert_eq!(again.body.matches("Please answer this.").count(), 1);
    assert_eq!(again.body.matches(" checked").count(), 1);
    let wrong = [("mark", mark.as_str()), ("page", &id), ("q:health.well", "9"), ("q:health.ill", "1")];
    assert_eq!(browser.post("/s/looks/answer", &wrong).status, 422);
    // what was taken before counts; only the rest is needed
    let rest = [("mark", mark.as_str()), ("page", &id), ("q:health.ill", "1")];
    assert_eq!(browser.post("/s/looks/answer", &rest).status, 303);
    // sent again, it changes nothing
    assert_eq!(browser.post("/s/looks/answer", &rest).status, 303);
    assert_eq!(browser.open("/s/looks/go").attribute("data-page"), "practice/2");
}

#[test]
fn who_fails_the_check_twice_is_screened_out_with_a_code() {
    let lab = Lab::plain();
    let (mut browser, page) = lab.agreed();
    let page = go_on(&mut browser, page, "check/1").pop().unwrap();
    let wrong = |page: &str, mark: &str| {
        [("mark", mark), ("page", page), ("q:question-1", "1")].map(|(a, b)| (a.to_owned(), b.to_owned()))
    };
    for attempt in ["check/1", "check/2"] {
        let fields = wrong(attempt, &page.attribute("data-mark"));
        let fields: Vec<(&str, &str)> = fields.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
        let reply = browser.post("/s/looks/answer", &fields);
        let shown = browser.follow(reply);
        assert_eq!(shown.body.contains("Not all answers were right"), attempt == "check/1");
        assert_eq!(shown.body.contains("C2OUT"), attempt == "check/2");
    }
}

#[test]
fn a_script_sends_answers_at_once_and_twice_counts_once() {
    let lab = Lab::plain();
    let (mut browser, page) = lab.agreed();
    let mark = page.attribute("data-mark");
    let answer = |value: i64, key: &str| {
        format!(
            r#"{{"page":"about-you","question":"age","value":{value},"first_ms":10,"ms":20,"key":"{key}"}}"#
        )
    };
    for (value, key) in [(30, "a"), (30, "a"), (31, "b"), (30, "a")] {
        let reply = browser.json("/s/looks/answer", &mark, &answer(value, key));
        assert_eq!((reply.status, reply.body.as_str()), (200, r#"{"page":"about-you"}"#));
    }
    let refused = browser.json("/s/looks/answer", &mark, &answer(500, "c"));
    assert_eq!(refused.status, 409);
    assert!(refused.body.contains("off-scale"), "{refused:?}");
    let next = r#"{"event":"next","page":"about-you"}"#;
    for _ in 0..2 {
        assert_eq!(browser.json("/s/looks/event", &mark, next).body, r#"{"page":"rules"}"#);
    }
    let ages: Vec<_> = wait(|then| lab.store.tables(then)).answers;
    assert_eq!(ages.iter().filter(|answer| answer.question == "age").count(), 1);
    assert_eq!(ages.iter().find(|answer| answer.question == "age").unwrap().value, Some(Value::Number(31)));
}

#[test]
fn a_film_that_cannot_be_shown_is_a_fault_and_another_follows() {
    let lab = Lab::plain();
    let (mut browser, page) = lab.agreed();
    let page = go_on(&mut browser, page, "walks/1").pop().unwrap();
    let (mark, id, film) =
        (page.attribute("data-mark"), page.attribute("data-page"), page.attribute("data-film"));
    // the instructed trial may come first
    let (page, id, film) = if film.is_empty() {
        let page = next(&mut browser, &page);
        let (id, film) = (page.attribute("data-page"), page.attribute("data-film"));
        (page, id, film)
    } else {
        (page, id, film)
    };
    assert!(page.body.contains("<noscript>"));
    let fault = format!(r#"{{"event":"fault","page":"{id}","reason":"{}"}}"#, "x".repeat(5000));
    assert_eq!(browser.json("/s/looks/event", &mark, &fault).status, 200);
    let other = browser.open("/s/looks/go");
    assert_eq!(other.attribute("data-page"), id);
    assert_ne!(other.attribute("data-film"), film);
    assert_eq!(wait(|then| lab.store.overview(then)).faults, 1);
}

#[test]
fn a_participant_goes_on_where_they_were_in_this_browser_or_another() {
    let lab = Lab::plain();
    let (mut browser, page) = lab.agreed();
    let page = go_on(&mut browser, page, "check/1").pop().unwrap();
    assert_eq!(browser.open("/s/looks").attribute("data-page"), "check/1");
    let code = page.body.split("class=\"code\">").nth(1).unwrap().split('<').next().unwrap().to_owned();
    assert_eq!(code.len(), 26);
    let mut other = lab.browser();
    assert_eq!(other.open(&format!("/s/looks?code={code}")).attribute("data-page"), "check/1");
    assert_eq!(wait(|then| lab.store.people(then)).len(), 1);
    assert_eq!(lab.browser().open("/s/looks?code=NOSUCHCODE").status, 401);
    // a second press of the first button in the same browser makes no second participant
    assert_eq!(begin(&mut browser).attribute("data-page"), "check/1");
    assert_eq!(wait(|then| lab.store.people(then)).len(), 1);
    // but a shared machine can begin again
    let reply = browser.post("/s/looks/begin", &[("new", "1")]);
    assert_eq!(browser.follow(reply).attribute("data-page"), "consent");
    assert!(lab.browser().get("/s/looks/go").header("location").ends_with("/s/looks"));
}

#[test]
fn withdrawing_asks_once_and_deletes() {
    let lab = Lab::plain();
    let (mut browser, page) = lab.agreed();
    let page = go_on(&mut browser, page, "practice/1").pop().unwrap();
    assert!(!wait(|then| lab.store.tables(then)).answers.is_empty());
    let mark = page.attribute("data-mark");
    let asked = browser.post("/s/looks/withdraw", &[("mark", &mark)]);
    assert!(asked.status == 200 && asked.body.contains("name=\"sure\""));
    assert_eq!(browser.open("/s/looks/go").attribute("data-page"), "practice/1", "asked only");
    let gone = browser.post("/s/looks/withdraw", &[("mark", &mark), ("sure", "yes")]);
    assert!(gone.status == 200 && gone.body.contains("You have withdrawn") && gone.body.contains("C3GONE"));
    assert!(!gone.body.contains("Stop and withdraw"));
    let left = wait(|then| lab.store.tables(then));
    assert!(left.answers.is_empty(), "{left:?}");
}

#[test]
fn declining_is_as_easy_as_agreeing_and_stores_no_more() {
    let lab = Lab::plain();
    let mut browser = lab.browser();
    let consent = begin(&mut browser);
    let mark = consent.attribute("data-mark");
    let reply = browser.post("/s/looks/begin", &[("mark", &mark), ("agree", "no")]);
    let page = browser.follow(reply);
    assert!(page.body.contains("You do not take part"));
    let reply = browser.post("/s/looks/begin", &[("mark", &mark), ("agree", "yes")]);
    assert!(browser.follow(reply).body.contains("You do not take part"), "not undone by the back button");
    assert_eq!(wait(|then| lab.store.people(then))[0].state.name(), "declined");
}

#[test]
fn the_hash_of_the_consent_is_the_servers() {
    use sha2::{Digest as _, Sha256};
    let lab = Lab::plain();
    let mut browser = lab.browser();
    let mark = begin(&mut browser).attribute("data-mark");
    let body = r#"{"event":"consented","text":"what I like"}"#;
    assert_eq!(browser.json("/s/looks/event", &mark, body).status, 200);
    let text = lab.store.current().text("consent.md").unwrap().to_owned();
    let hash: String = Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect();
    let store = lab.folder.path().join("run/study.sqlite");
    let connection =
        rusqlite::Connection::open_with_flags(store, rusqlite::OpenFlags::SQLITE_OPEN_READ_ONLY).unwrap();
    let sql = "SELECT detail FROM event WHERE kind = 'consented'";
    let detail: String = connection.query_row(sql, [], |row| row.get(0)).unwrap();
    assert!(detail.contains(&hash) && !detail.contains("what I like"), "{detail}");
}
