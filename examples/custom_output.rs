//! An output of one's own: one JSON object a second with the density and the mean speed of each emotion.
#![allow(clippy::print_stdout, reason = "an example prints")]

use gaitway::{Emotion, Result, Scene};

fn main() -> Result<()> {
    let scene = Scene::load("parking")?.agents(200).build()?;
    let area = gaitway::scenario::polygon::signed_area(&scene.geometry.bounds).abs();
    let mut crowd = scene.start()?;
    for second in 1..=10 {
        crowd.step(30)?;
        let mut speeds: [Vec<f32>; 4] = Default::default();
        for person in crowd.people()? {
            speeds[person.emotion().index()].push(person.velocity.length());
        }
        let present: usize = speeds.iter().map(Vec::len).sum();
        let mean = |emotion: Emotion| {
            let of = &speeds[emotion.index()];
            format!("\"{emotion}\": {:.3}", of.iter().sum::<f32>() / of.len().max(1) as f32)
        };
        let means = Emotion::ALL.map(mean).join(", ");
        println!("{{\"second\": {second}, \"people_per_m2\": {:.4}, {means}}}", present as f64 / area);
    }
    Ok(())
}
