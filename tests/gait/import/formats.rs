//! C3D and `NumPy`: files written by others (`files/`, by ezc3d 1.7.2 and `NumPy` 2.4.6), and by ourselves in every variant.

use super::walker::Walker;
use super::{containers, largest_difference};
use gaitway::gait::import::{JointMap, Options, c3d, import_file, import_file_with, npz};
use gaitway::gait::{Joint, Recording, stride};
use glam::{Quat, Vec3};
use std::path::{Path, PathBuf};

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/gait/import/files").join(name)
}

/// The same walk in every file: this is its CSV.
fn known() -> Recording {
    import_file(&file("walk.csv")).unwrap().remove(0)
}

fn says(take: &Recording, line: &str) {
    assert!(take.report.iter().any(|l| l.contains(line)), "{:?} should say {line}", take.report);
}

#[test]
fn a_c3d_of_ezc3d_is_read_with_its_unit_axis_subject_and_gap() {
    let take = import_file(&file("ezc3d.c3d")).unwrap().remove(0);
    assert!(largest_difference(&known(), &take) < 2e-3, "{}", largest_difference(&known(), &take));
    assert_eq!(take.provenance.subject.as_deref(), Some("Anna"));
    assert!((take.frame_rate - 50.0).abs() < 1e-4);
    says(&take, "0.001");
    says(&take, "+z, turned to +y");
    says(&take, "4 positions bridged");
}

#[test]
fn arrays_of_numpy_are_read_in_any_order_and_type() {
    let takes = import_file(&file("numpy.npz")).unwrap();
    assert_eq!(takes.iter().map(|take| take.name.as_str()).collect::<Vec<_>>(), ["walk_f8", "walk_be"]);
    for take in &takes {
        assert!(largest_difference(&known(), take) < 1e-4);
        assert!((take.frame_rate - 50.0).abs() < 1e-4);
    }
    let takes = import_file(&file("named.npz")).unwrap();
    assert_eq!(takes.len(), 2);
    assert!(largest_difference(&known(), &takes[0]) < 1e-4);
    assert_eq!(takes[1].poses.len(), 40, "zeros at the end are padding");
    says(&takes[0], "joint map: gaitway");
    let take = import_file(&file("walk.npy")).unwrap().remove(0);
    assert!(largest_difference(&known(), &take) < 1e-4);
    says(&take, "assumed");
}

#[test]
fn the_17_joints_of_human36m_are_known_by_their_order() {
    let take = import_file(&file("h36m.npy")).unwrap().remove(0);
    says(&take, "Human3.6M 17");
    let known = known();
    for (a, b) in take.poses.iter().zip(&known.poses) {
        // The file has our neck as thorax and our head as nose.
        for joint in [Joint::Root, Joint::Neck, Joint::LeftHand, Joint::RightFoot, Joint::RightElbow] {
            assert!(a[joint as usize].distance(b[joint as usize]) < 1e-3, "{joint:?}");
        }
    }
}

#[test]
fn numbered_joints_go_by_a_map_of_numbers() {
    let text: String =
        Joint::ALL.iter().map(|joint| format!("{} = \"{}\"\n", joint.name(), *joint as usize)).collect();
    let options = Options { joint_map: Some(JointMap::parse(&text, "m").unwrap()), ..Options::default() };
    let take = import_file_with(&file("walk.npy"), &options).unwrap().remove(0);
    assert!(largest_difference(&known(), &take) < 1e-4);
    says(&take, "joint map: m");
}

#[test]
fn c3d_of_every_processor_integer_and_float_is_the_same_walk() {
    let walk = Walker::default().take(2.4, 60.0);
    for processor in [84, 85, 86] {
        for is_float in [true, false] {
            let bytes = containers::c3d(&walk, processor, is_float, "mm");
            let take = c3d::parse_c3d(&bytes, "w.c3d", &Options::default()).unwrap().remove(0);
            let off = largest_difference(&walk, &take);
            assert!(
                off < if is_float { 1e-5 } else { 2e-4 },
                "processor {processor}, float {is_float}: {off}"
            );
            assert!((take.frame_rate - 60.0).abs() < 1e-4);
            assert!(stride::best(&take).is_ok());
        }
    }
    let bytes = containers::c3d(&walk, 84, true, "furlong");
    let take = c3d::parse_c3d(&bytes, "w.c3d", &Options::default()).unwrap().remove(0);
    assert!(largest_difference(&walk, &take) < 1e-4);
    says(&take, "millimetres, inferred");
}

