//! Withdrawal, operators, dates, copies and merging.

use super::whole::rusqlite_rows;
use super::{Person, open, opening};
use gaitway::study::plan::Ending;
use gaitway::study::protocol::Event;
use gaitway::study::protocol::{Content, State};
use gaitway::study::store::{
    Act, LINKS, Operator, RECORDINGS, Reading, Role, STORE, Store, Trouble, backup, merge, wait,
};
use std::path::Path;

fn has(path: &Path, text: &str) -> bool {
    std::fs::read(path).is_ok_and(|bytes| bytes.windows(text.len()).any(|part| part == text.as_bytes()))
}

#[test]
fn who_withdraws_is_forgotten_and_their_place_becomes_free() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path(), 12);
    let mut person = Person::come(&store, Some("P1")).unwrap();
    let other = Person::come(&store, Some("P2")).unwrap();
    let recordings = [&person, &other].map(|one| {
        let recording = folder.path().join(RECORDINGS).join(&one.turn.code);
        std::fs::create_dir_all(&recording).unwrap();
        std::fs::write(recording.join("walks-1.csv"), "steps").unwrap();
        recording
    });
    person.go_to(&store, "comments");
    for event in person.events().into_iter().take(1) {
        person.send(&store, event).unwrap();
    }
    let answered = wait(|then| store.overview(then)).unwrap().answered["walks"];
    assert_eq!(answered, (0, 1));
    person.send(&store, Event::Withdrawn).unwrap();
    assert!(
        matches!(&person.page().content, Content::Ended { ending: Ending::Withdrawn, code: Some(code) } if code == "C3ABCDEF")
    );
    assert_eq!(wait(|then| store.overview(then)).unwrap().answered["walks"], (0, 0));
    for table in ["answer", "exposure", "trial"] {
        assert_eq!(rusqlite_rows(folder.path(), &format!("SELECT count(*) FROM {table}")), [0], "{table}");
    }
    // what the participant did in a headset goes with the answers; others' stays
    wait(|then| store.overview(then)).unwrap();
    assert_eq!(recordings.each_ref().map(|path| path.exists()), [false, true]);
    std::fs::create_dir_all(&recordings[0]).unwrap(); // as if the program had been killed before it deleted them
    // neither in the files nor in their logs, while the store is open
    for file in
        [STORE, LINKS].map(str::to_owned).into_iter().chain([format!("{STORE}-wal"), format!("{LINKS}-wal")])
    {
        let path = folder.path().join(&file);
        assert!(!has(&path, "=fine") && !has(&path, "P1s1"), "{file}");
    }
    // the platform may send them again: they see that they have withdrawn
    let again = Person::come(&store, Some("P1")).unwrap();
    assert_eq!(again.turn.page, person.turn.page);
    drop(store);
    let store = Store::open_again(folder.path()).unwrap();
    assert_eq!(recordings.each_ref().map(|path| path.exists()), [false, true]);
    assert_eq!(wait(|then| store.turn(&person.token, then)).unwrap().page, person.turn.page);
    let tables = wait(|then| store.tables(then)).unwrap();
    assert_eq!((tables.participants.len(), tables.answers.len()), (2, 0));
    drop(store);
    for file in [STORE, LINKS] {
        assert!(
            !has(&folder.path().join(file), "=fine") && !has(&folder.path().join(file), "P1\0"),
            "{file}"
        );
    }
}

#[test]
fn where_answers_are_kept_nothing_leads_to_who_withdrew() {
    let folder = tempfile::tempdir().unwrap();
    let anonymous =
        |text: String| text.replace("on_withdrawal = \"delete\"", "on_withdrawal = \"keep-anonymous\"");
    let store = Store::open(folder.path(), &opening(12, anonymous)).unwrap();
    let mut person = Person::come(&store, Some("P1")).unwrap();
    person.go_to(&store, "comments");
    person.send(&store, Event::Withdrawn).unwrap();
    assert_eq!(wait(|then| store.turn(&person.token, then)), Err(Trouble::Unknown));
    assert!(matches!(Person::come(&store, Some("P1")), Err(Trouble::Gone)));
    let tables = wait(|then| store.tables(then)).unwrap();
    assert_eq!(tables.answers.iter().filter(|row| row.part == "walks").count(), 12 * 4);
    assert_eq!(
        rusqlite_rows(folder.path(), "SELECT count(*) FROM participant WHERE external_hash NOT NULL"),
        [0]
    );
}

