//! What is read out of each format.

use gaitway::replay::{Columns, Format, Options, Trajectories, read};
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
    let refused = of("uo.txt", text, &told).unwrap_err();
    assert!(refused.to_string().contains("faster than 16"), "{refused}");
    let told = Options { accept_speed: true, ..told };
    assert!((of("uo.txt", text, &told).unwrap().tracks[0].samples[0].position.x - 79.0).abs() < 1e-6);
}

#[test]
fn obsmat_is_known_by_its_eight_columns() {
    let read = plain("obsmat.txt", OBSMAT);
    assert_eq!((read.report.format, read.report.frame_rate_from), (Format::Obsmat, "velocities"));
    let still = plain("obsmat.txt", &OBSMAT.replace(" 1 0 0\n", " 0 0 0\n"));
    assert_eq!((still.frame_rate, still.report.frame_rate_from), (25.0, "steps"));
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
        ("1 0 0\n", "line 1", "3 columns"),
        ("# framerate: 25\n1 0 0\n", "line 2", "3 columns"),
        ("# framerate: 25\n1 0 0 1\n2 0 0\n", "line 3", "y is missing"),
    ] {
        let said = with(text);
        assert!(said.contains(line) && said.contains(why), "{text:?}: {said}");
    }
    assert!(with("# framerate: 25\n1 0 0 0\n1 2000000000 0 0\n").contains("at most a day"));
    assert!(with("# framerate: 1e9\n").contains("no rows"));
    assert!(with("").contains("no rows") && with("\r\n\n").contains("no rows"));
    let empty = of("a.csv", "id,frame,x,y\n", &Options::default()).unwrap_err().to_string();
    assert!(empty.contains("no rows"), "{empty}");
    assert!(read(Path::new("/no/such/file.txt"), &Options::default()).is_err());
}

/// Four people who walk for twelve samples, each along a curve of their own, written by `row` of (id, sample, x, y, vx, vy).
fn crowd(rate: f64, row: impl Fn(i64, i64, [f64; 4]) -> String) -> String {
    let mut text = String::new();
    for sample in 0..12_i64 {
        for id in 1..=4_i64 {
            let (t, phase) = (sample as f64 / rate, id as f64);
            let speed = 1.1 + 0.1 * phase;
            let (x, y) = (speed * t, 3.0 * phase + 0.3 * (t + phase).sin());
            text += &row(id, sample, [x, y, speed, 0.3 * (t + phase).cos()]);
        }
    }
    text
}

#[test]
fn frame_and_person_are_recognised_in_either_order() {
    // TrajNet and SGAN: a sample every 0.4 s, every tenth frame, first the frame
    let text =
        crowd(2.5, |id, sample, [x, y, ..]| format!("{}.0\t{id}.0\t{x:.3}\t{y:.3}\n", 780 + 10 * sample));
    let found = plain("biwi_eth.txt", &text);
    assert_eq!((found.tracks.len(), found.tracks[0].samples.len()), (4, 12));
    assert_eq!((found.frame_rate, found.report.frame_rate_from), (25.0, "steps"));
    assert_eq!((found.report.format, found.report.columns_from), (Format::Columns, Some("inferred")));
    assert_eq!(found.report.columns.unwrap().to_string(), "frame, id, x, y");
    assert!(found.report.median_speed.unwrap() < 2.0 && found.report.seconds < 4.5);
    // the same the other way round, and its frames counted one by one
    let text = crowd(2.5, |id, sample, [x, y, ..]| format!("{id} {sample} {x:.3} {y:.3}\n"));
    let found = plain("a.txt", &text);
    assert_eq!((found.tracks.len(), found.frame_rate, found.report.format), (4, 2.5, Format::Archive));
    // a wrong order is refused, whether inferred or given
    let wrong: Columns = "frame,id,x,y".parse().unwrap();
    let error =
        of("a.txt", &text, &Options { columns: Some(wrong), frame_rate: Some(2.5), ..Options::default() })
            .unwrap_err();
    assert!(error.to_string().contains("frame, id, x, y"), "{error}");
    assert!(error.hint().unwrap().contains("--accept-speed"), "{error}");
    // a comment that names the columns is believed
    let text = format!("# framerate: 25\n# frame id x/m y/m\n{}", "10 1 0.5 0.5\n20 1 1.0 0.5\n");
    assert_eq!(plain("c.txt", &text).report.columns_from, Some("file"));
}

