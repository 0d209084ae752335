//! Many browsers at once.

use super::{check, rehearsal};
use crate::common::lab::Lab;
use gaitway::study::rehearse::{Rehearsal, rehearse};
use gaitway::study::store::Reading;

#[test]
fn many_browsers_at_once_of_which_some_leave_are_all_answered() {
    let lab = Lab::new();
    let server = lab.serve();
    let rehearsal = Rehearsal { participants: 120, at_once: 40, leaving: 0.03, ..rehearsal(&lab) };
    let outcome = rehearse(&rehearsal).unwrap();
    assert!(outcome.lost.is_empty(), "{:?}", outcome.lost);
    assert!(outcome.left > 0 && outcome.finished > 0, "{outcome:?}");
    check(&lab.data(), &outcome);
    // beside the server, which goes on
    let overview = Reading::open(&lab.data()).unwrap().overview().unwrap();
    let (fewest, most) = overview.answered["walks"];
    assert!(most > 0, "{overview:?}");
    println!(
        "{:.0} answers a second, p99 {:.1} ms, {fewest} to {most} answers a walk",
        outcome.rate(),
        outcome.latency(0.99)
    );
    drop(server);
}
