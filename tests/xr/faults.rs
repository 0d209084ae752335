//! Faults that a layer plants between the program and the runtime: each ends in a new session, or in good order with its
//! reason in one line.

use super::service::{Live, Service, is_there};

const RUN: [&str; 7] = ["xr", "crossing", "--agents", "40", "--eye-size", "160x160", "--json"];

/// A run with a fault from which it must recover: the session is lost for that reason, and another one is begun.
fn recovers(service: &Service, fault: &str, reason: &str) {
    let mut live = Live::start(service.faulty(fault, &RUN));
    live.hear(reason);
    live.hear("the headset is back after");
    let (found, notes) = live.end();
    assert_eq!(found["sessions"], 2, "{fault}: {found}\n{notes:#?}");
    let told = notes.iter().filter(|line| line.contains("looking for it again"));
    assert!(
        told.clone().count() == 1 && told.clone().all(|line| line.contains(reason)),
        "{fault}: {notes:#?}"
    );
    assert_eq!(found["losses"].as_array().map(Vec::len), Some(1), "{fault}: {found}");
    assert_eq!(super::states(&found).last(), Some(&"exiting"), "{fault}: {found}");
    assert_eq!(found["ended"], "interrupted", "{fault}: {found}");
    // the crowd went on all the time, in the outage too: no slower than a fourth of what it did in the whole
    super::walked_all_the_time(&found);
    let outage = &found["losses"][0];
    let number = |of: &serde_json::Value, key: &str| of[key].as_f64().unwrap();
    let (gone, seconds) = (number(outage, "seconds"), number(&found, "seconds"));
    assert!(outage["reason"].as_str().unwrap().contains(reason), "{fault}: {found}");
    assert!(gone > 0.0 && gone < seconds, "{fault}: {found}");
    let rate = number(&found, "steps") / seconds;
    assert!(number(outage, "steps") >= (0.25 * rate * gone).floor().max(1.0), "{fault}: {found}");
}

#[test]
fn a_lost_session_restarts() {
    if !is_there() {
        return;
    }
    let service = Service::start("loss");
    recovers(&service, "loss-pending@12", "the runtime ended the session");
    recovers(&service, "session-lost-at-wait@6", "the runtime ended the session");
    recovers(&service, "loss-pending-at-end@6", "the runtime ended the session");
    recovers(&service, "session-lost-at-locate@5", "the runtime ended the session");
}

#[test]
fn a_runtime_that_goes_away_or_fails_is_found_again() {
    if !is_there() {
        return;
    }
    let service = Service::start("gone");
    recovers(&service, "instance-loss-pending@12", "the runtime stopped");
    recovers(&service, "instance-lost-at-end@6", "the runtime stopped");
    recovers(&service, "image-timeout@5", "kept an image for too long");
    recovers(&service, "begin-fails@6", "xrBeginFrame failed");
}

#[test]
fn the_runtime_may_end_the_session() {
    if !is_there() {
        return;
    }
    let service = Service::start("exit");
    let (found, _) = Live::start(service.faulty("exit@5", &RUN)).wait();
    assert_eq!(found["ended"], "the OpenXR runtime ended the session", "{found}");
    assert_eq!(found["sessions"], 1);
}

#[test]
fn what_fails_again_and_again_is_given_up_with_its_reason() {
    if !is_there() {
        return;
    }
    let service = Service::start("again");
    let run = ["xr", "crossing", "--agents", "40", "--eye-size", "160x160"];
    let failed = service.faulty("begin-fails@10+", &run).output().unwrap();
    let text = String::from_utf8_lossy(&failed.stderr);
    assert_eq!(failed.status.code(), Some(1), "{text}");
    let errors: Vec<&str> = text.lines().filter(|line| line.starts_with("error:")).collect();
    assert!(errors.len() == 1 && errors[0].contains("xrBeginFrame failed"), "{text}");
}
