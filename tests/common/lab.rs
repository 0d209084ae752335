//! A study that the real program serves: a folder for it, one for its data, and the process of the server.
#![allow(clippy::unwrap_used, clippy::panic, reason = "for tests: a failure is a panic")]

use std::io::{BufRead as _, BufReader};
use std::path::PathBuf;
use std::process::{Child, ChildStdout, Command, Stdio};
use tempfile::TempDir;

const PROGRAM: &str = env!("CARGO_BIN_EXE_gaitway");

/// A folder with a study that is ready for people, and one for its data.
#[derive(Debug)]
pub(crate) struct Lab {
    folder: TempDir,
    /// The built-in study.
    name: &'static str,
    /// The port at which participants come.
    port: u16,
}

impl Lab {
    /// The built-in study of gaits, whose library is the built-in one.
    pub(crate) fn new() -> Self {
        Self::with(&[], &[])
    }

    /// The same with more arguments of `study new`, and with changes to its file.
    pub(crate) fn with(arguments: &[&str], changes: &[(&str, &str)]) -> Self {
        Self::of("eva-gaits", arguments, changes)
    }

    /// A built-in study, with what the lab has to fill in.
    pub(crate) fn of(name: &'static str, arguments: &[&str], changes: &[(&str, &str)]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let study = folder.path().join("study");
        let mut new = Command::new(PROGRAM);
        let made = new.args(["study", "new", name, "--out"]).arg(&study).args(arguments).output().unwrap();
        assert!(made.status.success(), "{made:?}");
        for entry in std::fs::read_dir(&study).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|end| end != "toml" && end != "md") {
                continue;
            }
            let mut text = std::fs::read_to_string(&path).unwrap().replace("TO FILL IN", "Laboratory");
            for (old, new) in changes.iter().filter(|_| path.ends_with("study.toml")) {
                assert!(text.contains(old), "{old}");
                text = text.replace(old, new);
            }
            std::fs::write(&path, text).unwrap();
        }
        let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        Self { folder, name, port }
    }

    pub(crate) fn study(&self) -> PathBuf {
        self.folder.path().join("study")
    }

    pub(crate) fn data(&self) -> PathBuf {
        self.folder.path().join("data")
    }

    /// Where participants come.
    pub(crate) fn address(&self) -> String {
        format!("{}/s/{}", self.host(), self.name)
    }

    pub(crate) fn host(&self) -> String {
        format!("http://127.0.0.1:{}", self.port)
    }

    fn command(&self) -> Command {
        let mut command = Command::new(PROGRAM);
        command
            .args(["study", "serve", "--requests-per-minute", "0", "--console", "127.0.0.1:0", "--listen"])
            .arg(format!("127.0.0.1:{}", self.port))
            .arg("--data")
            .arg(self.data())
            .arg(self.study());
        command
    }

    /// What a server says that does not start.
    #[allow(dead_code, reason = "shared; not every test needs it")]
    pub(crate) fn refusal(&self) -> String {
        let ended = self.command().output().unwrap();
        assert!(!ended.status.success(), "it has started and ended");
        String::from_utf8(ended.stderr).unwrap()
    }

    /// Starts the server; returns when it takes requests.
    pub(crate) fn serve(&self) -> Server {
        let mut child = self.command().stdout(Stdio::piped()).stderr(Stdio::inherit()).spawn().unwrap();
        let says = BufReader::new(child.stdout.take().unwrap());
        let mut server = Server { child, says };
        let line = server.hear("participants");
        assert!(line.contains(&self.address()), "{line}");
        server
    }
}

/// A server that is killed when it is dropped.
#[derive(Debug)]
pub(crate) struct Server {
    child: Child,
    says: BufReader<ChildStdout>,
}

impl Server {
    /// `kill -9`.
    pub(crate) fn kill(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    /// The link by which the first operator chooses a password.
    pub(crate) fn first_link(&mut self) -> String {
        let line = self.hear("password");
        line.split_whitespace().next_back().unwrap().to_owned()
    }

    /// The next line that begins so.
    fn hear(&mut self, word: &str) -> String {
        loop {
            let mut line = String::new();
            assert!(self.says.read_line(&mut line).unwrap() > 0, "the server ended without a line on {word}");
            if line.starts_with(word) {
                return line;
            }
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _gone = self.child.kill();
        let _ended = self.child.wait();
    }
}
