//! Motion files in, gaits out: formats, faults, strides of a walker known exactly, and real data where present.

mod cli;
mod containers;
mod data;
mod formats;
mod legs;
mod movements;
mod strikes;
mod walker;
mod walking;

use gaitway::gait::import::{self, JointMap, Options, asf_amc, bvh, csv};
use gaitway::gait::{Error, Joint, Recording, stride};
use glam::{Quat, Vec3};
use walker::Walker;

fn largest_difference(a: &Recording, b: &Recording) -> f32 {
    assert_eq!(a.poses.len(), b.poses.len());
    a.poses.iter().flatten().zip(b.poses.iter().flatten()).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max)
}

#[test]
fn a_bvh_of_any_rotation_order_in_centimetres_gives_the_walker_back() {
    let take = Walker::default().take(2.0, 30.0);
    for (scale, unit) in [(100.0, "centimetres"), (1.0, "metres"), (1.0 / 0.0254, "inches")] {
        let read = bvh::parse_bvh(&walker::bvh(&take, scale), "walker.bvh", &Options::default()).unwrap();
        assert!(largest_difference(&take, &read) < 1e-4, "{unit}");
        assert!(read.report.iter().any(|line| line.contains(unit)), "{:?}", read.report);
        assert!((read.frame_rate - 30.0).abs() < 1e-3);
        assert_eq!(read.name, "walker");
    }
}

#[test]
fn z_up_files_are_turned_to_y_up_and_stay_right_handed() {
    let take = Walker::default().take(2.0, 30.0);
    let mut z_up = take.clone();
    for point in z_up.poses.iter_mut().flatten() {
        *point = Vec3::new(point.x, -point.z, point.y);
    }
    let read = bvh::parse_bvh(&walker::bvh(&z_up, 100.0), "z.bvh", &Options::default()).unwrap();
    assert!(largest_difference(&take, &read) < 1e-4);
    assert!(read.report.iter().any(|line| line.contains("+z")), "{:?}", read.report);
}

#[test]
fn left_is_left_even_where_the_file_says_right() {
    // A person facing +z has the left hand at +x.
    let take = Walker::default().take(2.0, 30.0);
    assert!(take.poses[0][Joint::LeftHand as usize].x > 0.0);
    let text = walker::csv(&[&take], 1.0);
    let exchanged = text.replace(",l_", ",?_").replace(",r_", ",l_").replace(",?_", ",r_");
    for (text, line) in [(&text, "left is left"), (&exchanged, "joints swapped")] {
        let read = csv::parse_csv(text, "walker.csv", &Options::default()).unwrap().remove(0);
        assert!(largest_difference(&take, &read) < 1e-4, "{line}");
        assert!(read.report.iter().any(|l| l.contains(line)), "{:?}", read.report);
    }
    for gait in stride::extract(&Walker { heading: 2.0, ..Walker::default() }.take(5.0, 60.0)).unwrap() {
        assert!(gait.poses.iter().all(|pose| pose[Joint::LeftHand as usize].x > 0.1));
    }
}

#[test]
fn a_csv_holds_several_takes_and_bare_numbers_are_egait_right_side_first() {
    let one = Recording { name: "one".into(), ..Walker::default().take(1.0, 30.0) };
    let two = Recording { name: "two".into(), ..Walker { speed: 0.8, ..Walker::default() }.take(1.2, 30.0) };
    let read = csv::parse_csv(&walker::csv(&[&one, &two], 1.0), "a.csv", &Options::default()).unwrap();
    assert_eq!(read.iter().map(|take| take.name.as_str()).collect::<Vec<_>>(), ["one", "two"]);
    assert!(largest_difference(&two, &read[1]) < 1e-5);

    let mut bare = String::new();
    for pose in &one.poses {
        let right_first = Joint::ALL.map(|joint| pose[joint.mirrored() as usize].to_array());
        let row: Vec<String> = right_first.iter().flatten().map(f32::to_string).collect();
        bare += &(row.join(" ") + "\n");
    }
    let read = csv::parse_csv(&bare, "a.txt", &Options::default()).unwrap().remove(0);
    assert!(largest_difference(&one, &read) < 1e-5);
    assert!(read.report.iter().any(|line| line.contains("left is left")), "{:?}", read.report);
}

