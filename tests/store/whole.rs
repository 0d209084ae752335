//! Whole participations.

use super::{Person, open, opening};
use gaitway::study::file::Front;
use gaitway::study::plan::Ending;
use gaitway::study::protocol::{Content, Event, State};
use gaitway::study::store::{Reading, Store, Trouble, wait};

#[test]
fn a_participation_survives_reopening_at_every_page() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = open(folder.path(), 12);
    let mut person = Person::come(&store, None).unwrap();
    let mut pages = Vec::new();
    while !matches!(person.page().content, Content::Ended { .. }) {
        let before = person.turn.clone();
        drop(store);
        store = Store::open_again(folder.path()).unwrap();
        let after = wait(|then| store.turn(&person.token, then)).unwrap();
        assert_eq!(after, before);
        pages.push(before.page.id);
        person.go_on(&store, 1).unwrap();
    }
    assert_eq!(person.turn.state, State::Ended(Ending::Finished));
    // consent, two pages before and two after, a check, 3 practice walks and 12 trials of two pages but for the instructed one
    assert_eq!(pages.len(), 1 + 2 + 2 + 1 + 2 * 3 + 2 * 12 - 1, "{pages:?}");
    let tables = wait(|then| store.tables(then)).unwrap();
    drop(store);
    let read = Reading::open(folder.path()).unwrap();
    assert_eq!(read.tables(None), tables);
    assert_eq!(tables.participants[0].frames.unwrap().all, 240 * (3 + 11));
    let walks = tables.answers.iter().filter(|answer| answer.part == "walks").count();
    assert_eq!(walks, 12 * 4);
    let written = gaitway::study::tables::write(&tables);
    assert_eq!(gaitway::study::tables::read(&written.0, &written.1, "test").unwrap(), tables);
}

#[test]
fn an_answer_that_is_sent_twice_counts_once_and_the_last_one_counts() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path(), 12);
    let mut person = Person::come(&store, None).unwrap();
    person.go_to(&store, "practice");
    person.go_on(&store, 1).unwrap();
    let events = person.events();
    let Event::Answer(first) = events[0].clone() else { panic!("{events:?}") };
    let changed =
        gaitway::study::protocol::Answer { value: Some(4), key: "other".to_owned(), ..first.clone() };
    for answer in [&first, &first, &changed, &first] {
        person.send(&store, Event::Answer(answer.clone())).unwrap();
    }
    let rows = rusqlite_rows(
        folder.path(),
        &format!("SELECT value FROM answer WHERE question = '{}'", first.question),
    );
    assert_eq!(rows, [1, 4]);
    let tables = wait(|then| store.tables(then)).unwrap();
    let counted: Vec<_> = tables.answers.iter().filter(|row| row.question == first.question).collect();
    assert_eq!((counted.len(), counted[0].number()), (1, Some(4)));
}

/// The first column of what a query finds.
pub(super) fn rusqlite_rows(folder: &std::path::Path, sql: &str) -> Vec<i64> {
    let connection = rusqlite::Connection::open(folder.join(gaitway::study::store::STORE)).unwrap();
    let mut statement = connection.prepare(sql).unwrap();
    let rows = statement.query_map([], |row| row.get(0)).unwrap();
    rows.map(Result::unwrap).collect()
}

#[test]
fn a_platforms_participant_is_one_participant_however_often_they_come() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path(), 12);
    let mut first = Person::come(&store, Some("P1")).unwrap();
    first.go_on(&store, 3).unwrap();
    let mut second = Person::come(&store, Some("P1")).unwrap();
    assert_eq!(second.turn, first.turn);
    assert_ne!(second.token, first.token);
    assert_ne!(Person::come(&store, Some("P2")).unwrap().turn.code, first.turn.code);
    // both browsers are known, and each sees what the other did
    second.go_on(&store, 1).unwrap();
    assert_eq!(wait(|then| store.turn(&first.token, then)).unwrap(), second.turn);
    let resumed = wait(|then| store.resume(&first.turn.code.to_lowercase(), Front::Web, then)).unwrap();
    assert_eq!(resumed.turn, second.turn);
    assert_eq!(wait(|then| store.resume("0", Front::Web, then)), Err(Trouble::Unknown));
    assert_eq!(wait(|then| store.turn("stolen", then)), Err(Trouble::Unknown));
}

