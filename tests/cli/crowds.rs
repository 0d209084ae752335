//! What a crowd's files and pictures say of it.

use super::{gaitway, good, has_vulkan, json, program};
use rusqlite::Connection;
use std::path::Path;

/// A single walker through the middle of a room, past a block: the room stands about (x, z).
fn room(x: i32, z: i32) -> String {
    let corner = |dx: i32, dz: i32| format!("[{}, {}]", x + dx, z + dz);
    let rectangle = |x: i32, z: i32| [corner(-x, -z), corner(x, -z), corner(x, z), corner(-x, z)].join(", ");
    let block = [corner(5, 3), corner(7, 3), corner(7, 4), corner(5, 4)].join(", ");
    format!(
        "name = \"room\"\nbounds = [{}]\n[[obstacles]]\npolygon = [{block}]\n[population]\nagents = 0\n\
         [[walkers]]\nposition = {}\nwaypoints = [{}]\nspeed = 1.3\n",
        rectangle(12, 5),
        corner(-10, 0),
        corner(10, 0)
    )
}

/// The cells of a CSV of trajectories, its head left out.
fn rows(path: &Path) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(path).unwrap();
    text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

#[test]
fn no_user_is_put_into_a_scene_without_one() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = (folder.path().join("room.toml"), folder.path().join("walk.csv"));
    let (file, csv) = (scene.to_str().unwrap(), out.to_str().unwrap());
    for (x, z) in [(0, 0), (100, -40)] {
        std::fs::write(&scene, room(x, z)).unwrap();
        good(&["simulate", file, "--seconds", "16", "--backend", "cpu", "--force", "--out", csv]);
        let place = |row: &Vec<String>| [3, 4].map(|column| row[column].parse::<f64>().unwrap());
        let way: Vec<[f64; 2]> = rows(&out).iter().map(place).collect();
        let aside = way.iter().map(|place| (place[1] - f64::from(z)).abs()).fold(0.0, f64::max);
        assert!(aside < 0.01, "{aside} m aside without a cause");
        assert!(way[way.len() - 1][0] > f64::from(x) + 9.0, "{way:?}");
    }
}

/// The samples of a PNG.
fn samples(path: &Path) -> Vec<u8> {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut samples = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut samples).unwrap();
    samples.truncate(frame.buffer_size());
    samples
}

#[test]
fn the_orbit_goes_round_the_place_wherever_it_stands() {
    if !has_vulkan() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let picture = |x: i32, z: i32| {
        let (scene, out) = (folder.path().join("room.toml"), folder.path().join(format!("{x}.png")));
        std::fs::write(&scene, room(x, z)).unwrap();
        let (file, png) = (scene.to_str().unwrap(), out.to_str().unwrap());
        good(&["render", file, "--camera", "orbit", "--at", "1", "--size", "192x108", "--out", png]);
        samples(&out)
    };
    let (here, there) = (picture(0, 0), picture(100, -40));
    let off: f64 = here.iter().zip(&there).map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    let off = off / f64::from(u32::try_from(here.len()).unwrap());
    assert!(off < 2.0, "the same room elsewhere looks {off} of 255 otherwise");
}