#[test]
fn an_acclaim_bone_turns_in_its_own_axis_frame_and_units_are_cmus() {
    let skeleton = asf_amc::parse_asf(&walker::asf(), "a.asf").unwrap();
    let text = walker::amc(3, |frame| 30.0 * frame as f32);
    let read = asf_amc::parse_amc(&text, "a.amc", &skeleton, &Options::default()).unwrap();
    let unit = 0.0254 / 0.45;
    // Axis frame 90 degrees about y: its z is the world's x; +rz swings a hanging leg backwards (y to z).
    for (frame, pose) in read.poses.iter().enumerate() {
        let swing = Quat::from_rotation_x((30.0 * frame as f32).to_radians());
        let thigh = pose[Joint::LeftKnee as usize] - pose[Joint::LeftHip as usize];
        assert!(thigh.distance(swing * Vec3::new(0.0, -7.0 * unit, 0.0)) < 1e-5, "{frame}: {thigh}");
    }
    assert!((read.poses[2][0] - Vec3::new(0.0, 15.0, 0.2) * unit).length() < 1e-5);
    assert!(read.poses[0][Joint::LeftHand as usize].x > 0.3);
    assert!((read.frame_rate - 120.0).abs() < 1e-6);
}

#[test]
fn strikes_speed_and_phase_of_a_known_walker_are_found() {
    for rate in [30.0, 60.0, 120.0] {
        for heading in [0.0, 2.5] {
            let walker = Walker { heading, ..Walker::default() };
            let take = walker.take(5.0, rate);
            let strides = stride::strides(&take).unwrap();
            assert_eq!(strides.len(), 4, "rate {rate}");
            for (k, found) in strides.iter().enumerate() {
                let strike = walker.first_strike + k as f32 * walker.cycle;
                let off = found.begin - strike;
                assert!(off.abs() < 0.03, "rate {rate}: strike {k} is off by {off} s");
                assert!((found.duration - walker.cycle).abs() < 0.012, "{}", found.duration);
                assert!((found.gait.speed / walker.speed - 1.0).abs() < 0.01, "{}", found.gait.speed);
                check_gait(&found.gait);
            }
        }
    }
}

/// What every gait promises: on the spot, towards +z, on the ground, closed, left strike first.
fn check_gait(gait: &gaitway::gait::Gait) {
    let count = gait.poses.len();
    let mean: Vec3 = gait.poses.iter().map(|pose| pose[0]).sum::<Vec3>() / count as f32;
    assert!(mean.x.abs() < 1e-3 && mean.z.abs() < 1e-3, "{}: {mean}", gait.name);
    let feet = |joint: Joint| gait.poses.iter().map(move |pose| pose[joint as usize]);
    let lowest = feet(Joint::LeftFoot).chain(feet(Joint::RightFoot)).map(|p| p.y).fold(f32::MAX, f32::min);
    assert!(lowest.abs() < 1e-4, "{}: lowest {lowest}", gait.name);
    let reach = |i: usize| gait.poses[i][Joint::LeftFoot as usize].z;
    let furthest = (0..count).max_by(|&a, &b| reach(a).total_cmp(&reach(b))).unwrap();
    let phase = furthest as f32 / count as f32;
    assert!(!(0.15..0.80).contains(&phase), "{}: left foot furthest at phase {phase}", gait.name);
    // The step over the seam is no larger than the largest inside.
    let step = |a: usize, b: usize| {
        gait.poses[a].iter().zip(&gait.poses[b]).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max)
    };
    let inside = (1..count).map(|i| step(i - 1, i)).fold(0.0, f32::max);
    assert!(step(count - 1, 0) < 1.3 * inside, "{}: seam {} inside {inside}", gait.name, step(count - 1, 0));
}

