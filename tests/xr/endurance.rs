//! The service killed, hung and started again, over and over.

use super::service::{Live, Service, is_there};
use super::{folder, recorded};
use std::time::Duration;

/// Cycles of: the service hangs while the crowd does so many steps, goes on or not, is killed, is started again.
fn cycles(count: u32, hung: usize, name: &str) {
    let mut service = Service::start(name);
    let visit = folder(name).join("visit.csv");
    let kept = visit.to_str().unwrap();
    let run = ["xr", "crossing", "--agents", "40", "--eye-size", "160x160", "--record", kept, "--json"];
    let mut live = Live::start(service.gaitway(&run));
    live.hear("the headset shows the crowd");
    let (mut back, mut memory) = (Vec::new(), Vec::new());
    for cycle in 0..count {
        std::thread::sleep(Duration::from_millis(300));
        service.signal("STOP");
        live.hear("does not answer");
        // the crowd goes on while the service hangs
        recorded(&visit, hung, |_| true);
        if cycle % 2 == 0 {
            service.signal("CONT");
            live.hear("answers again");
        }
        service.kill();
        live.hear("the runtime stopped; looking for it again");
        service.restart();
        let since = live.hear("the headset is back after");
        back.push(since.as_secs_f32());
        std::thread::sleep(Duration::from_millis(300));
        memory.push(live.memory());
    }
    let (found, _) = live.end();
    println!("{count} times: back within {back:.2?} s; memory {memory:.1?} MiB");
    assert_eq!(found["sessions"], count + 1, "{found}");
    assert_eq!(found["ended"], "interrupted", "{found}");
    assert_eq!(super::states(&found).iter().filter(|state| **state == "focused").count(), count as usize + 1);
    super::walked_all_the_time(&found);
    // what libraries keep for good is there after a few sessions
    if let [_, _, _, first, .., last] = memory[..] {
        assert!(last <= 1.05 * first, "memory grew: {memory:.1?} MiB");
    }
}

#[test]
fn a_service_that_hangs_and_dies_costs_pictures_not_the_crowd() {
    if is_there() {
        cycles(3, 45, "cycles");
    }
}

/// Takes three minutes: `cargo test --test xr -- --ignored --nocapture`.
#[test]
#[ignore = "takes three minutes"]
fn twenty_deaths_of_the_service_leave_no_trace() {
    if is_there() {
        let seconds = std::env::var("GAITWAY_XR_HUNG").map_or(5, |text| text.parse().unwrap());
        cycles(20, 30 * seconds, "twenty");
    }
}
