//! A participation in a headset: what its trials show, and rows that one machine of several gives.

use super::Person;
use gaitway::study::file::Front;
use gaitway::study::plan::Stimulus;
use gaitway::study::store::{Opening, Reading, Store, merge, wait};
use gaitway::study::{Materials, Study};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::Path;

/// The study of agents, whose rows are all of them or some.
fn opening(rows: Option<Range<u32>>) -> Opening {
    let study = Study::builtin("eva-agents").unwrap();
    let materials = Materials::default().with_text("consent-vr.en.md", "# Consent\n\nDo you agree?");
    Opening { study, materials, libraries: BTreeMap::new(), rows }
}

/// The row of a new participant in the part with scenes, once they have a place.
fn row(store: &Store) -> u32 {
    let mut person = Person::come_to_headset(store);
    person.go_to_page(store, "scenes/1");
    let [now, _] = wait(|then| store.showing(&person.token, then)).unwrap();
    now.unwrap().trial.row.unwrap()
}

#[test]
fn a_trial_shows_what_the_plan_says_and_the_next_one_is_known() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path(), &opening(None)).unwrap();
    let mut person = Person::come_to_headset(&store);
    assert_eq!(wait(|then| store.showing(&person.token, then)).unwrap(), [None, None]);
    person.go_to_page(&store, "practice/1");
    let [now, next] = wait(|then| store.showing(&person.token, then)).unwrap();
    let practice = now.unwrap();
    assert_eq!(
        (practice.trial.part.as_str(), practice.stimulus.as_ref().unwrap().scene()),
        ("practice", Some("garden"))
    );
    assert!(next.is_none(), "the next part has no place yet");
    person.go_to_page(&store, "scenes/1");
    let mut seen = BTreeSet::new();
    for position in 1..=12 {
        person.go_to_page(&store, &format!("scenes/{position}"));
        let [now, next] = wait(|then| store.showing(&person.token, then)).unwrap();
        let now = now.unwrap();
        assert_eq!(now.trial.position, position);
        assert_eq!(next.map(|next| next.trial.position), (position < 12).then_some(position + 1));
        let Some(Stimulus::Scene { scene, condition }) = &now.stimulus else { panic!("{now:?}") };
        assert!(seen.insert((scene.clone(), condition.clone())));
        // who reads the data afterwards finds the same
        let found = Reading::open(folder.path()).unwrap().showing(&person.turn.code, "scenes", position);
        assert_eq!(found.unwrap().0, now);
    }
    let reading = Reading::open(folder.path()).unwrap();
    assert_eq!(reading.showing(&person.turn.code, "practice", 1).unwrap().0, practice);
    for (code, part, trial) in
        [("K7", "scenes", 1), (person.turn.code.as_str(), "scenes", 13), (&person.turn.code, "walks", 1)]
    {
        assert!(reading.showing(code, part, trial).is_none(), "{code} {part} {trial}");
    }
}

#[test]
fn several_machines_give_rows_of_their_own_and_together_each_once() {
    let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let given = |folder: &Path, rows: Range<u32>| -> Vec<u32> {
        let store = Store::open(folder, &opening(Some(rows.clone()))).unwrap();
        let mut found: Vec<u32> = (0..7).map(|_| row(&store)).collect();
        drop(store);
        // the range is kept in the folder
        let store = Store::open(folder, &opening(None)).unwrap();
        found.extend((0..5).map(|_| row(&store)));
        found.sort_unstable();
        assert_eq!(found, rows.collect::<Vec<_>>());
        found
    };
    let both = [given(folders[0].path(), 0..12), given(folders[1].path(), 12..24)].concat();
    assert_eq!(both, (0..24).collect::<Vec<_>>());
    let all = folders[0].path().join("all");
    let from = folders.each_ref().map(|folder| folder.path().to_owned());
    assert_eq!(merge(&from, &all).unwrap(), 24);
    let counts = Reading::open(&all).unwrap().overview().unwrap().counts;
    assert_eq!(counts.iter().find(|counts| counts.part == "scenes").unwrap().counts, [1; 24]);
    for wrong in [0..25, 24..25] {
        let error = Store::open(folders[0].path(), &opening(Some(wrong))).unwrap_err().to_string();
        assert!(error.contains("0..24"), "{error}");
    }
}

#[test]
fn a_participant_goes_on_where_they_began() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path(), &opening(None)).unwrap();
    for (person, front, other, wanted) in [
        (Person::come_to_headset(&store), Front::Headset, Front::Web, "in a headset"),
        (Person::come(&store, None).unwrap(), Front::Web, Front::Headset, "in a browser"),
    ] {
        let code = person.turn.code.clone();
        assert_eq!(wait(|then| store.resume(&code, front, then)).unwrap().turn, person.turn);
        let refused = wait(|then| store.resume(&code, other, then)).unwrap_err();
        assert!(refused.to_string().contains(wanted), "{refused}");
    }
}