#[test]
fn velocities_tell_the_frame_rate() {
    // ETH's seq_eth: 15 frames a second, a row every sixth
    let eth = |scale: f64| {
        crowd(2.5, |id, sample, [x, y, vx, vy]| {
            let (vx, vy) = (scale * vx, scale * vy);
            format!("{} {id} {x} 0 {y} {vx} 0 {vy}\n", 6 * sample)
        })
    };
    let found = plain("obsmat.txt", &eth(1.0));
    assert_eq!((found.frame_rate, found.report.frame_rate_from), (15.0, "velocities"));
    assert!((found.report.seconds - 4.4).abs() < 1e-9, "{:?}", found.report);
    // said otherwise, that counts
    let fps = Options { frame_rate: Some(25.0), ..Options::default() };
    assert_eq!(of("obsmat.txt", &eth(1.0), &fps).unwrap().frame_rate, 25.0);
    // columns by name, in centimetres, at 16 frames a second
    let text = crowd(16.0, |id, sample, [x, y, vx, vy]| {
        format!("{id};{sample};{};{};{vx};{vy}\n", 100.0 * x, 100.0 * y)
    });
    let found = plain("v.csv", &format!("id;frame;x;y;v_x;v_y\n{text}"));
    assert_eq!((found.frame_rate, found.report.frame_rate_from), (16.0, "velocities"));
    assert!((found.report.metres_per_unit - 0.01).abs() < 1e-12, "{:?}", found.report);
}

#[test]
fn a_rate_that_nothing_tells_is_asked_for_with_the_speeds_it_would_give() {
    let text = crowd(16.0, |id, sample, [x, y, ..]| format!("{id} {sample} {x} {y}\n"));
    let error = of("a.txt", &text, &Options::default()).unwrap_err();
    assert!(error.hint().unwrap().contains("m/s at 16"), "{:?}", error.hint());
}

#[test]
fn columns_that_are_asked_for_are_taken_from_where_they_stand() {
    let columns: Columns = "-,y,x,frame,-,id".parse().unwrap();
    let options = Options { columns: Some(columns), frame_rate: Some(10.0), ..Options::default() };
    let text = "lane,north,east,tick,kind,who\nA,2.5,1.5,0,walker,7\nB,2.5,1.6,1,walker,7\n";
    let found = of("odd.csv", text, &options).unwrap();
    assert_eq!((found.tracks[0].person, found.report.columns_from), (7, Some("asked for")));
    assert_eq!(found.tracks[0].samples[1].position, Vec2::new(1.6, -2.5));
    let lacking = of("odd.csv", text, &Options::default()).unwrap_err();
    assert!(lacking.to_string().contains("no column for the person"), "{lacking}");
    assert!(lacking.hint().unwrap().contains("--columns"), "{lacking}");
}

#[test]
fn files_of_vadere_pathfinder_viswalk_and_crowdit_are_read_by_the_columns_that_matter() {
    let vadere = "#IDXCOL=2,DATACOL=6\npedestrianId simTime endTime startX-PID1 startY-PID1 endX-PID1 endY-PID1 targetId-PID2\n\
                  1 0.0 0.4 1.0 2.0 1.5 2.0 -1\n1 0.4 0.93 1.5 2.0 2.1 2.0 3\n2 0.1 0.6 5.0 5.0 5.5 5.0 3\n";
    let found = plain("postvis.traj", vadere);
    assert_eq!(
        (found.tracks.len(), found.tracks[0].samples.len()),
        (2, 3),
        "a step ends where the next one begins"
    );
    let last = found.tracks[0].samples[2];
    assert!(
        (last.time - 0.93).abs() < 1e-9 && last.position.distance(Vec2::new(2.1, -2.0)) < 1e-6,
        "{last:?}"
    );
    let pathfinder = "\u{feff}t,id,name,x,y,z,speed,active,location\r\ns,,,m,m,m,m/s,,\r\n0.0,3,Ann,1.0,2.0,0.0,1.2,1,Room\r\n\
                      0.1,3,Ann,1.12,2.0,0.0,1.2,1,Room\r\n0.2,3,Ann,1.24,2.0,0.0,1.2,1,Room\r\n";
    let found = plain("occupants_detailed.csv", pathfinder);
    assert_eq!((found.frame_rate, found.report.frame_rate_from), (10.0, "times"));
    assert_eq!((found.tracks[0].person, found.tracks[0].samples.len()), (3, 3));
    let viswalk =
        "$VISION\n* a comment\n$PEDESTRIAN:NO;SIMSEC;COORDCENTX;COORDCENTY\n1;0.05;1.0;2.0\n1;0.1;1.06;2.0\n";
    assert_eq!(plain("v.pp", viswalk).frame_rate, 20.0);
    let crowdit = "pedID,time,posX,posY\n1,0.0,1.0,2.0\n1,0.5,1.6,2.0\n";
    assert_eq!(plain("c.csv", crowdit).frame_rate, 2.0);
}

