//! E-Gait as it is in its files, without the importer: what was compared with Python.

use crate::common::data_set;
use gaitway::Emotion;
use gaitway::gait::{Gait, JOINT_COUNT, Joint, Provenance};
use glam::Vec3;
use std::collections::HashMap;
use std::path::PathBuf;

/// The folder of E-Gait, beside the repository or in `GAITWAY_DATA`.
pub(crate) fn folder() -> Option<PathBuf> {
    data_set("egait")
}

fn joint(column: &str) -> Joint {
    let name = column.trim_end_matches("_x").replace("r_", "right_").replace("l_", "left_");
    Joint::ALL.into_iter().find(|joint| joint.name() == name).unwrap()
}

/// The gaits of a file in its order: poses as they stand there taken for metres, 30 Hz, this speed.
pub(crate) fn raw(set: &str, speed: f32) -> Option<Vec<Gait>> {
    let folder = folder()?;
    let index = std::fs::read_to_string(folder.join("gaits.csv")).unwrap();
    let index: HashMap<&str, Vec<&str>> =
        index.lines().map(|line| line.split(',').collect::<Vec<_>>()).map(|row| (row[1], row)).collect();
    let text = std::fs::read_to_string(folder.join(format!("{set}.csv"))).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let joints: Vec<Joint> = header[2..].iter().step_by(3).map(|column| joint(column)).collect();
    let mut gaits: Vec<Gait> = Vec::new();
    for line in lines {
        let row: Vec<&str> = line.split(',').collect();
        let mut pose = [Vec3::ZERO; JOINT_COUNT];
        for (joint, values) in joints.iter().zip(row[2..].chunks(3)) {
            let [x, y, z] = [0, 1, 2].map(|axis| values[axis].parse().unwrap());
            pose[*joint as usize] = Vec3::new(x, y, z);
        }
        match gaits.last_mut() {
            Some(gait) if gait.name == row[0] => gait.poses.push(pose),
            _ => gaits.push(Gait {
                name: row[0].to_owned(),
                poses: vec![pose],
                frame_rate: 30.0,
                speed,
                provenance: Provenance {
                    dataset: set.to_owned(),
                    subject: Some(index[row[0]][3].to_owned()),
                    ..Provenance::default()
                },
                label: index[row[0]][5].parse::<Emotion>().ok(),
                ..Gait::default()
            }),
        }
    }
    Some(gaits)
}

/// The data sets in the order in which they were compared with Python.
pub(crate) const SETS: [&str; 5] = ["bml", "cmu", "ewalk", "ict", "sig"];
