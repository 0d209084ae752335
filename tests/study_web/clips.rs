//! Stimuli that are clips: files under their random names.

use crate::lab::{Lab, agree, begin, go_on};
use gaitway::study::serve::{Error, Server, Settings};
use gaitway::study::store::{Opening, Store};
use gaitway::study::{Materials, Study};
use std::collections::BTreeMap;

const STUDY: &str = r#"
[study]
id = "looks"
version = 1
title = "Scenes"
seed = 7
languages = ["en"]
minutes = 5
contact = "Lab"
flow = ["consent", "scenes"]
[consent]
text = "consent.md"
[part.scenes]
kind = "trials"
show = { scenes = ["garden"], conditions = ["baseline", "eva-g"], seconds = 2 }
ask = "which"
[questions.which]
kind = "choice"
options = ["one", "two"]
"#;

#[test]
fn clips_are_demanded_at_the_start_and_sent_whole_or_in_part() {
    let folder = tempfile::tempdir().unwrap();
    let opening = Opening {
        study: Study::parse(STUDY, "test").unwrap(),
        materials: Materials::default().with_text("consent.md", "# Consent"),
        libraries: BTreeMap::new(),
        rows: None,
    };
    let store = Store::open(&folder.path().join("run"), &opening).unwrap();
    let clips = folder.path().join("clips");
    let settings =
        Settings { listen: ([127, 0, 0, 1], 0).into(), clips: clips.clone(), ..Settings::default() };
    let error = Server::bind(store.clone(), &settings).unwrap_err();
    let Error::Clips { count, .. } = &error else { panic!("{error}") };
    assert_eq!(*count, 6, "two conditions, three seeds");
    assert!(error.to_string().contains("garden, baseline") && error.to_string().contains(".mp4"), "{error}");
    std::fs::create_dir_all(&clips).unwrap();
    for name in store.current().stimuli.keys() {
        std::fs::write(clips.join(format!("{name}.mp4")), [7; 1000]).unwrap();
    }
    let lab = Lab::serve(folder, store, |_| {});
    let mut browser = lab.browser();
    let consent = begin(&mut browser);
    let page = agree(&mut browser, &consent);
    let film = format!("/stimuli/{}", page.attribute("data-film"));
    assert_eq!(page.attribute("data-seconds"), "2");
    let whole = browser.get(&film);
    assert_eq!((whole.status, whole.header("content-type"), whole.body.len()), (200, "video/mp4", 1000));
    assert_eq!(whole.header("cache-control"), "public, max-age=31536000, immutable");
    let part = browser.send(&format!("GET {film} HTTP/1.1\r\n"), &[("range", "bytes=100-299")], "");
    assert_eq!(
        (part.status, part.header("content-range"), part.body.len()),
        (206, "bytes 100-299/1000", 200)
    );
    let none = browser.send(&format!("GET {film} HTTP/1.1\r\n"), &[("range", "bytes=5000-")], "");
    assert_eq!((none.status, none.header("content-range")), (416, "bytes */1000"));
    let pages = go_on(&mut browser, page, "");
    assert_eq!(pages.len(), 5);
    let sent = browser.received.join("\n");
    for word in ["baseline", "eva-g", "garden"] {
        assert!(!sent.contains(word), "{word}");
    }
}
