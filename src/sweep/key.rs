//! The name of a run, from all that it depends on.
//!
//! Keys have 128 bits (XXH3). Of a million different runs two have the same key with a chance of 1.5e-27: n² / 2^129. Keys
//! do not stand up to an adversary who wants two runs to have the same one.

use super::plan::Header;
use std::fmt;
use twox_hash::XxHash3_128;

/// The key of a run: 32 hexadecimal digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key(u128);

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

impl Key {
    /// The key that a text names; none if it names none.
    pub fn parse(text: &str) -> Option<Self> {
        let is_key = text.len() == 32 && text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'));
        u128::from_str_radix(text, 16).ok().filter(|_| is_key).map(Self)
    }
}

/// Texts of which none runs into the next.
#[derive(Debug, Clone, Default)]
struct Parts(Vec<u8>);

impl Parts {
    fn add(&mut self, text: &str) {
        self.0.extend((text.len() as u64).to_le_bytes());
        self.0.extend(text.as_bytes());
    }

    fn hash(&self) -> u128 {
        XxHash3_128::oneshot(&self.0)
    }
}

/// Hash of the content of a file.
pub fn of_file(bytes: &[u8]) -> Key {
    Key(XxHash3_128::oneshot(bytes))
}

/// What the keys of a plan's runs have in common.
#[derive(Debug, Clone)]
pub struct Keys(Parts);

impl Keys {
    /// Takes over what all runs of a plan share.
    pub fn of(header: &Header) -> Self {
        let mut parts = Parts::default();
        parts.add(&header.version);
        parts.add(&header.text);
        for file in &header.files {
            parts.add(&file.name);
            parts.add(&file.hash);
        }
        // whatever is written belongs to the run: a folder holds what its key says
        parts.add(&format!("{} {} {}", header.seconds, header.fps, header.until_empty));
        parts.add(&format!("{} {}", header.agents, header.trajectories));
        let mut shared = Parts::default();
        shared.add(&format!("{:032x}", parts.hash()));
        Self(shared)
    }

    /// The key of the run with these settings, in any order, and this seed.
    pub fn key<'a>(&self, settings: impl Iterator<Item = &'a str>, seed: u64) -> Key {
        let mut parts = self.0.clone();
        let mut settings: Vec<&str> = settings.collect();
        settings.sort_unstable();
        settings.into_iter().for_each(|setting| parts.add(setting));
        parts.add(&format!("seed {seed}"));
        Key(parts.hash())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header() -> Header {
        serde_json::from_str(
            r#"{"gaitway_plan": 1, "version": "1", "scenario": "s", "text": "t", "folder": null, "files": [], "seconds": 1.0,
            "fps": 10.0, "until_empty": false, "agents": true, "trajectories": false, "set": [], "vary": [], "runs": 1}"#,
        )
        .unwrap()
    }

    #[test]
    fn whatever_a_run_depends_on_changes_its_key_and_nothing_else_does() {
        let key =
            |header: &Header, settings: &[&str], seed| Keys::of(header).key(settings.iter().copied(), seed);
        let plain = key(&header(), &["a=1", "b=2"], 7);
        assert_eq!(key(&header(), &["b=2", "a=1"], 7), plain);
        let named = Header { scenario: "another name".to_owned(), runs: 9, ..header() };
        assert_eq!(key(&named, &["a=1", "b=2"], 7), plain);
        let changed = [
            key(&header(), &["a=1", "b=2"], 8),
            key(&header(), &["a=1", "b=3"], 7),
            key(&header(), &["a=1b=2"], 7),
            key(&header(), &["a=1"], 7),
            key(&Header { version: "2".to_owned(), ..header() }, &["a=1", "b=2"], 7),
            key(&Header { text: "u".to_owned(), ..header() }, &["a=1", "b=2"], 7),
            key(&Header { seconds: 2.0, ..header() }, &["a=1", "b=2"], 7),
            key(&Header { fps: 15.0, ..header() }, &["a=1", "b=2"], 7),
            key(&Header { until_empty: true, ..header() }, &["a=1", "b=2"], 7),
            key(&Header { agents: false, ..header() }, &["a=1", "b=2"], 7),
            key(&Header { trajectories: true, ..header() }, &["a=1", "b=2"], 7),
        ];
        for (number, one) in changed.iter().enumerate() {
            assert!(*one != plain && !changed[..number].contains(one), "{number}");
        }
        assert_eq!(Key::parse(&plain.to_string()), Some(plain));
        assert_eq!(Key::parse("+0123456789abcdef0123456789abcde"), None);
    }
}
