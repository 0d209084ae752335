//! The user's hands: seen as controllers, they point to a place and go there, walk, and come back to the start.

use super::service::{Head, Live, Service, Stick, is_there};
use super::{after, folder, recorded, shows, steps};
use gaitway::picture::Image;
use std::path::Path;

const SIZE: u32 = 400;

/// An empty square without agents.
const EMPTY: &str = r#"
name = "empty"
condition = "eva-o"
bounds = [[-30.0, -30.0], [30.0, -30.0], [30.0, 30.0], [-30.0, 30.0]]
[population]
agents = 0
[user]
position = [2.0, 1.0]
heading_deg = 180.0
"#;

/// The newest picture as soon as it is as it should be; never one that was begun before.
fn look(folder: &Path, what: &str, is_it: impl Fn(&Image) -> bool) -> Image {
    after(folder, 3);
    shows(folder, |image| if is_it(image) { Ok(()) } else { Err(what.to_owned()) }).0
}

/// The newest picture after some more.
fn any(folder: &Path) -> Image {
    after(folder, 3)
}

/// Mean light of a part of the left eye's picture, whose corners are shares of its side.
fn light(image: &Image, [left, top, right, bottom]: [f32; 4]) -> f32 {
    let at = |share: f32| (share * SIZE as f32) as u32;
    let pixels = (at(top)..at(bottom)).flat_map(|y| (at(left)..at(right)).map(move |x| (x, y)));
    let lights: Vec<f32> =
        pixels.map(|(x, y)| image.pixel(x, y).unwrap()[..3].iter().map(|c| f32::from(*c)).sum()).collect();
    lights.iter().sum::<f32>() / lights.len() as f32
}

/// How many pixels of the left eye's lower half are blue beyond anything in the scene.
fn blue(image: &Image) -> usize {
    let pixels = (SIZE / 2..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y)));
    pixels.filter(|(x, y)| image.pixel(*x, *y).is_some_and(|p| p[2] > 150 && p[0] < 110)).count()
}

fn hold(head: &mut Head, pitch_deg: f32, right: Stick, left: Stick) {
    head.set_hand(0, [-0.25, 1.25, -0.45], 0.0, left);
    head.set_hand(1, [0.25, 1.25, -0.45], pitch_deg, right);
    head.set(0.0, 0.0, [0.0, 1.6, 0.0]);
}

/// The user's places, step by step.
fn places(file: &Path) -> Vec<[f32; 2]> {
    steps(file).iter().map(|step| [step[1].parse().unwrap(), step[2].parse().unwrap()]).collect()
}