#[test]
fn a_walker_on_the_spot_gets_its_speed_from_the_planted_foot() {
    let walker = Walker::default();
    let mut treadmill = walker.take(5.0, 60.0);
    for (i, pose) in treadmill.poses.iter_mut().enumerate() {
        for point in pose {
            point.z -= walker.speed * i as f32 / 60.0;
        }
    }
    let gait = stride::best(&treadmill).unwrap();
    assert!((gait.speed / walker.speed - 1.0).abs() < 0.03, "{}", gait.speed);
    assert!(gait.provenance.to_string().contains("on the spot"), "{}", gait.provenance);
}

#[test]
fn one_pinned_cycle_from_anywhere_becomes_one_gait() {
    let walker = Walker { cycle: 1.2, ..Walker::default() };
    for start in [0.0, 0.4, 0.9] {
        let mut cycle = Walker { first_strike: start, ..walker }.take(1.2 - 0.01, 30.0);
        for pose in &mut cycle.poses {
            let root = pose[0];
            pose.iter_mut().for_each(|point| *point -= root);
        }
        cycle.cyclic = true;
        let strides = stride::strides(&cycle).unwrap();
        assert_eq!(strides.len(), 1);
        let gait = &strides[0].gait;
        assert_eq!(gait.poses.len(), 36);
        assert!((gait.speed / walker.speed - 1.0).abs() < 0.06, "{start}: {}", gait.speed);
        let heights = gait.poses.iter().map(|pose| pose[0].y);
        let bounce = heights.clone().fold(f32::MIN, f32::max) - heights.fold(f32::MAX, f32::min);
        assert!((0.02..0.08).contains(&bounce), "{bounce}");
        check_gait(gait);
    }
}

#[test]
fn egait_files_are_levelled_scaled_and_closed_whichever_way_they_face() {
    let walker = Walker { cycle: 1.2, ..Walker::default() };
    let unit = 1.32;
    for heading in [0.0, std::f32::consts::PI] {
        let truth = Walker { heading, ..walker }.take(1.19, 30.0);
        let mut file = truth.clone();
        for pose in &mut file.poses {
            let root = pose[0];
            pose.iter_mut().for_each(|p| *p = Quat::from_rotation_x(-12.1_f32.to_radians()) * (*p - root));
        }
        let read =
            csv::parse_csv(&walker::csv(&[&file], 1.0 / unit), "gaits.csv", &Options::default()).unwrap();
        assert!(read[0].cyclic && read[0].report.iter().any(|line| line.contains("levelled")));
        let known = truth.poses.iter().map(|pose| pose.map(|p| p - pose[0]));
        let off = read[0].poses.iter().flatten().zip(known.flatten()).map(|(p, q)| p.distance(q));
        assert!(off.fold(0.0, f32::max) < 1e-4, "{:?}", read[0].report);
        check_gait(&stride::best(&read[0]).unwrap());
    }
}

#[test]
fn egait_gaits_with_left_and_right_exchanged_come_out_as_those_without() {
    let truth = Walker { cycle: 1.2, ..Walker::default() }.take(1.19, 30.0);
    let mut file = truth.clone();
    for pose in &mut file.poses {
        let root = pose[0];
        pose.iter_mut().for_each(|p| *p = Quat::from_rotation_x(-12.1_f32.to_radians()) * (*p - root));
    }
    let mut exchanged = file.clone();
    for (pose, original) in exchanged.poses.iter_mut().zip(&file.poses) {
        for joint in Joint::ALL {
            pose[joint as usize] = original[joint.mirrored() as usize];
        }
    }
    let read = |file: &Recording, options: &Options| {
        csv::parse_csv(&walker::csv(&[file], 1.0 / 1.32), "gaits.csv", options).unwrap().remove(0)
    };
    let [one, other] = [&file, &exchanged].map(|file| read(file, &Options::default()));
    let says = |take: &Recording, words: &str| take.report.iter().any(|line| line.contains(words));
    assert!(says(&one, "left is left") && says(&other, "joints swapped"));
    assert_eq!(one.poses, other.poses, "the same walk, bit for bit");
    assert_eq!(stride::best(&one).unwrap().poses, stride::best(&other).unwrap().poses);
    // as published, nothing is repaired
    let published = Options { as_published: true, ..Options::default() };
    let [one, other] = [&file, &exchanged].map(|file| read(file, &published));
    assert!(one.cyclic && says(&one, "as published"));
    assert_eq!(one.poses[3][Joint::LeftHand as usize], other.poses[3][Joint::RightHand as usize]);
    let rise = one.poses[0][Joint::Head as usize];
    assert!(rise.z < -0.15 * rise.y, "still pitched: {rise}");
}

