//! Five hundred people cross a street for ten seconds. Where each of them is goes to standard output as a CSV table.
#![allow(clippy::print_stdout, reason = "an example prints")]

use gaitway::{Result, Scene};

fn main() -> Result<()> {
    let mut crowd = Scene::load("crossing")?.agents(500).seed(7).start()?;
    println!("time_s,id,x_m,z_m,speed_m_s,emotion");
    for _second in 0..10 {
        crowd.step(30)?;
        let time = crowd.time();
        for person in crowd.people()? {
            let (at, speed) = (person.position, person.velocity.length());
            println!("{time:.2},{},{:.3},{:.3},{speed:.3},{}", person.id, at.x, at.y, person.emotion());
        }
    }
    Ok(())
}