#[test]
fn robots_and_vehicles_are_seen_each_in_its_own_shape() {
    if !has_vulkan() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let model = gaitway::avatar::glb(&gaitway::avatar::generated(gaitway::avatar::Sex::Male));
    std::fs::write(path("model.glb"), model).unwrap();
    let none = "";
    let lines = [
        none,
        "kind = \"robot\"",
        "kind = \"vehicle\"",
        "kind = \"robot\"\nmodel = \"model.glb\"",
        "kind = \"robot\"\nmodel = \"model.glb\"\nsize = [1, 1, 2]",
        "kind = \"person\"",
    ];
    let pictures: Vec<Vec<u8>> = (0..)
        .zip(lines)
        .map(|(number, line)| {
            let outsider = format!("[[outsiders]]\n{line}\npath = [[0, 3, 2]]\n");
            let outsider = if line == none { none } else { &outsider };
            let scene =
                "name = \"yard\"\nbounds = [[0, 0], [6, 0], [6, 4], [0, 4]]\n[population]\nagents = 0\n";
            std::fs::write(path("yard.toml"), format!("{scene}{outsider}")).unwrap();
            let png = path(&format!("{number}.png"));
            let size = ["--camera", "top", "--at", "0.1", "--size", "192x128", "--out", &png];
            good(&[&["render", &path("yard.toml")][..], &size].concat());
            samples(Path::new(&png))
        })
        .collect();
    for (i, a) in pictures.iter().enumerate() {
        for (j, b) in pictures.iter().enumerate().skip(i + 1) {
            let other = a.iter().zip(b).filter(|(a, b)| a.abs_diff(**b) > 24).count();
            assert!(other > 60, "{:?} and {:?} differ in {other} samples", lines[i], lines[j]);
        }
    }
}

#[test]
fn files_say_what_people_feel_and_walk_with_from_the_first_frame_to_the_last() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let hall = "name = \"hall\"\nbounds = [[0, 0], [30, 0], [30, 30], [0, 30]]\n[population]\nagents = 60\n\
                [[routes]]\nname = \"way\"\nwaypoints = [[2, 15], [28, 15]]\nwidth = 26\n[emotion_dynamics]\ncontagion = 0\n\
                [[events]]\ntime = 0.5\nduration = 2\nplace = [15, 15]\nradius = 60\nemotion = \"angry\"\nstrength = 1\n";
    std::fs::write(path("hall.toml"), hall).unwrap();
    for name in ["run.csv", "run.sqlite"] {
        good(&["simulate", &path("hall.toml"), "--seconds", "3", "--backend", "cpu", "--out", &path(name)]);
    }
    // the emotion of each agent at the start, and the gait of that emotion
    let database = Connection::open(path("run.sqlite")).unwrap();
    let count = |what: &str| -> u32 {
        database
            .query_row(&format!("SELECT count(*) FROM agents WHERE {what}"), [], |row| row.get(0))
            .unwrap()
    };
    for emotion in ["happy", "angry", "sad", "neutral"] {
        assert!(count(&format!("emotion = '{emotion}'")) > 5, "{emotion}");
        assert_eq!(count(&format!("(emotion = '{emotion}') != ({emotion} = 1)")), 0, "{emotion}");
    }
    assert_eq!(count("gait NOT LIKE emotion || '-%'"), 0);
    // and what they felt in the end
    let rows = rows(Path::new(&path("run.csv")));
    let (first, last) = (&rows[..60], &rows[rows.len() - 60..]);
    for (id, row) in (1..).zip(first) {
        assert_eq!(count(&format!("id = {id} AND emotion = '{}'", row[8])), 1, "{row:?}");
    }
    assert!(first.iter().filter(|row| row[8] == "angry").count() < 30);
    assert!(last.iter().all(|row| row[8] == "angry"), "{last:?}");
}

#[test]
fn recorded_people_are_marked_as_led_in_the_table_of_agents() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (walked, again) = (path("walked.sqlite"), path("again.sqlite"));
    good(&["simulate", "garden", "--seconds", "1", "--backend", "cpu", "--out", &walked]);
    good(&["replay", &walked, "--backend", "cpu", "--out", &again]);
    for (file, led) in [(walked, 0), (again, 4)] {
        let counts =
            Connection::open(&file)
                .unwrap()
                .query_row("SELECT count(*), sum(led) FROM agents", [], |row| Ok((row.get(0)?, row.get(1)?)));
        assert_eq!(counts.unwrap(), (4, led), "{file}");
    }
}

