//! Links of platforms, languages, and a study that is closed.

use crate::client::Reply;
use crate::lab::{Lab, begin, go_on, wait};

const PROLIFIC: &[(&str, &str)] = &[("platform = \"none\"", "platform = \"prolific\"")];

#[test]
fn one_person_of_prolific_is_one_participant_and_gets_a_way_back() {
    let lab = Lab::new(PROLIFIC, |_| {});
    let link = "/s/looks?PROLIFIC_PID=p1&STUDY_ID=s&SESSION_ID=x1";
    let arrive = || {
        let mut browser = lab.browser();
        let welcome = browser.open(link);
        assert!(welcome.body.contains("name=\"PROLIFIC_PID\" value=\"p1\""), "{}", welcome.body);
        let reply = browser.post("/s/looks/begin", &[("PROLIFIC_PID", "p1"), ("SESSION_ID", "x1")]);
        let page = browser.follow(reply);
        (browser, page)
    };
    let (mut browser, page) = arrive();
    let page = crate::lab::agree(&mut browser, &page);
    go_on(&mut browser, page, "rules");
    let (mut second, page) = arrive();
    assert_eq!(page.attribute("data-page"), "rules", "goes on where they were, in another browser, too");
    assert_eq!(wait(|then| lab.store.people(then)).len(), 1);
    let last = go_on(&mut second, page, "").pop().unwrap();
    assert!(last.body.contains("href=\"https://app.prolific.com/submissions/complete?cc=C1DONE\""));
    assert!(browser.open(link).body.contains("How do they look?"), "the first page asks before it goes on");
}

#[test]
fn a_preview_of_mechanical_turk_takes_no_place() {
    let lab = Lab::new(&[("platform = \"none\"", "platform = \"mturk\"")], |_| {});
    let mut browser = lab.browser();
    let preview = browser.open("/s/looks?assignmentId=ASSIGNMENT_ID_NOT_AVAILABLE&hitId=h");
    assert!(preview.body.contains("This is a preview") && !preview.body.contains("/begin"));
    let forced =
        browser.post("/s/looks/begin", &[("assignmentId", "ASSIGNMENT_ID_NOT_AVAILABLE"), ("workerId", "w")]);
    assert_eq!(forced.status, 409);
    assert_eq!(wait(|then| lab.store.people(then)).len(), 0);
    let link = "/s/looks?assignmentId=a1&hitId=h&workerId=w1&turkSubmitTo=https%3A%2F%2Fexample.org";
    assert!(browser.open(link).body.contains("name=\"workerId\" value=\"w1\""));
    let reply = browser.post("/s/looks/begin", &[("assignmentId", "a1"), ("workerId", "w1")]);
    let page = browser.follow(reply);
    let page = crate::lab::agree(&mut browser, &page);
    let last = go_on(&mut browser, page, "").pop().unwrap();
    assert!(
        last.body.contains("C1DONE")
            && last.body.contains("Copy this code")
            && !last.body.contains("prolific")
    );
}

#[test]
fn sona_grants_credit_to_the_code_that_it_sent_the_participant_with() {
    let sona = "platform = \"sona\"\ncredit = \"https://school.sona-systems.com/webstudy_credit.aspx?experiment_id=12&credit_token=ab&survey_code=XXXX\"";
    let lab = Lab::new(&[("platform = \"none\"", sona), ("complete = \"C1DONE\", ", "")], |_| {});
    let finish = |code: &str| {
        let mut browser = lab.browser();
        let link =
            if code.is_empty() { "/s/looks".to_owned() } else { format!("/s/looks?survey_code={code}") };
        let welcome = browser.open(&link);
        let sent = format!("name=\"survey_code\" value=\"{code}\"");
        assert_eq!(welcome.body.contains(&sent), !code.is_empty());
        let fields = [("survey_code", code)];
        let reply = browser.post("/s/looks/begin", if code.is_empty() { &[] } else { &fields[..] });
        let page = browser.follow(reply);
        let page = crate::lab::agree(&mut browser, &page);
        let pages = go_on(&mut browser, page, "");
        let before_the_end = &pages[..pages.len() - 1];
        assert!(
            before_the_end.iter().all(|page| !page.body.contains("credit_token")),
            "only who has finished"
        );
        (browser, pages.last().unwrap().body.clone())
    };
    let (mut browser, last) = finish("4711");
    let address = "href=\"https://school.sona-systems.com/webstudy_credit.aspx?experiment_id=12&amp;credit_token=ab&amp;survey_code=4711\"";
    assert!(last.contains(address) && last.contains("Back to Sona"), "{last}");
    assert!(finish("815").1.contains("survey_code=815\""));
    // it stays under the same link, for each participant their own
    assert!(browser.open("/s/looks/go").body.contains(address));
    // a participant whom Sona did not send has nothing to be credited to
    assert!(!finish("").1.contains("sona-systems"));
    // nor has one whose id is deleted, as it is after its time
    let links = rusqlite::Connection::open(lab.folder.path().join("run/links.sqlite")).unwrap();
    links.execute("DELETE FROM link", []).unwrap();
    assert!(!browser.open("/s/looks/go").body.contains("sona-systems"));
}

#[test]
fn pages_speak_the_language_that_the_browser_or_the_participant_wishes() {
    let lab = Lab::plain();
    let mut browser = lab.browser();
    browser.extra.push(("accept-language".to_owned(), "fr, de-AT;q=0.9, en;q=0.5".to_owned()));
    let welcome = browser.open("/s/looks");
    assert!(welcome.body.contains("<html lang=\"de\" dir=\"ltr\">") && welcome.body.contains("Wie sehen"));
    assert!(welcome.body.contains("etwa 7 Minuten"));
    assert!(browser.open("/s/looks?lang=en").body.contains("about 7 minutes"));
    let reply = browser.post("/s/looks/begin", &[("language", "de")]);
    let consent = browser.follow(reply);
    assert!(consent.body.contains("Ich stimme zu") && consent.body.contains("Abbrechen und zurückziehen"));
    // what the program asks by itself, too
    let about = crate::lab::agree(&mut browser, &consent);
    for word in ["Ihr Geschlecht", "Frau", "Das möchte ich nicht sagen", "Ihr Alter in Jahren"] {
        assert!(about.body.contains(word), "{word}: {}", about.body);
    }
    let pages = go_on(&mut browser, about, "");
    let instructed = |page: &&Reply| page.body.contains("gelesen wird. Bitte");
    assert_eq!(pages.iter().filter(instructed).count(), 1);
    // a language that the study does not have
    let mut other = lab.browser();
    let reply = other.post("/s/looks/begin", &[("language", "xx")]);
    assert!(other.follow(reply).body.contains("I agree"));
}

#[test]
fn a_closed_study_lets_nobody_new_in_and_those_inside_go_on() {
    let lab = Lab::plain();
    let (mut browser, page) = lab.agreed();
    wait(|then| lab.store.set_admission("ann", false, then));
    let mut late = lab.browser();
    let reply = begin(&mut late);
    assert!(reply.status == 410 && reply.body.contains("The study is closed"));
    assert_eq!(go_on(&mut browser, page, "check/1").last().unwrap().status, 200);
    assert_eq!(lab.browser().open("/s/other").status, 404);
}