#[test]
fn what_is_no_text_is_named_for_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes, said, way_out) in [
        (
            "t.h5",
            b"\x89HDF\r\n\x1a\n\0\0\0\0\0".as_slice(),
            "HDF5",
            "load_trajectory_from_ped_data_archive_hdf5",
        ),
        ("t.txt.gz", b"\x1f\x8b\x08\x08", "gzip", "gunzip"),
        ("t.pkl", b"\x80\x05\x95\x1c\0\0\0\0", "pickle", "read_pickle"),
        ("t.ndjson", b"{\"scene\": {\"id\": 0}}\n{\"track\": {\"f\": 1}}", "TrajNet++", "jq"),
        ("t.npz", b"PK\x03\x04\0\0", "zip", "unzip"),
        ("t.xml", b"<?xml version=\"1.0\"?>", "XML", "columns"),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let error = read(&path, &Options::default()).unwrap_err();
        assert!(
            error.to_string().contains(said) && error.hint().unwrap().contains(way_out),
            "{name}: {error}"
        );
    }
    // a database is one whatever its name
    let path = folder.path().join("run.dat");
    database(&path, "2");
    assert_eq!(read(&path, &Options::default()).unwrap().report.format, Format::Sqlite);
    assert!(
        read(folder.path(), &Options::default()).unwrap_err().to_string().contains("a folder, not a file")
    );
}

#[test]
fn the_ways_of_spreadsheets_and_single_frames_are_read() {
    let options = Options { frame_rate: Some(10.0), ..Options::default() };
    let place = |name: &str, text: &str| of(name, text, &options).unwrap().tracks[0].samples[0].position;
    for (name, text) in [
        ("comma.csv", "\u{feff}id;frame;x;y\r\n1;0;1,5;2,5\r\n1;1;1,6;2,5\r\n"),
        ("comma.txt", "1 0 1,5 2,5\n1 1 1,6 2,5\n"),
        ("both.txt", "1, 0, 1.5, 2.5\n1, 1, 1.6, 2.5\n"),
        ("mixed.txt", "1 0, 1.5 2.5\n1 1, 1.6 2.5\n"),
        ("quotes.csv", "\"id\",\"frame\",\"x\",\"y\"\n\"1\",\"0\",\"1.5\",\"2.5\"\n"),
        ("tabs.tsv", "Person\tframe\tx [m]\ty [m]\n1\t0\t1.5\t2.5\n"),
        ("bare.csv", "1,0,1.5,2.5\n1,1,1.6,2.5\n"),
        ("mac.txt", "1 0 1.5 2.5\r1 1 1.6 2.5\r"),
    ] {
        assert_eq!(place(name, text), Vec2::new(1.5, -2.5), "{name}");
    }
    let one = of("one.csv", "id,frame,x,y\n1,5,0,0\n9007199254740991,5,3,3\n", &options).unwrap();
    assert_eq!((one.tracks.len(), one.report.seconds), (2, 0.0));
    assert_eq!(one.tracks[1].person, 9_007_199_254_740_991);
    let huge = of("h.csv", "id,frame,x,y\n1e300,5,0,0\n", &options).unwrap_err().to_string();
    assert!(huge.contains("53 bits"), "{huge}");
}

#[test]
fn quoted_cells_hold_separators_and_line_ends_and_what_is_wrong_behind_them_has_its_line() {
    let options = Options { frame_rate: Some(10.0), ..Options::default() };
    let head = "id, \"frame\",\"seen; said\",x [m],\"y [m]\"\n";
    let waits = "1,0,\"waits, \"\"then\n# framerate: 5\nwalks\",1.5,\"2,5\"\n# no \"row\n";
    for end in ["\n", "\r\n", "\r"] {
        let text = format!("\u{feff}{head}{waits}1,1, \"a, b\",\"1,6\",2.5\n").replace('\n', end);
        let found = of("remarks.csv", &text, &options).unwrap();
        let places: Vec<Vec2> = found.tracks[0].samples.iter().map(|sample| sample.position).collect();
        assert_eq!(places, [Vec2::new(1.5, -2.5), Vec2::new(1.6, -2.5)], "{end:?}");
        let unsaid = of("remarks.csv", &text, &Options::default()).unwrap_err().to_string();
        assert!(unsaid.contains("frames a second"), "a cell is no comment: {unsaid}");
        for (row, line, why) in [
            ("1,1,,left,2\n", "line 6", "x is \"left\""),
            ("1,1,\"\n\n\",1,2\n2,1,,1\n", "line 9", "y is missing"),
            ("1,1,\"a\nb\",\"1,2\n2,1,,1,1\n", "line 7", "a quote is opened and never closed"),
        ] {
            let text = format!("{head}{waits}{row}").replace('\n', end);
            let said = of("remarks.csv", &text, &options).unwrap_err().to_string();
            assert!(said.contains(line) && said.contains(why), "{row:?} {end:?}: {said}");
        }
    }
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
    let seeds: [(&str, Vec<u8>); 8] = [
        ("a.txt", ARCHIVE.into()),
        ("o.txt", OBSMAT.into()),
        ("s.vsp", SPLINES.into()),
        ("c.csv", CSV.into()),
        ("t.csv", "t,id,x,y,z,v_x,v_y\ns,,m,m,m,m/s,m/s\n0.1,1,2,3,0,1,0\n0.2,1,2.1,3,0,1,0\n".into()),
        (
            "v.traj",
            "pedestrianId simTime endTime startX startY endX endY\n1 0 0.4 1 2 2 2\n1 0.4 1 2 2 3 2\n".into(),
        ),
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
