//! The program as a server: `gaitway study serve` under many browsers, killed, and started again.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test")]

mod kills;
mod load;

use gaitway::study::rehearse::{Outcome, Rehearsal};
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

const PROGRAM: &str = env!("CARGO_BIN_EXE_gaitway");

/// A folder with a study that is ready for people, and one for its data.
struct Lab {
    folder: tempfile::TempDir,
    /// The port at which participants come.
    port: u16,
}

impl Lab {
    /// The built-in study of gaits, whose library is the built-in one.
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let study = folder.path().join("study");
        let made =
            Command::new(PROGRAM).args(["study", "new", "eva-gaits", "--out"]).arg(&study).output().unwrap();
        assert!(made.status.success(), "{made:?}");
        // what the lab has to fill in
        for name in ["study.toml", "consent.en.md"] {
            let path = study.join(name);
            let text = std::fs::read_to_string(&path).unwrap();
            std::fs::write(&path, text.replace("TO FILL IN", "Laboratory")).unwrap();
        }
        let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        Self { folder, port }
    }

    fn study(&self) -> PathBuf {
        self.folder.path().join("study")
    }

    fn data(&self) -> PathBuf {
        self.folder.path().join("data")
    }

    fn address(&self) -> String {
        format!("http://127.0.0.1:{}/s/eva-gaits", self.port)
    }

    /// Starts the server; returns when it takes requests.
    fn serve(&self) -> Server {
        let mut child = Command::new(PROGRAM)
            .args(["study", "serve", "--requests-per-minute", "0", "--console", "127.0.0.1:0", "--listen"])
            .arg(format!("127.0.0.1:{}", self.port))
            .arg("--data")
            .arg(self.data())
            .arg(self.study())
            .stdout(Stdio::piped())
            .stderr(Stdio::inherit())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let mut lines = BufReader::new(child.stdout.take().unwrap());
        lines.read_line(&mut line).unwrap();
        assert!(line.contains(&self.address()), "{line}");
        Server { child, _lines: lines }
    }

    fn rehearsal(&self) -> Rehearsal {
        Rehearsal {
            address: self.address(),
            participants: 100,
            at_once: 64,
            leaving: 0.0,
            pause: Duration::ZERO,
            patience: Duration::from_secs(120),
            seed: 1,
        }
    }
}

/// A server that is killed when it is dropped.
struct Server {
    child: Child,
    _lines: BufReader<std::process::ChildStdout>,
}

impl Server {
    /// `kill -9`.
    fn kill(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _gone = self.child.kill();
        let _ended = self.child.wait();
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
