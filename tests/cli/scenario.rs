//! A scenario of one's own: begun, checked, explained, taken from a built-in scene.

use super::{bad, gaitway, good, json, refused};
use std::path::Path;

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().unwrap().to_owned()
}

#[test]
fn what_a_scenario_begins_with_is_right_walks_and_names_its_own_file() {
    let folder = tempfile::tempdir().unwrap();
    for like in ["hall", "street", "museum", "corridor"] {
        let file = path(folder.path(), &format!("my-{like}.toml"));
        assert!(good(&["scene", "new", "--like", like, "--out", &file]).contains(&file));
        let (code, error) = bad(&["scene", "new", "--like", like, "--out", &file]);
        assert!(code == 1 && error.contains("exists already") && error.contains("--force"), "{error}");
        let found = &json(&["scene", "check", &file, "--json"])["scenes"][0];
        assert_eq!((&found["contents"]["name"], found.get("error")), (&like.into(), None));
        let run = json(&["simulate", &file, "--seconds", "20", "--backend", "cpu", "--json"]);
        assert!(run["mean_speed"].as_f64().unwrap() > 0.2, "{like}: {run}");
    }
    let text = std::fs::read_to_string(path(folder.path(), "my-hall.toml")).unwrap();
    assert!(text.contains("my-hall.toml --until empty") && !text.contains(" hall.toml"), "{text}");
    refused(&["scene", "new", "--like", "station"], "station", "hall, street, museum, corridor");
}

#[test]
fn a_check_says_what_is_right_and_what_is_wrong_and_simulates_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "wrong.toml");
    std::fs::write(&file, "name = \"wrong\"\n\n[navigation]\npatiense = 1.0\n").unwrap();
    let output = gaitway(&["scene", "check", "garden", &file]);
    let (told, error) =
        (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert_eq!(output.status.code(), Some(1));
    assert!(told.starts_with("garden: 4 agents, ") && told.contains("a user"), "{told}");
    assert!(error.contains("wrong.toml:4") && error.contains("did you mean `patience`?"), "{error}");
    assert!(
        good(&["scene", "check", "garden", "--set", "population.agents=9"]).starts_with("garden: 9 agents")
    );
    let error = bad(&["scene", "check", "garden", "--set", "population.agents=-9"]).1;
    assert!(error.contains("population.agents"), "{error}");
    // a goal where no agent can stand
    let walled = path(folder.path(), "walled.toml");
    let hall = std::fs::read_to_string("assets/starters/hall.toml").unwrap();
    std::fs::write(
        &walled,
        hall.replace(
            "[9.5, 5.5], [10.5, 5.5], [10.5, 6.5], [9.5, 6.5]",
            "[22, 2], [26, 2], [26, 10], [22, 10]",
        ),
    )
    .unwrap();
    let error = bad(&["scene", "check", &walled]).1;
    assert!(error.contains("stages[0].position") && error.contains("walkable ground"), "{error}");
}

#[test]
fn a_scene_written_out_walks_as_the_built_in_one_does() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "own.toml");
    let hash = |scene: &[&str]| {
        let end = ["--seconds", "3", "--backend", "cpu", "--json"];
        json(&[&["simulate"], scene, &end].concat())["state_hash"].as_str().unwrap().to_owned()
    };
    for scene in ["crossing", "garden", "parking", "scifi"] {
        assert!(good(&["scene", "show", scene, "--agents", "40", "--out", &file, "--force"]).is_empty());
        assert!(std::fs::read_to_string(&file).unwrap().contains("layout = \"custom\""));
        assert_eq!(hash(&[&file]), hash(&[scene, "--agents", "40"]), "{scene}");
    }
    assert!(good(&["scene", "show", "scifi"]).contains("[[routes]]"));
}

#[test]
fn the_schema_is_json_and_the_page_names_every_table() {
    let schema = json(&["scene", "schema"]);
    assert_eq!(schema["properties"]["navigation"]["properties"]["patience"]["maximum"], 600);
    let page = good(&["scene", "schema", "--format", "markdown"]);
    assert!(
        page.contains("## `[[population.classes]]`")
            && page.contains("| `patience` | number | s | `0` | 0 to 600 |")
    );
}

#[test]
fn the_lecture_hall_of_the_guide_is_short_right_and_empties() {
    let guide = std::fs::read_to_string("docs/own-scene.md").unwrap();
    let toml = guide.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    assert!(toml.lines().count() < 40, "{} lines", toml.lines().count());
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "lecture-hall.toml");
    std::fs::write(&file, toml).unwrap();
    let run = json(&["simulate", &file, "--until", "empty", "--backend", "cpu", "--json"]);
    assert_eq!((&run["emptied"], &run["left"]), (&true.into(), &120.into()), "{run}");
    for time in ["time_50", "time_100"] {
        let told = format!("{:.1} s", run["evacuation"][time].as_f64().unwrap());
        assert!(guide.contains(&told), "the guide does not say {told}");
    }
}