#[test]
fn what_does_not_repeat_is_spread_over_the_cycle() {
    let mut take = Walker::default().take(5.0, 60.0);
    for (i, pose) in take.poses.iter_mut().enumerate() {
        // Arms that rise by 10 cm a second.
        pose[Joint::LeftHand as usize].y += 0.1 * i as f32 / 60.0;
    }
    for found in stride::strides(&take).unwrap() {
        let hand = |i: usize| found.gait.poses[i][Joint::LeftHand as usize].y;
        let seam = (hand(0) - hand(found.gait.poses.len() - 1)).abs();
        assert!(seam < 0.01, "{seam}");
        assert!((found.mismatch - 0.11 / 4.0).abs() < 0.005, "{}", found.mismatch);
    }
}

#[test]
fn a_gentle_curve_is_followed_and_named_a_sharp_one_refused() {
    let curved = |degrees: f32| Walker { turn: degrees.to_radians(), ..Walker::default() }.take(5.0, 60.0);
    for degrees in [-15.0, 15.0] {
        let strides = stride::strides(&curved(degrees)).unwrap();
        for found in &strides {
            assert!((found.turn.to_degrees() - degrees).abs() < 1.5, "{}", found.turn.to_degrees());
            assert!((found.gait.speed / 1.2 - 1.0).abs() < 0.02, "{}", found.gait.speed);
            assert!(found.gait.provenance.to_string().contains("curved"), "{}", found.gait.provenance);
            assert!(found.mismatch < 0.03, "{}", found.mismatch);
            check_gait(&found.gait);
        }
    }
    let message = stride::extract(&curved(40.0)).unwrap_err().to_string();
    assert!(message.contains("turns by 4") || message.contains("turns by 3"), "{message}");
}

#[test]
fn standing_and_walking_backwards_are_refused_with_the_reason() {
    let walker = Walker::default();
    let still = Recording::new("still", 60.0, vec![walker.pose(0.0); 300]);
    assert!(stride::extract(&still).unwrap_err().to_string().contains("no straight stride"));
    let mut backwards = walker.take(5.0, 60.0);
    backwards.poses.reverse();
    let message = stride::extract(&backwards).unwrap_err().to_string();
    assert!(message.contains("off the way it faces") || message.contains("no straight"), "{message}");
    let nan = Recording::new("nan", 60.0, vec![[Vec3::NAN; 16]; 100]);
    assert!(stride::extract(&nan).unwrap_err().to_string().contains("not finite"));
}

