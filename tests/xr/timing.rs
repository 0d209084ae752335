//! Each picture is drawn for the moment at which it will be seen.

use super::folder;
use super::service::{Live, Service, is_there, until};

#[test]
fn views_are_located_for_the_predicted_time_and_handed_over_as_they_were_located() {
    if !is_there() {
        return;
    }
    let service = Service::start("timing");
    let frames = folder("timing").join("frames.txt");
    let run = ["xr", "crossing", "--agents", "20", "--eye-size", "160x160", "--json"];
    let mut command = service.faulty("", &run);
    command.env("GAITWAY_FRAMES", &frames);
    let mut head = service.head();
    let live = Live::start(command);
    // the head turns on and on: views of another moment are other views
    let mut turn = 0.0_f32;
    let told = until(|| {
        turn += 1.0;
        head.set(turn % 60.0, 0.0, [0.01 * (turn % 60.0), 1.6, 0.0]);
        let told = std::fs::read_to_string(&frames).unwrap_or_default();
        let mut numbers =
            told.split(|c: char| !c.is_ascii_digit()).filter_map(|word| word.parse::<u32>().ok());
        match (numbers.next(), numbers.next()) {
            (Some(40..), Some(20..)) => Ok(told),
            _ => Err(told),
        }
    });
    live.end();
    assert!(told.ends_with("fault: none\n"), "{told}");
}
