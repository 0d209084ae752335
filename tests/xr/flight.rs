//! The frame does not wait: it is handed over while the device draws it, and nothing is compiled in the session.

use super::folder;
use super::service::{Live, Service, is_there, until};

/// The numbers of a file that the layer writes.
fn numbers(told: &str) -> Vec<u32> {
    told.split(|c: char| !c.is_ascii_digit()).filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn a_picture_is_handed_over_while_the_device_draws_it() {
    if !is_there() {
        return;
    }
    let service = Service::start("flight");
    let file = folder("flight").join("handed-over.txt");
    let run = ["xr", "crossing", "--agents", "200", "--eye-size", "960x960", "--json"];
    let mut command = service.faulty("", &run);
    command.env("GAITWAY_HANDED_OVER", &file);
    let live = Live::start(command);
    let [early, late] = until(|| {
        let told = std::fs::read_to_string(&file).unwrap_or_default();
        match numbers(&told)[..] {
            [early, late] if early + late >= 15 => Ok([early, late]),
            _ => Err(told),
        }
    });
    let (found, _) = live.end();
    // the host may be kept from its processor for as long as a picture takes
    assert!(early > 3 * late, "{early} while they were drawn, {late} after");
    let half = |share: &str| found["frames"][share]["p50"].as_f64().unwrap();
    assert!(half("device_ms") > 1.0 && half("work_ms") > half("device_ms"), "{found}");
}

#[test]
fn nothing_is_compiled_in_the_session_and_the_runtime_is_not_blamed_for_it() {
    if !is_there() {
        return;
    }
    let service = Service::start("cold");
    let cache = folder("cold");
    let run = ["xr", "crossing", "--agents", "40", "--eye-size", "160x160", "--json"];
    let mut command = service.gaitway(&run);
    command.env("MESA_SHADER_CACHE_DIR", &cache);
    let mut live = Live::start(command);
    live.hear("the headset shows the crowd");
    std::thread::sleep(std::time::Duration::from_secs(2));
    let (found, notes) = live.end();
    assert!(found["frames"]["drawn"].as_u64().unwrap() > 3, "{found}");
    assert!(!notes.iter().any(|line| line.contains("does not answer")), "{notes:#?}");
    // a cold cache: the first picture takes seconds
    let longest = found["frames"]["work_ms"]["p99"].as_f64().unwrap();
    let half = found["frames"]["work_ms"]["p50"].as_f64().unwrap();
    println!("drawing: half {half:.1} ms, longest {longest:.1} ms; {notes:#?}");
    assert!(longest < 20.0 * half, "{longest} ms, half {half} ms");
}

#[test]
fn a_device_that_is_too_slow_draws_fewer_pixels_where_nobody_has_chosen_how_many() {
    if !is_there() {
        return;
    }
    let service = Service::start("pixels");
    let file = folder("pixels").join("frames.txt");
    let columns = |run: &[&str], few: u32| {
        let mut command = service.faulty("", run);
        command.env("GAITWAY_FRAMES", &file).env("OXR_VIEWPORT_SCALE_PERCENTAGE", "200");
        let live = Live::start(command);
        let told = until(|| {
            let told = std::fs::read_to_string(&file).unwrap_or_default();
            match numbers(&told)[..] {
                [pictures, _, columns, ..] if pictures > 40 && columns <= few => Ok(told),
                _ => Err(told),
            }
        });
        let (found, _) = live.end();
        let _ = std::fs::remove_file(&file);
        assert!(told.ends_with("fault: none\n"), "{told}");
        (numbers(&told)[2], found)
    };
    // Monado recommends 320x240 an eye, and twice of it as told
    let crowd = ["xr", "crossing", "--agents", "3000", "--json"];
    let (drawn, found) = columns(&crowd, 639);
    let least = found["least_resolution"].as_f64().unwrap();
    assert!(drawn < 640 && (0.6..1.0).contains(&least), "{drawn} columns, {found}");
    let chosen = ["xr", "crossing", "--agents", "3000", "--json", "--eye-size", "640x480"];
    let (drawn, found) = columns(&chosen, 640);
    assert_eq!((drawn, found["least_resolution"].as_f64()), (640, Some(1.0)), "{found}");
    assert!(found["least_quality"].as_f64().unwrap() < 0.6, "{found}");
}
