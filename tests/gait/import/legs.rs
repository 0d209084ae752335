//! Captures of the legs alone, and TRC: markers that are there, that are lost, that never were.

use super::containers;
use super::walker::Walker;
use gaitway::Emotion;
use gaitway::gait::import::{Options, c3d, csv, import_file, trc};
use gaitway::gait::walker::{Sex, WalkerStyle, walk};
use gaitway::gait::{Gait, Joint, JointSet, Pose, Recording, stride};
use gaitway::library::GaitLibrary;
use glam::Vec3;

/// The markers of Plug-in Gait's lower body around the joints of a walker towards +z.
pub(crate) fn lower_body(truth: &Recording) -> (Vec<String>, Vec<Vec<Vec3>>) {
    const MARKERS: [(&str, Joint, [f32; 3]); 14] = [
        ("LASI", Joint::Root, [0.125, 0.03, 0.09]),
        ("RASI", Joint::Root, [-0.125, 0.03, 0.09]),
        ("LPSI", Joint::Root, [0.05, 0.04, -0.10]),
        ("RPSI", Joint::Root, [-0.05, 0.04, -0.10]),
        ("LTHI", Joint::LeftHip, [0.1, -0.2, 0.0]),
        ("RTHI", Joint::RightHip, [-0.1, -0.2, 0.0]),
        ("LKNE", Joint::LeftKnee, [0.053, 0.0, 0.0]),
        ("RKNE", Joint::RightKnee, [-0.053, 0.0, 0.0]),
        ("LANK", Joint::LeftFoot, [0.04, 0.0, 0.0]),
        ("RANK", Joint::RightFoot, [-0.04, 0.0, 0.0]),
        ("LHEE", Joint::LeftFoot, [0.0, -0.05, -0.06]),
        ("RHEE", Joint::RightFoot, [0.0, -0.05, -0.06]),
        ("LTOE", Joint::LeftFoot, [0.0, -0.06, 0.14]),
        ("RTOE", Joint::RightFoot, [0.0, -0.06, 0.14]),
    ];
    let frame = |pose: &Pose| {
        MARKERS.iter().map(|(_, joint, offset)| pose[*joint as usize] + Vec3::from_array(*offset)).collect()
    };
    (MARKERS.iter().map(|(name, ..)| (*name).to_owned()).collect(), truth.poses.iter().map(frame).collect())
}

fn upper_body() -> JointSet {
    Joint::UPPER_BODY.into_iter().collect()
}

fn says(take: &Recording, line: &str) {
    assert!(take.report.iter().any(|l| l.contains(line)), "{:?} should say {line}", take.report);
}

/// What a gait of the legs promises: the walker's legs under the norm's upper body.
fn check_legs(gait: &Gait, truth: &Walker) {
    assert_eq!(gait.missing, upper_body());
    assert!((gait.speed / truth.speed - 1.0).abs() < 0.03, "{}", gait.speed);
    super::check_gait(gait);
    let message = gait.check_whole().unwrap_err().to_string();
    assert!(message.contains("not captured: spine, neck, head, left_shoulder"), "{message}");
    // The neutral walker's trunk over legs of 2 x 0.46 m, whose hands swing against the feet.
    let norm =
        [Sex::Female, Sex::Male].map(|sex| walk(&WalkerStyle::preset(Emotion::Neutral, sex), "n").unwrap());
    let leg = |pose: &Pose| {
        pose[Joint::LeftHip as usize].distance(pose[Joint::LeftKnee as usize])
            + pose[Joint::LeftKnee as usize].distance(pose[Joint::LeftFoot as usize])
    };
    let trunk = |pose: &Pose| pose[Joint::Head as usize].distance(pose[Joint::Root as usize]) / leg(pose);
    let known = (trunk(&norm[0].poses[0]) + trunk(&norm[1].poses[0])) / 2.0;
    for pose in &gait.poses {
        assert!((trunk(pose) / known - 1.0).abs() < 0.1, "{} of {known}", trunk(pose));
        assert!(pose[Joint::LeftHand as usize].x > 0.1 && pose[Joint::RightHand as usize].x < -0.1);
    }
    let half = gait.poses.len() / 2;
    let swing = |frame: usize| (gait.poses[frame][Joint::LeftHand as usize] - gait.poses[frame][0]).z;
    assert!(swing(0) + 0.1 < swing(half), "the left hand is back when the left foot strikes");
}