#[test]
fn controllers_are_seen_point_walk_and_recentre() {
    if !is_there() {
        return;
    }
    let service = Service::start("hands");
    let folder = folder("hands");
    let (file, record) = (folder.join("empty.toml"), folder.join("visit.csv"));
    std::fs::write(&file, EMPTY).unwrap();
    let (scene, shots, kept) = (file.to_str().unwrap(), folder.to_str().unwrap(), record.to_str().unwrap());
    let size = format!("{SIZE}x{SIZE}");
    let run = [
        "xr",
        scene,
        "--eye-size",
        &size,
        "--shots",
        shots,
        "--every",
        "4",
        "--record",
        kept,
        "--vignette",
        "1",
        "--json",
    ];
    let mut head = service.head();
    head.set(0.0, 0.0, [0.0, 1.6, 0.0]);
    let mut live = Live::start(service.gaitway(&run));
    live.hear("the headset shows the crowd");
    let rest = Stick::default();
    let bare = any(&folder);
    hold(&mut head, 0.0, rest, rest);
    // half a metre away, a hand's breadth below the eyes' height: where the controllers are the picture is dark
    let parts = [[0.15, 0.8, 0.4, 1.0], [0.6, 0.8, 0.95, 1.0]];
    let is_dark = |image: &Image| parts.iter().all(|part| light(image, *part) < light(&bare, *part) - 8.0);
    let held = look(&folder, "no controllers", is_dark);

    // pointing down at 35 degrees from 1.25 m: the place is a metre and three quarters away
    hold(&mut head, -35.0, Stick { a: true, ..rest }, rest);
    let aimed = look(&folder, "no ring on the floor", |image| blue(image) > 60);
    println!("{} blue pixels, {} before", blue(&aimed), blue(&held));
    assert_eq!(blue(&held), 0);
    hold(&mut head, -35.0, rest, rest);
    let there = look(&folder, "the ring stays", |image| blue(image) == 0);

    // walking: the edge is dark
    let start = places(&record).len();
    hold(&mut head, 0.0, rest, Stick { stick: [0.0, 1.0], ..rest });
    let (edge, middle) = ([0.0, 0.4, 0.06, 0.6], [0.4, 0.4, 0.6, 0.6]);
    let walks = look(&folder, "the edge is not dark", |image| light(image, edge) < 0.3 * light(&there, edge));
    println!("edge {:.0} standing, {:.0} walking", light(&there, edge), light(&walks, edge));
    assert!(light(&walks, middle) > 0.9 * light(&there, middle));
    let ahead = places(&record)[start - 1][1] - 0.8;
    recorded(&record, 1, |step| step[2].parse::<f32>().unwrap() < ahead);

    hold(&mut head, 0.0, rest, Stick { click: true, ..rest });
    any(&folder);
    hold(&mut head, 0.0, rest, rest);
    let is_light = |image: &Image| (light(image, edge) - light(&there, edge)).abs() < 12.0;
    look(&folder, "the edge stays dark", is_light);
    live.end();

    // x to the right as the user faces, z back: the room is not turned
    let way = places(&record);
    let jumps: Vec<[f32; 2]> = way
        .windows(2)
        .map(|pair| [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]])
        .filter(|jump| jump[0].hypot(jump[1]) > 1.0)
        .collect();
    println!("jumps {jumps:.2?}, from {:?} to {:?}", way[0], way[way.len() - 1]);
    assert_eq!(jumps.len(), 2, "a teleport and a recentring: {jumps:?}");
    assert!(jumps[0][1] < -1.2 && jumps[0][1] > -3.5 && jumps[0][0].abs() < 0.6, "{jumps:?}");
    let last = way[way.len() - 1];
    assert!((last[0] - 2.0).abs() < 0.05 && (last[1] - 1.0).abs() < 0.05, "back at the start: {last:?}");
}

/// How many pixels of a part of the left eye's picture have the colour of hands, which nothing else here has.
fn skin(image: &Image, [left, top, right, bottom]: [f32; 4]) -> usize {
    let at = |share: f32| (share * SIZE as f32) as u32;
    let pixels = (at(top)..at(bottom)).flat_map(|y| (at(left)..at(right)).map(move |x| (x, y)));
    let is_skin = |p: [u8; 4]| p[0] > p[1].saturating_add(15) && p[1] > p[2].saturating_add(5);
    pixels.filter(|(x, y)| image.pixel(*x, *y).is_some_and(is_skin)).count()
}

