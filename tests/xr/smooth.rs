//! People move in every frame, though the crowd is stepped more slowly than the display shows pictures.

use super::folder;
use super::frames;
use super::service::{Live, Service, is_there, until};
use glam::Vec2;
use std::path::Path;

/// Ten steps a second on a display of twenty pictures; one walks to and fro, another is set back whenever he arrives. Both stay so near
/// that they are drawn with a pose, whatever the quality.
const SCENE: &str = r#"
name = "smooth"
condition = "eva-o"
seed = 3
bounds = [[-40.0, -40.0], [40.0, -40.0], [40.0, 40.0], [-40.0, 40.0]]
[population]
agents = 0
[navigation]
time_step = 0.1
[user]
position = [0.0, 0.0]
heading_deg = 180.0
[[walkers]]
position = [-5.0, -8.0]
waypoints = [[5.0, -8.0], [-5.0, -8.0]]
mode = "patrol"
speed = 1.3
[[walkers]]
position = [-0.5, -5.5]
waypoints = [[30.0, -5.5]]
speed = 1.3
teleport = { from = [[3.5, -6.5], [6.0, -5.2]], to = [[-3.0, -5.6], [-2.0, -5.4]] }
"#;

/// Position of an agent's eyes (x, z, m), frame by frame.
fn way(folder: &Path, frames: &[u64], agent: &str) -> Vec<Vec2> {
    let seen = frames.iter().map(|frame| {
        let text = std::fs::read_to_string(folder.join(format!("frame-{frame:06}.csv"))).unwrap();
        let line = text.lines().find(|line| line.split(',').next() == Some(agent));
        let line = line.unwrap_or_else(|| panic!("frame {frame} does not show {agent}: {text}"));
        let fields: Vec<&str> = line.split(',').collect();
        Vec2::new(fields[2].parse().unwrap(), fields[4].parse().unwrap())
    });
    seen.collect()
}

/// How often an agent was set back.
fn set_back(taken: &[Vec2]) -> usize {
    taken.windows(2).filter(|pair| pair[1].x < pair[0].x - 4.5).count()
}

#[test]
fn people_move_in_every_frame_of_a_display_faster_than_the_steps() {
    if !is_there() {
        return;
    }
    let service = Service::start("smooth");
    let folder = folder("smooth");
    let file = folder.join("smooth.toml");
    std::fs::write(&file, SCENE).unwrap();
    service.head().set(0.0, 0.0, [0.0, 1.6, 0.0]);
    let (scene, shots) = (file.to_str().unwrap(), folder.to_str().unwrap());
    let run = ["xr", scene, "--eye-size", "320x320", "--shots", shots, "--every", "1", "--json"];
    let live = Live::start(service.gaitway(&run));
    // while the session begins, steps may be late; a picture without its table is being written
    let shown = || -> Vec<u64> {
        let is_whole = |frame: &u64| folder.join(format!("frame-{frame:06}.csv")).exists();
        frames(&folder).into_iter().filter(is_whole).skip(20).collect()
    };
    until(|| {
        let found = shown();
        let back = set_back(&way(&folder, &found, "1"));
        if found.len() > 60 && back > 0 {
            Ok(())
        } else {
            Err(format!("{} frames, set back {back} times", found.len()))
        }
    });
    let (found, _) = live.end();
    let frames = shown();

    let walked = way(&folder, &frames, "0");
    // not where he turns about
    let is_straight = |at: &[Vec2]| at.iter().all(|at| at.x.abs() < 3.8);
    let walks: Vec<f32> =
        walked.windows(2).filter(|pair| is_straight(pair)).map(|pair| pair[0].distance(pair[1])).collect();
    assert!(walks.len() > 30, "{walked:?}");
    println!("walks {walks:.3?} m a frame");
    // 1.3 m/s are 130 mm a step. Shown as the steps are, a frame would move by none, one or several of these; shown between
    // them, by other lengths too, however many frames a busy machine misses
    let steps = |walk: &f32| walk / 0.13;
    let between = walks.iter().map(steps).filter(|steps| (steps - steps.round()).abs() > 0.15).count();
    assert!(
        between * 100 >= walks.len() * 25,
        "{between} of {} moves are parts of steps: {walks:?}",
        walks.len()
    );
    // and where the machine kept the display's rate of 20 Hz, 65 mm in every frame
    let count = |key: &str| found["frames"][key].as_f64().unwrap();
    if count("missed") < 0.05 * count("drawn") && found["time_lost"].as_f64().unwrap() < 0.1 {
        let moving = walks.iter().filter(|step| **step > 0.03).count();
        assert!(moving * 100 >= walks.len() * 95, "{moving} of {} frames move: {walks:?}", walks.len());
        let mut sorted = walks.clone();
        sorted.sort_by(f32::total_cmp);
        let median = sorted[sorted.len() / 2];
        assert!((0.055..0.085).contains(&median), "{walks:?}");
    } else {
        println!("not asserted: 65 mm in every frame, on a machine too busy for 20 Hz ({})", found["frames"]);
    }
    // no agent is ever shown going back
    let is_back = |at: &[Vec2]| is_straight(at) && (at[1] - at[0]).dot(at[2] - at[1]) < -0.005 * 0.03;
    assert!(!walked.windows(3).any(is_back), "{walked:?}");

    let taken = way(&folder, &frames, "1");
    println!("set back {} times: {taken:.1?}", set_back(&taken));
    // no farther in a frame than the other one, who walks as fast
    for (pair, other) in taken.windows(2).zip(walked.windows(2)).filter(|(_, other)| is_straight(other)) {
        assert!(pair[1].x - pair[0].x < 2.0 * other[0].distance(other[1]) + 0.25, "{pair:?} {other:?}");
    }
    let far = |at: &Vec2| !(-3.2..=4.2).contains(&at.x);
    assert!(!taken.iter().any(far), "{taken:?}");
    let on_the_way = taken.windows(3).filter(|at| at[1].x < at[0].x - 0.3 && at[2].x < at[1].x - 0.3).count();
    assert_eq!(on_the_way, 0, "{taken:?}");
}