#[test]
fn a_c3d_of_the_lower_body_walks_with_the_upper_body_of_the_norm() {
    let walker = Walker::default();
    let (names, frames) = lower_body(&walker.take(4.0, 60.0));
    let bytes = containers::c3d_points(&names, &frames, 60.0, 84, true, "mm");
    let take = c3d::parse_c3d(&bytes, "legs.c3d", &Options::default()).unwrap().remove(0);
    assert_eq!(take.missing, upper_body());
    says(&take, "8 markers of gait analysis");
    says(&take, "warning: not captured: spine, neck, head");
    says(&take, "+z, turned to +y");
    says(&take, "left is left");
    let gait = stride::best(&take).unwrap();
    check_legs(&gait, &walker);
    // Without a unit in the file, the size of the legs gives it.
    let bytes = containers::c3d_points(&names, &frames, 60.0, 84, true, "?");
    let take = c3d::parse_c3d(&bytes, "legs.c3d", &Options::default()).unwrap().remove(0);
    says(&take, "millimetres, inferred");
}

#[test]
fn named_joints_of_the_legs_will_do_but_some_of_the_upper_body_asks_for_a_map() {
    let walker = Walker::default();
    let text = super::walker::csv(&[&walker.take(4.0, 60.0)], 1.0);
    let without = |joints: &[Joint]| {
        let mut text = text.clone();
        for joint in joints {
            let name = joint.name().replace("left_", "l_").replace("right_", "r_");
            text = text.replace(&format!(",{name}_x,{name}_y,{name}_z"), ",?a,?b,?c");
        }
        csv::parse_csv(&text, "legs.csv", &Options { frame_rate: Some(60.0), ..Options::default() })
    };
    let take = without(&Joint::UPPER_BODY).unwrap().remove(0);
    check_legs(&stride::best(&take).unwrap(), &walker);
    let message = without(&[Joint::Head, Joint::LeftHand]).unwrap_err().to_string();
    assert!(
        message.contains("2 of the 16 joints not found") && message.contains("head, left_hand"),
        "{message}"
    );
    let message = without(&[Joint::LeftKnee]).unwrap_err().to_string();
    assert!(message.contains("left_knee"), "{message}");
}

#[test]
fn a_library_keeps_which_joints_are_missing() {
    let walker = Walker::default();
    let (names, frames) = lower_body(&walker.take(4.0, 60.0));
    let bytes = containers::c3d_points(&names, &frames, 60.0, 84, true, "mm");
    let take = c3d::parse_c3d(&bytes, "legs.c3d", &Options::default()).unwrap().remove(0);
    let gait = stride::best(&take).unwrap();
    let file = GaitLibrary::from_gaits(vec![gait.clone()]).unwrap().to_glb_bytes();
    let read = GaitLibrary::from_glb_bytes(&file, "legs.glb").unwrap();
    assert_eq!(read.gaits(), [gait]);
    // The same number of letters, so that the file stays whole.
    let at = file.windows(6).position(|word| word == b"\"neck\"").unwrap();
    let at = at + 6 + file[at + 6..].windows(6).position(|word| word == b"\"neck\"").unwrap_or(0);
    let mut bad = file.clone();
    for (index, _) in file.windows(6).enumerate().filter(|(index, word)| *index >= at && *word == b"\"neck\"")
    {
        bad[index + 1..index + 5].copy_from_slice(b"nose");
    }
    let message = GaitLibrary::from_glb_bytes(&bad, "legs.glb").unwrap_err().to_string();
    assert!(message.contains("nose"), "{message}");
}

fn seen(frames: &[Vec<Vec3>]) -> Vec<Vec<Option<Vec3>>> {
    frames.iter().map(|frame| frame.iter().map(|point| Some(*point)).collect()).collect()
}

