//! Which heads follow the user's: measured on the joints of drawn agents, and kept as pictures.

use super::service::{Live, Service, is_there, until};
use super::{after, folder};
use std::collections::BTreeMap;
use std::path::Path;

/// Where people stand, in two rows, and face the user.
const STANDING: &str = r#"
name = "standing"
condition = "eva-g"
seed = 3
bounds = [[-30.0, -30.0], [30.0, -30.0], [30.0, 30.0], [-30.0, 30.0]]
[population]
agents = 0
[gaze]
budget = "all"
[user]
position = [0.0, 0.0]
heading_deg = 180.0
"#;

/// Degrees between the face of the happy and the user's eyes: the chin is up.
const EYES_OF_THE_HAPPY: std::ops::Range<f32> = 4.0..7.0;

/// Degrees to either side within which a head is that looks nowhere.
const AT_REST: f32 = 1.5;

/// One person in one picture.
#[derive(Debug, Clone, Copy)]
struct Look {
    /// Turn of the face against the chest, degrees, left positive.
    turn: f32,
    /// Angle between the face and the user's eyes, degrees.
    off: f32,
    /// Direction of the user, degrees, left positive.
    to_user: f32,
}

/// Everyone in the last picture: emotion, and how they look.
fn looks(folder: &Path, user: [f32; 2]) -> BTreeMap<u32, (String, Look)> {
    let tables = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let last = tables.filter(|path| path.extension().is_some_and(|x| x == "csv")).max().unwrap();
    let text = std::fs::read_to_string(last).unwrap();
    text.lines()
        .skip(1)
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            let number = |field: usize| fields[field].parse::<f32>().unwrap();
            // counted from +z, to which they were put; their left is +x
            let to_user = (user[0] - number(2)).atan2(user[1] - number(4)).to_degrees();
            let look = Look { turn: number(8), off: number(11), to_user };
            (fields[0].parse().unwrap(), (fields[1].to_owned(), look))
        })
        .collect()
}

#[test]
fn happy_and_angry_heads_follow_the_user_and_sad_ones_do_not() {
    if !is_there() {
        return;
    }
    let service = Service::start("gaze");
    let folder = folder("gaze");
    let mut scene = STANDING.to_owned();
    for (x, z) in [-2.0, -1.0, 0.0, 1.0, 2.0]
        .map(|x| (x, -2.5))
        .into_iter()
        .chain([-1.5, -0.5, 0.5, 1.5].map(|x| (x, -3.5)))
    {
        scene += &format!("[[walkers]]\nposition = [{x:.1}, {z:.1}]\n");
    }
    let file = folder.join("standing.toml");
    std::fs::write(&file, scene).unwrap();
    let (scene, shots) = (file.to_str().unwrap(), folder.to_str().unwrap());
    let run = ["xr", scene, "--eye-size", "640x640", "--shots", shots, "--every", "4", "--json"];
    let mut head = service.head();
    let mut found = Vec::new();
    head.set(0.0, 0.0, [0.0, 1.6, 0.0]);
    let mut live = Live::start(service.gaitway(&run));
    live.hear("the headset shows the crowd");
    for x in [-1.2_f32, 1.2] {
        head.set(0.0, 0.0, [x, 1.6, 0.0]);
        // frames that were begun before show the user as they were
        after(&folder, 4);
        // heads take a second or two of pictures to turn, however long a busy machine takes for these
        found.push(until(|| {
            // the user faces -z, so the room's x is the world's
            let seen = looks(&folder, [x, 0.0]);
            let is_there = |(emotion, look): &(String, Look)| match emotion.as_str() {
                "angry" => look.off < 3.0,
                "happy" => EYES_OF_THE_HAPPY.contains(&look.off),
                // glances aside come and go
                "sad" => look.turn.abs() < AT_REST,
                _ => true,
            };
            if seen.values().all(is_there) { Ok(seen) } else { Err(format!("heads still turn: {seen:.1?}")) }
        }));
    }
    live.end();
    let of = |emotion: &str| {
        let agents = found[0].iter().filter(|(_, (is, _))| is == emotion).map(|(agent, _)| *agent);
        let pairs: Vec<[Look; 2]> = agents.map(|agent| [found[0][&agent].1, found[1][&agent].1]).collect();
        assert!(!pairs.is_empty(), "no agent is {emotion}: {:?}", found[0]);
        pairs
    };
    for emotion in ["happy", "angry", "sad", "neutral"] {
        println!("{emotion}: {:.1?}", of(emotion));
    }
    for pair in of("happy").into_iter().chain(of("angry")) {
        // bodies may have turned in making room, and a turn is counted from the chest; `off` is the exact measure
        let turned = pair[1].turn - pair[0].turn;
        let user = pair[1].to_user - pair[0].to_user;
        assert!(user > 20.0 && turned > 0.5 * user, "{turned} degrees for {user}: {pair:?}");
    }
    for pair in of("sad") {
        let user = pair[1].to_user - pair[0].to_user;
        assert!(user > 20.0 && pair.iter().all(|look| look.turn.abs() < AT_REST), "{pair:?}");
    }
}