#[test]
fn faults_are_named_with_file_and_line() {
    let take = Walker::default().take(1.0, 30.0);
    let good = walker::bvh(&take, 100.0);
    let frames = format!("Frames: {}", take.poses.len());
    let last = good.trim_end().rfind('\n').unwrap();
    let cases = [
        ("", "HIERARCHY"),
        (&good[..good.len() / 2], "frame"),
        (&good[..last], "cut off"),
        (&good.replace(&frames, "Frames: 4000000000"), "4000000000"),
        (&good.replace(&frames, "Frames: 3"), "more lines follow"),
        (&good.replace("Xposition", "Wposition"), "unknown channel"),
        (&good.replacen("CHANNELS 6", "CHANNELS 7", 1), "0 to 6"),
        (&good.replacen("OFFSET 9", "OFFSET NaN", 1), "finite"),
        (&good.replace("MOTION", "MOTOIN"), "does not belong"),
        (&good.replace("Frame Time: 0.0", "Frame Time: -0.0"), "1 to 2000 Hz"),
        (&good.replace("left_knee", "middle_knee"), "left_knee"),
        ("HIERARCHY\nROOT a\n{\n", "file ends"),
    ];
    for (text, expected) in cases {
        let error = bvh::parse_bvh(text, "bad.bvh", &Options::default()).unwrap_err();
        assert!(matches!(error, Error::Syntax { .. }), "{error}");
        let message = error.to_string();
        assert!(
            message.starts_with("bad.bvh:") && message.contains(expected),
            "{message} should say {expected}"
        );
    }
    let asf = walker::asf();
    for (text, expected) in [
        (asf.replace("root upperback", "head upperback"), "cycle"),
        (asf.replace("upperback lowerneck", "nowhere lowerneck"), "nowhere"),
        (asf.replace(":hierarchy", ":hier"), ":hierarchy is missing"),
        (asf.replace("dof rx ry rz", "dof rx rw"), "rw"),
        (asf[..asf.len() / 3].to_owned(), "cut off"),
    ] {
        let message = asf_amc::parse_asf(&text, "bad.asf").unwrap_err().to_string();
        assert!(
            message.starts_with("bad.asf:") && message.contains(expected),
            "{message} should say {expected}"
        );
    }
    let skeleton = asf_amc::parse_asf(&asf, "a.asf").unwrap();
    let amc = walker::amc(4, |_| 0.0);
    for (text, expected) in [
        (amc.replacen("lfemur 0 0 0", "lfemur 0 0", 1), "2 values"),
        (amc.replacen("lfemur", "lfemurr", 1), "lfemurr"),
        (amc[..amc.len() - 40].to_owned(), "cut off"),
        (":DEGREES\n".to_owned(), "no frames"),
    ] {
        let error = asf_amc::parse_amc(&text, "bad.amc", &skeleton, &Options::default()).unwrap_err();
        assert!(error.to_string().contains(expected), "{error} should say {expected}");
    }
    let csv_text = walker::csv(&[&take], 1.0);
    for (text, expected) in [
        (csv_text.replace("head_y", "hat_y"), "head"),
        (csv_text.replacen("\nwalker,3,", "\nwalker,3,7,", 1), "51 cells"),
        (csv_text.replacen("\nwalker,3,", "\nwalker,3,x", 1), "number was expected"),
        (csv_text.replacen("\nwalker,3,", "\nother,3,", 1), "together"),
        (csv_text.lines().next().unwrap().to_owned(), "no rows"),
        ("index,key,label\n0,a,happy\n".to_owned(), "no columns of joint positions"),
    ] {
        let message = csv::parse_csv(&text, "bad.csv", &Options::default()).unwrap_err().to_string();
        assert!(
            message.starts_with("bad.csv:") && message.contains(expected),
            "{message} should say {expected}"
        );
    }
}

#[test]
fn quoted_cells_of_a_csv_hold_separators_and_line_ends_and_what_is_wrong_behind_them_has_its_line() {
    let take = Recording { name: "\"Ann, \"\"A\"\"\nslow\"".into(), ..Walker::default().take(0.2, 30.0) };
    let text = walker::csv(&[&take], 1.0).replacen("key,frame", "# of \"Ann\n\n\"key\", \"frame, of it\"", 1);
    let read = |text: &str| csv::parse_csv(text, "a.csv", &Options::default());
    for end in ["\n", "\r\n", "\r"] {
        let text = text.replace('\n', end);
        let found = read(&text).unwrap().remove(0);
        assert_eq!((found.name.as_str(), found.poses.len()), (format!("Ann, \"A\"{end}slow").as_str(), 6));
        // a header in line 3, and two lines for each row
        for (row, wrong, line, why) in [
            ("slow\",3,", "slow\",3,x", 10, "number was expected"),
            ("slow\",5,", "slow\",\"5,", 15, "a quote is opened and never closed"),
            ("slow\",4,", "slow\",4,4,", 12, "51 cells; the header has 50"),
        ] {
            let said = read(&text.replacen(row, wrong, 1)).unwrap_err().to_string();
            assert!(said.starts_with(&format!("a.csv:{line}: ")) && said.contains(why), "{end:?}: {said}");
        }
    }
    let timed = walker::csv(&[&take], 1.0).replacen(",frame,", ",time,", 1).replace("slow\",5,", "slow\",4,");
    let said = read(&timed).unwrap_err().to_string();
    assert!(said.starts_with("a.csv:12: time does not increase after 4 s"), "{said}");
}