fn read_trc(text: &str) -> Result<Recording, String> {
    let takes = trc::parse_trc(text, "walk.trc", &Options::default());
    takes.map(|mut takes| takes.remove(0)).map_err(|error| error.to_string())
}

#[test]
fn trc_is_read_in_every_dress() {
    let walker = Walker::default();
    let truth = walker.take(4.0, 60.0);
    let (names, frames) = lower_body(&truth);
    let mm = containers::trc(&names, &seen(&frames), 60.0, "mm");
    let metres = containers::trc(&names, &seen(&frames), 60.0, "m");
    let known = read_trc(&mm).unwrap();
    says(&known, "TRC: 14 markers, 240 frames, mm");
    says(&known, "gaps: none");
    assert!((known.frame_rate - 60.0).abs() < 1e-3);
    check_legs(&stride::best(&known).unwrap(), &walker);

    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("walk.TRC"), &mm).unwrap();
    let named = import_file(&folder.path().join("walk.TRC")).unwrap().remove(0);
    assert_eq!((named.name.as_str(), &named.poses), ("walk", &known.poses));

    let axes_gone: String = mm
        .lines()
        .filter(|line| !line.trim_start().starts_with('X'))
        .map(|line| format!("{line}\n"))
        .collect();
    for (what, text) in [
        ("metres", metres),
        ("CRLF", mm.replace('\n', "\r\n")),
        ("a byte order mark", format!("\u{feff}{mm}")),
        ("tabs at the ends", mm.replace('\n', "\t\n")),
        ("no blank line", mm.replace("\n\n", "\n")),
        ("no axes", axes_gone),
        ("blanks instead of tabs", mm.replace("\t\t\t", "\t").replace('\t', "  ")),
        ("no rate in the header", mm.replacen("60\t60\t", "0\t60\t", 1)),
        (
            "prefixes",
            mm.replace("LASI", "Anna:LASI")
                .replace("RASI", "Anna:RASI")
                .replace("\tLP", "\tAnna:LP")
                .replace("\tRP", "\tAnna:RP")
                .replace("\tLK", "\tAnna:LK")
                .replace("\tRK", "\tAnna:RK")
                .replace("\tLA", "\tAnna:LA")
                .replace("\tRA", "\tAnna:RA"),
        ),
    ] {
        let take = read_trc(&text).unwrap_or_else(|message| panic!("{what}: {message}"));
        let off = super::largest_difference(&known, &take);
        assert!(off < 1e-4, "{what}: off by {off} m");
        assert!((take.frame_rate - 60.0).abs() < 0.1, "{what}: {} Hz", take.frame_rate);
    }
}

#[test]
fn gaps_of_a_trc_are_bridged_and_long_ones_cut_the_take() {
    let walker = Walker::default();
    let (names, frames) = lower_body(&walker.take(4.0, 60.0));
    let mut frames = seen(&frames);
    let knee = names.iter().position(|name| name == "LKNE").unwrap();
    for frame in frames.iter_mut().take(106).skip(100) {
        frame[knee] = None;
    }
    for frame in frames.iter_mut().take(40).skip(20) {
        frame[knee] = Some(Vec3::ZERO);
    }
    let text = containers::trc(&names, &frames, 60.0, "mm");
    for text in [text.clone(), text.replace("\t\t\t\t", "\tNaN\tnan\tNaN\t")] {
        let take = read_trc(&text).unwrap();
        says(&take, "6 positions bridged");
        says(&take, "frames 41 to 240 of 240");
        assert!(stride::best(&take).is_ok());
    }
}

