//! What is fuzzed: a name, valid files, and the reader.

use crate::containers::{c3d, npy, npz, trc};
use crate::mutate::Form;
use crate::walker::{self, Walker};
use crate::{crowds, people, studies};
use gaitway::Emotion;
use gaitway::gait::import::{
    JointMap, Options, asf_amc, bvh, c3d as c3d_file, csv, npz as npz_file, trc as trc_file,
};
use gaitway::gait::walker::{Sex, person};
use gaitway::gait::{Error, Recording, stride};
use gaitway::library::GaitLibrary;
use std::path::Path;

/// One reader.
pub(crate) struct Target {
    pub(crate) name: &'static str,
    pub(crate) form: Form,
    /// Valid files.
    pub(crate) seeds: fn() -> Vec<Vec<u8>>,
    /// What was read, or the message.
    pub(crate) read: fn(&[u8]) -> Result<String, String>,
}

/// Every reader there is.
pub(crate) fn all() -> impl Iterator<Item = &'static Target> {
    let files = MOTION.iter().chain(&crowds::TARGETS).chain(&people::TARGETS).chain(&studies::TARGETS);
    #[cfg(feature = "study")]
    let files = files.chain(&crate::visits::TARGETS);
    files
}

/// Readers of motion capture and gaits.
static MOTION: [Target; 10] = [
    Target {
        name: "bvh",
        form: Form::Text,
        seeds: bvh_seeds,
        read: |bytes| takes(bvh::parse_bvh(&text(bytes), "x", &Options::default()).map(|take| vec![take])),
    },
    Target {
        name: "asf",
        form: Form::Text,
        seeds: || vec![walker::asf().into_bytes()],
        read: |bytes| {
            let skeleton = asf_amc::parse_asf(&text(bytes), "x").map_err(|error| error.to_string())?;
            let motion = walker::amc(20, |frame| frame as f32);
            // A skeleton with other bones is still one that was read.
            let take = asf_amc::parse_amc(&motion, "y", &skeleton, &Options::default());
            takes(Ok(take.into_iter().collect()))
        },
    },
    Target {
        name: "amc",
        form: Form::Text,
        seeds: || vec![walker::amc(20, |frame| frame as f32).into_bytes()],
        read: |bytes| {
            let skeleton = asf_amc::parse_asf(&walker::asf(), "x").map_err(|error| error.to_string())?;
            takes(
                asf_amc::parse_amc(&text(bytes), "y", &skeleton, &Options::default()).map(|take| vec![take]),
            )
        },
    },
    Target {
        name: "csv",
        form: Form::Text,
        seeds: csv_seeds,
        read: |bytes| takes(csv::parse_csv(&text(bytes), "x", &Options::default())),
    },
    Target {
        name: "c3d",
        form: Form::Binary,
        seeds: c3d_seeds,
        read: |bytes| takes(c3d_file::parse_c3d(bytes, "x", &Options::default())),
    },
    Target {
        name: "trc",
        form: Form::Text,
        seeds: trc_seeds,
        read: |bytes| takes(trc_file::parse_trc(&text(bytes), "x", &Options::default())),
    },
    Target {
        name: "npy",
        form: Form::Binary,
        seeds: npy_seeds,
        read: |bytes| takes(npz_file::parse_npy(bytes, "x", &Options::default())),
    },
    Target {
        name: "npz",
        form: Form::Npz,
        seeds: npz_seeds,
        read: |bytes| takes(npz_file::parse_npz(bytes, "x", &Options::default())),
    },
    Target {
        name: "map",
        form: Form::Text,
        seeds: map_seeds,
        read: |bytes| {
            let map = JointMap::parse(&text(bytes), "x").map_err(|error| error.to_string())?;
            let resolved = map.resolve(&["Hips", "Spine", "LWRA", "LWRB"]).is_ok();
            Ok(format!("{resolved}"))
        },
    },
    Target {
        name: "library",
        form: Form::Glb,
        seeds: library_seeds,
        read: |bytes| {
            let library = GaitLibrary::from_glb_bytes(bytes, "x").map_err(|error| error.to_string())?;
            Ok(library.gaits().len().to_string())
        },
    },
];

pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

pub(crate) fn gait(emotion: Emotion, index: u32) -> gaitway::gait::Gait {
    person(emotion, Sex::Female, 1, index).unwrap()
}

/// Asks a reader that takes paths: these files are there while it answers.
pub(crate) fn with_files(
    files: &[(&str, &[u8])],
    read: impl FnOnce(&Path) -> Result<String, String>,
) -> Result<String, String> {
    thread_local! { static FOLDER: tempfile::TempDir = tempfile::tempdir().unwrap(); }
    FOLDER.with(|folder| {
        for (name, bytes) in files {
            std::fs::write(folder.path().join(name), bytes).unwrap();
        }
        let answer = read(folder.path());
        for (name, _) in files {
            std::fs::remove_file(folder.path().join(name)).unwrap();
        }
        answer
    })
}