#[test]
fn broken_c3d_and_npz_are_refused_with_the_reason() {
    let walk = Walker::default().take(1.0, 30.0);
    let good = containers::c3d(&walk, 84, true, "mm");
    let with = |at: usize, bytes: &[u8]| {
        let mut bad = good.clone();
        bad[at..at + bytes.len()].copy_from_slice(bytes);
        bad
    };
    let label = good.windows(4).position(|w| w == b"head").unwrap();
    for (bytes, expected) in [
        (Vec::new(), "empty"),
        (with(1, &[0x51]), "0x50"),
        (with(0, &[200]), "block 200"),
        (with(515, &[3]), "processor type 3"),
        (good[..good.len() - 600].to_vec(), "of 30 frames; is it cut off?"),
        (with(label, b"heads"), "head"),
    ] {
        let message = c3d::parse_c3d(&bytes, "bad.c3d", &Options::default()).unwrap_err().to_string();
        assert!(
            message.starts_with("bad.c3d:0: ") && message.contains(expected),
            "{message} should say {expected}"
        );
    }
    for (bytes, expected) in [
        (b"PK\x03\x04 nothing".to_vec(), "no archive"),
        (
            containers::npz(&[("a", containers::npy("<f4", "(3, 5, 3)", &[0; 180]))], false),
            "5 joints without names",
        ),
        (
            containers::npz(&[("a", containers::npy("<f4", "(3,)", &[0; 12]))], false),
            "no array of joint positions",
        ),
        (
            containers::npz(&[("a", containers::npy("|O", "(3,)", &[0; 12]))], false),
            "no array of joint positions",
        ),
        (
            containers::npz(
                &[("a", containers::npy("<f4", "(1, 48)", &f32::NAN.to_le_bytes().repeat(48)))],
                false,
            ),
            "finite",
        ),
    ] {
        let message = npz::parse_npz(&bytes, "bad.npz", &Options::default()).unwrap_err().to_string();
        assert!(
            message.starts_with("bad.npz:0: ") && message.contains(expected),
            "{message} should say {expected}"
        );
    }
}

#[test]
fn an_archive_that_unpacks_to_a_thousand_times_its_size_is_refused() {
    let zeros = vec![0; 48 << 20];
    let bytes = containers::npz(&[("a", containers::npy("<f4", "(262144, 48)", &zeros))], true);
    assert!(bytes.len() < 1 << 20);
    let message = npz::parse_npz(&bytes, "bomb.npz", &Options::default()).unwrap_err().to_string();
    assert!(message.contains("unpacked"), "{message}");
}

#[test]
fn amass_rotations_pose_a_walker_that_strides() {
    // Legs and arms that swing about the sideways axis, knees that fold; z up as in AMASS, walking towards +x.
    let (rate, count, cycle) = (60.0_f32, 300, 1.1_f32);
    let (mut poses, mut trans) = (Vec::new(), Vec::new());
    for frame in 0..count {
        let t = frame as f32 / rate;
        let phase = std::f32::consts::TAU * t / cycle;
        let mut rotations = [Vec3::ZERO; 52];
        // Upright in a z-up world (a quarter turn about x, facing -y), then a quarter turn to the left.
        let quarter = std::f32::consts::FRAC_PI_2;
        rotations[0] = (Quat::from_rotation_z(quarter) * Quat::from_rotation_x(quarter)).to_scaled_axis();
        for (hip, knee, shoulder, sign) in [(1, 4, 16, 1.0_f32), (2, 5, 17, -1.0)] {
            rotations[hip] = Vec3::X * (-0.45 * sign * phase.cos());
            rotations[knee] = Vec3::X * (0.15 + 0.5 * (-sign * phase.sin()).max(0.0));
            // The arm hangs; both lie along x in the rest pose.
            rotations[shoulder] = Vec3::Z * (-sign * 1.4);
        }
        poses.extend(rotations.iter().flat_map(Vec3::to_array));
        trans.extend([1.1 * t, 0.0, 0.93]);
    }
    let bytes = |values: &[f32]| values.iter().flat_map(|v| f64::from(*v).to_le_bytes()).collect::<Vec<u8>>();
    let archive = containers::npz(
        &[
            ("poses", containers::npy("<f8", &format!("({count}, 156)"), &bytes(&poses))),
            ("trans", containers::npy("<f8", &format!("({count}, 3)"), &bytes(&trans))),
            ("mocap_framerate", containers::npy("<f8", "()", &bytes(&[rate]))),
            ("gender", containers::npy("<U4", "()", b"m\0\0\0a\0\0\0l\0\0\0e\0\0\0")),
            ("betas", containers::npy("<f8", "(16,)", &bytes(&[0.5; 16]))),
        ],
        true,
    );
    let take = npz::parse_npz(&archive, "walk_poses.npz", &Options::default()).unwrap().remove(0);
    says(&take, "AMASS");
    says(&take, "+z, turned to +y");
    says(&take, "left is left");
    says(&take, "straight towards +x");
    assert!((take.frame_rate - rate).abs() < 1e-4);
    for (frame, pose) in take.poses.iter().enumerate() {
        let angle = -0.45 * (std::f32::consts::TAU * frame as f32 / rate / cycle).cos();
        let thigh = pose[Joint::LeftKnee as usize] - pose[Joint::LeftHip as usize];
        // A turn about the sideways axis brings a hanging thigh forwards when it is negative.
        let expected = Vec3::new(-angle.sin(), -angle.cos(), 0.0) * thigh.length();
        assert!(thigh.distance(expected) < 1e-4, "frame {frame}: {thigh} is not {expected}");
    }
    let gait = stride::best(&take).unwrap();
    assert!((gait.cycle_time() - cycle).abs() < 0.05, "{}", gait.cycle_time());
    assert!((gait.speed - 1.1).abs() < 0.05, "{}", gait.speed);
    assert!(gait.poses.iter().all(|pose| pose[Joint::LeftFoot as usize].x > 0.02));
}

