//! Frames of the garden from a camera that goes round it. They go into the folder that is named, or into `frames`.
#![allow(clippy::print_stdout, reason = "an example prints")]

use gaitway::Scene;
use gaitway::export::image::write_png;
use gaitway::render::Settings;
use gaitway::scene::{CameraChoice, Stage};
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "frames".to_owned()));
    std::fs::create_dir_all(&folder)?;
    let scene = Scene::load("garden")?.agents(100).build()?;
    let mut stage = Stage::new(scene, Settings::sized(640, 360))?;
    for frame in 0..5 {
        stage.step(30)?;
        let camera = stage.camera(CameraChoice::Orbit, stage.simulation.time())?;
        let file = folder.join(format!("{frame:03}.png"));
        write_png(&file, &stage.picture(&camera)?)?;
        println!("{}", file.display());
    }
    Ok(())
}