#[test]
fn pose_estimates_and_markers_of_opensim_and_opencap_are_known() {
    let truth = Walker::default().take(3.0, 60.0);
    let body = |joint: Joint| move |pose: &Pose| pose[joint as usize];
    type Place = Box<dyn Fn(&Pose) -> Vec3>;
    let mut halpe: Vec<(String, Place)> = vec![
        ("Hip".into(), Box::new(body(Joint::Root))),
        ("Neck".into(), Box::new(body(Joint::Neck))),
        ("Head".into(), Box::new(body(Joint::Head))),
    ];
    for (side, first) in [("L", 0), ("R", 3)] {
        for (name, joint) in
            [("Hip", 10), ("Knee", 11), ("Ankle", 12), ("Shoulder", 4), ("Elbow", 5), ("Wrist", 6)]
        {
            halpe.push((format!("{side}{name}"), Box::new(body(Joint::ALL[joint + first]))));
        }
        halpe.push((format!("{side}BigToe"), Box::new(body(Joint::ALL[12 + first]))));
    }
    let names: Vec<String> = halpe.iter().map(|(name, _)| name.clone()).collect();
    let frames: Vec<Vec<Vec3>> =
        truth.poses.iter().map(|pose| halpe.iter().map(|(_, at)| at(pose)).collect()).collect();
    let take = read_trc(&containers::trc(&names, &seen(&frames), 60.0, "m")).unwrap();
    says(&take, "joint map: HALPE 26");
    assert!(take.missing.is_empty());
    assert!(
        take.poses[9][Joint::LeftHand as usize].distance(truth.poses[9][Joint::LeftHand as usize]) < 1e-4
    );

    let (plain, frames) = lower_body(&truth);
    for set in [
        ["ASIS", "V.Sacral", "Knee.Lat", "Ankle.Lat"],
        ["ASIS_study", "PSIS_study", "knee_study", "ankle_study"],
    ] {
        let renamed: Vec<String> = plain
            .iter()
            .map(|name| {
                let part = [("ASI", set[0]), ("PSI", set[1]), ("KNE", set[2]), ("ANK", set[3])];
                let found = part.iter().find(|(old, _)| name[1..] == **old);
                match found {
                    Some((_, new)) if new.starts_with('V') && name.starts_with('L') => (*new).to_owned(),
                    Some((_, new)) => format!("{}.{new}", name[..1].to_lowercase()),
                    None => name.clone(),
                }
            })
            .collect();
        let take = read_trc(&containers::trc(&renamed, &seen(&frames), 60.0, "m")).unwrap();
        assert_eq!(take.missing, upper_body(), "{renamed:?}");
        let off =
            take.poses[5][Joint::RightKnee as usize].distance(truth.poses[5][Joint::RightKnee as usize]);
        assert!(off < 0.03, "{renamed:?}: {off}");
    }
}

#[test]
fn a_wrong_rate_in_a_trc_gives_way_to_the_times() {
    let (names, frames) = lower_body(&Walker::default().take(4.0, 60.0));
    let text = containers::trc(&names, &seen(&frames), 60.0, "mm").replacen("60\t60\t", "100\t100\t", 1);
    let take = read_trc(&text).unwrap();
    assert!((take.frame_rate - 60.0).abs() < 0.1);
    says(&take, "warning: the header states 100.00 Hz, the times tell 60.0");
    let options = Options { frame_rate: Some(30.0), ..Options::default() };
    let take = trc::parse_trc(&text, "walk.trc", &options).unwrap().remove(0);
    assert!((take.frame_rate - 30.0).abs() < 1e-3);
    says(&take, "30 Hz, as given (the file states");
}

#[test]
fn broken_trc_is_refused_with_its_line() {
    let (names, frames) = lower_body(&Walker::default().take(1.0, 30.0));
    let good = containers::trc(&names, &seen(&frames), 30.0, "mm");
    let row = good.lines().nth(6).unwrap();
    for (text, expected) in [
        (String::new(), "walk.trc:1: begins with \"\""),
        ("HIERARCHY\n".to_owned(), "PathFileType"),
        (good.replace("Frame#", "Frames"), "names the markers"),
        (good.replace(row, &format!("{row}\t1\t2\t3")), "walk.trc:7: 47 cells; 14 markers ask for 44"),
        (good.replace(row, &row.replacen("\t", "\tx", 2)), "walk.trc:7: the time is"),
        (good.replacen("\t14\tmm", "\t40\tmm", 1), "the header states 40"),
        (good.replace("LKNE", "LKNEE2"), "LKNEE2"),
        (good.lines().take(5).map(|line| format!("{line}\n")).collect(), "no frames"),
    ] {
        let message = read_trc(&text).unwrap_err();
        assert!(message.contains(expected), "{message} should say {expected}");
    }
}
