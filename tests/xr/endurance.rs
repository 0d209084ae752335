//! The service killed, hung and started again, over and over.

use super::service::{Live, Service, is_there};
use std::time::{Duration, Instant};

/// Longest wait for anything, on a machine with other work to do.
const PATIENCE: Duration = Duration::from_secs(30);

/// Cycles of: the service hangs for `hung`, goes on or not, is killed, is started again. `within`: the headset must be
/// back within so long of its service.
fn cycles(count: u32, hung: Duration, within: Duration, name: &str, port: u16) {
    let mut service = Service::start(name, port);
    let run = ["xr", "crossing", "--agents", "40", "--eye-size", "160x160", "--json"];
    let begin = Instant::now();
    let mut live = Live::start(service.gaitway(&run));
    live.hear("the headset shows the crowd", PATIENCE);
    let (mut back, mut memory) = (Vec::new(), Vec::new());
    for cycle in 0..count {
        std::thread::sleep(Duration::from_millis(300));
        service.signal("STOP");
        std::thread::sleep(hung);
        live.hear("does not answer", PATIENCE);
        if cycle % 2 == 0 {
            service.signal("CONT");
            live.hear("answers again", PATIENCE);
        }
        service.kill();
        live.hear("the runtime stopped; looking for it again", PATIENCE);
        service.restart();
        let since = live.hear("the headset is back after", PATIENCE);
        back.push(since.as_secs_f32());
        std::thread::sleep(Duration::from_millis(300));
        memory.push(live.memory());
    }
    let seconds = begin.elapsed().as_secs_f64();
    let (found, _) = live.end();
    println!("{count} times: back within {back:.2?} s; memory {memory:.1?} MiB");
    println!("{} steps in {seconds:.1} s, {} s lost", found["steps"], found["time_lost"]);
    assert_eq!(found["sessions"], count + 1, "{found}");
    assert_eq!(found["ended"], "interrupted", "{found}");
    assert_eq!(super::states(&found).iter().filter(|state| **state == "focused").count(), count as usize + 1);
    // the crowd went on while the service hung: what it lost is the machine's doing
    let lost = found["time_lost"].as_f64().unwrap();
    assert!(lost < 0.1 * hung.as_secs_f64() * f64::from(count), "{found}");
    let worst = back.iter().copied().fold(0.0, f32::max);
    assert!(worst <= within.as_secs_f32(), "back within {worst} s");
    // what libraries keep for good is there after a few sessions
    if let [_, _, _, first, .., last] = memory[..] {
        assert!(last <= 1.05 * first, "memory grew: {memory:.1?} MiB");
    }
}

#[test]
fn a_service_that_hangs_and_dies_costs_pictures_not_the_crowd() {
    if is_there() {
        cycles(3, Duration::from_millis(2300), Duration::from_secs(10), "cycles", 4269);
    }
}

/// Takes three minutes: `cargo test --test xr -- --ignored --nocapture`.
#[test]
#[ignore = "takes three minutes"]
fn twenty_deaths_of_the_service_leave_no_trace() {
    if is_there() {
        let seconds = std::env::var("GAITWAY_XR_HUNG").map_or(5.0, |text| text.parse().unwrap());
        cycles(20, Duration::from_secs_f64(seconds), Duration::from_secs(2), "twenty", 4270);
    }
}
