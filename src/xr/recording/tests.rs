#![allow(clippy::unwrap_used, reason = "a test")]

use super::*;
use crate::kernels::layout::{Appearance, Body, Route, Stance, StepUniforms, Waiting};

fn session() -> Session {
    Session {
        version: "0.1.0".into(),
        scene: "crossing".into(),
        condition: "eva-g".into(),
        gaze: "natural".into(),
        agents: 7,
        seed: u64::MAX,
        time_step: 1.0 / 30.0,
        scenario: 1,
        library: 2,
        avatars: 3,
        start: 0x0123,
        trial: None,
    }
}

/// One agent who looks at the user at times, or does not.
fn crowd(gazes: bool) -> Store {
    Store {
        step: StepUniforms { agent_count: 1, ..StepUniforms::default() },
        position: vec![[1.0, 2.0]],
        velocity: vec![[0.0; 2]],
        heading: vec![0.5],
        stance: vec![Stance { walk_weight: 1.0, stride: 1.4, ..Stance::default() }],
        route: vec![Route::default()],
        waiting: vec![Waiting::default()],
        elevation: vec![0.0],
        appearance: vec![Appearance::new(0, 0, gazes, 1.0, [0; 4])],
        ..Store::default()
    }
}

fn states() -> Vec<UserState> {
    let odd = |i: u32| f32::from_bits(0x3f80_0000 + i * 7919);
    (0..40)
        .map(|i| UserState {
            place: Vec2::new(odd(i), -odd(i + 1) * 1e-3),
            elevation: odd(3 * i),
            velocity: Vec2::new(odd(2 * i) - 1.0, 1e-30),
            head: (i % 3 > 0).then(|| [odd(i), 1.6, -0.0, 0.0, odd(i), 0.0, 1.0]),
            hands: [None, (i % 2 == 0).then_some([0.1; 7])],
            sticks: [0.0, odd(i), -1.0],
        })
        .collect()
}

fn written() -> String {
    let mut recorder = Recorder::new(Vec::new(), &session()).unwrap();
    for state in &states() {
        recorder.step(state, &crowd(true)).unwrap();
    }
    String::from_utf8(recorder.finish(&crowd(true)).unwrap()).unwrap()
}

#[test]
fn what_is_written_is_read_back_with_all_its_bits() {
    let (states, text) = (states(), written());
    let read = Recording::read(text.as_bytes()).unwrap();
    assert_eq!(read.session, session());
    assert!(read.end.is_some() && read.hashes.len() == 1 && read.hashes[0].0 == 30);
    assert_eq!(read.steps.len(), states.len());
    for (a, b) in read.steps.iter().zip(&states) {
        let bits =
            |m: &UserState| [m.place.x, m.place.y, m.elevation, m.velocity.x, m.velocity.y].map(f32::to_bits);
        assert_eq!(bits(a), bits(b));
        assert_eq!(a, b);
    }
}

#[test]
fn a_recording_of_another_session_is_refused_with_what_differs() {
    let read = Recording::read(written().as_bytes()).unwrap();
    read.must_be_of(&session()).unwrap();
    let refused = |other: Session| read.must_be_of(&other).unwrap_err().to_string();
    assert!(
        refused(Session { condition: "eva-o".into(), ..session() })
            .ends_with("condition eva-g was recorded, this is eva-o")
    );
    assert!(
        refused(Session { gaze: "paper".into(), ..session() })
            .contains("gaze natural was recorded, this is paper")
    );
    let text = refused(Session { seed: 2, library: 9, ..session() });
    assert!(text.contains("seed 18446744073709551615 was recorded, this is 2; library "), "{text}");
    for (other, key) in [
        (Session { version: "9".into(), ..session() }, "version"),
        (Session { scene: "garden".into(), ..session() }, "scene"),
        (Session { agents: 8, ..session() }, "agents"),
        (Session { time_step: 0.1, ..session() }, "time_step"),
        (Session { scenario: 9, ..session() }, "scenario"),
        (Session { avatars: 9, ..session() }, "avatars"),
        (Session { start: 9, ..session() }, "start"),
    ] {
        assert!(refused(other).contains(&format!("session: {key} ")));
    }
}

