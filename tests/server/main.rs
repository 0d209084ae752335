//! The program as a server: `gaitway study serve` under many browsers, killed, and started again.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "a test")]

#[path = "../common/mod.rs"]
mod common;

mod kills;
mod load;

use common::lab::Lab;
use gaitway::study::rehearse::{Outcome, Rehearsal};
use std::path::Path;
use std::time::Duration;

fn rehearsal(lab: &Lab) -> Rehearsal {
    Rehearsal {
        address: lab.address(),
        participants: 100,
        at_once: 64,
        leaving: 0.0,
        pause: Duration::ZERO,
        patience: Duration::from_secs(120),
        seed: 1,
    }
}

/// Asserts that a store has every acknowledged answer, once.
fn check(data: &Path, outcome: &Outcome) {
    let connection = rusqlite::Connection::open(data.join(gaitway::study::store::STORE)).unwrap();
    let integrity: String = connection.query_row("PRAGMA integrity_check", [], |row| row.get(0)).unwrap();
    assert_eq!(integrity, "ok");
    let mut find = connection
        .prepare(
            "SELECT count(*), max(value) FROM answer JOIN participant ON participant.id = answer.participant \
             WHERE code = ?1 AND page = ?2 AND question = ?3 AND key = ?4",
        )
        .unwrap();
    for answer in &outcome.answers {
        let key = [&answer.code, &answer.page, &answer.question, &answer.key];
        let (rows, value): (u32, Option<i64>) =
            find.query_row(key, |row| Ok((row.get(0)?, row.get(1)?))).unwrap();
        assert_eq!((rows, value), (1, answer.value), "{answer:?}");
    }
    // no browser sent two answers to one question of a page
    let doubled = "SELECT count(*) FROM (SELECT 1 FROM answer GROUP BY participant, page, question HAVING count(*) > 1)";
    assert_eq!(connection.query_row(doubled, [], |row| row.get::<_, u32>(0)).unwrap(), 0);
}