#[test]
fn who_never_comes_does_not_keep_a_place_from_being_empty() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("hall.toml");
    let hall = "name = \"hall\"\nbounds = [[-12, -6], [12, -6], [12, 6], [-12, 6]]\n[population]\nagents = 20\n\
                [[stages]]\nname = \"out\"\nkind = \"exit\"\nposition = [11, 0]\nsize = [2, 10]\n\
                [[journeys]]\nname = \"through\"\nstages = [\"out\"]\n\
                [[sources]]\npolygon = [[0, -4], [8, -4], [8, 4], [0, 4]]\nschedule = [{ time = 0.5, count = 6 }]\n";
    std::fs::write(&scene, hall).unwrap();
    let run = [
        "simulate",
        scene.to_str().unwrap(),
        "--until",
        "empty",
        "--seconds",
        "90",
        "--backend",
        "cpu",
        "--json",
    ];
    let report = json(&run);
    assert!(report["emptied"] == true && report["never"] == 14, "{report}");
    assert!(report["evacuation"]["people"] == 6 && report["evacuation"]["left"] == 6, "{report}");
    assert!(report["evacuation"]["time_100"].as_f64().unwrap() < 60.0, "{report}");
}

#[test]
fn the_key_of_videos_is_kept_unless_forced() {
    let folder = tempfile::tempdir().unwrap();
    let (videos, key) = (folder.path().join("videos"), folder.path().join("videos-key.csv"));
    std::fs::write(&key, "of videos that raters have by now").unwrap();
    let show = ["gait", "show", "--videos", videos.to_str().unwrap()];
    let output = gaitway(&show);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(error.contains("videos-key.csv exists already") && error.contains("--force"), "{error}");
    assert!(!videos.exists() && std::fs::read_to_string(&key).unwrap().starts_with("of videos"));
}

#[test]
fn a_scene_that_is_imported_to_its_own_name_replaces_nothing_unless_forced() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("hall.xml", "<Project scene=\"s.xml\" behavior=\"b.xml\"/>");
    write("s.xml", "<Experiment version=\"2.0\"></Experiment>");
    write("b.xml", "<BFSM></BFSM>");
    let import = |more: &[&str]| {
        let mut command = program();
        command.current_dir(folder.path()).args(["scene", "import", "hall.xml"]).args(more);
        let output = command.output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    write("hall.toml", "mine");
    let (code, error) = import(&[]);
    assert!(
        code == Some(1) && error.contains("hall.toml exists already") && error.contains("--force"),
        "{error}"
    );
    assert_eq!(std::fs::read_to_string(folder.path().join("hall.toml")).unwrap(), "mine");
    let (code, error) = import(&["--force"]);
    assert_eq!(code, Some(0), "{error}");
    assert!(std::fs::read_to_string(folder.path().join("hall.toml")).unwrap().contains("hall"));
}

#[test]
fn the_demo_leaves_what_the_readme_promises() {
    if !has_vulkan() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("demo");
    let output =
        gaitway(&["demo", "--out", out.to_str().unwrap(), "--agents", "8", "--seconds", "0.2", "--json"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let names: std::collections::BTreeSet<_> = std::fs::read_dir(&out)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    let video = if cfg!(feature = "video") { "crowd.mp4" } else { "crowd.y4m" };
    // a machine that would take more than a minute for it makes none, and says so
    let is_filmed = !said.contains("no video");
    let promised = ["emotions.png", "eyes.png", "map.png", "overview.png", "trajectories.sqlite"];
    let promised: Vec<_> = promised.into_iter().chain(is_filmed.then_some(video)).collect();
    assert!(promised.iter().all(|name| names.contains(*name)) && names.len() == promised.len(), "{names:?}");
    for name in names.iter().filter(|name| name.ends_with(".png")) {
        let samples = samples(&out.join(name));
        assert!(samples.iter().any(|sample| *sample != samples[0]), "{name} shows nothing");
    }
    #[cfg(feature = "video")]
    if is_filmed {
        let video = mp4::read_mp4(std::fs::File::open(out.join(video)).unwrap()).unwrap();
        assert_eq!((video.duration().as_millis(), video.tracks()[&1].sample_count()), (4000, 60));
    }
}
