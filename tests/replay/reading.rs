//! What is read out of each format.

use gaitway::replay::{Format, Options, Trajectories, read};
use glam::Vec2;
use rusqlite::Connection;
use std::path::{Path, PathBuf};

pub(crate) fn file(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn of(name: &str, text: &str, options: &Options) -> Result<Trajectories, gaitway::replay::Error> {
    let folder = tempfile::tempdir().unwrap();
    read(&file(folder.path(), name, text), options)
}

fn plain(name: &str, text: &str) -> Trajectories {
    of(name, text, &Options::default()).unwrap()
}

const ARCHIVE: &str = "# PeTrack project: x\n# framerate: 25 fps\n# id frame x/m y/m z/m\n\
    1\t0\t1.0\t2.0\t1.76\n1\t1\t1.05\t2.0\t1.76\n2 1 0 0 1.6\n2 2 0 -0.05 1.6\n";
const OBSMAT: &str =
    " 1.0e+00 1.0e+00 1.5 0 2.5 1 0 0\n 1.1e+01 1.0e+00 1.9 0 2.5 1 0 0\n 1.1e+01 2.0e+00 0 0 0 0 0 0\n";
const SPLINES: &str = "1 - the number of splines\n2 - Num of control points\n\
    -100.0 50.0 0 -90.0 - (2D point, m_id)\n100.0 50.0 100 0.0 - (2D point, m_id)\n";
const HOMOGRAPHY: &str = "0.02 0 7\n0 0.024 6\n0 0 1\n";
const CSV: &str = "ID,Frame,x,y,v_x,v_y\n21,1010,0.2,-0.1,0.4,0.09\n21,1020,0.4,-0.1,0.4,0.09\n";
const OURS: &str =
    "frame,time_s,id,x_m,z_m,heading_rad\n0,0.000000,0,1.5,-2.5,0.5\n3,0.300000,0,1.6,-2.4,0.6\n";

fn database(path: &Path, version: &str) {
    let connection = Connection::open(path).unwrap();
    connection
        .execute_batch(&format!(
            "CREATE TABLE trajectory_data(frame INTEGER, id INTEGER, pos_x REAL, pos_y REAL, ori_x REAL, ori_y REAL);
             CREATE TABLE metadata(key TEXT, value TEXT);
             CREATE TABLE geometry(wkt TEXT);
             INSERT INTO metadata VALUES('version', '{version}'), ('fps', '10.0');
             INSERT INTO geometry VALUES('POLYGON ((0 0, 8 0, 8 6, 0 6, 0 0), (3 3, 4 3, 4 4, 3 3))');
             INSERT INTO trajectory_data VALUES(1, 5, 1.2, 2.0, 0.0, 1.0), (0, 5, 1.0, 2.0, 1.0, 0.0);"
        ))
        .unwrap();
}

#[test]
fn the_archives_text_says_unit_and_rate_in_comments() {
    let read = plain("a.txt", ARCHIVE);
    assert_eq!((read.report.format, read.report.frame_rate_from), (Format::Archive, "file"));
    assert_eq!((read.tracks.len(), read.report.samples), (2, 4));
    let first = read.tracks[0].samples[1];
    assert!((first.time - 0.04).abs() < 1e-9);
    assert_eq!(first.position, Vec2::new(1.05, -2.0), "y up the page is -z");
    assert!((read.tracks[1].samples[0].time - 0.04).abs() < 1e-9, "time counts from the first frame of all");
}

#[test]
fn centimetres_are_recognised_by_height_or_by_speed_and_a_rate_is_demanded() {
    let text = "1 43 79.0 774.0 183.0\n1 44 79.1 764.5 183.0\n1 45 79.4 754.1 183.0\n";
    let error = of("uo.txt", text, &Options::default()).unwrap_err();
    assert!(
        error.to_string().contains("frames a second") && error.hint().unwrap().contains("--fps"),
        "{error}"
    );
    let options = Options { frame_rate: Some(16.0), ..Options::default() };
    let by_height = of("uo.txt", text, &options).unwrap();
    assert_eq!(by_height.tracks[0].samples[0].position, Vec2::new(0.79, -7.74));
    assert!(
        by_height.report.notes[0].contains("centimetres (people are 183 tall)"),
        "{:?}",
        by_height.report
    );
    let without_z = text.replace(" 183.0", "");
    let by_speed = of("uo.txt", &without_z, &options).unwrap();
    assert!((by_speed.report.metres_per_unit - 0.01).abs() < 1e-9, "{:?}", by_speed.report);
    let told = Options { metres_per_unit: Some(1.0), ..options };
    assert!((of("uo.txt", text, &told).unwrap().tracks[0].samples[0].position.x - 79.0).abs() < 1e-6);
}

#[test]
fn obsmat_is_known_by_its_eight_columns() {
    let read = plain("obsmat.txt", OBSMAT);
    assert_eq!((read.report.format, read.report.frame_rate_from), (Format::Obsmat, "format"));
    assert!((read.tracks[0].samples[1].time - 0.4).abs() < 1e-9);
    assert_eq!(read.tracks[0].samples[1].position, Vec2::new(1.9, -2.5));
    let mirrored = of("o.txt", OBSMAT, &Options { mirror: true, ..Options::default() }).unwrap();
    assert_eq!(mirrored.tracks[0].samples[1].position, Vec2::new(1.9, 2.5));
}

#[test]
fn splines_come_to_the_ground_with_where_people_look() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), "annotation.vsp", SPLINES);
    let error = read(&path, &Options::default()).unwrap_err();
    assert!(error.to_string().contains("homography"), "{error}");
    file(folder.path(), "H.txt", HOMOGRAPHY);
    let found = read(&path, &Options::default()).unwrap();
    let [first, last] = found.tracks[0].samples[..] else { panic!("two control points") };
    assert!(first.position.distance(Vec2::new(5.0, -7.2)) < 1e-5, "{first:?}");
    assert!((last.time - 4.0).abs() < 1e-9, "one track, however far the points are apart");
    // -90 degrees is right in the picture (+x), 0 is up (-z): headings +90 and 180 degrees about +y
    assert!((first.heading.unwrap() - std::f32::consts::FRAC_PI_2).abs() < 1e-3, "{first:?}");
    assert!((last.heading.unwrap().abs() - std::f32::consts::PI).abs() < 1e-3, "{last:?}");
    // A row spans more ground than a column: this homography takes (row, column) from the corner.
    file(folder.path(), "H.txt", "-0.026 0 7.84\n0 0.021 5.5\n0 0 1\n");
    let found = read(&path, &Options::default()).unwrap();
    let expected = Vec2::new(-0.026 * (288.0 - 50.0) + 7.84, -(0.021 * (360.0 - 100.0) + 5.5));
    assert!(
        found.tracks[0].samples[0].position.distance(expected) < 1e-4,
        "{:?}",
        found.tracks[0].samples[0]
    );
    assert!(found.report.notes[0].contains("(row, column)"), "{:?}", found.report.notes);
}