#[test]
fn hands_without_controllers_are_seen_and_recorded() {
    if !is_there() {
        return;
    }
    let service = Service::start("fingers");
    let folder = folder("fingers");
    let (file, record) = (folder.join("empty.toml"), folder.join("visit.csv"));
    std::fs::write(&file, EMPTY).unwrap();
    let (scene, shots, kept) = (file.to_str().unwrap(), folder.to_str().unwrap(), record.to_str().unwrap());
    let size = format!("{SIZE}x{SIZE}");
    let run =
        ["xr", scene, "--eye-size", &size, "--shots", shots, "--every", "4", "--record", kept, "--json"];
    let mut head = service.head();
    head.set(0.0, 0.0, [0.0, 1.6, 0.0]);
    let mut live = Live::start(service.gaitway(&run));
    live.hear("the headset shows the crowd");
    let parts = [[0.0, 0.5, 0.5, 1.0], [0.5, 0.5, 1.0, 1.0]];
    let mut show = |left: Option<[f32; 3]>, right: Option<[f32; 3]>| {
        head.show_hand(0, left);
        head.show_hand(1, right);
        head.set(0.0, 0.0, [0.0, 1.6, 0.0]);
        let wanted = [left, right].map(|hand| hand.is_some());
        let is_it = |image: &Image| {
            (0..2).all(|hand| {
                if wanted[hand] { skin(image, parts[hand]) > 150 } else { skin(image, parts[hand]) == 0 }
            })
        };
        let image = look(&folder, "other hands", is_it);
        println!("{:?} pixels of skin for {wanted:?}", parts.map(|part| skin(&image, part)));
        // columns 13 and 20: the hands
        recorded(&record, 3, |step| [13, 20].map(|column| !step[column].is_empty()) == wanted);
    };
    let places = [Some([-0.25, 1.35, -0.45]), Some([0.25, 1.35, -0.45])];
    show(None, None);
    show(places[0], places[1]);
    show(None, places[1]);
    show(None, None);
    let (found, _) = live.end();
    let extensions = found["runtime"]["extensions"].as_array().unwrap();
    assert!(extensions.iter().any(|name| name == "XR_EXT_hand_tracking"), "{found}");
    // the palm of the right hand, as a controller would be: near where it was shown
    let rows = steps(&record);
    let right = rows.iter().rev().find(|row| !row[20].is_empty()).unwrap();
    let [x, y, z] = [20, 21, 22].map(|column| right[column].parse::<f32>().unwrap());
    println!("the right palm at {x} {y} {z}");
    // the user stands at (2, 1) and faces -z
    assert!((x - 2.25).abs() < 0.15 && (y - 1.35).abs() < 0.15 && (z - 0.55).abs() < 0.15, "{right:?}");
}

/// A ramp along x up to a deck of 3 m, under which two people walk up and down.
const RAMP: &str = r#"
name = "ramp"
condition = "eva-o"
bounds = [[-30.0, -30.0], [30.0, -30.0], [30.0, 30.0], [-30.0, 30.0]]
[population]
agents = 0
[user]
position = [-1.0, 0.0]
heading_deg = 90.0
[[floors]]
polygon = [[0, -2], [6, -2], [6, 2], [0, 2]]
heights = [0, 3, 3]
[[floors]]
polygon = [[6, -2], [12, -2], [12, 2], [6, 2]]
heights = [3]
[[walkers]]
position = [11.0, 0.5]
waypoints = [[7.0, 0.5], [11.0, 0.5]]
mode = "loop"
[[walkers]]
position = [7.0, -0.5]
waypoints = [[11.0, -0.5], [7.0, -0.5]]
mode = "loop"
"#;

#[test]
fn the_user_walks_up_a_ramp_and_the_eyes_rise() {
    if !is_there() {
        return;
    }
    let service = Service::start("ramp");
    let folder = folder("ramp");
    let (file, record) = (folder.join("ramp.toml"), folder.join("visit.csv"));
    std::fs::write(&file, RAMP).unwrap();
    let (scene, kept) = (file.to_str().unwrap(), record.to_str().unwrap());
    let run = ["xr", scene, "--eye-size", "160x160", "--record", kept, "--json"];
    let mut head = service.head();
    head.set(0.0, 0.0, [0.0, 1.6, 0.0]);
    let mut live = Live::start(service.gaitway(&run));
    live.hear("the headset shows the crowd");
    hold(&mut head, 0.0, Stick::default(), Stick { stick: [0.0, 1.0], ..Stick::default() });
    let number = |step: &[String], column: usize| step[column].parse::<f32>().unwrap();
    // height of the floor, then that of the head, which follows
    recorded(&record, 3, |step| number(step, 3) > 2.99 && !step[7].is_empty() && number(step, 7) > 4.5);
    live.end();
    for step in steps(&record) {
        let (x, height) = (number(&step, 1), number(&step, 3));
        assert!((height - (0.5 * x).clamp(0.0, 3.0)).abs() < 0.02, "{height} m high at {x}");
    }
    // those below the deck made no way for the user on it, and do not in the replay
    let again = ["xr", scene, "--backend", "cpu", "--json", "--replay", kept];
    let output = service.gaitway(&again).output().unwrap();
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(output.status.success() && found["equal"] == true, "{found}");
}