#[test]
fn the_hash_of_a_session_covers_what_the_gaze_is_made_from() {
    let of = |session: &Session, state: &UserState, gazes: bool| {
        let mut hash = SessionHash::new(session);
        hash.step(state, &crowd(gazes));
        hash.with(&crowd(gazes))
    };
    let user = UserState { head: Some([0.5, 1.6, 0.0, 0.0, 0.0, 0.0, 1.0]), ..UserState::default() };
    let one = of(&session(), &user, true);
    assert_eq!(one, of(&session(), &user, true));
    // all agents walk alike in all of these
    let lower = UserState { head: Some([0.5, 1.2, 0.0, 0.0, 0.0, 0.0, 1.0]), ..user };
    assert_ne!(one, of(&session(), &lower, true));
    assert_ne!(one, of(&session(), &user, false), "gazes at the user are hashed");
    assert_ne!(one, of(&Session { condition: "eva-o".into(), ..session() }, &user, true));
    assert_ne!(one, of(&session(), &UserState { elevation: 3.0, ..user }, true));
    // hands, sticks and a turned head move no agent, but are part of the session
    for other in [
        UserState { head: Some([0.5, 1.6, 0.0, 0.0, 1.0, 0.0, 0.0]), ..user },
        UserState { hands: [Some([0.1; 7]), None], ..user },
        UserState { hands: [None, Some([0.1; 7])], ..user },
        UserState { sticks: [0.0, 0.0, 0.5], ..user },
    ] {
        assert_ne!(one, of(&session(), &other, true), "{other:?}");
    }
    // beyond the reach of all agents only the user differs, not the gaze
    let mut far = (SessionHash::new(&session()), SessionHash::new(&session()));
    let away = UserState { head: Some([50.0, 1.6, 0.0, 0.0, 0.0, 0.0, 1.0]), ..user };
    far.0.step(&away, &crowd(true));
    far.1.step(&away, &crowd(false));
    assert_eq!(far.0.with(&crowd(true)), far.1.with(&crowd(false)));
}

#[test]
fn a_broken_file_is_refused_at_its_line() {
    let text = written();
    let refused = |text: String, want: &str| {
        let error = Recording::read(text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(want), "{error}");
    };
    refused(text.replace("recording 2", "recording 9"), "version \"9\"");
    refused(text.replace("recording 2", "recording 0"), "version \"0\"; this program reads 1 and 2");
    refused(String::new(), "line 1: does not begin with `# gaitway recording 2`");
    refused("frame id x y\n".into(), "line 1: does not begin");
    refused(text.replace("# seed", "# sead"), "line 7: no `# seed`");
    refused(text.replace("\n5,", "\n6,"), "line 19: step \"6\"; it should be 5");
    refused(text.replace(",1.6,", ",NaN,"), "not a finite number");
    refused(text.replace("\n3,", "\n3,0,"), "fields");
    refused(text.replace("# hash 30", "# hash 29"), "hash after \"29\" steps; it stands after 30");
}

/// The same in format 1: no heights, no condition, no hashes but those of start and end.
fn written_in_format_1() -> String {
    let kept = ["# scene", "# agents", "# seed", "# time_step", "# start", "# end"];
    let line = |line: &str| {
        let mut fields: Vec<&str> = line.split(',').collect();
        match fields.len() {
            1 if line.starts_with("# gaitway") => Some("# gaitway recording 1\n".to_owned()),
            1 => kept.iter().any(|key| line.starts_with(key)).then(|| format!("{line}\n")),
            _ => {
                fields.remove(3);
                Some(fields.join(",") + "\n")
            }
        }
    };
    written().lines().filter_map(line).collect()
}

#[test]
fn format_1_is_still_read_and_says_neither_condition_nor_heights() {
    let read = Recording::read(written_in_format_1().as_bytes()).unwrap();
    assert!(read.is_silent() && read.hashes.is_empty() && read.end.is_some());
    assert_eq!((read.session.scene.as_str(), read.session.condition.as_str()), ("crossing", ""));
    let flat: Vec<UserState> =
        states().into_iter().map(|user| UserState { elevation: 0.0, ..user }).collect();
    assert_eq!(read.steps, flat);
    // of what it says, everything must be so
    read.must_be_of(&Session { condition: "eva-o".into(), library: 9, ..session() }).unwrap();
    let text = read.must_be_of(&Session { seed: 2, ..session() }).unwrap_err().to_string();
    assert!(text.contains("seed 18446744073709551615 was recorded, this is 2"), "{text}");
    assert!(!Recording::read(written().as_bytes()).unwrap().is_silent());
    let bad = written_in_format_1().replace("# scene", "# scone");
    assert!(Recording::read(bad.as_bytes()).unwrap_err().to_string().contains("no `# scene`"));
}

#[test]
fn a_recording_of_a_trial_names_it_and_replays_as_any() {
    let label = TrialLabel {
        study: "eva-agents".into(),
        participant: "k7q4".into(),
        part: "scenes".into(),
        trial: 7,
    };
    let labelled = Session { trial: Some(label.clone()), ..session() };
    let text = |session: &Session| {
        let mut recorder = Recorder::new(Vec::new(), session).unwrap();
        states().iter().for_each(|state| recorder.step(state, &crowd(true)).unwrap());
        String::from_utf8(recorder.finish(&crowd(true)).unwrap()).unwrap()
    };
    let (plain, named) = (text(&session()), text(&labelled));
    let read = Recording::read(named.as_bytes()).unwrap();
    assert_eq!(read.session, labelled);
    read.must_be_of(&session()).unwrap();
    assert_eq!(read.end, Recording::read(plain.as_bytes()).unwrap().end, "a name is no part of the hash");
    let bad = named.replace("# trial 7", "# trial x");
    assert!(Recording::read(bad.as_bytes()).unwrap_err().to_string().contains("trial \"x\""));
    for (study, participant) in [("a\n# end 0", "b"), ("", "b"), ("a", " b")] {
        let trial = Some(TrialLabel {
            study: study.into(),
            participant: participant.into(),
            part: "scenes".into(),
            trial: 1,
        });
        let error = Recorder::new(Vec::new(), &Session { trial, ..session() }).unwrap_err();
        assert!(error.to_string().contains("must be one line"), "{error}");
    }
}

