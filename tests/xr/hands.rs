//! The user's hands: seen as controllers, they point to a place and go there, walk, and come back to the start.

use super::service::{Head, Live, Service, Stick, is_there};
use super::{folder, pictures};
use gaitway::picture::Image;
use std::path::Path;
use std::time::Duration;

const SIZE: u32 = 400;

/// An empty square, and nobody in it.
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

/// The newest picture after a pause.
fn look(folder: &Path) -> Image {
    std::thread::sleep(Duration::from_millis(1200));
    pictures(folder).pop().unwrap().1
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
    let text = std::fs::read_to_string(file).unwrap();
    let rows = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    let number = |field: Option<&str>| field.unwrap().parse().unwrap();
    rows.map(|row| {
        let mut fields = row.split(',').skip(1);
        [number(fields.next()), number(fields.next())]
    })
    .collect()
}

#[test]
fn controllers_are_seen_point_walk_and_recentre() {
    if !is_there() {
        return;
    }
    let service = Service::start("hands", 4284);
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
    live.hear("the headset shows the crowd", Duration::from_secs(30));
    let rest = Stick::default();
    let bare = look(&folder);
    hold(&mut head, 0.0, rest, rest);
    let held = look(&folder);
    // half a metre away, a hand's breadth below the eyes' height: where the controllers are the picture is dark
    let parts = [[0.15, 0.8, 0.4, 1.0], [0.6, 0.8, 0.95, 1.0]];
    for part in parts {
        let (without, with) = (light(&bare, part), light(&held, part));
        println!("light {without:.0} without a controller, {with:.0} with one");
        assert!(with < without - 8.0, "{without} {with}");
    }

    // pointing down at 35 degrees from 1.25 m: the place is a metre and three quarters away
    hold(&mut head, -35.0, Stick { a: true, ..rest }, rest);
    let aimed = look(&folder);
    println!("{} blue pixels, {} before", blue(&aimed), blue(&held));
    assert!(blue(&aimed) > 60 && blue(&held) == 0, "no ring on the floor");
    hold(&mut head, -35.0, rest, rest);
    let there = look(&folder);
    assert_eq!(blue(&there), 0);

    // walking: the edge is dark
    hold(&mut head, 0.0, rest, Stick { stick: [0.0, 1.0], ..rest });
    let walks = look(&folder);
    let (edge, middle) = ([0.0, 0.4, 0.06, 0.6], [0.4, 0.4, 0.6, 0.6]);
    println!("edge {:.0} standing, {:.0} walking", light(&there, edge), light(&walks, edge));
    assert!(light(&walks, edge) < 0.3 * light(&there, edge));
    assert!(light(&walks, middle) > 0.9 * light(&there, middle));

    hold(&mut head, 0.0, rest, Stick { click: true, ..rest });
    look(&folder);
    hold(&mut head, 0.0, rest, rest);
    let home = look(&folder);
    assert!((light(&home, edge) - light(&there, edge)).abs() < 12.0, "standing again");
    live.end();

    // x to the right as the user faces, z back: the room is not turned
    let way = places(&record);
    let jumps: Vec<[f32; 2]> = way
        .windows(2)
        .map(|pair| [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]])
        .filter(|jump| jump[0].hypot(jump[1]) > 0.4)
        .collect();
    println!("jumps {jumps:.2?}, from {:?} to {:?}", way[0], way[way.len() - 1]);
    assert_eq!(jumps.len(), 2, "a teleport and a recentring: {jumps:?}");
    assert!(jumps[0][1] < -1.2 && jumps[0][1] > -3.5 && jumps[0][0].abs() < 0.6, "{jumps:?}");
    let walked = way.windows(2).map(|pair| pair[1][1] - pair[0][1]).filter(|z| (-0.2..-0.01).contains(z));
    assert!(walked.sum::<f32>() < -0.8, "it walked ahead");
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
    let service = Service::start("fingers", 4287);
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
    live.hear("the headset shows the crowd", Duration::from_secs(30));
    let mut show = |left, right| {
        head.show_hand(0, left);
        head.show_hand(1, right);
        head.set(0.0, 0.0, [0.0, 1.6, 0.0]);
        look(&folder)
    };
    let places = [Some([-0.25, 1.35, -0.45]), Some([0.25, 1.35, -0.45])];
    let (bare, both) = (show(None, None), show(places[0], places[1]));
    let (one, none) = (show(None, places[1]), show(None, None));
    let parts = [[0.0, 0.5, 0.5, 1.0], [0.5, 0.5, 1.0, 1.0]];
    let seen = [&bare, &both, &one, &none].map(|image| parts.map(|part| skin(image, part)));
    println!("{seen:?} pixels of skin: none, both hands, the right one, none");
    assert!(seen[1].iter().all(|count| *count > 150), "{seen:?}");
    assert!(seen[2][0] == 0 && seen[2][1] > 150, "{seen:?}");
    assert_eq!([seen[0], seen[3]], [[0; 2]; 2]);
    let (found, _) = live.end();
    let extensions = found["runtime"]["extensions"].as_array().unwrap();
    assert!(extensions.iter().any(|name| name == "XR_EXT_hand_tracking"), "{found}");
    // the palm of the right hand, as a controller would be: longest of all, and near where it was shown
    let text = std::fs::read_to_string(&record).unwrap();
    let rows: Vec<Vec<&str>> = text
        .lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
        .map(|row| row.split(',').collect())
        .collect();
    let count = |column: usize| rows.iter().filter(|row| !row[column].is_empty()).count();
    assert!(count(12) > 10 && count(19) > count(12) + 10, "{} and {} steps with hands", count(12), count(19));
    let right = rows.iter().find(|row| !row[19].is_empty()).unwrap();
    let [x, y, z] = [19, 20, 21].map(|column| right[column].parse::<f32>().unwrap());
    println!("the right palm at {x} {y} {z}");
    // the user stands at (2, 1) and faces -z
    assert!((x - 2.25).abs() < 0.15 && (y - 1.35).abs() < 0.15 && (z - 0.55).abs() < 0.15, "{right:?}");
}