#[test]
fn files_are_dispatched_by_extension_and_options_hold() {
    let folder = tempfile::tempdir().unwrap();
    let take = Walker::default().take(4.0, 60.0);
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let path = write("w_01.BVH", &walker::bvh(&take, 7.0));
    write("labels.csv", "file,subject,style,perceived_label\nw_01.BVH,s7,proud,happy\n");
    let options = Options { metres_per_unit: Some(1.0 / 7.0), ..Options::default() };
    let read = import::import_file_with(&path, &options).unwrap().remove(0);
    assert!(largest_difference(&take, &read) < 1e-4);
    let gait = stride::best(&read).unwrap();
    assert_eq!((gait.provenance.subject.as_deref(), gait.acted.as_deref()), (Some("s7"), Some("proud")));
    assert_eq!(gait.label, Some(gaitway::Emotion::Happy));
    let map = JointMap { rig: "mine".into(), names: std::array::from_fn(|_| vec![("root".into(), 1.0)]) };
    let options = Options { joint_map: Some(map), ..Options::default() };
    assert!(import::import_file_with(&path, &options).unwrap_err().to_string().contains("fall together"));

    write("35.asf", &walker::asf());
    let amc = write("35_01.amc", &walker::amc(5, |_| 0.0));
    assert_eq!(import::import_file(&amc).unwrap()[0].poses.len(), 5);
    assert!(import::import_file(&folder.path().join("35.asf")).unwrap_err().to_string().contains(".amc"));
    std::fs::remove_file(folder.path().join("35.asf")).unwrap();
    assert!(import::import_file(&amc).unwrap_err().to_string().contains("35.asf"));
    assert!(import::import_file(&write("x.fbx", "")).unwrap_err().to_string().contains("fbx"));
    assert!(matches!(import::import_file(&folder.path().join("no.bvh")), Err(Error::Read { .. })));
}

#[test]
fn single_takes_are_of_the_data_set_of_their_folder_and_tables_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let mocap = folder.path().join("mocap");
    std::fs::create_dir(&mocap).unwrap();
    let take = Walker::default().take(4.0, 60.0);
    std::fs::write(mocap.join("w_01.bvh"), walker::bvh(&take, 7.0)).unwrap();
    let [a, b] = ["a", "b"].map(|name| Recording { name: name.to_owned(), ..take.clone() });
    std::fs::write(mocap.join("many.csv"), walker::csv(&[&a, &b], 1.0)).unwrap();
    let of = |path: &std::path::Path| -> Vec<[String; 4]> {
        let takes = import::import_file(path).unwrap().into_iter().map(|take| take.provenance);
        takes.map(|of| [of.dataset, of.file, of.format, of.take]).collect()
    };
    assert_eq!(of(&mocap.join("w_01.bvh")), [["mocap", "w_01.bvh", "BVH", "w_01"]]);
    // the folder's name is not in the path
    assert_eq!(of(&mocap.join("../mocap/./w_01.bvh"))[0][0], "mocap");
    let two = [["many", "many.csv", "CSV", "a"], ["many", "many.csv", "CSV", "b"]];
    assert_eq!(of(&mocap.join("many.csv")), two);
}
