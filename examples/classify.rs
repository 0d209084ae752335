//! What people would see in a walk: the motion file that is named (BVH, C3D, CSV, ...), or else one generated gait of each
//! emotion.
#![allow(clippy::print_stdout, reason = "an example prints")]

use gaitway::gait::walker::{Sex, person};
use gaitway::gait::{Gait, import, stride};
use gaitway::perception::model::Model;
use gaitway::{Emotion, Result};

fn main() -> Result<()> {
    let gaits: Vec<Gait> = match std::env::args().nth(1) {
        Some(file) => {
            let takes = import::import_file(file.as_ref())?;
            takes.iter().map(stride::best).collect::<std::result::Result<_, _>>()?
        }
        None => Emotion::ALL
            .into_iter()
            .map(|emotion| person(emotion, Sex::Female, 1, 0))
            .collect::<std::result::Result<_, _>>()?,
    };
    let model = Model::built_in()?;
    for gait in &gaits {
        let seen = model.predict(gait);
        let sure = seen.probabilities[seen.emotion.index()] * 100.0;
        println!("{}: {} ({sure:.0} %)", gait.name, seen.emotion);
    }
    Ok(())
}
