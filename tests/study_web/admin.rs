//! Operators: the first password, roles, what they do, and what is noted of it.

use crate::client::{Browser, Reply};
use crate::lab::{Lab, go_on, wait};
use gaitway::study::store::Role;
use std::net::SocketAddr;

const PASSWORD: &str = "a long password";

/// An operator who has come by the first link.
pub(crate) fn owner(lab: &Lab) -> Browser {
    let mut browser = Browser::new(lab.console);
    let key = lab.first_link.split("key=").nth(1).unwrap();
    let form = browser.open(&format!("/admin/first?key={key}"));
    assert!(form.body.contains("This link works once"));
    let reply = browser.post("/admin/first", &[("key", key), ("name", "ann"), ("password", PASSWORD)]);
    assert!(browser.follow(reply).body.contains("<h1>Live</h1>"));
    browser
}

/// The mark of an operator's forms.
fn mark(browser: &mut Browser) -> String {
    mark_of(&browser.open("/admin/participants"))
}

/// The mark of the forms on a page; empty without forms.
pub(crate) fn mark_of(page: &Reply) -> String {
    let rest = page.body.split("name=\"mark\" value=\"").nth(1);
    rest.map_or_else(String::new, |rest| rest.split('"').next().unwrap().to_owned())
}

fn sign_in(lab: &Lab, name: &str, password: &str) -> (Browser, Reply) {
    sign_in_with(lab.console, name, password)
}

/// The first operator at another address.
pub(crate) fn sign_in_at(console: SocketAddr, name: &str) -> (Browser, Reply) {
    sign_in_with(console, name, PASSWORD)
}

pub(crate) fn sign_in_with(console: SocketAddr, name: &str, password: &str) -> (Browser, Reply) {
    let mut browser = Browser::new(console);
    let reply = browser.post("/admin/login", &[("name", name), ("password", password)]);
    let page = browser.follow(reply);
    (browser, page)
}

/// An owner's browser, and one of an operator with a role.
pub(crate) fn with_role(lab: &Lab, role: &str) -> Browser {
    let mut own = owner(lab);
    let mark = mark_of(&own.open("/admin/operators"));
    let fields = [("mark", mark.as_str()), ("name", "bob"), ("password", "another password"), ("role", role)];
    let reply = own.post("/admin/operators", &fields);
    assert!(own.follow(reply).body.contains("The operator is named."));
    sign_in(lab, "bob", "another password").0
}

#[test]
fn the_first_link_works_once_and_passwords_are_stored_as_hashes() {
    let lab = Lab::plain();
    let key = lab.first_link.split("key=").nth(1).unwrap().to_owned();
    let mut browser = Browser::new(lab.console);
    for path in
        ["/admin/first?key=0", "/admin/first", "/admin/live", "/admin/participants", "/admin/balance", "/"]
    {
        assert!(browser.open(path).body.contains("<h1>Sign in</h1>"), "{path}");
    }
    let short = browser.post("/admin/first", &[("key", &key), ("name", "ann"), ("password", "short")]);
    assert!(short.status == 422 && short.body.contains("12 to 200 letters"));
    owner(&lab);
    let again = browser.post("/admin/first", &[("key", &key), ("name", "eve"), ("password", PASSWORD)]);
    assert!(browser.follow(again).body.contains("<h1>Sign in</h1>"));
    assert!(wait(|then| lab.store.operator("eve", then)).is_none());
    let ann = wait(|then| lab.store.operator("ann", then)).unwrap();
    assert!(ann.role == Role::Own && ann.hash.starts_with("$argon2id$"));
}

#[test]
fn five_attempts_a_minute_and_sessions_that_end() {
    let lab = Lab::plain();
    owner(&lab);
    let (mut browser, page) = sign_in(&lab, "ann", PASSWORD);
    assert!(page.body.contains("<h1>Live</h1>"));
    let cookie = browser.received.iter().find(|sent| sent.contains("set-cookie")).unwrap().clone();
    assert!(cookie.contains("HttpOnly; SameSite=Strict"), "{cookie}");
    let mark = mark(&mut browser);
    let reply = browser.post("/admin/logout", &[("mark", &mark)]);
    assert!(browser.follow(reply).body.contains("<h1>Sign in</h1>"));
    assert!(browser.open("/admin/live").body.contains("<h1>Sign in</h1>"));
    let attempt = || sign_in(&lab, "ann", "a wrong password").1.status;
    assert!((0..4).all(|_| attempt() == 401), "one of five was right before");
    // a slow machine gets some attempts back meanwhile
    assert!((0..12).any(|_| attempt() == 429));
    assert_eq!(sign_in(&lab, "ann", PASSWORD).1.status, 429, "the right one has to wait, too");
}

#[test]
fn roles_see_act_and_own() {
    let lab = Lab::plain();
    let (_, page) = lab.agreed();
    drop(page);
    let code = wait(|then| lab.store.people(then))[0].code.clone();
    let mut watch = with_role(&lab, "watch");
    let list = watch.open("/admin/participants");
    assert!(list.body.contains(&code) && !list.body.contains("value=\"pause\""));
    assert!(!watch.open("/admin/live").body.contains("Close admission"));
    assert_eq!(watch.open("/admin/operators").status, 403);
    let mark =
        watch.open("/admin/live").body.split("name=\"mark\" value=\"").nth(1).unwrap()[..16].to_owned();
    let pause = [("mark", mark.as_str()), ("code", &code), ("act", "pause")];
    assert_eq!(watch.post("/admin/participants", &pause).status, 403);
    for path in ["/admin/admission", "/admin/backup", "/admin/operators"] {
        assert_eq!(watch.post(path, &[("mark", &mark)]).status, 403, "{path}");
    }
    assert_eq!(wait(|then| lab.store.people(then))[0].state.name(), "consented");
}

