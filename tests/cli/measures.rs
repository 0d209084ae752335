//! Joint angles of walks, by the program.

use super::{good, json};
use gaitway::avatar::{Sex, generated, write_glb};

#[test]
fn gaits_are_measured_on_the_generated_bodies_and_on_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let built_in = json(&["gait", "measure", "--json", "--figures", &at("angles")]);
    assert_eq!(built_in["avatar"], "generated");
    let gaits = built_in["gaits"].as_array().unwrap();
    for emotion in ["happy", "angry", "sad", "neutral"] {
        let own = gaits.iter().filter(|gait| gait["emotion"] == emotion).count();
        assert_eq!(built_in["crowd"][emotion]["gaits"], own);
        let is_curve = |gait: &serde_json::Value| gait["curves"]["knee"].as_array().unwrap().len() == 64;
        assert!(own > 0 && gaits.iter().all(is_curve));
    }
    for angle in ["thigh", "knee", "ankle", "foot", "shoulder", "elbow"] {
        assert!(built_in["crowd"]["neutral"]["rms"][angle].as_f64().unwrap() > 0.0);
        for ending in ["svg", "png"] {
            let file = folder.path().join("angles").join(format!("{angle}.{ending}"));
            assert!(std::fs::metadata(&file).unwrap().len() > 1000, "{}", file.display());
        }
    }
    at_every_speed(&built_in);
    // crowds show more than people do
    let cue = &built_in["cues"]["cycle_time_s"]["sad"];
    assert!(cue["within"] == false && cue["value"].as_f64().unwrap() > 0.3, "{cue}");
    let faint = json(&["gait", "measure", "--expression", "1", "--json"]);
    let cue = &faint["cues"]["cycle_time_s"]["sad"];
    assert!(cue["within"] == true && cue["value"].as_f64().unwrap() > 0.1, "{cue}");

    // the same body from a file walks alike
    write_glb(&generated(Sex::Male), at("man.glb").as_ref()).unwrap();
    good(&["gait", "walk", "--emotion", "neutral", "--sex", "male", "--out", &at("walk.glb")]);
    let [own, file] = [vec![], vec!["--avatar".to_owned(), at("man.glb")]].map(|more| {
        let walk = at("walk.glb");
        let mut line = vec!["gait", "measure", &walk, "--json"];
        line.extend(more.iter().map(String::as_str));
        json(&line)["gaits"][0]["rms"]["knee"].as_f64().unwrap()
    });
    assert!((own - file).abs() < 0.5, "{own} on the generated body, {file} on its file");
    let shown = good(&["gait", "measure", &at("walk.glb")]);
    assert!(shown.contains("knee change") && shown.contains("step_width_m"), "{shown}");
}

/// The neutral people one by one, and as they are drawn at three speeds.
fn at_every_speed(found: &serde_json::Value) {
    let individuals = &found["individuals"];
    let neutral = found["gaits"].as_array().unwrap().iter().filter(|gait| gait["emotion"] == "neutral");
    let (within, all): (Vec<bool>, Vec<f64>) = neutral
        .map(|gait| (gait["within_two_bands"].as_bool().unwrap(), gait["farthest"].as_f64().unwrap()))
        .unzip();
    assert!(within.iter().zip(&all).all(|(within, farthest)| *within == (*farthest <= 4.0)));
    assert_eq!(individuals["gaits"], within.len());
    assert_eq!(individuals["within_two_bands"], within.iter().filter(|within| **within).count());
    assert_eq!(individuals["within_two_bands"], within.len(), "everybody: {all:?}");
    assert_eq!(individuals["by_angle"]["knee"], within.len());

    let speeds = found["speeds"].as_array().unwrap();
    let scalar = |at: usize, name: &str| {
        let scalar = &speeds[at]["scalars"][name];
        let [value, target, tolerance] =
            ["value", "target", "tolerance"].map(|part| scalar[part].as_f64().unwrap());
        assert_eq!(scalar["within"], (value - target).abs() <= tolerance, "{name}: {scalar}");
        scalar["within"].as_bool().unwrap()
    };
    // what is not yet as in people: docs/crowds.md
    let known = [(0, "bob_m"), (2, "hip_range_deg")];
    for (at, speed) in [0.8, 1.25, 1.7].into_iter().enumerate() {
        assert!((speeds[at]["speed"].as_f64().unwrap() - speed).abs() < 1e-6);
        let names: Vec<&String> = speeds[at]["scalars"].as_object().unwrap().keys().collect();
        assert_eq!(names.len(), 12, "{names:?}");
        for name in names {
            assert_eq!(scalar(at, name), !known.contains(&(at, name.as_str())), "{name} at {speed} m/s");
        }
    }
    // 56.7 where the pelvis turns no farther and the hips are no lower in long strides
    let swing = speeds[2]["scalars"]["hip_range_deg"]["value"].as_f64().unwrap();
    assert!(swing < 55.5, "thighs swing through {swing} degrees at 1.7 m/s");
}