#[test]
fn named_columns_are_found_and_ours_keep_our_frame() {
    let options = Options { frame_rate: Some(25.0), ..Options::default() };
    let single_file = of("n34.csv", CSV, &options).unwrap();
    assert_eq!(single_file.tracks[0].person, 21);
    assert_eq!(single_file.tracks[0].samples[1].position, Vec2::new(0.4, 0.1));
    assert!((single_file.tracks[0].samples[1].time - 0.4).abs() < 1e-9);
    let other = of("o.csv", "y;x;frame;agent\n2;1;0;7\n", &options).unwrap();
    assert_eq!((other.tracks[0].person, other.tracks[0].samples[0].position), (7, Vec2::new(1.0, -2.0)));
    let ours = plain("ours.csv", OURS);
    assert!((ours.frame_rate - 10.0).abs() < 1e-9, "from its times");
    let first = ours.tracks[0].samples[0];
    assert_eq!(first.position, Vec2::new(1.5, -2.5));
    assert!((first.heading.unwrap() - 0.5).abs() < 1e-5, "{first:?}");
    let missing = of("m.csv", "frame,x,y\n0,1,2\n", &options).unwrap_err().to_string();
    assert!(missing.contains("no column for the person") && missing.contains("line 1"), "{missing}");
}

#[test]
fn databases_of_both_versions_come_with_area_and_orientation() {
    let folder = tempfile::tempdir().unwrap();
    for version in ["1", "2"] {
        let path = folder.path().join(format!("v{version}.sqlite"));
        database(&path, version);
        let found = read(&path, &Options::default()).unwrap();
        let track = &found.tracks[0];
        assert_eq!((track.person, track.samples.len()), (5, 2));
        assert_eq!(track.samples[0].position, Vec2::new(1.0, -2.0), "rows are sorted");
        assert!((track.samples[0].heading.unwrap() - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
        let area = found.area.unwrap();
        assert_eq!((area.len(), area[0][2], area[1][0]), (2, Vec2::new(8.0, -6.0), Vec2::new(3.0, -3.0)));
    }
    let path = folder.path().join("v9.sqlite");
    database(&path, "9");
    assert!(read(&path, &Options::default()).unwrap_err().to_string().contains("version \"9\""));
}

#[test]
fn order_duplicates_gaps_and_absences_are_reported() {
    let mut text = String::from("# framerate: 10\n# x/m\n");
    for frame in [5, 4, 3, 2, 1, 0] {
        text += &format!("1 {frame} {} 0\n", 0.1 * f64::from(frame));
    }
    text += "1 3 0.3 0\n1 4 7 7\n"; // the same again, and elsewhere
    text += "1 8 0.8 0\n"; // two frames missing
    text += "1 60 3 3\n1 61 3.1 3\n"; // back after five seconds
    let found = plain("messy.txt", &text);
    let report = &found.report;
    assert!(report.unsorted);
    assert_eq!((report.people, report.samples), (1, 9));
    assert_eq!((report.duplicates, report.contradictions), (2, 1));
    assert_eq!((report.gaps, report.absences), (1, 1));
    assert!((report.longest_gap - 0.3).abs() < 1e-9 && (report.fastest - 1.0).abs() < 1e-3, "{report:?}");
    assert_eq!(found.tracks.len(), 2);
    let options = Options { longest_gap: Some(10.0), ..Options::default() };
    assert_eq!(of("messy.txt", &text, &options).unwrap().tracks.len(), 1);
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    let with = |text: &str| of("a.txt", text, &Options::default()).unwrap_err().to_string();
    for (text, line, why) in [
        ("# framerate: 25\n1 0 0 0\n1 x 0 0\n", "line 3", "the frame is \"x\""),
        ("# framerate: 25\n1 0.5 0 0\n", "line 2", "not a whole number"),
        ("# framerate: 25\n1 0 nan 0\n", "line 2", "not a finite number"),
        ("# framerate: 25\n1 0 0 0\n1 1 1e9 0\n", "line 3", "from the origin"),
        ("1 0 0\n", "", "3 columns"),
    ] {
        let said = with(text);
        assert!(said.contains(line) && said.contains(why), "{text:?}: {said}");
    }
    assert!(with("# framerate: 25\n1 0 0 0\n1 2000000000 0 0\n").contains("at most a day"));
    assert!(with("# framerate: 1e9\n").contains("no format that is read"));
    let empty = of("a.csv", "id,frame,x,y\n", &Options::default()).unwrap_err().to_string();
    assert!(empty.contains("no rows"), "{empty}");
    assert!(read(Path::new("/no/such/file.txt"), &Options::default()).is_err());
}

/// xorshift: the same broken files every time.
fn random(state: &mut u64) -> usize {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 16) as usize
}

#[test]
fn broken_files_of_every_format_are_answered() {
    let folder = tempfile::tempdir().unwrap();
    file(folder.path(), "H.txt", HOMOGRAPHY);
    let sqlite = folder.path().join("whole.sqlite");
    database(&sqlite, "2");
    let seeds: [(&str, Vec<u8>); 6] = [
        ("a.txt", ARCHIVE.into()),
        ("o.txt", OBSMAT.into()),
        ("s.vsp", SPLINES.into()),
        ("c.csv", CSV.into()),
        ("g.csv", OURS.into()),
        ("d.sqlite", std::fs::read(&sqlite).unwrap()),
    ];
    let options = Options { frame_rate: Some(25.0), ..Options::default() };
    let pieces: [&[u8]; 8] = [b"1e308", b"-", b"nan", b"\n", b"999999999999", b"0", b"\xff", b"("];
    let mut state = 0x9e37_79b9_7f4a_7c15;
    for (name, seed) in seeds {
        let path = folder.path().join(name);
        let is_text = !name.ends_with("sqlite");
        let cuts = if is_text { seed.len() } else { 60 };
        let mut answers = 0;
        for round in 0..cuts + 300 {
            let mut bytes = seed.clone();
            if round < cuts {
                bytes.truncate(round * seed.len() / cuts);
            } else {
                for _ in 0..=random(&mut state) % 4 {
                    let at = random(&mut state) % bytes.len();
                    if is_text {
                        let piece = pieces[random(&mut state) % pieces.len()];
                        bytes.splice(
                            at..(at + random(&mut state) % 4).min(bytes.len()),
                            piece.iter().copied(),
                        );
                    } else {
                        bytes[at] = random(&mut state) as u8;
                    }
                }
            }
            std::fs::write(&path, &bytes).unwrap();
            if let Ok(found) = read(&path, &options) {
                answers += 1;
                assert!(found.tracks.iter().all(|track| !track.samples.is_empty()));
                assert!(found.report.samples <= bytes.len(), "{name}: {:?}", found.report);
                let finite = |s: &gaitway::replay::Sample| s.position.is_finite() && s.time.is_finite();
                assert!(found.tracks.iter().flat_map(|track| &track.samples).all(finite), "{name}");
            }
        }
        println!("{name}: {answers} of {} broken files could be read", cuts + 300);
    }
}