/// Looks for strides in what was read, as an import does.
fn takes(read: Result<Vec<Recording>, Error>) -> Result<String, String> {
    let takes = read.map_err(|error| error.to_string())?;
    let mut answer = takes.len().to_string();
    for take in takes {
        assert!(take.poses.iter().flatten().all(|point| point.is_finite()), "positions that are not finite");
        match stride::survey(&take) {
            Ok(survey) => {
                answer += if survey.strides.is_empty() { " none" } else { " strides" };
                for found in survey.strides {
                    let finite = found.gait.poses.iter().flatten().all(|point| point.is_finite());
                    assert!(finite && found.gait.speed.is_finite(), "a gait that is not finite");
                }
            }
            Err(_) => answer += " unusable",
        }
    }
    answer.truncate(60);
    Ok(answer)
}

fn walk() -> Recording {
    Walker::default().take(2.6, 15.0)
}

fn bvh_seeds() -> Vec<Vec<u8>> {
    vec![
        walker::bvh(&walk(), 100.0).into_bytes(),
        walker::bvh(&Walker::default().take(0.2, 15.0), 1.0).into_bytes(),
    ]
}

fn csv_seeds() -> Vec<Vec<u8>> {
    let (one, two) = (walk(), Recording { name: "b".into(), ..walk() });
    let mut bare = String::new();
    for pose in &one.poses {
        let row: Vec<String> =
            pose.iter().flat_map(glam::Vec3::to_array).map(|v| format!("{v:.3}")).collect();
        bare += &(row.join(" ") + "\n");
    }
    vec![walker::csv(&[&one, &two], 1.0).into_bytes(), bare.into_bytes()]
}

fn c3d_seeds() -> Vec<Vec<u8>> {
    let walk = walk();
    vec![c3d(&walk, 84, true, "mm"), c3d(&walk, 85, false, "mm"), c3d(&walk, 86, true, "?")]
}

fn trc_seeds() -> Vec<Vec<u8>> {
    let names: Vec<String> = gaitway::gait::Joint::ALL.iter().map(|joint| joint.name().to_owned()).collect();
    let frames: Vec<Vec<Option<glam::Vec3>>> =
        walk().poses.iter().map(|pose| pose.iter().map(|point| Some(*point)).collect()).collect();
    let whole = trc(&names, &frames, 15.0, "mm");
    let legs: Vec<usize> = (0..16).filter(|joint| *joint == 0 || *joint > 9).collect();
    let of_legs: Vec<String> = legs.iter().map(|&joint| names[joint].clone()).collect();
    let frames: Vec<Vec<Option<glam::Vec3>>> =
        frames.iter().map(|frame| legs.iter().map(|&joint| frame[joint]).collect()).collect();
    let of_legs = trc(&of_legs, &frames, 15.0, "m");
    vec![whole.replace('\n', "\r\n").into_bytes(), whole.into_bytes(), of_legs.into_bytes()]
}

fn floats(take: &Recording) -> Vec<u8> {
    take.poses.iter().flatten().flat_map(glam::Vec3::to_array).flat_map(f32::to_le_bytes).collect()
}

fn npy_seeds() -> Vec<Vec<u8>> {
    let walk = walk();
    let count = walk.poses.len();
    vec![
        npy("<f4", &format!("({count}, 48)"), &floats(&walk)),
        npy("<f4", &format!("({count}, 16, 3)"), &floats(&walk)),
        npy(
            "<i2",
            "(2, 20, 17, 3)",
            &(0..2 * 20 * 17 * 3).flat_map(|i: i16| (i % 997).to_le_bytes()).collect::<Vec<u8>>(),
        ),
    ]
}

fn npz_seeds() -> Vec<Vec<u8>> {
    let walk = walk();
    let count = walk.poses.len();
    let positions = npy("<f4", &format!("({count}, 16, 3)"), &floats(&walk));
    let names: Vec<u8> = gaitway::gait::Joint::ALL
        .iter()
        .flat_map(|joint| format!("{:\0<14}", joint.name()).into_bytes())
        .collect();
    let small =
        |rows: usize, width: usize| npy("<f4", &format!("({rows}, {width})"), &vec![0x3d; 4 * rows * width]);
    vec![
        npz(&[("walk", positions.clone()), ("fps", npy("<f8", "()", &60.0_f64.to_le_bytes()))], true),
        npz(&[("positions", positions), ("names", npy("|S14", "(16,)", &names))], false),
        npz(
            &[
                ("poses", small(20, 66)),
                ("trans", small(20, 3)),
                ("mocap_framerate", npy("<f4", "()", &60.0_f32.to_le_bytes())),
            ],
            true,
        ),
    ]
}

fn map_seeds() -> Vec<Vec<u8>> {
    let text = "rig = \"mine\"\nlike = \"mixamo\"\nhead = \"Skull\"\nleft_hand = \"LWRA + LWRB\"\nspine = \"0.6*Pelvis + 0.4*Sternum\"\n";
    vec![text.into()]
}