#[test]
fn a_file_cut_or_changed_at_any_byte_is_read_or_refused() {
    let label = TrialLabel { study: "eva".into(), participant: "k7".into(), part: "scenes".into(), trial: 7 };
    let recorder = Recorder::new(Vec::new(), &Session { trial: Some(label), ..session() }).unwrap();
    let head = String::from_utf8(recorder.into_inner()).unwrap();
    let (rows, first) = (written(), written_in_format_1());
    let named = head + &rows[rows.find("\n0,").unwrap() + 1..];
    let mut whole = 0;
    for text in [named, first] {
        for cut in 0..text.len() {
            whole += usize::from(Recording::read(&text.as_bytes()[..cut]).is_ok());
        }
        for at in (0..text.len()).step_by(3) {
            for byte in [b'\n', b',', b'x', 0xff] {
                let mut changed = text.clone().into_bytes();
                changed[at] = byte;
                let _ = Recording::read(changed.as_slice());
            }
        }
    }
    assert!(whole > 10_000, "{whole} of the cuts are recordings");
}

#[test]
fn a_recording_that_is_cut_off_anywhere_is_read_up_to_its_last_whole_line() {
    let text = written();
    let table = text.find("\n0,").unwrap() + 1;
    for cut in (table..text.len()).step_by(61) {
        let read = Recording::read(&text.as_bytes()[..cut]).unwrap();
        let rows = text[table..cut]
            .split_inclusive('\n')
            .filter(|line| line.ends_with('\n') && !line.starts_with('#'));
        assert_eq!((read.steps.len(), read.end), (rows.count(), None), "cut at {cut}");
    }
}

#[test]
fn the_next_start_repairs_a_recording_that_broke_off_and_loses_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("visit.csv");
    let text = written();
    let torn = text.find("\n20,").unwrap() + 9;
    std::fs::write(&path, &text[..torn]).unwrap();
    assert_eq!(repair(&path).unwrap(), 8);
    let whole = std::fs::read_to_string(&path).unwrap();
    assert_eq!(whole, text[..torn - 8]);
    assert_eq!(repair(&path).unwrap(), 0);

    // a new one at the same place
    std::fs::write(&path, &text[..torn]).unwrap();
    for name in ["visit.broken-off.csv", "visit.broken-off-2.csv"] {
        let way = make_way(&path).unwrap();
        assert!(way.note.unwrap().contains(name));
        assert_eq!(std::fs::read_to_string(folder.path().join(name)).unwrap(), whole);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "");
        std::fs::write(&path, &whole).unwrap();
    }
    // without a step there is nothing to keep
    std::fs::write(&path, &text[..text.find("\n0,").unwrap() + 1]).unwrap();
    assert!(make_way(&path).unwrap().note.is_none());
    for (content, says) in [(text.as_str(), "a complete recording"), ("a,b\n1,2\n", "no recording")] {
        std::fs::write(&path, content).unwrap();
        assert!(make_way(&path).unwrap_err().to_string().contains(says));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), content);
    }
}

#[test]
fn each_hash_of_the_header_tells_when_what_it_is_of_changes() {
    use crate::avatar::{Sex, generated};
    use crate::library::GaitLibrary;
    use crate::scenario::Scenario;
    let scenario = Scenario::builtin("garden").unwrap();
    let mut other = scenario.clone();
    other.navigation.patience = 3.0;
    assert_eq!(hash_scenario(&scenario), hash_scenario(&scenario.clone()));
    assert_ne!(hash_scenario(&scenario), hash_scenario(&other));

    let library = GaitLibrary::generated(3, 1).unwrap();
    let mut gaits = library.gaits().to_vec();
    gaits[2].poses[5][4].y += 1e-3;
    let other = GaitLibrary::from_gaits(gaits).unwrap();
    assert_eq!(hash_library(&library), hash_library(&GaitLibrary::generated(3, 1).unwrap()));
    assert_ne!(hash_library(&library), hash_library(&other));

    let avatars = [generated(Sex::Female)];
    let mut other = avatars.clone();
    other[0].levels[0].vertices[7].color.x += 0.1;
    assert_eq!(hash_avatars(&avatars), hash_avatars(&[generated(Sex::Female)]));
    assert_ne!(hash_avatars(&avatars), hash_avatars(&other));
    assert_ne!(hash_avatars(&avatars), hash_avatars(&[generated(Sex::Male)]));

    // who looks and how fast one may walk is not in the state, which is the same
    let start = crowd(true);
    assert_eq!(hash_start(&start), hash_start(&crowd(true)));
    assert_ne!(hash_start(&start), hash_start(&crowd(false)));
    let body =
        Body { radius: 0.25, max_speed: 2.0, preferred_speed: 1.4, walk_ratio: 0.0, ..Body::default() };
    let faster = Store { body: vec![body], ..crowd(true) };
    assert_ne!(hash_start(&start), hash_start(&faster));
}