#[test]
fn markers_of_gait_analysis_become_a_walk() {
    // Markers around the joints of the analytic walker, where markers sit.
    let walker = Walker::default();
    let truth = walker.take(4.0, 60.0);
    let names = [
        "LFHD", "RFHD", "C7", "CLAV", "LSHO", "RSHO", "LELB", "RELB", "LWRA", "LWRB", "RWRA", "RWRB", "LASI",
        "RASI", "SACR", "LKNE", "RKNE", "LANK", "RANK",
    ];
    let frames: Vec<Vec<Vec3>> = truth
        .poses
        .iter()
        .map(|pose| {
            let at = |joint: Joint, x: f32, y: f32, z: f32| pose[joint as usize] + Vec3::new(x, y, z);
            vec![
                at(Joint::Head, 0.07, 0.0, 0.0),
                at(Joint::Head, -0.07, 0.0, 0.0),
                at(Joint::Neck, 0.0, 0.03, -0.06),
                at(Joint::Neck, 0.0, -0.03, 0.06),
                at(Joint::LeftShoulder, 0.0, 0.05, 0.0),
                at(Joint::RightShoulder, 0.0, 0.05, 0.0),
                at(Joint::LeftElbow, 0.03, 0.0, 0.0),
                at(Joint::RightElbow, -0.03, 0.0, 0.0),
                at(Joint::LeftHand, 0.02, 0.0, 0.02),
                at(Joint::LeftHand, -0.02, 0.0, -0.02),
                at(Joint::RightHand, 0.02, 0.0, 0.02),
                at(Joint::RightHand, -0.02, 0.0, -0.02),
                at(Joint::Root, 0.125, 0.03, 0.09),
                at(Joint::Root, -0.125, 0.03, 0.09),
                at(Joint::Root, 0.0, 0.04, -0.10),
                at(Joint::LeftKnee, 0.053, 0.0, 0.0),
                at(Joint::RightKnee, -0.053, 0.0, 0.0),
                at(Joint::LeftFoot, 0.04, 0.0, 0.0),
                at(Joint::RightFoot, -0.04, 0.0, 0.0),
            ]
        })
        .collect();
    let bytes = containers::c3d_points(&names.map(str::to_owned), &frames, 60.0, 84, true, "mm");
    let take = c3d::parse_c3d(&bytes, "markers.c3d", &Options::default()).unwrap().remove(0);
    says(&take, "19 markers");
    let off = |joint: Joint| {
        let pairs = take.poses.iter().zip(&truth.poses);
        pairs.map(|(a, b)| a[joint as usize].distance(b[joint as usize])).fold(0.0, f32::max)
    };
    for joint in [Joint::LeftKnee, Joint::RightFoot, Joint::LeftHand, Joint::Head, Joint::RightShoulder] {
        assert!(off(joint) < 0.02, "{joint:?} is off by {}", off(joint));
    }
    let gait = stride::best(&take).unwrap();
    assert!((gait.speed / walker.speed - 1.0).abs() < 0.02);
}