#[test]
fn neither_ids_of_platforms_nor_secrets_of_browsers_lie_in_the_store() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path(), 12);
    let person = Person::come(&store, Some("PLATFORM-PERSON-1")).unwrap();
    drop(store);
    let bytes = std::fs::read(folder.path().join(gaitway::study::store::STORE)).unwrap();
    let has = |bytes: &[u8], text: &str| bytes.windows(text.len()).any(|part| part == text.as_bytes());
    assert!(has(&bytes, &person.turn.code));
    assert!(!has(&bytes, "PLATFORM-PERSON-1") && !has(&bytes, &person.token));
    let links = std::fs::read(folder.path().join(gaitway::study::store::LINKS)).unwrap();
    assert!(has(&links, "PLATFORM-PERSON-1"));
}

#[test]
fn every_walk_gets_its_answers_while_people_leave_and_the_store_is_reopened() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = open(folder.path(), 30);
    let mut finished = 0;
    for number in 0..80 {
        let Ok(mut person) = Person::come(&store, None) else { break };
        // every third one leaves somewhere
        let pages = if number % 3 == 0 { 12 + number % 20 } else { usize::MAX };
        person.go_on(&store, pages).unwrap();
        finished += usize::from(person.turn.state == State::Ended(Ending::Finished));
        if number % 7 == 0 {
            drop(store);
            store = Store::open_again(folder.path()).unwrap();
        }
        let overview = wait(|then| store.overview(then)).unwrap();
        let (least, most) = overview.answered["walks"];
        assert!(most - least <= 8, "{overview:?}");
        if !overview.is_admitting {
            break;
        }
    }
    let overview = wait(|then| store.overview(then)).unwrap();
    assert!(!overview.is_admitting && finished >= 20, "{overview:?}");
    assert_eq!(overview.at_least["walks"], 10);
    let counts = &overview.counts.iter().find(|one| one.part == "walks").unwrap().counts;
    assert!(counts.iter().all(|&count| count >= 10), "{counts:?}");
}

#[test]
fn a_changed_study_needs_a_new_version_and_participants_keep_theirs() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path(), 12);
    let mut old = Person::come(&store, None).unwrap();
    old.go_on(&store, 2).unwrap();
    let error = Store::open(folder.path(), &opening(12, |text| text)).unwrap_err().to_string();
    assert!(error.contains("in use by another gaitway"), "{error}");
    drop(store);
    let milder = |text: String| text.replace("This person looks happy", "The person seems happy");
    let error = Store::open(folder.path(), &opening(12, milder)).unwrap_err().to_string();
    assert!(error.contains("raise study.version"), "{error}");
    let newer = |text: String| milder(text).replace("version = 1", "version = 2");
    let store = Store::open(folder.path(), &opening(12, newer)).unwrap();
    let text = |person: &Person| {
        let page = &person.turn.page;
        page.content.questions().iter().map(|question| question.text.clone()).collect::<String>()
    };
    old.go_to(&store, "practice");
    old.go_on(&store, 1).unwrap();
    let mut new = Person::come(&store, None).unwrap();
    new.go_to(&store, "practice");
    new.go_on(&store, 1).unwrap();
    assert!(text(&old).contains("looks happy") && text(&new).contains("seems happy"));
    assert_eq!((old.turn.version, new.turn.version), (1, 2));
    let other = |text: String| {
        text.replace("id = \"eva-gaits\"", "id = \"other\"").replace("version = 1", "version = 3")
    };
    drop(store);
    let error = Store::open(folder.path(), &opening(12, other)).unwrap_err().to_string();
    assert!(error.contains("a folder of its own"), "{error}");
}
