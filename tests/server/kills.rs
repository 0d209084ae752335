//! `kill -9` of the server under 64 browsers: no acknowledged answer is missing or doubled.

use super::{check, rehearsal};
use crate::common::lab::Lab;
use gaitway::study::rehearse::{Rehearsal, rehearse};
use std::time::Duration;

/// Kills the server so many times while 64 browsers answer; returns the number of acknowledged answers.
fn survive(kills: u32, pause: Duration) -> usize {
    let lab = Lab::new();
    let plan = Rehearsal { participants: 1_000_000, pause, leaving: 0.002, ..rehearsal(&lab) };
    let mut server = lab.serve();
    let outcome = std::thread::scope(|scope| {
        let browsers =
            scope.spawn(|| rehearse(&Rehearsal { participants: 64 + kills, ..plan.clone() }).unwrap());
        for number in 0..u64::from(kills) {
            std::thread::sleep(Duration::from_millis(100 + number * 137 % 400));
            server.kill();
            server = lab.serve(); // the same port and data
        }
        browsers.join().unwrap()
    });
    assert!(outcome.lost.is_empty(), "{:?}", outcome.lost);
    assert!(outcome.repeated > 0, "no request met a server that was down");
    check(&lab.data(), &outcome);
    outcome.answers.len()
}

#[test]
fn no_acknowledged_answer_is_missing_or_doubled_after_kills() {
    let answers = survive(4, Duration::from_millis(60));
    assert!(answers > 1_000, "{answers}");
}

#[test]
#[ignore = "two hundred kills, minutes"]
fn no_acknowledged_answer_is_missing_or_doubled_after_two_hundred_kills() {
    println!("{} acknowledged answers", survive(200, Duration::from_secs(3)));
}