#[test]
fn operators_act_on_participants_and_the_audit_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path(), 12);
    let mut person = Person::come(&store, None).unwrap();
    person.go_to(&store, "walks");
    let code = person.turn.code.clone();
    let act = |act| wait(|then| store.operate("ada", &code, act, then));
    assert_eq!(act(Act::Pause).unwrap().page.content, Content::Paused);
    let events = person.events();
    assert!(matches!(person.send(&store, events[0].clone()), Err(Trouble::Refused(_))));
    act(Act::Resume).unwrap();
    act(Act::Note { text: "coughed".to_owned() }).unwrap();
    person.go_on(&store, 1).unwrap();
    act(Act::Exclude { reason: "answered by telephone".to_owned() }).unwrap();
    let people = wait(|then| store.people(then)).unwrap();
    assert_eq!(
        (people[0].state, people[0].reason.as_str()),
        (State::Ended(Ending::Excluded), "answered by telephone")
    );
    assert_eq!(wait(|then| store.operate("ada", "NONE", Act::Pause, then)), Err(Trouble::Unknown));
    wait(|then| store.set_admission("ada", false, then)).unwrap();
    assert!(matches!(Person::come(&store, None), Err(Trouble::Closed)));
    let ada = Operator { name: "ada".to_owned(), role: Role::Run, hash: "$argon2id$".to_owned() };
    wait(|then| store.set_operator("owner", ada.clone(), then)).unwrap();
    drop(store);
    let store = Store::open_again(folder.path()).unwrap();
    assert_eq!(wait(|then| store.operator("ada", then)).unwrap(), Some(ada));
    assert_eq!(wait(|then| store.operators(then)).unwrap(), 1);
    assert!(wait(|then| store.overview(then)).unwrap().is_closed);
    wait(|then| store.set_admission("ada", true, then)).unwrap();
    assert!(Person::come(&store, None).is_ok());
    wait(|then| store.health(then)).unwrap();
    let audit = rusqlite_rows(folder.path(), "SELECT count(*) FROM audit WHERE operator = 'ada'");
    assert_eq!(audit, [6]);
}

#[test]
fn a_silent_participants_place_is_given_away_and_they_get_another_when_they_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path(), 12);
    let mut person = Person::come(&store, None).unwrap();
    person.go_to(&store, "walks");
    drop(store);
    // an hour passes: all that happened is an hour older
    let other = rusqlite::Connection::open(folder.path().join(STORE)).unwrap();
    for table in ["event", "answer", "exposure"] {
        other.execute_batch(&format!("UPDATE {table} SET at = at - 3600000")).unwrap();
    }
    other.execute_batch("UPDATE participant SET arrived = arrived - 3600000").unwrap();
    drop(other);
    let store = Store::open_again(folder.path()).unwrap();
    let mut waited = 0;
    while wait(|then| store.people(then)).unwrap()[0].state != State::Lapsed {
        std::thread::sleep(std::time::Duration::from_millis(100));
        waited += 1;
        assert!(waited < 100, "no lapse");
    }
    assert_eq!(wait(|then| store.overview(then)).unwrap().states["lapsed"], 1);
    let turn = wait(|then| store.turn(&person.token, then)).unwrap();
    assert_eq!((turn.state, turn.page.part.as_str()), (State::Placed, "walks"));
    person.turn = turn;
    person.go_on(&store, usize::MAX).unwrap();
    assert_eq!(person.turn.state, State::Ended(Ending::Finished));
}

