//! What happens when the disk does not do its part: nothing is answered well that is not on it.

use super::whole::rusqlite_rows;
use super::{Person, open};
use gaitway::study::protocol::{Content, Event};
use gaitway::study::store::{STORE, Store, Trouble, wait};
use std::time::Instant;

#[test]
fn while_another_program_holds_the_store_nothing_is_taken_and_afterwards_everything() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path(), 12);
    let mut person = Person::come(&store, None).unwrap();
    person.go_to(&store, "walks");
    let place = person.turn.clone();
    let other = rusqlite::Connection::open(folder.path().join(STORE)).unwrap();
    other.execute_batch("BEGIN IMMEDIATE").unwrap();
    let began = Instant::now();
    let events = person.events();
    let refused = person.send(&store, events[0].clone()).unwrap_err();
    assert!(matches!(&refused, Trouble::Unavailable(reason) if reason.contains("locked")), "{refused}");
    assert!(began.elapsed().as_secs() < 10);
    // pages are still shown, from memory that has not run ahead
    assert_eq!(wait(|then| store.turn(&person.token, then)).unwrap(), place);
    other.execute_batch("ROLLBACK").unwrap();
    person.send(&store, events[0].clone()).unwrap();
    assert_ne!(person.turn.page, place.page);
    let token = person.token.clone();
    drop(store);
    let store = Store::open_again(folder.path()).unwrap();
    assert_eq!(wait(|then| store.turn(&token, then)).unwrap(), person.turn);
}

#[test]
fn a_store_that_may_not_grow_answers_that_nothing_was_stored() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path(), 12);
    let mut person = Person::come(&store, None).unwrap();
    person.go_to(&store, "practice");
    person.go_on(&store, 1).unwrap();
    // a trigger stands in for a full disk: SQLite fails the statement as it does with SQLITE_FULL
    let other = rusqlite::Connection::open(folder.path().join(STORE)).unwrap();
    other
        .execute_batch(
            "CREATE TRIGGER full BEFORE INSERT ON answer BEGIN SELECT RAISE(ABORT, 'database or disk is full'); END",
        )
        .unwrap();
    let events = person.events();
    let before = person.turn.clone();
    let refused = person.send(&store, events[0].clone()).unwrap_err();
    assert!(matches!(&refused, Trouble::Unavailable(reason) if reason.contains("disk is full")), "{refused}");
    // what belongs to the page is refused too, since the answers are missing
    let next = person.send(&store, Event::Next { page: before.page.id.clone() }).unwrap_err();
    assert!(matches!(next, Trouble::Refused(_)), "{next}");
    other.execute_batch("DROP TRIGGER full").unwrap();
    for event in events {
        person.send(&store, event).unwrap();
    }
    assert_ne!(person.turn.page, before.page);
    assert_eq!(rusqlite_rows(folder.path(), "SELECT count(*) FROM answer WHERE page LIKE 'practice/%'"), [4]);
}

#[test]
fn requests_of_one_transaction_fail_together_and_places_are_given_again() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path(), 12);
    let mut people: Vec<Person> = (0..8).map(|_| Person::come(&store, None).unwrap()).collect();
    for person in &mut people {
        while !matches!(person.page().content, Content::Text { .. } if person.page().part == "how-it-works") {
            person.go_on(&store, 1).unwrap();
        }
        person.go_to(&store, "practice");
        // up to the answer that gives the place
        person.go_on(&store, 5).unwrap();
        let last = person.events();
        for event in &last[..last.len() - 1] {
            person.send(&store, event.clone()).unwrap();
        }
    }
    let other = rusqlite::Connection::open(folder.path().join(STORE)).unwrap();
    let full = "CREATE TRIGGER full BEFORE INSERT ON trial BEGIN SELECT RAISE(ABORT, 'disk is full'); END";
    other.execute_batch(full).unwrap();
    for person in &mut people {
        let next = Event::Next { page: person.page().id.clone() };
        assert!(matches!(person.send(&store, next), Err(Trouble::Unavailable(_))));
    }
    let places = || wait(|then| store.overview(then)).unwrap().places;
    assert_eq!(places(), 0);
    other.execute_batch("DROP TRIGGER full").unwrap();
    for person in &mut people {
        let next = Event::Next { page: person.page().id.clone() };
        person.send(&store, next).unwrap();
        assert_eq!(person.page().part, "walks");
    }
    assert_eq!(places(), 8);
    let counts = wait(|then| store.overview(then)).unwrap().counts;
    let counts = &counts[0].counts;
    assert!(counts.iter().max().unwrap() - counts.iter().min().unwrap() <= 1, "{counts:?}");
}

#[test]
fn folders_that_hold_something_else_are_refused_with_their_path() {
    let folder = tempfile::tempdir().unwrap();
    let error = Store::open_again(folder.path()).unwrap_err().to_string();
    assert!(error.contains("holds no data of a study"), "{error}");
    std::fs::write(folder.path().join(STORE), "not a database, but a text that is long enough to be one")
        .unwrap();
    let error = Store::open_again(folder.path()).unwrap_err().to_string();
    assert!(error.contains(STORE) && error.contains("not a database"), "{error}");
    let newer = tempfile::tempdir().unwrap();
    drop(open(newer.path(), 12));
    let other = rusqlite::Connection::open(newer.path().join(STORE)).unwrap();
    other.execute_batch("PRAGMA user_version = 7").unwrap();
    let error = Store::open_again(newer.path()).unwrap_err().to_string();
    assert!(error.contains("has format 7") && error.contains("up to 1"), "{error}");
}