fn library_seeds() -> Vec<Vec<u8>> {
    let one = GaitLibrary::from_gaits(vec![gait(Emotion::Sad, 0)]).unwrap();
    let two = GaitLibrary::from_gaits(vec![gait(Emotion::Happy, 0), gait(Emotion::Angry, 1)]).unwrap();
    vec![one.to_glb_bytes(), two.to_glb_bytes()]
}

/// Files whose few bytes ask for much: importer, what they do, bytes.
pub(crate) fn hostile() -> Vec<(&'static str, &'static str, Vec<u8>)> {
    const BYTES: usize = 400_000;
    // One channel in all, so that two bytes are a frame of 16 joints.
    let joints = gaitway::gait::Joint::ALL;
    let bodies = |channels: &str| {
        let mut text = format!("HIERARCHY\nROOT root\n{{\nOFFSET 0 1 0\n{channels}\n");
        for (index, joint) in joints.iter().enumerate().skip(1) {
            text += &format!("JOINT {}\n{{\nOFFSET {index} 1 0\n}}\n", joint.name());
        }
        text + "}\n"
    };
    let motion = |frames: usize| format!("MOTION\nFrames: {frames}\nFrame Time: 0.02\n");
    let one = format!("{}{}{}", bodies("CHANNELS 1 Xposition"), motion(BYTES / 2), "0\n".repeat(BYTES / 2));
    let six = "CHANNELS 6 Xposition Yposition Zposition Xrotation Yrotation Zrotation";
    let six = format!("{}{}{}", bodies(six), motion(BYTES / 12), "1 1 1 1 1 1\n".repeat(BYTES / 12));
    let deep = format!("HIERARCHY\n{}", "ROOT a {\nJOINT b {\n".repeat(BYTES / 20));
    let ones = |shape: &str, bytes: usize| npy("|i1", shape, &vec![1; bytes]);
    let moving = |rows: usize| -> Vec<u8> {
        let body: Vec<u8> = (0..48_u8).map(|i| i.wrapping_mul(37)).collect();
        body.repeat(rows)
    };
    let many: Vec<(String, Vec<u8>)> =
        (0..2000).map(|i| (format!("a{i}"), npy("|i1", "(1, 48)", &moving(1)))).collect();
    let many: Vec<(&str, Vec<u8>)> =
        many.iter().map(|(name, bytes)| (name.as_str(), bytes.clone())).collect();
    let mut c3d_few = c3d(&Walker::default().take(1.0, 60.0), 84, false, "mm");
    c3d_few[8] = 0xff;
    c3d_few[9] = 0xff;
    let nested = "[".repeat(BYTES);
    let mut all = vec![
        ("bvh", "frames of one channel", one.into_bytes()),
        ("bvh", "frames of six channels", six.into_bytes()),
        ("bvh", "joints in joints", deep.into_bytes()),
        ("amc", "empty frames", "1\n".repeat(BYTES / 2).into_bytes()),
        ("csv", "frames of zeros", ("0 ".repeat(48) + "\n").repeat(BYTES / 97).into_bytes()),
        ("csv", "frames of a body", (format!("{}\n", "1 2 3 9 ".repeat(12))).repeat(BYTES / 97).into_bytes()),
        ("csv", "many columns", (0..BYTES / 6).map(|i| format!("a{i}_x,")).collect::<String>().into_bytes()),
        ("trc", "frames without markers", {
            let names: String = (0..8000).map(|i| format!("\ta{i}\t\t")).collect();
            format!(
                "PathFileType\nDataRate\n60\nFrame#\tTime\thip\t\t{names}\n{}",
                "1\t1\n".repeat(BYTES / 4)
            )
            .into_bytes()
        }),
        ("trc", "frames of lost markers", {
            let names: String = joints.iter().map(|joint| format!("\t{}\t\t", joint.name())).collect();
            let rows: String = (0..BYTES / 12).map(|i| format!("1\t{i}\t\t\t1\n")).collect();
            format!("PathFileType\nDataRate\n60\nFrame#\tTime{names}\n{rows}").into_bytes()
        }),
        ("npy", "a claim of a billion frames", npy("<f4", "(1000000000, 16, 3)", &[0; 64])),
        ("npy", "bytes as numbers", npy("|i1", "(8000, 48)", &moving(8000))),
        ("npz", "equal numbers", npz(&[("a", ones("(900000, 48)", 43_200_000))], true)),
        ("npz", "equal bodies", npz(&[("a", npy("|i1", "(60000, 48)", &moving(60000)))], true)),
        ("npz", "two thousand arrays", npz(&many, true)),
        ("c3d", "a claim of 65,535 frames", c3d_few),
        ("map", "nested brackets", format!("head = {nested}").into_bytes()),
        ("scenario", "nested brackets", format!("name = {nested}").into_bytes()),
        ("asf", "bones without end", ":bonedata\nbegin\nname a\n".repeat(BYTES / 24).into_bytes()),
    ];
    all.extend(studies::hostile());
    #[cfg(feature = "study")]
    all.extend(crate::requests::hostile());
    all
}