#[test]
fn an_operator_pauses_notes_excludes_closes_and_copies_and_all_is_noted() {
    let lab = Lab::plain();
    let (mut participant, page) = lab.agreed();
    go_on(&mut participant, page, "walks/");
    let code = wait(|then| lab.store.people(then))[0].code.clone();
    let mut browser = with_role(&lab, "run");
    let mark = mark(&mut browser);
    let mut act = |act: &str, text: &str| {
        let fields = [("mark", mark.as_str()), ("code", code.as_str()), ("act", act), ("text", text)];
        let reply = browser.post("/admin/participants", &fields);
        browser.follow(reply)
    };
    assert!(act("pause", "").body.contains("Done."));
    let paused = participant.open("/s/looks/go");
    assert!(paused.body.contains("<h1 tabindex=\"-1\">Paused</h1>") && paused.body.contains("data-again"));
    act("resume", "");
    assert!(participant.open("/s/looks/go").attribute("data-page").starts_with("walks/"));
    act("note", "was <b>tired</b>");
    assert!(act("exclude", "").body.contains("Give a reason"));
    let list = act("exclude", "fell <i>asleep</i>");
    assert!(list.body.contains("fell &lt;i&gt;asleep&lt;/i&gt;") && list.body.contains("excluded"));
    assert!(participant.open("/s/looks/go").body.contains("The study ends here"));
    let reply = browser.post("/admin/admission", &[("mark", &mark), ("open", "no")]);
    assert!(browser.follow(reply).body.contains("Admission is closed."));
    assert!(wait(|then| lab.store.overview(then)).is_closed);
    let reply = browser.post("/admin/backup", &[("mark", &mark)]);
    assert!(browser.follow(reply).body.contains("A copy is"));
    assert_eq!(std::fs::read_dir(lab.folder.path().join("run/backups")).unwrap().count(), 1);
    let store = lab.folder.path().join("run/study.sqlite");
    let connection =
        rusqlite::Connection::open_with_flags(store, rusqlite::OpenFlags::SQLITE_OPEN_READ_ONLY).unwrap();
    let mut audit =
        connection.prepare("SELECT operator || ' ' || what FROM audit ORDER BY at, rowid").unwrap();
    let noted: Vec<String> = audit.query_map([], |row| row.get(0)).unwrap().map(Result::unwrap).collect();
    for entry in
        ["ann set operator", "bob signed in", "bob pause", "bob exclude", "bob close admission", "bob backup"]
    {
        assert!(noted.iter().any(|own| own == entry), "{entry}: {noted:?}");
    }
}

#[test]
fn a_participant_who_writes_to_the_lab_is_withdrawn_after_a_word_that_confirms_it() {
    let lab = Lab::plain();
    let (mut participant, page) = lab.agreed();
    go_on(&mut participant, page, "walks/");
    let code = wait(|then| lab.store.people(then))[0].code.clone();
    let mut browser = with_role(&lab, "run");
    let mark = mark(&mut browser);
    let mut withdraw = |text: &str| {
        let fields = [("mark", mark.as_str()), ("code", code.as_str()), ("act", "withdraw"), ("text", text)];
        let reply = browser.post("/admin/participants", &fields);
        browser.follow(reply).body
    };
    assert!(withdraw("").contains("it cannot be undone"));
    assert_eq!(wait(|then| lab.store.people(then))[0].state.name(), "placed");
    assert!(withdraw("withdraw").contains("Done."));
    assert_eq!(wait(|then| lab.store.people(then))[0].state.name(), "withdrawn");
    assert_eq!(wait(|then| lab.store.tables(then)).answers.len(), 0);
}

#[test]
fn the_live_page_counts_and_tells_when_to_ask_again() {
    let lab = Lab::plain();
    let (mut participant, page) = lab.agreed();
    go_on(&mut participant, page, "walks/");
    let mut browser = owner(&lab);
    let page = browser.open("/admin/live");
    for part in
        ["looks · open", "1 under way", "fewest 0", "of 2", "places <strong>1</strong>", "href=\"/static/"]
    {
        assert!(page.body.contains(part), "{part}: {}", page.body);
    }
    let event = browser.get("/admin/live/events");
    assert_eq!(event.header("content-type"), "text/event-stream");
    assert!(event.body.starts_with("retry: 1000\ndata: ") && event.body.ends_with("\n\n"));
    assert!(event.body.contains("under way"));
    let balance = browser.open("/admin/balance");
    assert_eq!(balance.body.matches("<th scope=\"row\">").count(), 8, "one row a stimulus");
    assert_eq!(Browser::new(lab.console).get("/admin/live/events").status, 401);
    assert_eq!(lab.browser().get("/admin/live").status, 404, "not at the address of participants");
    let evil = [("origin", "http://evil.example.org"), ("content-type", "application/x-www-form-urlencoded")];
    assert_eq!(browser.send("POST /admin/backup HTTP/1.1\r\n", &evil, "").status, 403);
    assert_eq!(browser.send("GET /admin/live HTTP/1.1\r\n", &[("host", "evil.example.org")], "").status, 403);
}