#[test]
fn every_built_in_rig_reads_a_walk_under_its_own_names() {
    let walk = Walker::default().take(2.0, 30.0);
    for rig in JointMap::known() {
        let map = JointMap::named(rig).unwrap();
        // A CSV with one joint for each name; places between joints get the walker's neighbours.
        let mut columns: Vec<(String, Joint)> = Vec::new();
        for (joint, parts) in Joint::ALL.iter().zip(&map.names) {
            for (name, _) in parts {
                if !columns.iter().any(|(other, _)| other == name) {
                    columns.push((name.clone(), *joint));
                }
            }
        }
        let header: Vec<String> =
            columns.iter().flat_map(|(n, _)| ["x", "y", "z"].map(|a| format!("{n}_{a}"))).collect();
        let mut text = header.join(",");
        for pose in &walk.poses {
            let row: Vec<String> = columns
                .iter()
                .flat_map(|(_, j)| pose[*j as usize].to_array().map(|v| v.to_string()))
                .collect();
            text += &format!("\n{}", row.join(","));
        }
        let options = Options { joint_map: Some(map), ..Options::default() };
        let take = gaitway::gait::import::csv::parse_csv(&text, "rig.csv", &options).unwrap().remove(0);
        for joint in [Joint::LeftFoot, Joint::RightKnee, Joint::LeftHand, Joint::RightHip] {
            let off = |(a, b): (&gaitway::gait::Pose, &gaitway::gait::Pose)| {
                a[joint as usize].distance(b[joint as usize])
            };
            let worst = take.poses.iter().zip(&walk.poses).map(off).fold(0.0, f32::max);
            assert!(worst < 1e-4, "{rig}: {joint:?} is off by {worst}");
        }
    }
}

#[test]
fn headings_are_reported_and_a_crab_is_warned_of() {
    let walk = Walker { heading: std::f32::consts::FRAC_PI_2, ..Walker::default() }.take(3.0, 60.0);
    let read = |take: &Recording| {
        let bytes = containers::c3d(take, 84, true, "mm");
        c3d::parse_c3d(&bytes, "w.c3d", &Options::default()).unwrap().remove(0)
    };
    says(&read(&walk), "straight towards +x");
    let mut crab = walk.clone();
    for pose in &mut crab.poses {
        let root = pose[0];
        pose.iter_mut().for_each(|p| *p = root + Quat::from_rotation_y(1.2) * (*p - root));
    }
    says(&read(&crab), "warning: walks towards +x but faces");
}

#[test]
fn every_subject_of_a_c3d_is_a_take_of_its_own() {
    let (anna, ben) =
        (Walker::default().take(3.0, 60.0), Walker { speed: 0.9, ..Walker::default() }.take(3.0, 60.0));
    let names: Vec<String> = ["Anna", "Ben", "Stick"]
        .iter()
        .flat_map(|who| Joint::ALL.map(|j| format!("{who}:{}", j.name())))
        .collect();
    let frames: Vec<Vec<Vec3>> = anna
        .poses
        .iter()
        .zip(&ben.poses)
        .map(|(a, b)| a.iter().chain(b).copied().chain([Vec3::ZERO; 16]).collect())
        .collect();
    let cut = &names[..40];
    let frames: Vec<Vec<Vec3>> = frames.iter().map(|frame| frame[..40].to_vec()).collect();
    let bytes = containers::c3d_points(cut, &frames, 60.0, 84, true, "mm");
    let takes = c3d::parse_c3d(&bytes, "pair.c3d", &Options::default()).unwrap();
    let who: Vec<_> =
        takes.iter().map(|take| (take.name.as_str(), take.provenance.subject.as_deref())).collect();
    assert_eq!(who, [("pair-Anna", Some("Anna")), ("pair-Ben", Some("Ben"))]);
    assert!(largest_difference(&ben, &takes[1]) < 1e-5);
}

#[test]
fn a_long_gap_cuts_the_take_and_a_short_one_is_bridged() {
    let walk = Walker::default().take(3.0, 60.0);
    let names = Joint::ALL.map(|joint| joint.name().to_owned());
    let mut frames: Vec<Vec<Vec3>> = walk.poses.iter().map(|pose| pose.to_vec()).collect();
    for frame in frames.iter_mut().take(40).skip(20) {
        frame[Joint::LeftHand as usize] = Vec3::ZERO;
    }
    for frame in frames.iter_mut().take(106).skip(100) {
        frame[Joint::Head as usize] = Vec3::ZERO;
    }
    let bytes = containers::c3d_points(&names, &frames, 60.0, 84, true, "mm");
    let take = c3d::parse_c3d(&bytes, "gaps.c3d", &Options::default()).unwrap().remove(0);
    says(&take, "6 positions bridged");
    says(&take, "frames 41 to 180 of 180");
    let off = take
        .poses
        .iter()
        .zip(&walk.poses[40..])
        .flat_map(|(a, b)| a.iter().zip(b))
        .map(|(a, b)| a.distance(*b));
    let worst = off.fold(0.0, f32::max);
    assert!(worst < 2e-3, "bridged within {worst} m");
}
