//! The mirror: a window with what the user sees. Closing it ends nothing else.

use super::presented::screen;
use super::service::{Live, Service, is_there};
use super::{POST, after, folder, shows};
use std::process::Command;

const EYE: u32 = 480;
/// Side of the mirror's window.
const WINDOW: u32 = 720;

#[test]
fn the_mirror_shows_the_left_eye_and_its_end_does_not_end_the_session() {
    if !is_there() {
        return;
    }
    let folder = folder("mirror");
    let Some(screen) = screen(&folder) else { return };
    let service = Service::start("mirror");
    let file = folder.join("post.toml");
    std::fs::write(&file, POST).unwrap();
    let (scene, shots) = (file.to_str().unwrap(), folder.to_str().unwrap());
    let size = format!("{EYE}x{EYE}");
    let run = ["xr", scene, "--eye-size", &size, "--shots", shots, "--every", "10", "--mirror", "--json"];
    service.head().set(8.0, 0.0, [0.0, 1.6, 0.0]);
    let mut command = service.gaitway(&run);
    command.env("DISPLAY", &screen.display).env_remove("WAYLAND_DISPLAY");
    let mut live = Live::start(command);
    live.hear("the headset shows the crowd");
    // the window is half as large again; edges of one pixel may differ
    let (_, (shown, off)) = shows(&folder, |eyes| {
        let shown = screen.shows([WINDOW, WINDOW]);
        let off = (0..EYE * EYE).filter(|i| {
            let (x, y) = (i % EYE, i / EYE);
            let (a, b) = (eyes.pixel(x, y).unwrap(), shown.pixel(x * 3 / 2, y * 3 / 2).unwrap());
            (0..3).any(|c| a[c].abs_diff(b[c]) > 8)
        });
        let off = off.count() as f32 / (EYE * EYE) as f32;
        if off < 0.01 { Ok((shown, off)) } else { Err(format!("{off} of the pixels differ")) }
    });
    gaitway::export::image::write_png(&folder.join("mirror-window.png"), &shown).unwrap();
    println!("{off:.4} of the pixels differ");

    // the display goes away, with all its windows
    let server = screen.server_id();
    assert!(Command::new("kill").args(["-KILL", &server.to_string()]).status().unwrap().success());
    live.hear("mirror");
    // the user is still shown the crowd
    after(&folder, 2);
    let (found, notes) = live.end();
    println!("{} pictures mirrored; {notes:?}", found["mirrored"]);
    assert!(found["mirrored"].as_u64().unwrap() > 0, "{found}");
    assert_eq!(
        (found["sessions"].as_u64(), found["ended"].as_str()),
        (Some(1), Some("interrupted")),
        "{found}"
    );
}

#[test]
fn without_a_display_there_is_no_mirror_but_a_session() {
    if !is_there() {
        return;
    }
    let service = Service::start("nomirror");
    let run = ["xr", "crossing", "--agents", "40", "--eye-size", "160x160", "--mirror", "--json"];
    let mut command = service.gaitway(&run);
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
    let mut live = Live::start(command);
    live.hear("no mirror: no window can be opened");
    live.hear("the headset shows the crowd");
    let (found, _) = live.end();
    assert_eq!((found["sessions"].as_u64(), found["mirrored"].as_u64()), (Some(1), Some(0)), "{found}");
}
