//! Faces of people who stand, as pictures of head and shoulders.

use crate::common::gpu;
use crate::support::keep;
use gaitway::Emotion;
use gaitway::render::camera::Camera;
use gaitway::render::{Image, Settings};
use gaitway::scenario::{Scenario, Shares};
use gaitway::scene::{Scene, Stage};
use glam::{Vec2, Vec3};

const SIDE: u32 = 720;
/// People of each emotion: women and men by turns.
const PEOPLE: usize = 6;
/// How high what a picture shows is, m.
const SHOWN: f32 = 0.56;
/// A channel of a pixel that changes by more is seen to, of 255.
const SEEN: u8 = 12;

/// People who have nowhere to go, 15 m from each other.
fn row(emotion: Emotion, expression: f32) -> Option<Stage> {
    let walker = |i: usize| format!("[[walkers]]\nposition = [{:.1}, 0.0]\n", 15.0 * i as f32 - 40.0);
    let walkers: String = (0..PEOPLE).map(walker).collect();
    let text = format!(
        "name = \"faces\"\nseed = 11\nbounds = [[-60, -40], [60, -40], [60, 40], [-60, 40]]\n[user]\navoided = false\n\
         [population]\nagents = 0\nexpression = {expression:.1}\n{walkers}"
    );
    let mut scenario = Scenario::parse(&text, "faces.toml").unwrap();
    let share = |of: Emotion| if of == emotion { 1.0 } else { 0.0 };
    scenario.population.emotions = Shares {
        happy: share(Emotion::Happy),
        angry: share(Emotion::Angry),
        sad: share(Emotion::Sad),
        neutral: share(Emotion::Neutral),
    };
    let mut stage =
        gpu::on_device(Stage::new(Scene::of(scenario).build().unwrap(), Settings::sized(SIDE, SIDE)))?;
    stage.step(90).unwrap();
    Some(stage)
}

/// Head and shoulders of one of them, who sees the eyes of the camera so far ahead, m.
fn portrait(stage: &mut Stage, number: usize, distance: f32) -> Image {
    let agent = &stage.scene.crowd.agents[number];
    let eyes = 0.925 * stage.scene.cast.avatars()[agent.avatar as usize].height * agent.scale;
    let at = Vec3::new(agent.position.x, eyes, agent.position.y);
    stage.scene.geometry.user = Some(Vec2::new(at.x, at.z + distance));
    stage.scene.scenario.user.as_mut().unwrap().eye_height = eyes;
    let camera = Camera::look_at(at + Vec3::Z * distance, at - Vec3::Y * 0.09, Vec3::Y);
    stage.picture(&camera.with_fov(2.0 * (0.5 * SHOWN / distance).atan())).unwrap()
}

fn changed(a: &Image, b: &Image) -> usize {
    let differ = |(a, b): (&[u8], &[u8])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > SEEN);
    a.pixels.chunks_exact(4).zip(b.pixels.chunks_exact(4)).filter(|pair| differ(*pair)).count()
}

#[test]
fn faces_of_people_who_stand_show_what_they_feel_and_those_of_the_neutral_are_at_rest() {
    for emotion in Emotion::ALL {
        let Some(mut shown) = row(emotion, 2.0) else { return };
        let mut hidden = row(emotion, 0.0).unwrap();
        for number in 0..2 {
            let face = portrait(&mut shown, number, 2.0);
            let at_rest = portrait(&mut hidden, number, 2.0);
            let pixels = changed(&face, &at_rest);
            println!("{emotion}, {number}: {pixels} pixels");
            if emotion == Emotion::Neutral {
                assert_eq!(pixels, 0);
            } else {
                assert!(pixels > 1_500, "{emotion}: {pixels} pixels of a face");
            }
        }
        // to be looked at, all of them
        if std::env::var_os("GAITWAY_PICTURES").is_some() {
            for number in 0..PEOPLE {
                for distance in [1.0, 2.0, 4.0] {
                    let face = portrait(&mut shown, number, distance);
                    keep(&format!("face-{emotion}-{number}-{distance}m"), &face);
                }
            }
        }
    }
    gpu::assert_silent();
}
