//! People who stand are no statues: what changes in their picture.

use crate::common::gpu;
use crate::support::keep;
use gaitway::Emotion;
use gaitway::render::camera::Camera;
use gaitway::render::{Image, Settings};
use gaitway::scenario::{Scenario, Shares};
use gaitway::scene::{Scene, Stage};
use glam::{Vec2, Vec3};

const W: u32 = 800;
const H: u32 = 260;

/// A channel of a pixel that changes by more is seen to, of 255.
const SEEN: u8 = 8;

/// Steps in 3 s.
const LATER: u32 = 90;

/// Ten people in a row who have nowhere to go, or an empty place: the only one stands behind the camera.
fn place(emotion: Emotion, is_empty: bool) -> Option<Stage> {
    let walker = |at: Vec2| format!("[[walkers]]\nposition = [{:.2}, {:.2}]\n", at.x, at.y);
    let row: String = match is_empty {
        true => walker(Vec2::new(0.0, 30.0)),
        false => (0..10u8).map(|i| walker(Vec2::new(0.8 * f32::from(i) - 3.6, 0.0))).collect(),
    };
    let text = format!(
        "name = \"row\"\ncondition = \"eva-o\"\nseed = 5\nbounds = [[-40, -40], [40, -40], [40, 40], [-40, 40]]\n\
         [population]\nagents = 0\n{row}"
    );
    let mut scenario = Scenario::parse(&text, "row.toml").unwrap();
    let share = |of: Emotion| if of == emotion { 1.0 } else { 0.0 };
    scenario.population.emotions = Shares {
        happy: share(Emotion::Happy),
        angry: share(Emotion::Angry),
        sad: share(Emotion::Sad),
        neutral: share(Emotion::Neutral),
    };
    let scene = Scene::of(scenario).build().unwrap();
    gpu::on_device(Stage::new(scene, Settings::sized(W, H)))
}

fn pixels(image: &Image) -> impl Iterator<Item = &[u8]> {
    image.pixels.chunks_exact(4)
}

fn differ(a: &[u8], b: &[u8]) -> bool {
    a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > SEEN)
}

#[test]
fn three_seconds_later_more_than_two_percent_of_the_pixels_of_ten_people_differ() {
    let camera = Camera::look_at(Vec3::new(0.0, 1.5, 9.0), Vec3::new(0.0, 0.95, 0.0), Vec3::Y).with_fov(0.3);
    let Some(mut empty_stage) = place(Emotion::Neutral, true) else { return };
    let empty = empty_stage.picture(&camera).unwrap();
    for emotion in Emotion::ALL {
        let mut stage = place(emotion, false).unwrap();
        stage.step(150).unwrap();
        let mut before = stage.picture(&camera).unwrap();
        for picture in 1..=4 {
            stage.step(LATER).unwrap();
            let after = stage.picture(&camera).unwrap();
            keep(&format!("standing-{emotion}-{picture}"), &after);
            // theirs, with their shadows, are the pixels that differ from those of the empty place
            let [mut theirs, mut changed] = [0, 0];
            for ((a, b), none) in pixels(&before).zip(pixels(&after)).zip(pixels(&empty)) {
                let is_theirs = differ(a, none) || differ(b, none);
                theirs += u32::from(is_theirs);
                changed += u32::from(is_theirs && differ(a, b));
            }
            let share = f64::from(changed) / f64::from(theirs);
            println!("{emotion}, {picture}: {:.1} % of {theirs} pixels", 100.0 * share);
            assert!(theirs > 10_000 && theirs < W * H / 2, "{theirs} pixels show people");
            assert!(share > 0.02, "{emotion}: {share} of their pixels");
            before = after;
        }
    }
    gpu::assert_silent();
}
