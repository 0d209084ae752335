//! Broken files: whatever the text, an importer answers, and quickly.

use super::walker::{self, Walker};
use gaitway::gait::import::{Options, asf_amc, bvh, csv};
use gaitway::gait::{Recording, stride};
use std::time::{Duration, Instant};

/// A small generator (`SplitMix64`), our own.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, bound: usize) -> usize {
        usize::try_from(self.next() % bound.max(1) as u64).unwrap()
    }
}

const NASTY: [&str; 22] = [
    "NaN",
    "inf",
    "-inf",
    "1e38",
    "-1e38",
    "1e-45",
    "4000000000",
    "18446744073709551616",
    "-1",
    "0",
    "",
    "{",
    "}",
    "MOTION",
    "begin",
    "end",
    ":hierarchy",
    "root",
    "JOINT x {",
    ",,,",
    "\u{0}",
    "\u{1F600}",
];

/// One to four random faults in a text.
fn mutate(text: &str, random: &mut Random) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len());
        let end = (at + 1 + random.below(60)).min(bytes.len());
        match random.below(7) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let part = bytes[at..end].to_vec();
                bytes.splice(at..at, part);
            }
            3 if at < bytes.len() => bytes[at] = b" \n\t,.-:{}#0aE\xFF"[random.below(14)],
            4 | 5 => {
                // A whole word becomes a nasty one.
                let word = |b: &u8| !b.is_ascii_whitespace() && *b != b',';
                let from = bytes[..at].iter().rposition(|b| !word(b)).map_or(0, |i| i + 1);
                let to = bytes[at..].iter().position(|b| !word(b)).map_or(bytes.len(), |i| at + i);
                bytes.splice(from..to, NASTY[random.below(NASTY.len())].bytes());
            }
            _ => {
                let mut lines: Vec<&[u8]> = bytes.split(|&b| b == b'\n').collect();
                let (a, b) = (random.below(lines.len()), random.below(lines.len()));
                lines.swap(a, b);
                bytes = lines.join(&b'\n');
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Calls `parse` on many broken versions of a text; counts the ones that were still read.
fn shake(name: &str, seed: u64, text: &str, parse: impl Fn(&str) -> Option<Vec<Recording>>) {
    assert!(parse(text).is_some(), "{name}: the text itself must be read");
    let (mut random, mut read, begin) = (Random(seed), 0, Instant::now());
    for round in 0..1500 {
        let broken = mutate(text, &mut random);
        let start = Instant::now();
        if let Some(takes) = parse(&broken) {
            read += 1;
            for take in &takes {
                assert!(
                    take.poses.iter().flatten().all(|p| p.is_finite()),
                    "{name}: seed {seed} round {round}"
                );
                // Ok or Err: only that it answers.
                let _ = stride::extract(take);
            }
        }
        assert!(start.elapsed() < Duration::from_secs(2), "{name}: seed {seed} round {round} hangs");
    }
    println!("{name}: {read} of 1500 broken texts were still read, {:.2} s", begin.elapsed().as_secs_f32());
}

#[test]
fn broken_files_are_answered_quickly() {
    let take = Walker::default().take(2.2, 15.0);
    let options = Options::default();
    shake("bvh", 1, &walker::bvh(&take, 100.0), |text| {
        bvh::parse_bvh(text, "x", &options).ok().map(|t| vec![t])
    });
    shake("csv", 2, &walker::csv(&[&take, &Recording { name: "b".into(), ..take.clone() }], 1.0), |text| {
        csv::parse_csv(text, "x", &options).ok()
    });
    let (asf, amc) = (walker::asf(), walker::amc(20, |frame| frame as f32));
    let skeleton = asf_amc::parse_asf(&asf, "x").unwrap();
    shake("amc", 3, &amc, |text| asf_amc::parse_amc(text, "x", &skeleton, &options).ok().map(|t| vec![t]));
    shake("asf", 4, &asf, |text| {
        let skeleton = asf_amc::parse_asf(text, "x").ok()?;
        Some(asf_amc::parse_amc(&amc, "x", &skeleton, &options).into_iter().collect())
    });
}