#[test]
fn a_clock_that_is_set_back_moves_nothing_back() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path(), 12);
    let mut person = Person::come(&store, None).unwrap();
    person.go_on(&store, 2).unwrap();
    drop(store);
    // as if the clock had been a day ahead before
    let other = rusqlite::Connection::open(folder.path().join(STORE)).unwrap();
    other.execute_batch("UPDATE event SET at = at + 86400000").unwrap();
    drop(other);
    let store = Store::open_again(folder.path()).unwrap();
    person.go_on(&store, 3).unwrap();
    let at = rusqlite_rows(folder.path(), "SELECT at FROM event ORDER BY seq");
    assert!(at.is_sorted() && at.len() > 3, "{at:?}");
}

#[test]
fn links_go_on_their_date_and_copies_hold_no_links() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path(), 12);
    let mut person = Person::come(&store, Some("PLATFORM-PERSON-1")).unwrap();
    person.go_on(&store, 4).unwrap();
    assert_eq!(wait(|then| store.overview(then)).unwrap().links_days, Some(29));
    assert_eq!(wait(|then| store.purge(then)), Ok((0, 0)));
    let copy = backup(folder.path()).unwrap();
    assert!(has(&copy, &person.turn.code) && !has(&copy, "PLATFORM-PERSON-1"));
    drop(store);
    let links = rusqlite::Connection::open(folder.path().join(LINKS)).unwrap();
    links.execute_batch("UPDATE link SET at = at - 31 * 86400000").unwrap();
    drop(links);
    let store = Store::open_again(folder.path()).unwrap();
    assert_eq!(wait(|then| store.purge(then)), Ok((1, 0)));
    assert_eq!(wait(|then| store.overview(then)).unwrap().links_days, None);
    drop(store);
    assert!(!has(&folder.path().join(LINKS), "PLATFORM-PERSON-1"));
    // a copy is a store
    let restored = tempfile::tempdir().unwrap();
    std::fs::copy(&copy, restored.path().join(STORE)).unwrap();
    let read = Reading::open(restored.path()).unwrap();
    assert_eq!(read.people()[0].code, person.turn.code);
    for _ in 0..26 {
        backup(restored.path()).unwrap();
    }
    let kept = std::fs::read_dir(restored.path().join("backups")).unwrap().count();
    assert_eq!(kept, 24);
}

#[test]
fn folders_of_several_machines_become_one() {
    let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let mut expected = gaitway::study::tables::Tables::default();
    for (number, folder) in folders.iter().enumerate() {
        let store = open(folder.path(), 12);
        for _ in 0..=number {
            let mut person = Person::come(&store, Some("P1")).unwrap();
            person.go_on(&store, 14).unwrap();
            Person::come(&store, None).unwrap().go_on(&store, usize::MAX).unwrap();
        }
        let tables = wait(|then| store.tables(then)).unwrap();
        expected.participants.extend(tables.participants);
        expected.answers.extend(tables.answers);
    }
    let into = tempfile::tempdir().unwrap();
    let from: Vec<_> = folders.iter().map(|folder| folder.path().to_owned()).collect();
    assert_eq!(merge(&from, &into.path().join("all")).unwrap(), 5);
    let read = Reading::open(&into.path().join("all")).unwrap();
    assert_eq!(read.tables(None), expected);
    let error = merge(&from, &into.path().join("all")).unwrap_err().to_string();
    assert!(error.contains("exists"), "{error}");
    let other = tempfile::tempdir().unwrap();
    drop(open(other.path(), 13));
    let changed = tempfile::tempdir().unwrap();
    drop(
        Store::open(changed.path(), &opening(12, |text| text.replace("minutes = 8", "minutes = 9"))).unwrap(),
    );
    let error = merge(&[from[0].clone(), changed.path().to_owned()], &into.path().join("two")).unwrap_err();
    assert!(error.to_string().contains("different studies or versions"), "{error}");
}
