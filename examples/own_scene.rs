//! A corridor with a pillar, built in code: half of the people look happy and half sad, and they walk both ways.
#![allow(clippy::print_stdout, reason = "an example prints")]

use gaitway::scenario::{Obstacle, Population, Route, RouteMode, Shares};
use gaitway::{Emotion, Result, Scenario, Scene};

fn main() -> Result<()> {
    let square = |[x, z]: [f32; 2], [width, length]: [f32; 2]| {
        vec![[x, z], [x + width, z], [x + width, z + length], [x, z + length]]
    };
    let line = |name: &str, waypoints: Vec<[f32; 2]>| Route {
        name: name.to_owned(),
        waypoints,
        width: 2.0,
        radius: 1.0,
        mode: RouteMode::Patrol,
        weight: 1.0,
    };
    let corridor = Scenario {
        name: "corridor".to_owned(),
        bounds: square([0.0, -3.0], [40.0, 6.0]),
        obstacles: vec![Obstacle { polygon: square([19.5, -0.5], [1.0, 1.0]), low: None, high: None }],
        routes: vec![
            line("east", vec![[2.0, -1.0], [38.0, -1.0]]),
            line("west", vec![[38.0, 1.0], [2.0, 1.0]]),
        ],
        population: Population {
            agents: 60,
            emotions: Shares { happy: 1.0, sad: 1.0, angry: 0.0, neutral: 0.0 },
            ..Population::default()
        },
        ..Scenario::default()
    };
    let mut crowd = Scene::of(corridor).start()?;
    crowd.step(20 * 30)?;
    for emotion in [Emotion::Happy, Emotion::Sad] {
        let speeds: Vec<f32> = crowd
            .people()?
            .filter(|person| person.emotion() == emotion)
            .map(|person| person.velocity.length())
            .collect();
        let mean = speeds.iter().sum::<f32>() / speeds.len() as f32;
        println!("{} {emotion} people walk {mean:.2} m/s", speeds.len());
    }
    Ok(())
}
