//! Avatars: generated and loaded bodies, driven by gaits. Pictures go to `target/avatar/`.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    missing_debug_implementations,
    unreachable_pub,
    reason = "test helpers"
)]

#[path = "avatar/raster.rs"]
mod raster;

use gaitway::avatar::{Sex, generated};
use raster::{Sheet, rest};
use std::path::PathBuf;

fn picture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/avatar").join(name)
}

#[test]
fn draws_the_bodies() {
    let mut sheet = Sheet::new(4.8, 1.9, 300.0);
    let mut faces = Sheet::new(2.0, 0.5, 900.0);
    for sex in Sex::ALL {
        let avatar = generated(sex);
        for turn in [0.0, 0.7, 1.57, 3.14] {
            sheet.draw(&avatar, 0, &rest(&avatar), turn, 0.6, -0.05);
        }
        for turn in [0.0, 0.7, 1.57, 3.14] {
            faces.draw(&avatar, 0, &rest(&avatar), turn, 0.25, avatar.height - 0.42);
        }
    }
    sheet.save(&picture("bodies.png"));
    faces.save(&picture("faces.png"));
    let mut levels = Sheet::new(3.6, 1.9, 300.0);
    for sex in Sex::ALL {
        let avatar = generated(sex);
        for level in 0..3 {
            levels.draw(&avatar, level, &rest(&avatar), 0.5, 0.6, -0.05);
        }
    }
    levels.save(&picture("levels.png"));
}
