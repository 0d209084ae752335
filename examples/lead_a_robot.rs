//! A program leads a robot through a crowd. It says before each step where the robot goes, and the people make room.
#![allow(clippy::print_stdout, reason = "an example prints")]

use gaitway::scenario::{ExternalAgent, ExternalKind};
use gaitway::{Result, Scene};
use glam::Vec2;

fn main() -> Result<()> {
    let robot = ExternalAgent {
        kind: ExternalKind::Robot,
        radius: Some(0.4),
        comfort: 0.3,
        model: None,
        size: None,
        path: Vec::new(), // this program is its path
    };
    let scene =
        Scene::load("crossing")?.agents(300).change(|scenario| scenario.outsiders.push(robot)).build()?;
    let id = scene.agents(); // outsiders are numbered after the people
    let mut crowd = scene.start()?;
    let velocity = Vec2::new(0.8, 0.0);
    let mut at = Vec2::new(-4.0, 0.0);
    let mut nearest = f32::MAX;
    for step in 0..10 * 30 {
        at += velocity / 30.0;
        crowd.lead(id, Some((at, velocity)))?;
        crowd.step(1)?;
        if step < 30 {
            continue; // it may appear beside a person, who needs a second to walk away
        }
        let others = crowd.people()?.filter(|person| person.id != id);
        nearest = others.map(|person| person.position.distance(at)).fold(nearest, f32::min);
    }
    println!(
        "the robot is at {at} m; after the first second no person's centre came nearer than {nearest:.2} m"
    );
    Ok(())
}
